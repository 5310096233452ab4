# SPDX-License-Identifier: Apache-2.0
"""Headless Chromium, driven over its debugging pipe with real events of mouse and keyboard."""

import base64
import fcntl
import json
import os
import queue
import subprocess
import threading
import time

HANG_S = 120  # stops a browser that hangs
KEYS = {"Enter": 13, "Escape": 27, "Delete": 46, "Backspace": 8, "Tab": 9, "Home": 36, "End": 35, " ": 32,
        "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}
CONTROL, SHIFT = 2, 8


class Browser:
    """One page. `errors` holds what its console complained of, with failed requests."""

    def __init__(self, program, profile, size=(1600, 1000), is_dark=False):
        to_read, self._write = os.pipe()
        self._read, to_write = os.pipe()
        # Chromium talks on descriptors 3 and 4, whatever the pipes got.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_read, to_write)]
        flags = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run", "--mute-audio", "--remote-debugging-pipe",
                 "--disable-background-networking", f"--user-data-dir={profile}", f"--window-size={size[0]},{size[1]}", "about:blank"]
        self.process = subprocess.Popen(["bash", "-c", f'exec "$0" "$@" 3<&{ends[0]} 4>&{ends[1]}', program, *flags], pass_fds=ends,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (to_read, to_write, *ends):
            os.close(end)
        self.errors = []
        self._id = 0
        self._answers = {}
        self._arrived = queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()
        targets = self.call("Target.getTargets", session=None)["targetInfos"]
        page = next(target for target in targets if target["type"] == "page")
        self._session = self.call("Target.attachToTarget", session=None, targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network", "Performance"):
            self.call(f"{domain}.enable")
        self.looks(size, is_dark)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close", session=None)
        except (OSError, RuntimeError):
            pass
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def call(self, method, session="", **parameters):
        self._id += 1
        message = {"id": self._id, "method": method, "params": parameters}
        if session == "":
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + HANG_S
        while self._id not in self._answers:
            try:
                answer = self._arrived.get(timeout=max(0.01, until - time.monotonic()))
            except queue.Empty:
                raise RuntimeError(f"{method}: the browser does not answer") from None
            if answer is None:
                raise RuntimeError(f"{method}: the browser ended")
            self._answers[answer["id"]] = answer
        answer = self._answers.pop(self._id)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def _listen(self):
        rest = b""
        while True:
            data = os.read(self._read, 1 << 16)
            if not data:
                self._arrived.put(None)
                return
            *messages, rest = (rest + data).split(b"\0")
            for message in map(json.loads, messages):
                if "id" in message:
                    self._arrived.put(message)
                else:
                    self._hear(message["method"], message["params"])

    def _hear(self, method, what):
        if method == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.errors.append(" ".join(str(one.get("value", one.get("description"))) for one in what["args"]))
        elif method == "Runtime.exceptionThrown":
            details = what["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description") or details["text"])
        elif method == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.errors.append(f"{what['entry']['text']} {what['entry'].get('url', '')}".strip())

    def looks(self, size, is_dark=False):
        self.call("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}])

    def open(self, address):
        self.call("Page.navigate", url=address)

    def press(self, selector, states):
        """Elements under pseudo-classes such as hover, as if the mouse were on all of them; no states: as they are."""
        for domain in ("DOM", "CSS"):
            self.call(f"{domain}.enable")
        root = self.call("DOM.getDocument", depth=0)["root"]["nodeId"]
        for node in self.call("DOM.querySelectorAll", nodeId=root, selector=selector)["nodeIds"]:
            self.call("CSS.forcePseudoState", nodeId=node, forcedPseudoClasses=states)

    def run(self, script):
        """The value of an expression in the page; a promise is awaited."""
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            details = result["exceptionDetails"]
            raise RuntimeError(f"{script[:200]}: {details.get('exception', {}).get('description') or details['text']}")
        return result["result"].get("value")

    def wait(self, script, seconds=60):
        """Until an expression is true."""
        until = time.monotonic() + seconds
        while True:
            try:
                value = self.run(f"Boolean({script})")
            except RuntimeError:  # a page between two
                value = None
            if value:
                return
            if time.monotonic() > until:
                raise RuntimeError(f"never true: {script}; the console says {self.errors[-5:]}")
            time.sleep(0.02)

    def middle(self, selector, k=0):
        """Where the k-th element of a selector has its middle on the screen."""
        place = self.run(f"(() => {{ const e = document.querySelectorAll({json.dumps(selector)})[{k}]; if (!e) return null; "
                         "e.scrollIntoView({ block: 'nearest' }); const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")
        if not place:
            raise RuntimeError(f"no {selector}")
        return place

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x, y, count=1, modifiers=0):
        self.mouse("mouseMoved", x, y)
        for k in range(1, count + 1):
            self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=k, modifiers=modifiers)
            self.mouse("mouseReleased", x, y, button="left", clickCount=k, modifiers=modifiers)

    def click_on(self, selector, k=0):
        self.click(*self.middle(selector, k))

    def drag(self, begin, end, steps=8, pause_s=0.02):
        self.mouse("mouseMoved", *begin)
        self.mouse("mousePressed", *begin, button="left", buttons=1, clickCount=1)
        for k in range(1, steps + 1):
            self.mouse("mouseMoved", *(a + (b - a) * k / steps for a, b in zip(begin, end)), button="left", buttons=1)
            time.sleep(pause_s)
        self.mouse("mouseReleased", *end, button="left", clickCount=1)

    def wheel(self, x, y, delta):
        self.mouse("mouseWheel", x, y, deltaX=0, deltaY=delta)

    def key(self, key, modifiers=0):
        code = KEYS.get(key, ord(key.upper()) if len(key) == 1 else 0)
        text = {"text": key} if len(key) == 1 and not modifiers & CONTROL else {"text": "\r"} if key == "Enter" else {}
        self.call("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", key=key, windowsVirtualKeyCode=code, modifiers=modifiers, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, windowsVirtualKeyCode=code, modifiers=modifiers)

    def type(self, text):
        self.call("Input.insertText", text=text)

    def picture(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

    def memory(self):
        """Bytes that the page's script holds, after its garbage is gone, and how many elements there are."""
        self.call("HeapProfiler.collectGarbage")
        metrics = {one["name"]: one["value"] for one in self.call("Performance.getMetrics")["metrics"]}
        return metrics["JSHeapUsedSize"], metrics["Nodes"]
