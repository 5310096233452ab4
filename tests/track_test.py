# SPDX-License-Identifier: Apache-2.0
"""airtruth track over data sets, where a folder holds results already or sequences have names alike: python3 track_test.py AIRTRUTH"""

import os
import re
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
        warnings = lambda: made("evaluate", "anew", "of-anew/opencv-kcf", "--no-page", "-o", "of-anew-measures").stderr
        truth = read("otb", "one", "groundtruth_rect.txt")
        try:
            write("otb/one/groundtruth_rect.txt", "50,60,20,14\n" * FRAMES)
            imported("otb", "otb", "anew")
        finally:
            write("otb/one/groundtruth_rect.txt", truth)
        self.assert_refused(track("--only", "one"), "one.run.json", "holds results with source_sha256", "give another --out")
        self.assertIn("1 runs tracked", track("--only", "two").stdout)
        self.assertEqual(warnings().count("results of 1 sequences were made of other content"), 1)
        self.assertIn("(the first: one); `airtruth track` with another --out", warnings())
        imported("otb", "otb", "anew")  # the same content again
        self.assertIn("2 were there", track().stdout)
        self.assertNotIn("other content", warnings())
        os.remove(path("of-anew", "opencv-kcf", "one.run.json"))  # as an older airtruth left it
        self.assertIn("2 were there", track().stdout)

    def test_a_box_outside_of_its_picture_breaks_its_own_run_off_alone(self):
        imported("otb", "otb", "outside")
        labels = "outside/sequences/one/labels.jsonl"
        write(labels, re.sub(r'"box_px":\[[^]]*\]', '"box_px":[9000,9000,20,14]', read(labels)))
        for how in ([], ["--protocol", "restart", "--repetitions", "1"]):
            done = run("track", "outside", "-t", "opencv-kcf", "-o", "of-outside", *how)
            self.assertEqual((done.returncode, done.stderr.count("on one: the tracker cannot begin: ")), (1, 1), done.stderr)
            self.assertIn("one/labels.jsonl: the first box has no area within the picture", done.stderr)
            self.assertIn("1 runs tracked", done.stdout)

    def test_a_run_without_its_times_is_not(self):
        imported("otb", "otb", "set")
        restart = ["--protocol", "restart", "--repetitions", "1"]
        for how, text, times in (([], "one.txt", "one_time.txt"), (restart, "restart/one/one_001.txt", "restart/one/one_001_time.value")):
            track = lambda: made("track", "set", "--only", "one", "-t", "opencv-kcf", "-o", "untimed", *how).stdout
            self.assertIn("1 runs tracked", track())
            before = read("untimed", "opencv-kcf", text)
            os.remove(path("untimed", "opencv-kcf", times))  # as a kill between the two leaves it
            self.assertIn("1 runs tracked", track())
            self.assertEqual(len(read("untimed", "opencv-kcf", times).split()), FRAMES)
            self.assertEqual(read("untimed", "opencv-kcf", text), before)
            self.assertIn("1 were there", track())

    def test_settings_of_a_call_without_results_are_not(self):
        write("blind/a.csv", "frame,x,y,w,h\n0,10,20,30,20\n1,10,20,30,20\n")
        made("dataset", "import", "blind", "-f", "csv", "--size", "320x240", "-o", "blind-set")
        imported("otb", "otb", "set")
        track = lambda source, seed: run("track", source, "--seed", seed, "-t", "opencv-kcf", "-o", "of-blind")
        self.assert_refused(track("blind-set", "1"), "a has no video")
        self.assertIn("2 runs tracked", track("set", "2").stdout)
        self.assert_refused(track("set", "1"), "seed")

    def test_runs_of_another_step_or_of_more_repetitions_are_not(self):
        imported("otb", "otb", "set")
        track = lambda *more: run("track", "set", "--only", "one", "-t", "opencv-kcf", "-o", "kept", *more)
        multistart = lambda step: track("--protocol", "multistart", "--anchor-step", step)
        runs = lambda kind: [name for name in sorted(os.listdir(path("kept", "opencv-kcf", kind, "one"))) if name.endswith(".txt")]
        self.assertEqual(multistart("12").returncode, 0)
        self.assertEqual(runs("multistart"), ["one_00000000.txt", "one_00000023.txt"])
        self.assertIn("2 were there", multistart("6").stdout)  # begins at these as well
        self.assertEqual(runs("multistart"), [f"one_{frame:08}.txt" for frame in (0, 6, 12, 23)])
        self.assert_refused(multistart("12"), "one_00000006.txt", "--anchor-step", "give another --out")
        repeated = lambda count: track("--protocol", "restart", "--repetitions", count)
        self.assertEqual(repeated("1").returncode, 0)
        self.assertIn("1 were there", repeated("2").stdout)
        self.assert_refused(repeated("1"), "one_002.txt", "--repetitions", "give another --out")


BOX = "{},10,20,30,20\n"
FRAMES_OF_ONE = "frame,x,y,w,h\n" + "".join(map(BOX.format, range(FRAMES)))
FRAMES_OF_TWO = FRAMES_OF_ONE + "".join(f"{k},90,60,20,20\n" for k in range(FRAMES))


class Names(program.Case):
    def test_an_object_and_a_sequence_of_one_name_are_refused(self):
        write("alike/a.csv", FRAMES_OF_TWO)
        write("alike/a-2.csv", FRAMES_OF_ONE)
        made("dataset", "import", "alike", "-f", "csv", "--size", "320x240", "-o", "alike-set")
        write("of-alike/a-2.txt", "10,20,30,20\n" * FRAMES)
        for command in (["track", "alike-set", "-t", "opencv-kcf", "-o", "never"], ["evaluate", "alike-set", "of-alike", "-o", "never"],
                        *(["dataset", "export", "alike-set", "-f", kind, "--images", "none", "--split", "none", "-o", "never"]
                          for kind in ("otb", "got10k", "vot"))):
            with self.subTest(command):
                self.assert_refused(run(*command), "both 'a' and 'a-2' hold what is named 'a-2'")
                self.assertFalse(os.path.exists(path("never")))
        made("dataset", "export", "alike-set", "-f", "mot", "--images", "none", "--split", "none", "-o", "tracks")

    def test_a_sequence_with_the_name_of_anothers_seconds_is_refused(self):
        for name in ("foo", "foo_time"):
            write(f"times/{name}.csv", FRAMES_OF_ONE)
        made("dataset", "import", "times", "-f", "csv", "--size", "320x240", "-o", "times-set")
        write("of-times/foo.txt", "10,20,30,20\n" * FRAMES)
        for command in (["track", "times-set", "-t", "opencv-kcf", "-o", "never"], ["evaluate", "times-set", "of-times", "-o", "never"]):
            self.assert_refused(run(*command), "the seconds of 'foo' and the results of 'foo_time' have one file, foo_time.txt")

    def test_objects_and_sequences_of_other_names_are_not(self):
        write("apart/a.csv", FRAMES_OF_TWO)
        write("apart/a-3.csv", FRAMES_OF_ONE)
        made("dataset", "import", "apart", "-f", "csv", "--size", "320x240", "-o", "apart-set")
        made("dataset", "export", "apart-set", "-f", "otb", "--images", "none", "--split", "none", "-o", "objects")
        self.assertEqual(sorted(read("objects", "all", "list.txt").split()), ["a-1", "a-2", "a-3"])


if __name__ == "__main__":
    program.main(make_inputs)
