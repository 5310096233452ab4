#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""./dev proof as a whole, and its readers of public sets: proof_test.py AIRTRUTH SOURCE PACKAGES

Skipped where torch (Debian's python3-torch) or OpenCV for Python is not installed. Every reader reads a set of a few made files in the layout
that the set's own page states. The command trains for a few steps on made clips of the layout it has real ones in, over a virtual flight.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import cv2
    import numpy
    import torch  # noqa: F401
except ImportError as missing:
    print(f"proof_test: skipped, {missing}: it needs Debian's python3-torch and python3-opencv")
    sys.exit(77)
AIRTRUTH, SOURCE, PACKAGES = map(os.path.abspath, sys.argv[1:4])
PROOF = os.path.join(SOURCE, "benchmarks", "proof")
sys.path[:0] = [PACKAGES, PROOF, os.path.join(SOURCE, "benchmarks")]

import measure
import sets
import splits
import tight
import trainings

WIDTH, HEIGHT = 320, 288


def picture(x, y, width, height):
    """A dark ellipse before a grey sky."""
    sky = numpy.tile(numpy.linspace(150, 180, HEIGHT).astype(numpy.uint8)[:, None], (1, WIDTH))
    cv2.ellipse(sky, (x + width // 2, y + height // 2), (width // 2, height // 2), 0, 0, 360, 40, -1)
    return sky


def write_video(path, frames):
    path.parent.mkdir(parents=True, exist_ok=True)
    video = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), 30, (WIDTH, HEIGHT))
    for frame in frames:
        video.write(cv2.cvtColor(frame, cv2.COLOR_GRAY2BGR))
    video.release()


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def made_clip(root, name, folder="", count=4, size=(24, 10)):
    """A clip of ground-real: its boxes are loose and from 1; tight ones lie in tight/, from 0, of all frames but the last."""
    boxes = [(40 + 6 * k, 60 + 3 * k, *size) for k in range(count)]
    write_video(root / folder / f"{name}.avi", [picture(*box) for box in boxes])
    write(root / folder / f"{name}.csv", "frame,x,y,w,h\n" + "".join(f"{k},{x - 4},{y - 4},{w + 10},{h + 10}\n" for k, (x, y, w, h) in enumerate(boxes)))
    if folder == "":
        write(root / "tight" / f"{name}.csv", "frame,x,y,width,height\n"
              + "".join(f"{k},{x},{y},{w},{h}\n" for k, (x, y, w, h) in enumerate(boxes[:-1])))
    return boxes


def ground_real(root):
    for name in ("V_AIRPLANE_001", "V_AIRPLANE_004", "V_HELICOPTER_004"):
        made_clip(root, name)
    made_clip(root, "V_BIRD_013", "birds", size=(10, 6))
    # The background of composites is a virtual flight, whose bird is where nobody sees it.
    flight = root / "birds" / "V_BIRD_001.mkv"
    subprocess.run([AIRTRUTH, "synth", "-o", flight, "--width", str(WIDTH), "--height", str(HEIGHT), "--frames", "4", "--no-own-aircraft"], check=True,
                   stdout=subprocess.DEVNULL)
    write(flight.with_suffix(".csv"), "frame,x,y,w,h\n" + "".join(f"{k},5,5,8,8\n" for k in range(4)))


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="airtruth_proof_")
        self.root = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()


class Readers(InFolder):
    def read(self, name):
        return {clip.name: clip for clip in sets.read_set(name, self.root).clips}

    def refused(self, name, words):
        with self.assertRaises(sets.Refused) as caught:
            sets.read_set(name, self.root)
        self.assertIn(words, str(caught.exception))
        self.assertEqual(len(str(caught.exception).splitlines()), 1)

    def check_box(self, one, kind, box):
        self.assertEqual((one.kind, [float(v) for v in one.box]), (kind, [float(v) for v in box]))

    def test_ground_real_has_tight_boxes_and_loose_ones_count_neither_way(self):
        boxes = made_clip(self.root, "V_AIRPLANE_001")
        bird = made_clip(self.root, "V_BIRD_013", "birds")
        clips = self.read("ground-real")
        aircraft = clips["V_AIRPLANE_001"]
        self.check_box(aircraft.frames[1].objects[0], "airplane", boxes[1])
        self.assertEqual((len(aircraft.frames[3].objects), len(aircraft.frames[3].ignored)), (0, 1))
        x, y, w, h = bird[0]
        self.check_box(clips["V_BIRD_013"].frames[0].objects[0], "bird", (x - 5, y - 5, w + 10, h + 10))
        greys = list(aircraft.grey(aircraft.frames[1:3]))
        self.assertEqual(greys[0].shape, (HEIGHT, WIDTH))
        x, y, w, h = boxes[2]
        self.assertLess(greys[1][y + h // 2, x + w // 2], greys[1][5, 5])

    def test_ground_real_finds_tight_boxes_in_the_pictures_where_none_are_given(self):
        """A rectangle of known sides within a loose box of two and a half times its size. In frame 4 nothing is there, in frame 6 it is twice as long."""
        boxes = [(60 + 4 * k, 80 + 2 * k, 24, 10) for k in range(12)]
        drawn = {**dict(enumerate(boxes)), 4: None, 6: (boxes[6][0] - 12, boxes[6][1], 48, 10)}
        frames = []
        for box in drawn.values():
            sky = picture(0, 0, 0, 0)
            if box is not None:
                x, y, width, height = box
                sky[y:y + height, x:x + width] = 40
            frames.append(sky)
        write_video(self.root / "V_HELICOPTER_001.avi", frames)
        loose = [(x - 18, y - 8, 60, 26) for x, y, _, _ in boxes]
        write(self.root / "V_HELICOPTER_001.csv", "frame,x,y,w,h\n" + "".join(f"{k},{x + 1},{y + 1},{w},{h}\n" for k, (x, y, w, h) in enumerate(loose)))
        clip = self.read("ground-real")["V_HELICOPTER_001"]
        self.assertEqual([frame.number for frame in clip.frames], list(range(12)))
        for frame in clip.frames:
            if frame.number in (4, 6):
                self.assertEqual(len(frame.objects), 0)
                self.assertEqual(frame.ignored.tolist(), [list(loose[frame.number])])
            else:
                self.assertEqual(([one.kind for one in frame.objects], len(frame.ignored)), (["helicopter"], 0))
                x, y, width, height = frame.objects[0].box
                left, top, w, h = boxes[frame.number]
                numpy.testing.assert_allclose((x, y, x + width, y + height), (left, top, left + w, top + h), atol=1)

    def test_a_tight_box_is_none_where_the_loose_box_does_not_hold_the_aircraft(self):
        sky = numpy.full((60, 60), 150, numpy.uint8)
        tight_box = lambda *loose: tight.tight_box(sky, numpy.array(loose, float))
        self.assertIsNone(tight_box(10, 10, 40, 30))
        sky[20:28, 5:30] = 40  # it begins left of the loose box
        self.assertIsNone(tight_box(10, 10, 40, 30))
        self.assertEqual(tight_box(-4, 10, 54, 30).tolist(), [5, 20, 25, 8])  # a loose box that reaches out of the picture
        self.assertIsNone(tight_box(58, 58, 2, 2))

    def test_clips_with_boxes_beside_them(self):
        write_video(self.root / "flight.avi", [picture(50, 50, 20, 8)] * 3)
        write(self.root / "flight.csv", "frame,x,y,width,height\n1,50,50,20,8\n")
        write(self.root / "ignore.csv", "sequence,first_frame,last_frame,x,y,width,height\nflight.mp4,0,2,40,40,40,30\n")
        flight = self.read("boxed")["flight"]
        self.assertEqual([(frame.number, len(frame.objects), len(frame.ignored)) for frame in flight.frames], [(0, 0, 1), (1, 1, 0), (2, 0, 1)])

    def test_airborne_object_tracking(self):
        entities = [{"time": 1000000000, "id": "Helicopter1", "bb": [10, 20, 30, 12], "blob": {"frame": 0, "range_distance_m": 300},
                     "labels": {"is_above_horizon": -1}, "flight_id": "f", "img_name": "1f.png"},
                    {"time": 1100000000, "id": "Flock1", "bb": [5, 6, 9, 9], "blob": {"frame": 1}, "labels": {"is_above_horizon": 1}, "flight_id": "f",
                     "img_name": "2f.png"}]
        write(self.root / "part1" / "ImageSets" / "groundtruth.json",
              json.dumps({"samples": {"f": {"metadata": {"resolution": {"width": WIDTH, "height": HEIGHT}}, "entities": entities}}}))
        for name in ("1f.png", "2f.png"):
            (self.root / "part1" / "Images" / "f").mkdir(parents=True, exist_ok=True)
            cv2.imwrite(str(self.root / "part1" / "Images" / "f" / name), picture(10, 20, 30, 12))
        clip = self.read("aot")["f"]
        self.check_box(clip.frames[0].objects[0], "helicopter", (10, 20, 30, 12))
        self.assertEqual([frame.objects[0].above_horizon for frame in clip.frames], [False, True])
        self.assertEqual(clip.frames[1].objects[0].kind, "bird")
        self.assertEqual(next(clip.grey(clip.frames)).shape, (HEIGHT, WIDTH))

    def test_nps_and_fl_drones(self):
        write_video(self.root / "videos" / "Clip_7.avi", [picture(50, 50, 20, 8)] * 2)
        write(self.root / "annotations" / "Clip_007.txt", "0,2,10,20,30,26,100,110,120,118\n1,0\n")
        for name in ("nps-drones", "fl-drones"):
            clip = self.read(name)["Clip_007"]
            self.check_box(clip.frames[0].objects[1], "uav", (100, 110, 20, 8))
            self.assertEqual(len(clip.frames[1].objects), 0)
        write(self.root / "annotations" / "Clip_007.txt", "0,2,10,20,30,26\n")
        self.refused("nps-drones", "Clip_007.txt:1")

    def test_det_fly(self):
        write(self.root / "Annotations" / "0001.xml", "<annotation><object><name>UAV</name><bndbox><xmin>11</xmin><ymin>21</ymin><xmax>40</xmax>"
              "<ymax>32</ymax></bndbox></object></annotation>")
        (self.root / "JPEGImages").mkdir()
        cv2.imwrite(str(self.root / "JPEGImages" / "0001.jpg"), picture(10, 20, 30, 12))
        clip = self.read("det-fly")["0001"]
        self.check_box(clip.frames[0].objects[0], "multirotor", (10, 20, 30, 12))
        self.assertEqual(next(clip.grey(clip.frames)).shape, (HEIGHT, WIDTH))

    def test_drone_vs_bird(self):
        write_video(self.root / "videos" / "gopro_001.avi", [picture(50, 50, 20, 8)] * 2)
        write(self.root / "annotations" / "gopro_001.txt", "0 2 10 20 30 12 drone 5 6 7 8 bird\n1 0\n")
        clip = self.read("drone-vs-bird")["gopro_001"]
        self.check_box(clip.frames[0].objects[0], "multirotor", (10, 20, 30, 12))
        self.check_box(clip.frames[0].objects[1], "bird", (5, 6, 7, 8))
        write(self.root / "annotations" / "gopro_001.txt", "0 1 10 20 thirty 12 drone\n")
        self.refused("drone-vs-bird", "gopro_001.txt:1")

    def test_what_is_no_such_set_is_refused_in_a_line(self):
        self.refused("no-set", "no reader")
        self.refused("aot", "groundtruth.json")
        self.refused("ground-real", "no labelled clip")
        self.refused("nps-drones", "videos")

    def test_every_set_states_its_licence(self):
        for name, source in sets.SOURCES.items():
            self.assertTrue(source.licence and source.where and source.targets, name)

    def test_no_clip_is_in_two_parts_of_a_split(self):
        for split in splits.SPLITS.values():
            names = split.train + split.backgrounds + split.looked_at + split.held_back
            self.assertEqual(len(names), len(set(names)))


class Measures(unittest.TestCase):
    """Two clips with an airplane of 20 x 10 px in each of two images, and one clip with a bird."""

    def images(self):
        plane = lambda: [sets.Object(numpy.array([100.0, 100, 20, 10]), "airplane")]
        bird = [sets.Object(numpy.array([50.0, 50, 10, 10]), "bird")]
        none = numpy.zeros((0, 4))
        return ([measure.Image("s", True, clip, index, plane(), [], none) for clip in "ab" for index in (0, 1)]
                + [measure.Image("s", True, "c", index, [], bird, none) for index in (0, 1)])

    def row(self, ignoring):
        rows = measure.rows_of(self.images(), {"s": ("airplane", "helicopter")})
        return next(row for row in rows if row.key["part"] == "all" and row.key["ignoring"] == ignoring)

    def test_a_bird_is_a_false_alarm_or_counts_neither_way(self):
        on_bird, on_plane = (numpy.array([[51.0, 51, 8, 8]]), numpy.array([0.9])), (numpy.array([[101.0, 100, 18, 10]]), numpy.array([0.8]))
        for ignoring, ap, recall in ((False, 4 / 6, 0), (True, 1, 1)):
            row = self.row(ignoring)
            answers = [measure.counted(image, on_bird if image.others else on_plane, ignoring) for image in row.images]
            scores = row.scores_of(answers, range(len(row.images)))
            self.assertAlmostEqual(scores[0], ap, places=3)  # every aircraft is found, below two false alarms
            self.assertEqual(scores[1], recall)  # at 0.1 an image
            self.assertEqual(scores[2], 1)
            misses, alarms = measure.errors_at(row, answers, 1)
            self.assertEqual((len(misses), [what for _, _, what in alarms]), (0, [] if ignoring else ["bird"] * 2))

    def test_what_false_alarms_are_is_told_and_can_be_written(self):
        large = (numpy.array([[200.0, 200, 60, 50]]), numpy.array([0.9]))
        found = {"real": [{("s", clip): [large, large] for clip in "abc"}]}
        told = measure.alarms_of(self.row(True), found, None)
        self.assertEqual(json.loads(json.dumps(told)), {"real": {"misses": 4, "false_alarms": 6, "by": {"background": 6}, "large": 6}})

    def test_draws_are_of_whole_clips(self):
        row = self.row(True)
        for _ in range(20):
            clips = [row.images[place].clip for place in row.drawn(numpy.random.default_rng(_))]
            self.assertEqual(len(clips), 6)
            self.assertEqual(clips.count("c"), 2)
            self.assertIn(clips.count("a"), (0, 2, 4))


class Command(InFolder):
    def run_proof(self, *arguments):
        environment = {**os.environ, "PYTHONPATH": PACKAGES, "OMP_NUM_THREADS": "1", "XDG_CACHE_HOME": str(self.root / "cache")}
        return subprocess.run([sys.executable, "-B", PROOF, *arguments], cwd=self.root, capture_output=True, text=True, check=False, env=environment)

    def test_it_trains_measures_and_goes_on(self):
        ground_real(self.root / "real")
        options = ["out", "--set", "ground-real=real", "--seeds", "1", "--steps", "3", "--frames", "3", "--negatives", "2", "--batch", "2", "--every", "2",
                   "--draws", "5"]
        done = self.run_proof(*options, "--only", "real,cut-and-paste")
        self.assertEqual(done.returncode, 0, done.stderr)
        first = {path: path.stat().st_mtime_ns for path in (self.root / "out").rglob("network.pt")}
        self.assertEqual(len(first), 2)
        done = self.run_proof(*options)  # the trainings that are there are kept
        self.assertEqual(done.returncode, 0, done.stderr)
        for path, time in first.items():
            self.assertEqual(path.stat().st_mtime_ns, time)
        result = json.loads((self.root / "out" / "proof.json").read_text())
        for row in result["rows"]:
            self.assertEqual(set(row["trainings"]), set(trainings.COMPARED))
        self.assertEqual({(row["kind"], row["ignoring"]) for row in result["rows"] if row["part"] == "all"},
                         {(kind, ignoring) for kind in ("airplane", "helicopter") for ignoring in (False, True)})
        self.assertIn("plain matte, without realism", (self.root / "out" / "proof.md").read_text())
        self.assertEqual(list((self.root / "out").rglob("*.checkpoint")), [])
        # The same folder with other options would mix two experiments.
        for arguments, words in ((["--steps", "4"], "was trained otherwise"), (["--held-back", "V_AIRPLANE_004"], "cannot be held back"),
                                 (["--only", "magic"], "no training 'magic'")):
            done = self.run_proof(*options, *arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_the_network_that_ships_is_written_and_detects(self):
        ground_real(self.root / "real")
        done = self.run_proof("out", "--set", "ground-real=real", "--only", "shipped", "--seeds", "1", "--steps", "4", "--frames", "4", "--negatives", "2",
                              "--batch", "2", "--every", "2", "--draws", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        made = self.root / "out" / "trainings" / "shipped-1" / "aircraft.onnx"
        self.assertLessEqual(made.stat().st_size, 1_000_000)
        done = subprocess.run([AIRTRUTH, "detect", self.root / "real" / "birds" / "V_BIRD_001.mkv", "-d", f"onnx:{made}", "-o", self.root / "found"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("in 4 frames", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
