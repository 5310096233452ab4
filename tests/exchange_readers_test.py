#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every format that `dataset export` writes is read as its official reader reads it.

exchange_readers_test.py AIRTRUTH

Two sets are exported: one that `dataset build` makes, of which all is known, and one that `dataset import` makes of
boxes in CSV, of which nothing else is. Each reader below follows the code or the rules that its docstring names, with
the types that these demand, and hands back the boxes in pixels from 0; they must be those of truth.jsonl and of the
CSV. Two sets named and written as their publishers do are imported with their pictures.
"""
import configparser
import csv
import glob
import io
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

try:
    import cv2
    import numpy
    import pandas
    import yaml
except ImportError as missing:
    DEBIAN_PYTHON = "/usr/bin/python3"
    if sys.executable != DEBIAN_PYTHON and os.path.exists(DEBIAN_PYTHON):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON] + sys.argv)
    print(f"skipped: {missing}; expected Debian's python3-numpy, python3-opencv, python3-pandas and python3-yaml")
    sys.exit(77)

AIRTRUTH = ""
WIDTH, HEIGHT = 160, 120

# The aircraft come nearer than 330 m in more than 30 frames, which makes an encounter of AOT, and leave through the
# picture's edge.
CATALOGUE = """
name = "readers"
[[background]]
name = "a, b"
flight = { seed = 3, frame_count = 36, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
[[aircraft]]
name = "c172"
aircraft = "c172/news"
[[trajectory]]
name = "past"
waypoints_ned_m = [[330, 0, -160], [150, 170, -160]]
speed_mps = 205
[[product]]
name = "{background}-{trajectory}-{aircraft}"
[output]
video = "mkv"
masks = true
"""

# Frame, x, y, width, height: whole and broken pixels, two objects in one frame, one over the picture's edge. The second
# object is there in one frame alone, of which the toolkits of single objects want no sequence.
IMPORTED = [(0, 10, 20, 30, 40), (0, 100.5, 7.25, 12.5, 9), (2, 11.5, 20, 30.25, 40), (5, 150, 100, 14, 30)]


def airtruth(*arguments):
    done = subprocess.run([AIRTRUTH, *map(str, arguments)], capture_output=True, text=True, errors="replace", timeout=240)
    if done.returncode != 0:
        raise AssertionError(f"airtruth {arguments}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done


def whole(text):
    """A number that is written as a whole one."""
    return int(text)


class Clip:
    def __init__(self, name, frames, cut=None, covered=None):
        self.name = name
        self.frames = frames  # of each frame: {track: (x, y, width, height)}
        self.cut = cut or set()  # (frame, track) that the picture's edge cuts
        self.covered = covered or []  # of each frame, the bounds of what the only track covers; None: nothing

    def tracks(self):
        return sorted({track for frame in self.frames for track in frame})

    def single_objects(self):
        """The clips of the single-object formats: from the first whole frame (or the first) to the last."""
        clips = {}
        for track in self.tracks():
            shown = [i for i, frame in enumerate(self.frames) if track in frame]
            whole_ones = [i for i in shown if (i, track) not in self.cut]
            first = whole_ones[0] if whole_ones else shown[0]
            name = self.name if len(self.tracks()) == 1 else f"{self.name}-{track}"
            if shown[-1] > first:
                clips[name] = [frame.get(track) for frame in self.frames[first:shown[-1] + 1]]
        return clips


def clipped(box):
    x, y = max(box[0], 0), max(box[1], 0)
    return (x, y, min(box[0] + box[2], WIDTH) - x, min(box[1] + box[3], HEIGHT) - y)


def whole_pixels(box):
    x, y, w, h = clipped(box)
    left, top = math.floor(x), math.floor(y)
    return (left, top, math.ceil(x + w) - left, math.ceil(y + h) - top)


class Readers(unittest.TestCase):
    """A test a format, over both sets, with and without pictures."""

    where = ""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.root = pathlib.Path(cls.folder.name)
        (cls.root / "catalogue.toml").write_text(CATALOGUE)
        airtruth("dataset", "build", cls.root / "catalogue.toml", "--out", cls.root / "built")
        cls.built = []
        sequences = sorted((cls.root / "built/sequences").iterdir())
        for sequence in sequences:
            frames, cut, covered = [], set(), []
            for i, line in enumerate((sequence / "truth.jsonl").read_text().splitlines()):
                intruder = json.loads(line)["intruders"][0]
                box = intruder.get("visible_box_px")
                frames.append({1: tuple(box)} if box else {})
                covered.append(intruder.get("covered_box_px"))
                if box and intruder["cut_by_frame"] > 0:
                    cut.add((i, 1))
            cls.built.append(Clip(sequence.name, frames, cut, covered))
        cls.media = next(path for path in sequences[0].iterdir() if path.suffix == ".mkv")
        (cls.root / "boxes.csv").write_text("frame,x,y,w,h\n" + "".join(
            ",".join(map(str, row)) + "\n" for row in IMPORTED))
        airtruth("dataset", "import", cls.root / "boxes.csv", "--format", "csv", "--video", cls.media,
                 "--out", cls.root / "imported")
        frames = [{} for _ in range(6)]
        for frame, *box in IMPORTED:
            frames[frame][len(frames[frame]) + 1] = tuple(box)
        cls.imported = [Clip("boxes", frames)]
        cls.takes_boxes = "--boxes" in airtruth("dataset", "export", "--help").stdout

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def exports(self, form, images=("default", "none"), options=()):
        """(folder, clips, has pictures) of every export in a format."""
        if self.takes_boxes:
            options = (*options, "--boxes", "visible")
        for name, clips in (("built", self.built), ("imported", self.imported)):
            for pictures in images:
                out = self.root / f"{form}-{name}-{pictures}-{len(list(self.root.iterdir()))}"
                chosen = () if pictures == "default" else ("--images", pictures)
                airtruth("dataset", "export", self.root / name, "--format", form, "--out", out, *chosen, *options)
                self.where = f"{form} of the {name} set, images {pictures}"
                yield out, clips, pictures != "none"

    def _formatMessage(self, message, standard):  # every failure says of which export it is
        return f"{self.where}: {super()._formatMessage(message, standard)}"

    def parts(self, folder):
        return [name for name in ("train", "val", "test", "all") if (folder / name).is_dir()]

    def check_picture(self, file):
        picture = cv2.imread(str(file))
        self.assertIsNotNone(picture, file)
        self.assertEqual(picture.shape[:2], (HEIGHT, WIDTH))

    def check_box(self, got, expected, tolerance=1e-9):
        for a, b in zip(got, expected, strict=True):
            self.assertAlmostEqual(a, b, delta=tolerance)

    def check_frames(self, got, clips, change=lambda box: box, tolerance=1e-9, has_tracks=True):
        """`got`: name -> frame -> {track: box}."""
        self.assertEqual(sorted(got), sorted(clip.name for clip in clips))
        for clip in clips:
            for i, expected in enumerate(clip.frames):
                found = got[clip.name].get(i, {})
                boxes = [change(box) for box in expected.values()]
                if has_tracks:
                    self.assertEqual(sorted(found), sorted(expected))
                self.assertEqual(len(found), len(boxes))
                for key, box in zip(sorted(found), boxes):
                    self.check_box(found[key], box, tolerance)

    def test_coco(self):
        """pycocotools/coco.py: createIndex, getAnnIds, annToRLE; cocoeval.py: _prepare; cocodataset.org,
        "Data format"."""
        for out, clips, has_pictures in self.exports("coco"):
            got = {}
            for file in (out / "annotations").glob("instances_*.json"):
                part = file.stem.removeprefix("instances_")
                data = json.loads(file.read_text())
                self.assertIsInstance(data["info"], dict)
                self.assertIsInstance(data["licenses"], list)
                names = {}
                for category in data["categories"]:
                    self.assertIs(type(category["id"]), int)
                    self.assertTrue(category["name"] and category["supercategory"])
                    names[category["id"]] = category["name"]
                videos = {video["id"]: video["name"] for video in data["videos"]}
                images = {}
                for image in data["images"]:
                    self.assertIs(type(image["id"]), int)
                    self.assertNotIn(image["id"], images)
                    self.assertEqual((image["width"], image["height"]), (WIDTH, HEIGHT))
                    images[image["id"]] = image
                    got.setdefault(videos[image["video_id"]], {})[image["frame_id"]] = {}
                    if has_pictures:
                        self.check_picture(out / "images" / part / image["file_name"])
                ids = set()
                for annotation in data["annotations"]:
                    self.assertIs(type(annotation["id"]), int)
                    self.assertNotEqual(annotation["id"], 0)  # cocoeval takes 0 for "no match"
                    self.assertNotIn(annotation["id"], ids)
                    ids.add(annotation["id"])
                    image = images[annotation["image_id"]]
                    self.assertIn(annotation["category_id"], names)
                    self.assertIs(type(annotation["iscrowd"]), int)
                    self.assertEqual(annotation["iscrowd"], 0)
                    x, y, w, h = annotation["bbox"]
                    if clips is self.built:
                        clip = next(clip for clip in clips if clip.name == videos[image["video_id"]])
                        self.check_run_lengths(annotation, clip.covered[image["frame_id"]])
                        got[videos[image["video_id"]]][image["frame_id"]][annotation["track_id"]] = (x, y, w, h)
                        continue
                    self.assertAlmostEqual(annotation["area"], w * h)
                    # A list of polygons, each of at least three corners; its area by the shoelace formula.
                    (polygon,) = annotation["segmentation"]
                    self.assertGreaterEqual(len(polygon), 6)
                    corners = list(zip(polygon[::2], polygon[1::2]))
                    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, corners[1:] + corners[:1])) / 2
                    self.assertAlmostEqual(abs(area), w * h)
                    got[videos[image["video_id"]]][image["frame_id"]][annotation["track_id"]] = (x, y, w, h)
            self.check_frames(got, clips)

    def check_run_lengths(self, annotation, covered):
        """common/maskApi.c, rleFrString: run lengths of the columns, zeros first, of size [height, width]; as text five
        bits a character from '0' on, the lowest first, 32 where more follow, 16 in the last a sign; from the fourth on
        the difference to the last but one."""
        counts, text = [], annotation["segmentation"]["counts"]
        at = 0
        while at < len(text):
            value, bits, more = 0, 0, True
            while more:
                code = ord(text[at]) - 48
                self.assertTrue(0 <= code < 64)
                value |= (code & 31) << bits
                more = code & 32
                at, bits = at + 1, bits + 5
            if code & 16:
                value -= 1 << bits
            counts.append(value + (counts[-2] if len(counts) > 2 else 0))
        self.assertEqual(annotation["segmentation"]["size"], [HEIGHT, WIDTH])
        self.assertEqual(sum(counts), HEIGHT * WIDTH)
        values = numpy.arange(len(counts)) % 2
        pixels = numpy.repeat(values, counts).reshape((HEIGHT, WIDTH), order="F")
        self.assertEqual(annotation["area"], pixels.sum())
        rows, columns = pixels.nonzero()
        left, top = columns.min(), rows.min()
        self.assertEqual([left, top, columns.max() - left + 1, rows.max() - top + 1], covered)

    def test_yolo(self):
        """ultralytics/data/utils.py: check_det_dataset, img2label_paths, verify_image_label."""
        for out, clips, has_pictures in self.exports("yolo"):
            data = yaml.safe_load((out / "data.yaml").read_text())
            path = pathlib.Path(data["path"])
            self.assertTrue(path.is_absolute() and path.samefile(out))
            self.assertEqual(sorted(data["names"]), list(range(len(data["names"]))))
            got = {}
            for key in ("train", "val", "test"):
                if key not in data:
                    self.assertEqual(key, "test")
                    continue
                folder = path / data[key]
                self.assertTrue(folder.is_dir())
                if has_pictures:
                    pictures = [str(p) for p in folder.rglob("*.*")]
                    self.assertTrue(all(p.rpartition(".")[2].lower() in ("jpg", "png") for p in pictures))
                    labels = ["/labels/".join(p.rsplit("/images/", 1)).rsplit(".", 1)[0] + ".txt" for p in pictures]
                else:
                    pictures = labels = [str(p) for p in (path / data[key].replace("images", "labels", 1)).iterdir()]
                for picture, label in zip(pictures, labels):
                    if has_pictures:
                        self.check_picture(picture)
                    rows = [line.split() for line in pathlib.Path(label).read_text().strip().splitlines()]
                    clip, _, number = pathlib.Path(label).stem.rpartition("_")
                    frame = got.setdefault(clip, {}).setdefault(whole(number), {})
                    if not rows:
                        continue
                    table = numpy.array(rows, dtype=numpy.float32)
                    self.assertEqual(table.shape[1], 5)
                    self.assertLessEqual(table[:, 1:].max(), 1)
                    self.assertGreaterEqual(table.min(), 0)
                    self.assertLess(table[:, 0].max(), len(data["names"]))
                    self.assertEqual(len(numpy.unique(table, axis=0)), len(table))
                    for i, (_, x, y, w, h) in enumerate(table.astype(float)):
                        frame[i + 1] = ((x - w / 2) * WIDTH, (y - h / 2) * HEIGHT, w * WIDTH, h * HEIGHT)
            self.check_frames(got, clips, clipped, tolerance=1e-4, has_tracks=False)

    def read_mot(self, out, clips):
        """TrackEval, datasets/mot_challenge_2d_box.py: _get_seq_info, _load_raw_file, get_preprocessed_seq_data for
        MOT17; datumaro, data_formats/mot.py: _parse_seq_info and _load_items; Milan et al. 2016, table 4."""
        got, classes = {}, set()
        for part in self.parts(out):
            with open(out / "seqmaps" / f"{part}.txt") as file:
                rows = list(csv.reader(file))
            self.assertEqual(rows[0], ["name"])
            for (name,) in rows[1:]:
                folder = out / part / name
                about = configparser.ConfigParser()
                about.read(folder / "seqinfo.ini")
                length = whole(about["Sequence"]["seqLength"])
                keys = {}
                for line in (folder / "seqinfo.ini").read_text().splitlines():
                    if len(entry := line.lower().strip().split("=", maxsplit=1)) == 2:
                        keys[entry[0]] = entry[1]
                self.assertEqual(set(keys), {"name", "imdir", "framerate", "seqlength", "imwidth", "imheight", "imext"})
                self.assertEqual([whole(keys[key]) for key in ("imwidth", "imheight", "seqlength")],
                                 [WIDTH, HEIGHT, length])
                self.assertGreater(whole(keys["framerate"]), 0)
                labels = (folder / "gt/labels.txt").read_text().splitlines()
                frames = got[name] = {}
                with open(folder / "gt/gt.txt", newline="") as file:
                    for row in csv.reader(file):
                        frame, track, keep, kind = (whole(row[i]) for i in (0, 1, 6, 7))
                        self.assertTrue(1 <= frame <= length and track >= 1)
                        self.assertTrue(1 <= kind <= min(13, len(labels)))
                        self.assertTrue(0 <= float(row[8]) <= 1)
                        self.assertEqual(keep, 1)
                        classes.add(kind)
                        x, y, w, h = map(float, row[2:6])
                        self.assertNotIn(track, frames.setdefault(frame - 1, {}))
                        frames[frame - 1][track] = (x - 1, y - 1, w, h)
                yield_pictures = folder / keys["imdir"]
                if yield_pictures.is_dir():
                    self.check_picture(yield_pictures / ("%06d%s" % (length, keys["imext"])))
        self.check_frames(got, clips)
        return classes

    def test_mot(self):
        for out, clips, _ in self.exports("mot"):
            # MOT17's evaluation keeps class 1 alone.
            self.assertEqual(self.read_mot(out, clips), {1})
        for out, clips, _ in self.exports("mot", images=("none",), options=("--mot-classes",)):
            self.assertEqual(self.read_mot(out, clips), {1, 2} if clips is self.built else {1})

    def voc_struct(self, text):
        """VOCdevkit/VOCcode/VOCxml2struct.m: elements, text, tabs and line ends; no declaration, attributes or blanks."""
        text = text.translate({9: None, 10: None, 13: None})

        def parse(at, parent):
            if parent and text[at] != "<":
                end = text.index("<", at)
                close = text.index(">", end)
                self.assertEqual(text[end:close + 1], f"</{parent}>")
                return text[at:end].strip(), close + 1
            found = {}
            while at < len(text):
                self.assertEqual(text[at], "<")
                close = text.index(">", at)
                tag = text[at + 1:close]
                if tag == f"/{parent}":
                    return found, close + 1
                self.assertTrue(tag.isidentifier(), tag)
                inner, at = parse(close + 1, tag)
                found.setdefault(tag, []).append(inner)
            return found, at

        return parse(0, "")[0]

    def test_voc(self):
        """VOCdevkit: VOCreadrecxml.m, VOCxml2struct.m; detectron's and others' voc_eval.py: parse_rec; VOC2012 development
        kit, section 4 (pixels from 1, both corners inside)."""
        for out, clips, has_pictures in self.exports("voc"):
            got = {}
            lists = sorted(path.stem for path in (out / "ImageSets/Main").iterdir())
            names = [line for part in lists
                     for line in (out / f"ImageSets/Main/{part}.txt").read_text().splitlines()]
            self.assertEqual(sorted(names), sorted(path.stem for path in (out / "Annotations").iterdir()))
            for name in names:
                file = out / "Annotations" / f"{name}.xml"
                (struct,) = self.voc_struct(file.read_text())["annotation"]
                (source,) = struct["source"]
                self.assertTrue(source["database"] and source["annotation"] and source["image"])
                self.assertIn(struct["segmented"], (["0"], ["1"]))
                (folder,), (picture,) = struct["folder"], struct["filename"]
                if has_pictures:
                    self.check_picture(out.parent / folder / "JPEGImages" / picture)
                tree = ElementTree.parse(file).getroot()
                size = [whole(tree.find(f"size/{key}").text) for key in ("width", "height", "depth")]
                self.assertEqual(size, [WIDTH, HEIGHT, 3])
                clip, _, number = name.rpartition("_")
                frame = got.setdefault(clip, {}).setdefault(whole(number), {})
                for thing in tree.findall("object"):
                    self.assertTrue(thing.find("name").text and thing.find("pose").text)
                    for flag in ("truncated", "occluded", "difficult"):
                        self.assertIn(whole(thing.find(flag).text), (0, 1))
                    left, top, right, bottom = (whole(thing.find(f"bndbox/{key}").text)
                                                for key in ("xmin", "ymin", "xmax", "ymax"))
                    self.assertTrue(1 <= left <= right <= WIDTH and 1 <= top <= bottom <= HEIGHT)
                    frame[len(frame) + 1] = (left - 1, top - 1, right - left + 1, bottom - top + 1)
            self.check_frames(got, clips, whole_pixels, has_tracks=False)

    def test_cvat(self):
        """CVAT, dataset_manager/formats/cvat.py: load_anno and CvatExtractor; bindings.py: match_dm_item; datumaro,
        data_formats/cvat/base.py: _load_items."""
        for out, clips, has_pictures in self.exports("cvat", images=("default", "png", "none")):
            got = {}
            for part in self.parts(out):
                for folder in (out / part).iterdir():
                    top = ElementTree.parse(folder / "annotations.xml").getroot()
                    self.assertEqual((top.tag, top.find("version").text), ("annotations", "1.1"))
                    task = top.find("meta/task")
                    self.assertEqual(task.find("mode").text, "interpolation")
                    size = [whole(task.find(f"original_size/{key}").text) for key in ("width", "height")]
                    self.assertEqual(size, [WIDTH, HEIGHT])
                    length = whole(task.find("size").text)
                    attributes = {label.find("name").text: {a.find("name").text for a in label.iter("attribute")}
                                  for label in task.iter("label")}
                    # A task of the pictures, or of the video, whose frames are called frame_%06d.
                    task_frames = {f"frame_{i:06}": i for i in range(length)}
                    names = {}
                    for image in top.findall("image"):
                        frame = task_frames[os.path.splitext(image.attrib["name"])[0]]
                        self.assertEqual(whole(image.attrib["id"]), frame)
                        names[frame] = image.attrib["name"]
                    self.assertEqual(len(names), length if has_pictures else 0)
                    for frame in range(length):
                        # datumaro: a name must be there, frame_%06d.png need not.
                        file = folder / "images" / names.get(frame, f"frame_{frame:06}.png")
                        if has_pictures:
                            self.check_picture(file)
                    frames = got[task.find("name").text] = {}
                    for track in top.findall("track"):
                        whole(track.attrib["id"])
                        shapes = {}
                        for box in track.findall("box"):
                            self.assertIn(box.attrib["keyframe"], "01")
                            self.assertIn(box.attrib["occluded"], "01")
                            corners = [float(box.attrib[key]) for key in ("xtl", "ytl", "xbr", "ybr")]
                            frame = whole(box.attrib["frame"])
                            self.assertNotIn(frame, shapes)
                            shapes[frame] = None if box.attrib["outside"] == "1" else corners
                            self.assertTrue({attribute.attrib["name"] for attribute in box.findall("attribute")}
                                            <= attributes[track.attrib["label"]])
                        last = None
                        for frame in range(length):  # a track stays where it is until its next key frame
                            last = shapes.get(frame, last)
                            if last:
                                x, y, right, bottom = last
                                box = (x, y, right - x, bottom - y)
                                frames.setdefault(frame, {})[whole(track.attrib["id"]) + 1] = box
            self.check_frames(got, clips)

    def test_aot(self):
        """airborne-detection-starter-kit: core/flight.py, core/frame.py, core/airborne_object_location.py;
        core/metrics/airborne_metrics: pandas_utils.py, match_groundtruth_results.py (the truth as detections joins to
        itself by img_name alone: no false positive), calculate_encounters.py."""
        for out, clips, has_pictures in self.exports("aot"):
            got, encounters = {}, 0
            for part in self.parts(out):
                data = json.loads((out / part / "ImageSets/groundtruth.json").read_text())
                for flight, sample in data["samples"].items():
                    about = sample["metadata"]
                    self.assertTrue(about["data_path"])
                    self.assertAlmostEqual(about["duration"], about["number_of_frames"] / about["fps"] * 1000)
                    frames = got[flight] = {}
                    for entity in sample["entities"]:
                        self.assertIs(type(entity["time"]), int)
                        frame = whole(entity["blob"]["frame"])
                        self.assertEqual(entity["img_name"], f"{entity['time']}{flight}.png")
                        if has_pictures:
                            self.check_picture(out / part / "Images" / flight / entity["img_name"])
                        boxes = frames.setdefault(frame, {})
                        if "id" in entity:
                            self.assertIn(entity["labels"]["is_above_horizon"], (-1, 0, 1))
                            boxes[whole(entity["id"].removeprefix("Airplane"))] = tuple(entity["bb"])
                table = pandas.json_normalize(
                    data["samples"].values(), record_path="entities",
                    meta=[["metadata", "resolution", "width"], ["metadata", "resolution", "height"]], sep="_",
                    errors="ignore")
                self.assertEqual(set(table["metadata_resolution_width"]), {WIDTH})
                # A name is one frame of one flight.
                self.assertEqual(table["img_name"].nunique(), len(table[["flight_id", "blob_frame"]].drop_duplicates()))
                # Every detection overlaps a box of its own picture wholly: FPPI 0.
                shown = table.dropna(subset=["bb"])
                joined = shown.merge(shown, on="img_name", suffixes=("", "_det"))
                equal = joined["bb"].map(tuple) == joined["bb_det"].map(tuple)
                self.assertEqual(equal.groupby([joined["img_name"], joined["id_det"]]).any().all(), True)
                self.assertEqual(len(shown), len(joined[equal].drop_duplicates(["img_name", "id_det"])))
                if "blob_range_distance_m" not in shown:
                    self.assertIs(clips, self.imported)
                    continue
                near = shown[shown["blob_range_distance_m"] <= 700].sort_values(["flight_id", "id", "time"])
                for _, rows in near.groupby(["flight_id", "id"]):
                    self.assertLessEqual(rows["blob_frame"].diff().max(), 3)
                    encounters += len(rows) >= 30 and rows["blob_range_distance_m"].min() <= 330
            self.check_frames(got, clips)
            self.assertEqual(encounters, len(self.built) if clips is self.built else 0)
        refused = subprocess.run(
            [AIRTRUTH, "dataset", "export", self.root / "built", "--format", "aot", "--images", "jpg", "--out",
             self.root / "refused"], capture_output=True, text=True, timeout=60)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("expected png or none", refused.stderr)
        self.assertFalse((self.root / "refused").exists())

    def check_single(self, got, clips):
        expected = {name: boxes for clip in clips for name, boxes in clip.single_objects().items()}
        self.assertEqual(sorted(got), sorted(expected))
        for name, boxes in expected.items():
            self.assertEqual(len(got[name]), len(boxes), name)
            for a, b in zip(got[name], boxes):
                self.assertEqual(a is None, b is None)
                if b is not None:
                    self.check_box(a, b)

    def sequences(self, out):
        for part in self.parts(out):
            for name in (out / part / "list.txt").read_text().strip().split("\n"):
                yield name, out / part / name

    def test_otb(self):
        """got10k toolkit, got10k/datasets/otb.py; Wu et al. 2013 (pixels from 1)."""
        for out, clips, has_pictures in self.exports("otb"):
            got = {}
            for name, folder in self.sequences(out):
                (file,) = glob.glob(glob.escape(str(folder)) + "/groundtruth*.txt")
                boxes = numpy.loadtxt(io.StringIO(pathlib.Path(file).read_text().replace(",", " ")))
                self.assertEqual(boxes.shape[1], 4)
                if has_pictures:
                    pictures = sorted(glob.glob(glob.escape(str(folder)) + "/img/*.jpg"))
                    self.assertEqual(len(pictures), len(boxes))
                    self.check_picture(pictures[-1])
                got[name] = [(x - 1, y - 1, w, h) if w > 0 else None for x, y, w, h in boxes]
            self.check_single(got, clips)

    def test_got10k(self):
        """got10k toolkit, got10k/datasets/got10k.py: __getitem__ and _fetch_meta; pytracking, ltr/dataset/got10k.py
        (lines of meta_info.ini by their place, labels as whole numbers)."""
        for options in ((), ("--split", "none")):
            for out, clips, has_pictures in self.exports("got10k", options=options):
                self.assertTrue(set(self.parts(out)) <= {"train", "val", "test"})
                got = {}
                for name, folder in self.sequences(out):
                    boxes = numpy.loadtxt(folder / "groundtruth.txt", delimiter=",")
                    if has_pictures:
                        pictures = sorted(glob.glob(glob.escape(str(folder)) + "/*.jpg"))
                        self.assertEqual(len(pictures), len(boxes))
                        self.check_picture(pictures[-1])
                    lines = (folder / "meta_info.ini").read_text().strip().split("\n")
                    self.assertEqual(lines[0], "[METAINFO]")
                    meta = {line.split(": ")[0]: line.split(": ")[1] for line in lines[1:]}
                    self.assertEqual(list(meta)[:10], ["url", "begin", "end", "anno_fps", "object_class", "motion_class",
                                                       "major_class", "root_class", "motion_adverb", "resolution"])
                    labels = {}
                    for label in ("cover", "absence", "cut_by_image"):
                        column = (folder / f"{label}.label").read_text().splitlines()
                        labels[label] = [whole(value) for value in column]
                        self.assertEqual(len(column), len(boxes))
                    self.assertTrue(set(labels["cover"]) <= set(range(9)))
                    for absent, cover in zip(labels["absence"], labels["cover"]):
                        self.assertEqual(absent == 1, cover == 0)
                    if clips is self.imported:
                        self.assertEqual(meta["labels_unknown"], "cut_by_image cover")
                        # The box that reaches over the picture's edge, and no other.
                        self.assertEqual(labels["cut_by_image"][-1], 1 if name == "boxes-1" else 0)
                    got[name] = [None if absent else (x - 1, y - 1, w, h)
                                 for (x, y, w, h), absent in zip(boxes, labels["absence"])]
                self.check_single(got, clips)

    def test_vot(self):
        """vot-toolkit: vot/dataset/common.py (_read_metadata, _read_data), vot/dataset/__init__.py
        (PatternFileListChannel), vot/region/io.py (parse_region), vot/experiment/multistart.py (find_anchors)."""
        for out, clips, has_pictures in self.exports("vot", images=("default", "png", "none")):
            got = {}
            for name, folder in self.sequences(out):
                about = dict(line.split("=", 1) for line in (folder / "sequence").read_text().splitlines())
                length = whole(about["length"])
                self.assertEqual((whole(about["width"]), whole(about["height"])), (WIDTH, HEIGHT))
                self.assertGreater(whole(about["fps"]), 0)
                self.assertIn(os.path.splitext(about["channels.color"])[1], (".jpg", ".png"))
                for i in range(1, length + 1):
                    if has_pictures:
                        self.check_picture(folder / (about["channels.color"] % i))
                boxes = [[float(number) for number in line.strip().split(",")]
                         for line in (folder / "groundtruth.txt").read_text().splitlines()]
                self.assertEqual({len(box) for box in boxes}, {4})
                self.assertEqual(len(boxes), length)
                got[name] = [None if any(map(math.isnan, box)) else tuple(box) for box in boxes]
                for file in folder.glob("*.tag"):
                    self.assertTrue(set(file.read_text().split()) <= {"0", "1"})
                values = {file.stem: [float(line) for line in file.read_text().splitlines()]
                          for file in folder.glob("*.value")}
                self.assertEqual({len(column) for column in values.values()}, {length})
                starts = [i for i, value in enumerate(values["anchor"]) if value != 0]
                self.assertTrue(starts)
                self.assertTrue(all(got[name][i] is not None for i in starts))
                self.assertEqual(values["anchor"][0], 1)
            self.check_single(got, clips)

    def import_again(self, form, source, pictures):
        """Imports a set of others, and exports it with its pictures, which are then all read: the boxes by frame."""
        out = self.root / f"again-{form}"
        airtruth("dataset", "import", source, "--format", form, "--out", out)
        airtruth("dataset", "export", out, "--format", "coco", "--images", "png", "--out", out / "coco")
        data = json.loads((out / "coco/annotations/instances_train.json").read_text())
        got = {image["id"]: [] for image in data["images"]}
        for image, original in zip(data["images"], pictures, strict=True):
            copy = cv2.imread(str(out / "coco/images/train" / image["file_name"]))
            self.assertTrue((copy == cv2.imread(str(original))).all(), original)
        for annotation in data["annotations"]:
            got[annotation["image_id"]].append(tuple(annotation["bbox"]))
        return list(got.values())

    def flat_pictures(self, folder, names):
        """Pictures that tell their place by their grey, written in another order than that of their names."""
        folder.mkdir(parents=True)
        for i in reversed(range(len(names))):
            cv2.imwrite(str(folder / names[i]), numpy.full((48, 64, 3), 40 * i + 20, numpy.uint8))
        return [folder / name for name in names]

    def test_webdataset(self):
        """webdataset/tariterators.py: tar_file_iterator, base_plus_ext, group_by_keys."""
        for out, clips, has_pictures in self.exports("webdataset", options=("--shard-mb", "1")):
            got, keys = {clip.name: {} for clip in clips}, set()
            for shard in sorted(out.glob("*.tar")):
                self.assertRegex(shard.name, r"^(train|val|test|all)-\d{6}\.tar$")
                for key, sample in self.samples_of(shard):
                    self.assertNotIn(key, keys)
                    keys.add(key)
                    about = json.loads(sample["json"])
                    got[about["clip"]][about["frame"]] = {label["track"]: tuple(label["box_px"]) for label in about["labels"]}
                    self.assertEqual(set(sample), {"jpg", "json"} if has_pictures else {"json"})
                    if has_pictures:
                        picture = cv2.imdecode(numpy.frombuffer(sample["jpg"], numpy.uint8), cv2.IMREAD_COLOR)
                        self.assertEqual(picture.shape, (HEIGHT, WIDTH, 3))
            self.assertEqual(len(keys), sum(len(clip.frames) for clip in clips))
            self.check_frames(got, clips)

    @staticmethod
    def samples_of(shard):
        """Files that follow each other and have one key are one sample."""
        samples = []
        with tarfile.open(shard) as archive:
            for member in archive:
                key, ending = re.match(r"^((?:.*/|)[^.]+)[.]([^/]*)$", member.name).groups()
                if not samples or samples[-1][0] != key:
                    samples.append((key, {}))
                samples[-1][1][ending] = archive.extractfile(member).read()
        return samples

    def test_table(self):
        """Python's csv, as pandas.read_csv reads it too."""
        for out, clips, _ in self.exports("table", images=("default",)):
            with open(out / "frames.csv", newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file, strict=True))
            got = {clip.name: {} for clip in clips}
            for row in rows:
                self.assertNotIn(None, row.values())
                box = tuple(float(row[f"box_px_{part}"]) for part in ("x", "y", "width", "height"))
                got[row["sequence"]].setdefault(int(row["frame"]), {})[int(row["track"])] = box
            self.check_frames(got, clips)
            self.assertEqual(len(pandas.read_csv(out / "frames.csv")), len(rows))
            if clips is self.built:
                self.check_truth(out, rows)
            else:
                self.assertEqual(len(pandas.read_csv(out / "encounters.csv")), 0)

    def check_truth(self, out, rows):
        truth = {}
        for sequence in (self.root / "built/sequences").iterdir():
            for i, line in enumerate((sequence / "truth.jsonl").read_text().splitlines()):
                truth[sequence.name, i] = json.loads(line)["intruders"][0]
        for row in rows:
            intruder = truth[row["sequence"], int(row["frame"])]
            for column, value in (("id", intruder["id"]), ("range_m", intruder["range_m"]), ("azimuth_deg", intruder["azimuth_deg"]),
                                  ("position_ned_m_down", intruder["position_ned_m"][2]), ("tcpa_s", intruder["encounter"]["tcpa_s"]),
                                  ("exact_box_px_width", intruder["exact_box_px"][2]), ("centroid_px_y", intruder["centroid_px"][1])):
                found = row[column] if isinstance(value, str) else float(row[column]) if row[column] else None
                self.assertEqual(found, value, column)
        with open(out / "encounters.csv", newline="", encoding="utf-8") as file:
            encounters = list(csv.DictReader(file, strict=True))
        self.assertEqual([row["sequence"] for row in encounters], [clip.name for clip in self.built])
        for row in encounters:
            record = json.loads((self.root / "built/sequences" / row["sequence"] / "sequence.json").read_text())["encounters"][0]
            self.assertEqual(float(row["closest_approach_distance_m"]), record["closest_approach"]["distance_m"])
            self.assertEqual(float(row["first_seen_to_closest_approach_s"]), record["first_seen"]["to_closest_approach_s"])
            self.assertEqual([row["id"], row["meeting"] or None], [record["id"], record["meeting"]])

    def test_import_of_coco_by_its_own_names(self):
        """cocodataset.org: instances_val2017.json, val2017/000000000139.jpg: 12 digits, with gaps; iscrowd = 1."""
        self.where = "import of COCO"
        source = self.root / "coco2017"
        names = ["000000000139.png", "000000000285.png", "000000581929.png"]
        pictures = self.flat_pictures(source / "val2017", names)
        images = [{"id": int(name[:12]), "file_name": name, "width": 64, "height": 48} for name in names]
        boxes = [{"id": 1, "image_id": 139, "category_id": 5, "bbox": [1, 2, 3, 4], "area": 12, "iscrowd": 0},
                 {"id": 2, "image_id": 285, "category_id": 5, "bbox": [9, 9, 9, 9], "area": 81, "iscrowd": 1},
                 {"id": 3, "image_id": 581929, "category_id": 5, "bbox": [5.5, 6, 7, 8], "area": 56, "iscrowd": 0}]
        (source / "annotations").mkdir()
        (source / "annotations/instances_val2017.json").write_text(json.dumps(
            {"images": list(reversed(images)), "annotations": boxes, "categories": [{"id": 5, "name": "airplane"}]}))
        self.assertEqual(self.import_again("coco", source, pictures), [[(1, 2, 3, 4)], [(9, 9, 9, 9)], [(5.5, 6, 7, 8)]])
        again = json.loads((self.root / "again-coco/coco/annotations/instances_train.json").read_text())
        self.assertEqual([one["iscrowd"] for one in again["annotations"]], [0, 1, 0])

    def test_import_of_aot_by_its_own_names(self):
        """airborne-detection-starter-kit, docs/DATASET.md: times since 1970, flights in hexadecimal, NaN."""
        self.where = "import of AOT"
        source = self.root / "aot2021/part1"
        flight = "1f9a42f2d2194622b845bf5ad9ba1f17"
        times = [1544528583848547865, 1544528583922625208, 1544528584035335403]
        names = [f"{time}{flight}.png" for time in times]
        pictures = self.flat_pictures(source / "Images" / flight, names)
        entities = [{"time": time, "blob": {"frame": i, "range_distance_m": math.nan}, "labels": {"is_above_horizon": 1},
                     "flight_id": flight, "img_name": names[i]} for i, time in enumerate(times)]
        entities[1].update(id="Airplane1", bb=[1.5, 2, 3, 4])
        (source / "ImageSets").mkdir()
        (source / "ImageSets/groundtruth.json").write_text(json.dumps({"metadata": {}, "samples": {flight: {
            "metadata": {"data_path": f"train3/{flight}/", "fps": 10.0, "number_of_frames": 3, "duration": 300.0,
                         "resolution": {"height": 48, "width": 64}}, "entities": entities}}}))
        self.assertIn("NaN", (source / "ImageSets/groundtruth.json").read_text())
        self.assertEqual(self.import_again("aot", source, pictures), [[], [(1.5, 2, 3, 4)], []])

    def test_names(self):
        """Patterns of numbered pictures, shells, XML and JSON have their own idea of these characters."""
        for name, forms in (("a%d $(b)", ("yolo", "otb", "vot")), ("<b>&\"'", ("voc", "cvat", "mot")), ("a.b,%2E", ("webdataset",))):
            self.where = f"clip {name!r}"
            csv_file = self.root / f"{name}.csv"
            csv_file.write_text((self.root / "boxes.csv").read_text())
            imported = self.root / f"set of {name}"
            airtruth("dataset", "import", csv_file, "--format", "csv", "--video", self.media, "--out", imported)
            for form in forms:
                out = self.root / f"{form} of {name}"
                airtruth("dataset", "export", imported, "--format", form, "--out", out)
                back = airtruth("dataset", "import", out, "--format", form, "--out", self.root / f"{form} back {name}")
                self.assertRegex(back.stdout, ", [34] boxes")
        no_utf8 = os.fsencode(self.root) + b"/b\xffx"
        pathlib.Path(os.fsdecode(no_utf8 + b".csv")).write_text((self.root / "boxes.csv").read_text())
        airtruth("dataset", "import", os.fsdecode(no_utf8 + b".csv"), "--format", "csv", "--out", self.root / "b")
        self.assertEqual([path.name for path in (self.root / "b/sequences").iterdir()], ["b-x"])
        refused = subprocess.run([AIRTRUTH, "dataset", "export", self.root / "b", "--format", "coco", "--images", "none",
                                  "--out", no_utf8], capture_output=True, timeout=60)
        self.assertEqual(refused.returncode, 2)
        self.assertIn(b"is no UTF-8 name", refused.stderr)
        self.assertFalse(os.path.exists(no_utf8))


if __name__ == "__main__":
    AIRTRUTH = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=1)
