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


def run(*arguments):
    return subprocess.run([sys.executable, "-c", WITH_STAND_INS, SCRIPT, *arguments], capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": PACKAGES})


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
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn("holds no finished sequence", done.stderr)
            self.assertEqual(os.listdir(folder), [])


if __name__ == "__main__":
    unittest.main()
