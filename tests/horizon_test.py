# SPDX-License-Identifier: Apache-2.0
"""The horizon of a clip is measured where its line is sharp, and refused in one line where it is not: python3 horizon_test.py AIRTRUTH

A virtual flight has a horizon in every frame. The coast of AIRTRUTH_SHARED/footage/gopro-karma has the sea's in less than half of its width and a
skyline of houses beside it; the flight over hills in fixed-wing/overcast_b4 has a horizon. Both clips are skipped where they are not there."""

import os
import re
import subprocess
import sys
import tempfile
import unittest

AIRTRUTH = ""
ROOT = ""


def path(*names):
    return os.path.join(ROOT, *names)


def run(*words):
    return subprocess.run([AIRTRUTH, *words], capture_output=True, text=True, cwd=ROOT, timeout=300)


def footage(*names):
    shared = os.environ.get("AIRTRUTH_SHARED")
    file = os.path.join(shared or "", "footage", *names)
    if not shared or not os.path.exists(file):
        raise unittest.SkipTest("AIRTRUTH_SHARED/footage/" + "/".join(names) + " is not there")
    return file


class HorizonTest(unittest.TestCase):
    def calibrated(self, video, name):
        """What calibrate says of the horizon, and the camera file that it writes."""
        made = run("calibrate", video, "-o", name + ".toml", "--plot", name + ".png")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertTrue(os.path.getsize(path(name + ".png")) > 0)
        lines = [line for line in made.stderr.splitlines() if "warning: horizon " in line]
        with open(path(name + ".toml"), encoding="utf-8") as file:
            return lines, file.read()

    def test_a_virtual_flight_has_one(self):
        made = run("synth", "-o", "flight.mkv", "--width", "480", "--height", "360", "--frames", "24", "--no-own-aircraft", "--seed", "3")
        self.assertEqual(made.returncode, 0, made.stderr)
        said, camera = self.calibrated("flight.mkv", "flight")
        self.assertEqual(said, [])
        self.assertRegex(camera, r"(?m)^airlight = \[")
        self.assertNotIn("# horizon", camera)

    def test_a_coast_has_none_and_that_is_said(self):
        said, camera = self.calibrated(footage("gopro-karma", "karma.mp4"), "karma")
        self.assertEqual(len(said), 1, said)
        counts = re.search(r"cannot be had: .* in (\d+) of (\d+) frames; in (\d+) they part without one", said[0])
        self.assertIsNotNone(counts, said[0])
        sharp, frames, parted = map(int, counts.groups())
        self.assertLess(sharp, parted)
        self.assertEqual(frames, 41)
        self.assertLessEqual(sharp + parted, frames)
        self.assertRegex(camera, r"(?m)^# horizon: not measured: ")
        # No value that needs the horizon is written.
        self.assertRegex(camera, r"(?m)^# airlight: not measured: no horizon is found")
        self.assertNotRegex(camera, r"(?m)^airlight")

    def test_hills_have_one(self):
        said, camera = self.calibrated(footage("fixed-wing", "overcast_b4.mp4"), "hills")
        # A few frames have none, and that is said.
        self.assertEqual(len(said), 1, said)
        counts = re.search(r"measured in (\d+) of (\d+) frames; in (\d+) ", said[0])
        self.assertIsNotNone(counts, said[0])
        self.assertGreater(int(counts[1]), 0.85 * int(counts[2]))
        self.assertRegex(camera, r"(?m)^airlight = \[")


if __name__ == "__main__":
    AIRTRUTH = os.path.abspath(sys.argv.pop(1))
    with tempfile.TemporaryDirectory() as ROOT:
        unittest.main()
