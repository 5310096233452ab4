#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The training script compiles and refuses what it cannot use: python3 train_detector_test.py PACKAGES

Training itself needs torch, which is not installed where the tests run (python_torch_test trains where it is); the libraries are
stood in for, so that the script gets as far as its arguments and its data. PACKAGES is the folder that holds the package airtruth.
"""
import os
import py_compile
import subprocess
import sys
import tempfile
import unittest

PACKAGES = os.path.abspath(sys.argv.pop())
SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "benchmarks", "train_detector.py")
WITH_STAND_INS = """
import runpy, sys
from unittest.mock import MagicMock
for name in ("cv2", "torch", "torch.nn", "torch.nn.functional"):
    sys.modules[name] = MagicMock()
sys.modules["torch"].nn = sys.modules["torch.nn"]
sys.modules["torch.nn"].Module = object
script = sys.argv[1]
sys.argv = sys.argv[1:]
runpy.run_path(script, run_name="__main__")
"""


def run(*arguments, code=WITH_STAND_INS, folder=None):
    return subprocess.run([sys.executable, "-c", code, SCRIPT, *arguments], capture_output=True, text=True, check=False, cwd=folder,
                          env={**os.environ, "PYTHONPATH": PACKAGES})


def run_beside(code, folder=None):
    """Runs code that sees the script's names as `script`."""
    loaded = WITH_STAND_INS.replace('run_name="__main__")', 'run_name="script")').replace("runpy.run_path", "script = runpy.run_path")
    return run(code=loaded + code, folder=folder)


class TrainDetector(unittest.TestCase):
    def test_it_compiles(self):
        with tempfile.TemporaryDirectory() as folder:
            py_compile.compile(SCRIPT, os.path.join(folder, "compiled.pyc"), doraise=True)

    def test_arguments_are_refused_in_a_line(self):
        for arguments, words in ((["set"], "-o/--output"), (["-o", "a.onnx"], "SET"), (["set", "-o", "a.pt"], "expected a name that ends in .onnx"),
                                 (["set", "-o", "a.onnx", "--minutes", "few"], "--minutes")):
            done = run(*arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr.splitlines()[-1])

    def test_a_folder_without_sequences(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run(folder, "-o", os.path.join(folder, "a.onnx"))
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn("holds no finished sequence", done.stderr)
            self.assertEqual(os.listdir(folder), [])

    def test_a_faint_aircraft_counts_neither_way(self):
        code = """
import numpy as np
sky = np.full((100, 200), 100, np.uint8)
sky[:, 120:] = 60  # a step in the background far from all aircraft but the last
boxes = []
for x, y, value in ((10, 10, 124), (40, 10, 126), (70, 10, 74), (10, 60, 76), (-3, 40, 126), (198, 96, 90)):
    sky[max(y, 0):y + 4, max(x, 0):x + 6] = value
    boxes.append((x, y, 6, 4))
sky[11, 81] = 255  # beside an aircraft, and none of its own
frames = script["Frames"]()
frames.add(sky, np.array(boxes, np.float32), np.array([[1, 2, 3, 4]], np.float32))
assert frames.boxes[0].tolist() == [[*boxes[k]] for k in (1, 2, 4, 5)], frames.boxes
assert frames.ignored[0].tolist() == [[1, 2, 3, 4], [*boxes[0]], [*boxes[3]]], frames.ignored
frames.add(sky[10:14, 10:16], np.array([[0, 0, 6, 4]], np.float32))  # nothing around it: it stays
assert len(frames.boxes[1]) == 1 and len(frames.ignored[1]) == 0
"""
        done = run_beside(code)
        self.assertEqual(done.returncode, 0, done.stderr)


class Streams(unittest.TestCase):
    def test_a_stream_without_an_aircraft_ends_the_training(self):
        code = """
import airtruth
airtruth.Stream = lambda catalogue, seed: None
streamed = script["Streamed"]("sky.toml", 1)
boxes = script["NO_BOXES"]
streamed.read = lambda index: ("picture", [[1, 2, 3, 4]] if index == 40 else boxes, boxes)
assert len(streamed.draw(True, None)[1]) == 1 and streamed.index == 41, streamed.index
streamed.draw(True, None)
"""
        done = run_beside(code)
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertIn("sky.toml: 1000 samples in a row show no aircraft", done.stderr)


class Negatives(unittest.TestCase):
    def test_half_of_the_crops_without_an_aircraft_are_about_false_alarms(self):
        code = """
import pathlib
import numpy as np
import airtruth
from airtruth import _show
sky = np.full((300, 400, 3), 100, np.uint8)
sky[200, 300] = 250
pathlib.Path("0000.png").write_bytes(_show._png(sky))
asked = []
def mine(video, detector):
    asked.append((video, detector))
    return airtruth.HardNegatives(pathlib.Path("."), detector, [airtruth.FalseAlarm(0, 0.0, np.array([298.0, 198.0, 5.0, 5.0]), 0.9)])
airtruth.mine = mine
frames = script["Frames"]()
frames.add(np.zeros((290, 290), np.uint8), script["NO_BOXES"])
mixed = script["WithNegatives"](frames, ["a.mp4", "b.mp4"], "onnx:first.onnx")
assert asked == [("a.mp4", "onnx:first.onnx"), ("b.mp4", "onnx:first.onnx")], asked
for picture in mixed.pictures:  # moved into the frame: its right and lower edges are those of the frame
    assert picture.shape == (280, 280) and np.argwhere(picture > 200).tolist() == [[180, 180]], np.argwhere(picture > 200)
dice = np.random.default_rng(1)
drawn = [mixed.draw(False, dice) for _ in range(400)]
mined = sum(picture.shape == (280, 280) for picture, _, _ in drawn)
assert 160 < mined < 240 and all(len(boxes) == 0 for _, boxes, _ in drawn), mined
assert all(mixed.draw(True, dice)[0].shape == (290, 290) for _ in range(20))
assert mixed.words().endswith("2 mined false alarms")
"""
        with tempfile.TemporaryDirectory() as folder:
            done = run_beside(code, folder)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
