# SPDX-License-Identifier: Apache-2.0
"""The studio's page in a real browser: python3 studio_test.py AIRTRUTH SOURCE [--drags N] [--monkey SECONDS] [--only NAME]

From a virtual flight to a saved scene with two aircraft and a flock by the mouse alone, rendered by the command line with all of it
where the handles stood; keys, refused numbers and broken files; both films at one frame; edits through reloads, lost connections and other programs; random clicks, drags, keys, resizes and reloads;
no text cut, on another or too faint. How long a drag takes until its picture is drawn is printed, never asserted.
"""

import argparse
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
import tomllib

import numbered_clip
from browser import CONTROL, SHIFT, Browser
from report_page_test import browser_or_skip

FRAMES, WIDTH, HEIGHT, FOV_DEG = 45, 640, 480, 60
IDLE = "window.airtruthStudio && airtruthStudio.isIdle() && airtruthStudio.studio.store.now.connected"
STORE = "airtruthStudio.studio.store.now"
BESIDE_PX = 1  # of where a handle stood, in the rendered video
HEAP_GROWTH = 24 << 20
SERVER_GROWTH = 600 << 20  # aircraft stay open, of 512 MiB at most

# What the layout has to say in one state of the page.
LOOK = r"""(() => {
  const faults = [];
  const wide = innerWidth, high = innerHeight;
  const isShown = (e) => e.checkVisibility({ opacityProperty: true, visibilityProperty: true });
  const scrolls = (e) => { for (let p = e; p; p = p.parentElement) if (['auto', 'scroll'].includes(getComputedStyle(p).overflowY)) return p; return null; };
  if (document.documentElement.scrollWidth > wide) faults.push(`the page is ${document.documentElement.scrollWidth - wide} px too wide`);
  const open = document.querySelector('dialog[open]');
  const root = open || document.body;
  const lines = [];
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    const text = node.textContent.trim().slice(0, 40);
    if (!text || parent.closest('script, style, option, title, noscript, .over') || !isShown(parent)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const scroller = scrolls(parent);
    const room = scroller ? scroller.getBoundingClientRect() : { left: 0, top: 0, right: wide, bottom: high };
    for (const rect of range.getClientRects()) {
      if (!rect.width) continue;
      if (rect.left < room.left - 1 || rect.right > room.right + 1) faults.push(`"${text}" leaves its panel`);
      if (!scroller && (rect.bottom > high + 1 || rect.top < -1)) faults.push(`"${text}" leaves the screen`);
      if (!scroller || (rect.top >= room.top && rect.bottom <= room.bottom)) lines.push({ text, node, left: rect.left, right: rect.right, top: rect.top, bottom: rect.bottom });
    }
    for (let holder = parent; holder !== root; holder = holder.parentElement)
      if (getComputedStyle(holder).overflowX !== 'visible' && getComputedStyle(holder).display !== 'inline' && holder.clientWidth && holder.scrollWidth > holder.clientWidth + 1) { faults.push(`"${text}" is cut`); break; }
  }
  for (const input of root.querySelectorAll('input')) {
    if (!isShown(input) || !['number', 'search', 'text'].includes(input.type)) continue;
    if (input.value && input.scrollWidth > input.clientWidth + 1) faults.push(`the value ${input.value} of "${input.getAttribute('aria-label')}" is cut`);
  }
  lines.sort((a, b) => a.top - b.top);
  for (let i = 0; i < lines.length; ++i)
    for (let k = i + 1; k < lines.length && lines[k].top < lines[i].bottom; ++k) {
      const [a, b] = [lines[i], lines[k]];
      if (a.node === b.node || a.node.parentElement.closest('svg') || b.node.parentElement.closest('svg')) continue;
      if (Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1.5 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3) faults.push(`"${a.text}" and "${b.text}" on each other`);
    }
  // Names for those who do not see the page, and contrast for those who do.
  for (const e of root.querySelectorAll('button, input, select, [role=button], [role=slider]'))
    if (isShown(e) && !e.labels?.length && !(e.getAttribute('aria-label') || e.textContent.trim())) faults.push(`no name: ${e.outerHTML.slice(0, 80)}`);
  const numbers = (colour) => (colour.match(/[\d.]+/g) || [0, 0, 0, 0]).map(Number);
  const bright = ([r, g, b]) => [r, g, b].map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)).reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  for (const { text, node } of lines) {
    const parent = node.parentElement;
    if (parent.closest('svg') || parent.closest(':disabled')) continue;
    let ground = null;
    for (let e = parent; e && !ground; e = e.parentElement) { const c = numbers(getComputedStyle(e).backgroundColor); if (c.length < 4 || c[3] > 0.9) ground = c; }
    const [a, b] = [bright(numbers(getComputedStyle(parent).color)), bright(ground || [255, 255, 255])].sort((p, q) => q - p);
    if ((a + 0.05) / (b + 0.05) < 4.5) faults.push(`"${text}" is faint: ${((a + 0.05) / (b + 0.05)).toFixed(1)} to 1`);
  }
  return [...new Set(faults)];
})()"""

# Labels that leave their view, or lie under a handle.
LABELS = r"""(() => {
  const faults = [];
  const meet = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
  for (const [svg, labels, handles] of [['.over', '.overlay text, .handle text', '.handle .ring'], ['studio-plan svg', '.labels text', '.grab']]) {
    const view = document.querySelector(svg);
    const room = view.getBoundingClientRect();
    const marks = [...view.querySelectorAll(handles)].map((e) => e.getBoundingClientRect());
    for (const label of view.querySelectorAll(labels)) {
      const box = label.getBoundingClientRect();
      if (!box.width) continue;
      if (box.left < room.left - 1 || box.right > room.right + 1 || box.top < room.top - 1 || box.bottom > room.bottom + 1) faults.push(`"${label.textContent}" is cut`);
      if (marks.some((mark) => meet(mark, box))) faults.push(`"${label.textContent}" is under a handle`);
    }
  }
  return faults;
})()"""


# Names of directions that lie on each other.
MEETING = r"""(() => {
  const boxes = [...document.querySelectorAll('.motion text')].map((e) => [e.textContent, e.getBoundingClientRect()]);
  const meet = (a, b) => Math.min(a.right, b.right) > Math.max(a.left, b.left) && Math.min(a.bottom, b.bottom) > Math.max(a.top, b.top);
  return boxes.flatMap(([words, a], k) => boxes.slice(k + 1).filter(([, b]) => meet(a, b)).map(([other]) => `${words} and ${other}`));
})()"""


class Server:
    """`airtruth studio` on a video or a scene, in a folder."""

    ended = set()  # ports of servers that a test has ended, of which a page may still ask

    def __init__(self, airtruth, folder, what, port=0):
        self.process = subprocess.Popen([airtruth, "--quiet", "studio", what, "--out", "out", "--port", str(port)], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        self.port = self.address.partition("?")[0].rstrip("/").rpartition(":")[2]
        if not self.address.startswith("http://127.0.0.1:"):
            raise AssertionError(f"{self.address!r} {self.process.stderr.read()}")

    def memory(self):
        with open(f"/proc/{self.process.pid}/status", encoding="utf-8") as status:
            return next(int(line.split()[1]) << 10 for line in status if line.startswith("VmRSS"))

    def end(self, how=signal.SIGINT):
        Server.ended.add(self.port)
        self.process.send_signal(how)
        try:
            code = self.process.wait(60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = self.process.wait()
        errors = self.process.stderr.read()
        for pipe in (self.process.stdout, self.process.stderr):
            pipe.close()
        if how == signal.SIGINT and code != 130:
            raise AssertionError(f"the server ended with {code}; expected 130\n{errors}")


def web_socket(server):
    """A page's connection, which says nothing."""
    connection = socket.create_connection(("127.0.0.1", int(server.port)), timeout=60)
    token = server.address.partition("token=")[2]
    connection.sendall((f"GET /ws?token={token} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nOrigin: http://127.0.0.1:{server.port}\r\nConnection: Upgrade\r\n"
                        "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n").encode())
    expect("a page's connection", connection.recv(12), b"HTTP/1.1 101")
    return connection


class Page:
    """What a hand does on the page."""

    def __init__(self, browser):
        self.browser = browser

    def open(self, address):
        self.browser.open(address)
        self.rest()

    def rest(self):
        self.browser.wait(IDLE, 120)

    def state(self):
        return self.browser.run(f"{STORE}.state")

    def screen(self, pixel):
        """Where a pixel of the frame is on the screen."""
        return self.browser.run(f"(() => {{ const svg = document.querySelector('.over'); const p = new DOMPoint({pixel[0]}, {pixel[1]}).matrixTransform(svg.getScreenCTM()); return [p.x, p.y]; }})()")

    def add(self, search, k=0):
        self.browser.key("n")
        self.browser.wait("document.querySelector('studio-gallery dialog[open]')")
        count = self.browser.run("document.querySelectorAll('.handle').length")
        self.browser.type(search)
        # What is typed is searched for a moment later; a card's first livery is of the type's folder.
        self.browser.wait(f"document.querySelectorAll('.card')[{k}]?.querySelector('select')?.value.includes({json.dumps(search)})")
        self.browser.click_on(".card .choose", k)
        self.browser.wait(f"document.querySelectorAll('.handle').length === 2 || {count} === 2")
        self.rest()

    def add_flock(self):
        self.browser.key("n")
        self.browser.wait("document.querySelector('studio-gallery dialog[open]')")
        self.browser.click_on(".natural button", 0)
        self.rest()

    def select(self, k):
        if self.browser.run(f"document.querySelectorAll('button.flyer')[{k}].getAttribute('aria-expanded')") != "true":
            self.browser.click_on("button.flyer", k)
        self.rest()

    def drag_handle(self, k, pixel, steps=10):
        begin = self.browser.middle(".handle .ring", k)
        self.browser.drag(begin, self.screen(pixel), steps)
        self.rest()

    def boxes(self):
        return self.browser.run(f"{STORE}.picture.boxes")


def flight(airtruth, folder, frames=FRAMES, width=WIDTH, height=HEIGHT, has_encounter=True, name="flight.mp4"):
    """A clip and, with an aircraft by its closest approach, a scene of its name."""
    subprocess.run([airtruth, "--quiet", "synth", "--out", name, "--frames", str(frames), "--width", str(width), "--height", str(height), "--seed", "7", "--no-own-aircraft"], cwd=folder, check=True)
    if has_encounter:
        subprocess.run([airtruth, "--quiet", "scene", "new", name], cwd=folder, check=True)


def near(what, got, wanted, tolerance):
    if any(abs(a - b) > tolerance for a, b in zip(got, wanted)):
        raise AssertionError(f"{what}: {got}; expected {wanted} within {tolerance}")


def expect(what, got, wanted):
    if got != wanted:
        raise AssertionError(f"{what}: {got!r}; expected {wanted!r}")


def complaints(browser):
    """What the console complained of, but of connections that a test or a reload has ended."""
    return [error for error in browser.errors if "WebSocket" not in error and not ("net::ERR_" in error and any(f":{port}/" in error for port in Server.ended))]


def moments_of(table):
    return [(one["time_s"], one["pixel"]) for one in table["seen"]]


def test_model(browser, source, root):
    """The page's state by itself."""
    bundle = os.path.join(root, "model_test.js")
    subprocess.run(["esbuild", os.path.join(source, "src/studio/page/assets/model/model_test.ts"), "--bundle", "--format=iife", "--target=es2021", "--log-level=warning", f"--outfile={bundle}"], check=True)
    browser.run(open(bundle, encoding="utf-8").read() + "; 1")
    said = browser.run("modelTest")
    if not said[0].endswith(" good"):
        raise AssertionError("\n  ".join(["model:", *said]))
    print(f"model: {said[0]}")


def test_handles(airtruth, browser, root):
    """From a video to a saved scene by the mouse, and what the command line renders from it."""
    flight(airtruth, root)
    server = Server(airtruth, root, "flight.toml")
    page = Page(browser)
    page.open(server.address)
    begun = page.state()["text"]
    # The scene begins with one aircraft by its closest approach.
    page.select(0)
    browser.run("[...document.querySelectorAll('studio-flyer button')].find((b) => b.textContent.startsWith('State by moments')).scrollIntoView()")
    buttons = browser.run("[...document.querySelectorAll('studio-flyer button')].map((b) => b.textContent)")
    browser.click_on("studio-flyer button", next(k for k, words in enumerate(buttons) if words.startswith("State by moments")))
    browser.wait("document.querySelectorAll('.handle').length >= 2")
    page.rest()
    page.drag_handle(0, (200, 120))
    page.add("738")
    page.drag_handle(0, (150, 200))
    page.drag_handle(1, (480, 170))
    # Nearer by the wheel above a handle.
    before = page.state()["scene"]["intruder"][1]["seen"][1]["range_m"]
    browser.wheel(*browser.middle(".handle .ring", 1), -240)
    page.rest()
    after = page.state()["scene"]["intruder"][1]["seen"][1]["range_m"]
    if not after < 0.85 * before:
        raise AssertionError(f"the wheel made {before} m to {after} m; expected nearer")
    # A moment of its own where the path is double-clicked.
    browser.key("Escape")
    frame = FRAMES // 3
    browser.run(f"airtruthStudio.studio.show({frame})")
    page.rest()
    browser.click(*page.screen((320, 150)), count=2)
    browser.wait("document.querySelectorAll('.handle').length === 3")
    page.rest()
    browser.run("airtruthStudio.studio.show(0)")
    page.rest()
    page.add_flock()
    page.drag_handle(0, (420, 100))
    # The boxes in the page's pictures, at each moment of all paths.
    shown = {}
    state = page.state()
    for frame in sorted({round(time_s * 30) for key in ("intruder", "distractor") for table in state["scene"][key] for time_s, _ in moments_of(table)}):
        browser.run(f"airtruthStudio.studio.show({frame})")
        page.rest()
        shown[frame] = {one["id"]: one["box"] for one in page.boxes()}
    browser.key("s", CONTROL)
    browser.wait(f"{STORE}.state.saved")
    expect("console", browser.errors, [])
    server.end()
    saved = open(os.path.join(root, "flight.toml"), encoding="utf-8").read()
    expect("saved text", saved, state["text"])
    lost = [line for line in begun.splitlines() if line.startswith("#") and line not in saved.splitlines()]
    expect("lost comments", lost, [])
    scene = tomllib.loads(saved)
    expect("flyers", (len(scene["intruder"]), [one["kind"] for one in scene["distractor"]]), (2, ["bird"]))
    near("first handle", scene["intruder"][0]["seen"][0]["pixel"], (200, 120), 0.6)
    near("second handle", scene["intruder"][1]["seen"][0]["pixel"], (150, 200), 0.6)
    subprocess.run([airtruth, "--quiet", "render", "flight.toml", "--out", "rendered"], cwd=root, check=True, stderr=subprocess.DEVNULL)
    check_rendered(root, scene, shown)
    print(f"handles: two aircraft and a flock; {sum(map(len, shown.values()))} boxes of {len(shown)} frames as rendered")


def test_near_miss(airtruth, browser, root):
    """From a video to an aircraft at a pixel in a frame that then passes at a stated distance, and another distance."""
    flight(airtruth, root, has_encounter=False)
    server = Server(airtruth, root, "flight.mp4")
    page = Page(browser)
    page.open(server.address)
    expect("flyers of a begun scene", ("intruder" in page.state()["scene"], "Nothing flies yet" in "".join(words_of(browser, "studio-flyers .hint"))), (False, True))
    expect("what is guessed", words_of(browser, "studio-flyers .hint")[0].startswith("Guessed: the lens, the height, the own speed."), True)
    frame, pixel = 12, (250, 180)
    browser.run(f"airtruthStudio.studio.show({frame})")
    page.rest()
    browser.click(*page.screen(pixel), count=2)
    browser.wait("document.querySelector('studio-gallery dialog[open]')")
    browser.type("738")
    browser.wait("document.querySelectorAll('.card')[0]?.querySelector('select')?.value.includes('738')")
    browser.click_on(".card .choose")
    browser.wait("document.querySelectorAll('.handle').length === 2")
    page.rest()
    browser.click_on(".near-miss summary")
    for name, value in (("Pass at, m", "80"), ("Above, m", "10")):
        type_into(browser, name, value)
        browser.key("Enter")
    browser.run("(() => { const side = document.querySelector('.near-miss select'); side.value = 'left'; side.dispatchEvent(new Event('change')); })()")
    browser.wait(f"{STORE}.plan?.complete", 120)
    expect("what was typed stays", browser.run("[...document.querySelectorAll('.near-miss input')].map((e) => e.value).slice(0, 2)"), ["80", "10"])
    browser.click_on(".near-miss button")
    browser.wait(f"{STORE}.state.scene.intruder[0].encounter")
    page.rest()
    miss = lambda: browser.run(f"{STORE}.plan.tracks[0].cpa")
    near("the miss distance", [miss()["distance_m"], miss()["above_m"], miss()["right_m"] < 0], [80, 10, True], 0.1)
    expect("its field", browser.run("document.querySelector('input[aria-label=\"Miss distance, m\"]').value"), "80")
    browser.key("s", CONTROL)
    browser.wait(f"{STORE}.state.saved")
    subprocess.run([airtruth, "--quiet", "render", "flight.toml", "--out", "rendered"], cwd=root, check=True, stderr=subprocess.DEVNULL)
    with open(os.path.join(root, "rendered", "flight", "truth.jsonl"), encoding="utf-8") as file:
        x, y, width, height = next(one for one in map(json.loads, file) if one.get("frame") == frame)["intruders"][0]["exact_box_px"]
    near("the box in that frame", (x + width / 2, y + height / 2), pixel, BESIDE_PX)
    type_into(browser, "Miss distance, m", "30")
    browser.key("Enter")
    page.rest()
    near("another miss distance", [miss()["distance_m"], miss()["right_m"] < 0], [30, True], 0.3)
    middle = lambda: [(lambda x, y, w, h: (x + w / 2, y + h / 2))(*one["box"]) for one in page.boxes()]
    near("the box in that frame at another miss distance", middle()[0], pixel, BESIDE_PX)
    type_into(browser, "Miss distance, m", "5")
    expect("nearer than it is above", words_of(browser, ".expected")[0].startswith("Expected a number from 10.1 to 100000 m, since it is so far above"), True)
    browser.key("Escape")
    page.open(server.address)
    says_so = lambda: any(words.startswith("Its pixel at 0.4 s stays") for words in words_of(browser, "studio-flyer .hint"))
    type_into(browser, "Above, m", "20")
    browser.key("Enter")
    page.rest()
    near("at another height, after a reload", [miss()["distance_m"], miss()["above_m"], *middle()[0], says_so()], [30, 20, *pixel, True], BESIDE_PX)
    type_into(browser, "Course, °", "250")
    browser.key("Enter")
    page.rest()
    near("on another course", [miss()["distance_m"], miss()["right_m"] < 0, says_so()], [30, True, False], 0.3)
    # What is undone to the file's text is saved.
    for _ in range(3):
        browser.key("z", CONTROL)
        page.rest()
    expect("saved", page.state()["saved"], True)
    expect("console", browser.errors, [])
    server.end()
    print("near miss: at its pixel as rendered, past at the stated distance")


def check_rendered(root, scene, shown):
    """The truth of the render beside the handles and the boxes of the page."""
    with open(os.path.join(root, "rendered", "flight", "truth.jsonl"), encoding="utf-8") as file:
        frames = {one["frame"]: {intruder["id"]: intruder for intruder in one["intruders"]} for one in map(json.loads, file) if "intruders" in one}
    for k, table in enumerate(scene["intruder"]):
        in_frame = [one for one in moments_of(table) if 0 <= one[1][0] < WIDTH and 0 <= one[1][1] < HEIGHT]
        expect(f"moments of intruder-{k + 1} in the frame", len(in_frame) > 0, True)
        for time_s, pixel in in_frame:
            x, y, width, height = frames[round(time_s * 30)][table.get("id", f"intruder-{k + 1}")]["exact_box_px"]
            near(f"intruder-{k + 1} at {time_s} s", (x + width / 2, y + height / 2), pixel, BESIDE_PX)
    for frame, boxes in shown.items():
        for name, box in boxes.items():
            near(f"box of {name} in frame {frame}", frames[frame][name]["exact_box_px"], box, BESIDE_PX)


def words_of(browser, selector):
    """What is to be read now in all elements of a selector."""
    return browser.run(f"[...document.querySelectorAll({json.dumps(selector)})].filter((e) => e.checkVisibility()).map((e) => e.textContent)")


def press_button(browser, words):
    """A click of the mouse on a button by its words."""
    buttons = browser.run("[...document.querySelectorAll('button')].map((b) => b.checkVisibility() ? b.textContent : '')")
    browser.click_on("button", buttons.index(words))


def type_into(browser, name, text):
    """Another text in a number's field, not yet entered."""
    selector = f"input[aria-label={json.dumps(name, ensure_ascii=False)}]"
    browser.click_on(selector)
    browser.run(f"document.querySelector({json.dumps(selector)}).select()")
    browser.type(text)


def test_keys(airtruth, browser, root):
    """The keyboard after the mouse, numbers that are refused, and gestures that cannot be done."""
    flight(airtruth, root)
    server = Server(airtruth, root, "flight.mp4")
    page = Page(browser)
    page.open(server.address)
    value = lambda name: browser.run(f"document.querySelector('input[aria-label={json.dumps(name)}]').value")
    focus = lambda: browser.run("document.activeElement.tagName")
    # A path by its closest approach has no moments, and says so.
    page.select(0)
    for gesture in (lambda: browser.key("m"), lambda: browser.click(*page.screen((320, 150)), count=2)):
        gesture()
        browser.wait("[...document.querySelectorAll('.notice')].some((e) => e.textContent.includes('closest approach. “State by moments in the picture”'))")
        browser.click_on(".notice [aria-label=Dismiss]")
    # A number that is refused says what is expected, and goes back to its value: by Escape, by leaving, and by undo.
    speed = value("Speed, m/s")
    type_into(browser, "Speed, m/s", "0")
    expect("what is expected", words_of(browser, ".expected"), ["Expected a number from 0.001 to 10000 m/s."])
    browser.key("Escape")
    expect("after Escape", (value("Speed, m/s"), focus(), words_of(browser, ".expected")), (speed, "BODY", []))
    type_into(browser, "Speed, m/s", "-")
    browser.key("Tab")
    expect("after Tab", (value("Speed, m/s"), words_of(browser, ".expected")), (speed, []))
    browser.wait(f"[...document.querySelectorAll('.notice')].some((e) => e.textContent.includes('Speed: {speed} stays. Expected a number from 0.001 to 10000 m/s.'))")
    type_into(browser, "Speed, m/s", "47")
    browser.key("Enter")
    page.rest()
    for give_back in (lambda: browser.key("z", CONTROL), lambda: press_button(browser, "Undo")):
        type_into(browser, "Speed, m/s", "0")
        give_back()
        page.rest()
        expect("undo of what was refused", (value("Speed, m/s"), page.state()["undo"]), ("47", 1))
    type_into(browser, "Right, m", "55")
    browser.key("Escape")
    browser.key("2")
    page.rest()
    expect("keys after Escape", (browser.run(f"{STORE}.tab"), page.state()["undo"]), ("light", 1))
    # The Horizon is drawn over the camera's panel alone.
    horizon = "document.querySelector('.horizon').hasAttribute('hidden')"
    browser.key("3")
    browser.wait(f"!{horizon}")
    browser.key("1")
    browser.wait(horizon)
    # Space plays after a click on a button, and presses the one that was reached by Tab.
    press_button(browser, "Undo")
    page.rest()
    expect("undone", page.state()["undo"], 0)
    browser.key("z", CONTROL | SHIFT)
    page.rest()
    browser.run("for (let k = 2; k < 5; ++k) airtruthStudio.studio.edit([{ set: ['seed'], to: k }]); 1")
    page.rest()
    for press in (lambda: press_button(browser, "Undo"), lambda: browser.click_on(".tick"), lambda: browser.click_on(".tick input")):
        press()
        page.rest()
        before = (page.state()["undo"], browser.run(f"{STORE}.showsAircraft"))
        browser.key(" ")
        browser.wait(f"{STORE}.playing")
        browser.key(" ")
        browser.wait(f"!{STORE}.playing")
        page.rest()
        expect("after Space", (page.state()["undo"], browser.run(f"{STORE}.showsAircraft")), before)
    browser.click_on("studio-time .strip input")
    page.rest()
    frame = browser.run(f"{STORE}.frame")
    browser.key("ArrowLeft", SHIFT)
    expect("ten frames back after a click on the thumbnails", browser.run(f"{STORE}.frame"), frame - 10)
    for reached, pressed in (("button", "state.undo"), (".tick input", "showsAircraft")):
        browser.run(f"document.querySelector('studio-tools {reached}').focus()")
        before = browser.run(f"{STORE}.{pressed}")
        browser.key(" ")
        page.rest()
        expect(f"Space on a {reached} that was reached by keys", browser.run(f"{STORE}.{pressed}") != before, True)
    # What is new flies level.
    browser.wait(f"{STORE}.plan?.complete", 120)
    page.add("738")
    heights = browser.run(f"{STORE}.plan.tracks[1].ned.filter(Boolean).map((ned) => -ned[2])")
    near("its heights", [min(heights)], [max(heights)], 1.5)
    # Delete on a heading, whichever way it got the focus.
    flyers = lambda: len(page.state()["scene"].get("intruder", []))
    for reach in (lambda: browser.click_on("button.flyer", 1), lambda: browser.run("document.querySelectorAll('button.flyer')[1].focus()")):
        expect("flyers", flyers(), 2)
        reach()
        page.rest()
        browser.key("Delete")
        page.rest()
        expect("flyers after Delete", flyers(), 1)
        browser.key("z", CONTROL)
        page.rest()
    page.select(1)
    browser.run("document.querySelector('.handle').focus()")
    browser.key("Delete")
    page.rest()
    expect("of two moments", (flyers(), "at least two moments" in "".join(words_of(browser, ".notice"))), (2, True))
    # Rows stay where they are when the checks say something.
    rows = lambda: browser.run("[...document.querySelectorAll('studio-flyer input, studio-flyer button')].map((e) => e.getBoundingClientRect().top)")
    before = rows()
    checks = "document.querySelectorAll('.flyers .selected .checks li').length"
    expect("checks", browser.run(checks), 0)
    type_into(browser, "Size of moment 2", "9000")
    browser.key("Enter")
    browser.wait(checks)
    page.rest()
    expect("rows under a warning", rows(), before)
    browser.key("z", CONTROL)
    page.rest()
    # A moment stays between those beside it.
    times = [time_s for time_s, _ in moments_of(page.state()["scene"]["intruder"][1])]
    type_into(browser, "Time of moment 2, s", "0")
    browser.key("Enter")
    page.rest()
    expect("a time before the moment before", words_of(browser, ".expected"), [f"Expected a number from {round(times[0] + 1 / 30, 3)} to {round((FRAMES - 1) / 30, 3)} s, between the moments beside it."])
    browser.key("Escape")
    # Its frame comes with a time that is left by Tab.
    time_s = round(times[1] - 5 / 30, 3)
    type_into(browser, "Time of moment 2, s", str(time_s))
    browser.key("Tab")
    page.rest()
    expect("the frame of a time that was entered", browser.run(f"{STORE}.frame"), round(30 * time_s))
    square = browser.middle("studio-height .moment", 1)
    browser.drag(square, (square[0] - 900, square[1]))
    page.rest()
    expect("times by a drag", moments_of(page.state()["scene"]["intruder"][1])[1][0] > times[0], True)
    expect("problem", page.state()["problem"], None)
    # A handle beyond the edge of the panel stays within reach, and says so.
    begin = browser.middle(".handle .ring", 0)
    frame = browser.run("(() => { const b = document.querySelector('studio-picture').getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; })()")
    browser.drag(begin, (frame[2] + 150, frame[1] + 200))
    page.rest()
    ring = browser.middle(".handle.rim .ring")
    expect("the handle in the panel", frame[0] < ring[0] < frame[2] and frame[1] < ring[1] < frame[3], True)
    expect("words of the handle", "outside the picture" in browser.run("document.querySelector('.handle text').textContent"), True)
    page.drag_handle(0, (200, 120))
    near("dragged back", moments_of(page.state()["scene"]["intruder"][1])[0][1], (200, 120), 0.6)
    browser.mouse("mouseMoved", *page.screen((100, 300)))
    browser.wait("!document.querySelector('.pixel').hidden")
    near("the pointer's pixel", [float(v) for v in words_of(browser, ".pixel")[0].removesuffix(" px").split(", ")], (100, 300), 1)
    # Labels: of an aircraft at the edges of the picture, and of handles that are near one another.
    for first, second in (((625, 100), (600, 120)), ((20, 20), (60, 30)), ((330, 465), (300, 470)), ((320, 200), (335, 200))):
        change = [{"set": ["intruder", 1, "seen", k, "pixel"], "to": place} for k, place in enumerate((first, second))]
        browser.run(f"airtruthStudio.studio.edit({json.dumps(change)}); airtruthStudio.studio.show(0)")
        for size in ((1024, 700), (1600, 1000)):
            browser.looks(size)
            page.rest()
            browser.wait(f"!{LABELS}.length", 5)
    # Directions of the world, in a picture as small as that of a narrow window.
    browser.run("airtruthStudio.studio.store.put({ showsMotion: true, look: { x: 0, y: 0, scale: 0.6 } })")
    browser.wait("document.querySelectorAll('.motion text').length > 5")
    expect("names of directions on each other", browser.run(MEETING), [])
    browser.run("airtruthStudio.studio.store.put({ showsMotion: false, look: null })")
    expect("time in view", words_of(browser, ".in-view")[1].startswith("In view for "), True)
    # A double click adds a flyer, and replaces none for which the gallery was opened before.
    page.select(0)
    press_button(browser, "Change …")
    browser.wait("document.querySelector('studio-gallery dialog[open]')")
    browser.key("Escape")
    browser.wait(f"!{STORE}.dialog")
    browser.run("airtruthStudio.studio.select(null)")
    before = flyers()
    browser.click(*page.screen((100, 300)), count=2)
    browser.wait("document.querySelectorAll('.card').length")
    browser.click_on(".card .choose")
    page.rest()
    expect("flyers after a double click", flyers(), before + 1)
    # The gallery: by class, and as large with few hits as with all.
    browser.key("Escape")
    browser.key("n")
    browser.wait("document.querySelectorAll('.card').length")
    natural = browser.middle(".natural button")
    browser.type("airliner")
    browser.wait("document.querySelectorAll('.card').length && [...document.querySelectorAll('.card')].every((card) => card.textContent.includes('airliner'))")
    browser.run("document.querySelector('studio-gallery input').select()")
    browser.type("no such type")
    browser.wait("!document.querySelectorAll('.card').length")
    near("buttons of the gallery", browser.middle(".natural button"), natural, 0.5)
    undo = page.state()["undo"]
    browser.key("z", CONTROL)
    page.rest()
    expect("undo while the gallery is open", page.state()["undo"], undo)
    expect("console", browser.errors, [])
    server.end()
    print("keys: of the page after the mouse, of a button after Tab; what is refused is said and given back")


def test_film(airtruth, browser, root):
    """The rendered film and the original show one frame, and the boxes are those of it."""
    first, count = 20, 24
    os.mkdir(os.path.join(root, "clip"))
    for number in range(60):
        numbered_clip.write_png(os.path.join(root, "clip", f"{number:04}.png"), number)
    subprocess.run(["ffmpeg", "-v", "error", "-framerate", "30", "-i", "clip/%04d.png", "-pix_fmt", "yuv420p", "-crf", "12", "numbered.mp4"], cwd=root, check=True)
    write(os.path.join(root, "film.toml"), f"""[background]
video = "numbered.mp4"
first_frame = {first}
frame_count = {count}
[lens]
vertical_fov_deg = 60
[camera]
position_ned_m = [0, 0, -150]
velocity_ned_mps = [20, 0, 0]
attitude_yaw_pitch_roll_deg = [0, 0, 0]
[motion]
model = "none"
[[intruder]]
aircraft = "738/738-ANA"
[[intruder.seen]]
time_s = 0
pixel = [100, 180]
range_m = 250
[[intruder.seen]]
time_s = 0.7
pixel = [260, 180]
range_m = 250
""")
    server = Server(airtruth, root, "film.toml")
    page = Page(browser)
    browser.open(server.address)
    browser.wait(f"window.airtruthStudio && {STORE}.state")
    expect("problem", page.state()["problem"], None)
    page.rest()
    browser.key("r")
    expect("where it will be", "will be in out/film, as" in words_of(browser, "studio-render .hint")[0], True)
    press_button(browser, "Render the clip")
    browser.wait(f"{STORE}.film && document.querySelectorAll('studio-render video')[1].readyState >= 2", 120)
    browser.run(numbered_clip.READ_NUMBER + """
      window.numbersShown = () => [...document.querySelectorAll('studio-render video')].map(numberOn);
      window.boxShown = () => { const r = document.querySelector('.films rect'); return r && ['x', 'y', 'width', 'height'].map((name) => Number(r.getAttribute(name))); }; 1""")
    browser.click_on("studio-render .tick input")
    both = lambda frame: browser.wait(f"String(numbersShown()) === '{first + frame},{first + frame}'", 20)
    truth = {frame: boxes[0]["box"] for frame, boxes in browser.run(f"{STORE}.film.boxes")}

    def check(frame):
        both(frame)
        x, y, width, height = truth[frame]
        browser.wait(f"boxShown() && {[x - 2, y - 2, width + 4, height + 4]}.every((v, k) => Math.abs(v - boxShown()[k]) < 0.01)", 20)

    def go_to(frame):
        browser.run(f"(() => {{ const time = document.querySelector('[aria-label=\"Frame of the film\"]'); time.value = {frame}; time.dispatchEvent(new Event('input')); }})()")
        check(frame)

    check(0)
    for frame in (7, 8, count - 1, 3):
        go_to(frame)
    # Between two frames the one before is on the screen.
    browser.run(f"document.querySelectorAll('studio-render video')[1].currentTime = {5.9 / 30}; 1")
    check(5)
    press_button(browser, "Play")
    browser.wait("document.querySelectorAll('studio-render video')[1].currentTime > 0.4")
    if browser.run("!document.querySelectorAll('studio-render video')[1].paused"):
        press_button(browser, "Pause")
    browser.wait("(() => { const [a, b] = numbersShown(); return a === b && !document.querySelector('studio-render video').seeking; })()", 20)
    check(browser.run("numbersShown()")[1] - first)
    # Opened again, and of another film, it is at the frame of the picture, wherever it was.
    browser.key("Escape")
    browser.wait(f"{STORE}.dialog === null")
    browser.run("airtruthStudio.studio.show(11)")
    page.rest()
    browser.key("r")
    check(11)
    go_to(0)
    browser.run(f"window.firstFilm = {STORE}.film; 1")
    press_button(browser, "Render the clip")
    browser.wait(f"{STORE}.film !== firstFilm && !{STORE}.busy && document.querySelectorAll('studio-render video')[1].readyState >= 2", 120)
    check(11)
    expect("console", browser.errors, [])
    server.end()
    print(f"film: both at one frame, from frame {first} of the clip on, and the boxes of that frame")


def test_log(airtruth, browser, root):
    """The camera's panel has what a log gives at the first frame, and another yaw keeps the log's pitch and roll."""
    flight(airtruth, root, frames=10, width=320, height=240, has_encounter=False)
    # 20 m/s towards north: a degree of latitude is 111,172 m there.
    rows = [f"{k / 10},{47 + 2 * k / 111172:.9f},8,500,80,30,5,10" for k in range(21)]
    write(os.path.join(root, "log.csv"), "\n".join(["time_s,latitude_deg,longitude_deg,altitude_m,height_m,yaw_deg,pitch_deg,roll_deg", *rows, ""]))
    write(os.path.join(root, "log.toml"), '[background]\nvideo = "flight.mp4"\n[lens]\nvertical_fov_deg = 60\n[camera]\nlog = "log.csv"\nlog_offset_s = 0.5\n')
    server = Server(airtruth, root, "log.toml")
    page = Page(browser)
    page.open(server.address)
    browser.key("3")
    page.rest()
    shown = lambda: [float(text) for text in browser.run("[...document.querySelectorAll('studio-camera input')].map((e) => e.value)")]
    near("view, yaw, pitch, roll, height, north, east, down", shown(), (60, 30, 5, 10, 80, 20, 0, 0), 0.05)
    expect("whose they are", any("by the log" in words for words in words_of(browser, "studio-camera .hint")), True)
    type_into(browser, "Yaw, °", "31")
    browser.key("Enter")
    page.rest()
    expect("attitude after another yaw", page.state()["scene"]["camera"]["attitude_yaw_pitch_roll_deg"], [31, 5, 10])
    near("height and speed after it", shown()[4:], (80, 20, 0, 0), 0.05)
    server.end()
    print("log: its attitude, height and speed in the panel; another yaw keeps pitch and roll")


def test_broken(airtruth, browser, root):
    """A file that is no scene, one that becomes so, and no connection."""
    flight(airtruth, root, frames=10, width=320, height=240)
    write(os.path.join(root, "bad.toml"), "hello this is text\n")
    server = Server(airtruth, root, "bad.toml")
    page = Page(browser)
    browser.open(server.address)
    browser.wait(f"window.airtruthStudio && {STORE}.state")
    time.sleep(0.3)
    expect("the text of what is no scene", ("hello this is text" in words_of(browser, "studio-text pre")[0], "is not TOML" in "".join(words_of(browser, ".notice.error"))), (True, True))
    for key in ("n", "m", "[", " ", "1", "2", "3", "4", "Delete"):
        browser.key(key)
    expect("speed", browser.run("document.querySelector('studio-time select').value"), "1")
    expect("dialog and playing", browser.run(f"[{STORE}.dialog, {STORE}.playing]"), [None, False])
    expect("console", browser.errors, [])
    browser.open("about:blank")  # a page would look for its server
    server.end()
    server = Server(airtruth, root, "flight.mp4")
    file = os.path.join(root, "flight.toml")
    # A ninth page says why it has no connection, and has one when another is closed.
    others = [web_socket(server) for _ in range(8)]
    browser.open(server.address)
    browser.wait("[...document.querySelectorAll('.notice.error')].some((e) => e.checkVisibility() && e.textContent.includes('at most eight pages'))")
    for other in others:
        other.close()
    page.rest()
    browser.wait("![...document.querySelectorAll('.notice.error')].some((e) => e.checkVisibility())")
    browser.errors[:] = [error for error in browser.errors if "WebSocket" not in error]
    good = page.state()["text"]
    opacity = "getComputedStyle(document.querySelector('studio-plan svg')).opacity"
    for broken in (good.replace("[light]", "[light]\nsun_elevaton_deg = 1"), "[[["):
        write(file, broken)
        browser.wait(f"{STORE}.state.problem && {opacity} < 1")
        expect("the words beside the name", words_of(browser, ".saved"), ["has an error"])
        expect("flyers that are still to be seen", browser.run(f"{STORE}.state.scene.intruder.length"), 1)
        write(file, good)
        browser.wait(f"!{STORE}.state.problem && {opacity} === '1'")
        page.rest()
    expect("console", browser.errors, [])
    # Without a connection nothing looks as if it could be saved, and the key says so.
    browser.run("airtruthStudio.studio.edit([{ set: ['seed'], to: 5 }])")
    page.rest()
    server.end()
    browser.wait(f"!{STORE}.connected")
    save = "[...document.querySelectorAll('studio-tools button')].find((b) => b.textContent === 'Save').disabled"
    browser.wait(save)
    browser.key("s", CONTROL)
    browser.wait("[...document.querySelectorAll('.notice')].some((e) => e.textContent.includes('Not done'))")
    browser.run("airtruthStudio.studio.edit([{ set: ['seed'], to: 6 }])")
    browser.wait("[...document.querySelectorAll('.notice.error')].some((e) => e.textContent.includes('what waits (1) is lost'))")
    print("broken: a text that is no scene is shown as one; without a connection it is said what is done and what is not")


def test_edits(airtruth, browser, root):
    """Undo to the beginning, other programs, reloads and lost connections."""
    flight(airtruth, root)
    server = Server(airtruth, root, "flight.mp4")
    file = os.path.join(root, "flight.toml")
    page = Page(browser)
    page.open(server.address)
    begun = page.state()["text"]
    page.add("c172")
    page.drag_handle(0, (300, 200))
    page.drag_handle(1, (400, 220))
    expect("steps of undo", page.state()["undo"], 3)
    moved = page.state()["text"]
    # Keys: a handle by arrows, a moment away and back.
    browser.run("document.querySelector('.handle').focus()")
    x = page.state()["scene"]["intruder"][1]["seen"][0]["pixel"][0]
    browser.key("ArrowRight", SHIFT)
    page.rest()
    near("arrow key", [page.state()["scene"]["intruder"][1]["seen"][0]["pixel"][0]], [x + 10], 0.05)
    for _ in range(4):
        browser.key("z", CONTROL)
        page.rest()
    expect("undone to the beginning", page.state()["text"], begun)
    for _ in range(3):
        browser.key("z", CONTROL | SHIFT)
        page.rest()
    expect("done again", page.state()["text"], moved)
    # A reload keeps all, and so does a connection that is lost in the middle of a drag.
    page.open(server.address)
    expect("after a reload", page.state()["text"], moved)
    page.select(1)
    begin = browser.middle(".handle .ring", 0)
    browser.mouse("mouseMoved", *begin)
    browser.mouse("mousePressed", *begin, button="left", buttons=1, clickCount=1)
    for k in range(1, 21):
        browser.mouse("mouseMoved", begin[0] + 4 * k, begin[1] + k, button="left", buttons=1)
        if k == 10:
            browser.run("airtruthStudio.studio.connection.socket.close()")
    browser.mouse("mouseReleased", begin[0] + 80, begin[1] + 20, button="left", clickCount=1)
    page.rest()
    near("a drag over a lost connection", browser.middle(".handle .ring", 0), (begin[0] + 80, begin[1] + 20), 1)
    # What was not answered when the page ended is done by the next one.
    browser.run("airtruthStudio.studio.edit([{ set: ['seed'], to: 77 }]); airtruthStudio.studio.edit([{ set: ['light', 'sun_elevation_deg'], to: 33 }]); location.reload(); 1")
    browser.wait(f"window.airtruthStudio && {STORE}.state && {STORE}.state.scene.seed === 77 && {STORE}.state.scene.light.sun_elevation_deg === 33")
    page.rest()
    # A crash of the server: the journal has it.
    kept = page.state()["text"]
    server.end(signal.SIGKILL)
    server = Server(airtruth, root, "flight.mp4")
    page.open(server.address)
    expect("after a crash of the server", page.state()["text"], kept)
    browser.key("s", CONTROL)
    browser.wait(f"{STORE}.state.saved")
    # Another program changes the file: taken where nothing is unsaved, else offered.
    page.rest()
    write(file, kept + "\n# by hand\n")
    browser.wait(f"{STORE}.state.text.endsWith('# by hand\\n')")
    page.rest()
    # What waited is not done upon another text, and that is said.
    server.end()
    browser.wait(f"!{STORE}.connected")
    browser.run("airtruthStudio.studio.edit([{ remove: ['intruder', 1] }]); airtruthStudio.studio.edit([{ set: ['seed'], to: 80 }]); 1")
    other = kept + "\n# while no studio ran\n"
    write(file, other)
    server = Server(airtruth, root, "flight.mp4", server.port)
    page.open(server.address)
    browser.wait(f"{STORE}.notices.some((one) => one.line.includes('2 changes'))")
    expect("edits made upon another text", page.state()["text"], other)
    browser.run("airtruthStudio.studio.edit([{ set: ['seed'], to: 78 }])")
    page.rest()
    write(file, kept + "\n# again\n")
    browser.wait("[...document.querySelectorAll('.notice button')].some((b) => b.textContent === 'Keep mine' && b.checkVisibility())")
    browser.click_on(".notice.warning button", 1)
    browser.key("s", CONTROL)
    browser.wait(f"{STORE}.state.saved")
    expect("mine was kept", tomllib.loads(open(file, encoding="utf-8").read())["seed"], 78)
    browser.run("airtruthStudio.studio.edit([{ set: ['seed'], to: 79 }])")
    page.rest()
    write(file, kept + "\n# theirs\n")
    browser.wait("[...document.querySelectorAll('.notice button')].some((b) => b.textContent === 'Take the file' && b.checkVisibility())")
    browser.click_on(".notice.warning button", 0)
    browser.wait(f"{STORE}.state.text.endsWith('# theirs\\n')")
    # Another clip in the file is opened.
    flight(airtruth, root, frames=20, width=320, height=240, has_encounter=False, name="other.mp4")
    write(file, kept.replace("flight.mp4", "other.mp4"))
    browser.wait(f"{STORE}.clip.video === 'other.mp4' && {STORE}.clip.frames === 20 && document.querySelector('.thumbs img').src.includes('other')")
    page.rest()
    expect("the picture's size", browser.run("(({ width, height }) => [width, height])(airtruthStudio.studio.pictures.canvas)"), [320, 240])
    expect("console", complaints(browser), [])
    server.end()
    print("edits: undo to the beginning; reload, lost connection, crash and another program lose nothing")


def write(file, text):
    with open(file + ".new", "w", encoding="utf-8") as out:
        out.write(text)
    os.replace(file + ".new", file)


def test_latency(airtruth, browser, root, drags):
    flight(airtruth, root, frames=60, width=1280, height=960)
    server = Server(airtruth, root, "flight.mp4")
    page = Page(browser)
    page.open(server.address)
    page.add("738")
    browser.wait(f"{STORE}.progress === null")
    page.rest()
    chance = random.Random(1)
    for _ in range(drags):
        begin = browser.middle(".handle .ring", 0)
        browser.drag(begin, page.screen((chance.uniform(200, 1000), chance.uniform(150, 600))), 6, 1 / 60)
        page.rest()
    latencies = sorted(browser.run("airtruthStudio.latencies_ms"))
    part = lambda share: latencies[min(len(latencies) - 1, int(share * len(latencies)))]
    expect("console", browser.errors, [])
    server.end()
    print(f"latency of {drags} drags at 1280x960, {len(latencies)} pictures: median {part(0.5):.0f} ms, 95 % {part(0.95):.0f} ms, most {latencies[-1]:.0f} ms; load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


def test_layout(airtruth, browser, root):
    flight(airtruth, root, frames=20, width=320, height=240)
    server = Server(airtruth, root, "flight.mp4")
    page = Page(browser)
    page.open(server.address)
    page.add("738")
    page.add_flock()
    browser.run("airtruthStudio.studio.edit([{ set: ['intruder', 0, 'id'], to: 'the_aircraft_that_comes_from_the_right_with_a_very_long_name' }, { set: ['intruder', 1, 'seen', 0, 'range_m'], to: 12345.6 }])")
    page.rest()
    states = [("flyer by approach", "airtruthStudio.studio.select(['intruder', 0])"), ("flyer by moments", "airtruthStudio.studio.select(['intruder', 1], 0)"), ("flock", "airtruthStudio.studio.select(['distractor', 0])"),
              *((tab, f"airtruthStudio.studio.store.put({{ tab: '{tab}' }})") for tab in ("light", "camera", "text")),
              *((dialog, f"airtruthStudio.studio.store.put({{ dialog: '{dialog}', tab: 'flyers' }})") for dialog in ("help", "gallery", "render"))]
    faults = []
    for size in ((1024, 768), (1600, 1000), (3840, 2160)):
        for is_dark in (False, True):
            browser.looks(size, is_dark)
            for name, script in states:
                browser.run(f"{script}; 1")
                time.sleep(0.15)
                page.rest()
                found = browser.run(LOOK)
                for _ in range(10):  # a page may still be drawing on a busy machine: what stays is a fault
                    if not found:
                        break
                    time.sleep(0.2)
                    found = browser.run(LOOK)
                for pseudo in (["hover"], ["focus", "focus-visible"], ["hover", "active"]) if size[0] == 1600 else ():
                    browser.press("button, select", pseudo)
                    found += [f"{fault} under {pseudo[0]}" for fault in browser.run(LOOK) if "faint" in fault]
                    browser.press("button, select", [])
                faults += [f"{size[0]} px, {'dark' if is_dark else 'light'}, {name}: {fault}" for fault in found]
            browser.run("airtruthStudio.studio.store.put({ dialog: null, tab: 'flyers' }); 1")
    browser.looks((390, 844))
    expect("least width, and how far a phone scrolls", browser.run("(scrollTo(768, 0), [document.querySelector('airtruth-studio').offsetWidth, scrollX])"), [768, 768 - 390])
    browser.looks((1600, 1000))
    expect("console", browser.errors, [])
    server.end()
    if faults:
        raise AssertionError("\n  ".join([f"{len(faults)} faults of layout", *faults[:20]]))
    print(f"layout: {len(states)} states at 3 sizes, dark and light: no text cut, on another or faint; everything has a name")


KEYS = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", " ", "[", "]", "m", "Delete", "1", "2", "3", "4", "+", "-", "f", "n", "?", "Escape", "Enter", "Tab", "r"]


def test_monkey(airtruth, browser, root, seconds):
    """Anything, anywhere. What is on the page in the end is what the server has, and a reload changes nothing."""
    flight(airtruth, root, frames=20, width=320, height=240)
    server = Server(airtruth, root, "flight.mp4")
    page = Page(browser)
    page.open(server.address)
    page.add("c172")
    page.add_flock()
    chance = random.Random(os.environ.get("AIRTRUTH_SEED", "1"))
    heap, nodes = browser.memory()
    resident = server.memory()
    until = time.monotonic() + seconds
    size, steps, reloads = (1600, 1000), 0, 0
    place = lambda: (chance.uniform(0, size[0]), chance.uniform(0, size[1]))
    while time.monotonic() < until:
        steps += 1
        what = chance.random()
        if what < 0.25:
            browser.click(*place(), count=chance.choice((1, 1, 1, 2)))
        elif what < 0.5:
            begin = place()
            if chance.random() < 0.6:
                try:
                    begin = browser.middle(".handle, .grab", chance.randrange(4))
                except RuntimeError:
                    pass  # there are fewer
            browser.drag(begin, place(), chance.randrange(1, 8), 0.005)
        elif what < 0.6:
            browser.wheel(*place(), chance.uniform(-400, 400))
        elif what < 0.9:
            browser.key(chance.choice(KEYS), SHIFT if chance.random() < 0.1 else 0)
        elif what < 0.96:
            browser.key(chance.choice("zzzy"), CONTROL)
        elif what < 0.975:
            browser.key("s", CONTROL)
        elif what < 0.985:
            size = chance.choice(((1024, 768), (1600, 1000), (2200, 1300)))
            browser.looks(size, chance.random() < 0.5)
        elif what < 0.99:
            browser.run("airtruthStudio.studio.connection.socket?.close()")
        elif time.monotonic() < until - seconds / 2:  # one page lives for the second half: does its memory grow?
            reloads += 1
            reload_and_compare(browser, page, server.address)
    browser.key("Escape")
    aged, aged_nodes = browser.memory()
    reload_and_compare(browser, page, server.address)
    text = page.state()["text"]
    page.open(server.address)
    expect("after the last reload", page.state()["text"], text)
    # All of it can be taken back and done again.
    undo = page.state()["undo"]
    browser.run(f"(async () => {{ for (let k = 0; k < {undo}; ++k) await airtruthStudio.studio.undo(); }})()")
    expect("undone", page.state()["undo"], 0)
    browser.run(f"(async () => {{ for (let k = 0; k < {undo}; ++k) await airtruthStudio.studio.redo(); }})()")
    page.rest()
    expect("done again", page.state()["text"], text)
    print(f"monkey: {steps} steps in {seconds:.0f} s, {reloads} reloads, {undo} steps of undo; heap {heap >> 20} -> {aged >> 20} MiB, "
          f"{nodes:.0f} -> {aged_nodes:.0f} nodes, server {resident >> 20} -> {server.memory() >> 20} MiB")
    expect("console", complaints(browser), [])
    if aged > heap + HEAP_GROWTH or server.memory() > resident + SERVER_GROWTH:
        raise AssertionError("memory grows")
    server.end()


def reload_and_compare(browser, page, address):
    """No edit that the page had taken is lost with it."""
    unsent, wholes = browser.run("[airtruthStudio.studio.edits.unsent().edits.map((one) => one.changes), airtruthStudio.studio.wholes]")
    page.open(address)
    scene = page.state()["scene"]
    last = {json.dumps(change["set"]): change for changes in unsent for change in changes if "set" in change}
    if wholes or any("set" not in change for changes in unsent for change in changes):
        return  # an undo was under way, or tables moved
    for change in last.values():
        value = scene
        for key in change["set"]:
            value = value[key]
        expect(f"{change['set']} after a reload", value, change["to"])


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("airtruth")
    arguments.add_argument("source")
    arguments.add_argument("--drags", type=int, default=20)
    arguments.add_argument("--monkey", type=float, default=20, help="seconds")
    arguments.add_argument("--only")
    arguments = arguments.parse_args()
    airtruth = os.path.abspath(arguments.airtruth)
    program = browser_or_skip("studio_test")
    tests = {"model": lambda _, *given: test_model(given[0], arguments.source, given[1]), "handles": test_handles, "near-miss": test_near_miss, "keys": test_keys, "film": test_film, "log": test_log, "broken": test_broken, "edits": test_edits, "layout": test_layout,
             "latency": lambda *given: test_latency(*given, arguments.drags), "monkey": lambda *given: test_monkey(*given, arguments.monkey)}
    for name, test in tests.items():
        if arguments.only not in (None, name):
            continue
        with tempfile.TemporaryDirectory(prefix="airtruth_studio_", ignore_cleanup_errors=True) as root:
            with Browser(program, os.path.join(root, ".profile")) as browser:
                test(airtruth, browser, root)


if __name__ == "__main__":
    main()
