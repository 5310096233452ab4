# SPDX-License-Identifier: Apache-2.0
"""The tracker's side of the TraX protocol (versions 3 and 4), with the standard library alone.

    from airtruth_trax import Server

    server = Server("mine")
    for request in server:
        if request.begins:
            start(request.image, request.region)
        server.reply(track(request.image))

    airtruth track DIR --tracker "trax:python3 mine.py" --out results

A region is (x, y, width, height); the first pixel covers [0, 1).

What the tracker takes, best first, is said by Server("mine", images="memory;path"), of
    path    a file
    memory  samples in the message
    buffer  a PNG's or JPEG's bytes in the message ("data" in the protocol's text)
    url     http or https
request.pixels() is the picture of any of them: (width, height, bytes), three bytes a pixel: red, green, blue. PNGs are read here; JPEGs
and whatever else need OpenCV's (cv2) or Pillow's (PIL) module, and ImageError says so where neither is installed. request.encoded() is
the file's bytes for a decoder of your own. decodable() names what pixels() can read here, for `images`.

Messages go over standard input and output, over the file descriptors TRAX_IN and TRAX_OUT, or over a connection to 127.0.0.1 at the
port TRAX_SOCKET, as the environment says.
"""

import base64
import importlib
import io
import os
import re
import socket
import struct
import sys
import urllib.request
import zlib
from typing import NamedTuple, Optional, Tuple

PNG = b"\x89PNG\r\n\x1a\n"
MOST_PIXELS = 1 << 28
URL_TIMEOUT_S = 30
BUFFER_FORMATS = ("image/png", "image/jpeg")


class TraxError(ValueError):
    pass


class ImageError(TraxError):
    """A picture that cannot be had or read."""


class ProtocolError(TraxError):
    """A request that the protocol does not allow."""


class Request(NamedTuple):
    begins: bool  # what was followed is let go: `objects` holds all that there is
    image: str  # a file's path; of another kind the whole text: image:..., data:..., http://...
    region: Optional[Tuple[float, float, float, float]] = None  # of the first new object
    objects: tuple = ()  # new ones, (region, properties), which come after those that are followed already
    properties: dict = {}

    @property
    def kind(self):
        """path, memory, buffer or url."""
        scheme = re.match(r"([a-z+.-]{1,15}):", self.image)
        return {None: "path", "image": "memory", "data": "buffer"}.get(scheme and scheme[1], "url")

    def encoded(self):
        """The bytes of the PNG, JPEG or other file."""
        if self.kind == "path":
            try:
                with open(os.fsencode(self.image), "rb") as file:
                    return file.read()
            except OSError as error:
                raise ImageError(f"{self.image}: {error.strerror}") from None
        if self.kind == "buffer":
            head, _, body = self.image[len("data:"):].partition(";")
            if head.lower() not in BUFFER_FORMATS:
                raise ImageError(f"a picture of type {head[:40]}; expected {' or '.join(BUFFER_FORMATS)}")
            return _base64(re.sub(r"^base64[,;]", "", body))
        if self.kind == "url":
            if not self.image.startswith(("http://", "https://")):
                raise ImageError(f"{self.image[:200]}: expected http or https")
            try:
                with urllib.request.urlopen(self.image, timeout=URL_TIMEOUT_S) as answer:
                    return answer.read()
            except OSError as error:
                raise ImageError(f"{self.image[:200]}: {error}") from None
        raise ImageError("a picture in memory has no file")

    def pixels(self):
        """(width, height, bytes of red, green, blue)."""
        return _from_memory(self.image) if self.kind == "memory" else _decoded(self.encoded())


def decodable():
    """Kinds of pictures that pixels() can read here: without a decoder for JPEGs no buffer, which may hold one."""
    return "memory;path;url" + (";buffer" if _module("cv2") or _module("PIL.Image") else "")


class Server:
    """Says hello at once. Version 4, for several objects at a time, where takes_several."""

    def __init__(self, name, images="path", takes_several=False):
        self._takes_several = takes_several
        self._followed = 0
        self._has_quit = False
        port = os.environ.get("TRAX_SOCKET")
        if port:
            self._socket = socket.create_connection(("127.0.0.1", int(port)))
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._in, self._out = self._socket.makefile("rb"), self._socket.makefile("wb")
        else:
            self._in = self._opened("TRAX_IN", sys.stdin, "rb")
            self._out = self._opened("TRAX_OUT", sys.stdout, "wb")
            if self._out is sys.stdout.buffer:
                sys.stdout = sys.stderr  # what the tracker prints must not mix with its answers
        images = images.replace(",", ";").replace("data", "buffer").strip(";")
        version = {"trax.version": 4, "trax.multiobject": 1} if takes_several else {"trax.version": 3}
        self._say("hello", (), {"trax.name": name, **version, "trax.image": images + ";", "trax.region": "rectangle;", "trax.channels": "color;"})

    def __iter__(self):
        """Requests, to the end. ProtocolError, which the evaluator is told, for what the protocol does not allow."""
        begins, objects = False, []
        for line in self._in:
            if not line.startswith(b"@@TRAX:"):
                continue
            kind, arguments, properties = self._message(line)
            if kind == "quit":
                return
            if (kind, len(arguments)) not in (("initialize", 0), ("initialize", 1), ("initialize", 2), ("frame", 1)):
                self._fail(f"{kind} with {len(arguments)} arguments")
            if kind == "initialize" and len(arguments) != 1:  # all is let go: by version 3's, or by an empty one
                begins, objects, self._followed = True, [], 0
            if kind == "initialize" and arguments:
                begins = begins or self._followed == 0
                objects.append((self._region(arguments[-1]), properties if len(arguments) == 1 else {}))
                self._followed += 1
                if self._followed > 1 and not self._takes_several:
                    self._fail("a second object")
            if kind == "initialize" and len(arguments) < 2:  # version 4: the picture follows
                continue
            if not self._followed:
                self._fail("a picture before any object")
            image = re.sub(r"^file:(//)?", "", arguments[0])
            yield Request(begins, image, objects[0][0] if objects else None, tuple(objects), properties)
            begins, objects = False, []

    def reply(self, region, confidence=1.0, properties=None):
        """region None: the tracker does not know where its object is."""
        self.reply_all([(region, confidence, properties or {})])

    def reply_lost(self):
        self.reply(None)

    def reply_all(self, answers):
        """(region or None, confidence, properties), or a region or None alone, for each object in the order in which they came."""
        if len(answers) != self._followed:
            raise ValueError(f"{len(answers)} answers for {self._followed} objects")
        for answer in answers:
            region, confidence, properties = answer if answer and len(answer) == 3 else (answer, 1.0, {})
            if region is None:
                self._say("state", ["0"], properties, flush=False)
            else:
                self._say("state", [",".join("%.10g" % v for v in region)], {"confidence": "%g" % confidence, **properties}, flush=False)
        self._out.flush()

    def quit(self, reason):
        """The tracker cannot go on. Of several calls the first counts."""
        if not self._has_quit:
            self._has_quit = True
            self._say("quit", (), {"trax.reason": reason})

    @staticmethod
    def _opened(variable, standard, mode):
        number = os.environ.get(variable)
        return os.fdopen(int(number), mode) if number else standard.buffer

    def _fail(self, what):
        self.quit(what)
        raise ProtocolError(what)

    def _region(self, text):
        try:
            region = tuple(map(float, text.split(",")))
        except ValueError:
            region = ()
        if len(region) != 4:
            self._fail(f"no rectangle: {text[:40]}")
        return region

    def _say(self, kind, arguments, properties, flush=True):
        quoted = lambda text: ' "' + re.sub(r'(["\\])', r"\\\1", text).replace("\n", "\\n") + '"'
        words = "".join(map(quoted, arguments)) + "".join(quoted(f"{key}={value}") for key, value in properties.items())
        self._out.write(f"@@TRAX:{kind}{words}\n".encode("utf-8", "surrogateescape"))
        if flush:
            self._out.flush()

    @staticmethod
    def _message(line):
        """Words are bare or in quotes with \\" \\\\ and \\n; key=value is a property."""
        text = line.decode("utf-8", "surrogateescape").rstrip("\r\n")[len("@@TRAX:"):]
        kind = re.match(r"[^\s]*", text)[0]
        escape = lambda word: re.sub(r"\\(.)", lambda m: "\n" if m[1] == "n" else m[1], word) if "\\" in word else word
        arguments, properties = [], {}
        for quoted, bare in re.findall(r'"([^"\\]*(?:\\.[^"\\]*)*)"|([^\s"]+)', text[len(kind):]):
            word = escape(bare or quoted)
            key, equals, value = word[:65].partition("=")
            if equals and re.fullmatch(r"[A-Za-z0-9._]{1,64}", key):
                properties[key] = word[len(key) + 1:]
            else:
                arguments.append(word)
        return kind.lower(), arguments, properties


def _module(name):
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _base64(text):
    try:
        return base64.b64decode(text, validate=True)
    except ValueError:
        raise ImageError("a picture is no base64") from None


def _grey(samples):
    out = bytearray(3 * len(samples))
    out[0::3] = out[1::3] = out[2::3] = samples
    return bytes(out)


def _from_memory(image):
    match = re.match(r"image:([0-9]{1,6});([0-9]{1,6});(rgb|gray8|gray16);", image)
    if not match:
        raise ImageError(f"no picture in memory: {image[:40]}")
    width, height, kind = int(match[1]), int(match[2]), match[3]
    samples = _base64(image[match.end():])
    if not samples or len(samples) != width * height * {"rgb": 3, "gray8": 1, "gray16": 2}[kind]:
        raise ImageError("a picture has not as many samples as its size says")
    if kind == "rgb":
        return width, height, samples
    return width, height, _grey(samples[1::2] if kind == "gray16" else samples)  # the low byte is first


def _decoded(data):
    is_png = data.startswith(PNG)
    if cv2 := _module("cv2"):
        picture = cv2.imdecode(_module("numpy").frombuffer(data, "uint8"), cv2.IMREAD_COLOR) if data else None
        if picture is None:
            raise ImageError("OpenCV cannot read the picture")
        return picture.shape[1], picture.shape[0], cv2.cvtColor(picture, cv2.COLOR_BGR2RGB).tobytes()
    if pillow := _module("PIL.Image"):
        try:
            with pillow.open(io.BytesIO(data)) as picture:
                if not (is_png and picture.mode.startswith("I")):  # 16 bits, which Pillow does not scale
                    return (*picture.size, picture.convert("RGB").tobytes())
        except (OSError, ValueError, pillow.DecompressionBombError) as error:
            raise ImageError(f"Pillow cannot read the picture: {error}") from None
    if not is_png:
        name = "a JPEG" if data.startswith(b"\xff\xd8\xff") else "no PNG"
        raise ImageError(f"the picture is {name}: OpenCV's (cv2) or Pillow's (PIL) Python module is needed, and neither is installed")
    try:
        return _from_png(data)
    except (struct.error, zlib.error, IndexError):
        raise ImageError("the PNG is broken") from None


def _from_png(data):
    at, body, palette, head = len(PNG), [], b"", None
    while at + 8 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        chunk = data[at + 8:at + 8 + length]
        at += 12 + length
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"PLTE":
            palette = chunk
        elif kind == b"IDAT":
            body.append(chunk)
    if head is None:
        raise ImageError("the PNG is broken")
    width, height, depth, colour, _, _, interlaced = head
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}.get(colour)
    if channels is None or depth not in (1, 2, 4, 8, 16) or not 0 < width * height <= MOST_PIXELS:
        raise ImageError("the PNG is broken")
    if interlaced:
        raise ImageError("the PNG is interlaced: OpenCV's (cv2) or Pillow's (PIL) Python module is needed, and neither is installed")
    stride = (width * channels * depth + 7) // 8
    raw = zlib.decompressobj().decompress(b"".join(body), height * (stride + 1))
    if len(raw) != height * (stride + 1):
        raise ImageError("the PNG is broken")
    step = max(1, channels * depth // 8)
    rows, above = [], bytes(stride)
    for start in range(0, len(raw), stride + 1):
        above = _unfiltered(raw[start], raw[start + 1:start + 1 + stride], above, step)
        rows.append(above)
    if depth == 16:
        samples = b"".join(rows)[0::2]  # the high byte is first
    elif depth == 8:
        samples = b"".join(rows)
    else:
        scale = 1 if colour == 3 else 255 // ((1 << depth) - 1)
        shifts, mask = range(8 - depth, -1, -depth), (1 << depth) - 1
        samples = b"".join(bytes((byte >> shift & mask) * scale for byte in row for shift in shifts)[:width] for row in rows)
    if colour in (0, 4):
        return width, height, _grey(samples[0::channels])
    out = bytearray(3 * width * height)
    for k in range(3):
        if colour == 3:
            out[k::3] = samples.translate(palette[k:768:3].ljust(256, b"\0"))
        else:
            out[k::3] = samples[k::channels]
    return width, height, bytes(out)


def _unfiltered(kind, row, above, step):
    """A row of a PNG without its filter (ISO 15948, section 9)."""
    if kind == 0:
        return row
    if kind == 2:
        return bytes((a + b) & 255 for a, b in zip(row, above))
    if kind not in (1, 3, 4):
        raise ImageError("the PNG is broken")
    out = bytearray(row)
    for i, value in enumerate(row):
        left = out[i - step] if i >= step else 0
        up = above[i]
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + up) // 2
        else:
            corner = above[i - step] if i >= step else 0
            middle = left + up - corner
            to_left, to_up, to_corner = abs(middle - left), abs(middle - up), abs(middle - corner)
            guess = left if to_left <= to_up and to_left <= to_corner else up if to_up <= to_corner else corner
        out[i] = (value + guess) & 255
    return bytes(out)
