# SPDX-License-Identifier: Apache-2.0
"""The shipped TraX clients against an evaluator written here from the protocol's text: python3 trax_protocol_test.py CLIENTS EXAMPLE

Each client follows a block over standard streams, over descriptors (TRAX_IN, TRAX_OUT) and over a socket (TRAX_SOCKET), in version 3 and,
with several objects that come and go, in version 4; with pictures of every kind. Then the Python client's PNG reader meets pictures of
every colour type, depth and filter, whose samples are known, and both clients meet requests that the protocol does not allow.
"""

import base64
import functools
import http.server
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

WIDTH, HEIGHT, FRAMES = 96, 72, 4
PNG_TYPES = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # colour type: samples a pixel


def fail(what):
    sys.exit(f"trax_protocol_test: {what}")


def place(frame, start=(20, 15)):
    return start[0] + 3 * frame, start[1] + 2 * frame, 14, 10


def grey(frame, column, row):
    for x, y, w, h in (place(frame), place(frame, (50, 30))):
        if x <= column < x + w and y <= row < y + h:
            return 40 + 90 * ((column - x) // 3 + (row - y) // 3 & 1) + (x > 40) * (column - x)
    return 150 + (column * 7 + row * 3) % 23


def samples(frame):
    return bytes(grey(frame, c, r) for r in range(HEIGHT) for c in range(WIDTH))


def filtered(kind, row, above, step):
    """A row as ISO 15948, section 9, has it."""
    out = bytearray()
    for i, value in enumerate(row):
        a, b, c = (row[i - step] if i >= step else 0), above[i], (above[i - step] if i >= step else 0)
        p = a + b - c
        paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
        out.append(value - (0, a, b, (a + b) // 2, paeth)[kind] & 255)
    return bytes((kind,)) + bytes(out)


def png(width, height, colour, depth, rows, palette=b""):
    """rows: packed as the format has them; filters 0 to 4 in turn."""
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    step = max(1, PNG_TYPES[colour] * depth // 8)
    above = [bytes(len(rows[0]))] + rows[:-1]
    body = b"".join(filtered(i % 5, row, up, step) for i, (row, up) in enumerate(zip(rows, above)))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0))
            + (chunk(b"PLTE", palette) if palette else b"") + chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b""))


def grey_png(frame):
    data = samples(frame)
    return png(WIDTH, HEIGHT, 0, 8, [data[r * WIDTH:(r + 1) * WIDTH] for r in range(HEIGHT)])


class Evaluator:
    """Starts a tracker over a transport, and speaks with it."""

    def __init__(self, command, transport, environment=None):
        environment = {**os.environ, **(environment or {})}
        given, listener = (), None
        if transport == "socket":
            listener = socket.create_server(("127.0.0.1", 0))
            listener.settimeout(30)
            environment["TRAX_SOCKET"] = str(listener.getsockname()[1])
        elif transport == "descriptors":
            (take, tell), (hear, say) = os.pipe(), os.pipe()
            given = (take, say)
            environment.update(TRAX_IN=str(take), TRAX_OUT=str(say))
        is_standard = transport == "standard"
        self.process = subprocess.Popen(command, env=environment, pass_fds=given, stdin=subprocess.PIPE if is_standard else subprocess.DEVNULL,
                                        stdout=subprocess.PIPE if is_standard else subprocess.DEVNULL, stderr=subprocess.PIPE)
        if listener:
            self._socket = listener.accept()[0]
            listener.close()
            self._out, self._in = self._socket.makefile("wb"), self._socket.makefile("rb")
        elif given:
            self._out, self._in = os.fdopen(tell, "wb"), os.fdopen(hear, "rb")
            for file in given:
                os.close(file)
        else:
            self._out, self._in = self.process.stdin, self.process.stdout
        self.hello = self.next("hello")

    def say(self, *lines):
        self._out.write("".join(f"@@TRAX:{line}\n" for line in lines).encode())
        self._out.flush()

    def next(self, kind):
        for line in self._in:
            if line.startswith(b"@@TRAX:"):
                if not line.startswith(b"@@TRAX:" + kind.encode()):
                    fail(f"{line!r}; expected {kind}")
                return line.decode().rstrip("\n")
        fail(f"no {kind}: {self.process.stderr.read().decode()}")

    def boxes(self, count=1):
        return [tuple(map(float, re.match(r'@@TRAX:state "([^"]*)" "confidence=', self.next("state"))[1].split(","))) for _ in range(count)]

    def end(self, code=0):
        if code == 0:
            self.say("quit")
        noise = self.process.communicate(timeout=30)[1].decode() if self._in is not self.process.stdout else self.process.stderr.read().decode()
        if self.process.wait(30) != code:
            fail(f"ended with {self.process.returncode}, expected {code}: {noise}")
        self._out.close()
        self._in.close()
        return noise


def kinds_of_pictures(root, server_port):
    """name: text of a frame's picture in a message."""
    encoded = lambda data: base64.b64encode(data).decode()
    path = lambda frame: f"{root}/{frame}.png"
    text = {
        "path": lambda f: "file://" + path(f),
        "bare path": path,
        "rgb": lambda f: f"image:{WIDTH};{HEIGHT};rgb;" + encoded(bytes(v for s in samples(f) for v in (s, s, s))),
        "gray8": lambda f: f"image:{WIDTH};{HEIGHT};gray8;" + encoded(samples(f)),
        "gray16": lambda f: f"image:{WIDTH};{HEIGHT};gray16;" + encoded(b"".join(struct.pack("<H", 256 * s + 17) for s in samples(f))),
        "data": lambda f: "data:image/png;" + encoded(grey_png(f)),
        "data, RFC 2397": lambda f: "data:image/png;base64," + encoded(grey_png(f)),
        "data, semicolons": lambda f: "data:image/png;base64;" + encoded(grey_png(f)),
        "url": lambda f: f"http://127.0.0.1:{server_port}/{f}.png"}
    for frame in range(FRAMES):
        with open(path(frame), "wb") as file:
            file.write(grey_png(frame))
    if shutil.which("ffmpeg"):
        for frame in range(FRAMES):
            subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", path(frame), "-q:v", "1", f"{root}/{frame}.jpg"], check=True)
        text["JPEG by path"] = lambda f: f"file://{root}/{f}.jpg"
        text["JPEG data"] = lambda f: "data:image/jpeg;" + encoded(open(f"{root}/{f}.jpg", "rb").read())
    else:
        print("without ffmpeg no JPEGs")
    return text


def follow_one(command, transport, picture, what, environment=None):
    """Version 3, begun twice."""
    tracker = Evaluator(command, transport, environment)
    if '"trax.version=3"' not in tracker.hello:
        fail(f"{what}: {tracker.hello}")
    for _ in range(2):
        tracker.say(f'initialize "{picture(0)}" "{",".join(map(str, place(0)))}" "some.key=a value"')
        for frame in range(FRAMES):
            if frame:
                tracker.say(f'FRAME "{picture(frame)}" time={frame}')
            if (found := tracker.boxes()) != [place(frame)]:
                fail(f"{what}, {transport}, frame {frame}: {found}; expected {place(frame)}")
    tracker.end()


def follow_several(command, transport, picture, what):
    """Version 4: one object, a second from frame 2 on, then both let go and the second alone."""
    tracker = Evaluator(command, transport)
    if '"trax.version=4"' not in tracker.hello or '"trax.multiobject=1"' not in tracker.hello:
        fail(f"{what}: {tracker.hello}")
    region = lambda frame, start: ",".join(map(str, place(frame, start)))
    first, second = (20, 15), (50, 30)
    for frame in range(FRAMES):
        if frame in (0, 2):
            tracker.say(f'initialize "{region(frame, first if frame == 0 else second)}" "object={frame}"')
        tracker.say(f'frame "{picture(frame)}"')
        wanted = [place(frame, start) for start in ((first,) if frame < 2 else (first, second))]
        if (found := tracker.boxes(len(wanted))) != wanted:
            fail(f"{what}, {transport}, frame {frame}: {found}; expected {wanted}")
    tracker.say("initialize", f'initialize "{region(0, second)}"', f'frame "{picture(0)}"')
    tracker.boxes()
    tracker.say(f'frame "{picture(1)}"')
    if (found := tracker.boxes()) != [place(1, second)]:
        fail(f"{what}, {transport}, begun anew: {found}")
    tracker.end()


def check_refusals(command, what, picture):
    for lines, reason in (([f'frame "{picture(0)}"'], "a picture before any object"),
                          ([f'initialize "{picture(0)}" "1,2,3,4,5,6"'], "no rectangle: 1,2,3,4,5,6"),
                          ([f'initialize "{picture(0)}" "here"'], "no rectangle: here"),
                          (['initialize "1,2,3,4"', 'initialize "1,2,3,4"'], "a second object"),
                          (["dance"], "dance with 0 arguments"),
                          ([f'initialize "{picture(0)}x" "1,2,9,9"'], "")):
        tracker = Evaluator(command, "standard")
        tracker.say(*lines)
        if reason not in (said := tracker.next("quit")):
            fail(f"{what}: {said}; expected {reason}")
        noise = tracker.process.stderr.read().decode()
        last = noise.splitlines()[-1]  # OpenCV warns of a file that it cannot read
        if tracker.process.wait(30) != 1 or not last.startswith("template_tracker: ") or reason not in last or "Traceback" in noise:
            fail(f"{what}: {lines[0][:40]} ends with {tracker.process.returncode}: {noise}")


def check_pngs(clients):
    """Every colour type and depth with all five filters; by hand: what each packed sample is worth."""
    sys.path.insert(0, clients)
    import airtruth_trax  # pylint: disable=import-outside-toplevel

    decode = airtruth_trax._from_png  # pylint: disable=protected-access
    width, height = 13, 11
    count = 0
    for colour, channels in PNG_TYPES.items():
        for depth in {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}[colour]:
            top = (1 << depth) - 1
            values = [[(31 * r + 17 * i * i + 5 * i) * 977 & top for i in range(width * channels)] for r in range(height)]
            bits = ["".join(f"{v:0{depth}b}" for v in row) for row in values]
            rows = [bytes(int(b[i:i + 8].ljust(8, "0"), 2) for i in range(0, len(b), 8)) for b in bits]
            palette = bytes((k * 7 + j * 50) & 255 for k in range(top + 1) for j in range(3)) if colour == 3 else b""
            level = lambda v: v >> 8 if depth == 16 else v * 255 // top
            wanted = bytearray()
            for row in values:
                for i in range(width):
                    pixel = row[i * channels:(i + 1) * channels]
                    wanted += (palette[3 * pixel[0]:3 * pixel[0] + 3] if colour == 3 else
                               bytes(level(v) for v in pixel[:3]) if colour in (2, 6) else bytes([level(pixel[0])] * 3))
            if decode(png(width, height, colour, depth, rows, palette)) != (width, height, bytes(wanted)):
                fail(f"PNG of colour type {colour}, {depth} bits")
            count += 1
    whole = png(2, 2, 0, 8, [b"ab", b"cd"])
    for broken in [whole[:n] for n in range(8, len(whole) - 24)] + [whole.replace(b"IHDR\0\0\0\2\0\0\0\2", b"IHDR\0\0\0\2\x7f\0\0\0")]:
        try:
            airtruth_trax.Request(True, "data:image/png;" + base64.b64encode(broken).decode()).pixels()
            fail("a broken PNG is read")
        except airtruth_trax.ImageError:
            pass
    return count


FAKE_PIL = '''
class DecompressionBombError(Exception):
    pass
class Picture:
    def __init__(self, size, body): self.size, self.mode, self._body = size, "RGB", body
    def __enter__(self): return self
    def __exit__(self, *_): pass
    def convert(self, mode): return self
    def tobytes(self): return self._body
def open(file):
    data = file.read()
    if not data.startswith(b"fake"): raise OSError("cannot identify the file")
    return Picture((96, 72), bytes(v for s in data[4:] for v in (s, s, s)))
'''


def check_decoders(python, root):
    """Where Pillow is, what is no PNG goes to it; where nothing is, the tracker says what is missing."""
    os.makedirs(root + "/modules/PIL")
    for name, text in (("__init__", ""), ("Image", FAKE_PIL)):
        with open(f"{root}/modules/PIL/{name}.py", "w", encoding="utf-8") as file:
            file.write(text)
    picture = lambda f: "data:image/jpeg;" + base64.b64encode(b"fake" + samples(f)).decode()
    follow_one(python, "standard", picture, "Pillow", {"PYTHONPATH": root + "/modules"})
    for data, reason in ((b"\xff\xd8\xff\xe0 and so on", "the picture is a JPEG: OpenCV's"), (b"GIF89a", "the picture is no PNG: OpenCV's")):
        tracker = Evaluator(python, "standard")
        if "buffer" in tracker.hello:
            fail(f"without a decoder it takes buffers: {tracker.hello}")
        with open(root + "/odd.jpg", "wb") as file:
            file.write(data)
        tracker.say(f'initialize "file://{root}/odd.jpg" "1,2,9,9"')
        said = tracker.next("quit")
        noise = tracker.process.stderr.read().decode()
        if reason not in said or noise.count("\n") != 1 or tracker.process.wait(30) != 1:
            fail(f"without a decoder: {said} {noise}")


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def main():
    clients, example = map(os.path.abspath, sys.argv[1:3])
    # Without site packages: the standard library alone.
    python = [sys.executable, "-S", "-B", clients + "/template_tracker.py"]
    with tempfile.TemporaryDirectory(prefix="airtruth_trax_protocol_") as root:
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=root))
        threading.Thread(target=server.serve_forever, daemon=True).start()
        pictures = kinds_of_pictures(root, server.server_address[1])
        runs = 0
        for what, command in (("C++", [example]), ("Python", python)):
            for transport in ("standard", "descriptors", "socket"):
                follow_one(command, transport, pictures["path"], what)
                follow_several(command + ["--several"], transport, pictures["path"], what)
                runs += 2
            for kind, picture in pictures.items():
                if kind == "path" or (what == "Python" and "JPEG" in kind) or (what == "C++" and kind == "url"):
                    continue
                follow_one(command, "standard", picture, f"{what}, {kind}")
                runs += 1
            check_refusals(command, what, pictures["path"])
        check_decoders(python, root)
        server.shutdown()
    print(f"{runs} runs with two clients find the block, {check_pngs(clients)} forms of PNG are read as they are, refusals are told")


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    main()
