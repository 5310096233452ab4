# SPDX-License-Identifier: Apache-2.0
"""airtruth.torch beside the streams that it reads: python3 python_torch_test.py AIRTRUTH SOURCE PACKAGES

Skipped where torch (Debian's python3-torch) is not installed. Pictures, boxes and labels are those of the samples; workers that are
forked or spawned give what one process gives; the examples of the docstrings give what they show, and examples/train_from_stream.py
trains.
"""

import doctest
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import torch
except ImportError:
    print("python_torch_test: skipped, torch is not installed: it needs python3-torch")
    sys.exit(77)
AIRTRUTH, SOURCE, PACKAGES = map(os.path.abspath, sys.argv[1:4])
sys.path.insert(0, PACKAGES)

import numpy as np

import airtruth

TRAINING = """[stream]
size_px = [64, 64]
intruders = [1, 3]
[[background]]
name = "clip"
video = "clip.mkv"
lens = { vertical_fov_deg = 60 }
motion = { model = "none" }
camera = { position_ned_m = [0, 0, -300], velocity_ned_mps = [25, 0, 0] }
[[random]]
count = 100
aircraft = ["c172/*"]
size_px = [10, 40]
azimuth_deg = [-20, 20]
elevation_deg = [-10, 10]
negatives = 0.2
[[distractor]]
kind = "bird"
flock = [1, 3]
size_px = [8, 30]
"""


def synth(name, width, height, frames):
    subprocess.run([AIRTRUTH, "synth", "-o", name, "--width", str(width), "--height", str(height), "--frames", str(frames),
                    "--no-own-aircraft"], check=True, stdout=subprocess.DEVNULL)


def make_inputs():
    synth("clip.mkv", 160, 120, 6)
    pathlib.Path("training.toml").write_text(TRAINING)


def sums_of(loader):
    """A number for each batch, which any other picture or target changes."""
    sums = []
    for pictures, targets in loader:
        weights = torch.arange(1, pictures[0].numel() + 1).reshape(pictures[0].shape)
        sums.append([[int((picture * weights).sum()), {name: one.tolist() for name, one in target.items() if name != "range_m"}]
                     for picture, target in zip(pictures, targets)])
    return sums


class Items(unittest.TestCase):
    def setUp(self):
        self.stream = airtruth.Stream("training.toml", seed=7)

    def test_masks_are_of_the_boxes(self):
        self.assertNotIn("masks", airtruth.torch.Dataset(self.stream, 1)[0][1])
        stream = airtruth.Stream(TRAINING.replace("[stream]", "[stream]\nmasks = true"), seed=7)
        filled = 0
        for _, target in airtruth.torch.Dataset(stream, 12, distractors=True):
            self.assertEqual([target["masks"].shape, target["masks"].dtype], [(len(target["boxes"]), 64, 64), torch.uint8])
            for mask, (x0, y0, x1, y1) in zip(target["masks"], target["boxes"]):
                rows, columns = torch.nonzero(mask, as_tuple=True)
                filled += len(rows)
                self.assertTrue(bool((columns + 1 > x0).all() and (columns < x1).all() and (rows + 1 > y0).all() and (rows < y1).all()))
        self.assertGreater(filled, 100)

    def test_an_item_is_its_sample(self):
        rgb, gray = airtruth.torch.Dataset(self.stream, 12, 5), airtruth.torch.Dataset(self.stream, 12, 5, channels="gray", dtype="float32")
        for k in range(12):
            frame = self.stream[5 + k].frames[0]
            self.assertTrue(np.array_equal(np.moveaxis(rgb[k][0].numpy(), 0, 2), frame.rgb))
            self.assertTrue(np.allclose(gray[k][0].numpy() * 255, frame.full_range_gray[None], atol=1e-4))
            self.assertEqual([rgb[k][0].dtype, gray[k][0].dtype, int(rgb[k][1]["index"])], [torch.uint8, torch.float32, 5 + k])
        self.assertTrue(torch.equal(rgb[-1][0], rgb[11][0]))
        self.assertRaises(IndexError, rgb.__getitem__, 12)

    def test_targets_are_the_boxes_that_are_in_the_picture(self):
        seen = {"boxes": 0, "ignored": 0, "birds": 0}
        for min_visible in (0, 0.5, 1):
            aircraft = airtruth.torch.Dataset(self.stream, 40, min_visible=min_visible)
            everything = airtruth.torch.Dataset(self.stream, 40, min_visible=min_visible, distractors=True)
            for k in range(40):
                wanted = self.boxes_of(self.stream[k], min_visible)
                target = everything[k][1]
                self.assertEqual(list(zip(target["boxes"].tolist(), target["labels"].tolist())), wanted)
                self.assertEqual(aircraft[k][1]["boxes"].tolist(), [box for box, label in wanted if label == 1])
                self.assertEqual(len(target["range_m"]), len(wanted))
                seen["boxes"] += len(wanted)
                seen["ignored"] += len(target["ignored"])
                seen["birds"] += sum(label == 2 for _, label in wanted)
        self.assertTrue(all(seen.values()), seen)

    def boxes_of(self, sample, min_visible):
        found = []
        for intruder, (x, y, w, h) in zip(sample.frames[0].intruders, sample.frames[0].boxes()):
            if intruder.state != "visible" or intruder.covered_box is None or np.isnan(x):
                continue
            if w * h >= min_visible * np.prod(intruder.covered_box[2:]):
                found.append(([x, y, x + w, y + h], 1 + ["aircraft", "bird"].index(intruder.object_class)))
        return found

    def test_pictures_in_a_row_are_channels(self):
        stream = airtruth.Stream(TRAINING.replace("[stream]", "[stream]\nframes = 3"), seed=7)
        picture, target = airtruth.torch.Dataset(stream, 4, channels="gray")[2]
        self.assertTrue(np.array_equal(picture.numpy(), [frame.full_range_gray for frame in stream[2].frames]))
        self.assertEqual(int(target["index"]), 2)

    def test_ultralytics_boxes_are_shares(self):
        pictures, targets = airtruth.torch.collate(list(airtruth.torch.Dataset(self.stream, 10, distractors=True)))
        batch = airtruth.torch.ultralytics(pictures, targets)
        self.assertEqual(batch["batch_idx"].tolist(), [k for k, target in enumerate(targets) for _ in target["boxes"]])
        self.assertEqual((batch["cls"][:, 0] + 1).tolist(), [label for target in targets for label in target["labels"]])
        corners = torch.cat([batch["bboxes"][:, :2] - batch["bboxes"][:, 2:] / 2, batch["bboxes"][:, :2] + batch["bboxes"][:, 2:] / 2], 1)
        self.assertTrue(torch.allclose(corners * 64, torch.cat([target["boxes"] for target in targets]), atol=1e-4))

    def test_arguments_that_are_wrong_are_named(self):
        for wrong in ({"channels": "grey"}, {"dtype": "int8"}, {"min_visible": 2}, {"min_visible": float("nan")}, {"length": -1}, {"first": -1}):
            with self.assertRaisesRegex(ValueError, next(iter(wrong))):
                airtruth.torch.Dataset(self.stream, **{"length": 3, **wrong})
        self.assertRaises(TypeError, airtruth.torch.Dataset, self.stream, 1.5)


class Workers(unittest.TestCase):
    def test_workers_give_what_one_process_gives(self):
        data = airtruth.torch.Dataset(airtruth.Stream("training.toml", seed=7), 40, distractors=True)

        def loader(workers, method=None):
            return torch.utils.data.DataLoader(data, batch_size=6, num_workers=workers, collate_fn=airtruth.torch.collate,
                                               multiprocessing_context=method)

        wanted = sums_of(loader(0))
        self.assertEqual(len(wanted), 7)
        for method in ("fork", "spawn"):
            self.assertEqual(sums_of(loader(2, method)), wanted, method)


class Pages(unittest.TestCase):
    def test_the_example_trains_and_evaluates(self):
        synth("own.mkv", 320, 240, 12)
        example = os.path.join(SOURCE, "examples", "train_from_stream.py")
        with open(example, encoding="utf-8") as file:
            self.assertLessEqual(len(file.readlines()), 60)
        done = subprocess.run([sys.executable, example, "own.mkv", "--steps", "21"], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": PACKAGES, "OMP_NUM_THREADS": "1"})
        self.assertEqual(done.returncode, 0, done.stderr)
        losses = [float(one) for one in re.findall(r"(?m)^step \d+: loss ([\d.]+)$", done.stdout)]
        self.assertEqual(len(losses), 2, done.stdout)
        self.assertLess(losses[1], losses[0])
        self.assertRegex(done.stdout, r"\d+ aircraft in 160 pictures: AP at IoU 0.5 is \d\.\d+, by centre distance \d\.\d+\n$")

    @unittest.skipUnless(importlib.util.find_spec("cv2"), "cv2 (Debian's python3-opencv) is not installed")
    def test_the_training_script_takes_a_set_and_its_stream(self):
        pathlib.Path("set.toml").write_text(TRAINING.replace("count = 100", "count = 4\nframe_count = 3").replace("[64, 64]", "[160, 120]"))
        subprocess.run([AIRTRUTH, "dataset", "build", "set.toml", "--out", "set"], check=True, capture_output=True)
        for source, words in (("set", r"8 frames, \d+ boxes"), ("set.toml", "a stream")):
            done = subprocess.run([sys.executable, os.path.join(SOURCE, "benchmarks", "train_detector.py"), source, "-o", "mine.onnx", "--steps", "2",
                                   "--batch", "4", "--every", "2"], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": PACKAGES})
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, rf"^{words}, \d+ parameters\n2 steps; wrote mine.onnx\n$")

    def test_examples(self):
        options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
        for test in doctest.DocTestFinder().find(airtruth.torch, globs={"airtruth": airtruth, "torch": torch}):
            self.assertEqual(doctest.DocTestRunner(optionflags=options).run(test).failed, 0, test.name)


if __name__ == "__main__":
    folder = tempfile.mkdtemp(prefix="airtruth_torch_")
    os.environ["XDG_CACHE_HOME"] = os.path.join(folder, "cache")
    os.chdir(folder)
    try:
        make_inputs()
        unittest.main(argv=sys.argv[:1] + sys.argv[4:], warnings="ignore")
    finally:
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=True)
