# SPDX-License-Identifier: Apache-2.0
"""airtruth track over data sets, where a folder holds results already or sequences have names alike: python3 track_test.py AIRTRUTH"""

import os
import shutil

import program
from numbered_clip import write_otb
from program import made, path, read, run, write

FRAMES = 24


def make_inputs():
    write_otb(path("otb"), ["one", "two"], FRAMES)


def imported(source, kind, out):
    """A data set of a folder of labels, in place of what is there."""
    shutil.rmtree(path(out), ignore_errors=True)
    made("dataset", "import", source, "-f", kind, "--frame-rate", "25", "-o", out)


class Kept(program.Case):
    def test_results_of_a_sequence_that_was_made_anew_are_not(self):
        imported("otb", "otb", "anew")
        track = lambda *more: run("track", "anew", "-t", "opencv-kcf", "-o", "of-anew", *more)
        self.assertEqual(track("--only", "one").returncode, 0)
        truth = read("otb", "one", "groundtruth_rect.txt")
        try:
            write("otb/one/groundtruth_rect.txt", "50,60,20,14\n" * FRAMES)
            imported("otb", "otb", "anew")
        finally:
            write("otb/one/groundtruth_rect.txt", truth)
        self.assert_refused(track("--only", "one"), "one.run.json", "holds results with source_sha256", "give another --out")
        self.assertIn("1 runs tracked", track("--only", "two").stdout)
        imported("otb", "otb", "anew")  # the same content again
        self.assertIn("2 were there", track().stdout)
        os.remove(path("of-anew", "opencv-kcf", "one.run.json"))  # as an older airtruth left it
        self.assertIn("2 were there", track().stdout)


if __name__ == "__main__":
    program.main(make_inputs)
