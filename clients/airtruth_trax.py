# SPDX-License-Identifier: Apache-2.0
"""The tracker's side of the TraX protocol (version 3), with the standard library alone.

    from airtruth_trax import Server

    server = Server("mine")
    for request in server:
        if request.begins:
            start(request.image, request.region)
        server.reply(track(request.image))

    airtruth track DIR --tracker "trax:python3 mine.py" --out results

A region is (x, y, width, height); the first pixel covers [0, 1). Server(images="memory") gets the samples in place of a path:
request.pixels() is then (width, height, bytes), three bytes a pixel: red, green, blue.
"""

import base64
import re
import sys
from typing import NamedTuple, Optional, Tuple


class Request(NamedTuple):
    begins: bool  # region holds the object to follow from here on
    image: str  # a file's path, or image:WIDTH;HEIGHT;rgb;BASE64
    region: Optional[Tuple[float, float, float, float]] = None

    def pixels(self):
        width, height, kind, samples = self.image[len("image:"):].split(";", 3)
        if kind != "rgb":
            raise ValueError(f"TraX: pictures of kind {kind}")
        return int(width), int(height), base64.b64decode(samples)


class Server:
    def __init__(self, name, images="path"):
        # What the tracker prints must not mix with its answers.
        self._out = sys.stdout
        sys.stdout = sys.stderr
        self._say(f'hello "trax.name={name}" "trax.version=3" "trax.image={images};" "trax.region=rectangle;" "trax.channels=color;"')

    def __iter__(self):
        for line in sys.stdin:
            words = self._words(line.rstrip("\r\n"))
            if not words or not words[0].startswith("@@TRAX:"):
                continue
            if words[0] == "@@TRAX:quit":
                return
            begins = words[0] == "@@TRAX:initialize"
            image = words[1][len("file://"):] if words[1].startswith("file://") else words[1]
            yield Request(begins, image, tuple(map(float, words[2].split(","))) if begins else None)

    def reply(self, region, confidence=1.0):
        self._say('state "%s" "confidence=%g"' % (",".join("%.10g" % v for v in region), confidence))

    def reply_lost(self):
        """The tracker does not know where its object is."""
        self._say('state "0"')

    def _say(self, message):
        self._out.write(f"@@TRAX:{message}\n")
        self._out.flush()

    @staticmethod
    def _words(line):
        """Words are bare or in quotes with \\" \\\\ and \\n."""
        escape = lambda text: re.sub(r"\\(.)", lambda m: "\n" if m[1] == "n" else m[1], text)
        return [escape(quoted if bare == "" else bare)
                for quoted, bare in re.findall(r'"((?:[^"\\]|\\.)*)"|([^\s"]+)', line)]
