# SPDX-License-Identifier: Apache-2.0
"""A set with birds and multirotors is exported, imported and evaluated: the scores are those of the set itself, for each format as far
as its LOSS.md says that it can. round_trip_scores_test.py AIRTRUTH"""

import json
import os

from program import Case, main, made, path, read, write

CATALOGUE = """
name = "set"
seed = 11
[[background]]
name = "sky"
flight = { seed = 1, frame_count = 12, width = 320, height = 240 }
lens = { vertical_fov_deg = 60 }
camera = { position_ned_m = [0, 0, -150], velocity_ned_mps = [20, 0, 0] }
[output]
video = "mkv"
[[random]]
name = "s{index}"
count = 3
frame_count = 12
aircraft = ["c172/*"]
size_px = [15, 45]
azimuth_deg = [-10, 10]
elevation_deg = [0, 10]
[[distractor]]
kind = "bird"
range_m = [5, 15]
azimuth_deg = [-15, 15]
elevation_deg = [-5, 12]
[[distractor]]
kind = "multirotor"
range_m = [5, 15]
azimuth_deg = [-15, 15]
elevation_deg = [-5, 12]
"""
SIZE = (320, 240)
WHOLE = ["coco", "mot", "cvat", "aot"]  # clips with all objects and their tracks
PICTURES = ["yolo", "voc"]  # no tracks
DETECTION = ["detections", "average_precision", "false_alarms_by", "mistaken_by"]
SINGLE = ["otb", "got10k", "vot"]  # a sequence for each aircraft


def moved(box, k):
    """A box that is off by a few tenths of its size, otherwise in each frame: no overlap is at a threshold."""
    x, y, width, height = box
    return [x + (0.03 + 0.011 * (k % 7)) * width, y - (0.02 + 0.013 * (k % 5)) * height, width * (1 + 0.017 * (k % 3)), height * (1 - 0.019 * (k % 4))]


def write_results():
    """A tracker's answers for the sequences of the set, one of them lost from the middle on, and detections of all kinds of objects."""
    for sequence in sorted(os.listdir(path("otb", "all"))):
        if not os.path.isdir(path("otb", "all", sequence)):
            continue
        lines = read("otb", "all", sequence, "groundtruth_rect.txt").split()
        truth = [[float(number) for number in line.split(",")] for line in lines]
        lost = len(truth) // 2 if sequence.endswith("1") else len(truth)
        answers = [",".join(map(repr, moved([box[0] - 1, box[1] - 1, *box[2:]], k))) if k < lost else "nan,nan,nan,nan" for k, box in enumerate(truth)]
        write(f"results/tracker/{sequence}.txt", "".join(answer + "\n" for answer in answers))
    for name in sorted(os.listdir(path("set", "sequences"))):
        lines = []
        for k, line in enumerate(read("set", "sequences", name, "truth.jsonl").splitlines()):
            for i, one in enumerate(json.loads(line)["intruders"]):
                if one["covered_box_px"] is None or (k + i) % 5 == 4:
                    continue
                x, y, width, height = moved(one["covered_box_px"], k + i)
                lines.append(f"{k + 1},-1,{x + 1!r},{y + 1!r},{width!r},{height!r},{0.9 - 0.07 * ((3 * k + 5 * i) % 11) - 1e-4 * k!r},-1,-1,-1\n")
            lines.append(f"{k + 1},-1,150.5,20.25,9,6,{0.31 + 0.01 * k!r},-1,-1,-1\n")
        write(f"results/detector/{name}.txt", "".join(lines))


def evaluated(folder, *results):
    score = ["--score", "0"] if "results/detector" in results else []
    made("evaluate", folder, *results, *score, "--no-page", "-o", f"scores_{folder}")
    found = {}
    for name in ("evaluation.json", "detection.json"):
        if os.path.exists(path(f"scores_{folder}", name)):
            found[name] = json.loads(read(f"scores_{folder}", name))
    return found


def imported(format):
    out = f"again_{format}"
    if not os.path.exists(path(out)):
        if not os.path.exists(path(format)):
            made("dataset", "export", "set", "--format", format, "--out", format, "--images", "none", "--split", "none")
        size = ["--size", f"{SIZE[0]}x{SIZE[1]}"] if format in ("yolo", "otb", "got10k", "vot") else []
        made("dataset", "import", format, "--format", format, "--out", out, *size)
    return out


class Scores(Case):
    def assert_same(self, found, expected, where):
        """Every number of `expected` is that of `found`, but for the last bits of boxes that a format writes in other units."""
        if isinstance(expected, dict):
            for key, value in expected.items():
                self.assert_same(found[key], value, f"{where}.{key}")
        elif isinstance(expected, list):
            self.assertEqual(len(found), len(expected), where)
            for i, value in enumerate(expected):
                self.assert_same(found[i], value, f"{where}[{i}]")
        elif isinstance(expected, float):
            self.assertAlmostEqual(found, expected, delta=1e-9, msg=where)
        else:
            self.assertEqual(found, expected, where)

    def assert_same_tracker(self, format, keep):
        found = evaluated(imported(format), "results/tracker")["evaluation.json"]
        (mine,), (theirs,) = self.own["evaluation.json"]["trackers"], found["trackers"]
        self.assertEqual(len(mine["sequences"]), 3)
        for one, other in zip([mine["overall"], *mine["sequences"]], [theirs["overall"], *theirs["sequences"]]):
            self.assert_same(other, {key: value for key, value in one.items() if key in keep}, format)

    def assert_same_detector(self, format, keep):
        found = evaluated(imported(format), "results/detector")["detection.json"]
        (mine,), (theirs,) = self.own["detection.json"]["detectors"], found["detectors"]
        self.assert_same(theirs, {key: mine[key] for key in keep}, format)

    @classmethod
    def setUpClass(cls):
        cls.own = evaluated("set", "results/tracker", "results/detector")
        overall = cls.own["evaluation.json"]["trackers"][0]["overall"]
        # What no format stores: the lens, and the range where the object is lost.
        cls.measures = {key for key in overall if key not in ("angle_mrad", "sequences_lost")} | {"name"}

    def test_the_own_scores_can_tell_sets_apart(self):
        """A set whose birds were aircraft, or whose boxes were other ones, would have other scores."""
        detector = self.own["detection.json"]["detectors"][0]
        self.assertTrue(0.05 < detector["average_precision"]["ap"] < 0.95, detector["average_precision"])
        self.assertEqual(set(detector["false_alarms_by"]), {"background", "bird", "multirotor"})
        overall = self.own["evaluation.json"]["trackers"][0]["overall"]
        self.assertTrue(0.3 < overall["auc"] < 0.9, overall["auc"])

    def test_formats_of_whole_clips_keep_both(self):
        for format in WHOLE:
            with self.subTest(format):
                self.assert_same_tracker(format, self.measures)
                self.assert_same_detector(format, DETECTION)

    def test_formats_of_pictures_keep_detections(self):
        for format in PICTURES:
            with self.subTest(format):
                self.assert_same_detector(format, DETECTION)

    def test_what_counts_neither_way_does_so_in_an_import(self):
        scores = {}
        for format in ("webdataset", "coco", "voc"):
            made("dataset", "export", "set", "--format", format, "--out", f"faint_{format}", "--images", "none", "--split", "none", "--min-size", "22")
            made("dataset", "import", f"faint_{format}", "--format", format, "--out", f"faint_again_{format}")
            scores[format] = evaluated(f"faint_again_{format}", "results/detector")["detection.json"]["detectors"][0]
        expected = {key: scores["webdataset"][key] for key in DETECTION}
        own = self.own["detection.json"]["detectors"][0]
        self.assertNotEqual(expected["average_precision"]["ap"], own["average_precision"]["ap"])
        for format in ("coco", "voc"):
            self.assert_same(scores[format], expected, format)

    def test_formats_of_one_object_keep_tracking(self):
        for format in SINGLE:
            with self.subTest(format):
                self.assert_same_tracker(format, self.measures)


def make_set():
    write("set.toml", CATALOGUE)
    made("dataset", "build", "set.toml", "--out", "set")
    made("dataset", "export", "set", "--format", "otb", "--out", "otb", "--images", "none", "--split", "none")
    write_results()


if __name__ == "__main__":
    main(make_set)
