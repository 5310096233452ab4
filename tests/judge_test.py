#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The judge of benchmarks/judge on comparisons that are drawn here: judge_test.py

A judge finds the difference that was put in, and none where both aircraft of every pair are drawn alike. A clip's two aircraft always
differ in shape and shade, each clip in its own way, which no judge of other clips may take for the difference.
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

try:
    import cv2
    import numpy
    import sklearn  # noqa: F401
except ImportError as missing:
    DEBIAN_PYTHON = "/usr/bin/python3"
    if sys.executable != DEBIAN_PYTHON and os.path.exists(DEBIAN_PYTHON):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON] + sys.argv)
    print(f"skipped: {missing}; expected Debian's python3-sklearn and python3-opencv")
    sys.exit(77)

JUDGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "benchmarks", "judge")
SOFT, SHARP = 1.4, 0.7  # px of an outline's blur
SIDE = 32
FRAMES = 8
CLIPS = 4
MADE_OVER_REAL = 0.8  # of the edge that comparison.json states


def aircraft(dice, size, shade, blur):
    """An ellipse before a noisy sky; RGB."""
    sky = numpy.full((SIDE, SIDE, 3), (120, 150, 190), numpy.float32)
    mask = numpy.zeros((SIDE, SIDE), numpy.float32)
    cv2.ellipse(mask, (SIDE // 2, SIDE // 2), size, float(dice.uniform(-10, 10)), 0, 360, 1, -1)
    mask = cv2.GaussianBlur(mask, None, blur)[..., None]
    picture = sky * (1 - mask) + shade * mask + dice.normal(0, 1, sky.shape)
    return numpy.clip(picture + 0.5, 0, 255).astype(numpy.uint8)


def comparison(root, name, made_blur):
    """What `compare` leaves of a clip."""
    dice = numpy.random.default_rng(sum(name.encode()))
    folder = os.path.join(root, name)
    os.makedirs(os.path.join(folder, "patches"))
    looks = [((int(dice.integers(5, 9)), int(dice.integers(2, 5))), dice.uniform(20, 90)) for _ in (1, 0)]
    rows = ['frame,real,centre x px,"longest side, px","peak contrast above, code values","peak contrast below, code values"']
    for frame in range(FRAMES):
        pair = [aircraft(dice, *look, blur) for look, blur in zip(looks, (SOFT, made_blur))]
        cv2.imwrite(os.path.join(folder, "patches", f"{frame:06}.png"), cv2.cvtColor(numpy.hstack(pair), cv2.COLOR_RGB2BGR))
        rows += [f"{frame},{real},0,{2 * looks[1 - real][0][0]},3,{-60 if real or made_blur == SOFT else -45}" for real in (1, 0)]
    with open(os.path.join(folder, "patches.csv"), "w", encoding="utf-8") as file:
        file.write("\n".join(rows) + "\n")
    with open(os.path.join(folder, "comparison.json"), "w", encoding="utf-8") as file:
        json.dump({"measures": [{"name": "edge, 10 to 90 %, px", "real": 2, "inserted": 2 * MADE_OVER_REAL},
                                {"name": "saturation", "real": None, "inserted": None}]}, file)
    return folder


class Judge(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="airtruth_judge_")
        cls.root = cls.folder.name
        cls.apart = [comparison(cls.root, f"apart-{i}", SHARP) for i in range(CLIPS)]
        cls.alike = [comparison(cls.root, f"alike-{i}", SOFT) for i in range(CLIPS)]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def run_judge(self, *arguments):
        return subprocess.run([sys.executable, "-B", JUDGE, *arguments], cwd=self.root, capture_output=True, text=True, check=False,
                              env={**os.environ, "LOKY_MAX_CPU_COUNT": "1", "OMP_NUM_THREADS": "1"})  # faster than processes for so little

    def verdict(self, folders, draws):
        done = self.run_judge("verdict", *folders, "-o", "verdict.json", "--no-network", "--draws", draws)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.root, "verdict.json"), encoding="utf-8") as file:
            return json.load(file), done.stdout

    def refused(self, words, *arguments):
        done = self.run_judge(*arguments)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(words, done.stderr)

    def test_the_difference_that_was_put_in_is_found(self):
        found, said = self.verdict(self.apart, "1")
        for judge in found["judges"]:
            for key in ("area", "pairs"):
                self.assertGreater(judge[key]["value"], 0.97, judge)
                self.assertEqual(judge[key]["by_chance"]["as_high"], 0, judge)
        self.assertGreater(found["single"]["ranked"][0]["area"], found["single"]["best_by_chance"]["median"])
        gaps = {gap["name"]: gap for gap in found["gaps"]}
        self.assertAlmostEqual(gaps["edge, 10 to 90 %, px"]["made_over_real"]["value"], MADE_OVER_REAL)
        self.assertEqual(gaps["saturation"]["clips"], 0)
        self.assertAlmostEqual(gaps["peak contrast, code values"]["made_over_real"]["value"], 0.75)  # -45 over -60
        self.assertEqual(sum(gaps[f"peak contrast, longest side over {px} px"]["clips"] for px in ("6 to 10", "10 to 20")), CLIPS)
        for words in ("| trees | ", f"| apart-{CLIPS - 1} | {FRAMES} |", "What alone tells most", "--no-network"):
            self.assertIn(words, said)

    def test_where_both_are_drawn_alike_the_judge_stays_within_chance(self):
        found, _ = self.verdict(self.alike, "3")
        for judge in found["judges"]:
            for key in ("area", "pairs"):
                self.assertGreaterEqual(judge[key]["by_chance"]["as_high"], 1, judge)
        best = found["single"]["ranked"][0]["area"]
        self.assertLessEqual(best, found["single"]["best_by_chance"]["high"])

    def test_a_sheet_is_scored_by_its_key(self):
        done = self.run_judge("sheet", *self.apart, "-o", "sheet.png", "--each", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.root, "sheet.key.csv"), encoding="utf-8") as file:
            key = [line.split(",") for line in file.read().splitlines()[1:]]
        self.assertEqual(len(key), 2 * CLIPS)
        self.assertEqual({row[1] for row in key}, {"left", "right"})
        self.assertEqual(sorted({row[2] for row in key}), [f"apart-{i}" for i in range(CLIPS)])
        self.assertNotIn("real", done.stdout)
        # At 1x and at 6x both aircraft of the first pair are those of its clip and frame, the real one where the key says.
        sheet = cv2.imread(os.path.join(self.root, "sheet.png"))
        pair = cv2.imread(os.path.join(self.root, key[0][2], "patches", f"{int(key[0][3]):06}.png"))
        real = pair[:, :SIDE]
        at = [x for x in range(sheet.shape[1] // 2 - SIDE) if (sheet[26:26 + SIDE, x:x + SIDE] == real).all()]
        self.assertEqual(len(at), 1)
        self.assertEqual(at[0] > sheet.shape[1] // 4, key[0][1] == "right")
        self.refused("--overwrite", "sheet", *self.apart, "-o", "sheet.png")
        # 8 of 8: the lower bound p has p^8 = 0.025. 6 of 8: sums of binomial terms.
        for wrong, words in ((0, "8/8 right: 1.000 (0.631 to 1.000)"), (2, "6/8 right: 0.750 (0.349 to 0.968)")):
            answers = [f"{row[0]},{row[1] if i >= wrong else ('left', 'right')[row[1] == 'left']}" for i, row in enumerate(key)]
            with open(os.path.join(self.root, "answers.csv"), "w", encoding="utf-8") as file:
                file.write("\n".join(answers) + "\n")
            self.assertIn(words, self.run_judge("score", "answers.csv", "sheet.key.csv").stdout)
        with open(os.path.join(self.root, "answers.csv"), "w", encoding="utf-8") as file:
            file.write("\n".join(answers[:-1]) + "\n")
        self.refused("does not answer the pairs", "score", "answers.csv", "sheet.key.csv")

    def test_bad_input_is_refused_in_one_line(self):
        os.makedirs(os.path.join(self.root, "empty"), exist_ok=True)
        with open(os.path.join(self.root, "odd.csv"), "w", encoding="utf-8") as file:
            file.write("1,up\n")
        self.refused("three or more", "verdict", *self.apart[:2])
        self.refused("one name", "verdict", *self.apart[:2], self.apart[1])
        self.refused("is no comparison", "verdict", *self.apart[:2], "empty")
        self.refused("expected one that ends in .png", "sheet", *self.apart, "-o", "new.jpg")
        self.refused("'1,up' is no answer", "score", "odd.csv", "odd.csv")


if __name__ == "__main__":
    unittest.main()
