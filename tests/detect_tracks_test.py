# SPDX-License-Identifier: Apache-2.0
"""airtruth detect with a network in an ONNX file, and with tracks made of detections: python3 detect_tracks_test.py AIRTRUTH"""

import json
import os
import shutil
import struct

import program
from detect_test import COUNT, HEIGHT, WIDTH, brightest, make_inputs, target
from program import Case, made, path, read, run, write

CELL = 4  # px
SIDE = 8  # px: side of the network's boxes


def varint(value):
    data = b""
    while value >= 0x80:
        data, value = data + bytes([value & 0x7F | 0x80]), value >> 7
    return data + bytes([value])


def number(field, value):
    return varint(field << 3) + varint(value)


def message(field, data):
    data = data.encode() if isinstance(data, str) else data
    return varint(field << 3 | 2) + varint(len(data)) + data


def floats(name, shape, values):
    return b"".join(number(1, n) for n in shape) + number(2, 1) + message(8, name) + message(9, struct.pack(f"<{len(values)}f", *values))


def node(kind, inputs, output):
    cells = [message(1, name) + number(20, 7) + number(8, CELL) * 2 for name in ("kernel_shape", "strides")]
    return (b"".join(message(1, name) for name in inputs) + message(2, output) + message(3, output) + message(4, kind)
            + b"".join(message(5, one) for one in cells))


def value(name, shape):
    """A length of None is one that the network leaves open."""
    lengths = [message(2, f"{name}{i}") if n is None else number(1, n) for i, n in enumerate(shape)]
    return message(1, name) + message(2, message(1, number(1, 1) + message(2, b"".join(message(1, one) for one in lengths))))


def brightness_model():
    """onnx.proto by hand: heat is the brightest sample of a cell; the offset is half a cell, and the size SIDE."""
    nodes = [node("MaxPool", ["grey"], "heat"), node("Conv", ["grey", "zero", "half"], "offset"), node("Conv", ["grey", "zero", "side"], "size")]
    tensors = [floats("zero", (2, 1, CELL, CELL), [0] * (2 * CELL * CELL)), floats("half", (2,), [0.5, 0.5]), floats("side", (2,), [SIDE, SIDE])]
    outputs = [value(name, (1, n, None, None)) for name, n in (("heat", 1), ("offset", 2), ("size", 2))]
    graph = (b"".join(message(1, one) for one in nodes) + message(2, "graph") + b"".join(message(5, one) for one in tensors)
             + message(11, value("grey", (1, 1, None, None))) + b"".join(message(12, one) for one in outputs))
    return number(1, 6) + message(7, graph) + message(8, message(1, "") + number(2, 11))


def description(**changes):
    whole = {"format": "airtruth detector model 1", "input": {"layout": "grey", "scale": 1 / 255, "fit": "frame", "multiple_px": CELL},
             "output": {"kind": "heat_map", "heat": "heat", "offset": "offset", "size": "size"}, "classes": ["aircraft"],
             "score_threshold": 0.9, "confident_score": 0.95}
    return json.dumps({**whole, **changes}, indent=1)


def make_all_inputs():
    make_inputs()
    write("bright.onnx", brightness_model())
    write("bright.json", description())


def lines_of(*parts):
    return [[float(v) for v in line.split(",")[:7]] for line in read(*parts).splitlines()]


class ANetwork(Case):
    def test_finds_the_brightest_cell_and_its_track(self):
        made("detect", "set", "-d", "onnx:bright.onnx", "-o", "net", "--only", "one", "--associate", "--declare", "2/3")
        lines = lines_of("net", "bright", "one.txt")
        self.assertEqual(len(lines), COUNT)
        for k, line in enumerate(lines):
            x, y = ((v // CELL + 0.5) * CELL - SIDE / 2 for v in brightest(k))
            self.assertEqual(line[:6], [k + 1, -1 if k == 0 else 1, x + 1, y + 1, SIDE, SIDE])
            self.assertAlmostEqual(line[6], 250 / 255, places=6)

    def test_results_belong_to_one_network(self):
        made("detect", "set", "-d", "onnx:bright.onnx", "-o", "kept", "--only", "one")
        os.makedirs(path("elsewhere"), exist_ok=True)
        shutil.copy(path("bright.onnx"), path("elsewhere"))
        write("elsewhere/bright.json", description())
        done = made("detect", "set", "-d", "onnx:elsewhere/bright.onnx", "-o", "kept")
        self.assertIn("1 were there", done.stdout)
        write("elsewhere/bright.json", description(score_threshold=0.8))
        self.assert_refused(run("detect", "set", "-d", "onnx:elsewhere/bright.onnx", "-o", "kept"), "holds results with files", "bright.json")
        self.assert_refused(run("detect", "set", "-d", "onnx:bright.onnx", "-o", "kept", "--associate"), "holds results with association")

    def test_faults_are_one_line_and_nothing_is_made(self):
        def refused(name, onnx, text, *words):
            write(name + ".onnx", onnx)
            if text is not None:
                write(name + ".json", text)
            self.assert_refused(run("detect", "set", "-d", f"onnx:{name}.onnx", "-o", "x"), *words)
        whole = brightness_model()
        refused("bare", whole, None, "bare.onnx: has no description beside it; expected bare.json")
        refused("none", "a text", description(), "none.onnx: cannot be loaded as an ONNX network: it is no ONNX file")
        refused("cut", whole[:-200], description(), "cut.onnx: cannot be loaded as an ONNX network: ")
        refused("keys", whole, description(nms_iuo=0.3), "keys.json:", 'unknown key "nms_iuo"; did you mean "nms_iou"?')
        refused("shape", whole, description(classes=["aircraft", "bird"]), "shape.onnx: its output 'heat' has the shape 1 x 1 x 64 x 64")
        refused("names", whole, description(output={"kind": "yolov5", "boxes": "output0"}), "it has no output 'output0'; it ends with")
        self.assert_refused(run("detect", "set", "-d", "onnx:", "-o", "x"), "names no file; expected onnx:MODEL.onnx")
        self.assert_refused(run("detect", "set", "-d", "onxn:bright.onnx", "-o", "x"), "did you mean 'onnx:'?")
        self.assertFalse(os.path.exists(path("x")))


class Tracks(Case):
    def test_the_target_has_one_track(self):
        made("detect", "set", "-d", "cmo", "-o", "tracks", "--only", "one", "--associate")
        seen = []
        for frame, track, left, top, *_ in lines_of("tracks", "cmo", "one.txt"):
            x, y, _, _ = target(int(frame) - 1)
            if abs(left - 1 - x) <= 2 and abs(top - 1 - y) <= 2:
                seen.append(int(track))
        declared = [track for track in seen if track >= 0]
        self.assertGreaterEqual(len(declared), len(seen) - 2)  # 3 of 5: the first two frames come before
        self.assertEqual(len(set(declared)), 1)

    def test_options_are_checked(self):
        self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "y", "--declare", "3/5"), "--declare has no effect without --associate")
        for text, words in (("3", "expected M/N"), ("a/5", "expected M/N"), ("5/3", "expected 1 to 3"), ("1/2000", "expected 1 to 1000")):
            self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "y", "--associate", "--declare", text), words)
        self.assertFalse(os.path.exists(path("y")))


if __name__ == "__main__":
    program.main(make_all_inputs)
