# SPDX-License-Identifier: Apache-2.0
"""The detector's side of airtruth's protocol for detectors (docs/detector-protocol.md), in one file that needs the standard library alone.

    from airtruth_detector import Server, detection

    server = Server(samples="gray")
    for frame in server:
        server.reply([detection((x, y, width, height), score) for x, y, width, height, score in find(frame)])

    airtruth detect DIR --detector "mine=exec:python3 mine.py" --out results

A box is (x, y, width, height) in pixels; the first pixel covers [0, 1). What the program prints to standard error, or through print(), is kept
in a log.
"""

import json
import mmap
import sys
from typing import NamedTuple, Optional, Sequence, Tuple

PROTOCOL = 1


class ProtocolError(ValueError):
    pass


class SequenceFacts(NamedTuple):
    """What is known of the sequence."""
    name: str
    width: int
    height: int
    frame_rate_hz: float
    lens: dict  # model, focal_px, principal_point_px, distortion (docs/lenses.md)


class Frame(NamedTuple):
    index: int  # in the sequence, from 0
    time_s: float
    # Rows of samples from the top, without padding: red, green, blue of each pixel, or its luma. numpy.frombuffer(frame.samples, "uint8") takes it
    # without a copy. Of shared memory, it is valid until the reply.
    samples: memoryview
    sequence: SequenceFacts
    # Rotation (w, x, y, z) of a direction in the camera of the frame before into this frame's (x right, y down, z forward); None: not known.
    this_from_previous: Optional[Tuple[float, float, float, float]] = None


def detection(box, score, category="aircraft", track=None):
    """A detection as reply() takes it. The track is the same number for the same object throughout the sequence."""
    found = {"box": [float(v) for v in box], "score": float(score)}
    if category != "aircraft":
        found["category"] = category
    if track is not None:
        found["track"] = int(track)
    return found


class Server:
    """Says hello at once. samples: "rgb" or "gray"; frames come by "pipe" or by "shared_memory"."""

    def __init__(self, samples="rgb", frames="pipe"):
        self._in, self._out = sys.stdin.buffer, sys.stdout.buffer
        sys.stdout = sys.stderr  # what the program prints must not mix with its answers
        self._bytes_per_pixel = {"rgb": 3, "gray": 1}[samples]
        self._sequence = self._shared = self._asked = None
        self._say({"hello": {"protocol": PROTOCOL, "samples": samples, "frames": frames}})

    def __iter__(self):
        """Frames, to the end of the sequence."""
        for line in self._in:
            message = json.loads(line)
            if "quit" in message:
                return
            if "begin" in message:
                self._begin(message["begin"])
            elif "frame" in message:
                yield self._frame(message)
            else:
                raise ProtocolError(f"a message of {sorted(message)}")

    def reply(self, detections: Sequence[dict]):
        if self._asked is None:
            raise ProtocolError("a reply without a frame")
        self._say({"frame": self._asked, "detections": list(detections)})
        self._asked = None

    def _begin(self, begin):
        self._sequence = SequenceFacts(begin["sequence"], begin["width"], begin["height"], begin["frame_rate_hz"], begin["lens"])
        if "shared_memory" in begin:
            with open(begin["shared_memory"], "rb") as file:
                self._shared = memoryview(mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ))

    def _frame(self, message):
        count = self._sequence.width * self._sequence.height * self._bytes_per_pixel
        if message["bytes"] != count:
            raise ProtocolError(f"a frame of {message['bytes']} bytes; expected {count}")
        samples = self._shared or memoryview(self._in.read(count))
        if len(samples) < count:
            raise ProtocolError("a frame ends early")
        self._asked = message["frame"]
        turn = message.get("this_from_previous")
        return Frame(self._asked, message["time_s"], samples[:count], self._sequence, turn and tuple(turn))

    def _say(self, message):
        self._out.write(json.dumps(message, allow_nan=False).encode() + b"\n")
        self._out.flush()
