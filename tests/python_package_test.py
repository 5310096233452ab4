# SPDX-License-Identifier: Apache-2.0
"""The Python package beside the program's own files: python3 python_package_test.py AIRTRUTH SOURCE PACKAGES

PACKAGES is the folder that holds `airtruth`. A small clip and a set are made by the program. Frames and truth in memory are those of
the files; the examples of the docstrings give what they show; no argument of the table of hostile ones ends the process; Ctrl-C ends
a rendering within 2 s; what is made before a fork is refused after it. mypy checks the package where it is installed.
Without PACKAGES (the package was not built) the test is skipped.
"""

import base64
import doctest
import json
import math
import multiprocessing
import os
import pathlib
import pickle
import re
import shlex
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import warnings
import zlib

if len(sys.argv) < 4:
    print("python_package_test: skipped, the package was not built: it needs pybind11-dev and python3-dev")
    sys.exit(77)
AIRTRUTH, SOURCE, PACKAGES = map(os.path.abspath, sys.argv[1:4])
sys.path.insert(0, PACKAGES)

import numpy as np

import airtruth
from airtruth import _core, _show, evaluate

if np.lib.NumpyVersion(np.__version__) >= "2.0.0":
    np.set_printoptions(legacy="1.25")  # the examples show numbers without their types

MODULES = ("_error", "_frames", "_video", "_lens", "_render", "_labels", "_mine", "_source", "_stream", "_dataset", "_show", "_aircraft", "_motion", "_program", "_calibrate", "_encounters", "evaluate")
SCENE = """name = "across"
[background]
video = "clip.mkv"
[lens]
vertical_fov_deg = 60
[camera]
position_ned_m = [0, 0, -150]
[motion]
model = "none"
[[intruder]]
id = "a"
aircraft = "c172/news"
waypoints_ned_m = [[30, -8, -150], [30, 80, -150]]
speed_mps = 40
[output]
video = "mkv"
"""
SCENE_DICT = {
    "name": "across", "background": {"video": pathlib.Path("clip.mkv")}, "lens": {"vertical_fov_deg": 60},
    "camera": {"position_ned_m": (0, 0, np.int64(-150))}, "motion": {"model": "none"},
    "intruder": [{"id": "a", "aircraft": "c172/news", "waypoints_ned_m": np.array([[30, -8, -150], [30, 80, -150.0]]),
                  "speed_mps": np.float32(40)}],
}
TRAINING = """[stream]
picture = "crop"
size_px = [64, 64]
[[background]]
name = "clip"
video = "clip.mkv"
lens = { vertical_fov_deg = 60 }
motion = { model = "none" }
camera = { position_ned_m = [0, 0, -300], velocity_ned_mps = [25, 0, 0] }
[[random]]
count = 100
aircraft = ["c172/news"]
size_px = [10, 30]
azimuth_deg = [-20, 20]
elevation_deg = [-10, 10]
negatives = 0.2
"""
CALIBRATION = """%YAML:1.0
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 320., 0., 500., 240., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.2, 0.03, 0., 0., 0. ]
"""


def output(*arguments):
    done = subprocess.run([AIRTRUTH, *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.stderr}")
    return done.stdout





def make_inputs():
    output("synth", "-o", "clip.mkv", "--width", "160", "--height", "120", "--frames", "6", "--no-own-aircraft")
    pathlib.Path("scene.toml").write_text(SCENE)
    pathlib.Path("training.toml").write_text(TRAINING)
    for name in ("own.csv", "light_aircraft.txt"):
        shutil.copy(os.path.join(SOURCE, "examples", "encounters", name), name)
    pathlib.Path("calibration.yml").write_text(CALIBRATION)
    output("render", "scene.toml", "--out", "set")
    output("dataset", "export", "set", "-f", "coco", "-o", "coco")


def equal(a, b):
    """Whether two values of truth are the same, arrays and NaN included."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
    if hasattr(a, "__dict__"):
        return all(equal(value, getattr(b, name)) for name, value in vars(a).items())
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(map(equal, a, b))
    return a == b


def same_frame(a, b):
    return all(map(np.array_equal, a.planes, b.planes)) and equal(a.truth, b.truth)


class Frames(unittest.TestCase):
    def test_a_rendering_is_the_file_that_render_writes(self):
        with open("set/across/truth.jsonl") as file:
            lines = [json.loads(line) for line in file]
        made = list(airtruth.render("scene.toml", cache=False))
        read = list(airtruth.VideoReader("set/across/across.mkv"))
        self.assertEqual([len(made), len(read)], [6, 6])
        for frame, file, line in zip(made, read, lines):
            self.assertTrue(all(map(np.array_equal, frame.planes, file.planes)))
            self.assertTrue(np.array_equal(frame.rgb, file.rgb))
            self.assertTrue(np.shares_memory(frame.gray, frame.planes[0]))
            self.assertEqual([frame.index, frame.time_s], [line["frame"], line["time_s"]])
            self.check_intruder(frame.intruders[0], line["intruders"][0])

    def check_intruder(self, intruder, line):
        encounter = line.pop("encounter")
        volumes = encounter.pop("volumes")
        for key, value in line.items():
            found = getattr(intruder, key)
            self.assertEqual(found.tolist() if isinstance(found, np.ndarray) else found, value, key)
        for key, value in encounter.items():
            self.assertEqual(getattr(intruder.encounter, key), value, key)
        self.assertEqual(len(intruder.encounter.volumes), len(volumes))
        self.assertTrue(np.array_equal(intruder.covered_box, line["covered_box_px"]))

    def test_path_text_and_dict_are_one_scene(self):
        wanted = list(airtruth.render("scene.toml", threads=2))
        for scene in (pathlib.Path("scene.toml"), SCENE, SCENE_DICT, airtruth.toml_of(SCENE_DICT)):
            made = list(airtruth.render(scene, threads=1, cache="cache of mine"))
            self.assertTrue(len(made) == 6 and all(map(same_frame, made, wanted)))
        elsewhere = list(airtruth.render(SCENE_DICT, folder=os.getcwd()))
        self.assertTrue(all(map(same_frame, elsewhere, wanted)))

    def test_progress_is_told_and_its_exception_arrives(self):
        told = []
        list(airtruth.render("scene.toml", progress=lambda done, total: told.append((done, total))))
        self.assertEqual(told, [(k + 1, 6) for k in range(6)])
        with self.assertRaises(ZeroDivisionError):
            list(airtruth.render("scene.toml", progress=lambda done, total: 1 / 0))
        for call in (lambda **how: airtruth.motion("clip.mkv", cache=False, **how), lambda **how: airtruth.calibrate("clip.mkv", **how)):
            told.clear()
            call(progress=lambda done, total: told.append((done, total)))
            self.assertEqual((told[-1], told == sorted(told)), ((6, 6), True))
            with self.assertRaises(ZeroDivisionError):
                call(progress=lambda done, total: 1 / 0)
        told.clear()
        airtruth.sample_encounters("light_aircraft.txt", count=20, progress=lambda done, total: told.append((done, total)))
        self.assertEqual(told[-1], (20, 20))

    def test_full_range_gray_is_that_of_a_network(self):
        def frame(planes, pixel_format, matrix, is_full_range):
            return airtruth.Frame(0, 0.0, planes, pixel_format, matrix, is_full_range)

        ramp = np.arange(256, dtype=np.uint8).reshape(16, 16)
        wide = frame((ramp,), "gray", "bt601", False).full_range_gray
        self.assertEqual([wide.flat[k] for k in (0, 16, 17, 126, 235, 255)], [0, 0, 1, 128, 255, 255])
        self.assertTrue(np.array_equal(frame((ramp,), "gray", "bt601", True).full_range_gray, ramp))
        rgb = np.random.default_rng(1).integers(0, 256, (40, 30, 3), dtype=np.uint8)
        planes = tuple(np.ascontiguousarray(rgb[..., k]) for k in (1, 2, 0))
        try:
            import cv2
        except ImportError:
            return
        self.assertTrue(np.array_equal(frame(planes, "gbrp", "rgb", True).full_range_gray, cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)))

    def test_frames_outlive_what_made_them_and_travel(self):
        with airtruth.render("scene.toml") as frames:
            frame = next(frames)
            lens = frames.lens
        del frames
        copy = pickle.loads(pickle.dumps(frame))
        self.assertTrue(same_frame(copy, frame))
        for one, other in ((frame, copy), (frame.truth, copy.truth), (frame.intruders[0], copy.intruders[0])):
            self.assertEqual([one == one, one == other, one in [other, one]], [True, False, True])
        frame.planes[0][:] = 0
        self.assertGreater(copy.gray.max(), 0)
        self.assertEqual(lens.width, 160)

    def test_warnings_are_pythons(self):
        airtruth.convert_labels("coco", "coco", "of no class", "mot")
        with self.assertWarnsRegex(UserWarning, "state no class"):
            airtruth.read_labels("of no class", "mot")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            airtruth.read_labels("coco", "coco")
            self.assertRaises(UserWarning, airtruth.read_labels, "of no class", "mot")
        with open("foreign.json", "w") as file:
            json.dump({"images": [{"id": 1, "file_name": "a.png", "width": 64, "height": 64}], "categories": [{"id": 1, "name": "a\x1b[31m"}],
                       "annotations": [{"id": 1, "image_id": 1, "category_id": 1, "bbox": [1, 2, 3, 4]}]}, file)
        with self.assertWarnsRegex(UserWarning, r"'a\?\[31m'"):
            airtruth.read_labels("foreign.json", "coco")

    def test_a_notebook_shows_the_picture_with_its_box(self):
        frame = airtruth.DataSet("set")["across"].frame(3)
        page = frame._repr_html_()
        png = base64.b64decode(re.search(r"base64,([^\"]+)\"", page).group(1))
        at = png.index(b"IDAT")
        length = struct.unpack(">I", png[at - 4:at])[0]
        rows = np.frombuffer(zlib.decompress(png[at + 4:at + 4 + length]), np.uint8).reshape(120, 1 + 160 * 3)
        shown = rows[:, 1:].reshape(120, 160, 3)
        x, y, width, height = frame.intruders[0].covered_box
        drawn = np.zeros((120, 160), bool)
        drawn[y - 1:y + height + 1, x - 1:x + width + 1] = True
        drawn[y:y + height, x:x + width] = False
        self.assertTrue((shown[drawn] == (255, 160, 0)).all())
        self.assertTrue(np.array_equal(shown[~drawn], frame.rgb[~drawn]))
        frame.intruders[0].covered_box_px = None
        frame.intruders[0].exact_box_px = np.array([-1e300, -5, 1e301, 1e9])
        self.assertIn("<img", frame._repr_html_())
        self.assertIn("across", airtruth.DataSet("set")._repr_html_())

    def test_gray_of_rgb_is_luma(self):
        planes = tuple(np.full((2, 2), value, np.uint8) for value in (200, 50, 100))  # G, B, R
        frame = airtruth.Frame(0, 0.0, planes, "gbrp", "rgb", True)
        self.assertEqual(frame.gray[0, 0], round(0.299 * 100 + 0.587 * 200 + 0.114 * 50))
        self.assertEqual(frame.rgb[0, 0].tolist(), [100, 200, 50])


def same_sample(a, b):
    return [a.index, a.background, a.first_frame] == [b.index, b.background, b.first_frame] and all(map(same_frame, a.frames, b.frames))


class Streams(unittest.TestCase):
    def test_a_sample_is_what_render_makes_of_its_scene(self):
        stream = airtruth.Stream(TRAINING, seed=3)
        objects = 0
        for index in (0, 1, 17):
            frame = stream[index].frames[0]
            whole = next(airtruth.render(stream.scene(index)))
            x, y, width, height = frame.crop
            self.assertTrue(np.array_equal(frame.gray, whole.gray[y:y + height, x:x + width]))
            self.assertTrue(equal(frame.intruders, whole.intruders))
            for box, intruder in zip(frame.boxes(), frame.intruders):
                objects += 1
                if intruder.covered_box is None:
                    self.assertTrue(np.isnan(box).all())
                    continue
                left, top, w, h = intruder.covered_box
                seen = np.array([max(0, left - x), max(0, top - y), min(width, left + w - x), min(height, top + h - y)])
                if (seen[2:] - seen[:2] == [w, h]).all():
                    self.assertEqual(box.tolist(), [*seen[:2], w, h])
                elif not np.isnan(box).all():  # test_a_mask_holds_what_its_covered_box_bounds has what it bounds
                    self.assertTrue((box[:2] >= seen[:2]).all() and (box[:2] + box[2:] <= seen[2:]).all())
            self.assertIn("<img", frame._repr_html_())
        self.assertGreater(objects, 0)

    def test_samples_are_the_same_whatever_asks_for_them(self):
        stream = airtruth.Stream("training.toml", seed=5)
        wanted = [stream[index] for index in range(6)]
        self.assertTrue(same_sample(airtruth.Stream("training.toml", seed=5, threads=2)[4], wanted[4]))
        self.assertFalse(all(map(same_sample, wanted, airtruth.Stream("training.toml", seed=6))))
        found = [None] * 6

        def take(index):
            found[index] = stream[index]

        threads = [threading.Thread(target=take, args=(index,)) for index in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(all(map(same_sample, found, wanted)))
        for method in ("fork", "spawn"):
            with multiprocessing.get_context(method).Pool(2) as pool:
                self.assertTrue(all(map(same_sample, pool.map(stream.__getitem__, range(6), chunksize=3), wanted)), method)


    def test_a_mask_holds_what_its_covered_box_bounds(self):
        stream = airtruth.Stream(TRAINING.replace("[stream]", "[stream]\nmasks = true"), seed=3)
        self.assertIsNone(airtruth.Stream(TRAINING, seed=3)[0].frames[0].masks)
        bounded = 0
        for index in range(60):
            frame = stream[index].frames[0]
            self.assertEqual([frame.masks.shape, frame.masks.dtype], [(len(frame.intruders), 64, 64), np.dtype(np.uint8)])
            for mask, box in zip(frame.masks, frame.boxes()):
                covered = mask >= 20  # docs/formats/truth.md
                if not covered.any():
                    self.assertTrue(np.isnan(box).all())
                    continue
                rows, columns = np.flatnonzero(covered.any(axis=1)), np.flatnonzero(covered.any(axis=0))
                self.assertEqual(box.tolist(), [columns[0], rows[0], np.ptp(columns) + 1, np.ptp(rows) + 1])
                bounded += 1
        self.assertGreater(bounded, 2)

    def test_a_worker_that_is_killed_takes_nothing_along(self):
        wanted = [airtruth.Stream("training.toml", seed=5)[index] for index in (40, 41)]
        stream = airtruth.Stream("training.toml", seed=5)
        context = multiprocessing.get_context("fork")
        for _ in range(3):
            begun = context.Event()
            worker = context.Process(target=samples_without_end, args=(stream, begun))
            worker.start()
            self.assertTrue(begun.wait(60))
            worker.kill()
            worker.join(60)
            self.assertEqual(worker.exitcode, -signal.SIGKILL)
            again = airtruth.Stream("training.toml", seed=5)
            for opened in (stream, again):
                self.assertTrue(all(map(same_sample, [opened[40], opened[41]], wanted)))


def samples_without_end(stream, begun):
    for sample in stream:
        begun.set()


class Sets(unittest.TestCase):
    def test_columns_are_the_truth_of_each_frame(self):
        sequence = airtruth.DataSet("set")["across"]
        for k in range(len(sequence)):
            intruder = sequence.frame(k).intruders[0]
            for name, column in sequence.truth.items():
                value = getattr(intruder, name, None)
                if value is None:
                    value = getattr(intruder.encounter, name, None)
                if name not in ("frame", "time_s"):
                    wanted = np.nan if value is None else value
                    self.assertTrue(np.array_equal(column[k], wanted, equal_nan=column.dtype.kind == "f"), name)
        self.assertEqual(sequence.frames["frame_from_reference"].shape, (6, 9))
        self.assertEqual([frame.index for frame in sequence], list(range(6)))
        self.assertTrue(same_frame(sequence.frame(-1), sequence.frame(5)))
        self.assertTrue(same_frame(pickle.loads(pickle.dumps(sequence)).frame(2), sequence.frame(2)))

    def test_a_pickled_sequence_keeps_the_kind_of_its_boxes(self):
        def boxes(sequence):
            return [label.box_px.tolist() for frame in sequence.labels.frames for label in frame.labels]

        exact = airtruth.DataSet("set", boxes="exact")["across"]
        self.assertNotEqual(boxes(exact), boxes(airtruth.DataSet("set")["across"]))
        self.assertEqual(boxes(pickle.loads(pickle.dumps(exact))), boxes(exact))

    def test_a_table_is_flat(self):
        table = airtruth.DataSet("set").table()
        self.assertEqual({(column.ndim, len(column)) for column in table.values()}, {(1, 6)})
        try:
            import pandas
        except ImportError:
            print("python_package_test: pandas is not installed; the table is not given to it")
            return
        self.assertEqual(pandas.DataFrame(table)["range_m"].tolist(), table["range_m"].tolist())

    def test_an_imported_set_has_what_its_labels_tell(self):
        output("dataset", "import", "coco", "-f", "coco", "-o", "imported")
        data = airtruth.DataSet("imported")
        sequence = data[data.names[0]]
        self.assertTrue(sequence.is_imported and sequence.lens is None)
        boxes = airtruth.DataSet("set")["across"].truth["covered_box_px"]
        self.assertTrue(np.array_equal(sequence.truth["exact_box_px"], boxes[~np.isnan(boxes[:, 0])]))
        self.assertEqual(sequence.frame(0).gray.shape, (120, 160))
        self.assertIn("exact_box_px_x", data.table())

    def test_an_imported_clip_has_the_times_of_its_video(self):
        pathlib.Path("boxes.csv").write_text("frame,x,y,w,h\n0,10,20,30,40\n5,11,20,30,40\n")
        output("dataset", "import", "boxes.csv", "-f", "csv", "--video", "clip.mkv", "-o", "timed")
        sequence = airtruth.DataSet("timed")["boxes"]
        times = [frame.time_s for frame in airtruth.VideoReader("clip.mkv")]
        self.assertEqual(len(times), 6)
        self.assertTrue(np.allclose(sequence.frames["time_s"], times, atol=1e-3))
        self.assertTrue(np.allclose([frame.time_s for frame in sequence], times, atol=1e-3))
        self.assertTrue(np.allclose(sequence.truth["time_s"], [times[0], times[5]], atol=1e-3))

    def test_labels_survive_a_conversion(self):
        before = airtruth.read_labels("coco", "coco")[0]
        for format in ("yolo", "mot", "voc", "got10k"):
            airtruth.convert_labels("coco", "coco", "as " + format, format)
            if format == "yolo":
                continue
            after = airtruth.read_labels("as " + format, format, size=(160, 120))[0]
            boxes = [[label.box_px.tolist() for frame in clip.frames for label in frame.labels] for clip in (before, after)]
            self.assertTrue(boxes[0] and np.allclose(boxes[0], boxes[1], atol=0.01), format)


class Numbers(unittest.TestCase):
    def test_a_pinhole_is_its_formula(self):
        lens = airtruth.Lens.pinhole((500, 520), (320, 240), 640, 480)
        points = np.random.default_rng(1).normal(size=(50_000, 3)) * (5, 5, 50)
        pixels = lens.pixel_from_cam(points)
        ahead = points[:, 2] > 0
        self.assertTrue(np.isnan(pixels[~ahead]).all())
        wanted = points[ahead, :2] / points[ahead, 2:] * (500, 520) + (320, 240)
        self.assertTrue(np.allclose(pixels[ahead], wanted, rtol=1e-12))
        rays = lens.ray_from_pixel(pixels[ahead])
        self.assertTrue(np.allclose(rays, points[ahead] / np.linalg.norm(points[ahead], axis=1)[:, None], atol=1e-9))

    def test_arrays_of_any_layout_are_read(self):
        lens = airtruth.Lens.pinhole((500, 500), (320, 240), 640, 480)
        points = np.arange(60.0).reshape(20, 3) + 1
        wanted = lens.pixel_from_cam(points)
        for same in (points[::-1][::-1], np.asfortranarray(points), points.astype(np.int16), points.astype(">f4"), points.tolist(),
                     np.repeat(points, 2, axis=0)[::2]):
            self.assertTrue(np.array_equal(lens.pixel_from_cam(same), wanted))
        self.assertEqual(lens.pixel_from_cam([]).shape, (0, 2))
        self.assertEqual(lens.pixel_from_cam(np.empty((0, 3))).shape, (0, 2))

    def test_scores_are_those_of_the_definitions(self):
        random = np.random.default_rng(2)
        truth = np.column_stack([random.uniform(0, 100, (40, 2)), random.uniform(5, 20, (40, 2))])
        answers = truth + random.normal(size=truth.shape)
        answers[7] = np.nan
        result = evaluate.score(truth, answers)
        low, high = np.maximum(truth[:, :2], answers[:, :2]), np.minimum(truth[:, :2] + truth[:, 2:], answers[:, :2] + answers[:, 2:])
        both = np.prod(np.maximum(high - low, 0), axis=1)
        ious = np.nan_to_num(both / (truth[:, 2:].prod(axis=1) + answers[:, 2:].prod(axis=1) - both))
        self.assertTrue(np.allclose(evaluate.overlap(truth, answers), ious))
        self.assertAlmostEqual(result.average_overlap, ious[1:].mean())
        self.assertEqual(result.success.shape, (21,))
        self.assertEqual(evaluate.mean_of([result, result]).counted, 80)
        late = evaluate.score([[np.nan] * 4, [10, 10, 20, 10]], [[10, 10, 20, 10], [20, 10, 20, 10]])
        self.assertAlmostEqual(evaluate.mean_of([late]).average_overlap, 1 / 3)
        self.assertEqual(pickle.loads(pickle.dumps(result)).auc, result.auc)

    def test_intervals_of_average_precision_need_two_sequences(self):
        box, none = [[10, 10, 20, 10]], np.empty((0, 4))
        images = [box, box, box, box], [box, none, box, box], [[0.9], [], [0.8], [0.7]]
        self.assertIsNone(evaluate.average_precision(*images).ap_50_interval)
        ap = evaluate.average_precision(*images, sequences=[7, 7, 9, 9])
        self.assertTrue(ap.ap_50_interval[0] <= ap.ap_50 <= ap.ap_50_interval[1])
        flagged = evaluate.average_precision(*images, ignored=[[0], [1], [0], [0]])
        self.assertEqual([flagged.curve_50.truths, round(flagged.ap_50, 9)], [3, 1])


class Detectors(unittest.TestCase):
    """Average precision, FROC, HOTA and AOT of random flights, beside the numbers of `airtruth evaluate`, without and with regions in which
    detections count neither way."""

    @classmethod
    def setUpClass(cls):
        random = np.random.default_rng(5)
        cls.columns = {name: [] for name in ("truth", "truth_tracks", "ranges_m", "above_horizon", "detections", "scores", "tracks", "sequences")}
        results = []
        for flight in range(3):
            name = f"flight-{flight}"
            labels = [{"format": "airtruth labels 1", "name": name, "width": 640, "height": 480, "frame_rate_hz": 10}]
            for frame in range(60 + flight):
                ids = [1, 2] if frame % 20 else [1]
                boxes = [[100.0 * k + 2 * frame, 90.0 * k, 8 + 0.2 * frame, 5 + 0.1 * frame] for k in ids]
                ranges, above = [abs(500 * k - 9.5 * frame) + 50 for k in ids], [1 if k == 1 else -1 for k in ids]
                seen = [k for k in ids if random.random() < 0.8]
                found = [[x + random.normal(0, 1), y + random.normal(0, 1), w * random.uniform(0.8, 1.2), h] for x, y, w, h in
                         (boxes[ids.index(k)] for k in seen)]
                tracks = [10 * k + (frame > 40) for k in seen]
                if random.random() < 0.4:
                    found.append([random.uniform(0, 600), random.uniform(300, 440), 9.0, 7.0])
                    tracks.append(100 + frame // 9)
                scores = random.uniform(0, 1, len(found)).tolist()
                labels.append({"frame": frame, "labels": [
                    {"track": k, "category": "738", "box_px": box, "range_m": r, "above_horizon": a > 0}
                    for k, box, r, a in zip(ids, boxes, ranges, above)]})
                for column, values in zip(cls.columns.values(), (boxes, ids, ranges, above, found, scores, tracks, flight)):
                    column.append(values)
                results += [{"image_id": len(cls.columns["truth"]), "category_id": 1, "bbox": box, "score": score, "track_id": track}
                            for box, score, track in zip(found, scores, tracks)]
            folder = pathlib.Path("detected/sequences", name)
            folder.mkdir(parents=True)
            (folder / "labels.jsonl").write_text("".join(json.dumps(line) + "\n" for line in labels))
            (folder / "sequence.json").write_text(json.dumps(
                {"format": "airtruth labelled clip 1", "version": "1", "name": name, "imported_from": "csv", "frames": len(labels) - 1,
                 "labels": sum(len(line["labels"]) for line in labels[1:]), "categories": ["738"]}))
        pathlib.Path("mine.json").write_text(json.dumps(results))
        region = [0, 300, 320, 180]
        pathlib.Path("regions.csv").write_text("sequence,first_frame,last_frame,x,y,width,height\nflight-1,,," + ",".join(map(str, region)) + "\n")
        regions = [[region] if flight == 1 else np.empty((0, 4)) for flight in cls.columns["sequences"]]
        cls.cases = [(cls.evaluated("evaluated"), {}), (cls.evaluated("evaluated_regions", "--ignore", "regions.csv"), {"regions": regions})]

    @staticmethod
    def evaluated(out, *options):
        output("evaluate", "detected", "mine.json", "-o", out, "--no-page", *options)
        with open(f"{out}/detection.json") as file:
            return json.load(file)["detectors"][0]

    def taken(self, *names):
        return {name: self.columns[name] for name in names}

    def test_regions_change_what_is_told(self):
        (plain, _), (with_regions, _) = self.cases
        for measure in ("average_precision", "froc", "aot", "tracks"):
            self.assertNotEqual(plain[measure], with_regions[measure], measure)

    def test_average_precision_is_the_programs_to_the_last_bit(self):
        for told, regions in self.cases:
            found = evaluate.average_precision(**self.taken("truth", "detections", "scores", "sequences"), **regions)
            for name in ("ap", "ap_50", "ap_75", "ap_small", "ar_100", "ap_centre"):
                self.assertEqual(getattr(found, name), told["average_precision"][name], name)

    def test_froc_is_the_programs_to_the_last_bit(self):
        for told, regions in self.cases:
            self.check_froc(told["froc"], evaluate.froc(**self.taken("truth", "detections", "scores", "sequences"), rate_hz=10, **regions))
        flagged = evaluate.froc([[[0, 0, 9, 9]]], [[[0, 0, 9, 9]]], [[1]], ignored=[[1]])
        self.assertEqual([flagged.score.size, flagged.hours, flagged.false_alarms_per_hour, flagged.aircraft], [0, None, None, 0])

    def check_froc(self, told, found):
        self.assertEqual([found.images, found.flights, found.hours, found.aircraft],
                         [told[name] for name in ("images", "flights", "hours", "aircraft_in_images")])
        self.assertGreater(len(told["points"]), 50)
        for name in ("score", "false_alarms_per_image", "false_alarms_per_hour", "false_alarms_per_flight"):
            self.assertEqual(getattr(found, name).tolist(), [point[name] for point in told["points"]], name)
        shares = [point["detection"] for point in told["points"]]
        self.assertEqual(found.detection.tolist(), [share["share"] for share in shares])
        self.assertEqual(np.stack([found.detection_low, found.detection_high], 1).tolist(), [share["interval_95"] for share in shares])

    def test_hota_is_the_programs_to_the_last_bit(self):
        for told, regions in self.cases:
            told = told["tracks"]["hota"]
            found = evaluate.hota(**self.taken("truth", "truth_tracks", "detections", "tracks", "sequences"), **regions)
            for name, values in told.items():
                self.assertEqual([getattr(found, name), found.at_overlaps[name].tolist()], [values["mean"], values["at_overlaps"]], name)
            self.assertEqual(set(told), set(found.at_overlaps))
        with self.assertRaisesRegex(ValueError, "track 1 twice"):
            evaluate.hota([[[0, 0, 9, 9]] * 2], [[1, 1]], [[]], [[]])

    def test_aot_is_the_programs_to_the_last_bit(self):
        columns = self.taken("truth", "truth_tracks", "ranges_m", "above_horizon", "detections", "scores", "tracks", "sequences")
        for told, regions in self.cases:
            found = evaluate.aot(**columns, rate_hz=10, **regions)
            self.check_aot(told, found, evaluate.aot_ranks(**columns, rate_hz=10, **regions))
        strict = evaluate.aot(**columns, min_score=0.9)
        self.assertTrue(strict.hfar is None and strict.score == 0.9 and strict.edr[0] <= found.edr[0])

    def check_aot(self, told_of, found, ranks):
        self.assertGreater(found.edr[1], 2)
        for score, key in ((found, "aot"), (ranks[0], "aot_at_hfar_0.5"), (ranks[1], "aot_at_fppi_0.0005")):
            told = told_of[key]
            if told is None:
                self.assertIsNone(score, key)
                continue
            for name, value in told.items():
                one = getattr(score, name)
                wanted = [value["detected"], value["total"], value["rate"]] if isinstance(value, dict) else value
                self.assertEqual(list(one) if isinstance(one, tuple) else one, wanted, name)

    def test_what_is_not_defined_is_none(self):
        box = [[0, 0, 9, 9]]
        aot = evaluate.aot([box], [[1]], [box], [[1]])
        self.assertEqual((aot.edr, aot.edr_mixed, aot.afdr), ((0, 0, None),) * 3)
        nothing = evaluate.aot([], [], [], [], rate_hz=10)
        self.assertEqual((nothing.hfar, nothing.fppi), (None, None))
        curve = evaluate.froc([[]], [box], [[1]])
        self.assertEqual((curve.detection, curve.detection_low, curve.detection_high), (None,) * 3)
        self.assertEqual(curve.false_alarms_per_image.tolist(), [1])
        for restart in (evaluate.restart_score([], (1, 2)), evaluate.restart_score([(box, None, [])], (1, 2))):
            self.assertEqual((restart.accuracy, restart.failures, restart.reliability, restart.eao), (None,) * 4)
        multistart = evaluate.multistart_score([], (1, 2))
        self.assertEqual((multistart.accuracy, multistart.robustness, multistart.eao), (None,) * 3)
        self.assertEqual(evaluate.paired([], []).difference, None)

    def test_flagged_aircraft_and_what_is_on_them_are_left_out(self):
        counted, flagged, beside = [0, 0, 20, 10], [100, 0, 20, 10], [109, 0, 20, 10]
        plain, ignored = ([counted],) * 4, ([counted, flagged],) * 4
        hota = evaluate.hota(ignored, [[1, 2]] * 4, [[counted, beside]] * 4, [[7, 8]] * 4, ignored=[[0, 1]] * 4)
        self.assertEqual(hota.hota, evaluate.hota(plain, [[1]] * 4, plain, [[7]] * 4).hota)
        far = evaluate.hota(ignored, [[1, 2]] * 4, [[counted, [120, 0, 20, 10]]] * 4, [[7, 8]] * 4, ignored=[[0, 1]] * 4)
        near = evaluate.hota(ignored, [[1, 2]] * 4, [[counted, [120, 0, 20, 10]]] * 4, [[7, 8]] * 4, ignored=[[0, 1]] * 4, centre_px=20)
        self.assertTrue(far.hota < 1 and near.hota == 1)
        aot = evaluate.aot(ignored, [[1, 2]] * 4, [[counted, [112, 9, 20, 10]]] * 4, [[1, 1]] * 4, ranges_m=[[300, 300]] * 4, ignored=[[0, 1]] * 4,
                           centre_px=20)
        self.assertEqual(aot.fppi, 0)
        self.assertEqual(evaluate.aot_ranks(ignored, [[1, 2]] * 4, [[[112, 9, 20, 10]]] * 4, [[1]] * 4, ignored=[[0, 1]] * 4)[1], None)


HOSTILE = [
    None, True, -1, 0, 3, 2**31, 2**63, 2**70, -2**70, 1.5, math.nan, math.inf, 1e300, "", "x", "\0", "a\nb", "\ud800", b"\xff", "x" * 5000,
    [], {}, (), [[]], [None], ["a"], {"a": object()}, object(), [1, 2, 3, 4], [[1, 2]], [[1, 2, 3]], [[1, 2, 3, 4]], [[1, 2, 3, -4]],
    [[math.nan] * 4], [[math.inf] * 4], [[1e308] * 4], [[[1, 2, 3]]], [[1, 2], [3]], np.zeros((0, 4)), np.zeros((2, 3, 4)), np.zeros(3, complex),
    np.array(["a"]), np.array([None]), np.zeros(4, "M8[s]"), np.zeros(2, [("a", "i4")]), np.broadcast_to(np.zeros((1, 1)), (4, 4)),
    np.zeros((4, 8))[::2, ::2], np.zeros((3, 4), np.float16), (2, -3), (0, 0), (2**40, 2**40), pathlib.Path("."), pathlib.Path("scene.toml"),
    lambda *a: None, int, sys, iter([1]), np.float64(3), np.ma.zeros((2, 2)),
]
MODEL_OPTIONS = ("count", "seed", "duration_s", "domain", "airspace", "altitude_ft", "cpa_time_s", "hmd_m", "hmd_shares", "vmd_m", "vmd_shares",
                 "jobs")
GEOMETRY = ("course_deg", "speed_mps", "climb_mps", "turn_rate_dps")
EXPECTED = (airtruth.Error, TypeError, ValueError, OverflowError, IndexError, KeyError, AttributeError, OSError)


def hostile_targets():
    """Functions by name, and good arguments of each, of which one at a time is replaced."""
    lens = airtruth.Lens.pinhole((500, 500), (320, 240), 640, 480)
    data = airtruth.DataSet("set")
    boxes = [[0, 0, 9, 9], [1, 1, 9, 9]]
    score = evaluate.score(boxes, boxes)
    run_ = (boxes, [1, 3])
    frame = data["across"].frame(0)
    stream = airtruth.Stream("training.toml", seed=1)

    def html_of(frame, box, crop):
        frame = pickle.loads(pickle.dumps(frame))
        frame.intruders[0].covered_box_px, frame.crop = box, crop
        return frame._repr_html_()

    return {
        "Lens": (airtruth.Lens, [lens._core]),
        "Lens.pinhole": (airtruth.Lens.pinhole, [(500, 500), (320, 240), 640, 480]),
        "Lens.pinhole_from_vertical_fov": (airtruth.Lens.pinhole_from_vertical_fov, [60, 640, 480]),
        "Lens.brown_conrady": (airtruth.Lens.brown_conrady, [(500, 500), (320, 240), [0, 0, 0, 0], 640, 480]),
        "Lens.fisheye": (airtruth.Lens.fisheye, [(500, 500), (320, 240), [0.1], 640, 480, 1.5]),
        "Lens.from_file": (airtruth.Lens.from_file, ["calibration.yml", 640, 480]),
        "pixel_from_cam": (lens.pixel_from_cam, [[[0, 0, 1]]]),
        "ray_from_pixel": (lens.ray_from_pixel, [[[0, 0]]]),
        "render": (lambda *a: next(airtruth.render(a[0], threads=a[1], cache=a[2], progress=a[3], folder=a[4])),
                   ["scene.toml", 1, True, None, None]),
        "render dict": (lambda value: airtruth.render({**SCENE_DICT, "camera": value}), [{"position_ned_m": [0, 0, -150]}]),
        "toml_of": (airtruth.toml_of, [{"a": 1}]),
        "VideoReader": (lambda *a: next(airtruth.VideoReader(*a)), ["clip.mkv", 0]),
        "DataSet": (lambda folder, boxes: airtruth.DataSet(folder, boxes=boxes)["across"], ["set", "covered"]),
        "DataSet[]": (lambda name: data[name], ["across"]),
        "in": (lambda name: name in data, ["across"]),
        "Sequence.frame": (data["across"].frame, [0]),
        "read_labels": (lambda *a: airtruth.read_labels(a[0], a[1], size=a[2], category=a[3]), ["coco", "coco", (160, 120), "x"]),
        "convert_labels": (lambda *a: airtruth.convert_labels(*a[:4], part=a[4]), ["coco", "coco", "set", "mot", "p"]),
        "rgb": (lambda *a: airtruth.Frame(0, 0.0, *a).rgb, [frame.planes, frame.pixel_format, frame.matrix, False]),
        "rgb of a plane": (lambda plane: airtruth.Frame(0, 0.0, (plane,), "gray", "bt601", False).rgb, [frame.planes[0]]),
        "boxes": (frame.boxes, ["covered"]),
        "boxes of a crop": (lambda box, crop: html_of(frame, box, crop), [[0, 0, 9, 9], [2, 2, 9, 9]]),
        "Stream": (lambda *a: airtruth.Stream(a[0], seed=a[1], threads=a[2], cache=a[3], folder=a[4])[0], ["training.toml", 1, 1, True, None]),
        "run": (lambda *a: airtruth.run(a[0], a[1], format=a[2], out=a[3], progress=a[4]), ["dataset export", "set", "mot", "hostile", None]),
        "Stream[]": (stream.__getitem__, [0]),
        "Stream.scene": (stream.scene, [0]),
        "motion": (lambda *a: airtruth.motion(a[0], model=a[1], lens=a[2], mask=a[3], reference=a[4], smoothing_s=a[5], cache=a[6]),
                   ["clip.mkv", "auto", None, None, "first_frame", 1, True]),
        "calibrate": (lambda *a: airtruth.calibrate(a[0], lens=a[1], mask=a[2], altitude_m=a[3], heading_deg=a[4], gamma=a[5], profile=a[6]),
                      ["clip.mkv", None, None, None, 0, 0, ""]),
        "calibrate clips": (lambda *a: airtruth.calibrate(a), ["clip.mkv", "clip.mkv"]),
        "aircraft": (airtruth.aircraft, ["c172"]),
        "left_out_aircraft": (airtruth.left_out_aircraft, ["*"]),
        "show_aircraft": (lambda *a: airtruth.show_aircraft(a[0], forward=a[1], up=a[2], scale=a[3]), ["c172/news", "", "", 0]),
        "sample_encounters": (lambda model, own, *a: airtruth.sample_encounters(model, own=own, **dict(zip(MODEL_OPTIONS, a))),
                              ["light_aircraft.txt", "own.csv", 3, 1, 20, None, None, [0, 9000], 10, [-90, 90], [1], [-9, 9], [1], 1]),
        "sample_encounters geometric": (lambda *a: airtruth.sample_encounters("geometric", own="own.csv", count=3, **dict(zip(GEOMETRY, a))),
                                        [[-90, 90], 60, 0, 1]),
        "score": (lambda *a: evaluate.score(a[0], a[1], seconds=a[2], size=a[3]), [boxes, boxes, [1, 1], (9, 9)]),
        "mean_of": (evaluate.mean_of, [[score]]),
        "mean_of one": (lambda one: evaluate.mean_of([one]), [score]),
        "first_loss": (evaluate.first_loss, [boxes, boxes]),
        "overlap": (evaluate.overlap, [boxes, boxes]),
        "average_precision": (lambda *a: evaluate.average_precision(*a[:3], sequences=a[3], ignored=a[4], centre_px=a[5], regions=a[6]),
                              [[boxes], [boxes], [[1, 1]], [0], [[0, 0]], 10, [boxes]]),
        "average_precision image": (lambda *a: evaluate.average_precision([a[0]], [a[1]], [a[2]]), [boxes, boxes, [1, 1]]),
        "froc": (lambda *a: evaluate.froc(*a[:3], sequences=a[3], ignored=a[4], rate_hz=a[5], centre_px=a[6], regions=a[7]),
                 [[boxes], [boxes], [[1, 1]], [0], [[0, 0]], 10, 10, [boxes]]),
        "froc image": (lambda *a: evaluate.froc([a[0]], [a[1]], [a[2]]), [boxes, boxes, [1, 1]]),
        "hota": (lambda *a: evaluate.hota(*a[:4], sequences=a[4], ignored=a[5], regions=a[6], centre_px=a[7]),
                 [[boxes], [[1, 2]], [boxes], [[1, 2]], [0], [[0, 1]], [boxes], 10]),
        "hota image": (lambda *a: evaluate.hota(*([one] for one in a)), [boxes, [1, 2], boxes, [1, 2]]),
        "aot": (lambda *a: evaluate.aot(*a[:4], tracks=a[4], ranges_m=a[5], above_horizon=a[6], sequences=a[7], rate_hz=a[8], min_score=a[9],
                                        min_track_frames=a[10], ignored=a[11], regions=a[12], centre_px=a[13]),
                [[boxes], [[1, 2]], [boxes], [[1, 1]], [[1, 2]], [[300, 300]], [[0, 1]], [0], 10, 0.5, 0, [[0, 1]], [boxes], 10]),
        "aot image": (lambda *a: evaluate.aot([a[0]], [a[1]], [a[2]], [a[3]], tracks=[a[4]], ranges_m=[a[5]], above_horizon=[a[6]]),
                      [boxes, [1, 2], boxes, [1, 1], [1, 2], [300, 300], [0, 1]]),
        "aot_ranks": (lambda *a: evaluate.aot_ranks(*a[:4], rate_hz=a[4]), [[boxes], [[1, 2]], [boxes], [[1, 1]], 10]),
        "bootstrap_mean": (evaluate.bootstrap_mean, [[1, 2], [1, 1]]),
        "paired": (evaluate.paired, [[1, 2], [1, 1]]),
        "kendall_tau": (evaluate.kendall_tau, [[1, 2], [1, 1]]),
        "restart_score": (evaluate.restart_score, [[(boxes, None, [run_])], (1, 2)]),
        "restart_score sequence": (lambda *a: evaluate.restart_score([a], (0, 2)), [boxes, (9, 9), [run_]]),
        "restart_score run": (lambda *a: evaluate.restart_score([(boxes, (9, 9), [a])], (0, 2)), [boxes, [1, 3]]),
        "multistart_score": (evaluate.multistart_score, [[(boxes, None, [(0, False, *run_)])], (1, 2)]),
        "multistart_score run": (lambda *a: evaluate.multistart_score([(boxes, (9, 9), [a])], (0, 2)), [0, False, boxes, [1, 3]]),
        "anchors_of": (evaluate.anchors_of, [boxes, 1]),
        "eao_range": (evaluate.eao_range, [[1, 2, 3]]),
    }


class Clips(unittest.TestCase):
    def small_lens(self):
        """The calibration for pictures of 160 x 120."""
        numbers = {"640": "160", "480": "120", "500.": "125.", "320.": "80.", "240.": "60."}
        with open("small.yml", "w") as file:
            file.write(re.sub("|".join(map(re.escape, numbers)), lambda found: numbers[found.group(0)], CALIBRATION))

    def table(self, *arguments):
        """The rows of motion.csv, its columns by name."""
        output("motion", "clip.mkv", "--overwrite", "-o", "motion.csv", *arguments)
        with open("motion.csv") as file:
            rows = [line.rstrip().split(",") for line in file]
        return dict(zip(rows[0], zip(*rows[1:])))

    def test_motion_is_the_programs_table(self):
        self.small_lens()
        for cache in (False, "cache of motion", "cache of motion"):
            for arguments, options in (([], {}), (["--reference", "smoothed", "--smoothing", "0.1"], {"reference": "smoothed", "smoothing_s": 0.1}),
                                       (["--lens", "small.yml"], {"lens": "small.yml"})):
                table, moved = self.table(*arguments), airtruth.motion("clip.mkv", cache=cache, **options)
                for name in ("frame", "time_s", "inliers", "rms_px"):
                    self.assertEqual([float(cell) for cell in table[name]], getattr(moved, name).tolist(), name)
                self.assertEqual(list(table["state"]), moved.state)
                if moved.lens:
                    found, names = moved.cam_from_reference_cam, ("qw", "qx", "qy", "qz")
                    self.assertEqual([moved.lens.model, moved.lens.width], ["brown_conrady", 160])
                else:
                    found, names = moved.frame_from_reference.reshape(6, 9), [f"h{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)]
                self.assertEqual([[float(cell) for cell in table[name]] for name in names], found.T.tolist())
        self.assertTrue(os.listdir("cache of motion/motion"))
        for options, words in (({"model": "none"}, "expected auto"), ({"model": "rotation"}, "needs a lens"), ({"reference": "x"}, "first_frame"),
                               ({"model": "homography", "lens": "small.yml"}, "knows none"), ({"smoothing_s": 0}, "smoothing")):
            with self.assertRaisesRegex(airtruth.Error, words):
                airtruth.motion("clip.mkv", **options)


    def test_a_calibration_is_the_programs_camera_file(self):
        self.small_lens()
        options = {"lens": "small.yml", "altitude_m": 150, "heading_deg": 30, "gamma": 2.2}
        output("synth", "-o", "sixty.mkv", "--width", "160", "--height", "120", "--frames", "60", "--no-own-aircraft")
        told = output("calibrate", "sixty.mkv", "-o", "camera.toml", "--lens", "small.yml", "--altitude", "150", "--heading", "30", "--gamma", "2.2")
        found = airtruth.calibrate("sixty.mkv", **options)
        with open("camera.toml") as file:
            written = file.read()
        self.assertEqual(found.toml, written)
        self.assertIn(f"{sum(one.value is not None for table in found.quantities.values() for one in table.values())} values from 60 frames", told)
        table = ""
        stated = {}
        for line in written.splitlines():
            table = line[1:-1] if line.startswith("[") else table
            if re.match(r"\w+ = [-\d\[]", line):
                key, value = line.split("#")[0].split(" = ")
                stated[table, key] = json.loads(value)
        for name, keys in found.quantities.items():
            for key, one in keys.items():
                self.assertEqual(one.value is None, (name, key) not in stated, (name, key))
                self.assertEqual(one.value is None, bool(one.missing), (name, key))
                if one.value is not None:
                    self.assertTrue(np.allclose(one.value, stated[name, key], rtol=1e-2), (name, key, one, stated[name, key]))
                    self.assertEqual(np.shape(one.value), np.shape(one.sigma))
        self.assertTrue(len(found.horizon_frame) == len(found.horizon_pitch_deg) == len(found.horizon_roll_deg))
        both = airtruth.calibrate([pathlib.Path("sixty.mkv"), "sixty.mkv"], profile="none")
        self.assertEqual([both.clips, both.frames, {one.source for one in both.quantities["light"].values()}], [2, 120, {""}])
        for arguments, words in (({"altitude_m": 0}, "altitude"), ({"heading_deg": 361}, "heading"), ({"gamma": 1}, "gamma"),
                                 ({"profile": "gopro"}, "no camera profile"), ({"profile": "gopro-karma"}, "px")):
            with self.assertRaisesRegex(airtruth.Error, words):
                airtruth.calibrate("clip.mkv", **arguments)
        with self.assertRaisesRegex(airtruth.Error, "no clip"):
            airtruth.calibrate([])


def write_sky(folder, bright):
    """Numbered pictures of a flat grey sky with one bright pixel each: (x, y, level) of each frame."""
    os.makedirs(folder)
    for number, (x, y, level) in enumerate(bright):
        rgb = np.full((120, 160, 3), 100, np.uint8)
        rgb[y, x] = level
        pathlib.Path(folder, f"{number:04}.png").write_bytes(_show._png(rgb))


BRIGHTEST = f"exec:{sys.executable} {shlex.quote(os.path.join(SOURCE, 'clients', 'brightest_detector.py'))}"  # boxes of 5 x 5 px; the score is the level / 255


class Mined(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # One thing in frames 0 to 19, brightest in frame 7, and another at another place from frame 20 on, brightest in frame 25.
        cls.bright = [(30, 40, 250 if k == 7 else 240) for k in range(20)] + [(120, 80, 235 if k == 25 else 230) for k in range(20, 30)]
        write_sky("sky", cls.bright)

    def mine(self, folder, **arguments):
        return airtruth.mine(folder, detector=BRIGHTEST, frame_rate_hz=25, **arguments)

    def check(self, mined, frames):
        self.assertEqual([alarm.frame for alarm in mined.alarms], frames)
        for alarm in mined.alarms:
            x, y, level = self.bright[alarm.frame]
            self.assertEqual(alarm.box.tolist(), [x - 2, y - 2, 5, 5])
            self.assertAlmostEqual(alarm.score, level / 255, places=5)

    def test_a_thing_counts_once_in_so_many_frames_by_its_best(self):
        self.check(self.mine("sky"), [7, 25])
        self.check(self.mine("sky", every=5), [7, 0, 12, 17, 25, 20])
        self.check(self.mine("sky", every=5, count=3), [7, 0, 12])
        self.check(self.mine("sky", min_score=0.93), [7])
        self.assertEqual(len(self.mine("sky", every=1, count=None).alarms), 30)

    def test_words_of_aircraft_are_alarms_and_other_classes_are_not(self):
        pathlib.Path("words.py").write_text("\n".join((
            "import sys", f"sys.path.insert(0, {os.path.join(SOURCE, 'clients')!r})", "from airtruth_detector import Server, detection",
            "server = Server()", "for frame in server:",
            "    server.reply([detection((10 + 30 * k, 20, 5, 5), 0.9, word) for k, word in enumerate(sys.argv[1:])])")))
        mined = airtruth.mine("sky", detector=f"exec:{sys.executable} words.py airplane Aeroplanes bird drone aircraft", frame_rate_hz=25)
        self.assertEqual(sorted(alarm.box[0] for alarm in mined.alarms), [10, 40, 130])

    def test_what_moves_is_one_thing_by_its_track(self):
        write_sky("moving", [(40 + k, 60, 200 + k) for k in range(30)])
        self.assertEqual([alarm.frame for alarm in self.mine("moving").alarms], [29])

    def test_pictures_are_those_of_the_video_about_the_box(self):
        mined = self.mine("sky", every=5)
        whole = list(airtruth.VideoReader("sky"))
        grey = mined.crops((21, 31), channels="gray")
        for alarm, picture, colour in zip(mined.alarms, grey, mined.crops((21, 31))):
            x, y, _ = self.bright[alarm.frame]
            self.assertTrue(np.array_equal(picture, whole[alarm.frame].gray[y - 15:y + 16, x - 10:x + 11]))
            self.assertTrue(np.array_equal(colour, whole[alarm.frame].rgb[y - 15:y + 16, x - 10:x + 11]))
            self.assertEqual(alarm.time_s, alarm.frame / 25)
        self.assertEqual(mined.crops((160, 120)).shape, (6, 120, 160, 3))
        self.assertEqual([(frame.index, len(alarms)) for frame, alarms in mined.frames()], [(k, 1) for k in (0, 7, 12, 17, 20, 25)])
        for arguments in (((161, 20),), ((0, 20),), ((20, 20), "hsv"), ((20,),)):
            self.assertRaises(ValueError, mined.crops, *arguments)

    def test_backgrounds_make_composites_of_those_frames_alone(self):
        mined = self.mine("sky", every=5)
        tables = mined.backgrounds({"name": "home", "lens": {"vertical_fov_deg": 60}, "motion": {"model": "none"},
                                    "camera": {"position_ned_m": [0, 0, -300]}})
        self.assertEqual([table["name"] for table in tables], ["home-7", "home-0", "home-12", "home-17", "home-25", "home-20"])
        stream = airtruth.Stream({"stream": {"size_px": [64, 64]}, "background": tables,
                                  "random": [{"count": 9, "aircraft": ["c172/*"], "size_px": [8, 20]}]})
        self.assertEqual({stream[k].first_frame for k in range(24)} | {stream[64 * k].first_frame for k in range(24)}, {0, 7, 12, 17, 20, 25})
        self.assertAlmostEqual(sum(table["weight"] for table in tables), 1)
        two = mined.backgrounds({"name": "home", "lens": {"vertical_fov_deg": 60}, "motion": {"model": "none"}, "camera": {"position_ned_m": [0, 0, -300]}}, 2)
        self.assertEqual([(table["first_frame"], table["frame_count"]) for table in two[:2]], [(7, 2), (0, 2)])
        rules = [{"name": f"{start}-{{index}}", "count": 1, "frame_count": 5, "start": start, "aircraft": ["c172/*"], "size_px": [8, 20]} for start in ("first", "random")]
        pathlib.Path("mined.toml").write_text(airtruth.toml_of({"background": two[4:5], "random": rules}))
        output("dataset", "build", "mined.toml", "--out", "mined")
        data = airtruth.DataSet("mined")
        self.assertEqual(len(data.names), 2)
        for name in data.names:  # frames 25 and 26, in which the second thing is there and the first is not
            levels = [(int(frame.gray[80, 120]), int(frame.gray[40, 30])) for frame in data[name]]
            self.assertEqual(len(levels), 2, name)
            self.assertTrue(all(second > first + 30 for second, first in levels), levels)

    def test_an_empty_sky_gives_none(self):
        write_sky("empty", [(0, 0, 100)] * 4)
        mined = airtruth.mine("empty", frame_rate_hz=25)
        self.assertEqual((mined.alarms, mined.backgrounds({}), list(mined.frames()), mined.crops((20, 10)).shape), ([], [], [], (0, 10, 20, 3)))

    def test_what_cannot_be_mined_is_said_in_a_line(self):
        for arguments, words in ((("none.mp4",), "none.mp4: does not exist"), (("-none.mp4",), "does not exist"), (("sky", "nothing"), "there is no detector 'nothing'"),
                                 (("sky", "exec:false"), "the detector ended with status 1"), (("sky", "onnx:no.onnx"), "no.onnx")):
            with self.assertRaisesRegex(airtruth.Error, words) as caught:
                airtruth.mine(arguments[0], detector=arguments[1] if len(arguments) > 1 else "cmo", frame_rate_hz=25)
            self.assertEqual(len(str(caught.exception).splitlines()), 1)
        with self.assertRaisesRegex(airtruth.Error, "numbered pictures, which state no rate; expected frame_rate_hz"):
            airtruth.mine("sky")
        for arguments in ({"every": 0}, {"count": 0}):
            self.assertRaises(ValueError, airtruth.mine, "sky", **arguments)
        os.environ["AIRTRUTH_PROGRAM"] = "/nothing/airtruth"
        try:
            self.assertRaisesRegex(airtruth.Error, "/nothing/airtruth: No such file", airtruth.mine, "sky")
        finally:
            del os.environ["AIRTRUTH_PROGRAM"]


class Flights(unittest.TestCase):
    def test_the_catalogue_is_that_of_the_program(self):
        listed = output("aircraft", "list", "--sizes").splitlines()
        found = airtruth.aircraft()
        self.assertEqual([line.split()[0] for line in listed], [one.name for one in found])
        for line, one in zip(listed, found):
            words = "no published size is known: its scale is not checked" if not one.type else one.type
            if one.span_m:
                words += f": span {one.span_m:.2f} m, length {one.length_m:.2f} m"
            self.assertEqual(line.split(None, 1), [one.name, words])
        self.assertEqual(output("aircraft", "list", "--left-out").splitlines(),
                         [f"{name:<40} {why}" for name, why in airtruth.left_out_aircraft().items()])

    def test_an_aircraft_is_what_the_program_shows(self):
        one = airtruth.show_aircraft("c172/news")
        told = output("aircraft", "show", "c172/news")
        self.assertIn(f"length {one.length_m:.2f} m, span {one.span_m:.2f} m, height {one.height_m:.2f} m", told)
        self.assertIn(f"{one.triangles} triangles, {one.textures} textures, {one.file}", told)
        self.assertEqual(told.split("other liveries:\n")[1].split(), one.liveries)
        with open("box.obj", "w") as file:
            file.write("v 0 0 0\nv 4 0 0\nv 0 0 2\nv 0 1 0\nf 1 2 3\nf 1 3 4\n")
        box = airtruth.show_aircraft(pathlib.Path("box.obj"), forward="x", up="y", scale=2)
        self.assertEqual([box.length_m, box.span_m, box.height_m, box.triangles, box.liveries], [8, 4, 2, 2, []])


    def test_encounters_are_the_rows_of_the_programs_file(self):
        model = ("--hmd-m", "-90", "0", "90", "--hmd-shares", "1", "2", "--cpa-time", "18", "--duration", "30"), {
            "hmd_m": [-90, 0, 90], "hmd_shares": [1, 2], "cpa_time_s": 18, "duration_s": 30}
        geometry = ("--course-deg", "150", "210", "--climb-mps", "-2", "2"), {"course_deg": (150, 210), "climb_mps": [-2, 2.0]}
        for name, own, (flags, options) in (("light_aircraft.txt", "own.csv", model), ("geometric", "own.csv", geometry),
                                            ("light_aircraft.txt", None, (("--altitude-ft", "1000", "1500"), {"altitude_ft": [1000, 1500]}))):
            told = output("encounter", "sample", name, "--count", "40", "--seed", "9", "-o", "met.csv", "--overwrite", *flags,
                          *(("--own", own) if own else ()))
            met = airtruth.sample_encounters(name, own=own, count=40, seed=9, jobs=2, **options)
            with open("met.csv") as file:
                head, *lines = [line.rstrip().split(",") for line in file]
            cells = dict(zip(head, zip(*lines)))
            found = {"encounter": met.encounter, "time_s": met.time_s}
            for k, axis in enumerate(("north", "east", "down")):
                found[axis + "_m"], found[axis + "_mps"] = met.position_ned_m[:, k], met.velocity_ned_mps[:, k]
            if "weight" in cells:
                found["weight"] = met.weights[met.encounter - 1]
            for key, column in found.items():
                self.assertEqual([float(cell) for cell in cells[key]], column.tolist(), key)
            self.assertEqual(list(cells["aircraft"]), [met.aircraft_names[k] for k in met.aircraft])
            if met.share < 1:
                self.assertIn(f"the cut holds {100 * met.share:.3g} %", told)
            if name != "geometric":
                self.assertIn(f"{met.draws / 40:.3f} draws a track", told)
            self.assertAlmostEqual(met.effective_count, met.weights.sum() ** 2 / (met.weights ** 2).sum())
        for options, words in (({"hmd_m": 9}, "hmd_m belongs to encounters; expected own"), ({"course_deg": 9}, "course_deg belongs to geometric"),
                               ({"own": "own.csv", "hmd_m": [9, 3]}, "hmd_m is 9 3"), ({"domain": 1}, "no geographic domain"),
                               ({"altitude_ft": [1]}, "altitude_ft is not two"), ({"count": 0}, "0 encounters"), ({"count": -5}, "-5 encounters")):
            with self.assertRaisesRegex(airtruth.Error, words):
                airtruth.sample_encounters("light_aircraft.txt", **options)
        with self.assertRaisesRegex(airtruth.Error, "own is missing"):
            airtruth.sample_encounters("geometric")


class Hostile(unittest.TestCase):
    def test_every_function_refuses_or_answers(self):
        refused = 0
        for name, (function, good) in hostile_targets().items():
            with self.subTest(name):
                function(*good) if name != "convert_labels" else None
                for position in range(len(good)):
                    for value in HOSTILE:
                        arguments = [*good[:position], value, *good[position + 1:]]
                        with warnings.catch_warnings():
                            warnings.simplefilter("ignore")
                            try:
                                function(*arguments)
                            except EXPECTED as error:
                                refused += 1
                                if isinstance(error, airtruth.Error):
                                    self.assertEqual(len(str(error).splitlines()), 1, f"{position} {value!r}: {error}")
        self.assertGreater(refused, 2000)

    def test_core_refuses_too(self):
        """The private module, to which nothing stands between."""
        for name in dir(_core):
            function = getattr(_core, name)
            if not callable(function):
                continue
            for count in range(5):
                for value in HOSTILE:
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        try:
                            function(*[value] * count)
                        except EXPECTED:
                            pass

    def test_values_that_are_wrong_are_named(self):
        lens = airtruth.Lens.pinhole((500, 500), (320, 240), 640, 480)
        for wrong, kind, words in (
            (lambda: lens.pixel_from_cam([[1, 2]]), ValueError, r"points has the shape \(1, 2\); expected \(n, 3\)"),
            (lambda: lens.pixel_from_cam([["a", "b", "c"]]), TypeError, "points has the dtype"),
            (lambda: evaluate.overlap([[0, 0, -1, 1]], [[0, 0, 1, 1]]), ValueError, "row 0 of a is no box"),
            (lambda: airtruth.render("no such.toml"), airtruth.Error, "no such.toml"),
            (lambda: airtruth.render({"backgroud": {}}), airtruth.Error, "background"),
            (lambda: airtruth.render("scene.toml", threads=-1), ValueError, "threads is -1"),
            (lambda: airtruth.render({"a": object()}), TypeError, "a is a object"),
            (lambda: airtruth.DataSet("set")["other"], airtruth.Error, "other"),
            (lambda: airtruth.DataSet("set")["across"].frame(6), IndexError, "there is no frame 6; across has 6"),
            (lambda: airtruth.DataSet("set")[0], TypeError, "name is of the type int; expected a text"),
            (lambda: airtruth.DataSet("set", boxes=1)["across"], TypeError, "boxes is of the type int; expected a text"),
            (lambda: airtruth.Stream("training.toml", seed=-1), ValueError, "seed is -1; expected 0 to 18446744073709551615"),
            (lambda: airtruth.Stream("training.toml", threads=2**70), ValueError, "threads is 1180591620717411303424; expected 0 to 256"),
            (lambda: airtruth.VideoReader("clip.mkv", first_frame=2**64), ValueError, "first_frame is 18446744073709551616; expected 0 to"),
            (lambda: airtruth.VideoReader("clip.mkv", first_frame=-1), ValueError, "first_frame is -1; expected 0 to"),
            (lambda: airtruth.render("scene.toml", threads=1.5), TypeError, "threads is of the type float; expected a whole number"),
            (lambda: airtruth.motion("clip.mkv", model=3), TypeError, "model is of the type int; expected a text"),
            (lambda: airtruth.sample_encounters("geometric", own="own.csv", jobs=257), ValueError, "jobs is 257; expected 0 to 256"),
            (lambda: airtruth.Lens.pinhole((1,), (2, 3), 64, 48), TypeError, "focal_px is of the type tuple; expected two numbers"),
            (lambda: airtruth.Lens.pinhole((1, 1), (2, 3), 0, 48), ValueError, "width is 0; expected 1 to 65536"),
            (lambda: evaluate.score([], [], size=(2**70, 1)), ValueError, "width is 1180591620717411303424; expected 1 to 65536"),
            (lambda: evaluate.bootstrap_mean([1, math.nan]), ValueError, "number 1 of values is infinite or NaN"),
            (lambda: evaluate.average_precision([[[0, 0, 9, 9]]], [[[0, 0, 9, 9]]], [[math.inf]]), ValueError, "number 0 of scores is infinite or NaN"),
            (lambda: airtruth.HardNegatives(pathlib.Path("clip.mkv"), "cmo", []).crops((-1, 9)), ValueError, r"size_px is \[-1, 9\]; expected a width"),
            (lambda: airtruth.run(None), TypeError, "command is of the type NoneType; expected a text"),
            (lambda: airtruth.toml_of([1]), TypeError, "source is of the type list; expected a dict"),
            (lambda: evaluate.mean_of([3]), TypeError, "scores holds one of the type int; expected a Score"),
            (lambda: airtruth.VideoReader("clip.mkv", 6), airtruth.Error, "6 frames"),
            (lambda: airtruth.read_labels("coco", "cocoo"), airtruth.Error, "coco"),
            (lambda: airtruth.aircraft("c127"), airtruth.Error, "no name among .* contains 'c127'; the nearest are .*c172"),
        ):
            with self.assertRaisesRegex(kind, words) as caught:
                wrong()
            self.assertEqual(len(str(caught.exception).splitlines()), 1, str(caught.exception))
        deep = {}
        deep["deep"] = deep
        with self.assertRaises(ValueError):
            airtruth.render(deep)

    def test_a_lens_is_the_same_in_another_process(self):
        for lens in (
            airtruth.Lens.pinhole((500, 510), (320, 240), 640, 480),
            airtruth.Lens.brown_conrady((500, 500), (320, 240), [-0.2, 0.03, 0, 0], 640, 480),
            airtruth.Lens.fisheye((300, 300), (320, 240), [0.1], 640, 480),
            airtruth.Lens.fisheye((300, 300), (320, 240), [0.1], 640, 480, max_angle_rad=0.5),
        ):
            copy = pickle.loads(pickle.dumps(lens))
            self.assertEqual((copy.model, copy.width, copy.height), (lens.model, lens.width, lens.height))
            point = [[0.3, -0.2, 1]]
            self.assertTrue(np.array_equal(copy.pixel_from_cam(point), lens.pixel_from_cam(point)))
            self.assertEqual(copy.max_angle_rad, lens.max_angle_rad)
            self.assertEqual(copy, lens)
            self.assertEqual(hash(copy), hash(lens))
            self.assertNotEqual(lens, airtruth.Lens.pinhole((500, 511), (320, 240), 640, 480))
        self.assertEqual(copy.max_angle_rad, 0.5)
        moved = airtruth.Motion(640, 480, lens, *[np.zeros(0)] * 6, [], None)
        self.assertEqual(pickle.loads(pickle.dumps(moved)).lens.model, "fisheye")

    def test_use_after_close_is_an_error(self):
        frames, video = airtruth.render("scene.toml"), airtruth.VideoReader("clip.mkv")
        for one in (frames, video):
            next(one)
            one.close()
            one.close()
            with self.assertRaisesRegex(airtruth.Error, "is closed"):
                next(one)
        with self.assertRaisesRegex(airtruth.Error, "is closed"):
            frames.lens

    def test_two_threads_in_one_object_are_refused_or_take_turns(self):
        outcomes = []

        def take(source):
            try:
                outcomes.extend(frame.index for frame in source)
            except airtruth.Error as error:
                outcomes.append(str(error))

        for source in (airtruth.render("scene.toml"), airtruth.VideoReader("clip.mkv")):
            outcomes.clear()
            threads = [threading.Thread(target=take, args=(source,)) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(sorted(one for one in outcomes if isinstance(one, int)), list(range(6)))


def frame_in_child(queue):
    queue.put([next(airtruth.render("scene.toml")), airtruth.DataSet("set")["across"].frame(2)])


class Commands(unittest.TestCase):
    """airtruth.run()."""

    def test_every_command_can_be_run(self):
        with open(os.path.join(SOURCE, "docs", "reference", "commands.md")) as file:
            names = re.findall(r"(?m)^##+ airtruth (.+)$", file.read())
        self.assertGreater(len(names), 30)
        for name in names:
            self.assertIn(f"airtruth {name}", airtruth.run(name, help=True))

    def test_it_is_the_programs_own_work(self):
        self.assertEqual(airtruth.run("aircraft list", "c172/*", sizes=True, left_out=False), output("aircraft", "list", "--sizes", "c172/*"))
        shown = airtruth.run("dataset export", pathlib.Path("set"), format="mot", out=pathlib.Path("mot_run"), images=None)
        self.assertEqual(shown.replace("mot_run", "mot_program"), output("dataset", "export", "set", "--format", "mot", "-o", "mot_program"))
        lists = {"course_deg": [150, 210]}
        airtruth.run("encounter sample", "geometric", own="own.csv", count=5, out="run.csv", **lists)
        output("encounter", "sample", "geometric", "--own", "own.csv", "--count", "5", "--course-deg", "150", "210", "-o", "program.csv")
        self.assertEqual(pathlib.Path("run.csv").read_text(), pathlib.Path("program.csv").read_text())

    def test_progress_is_told_and_its_exception_ends_the_program(self):
        told = []
        airtruth.run("synth", out="told.mkv", width=64, height=64, frames=300, progress=lambda *now: told.append(now))
        self.assertEqual((told[-1], told == sorted(told)), ((300, 300), True))
        with self.assertRaises(ZeroDivisionError):
            airtruth.run("synth", out="broken.mkv", width=64, height=64, frames=100000, progress=lambda *now: 1 / 0)
        self.assertFalse(os.path.exists("broken.mkv"))

    def test_messages_are_pythons(self):
        for arguments, options, words in ((("rendr",), {}, "there is no command 'rendr'; did you mean 'render'"),
                                          (("dataset plam", "x"), {}, "there is no command 'plam'; did you mean 'plan'"),
                                          (("render", "scene.toml"), {"ou": "x"}, "there is no option '--ou'; did you mean '--out'"),
                                          (("render", "none.toml"), {}, "none.toml: cannot open"),
                                          (("render", "-none.toml"), {}, "-none.toml: cannot open")):
            with self.assertRaisesRegex(airtruth.Error, words) as caught:
                airtruth.run(*arguments, **options)
            self.assertEqual(len(str(caught.exception).splitlines()), 1)
        pathlib.Path("slow.toml").write_text(SCENE.replace("speed_mps = 40", "speed_mps = 5"))
        with self.assertWarnsRegex(UserWarning, "cannot fly its path") as caught:
            airtruth.run("render", "slow.toml", out="slow")
        self.assertEqual(os.path.basename(caught.filename), "python_package_test.py")

    def test_all_that_the_program_says_arrives(self):
        said = '{"level": "warning", "message": "a\\nb"}\nof a library\n{"level": "error", "message": "first"}\n{"level": "error", "message": "last"}\n'
        pathlib.Path("says.sh").write_text(f"#!/bin/sh\necho out\ncat >&2 <<'END'\n{said}END\nexit $STATUS\n")
        os.chmod("says.sh", 0o755)
        for status in ("0", "1"):
            with unittest.mock.patch.dict(os.environ, AIRTRUTH_PROGRAM=os.path.abspath("says.sh"), STATUS=status), warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                if status == "0":
                    self.assertEqual(airtruth.run("x"), "out\n")
                else:
                    with self.assertRaisesRegex(airtruth.Error, "^last$"):
                        airtruth.run("x")
            self.assertEqual([str(one.message) for one in told], ["a b", "of a library", "first"] + ["last"] * (status == "0"))


class Processes(unittest.TestCase):
    def test_fork_and_spawn(self):
        wanted = [next(airtruth.render("scene.toml")), airtruth.DataSet("set")["across"].frame(2)]
        for method in ("fork", "spawn"):
            context = multiprocessing.get_context(method)
            queue = context.Queue()
            child = context.Process(target=frame_in_child, args=(queue,))
            child.start()
            got = queue.get(timeout=60)
            child.join(60)
            self.assertEqual(child.exitcode, 0, method)
            self.assertTrue(all(map(same_frame, got, wanted)), method)

    def test_what_was_made_before_a_fork_is_refused_and_left_alone(self):
        objects = [airtruth.render("scene.toml"), airtruth.VideoReader("clip.mkv")]
        sequence = airtruth.DataSet("set")["across"]
        for one in objects:
            next(one)
        sequence.frame(0)
        child = os.fork()
        if child == 0:
            refused = 0
            for one in objects:
                try:
                    next(one)
                except airtruth.Error as error:
                    refused += "fork" in str(error)
            works = sequence.frame(1).index == 1
            del one, objects, sequence
            os._exit(0 if refused == 2 and works else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertEqual([next(one).index for one in objects], [1, 1])

    def test_a_daemon_thread_does_not_end_the_process(self):
        lines = {"while it reads": "list(airtruth.VideoReader('clip.mkv'))",
                 "while it draws": f"list(airtruth.render({SCENE!r}))",
                 "while it streams": f"[airtruth.Stream({TRAINING!r})[k] for k in range(50)]"}
        for when, line in lines.items():
            code = (f"import sys, threading, time; sys.path.insert(0, {PACKAGES!r}); import airtruth\n"
                    f"def work():\n  while True: {line}\n"
                    "threading.Thread(target=work, daemon=True).start(); time.sleep(0.6); print('over')\n")
            for _ in range(3):
                child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
                self.assertEqual([child.stdout, child.stderr, child.returncode], ["over\n", "", 0], when)

    def test_ctrl_c_ends_a_call(self):
        output("synth", "-o", "long.mkv", "--width", "320", "--height", "240", "--frames", "150", "--no-own-aircraft")
        measured = SCENE.replace("clip.mkv", "long.mkv").replace('model = "none"', 'model = "rotation"\n[realism]\nauto = true')
        programs = {"while it measures": "for _ in range(9**9): airtruth.render(source, cache=False)",
                    "while it draws": "for _ in range(9**9): list(airtruth.render(source, cache=False))",
                    "while it streams": "list(stream)",
                    "while it measures motion": "for _ in range(9**9): airtruth.motion(source, cache=False)",
                    "while it calibrates": "for _ in range(9**9): airtruth.calibrate(source)",
                    "while the program runs": "airtruth.run('synth', out='endless.mkv', width=64, height=64, frames=1000000)",
                    "while it draws encounters": "airtruth.sample_encounters('light_aircraft.txt', count=1000000)",
                    "while it scores": "airtruth.evaluate.average_precision([source] * 20000, [source] * 20000, [range(30)] * 20000)"}
        boxes = [[k, k, 20, 10] for k in range(30)]
        waited = []
        for (when, line), source in zip(programs.items(), (measured, SCENE, TRAINING, "long.mkv", "long.mkv", "", "", boxes)):
            code = (f"import sys; sys.path.insert(0, {PACKAGES!r}); import airtruth\nsource = {source!r}\n"
                    f"stream = airtruth.Stream({TRAINING!r})\nprint('begun', flush=True)\n"
                    f"try:\n  {line}\nexcept KeyboardInterrupt:\n  print('stopped', stream[7].index)\n")
            child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            child.stdout.readline()
            time.sleep(0.4)
            begin = time.monotonic()
            child.send_signal(signal.SIGINT)
            told = child.stdout.readline()
            waited.append(time.monotonic() - begin)
            rest, errors = child.communicate(timeout=60)
            self.assertEqual([told + rest, errors, child.returncode], ["stopped 7\n", "", 0], when)
        print(f"Ctrl-C ends a call after {max(waited):.1f} s at most")


class Pages(unittest.TestCase):
    def test_examples(self):
        options = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE | doctest.IGNORE_EXCEPTION_DETAIL
        tried = 0
        for name in MODULES:
            module = __import__("airtruth." + name, fromlist=["*"])
            for test in doctest.DocTestFinder().find(module, "airtruth." + name, module=False, globs={"airtruth": airtruth, "np": np, "pathlib": pathlib}):
                result = doctest.DocTestRunner(optionflags=options).run(test)
                self.assertEqual(result.failed, 0, test.name)
                tried += len(test.examples) > 0
        self.assertGreater(tried, 30)

    def test_all_that_is_public_has_a_page(self):
        page = os.path.join(SOURCE, "docs", "reference", "make_python.py")
        checked = subprocess.run([sys.executable, page, PACKAGES, "--check"], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_types(self):
        if shutil.which("mypy") is None:
            print("python_package_test: mypy is not installed; the types are not checked")
            return
        checked = subprocess.run(["mypy", "--config-file", os.path.join(SOURCE, "python", "mypy.ini"), "--cache-dir", "mypy",
                                  os.path.join(SOURCE, "python", "airtruth")], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)

    def test_the_stub_names_what_the_module_has(self):
        with open(os.path.join(SOURCE, "python", "airtruth", "_core.pyi")) as file:
            stub = file.read()
        for name in (name for name in dir(_core) if not name.startswith("_")):
            self.assertRegex(stub, rf"(?m)^(class|def) {name}\b|^{name}: ")
        for kind, body in re.findall(r"(?m)^class (\w+):\n((?: .*\n)+)", stub):
            stated = set(re.findall(r"(?m)^    (?:def )?(\w+)[(:]", body)) - {"__init__"}
            self.assertEqual(stated, {name for name in vars(getattr(_core, kind)) if not name.startswith("_")}, kind)


if __name__ == "__main__":
    folder = tempfile.mkdtemp(prefix="airtruth_python_")
    os.environ["XDG_CACHE_HOME"] = os.path.join(folder, "cache")
    os.chdir(folder)
    try:
        make_inputs()
        unittest.main(argv=sys.argv[:1] + sys.argv[4:], warnings="ignore")
    finally:
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=True)
