# SPDX-License-Identifier: Apache-2.0
"""Labels belong to the pictures that they name, whatever the names are. picture_names_test.py AIRTRUTH

Sets of eight pictures are named by schemes that people and their tools use, and are listed shuffled and sorted. Picture i has the
grey level 10 i and its box has x = i. A set of each scheme is imported from COCO, exported to YOLO and imported again. The other formats that
name pictures share COCO's join of labels and pictures: each imports every fifth scheme, another fifth each. The box of every frame must
be that of its picture each time.
"""

import json
import os
import random
import struct
import subprocess
import sys
import tempfile
import unittest
import uuid
import zlib

PROGRAM = os.path.abspath(sys.argv.pop(1))
COUNT = 8
WIDTH, HEIGHT = 64, 48
RANDOM = random.Random(38)


def digest():
    return "%032x" % RANDOM.getrandbits(128)


# By scheme, the name of picture i without its ending.
SCHEMES = {
    "padded": lambda i: f"{i:06d}",
    "unpadded": lambda i: f"{7 + i}",
    "from 1": lambda i: f"{i + 1:04d}",
    "word and number": lambda i: f"frame_{i:06d}",
    "word and bare number": lambda i: f"img{8 + i}",
    "number and word": lambda i: f"frame{8 + i}_left",
    "every fifth": lambda i: f"f_{5 * i:04d}",
    "Roboflow": lambda i: f"DJI_0012_mp4-{i:04d}_jpg.rf.{digest()}",
    "Roboflow's new suffix": lambda i: f"clip_{i}_png.rf.{digest()[:20]}",
    "UUID": lambda i: str(uuid.UUID(int=RANDOM.getrandbits(128))),
    "digest": lambda i: digest(),
    "DJI": lambda i: f"DJI_{i + 96:04d}",
    "DJI with a time": lambda i: f"DJI_202406121032{10 + i}_{i + 7:04d}_V",
    "GoPro": lambda i: f"GOPR{9996 + i}",
    "Sony": lambda i: f"DSC{i + 1:05d}",
    "phone": lambda i: f"IMG_20240612_10325{i}",
    "date and time": lambda i: f"2024-06-12_10-{32 + i // 4}-{57 + i if i < 3 else i - 3:02d}",
    "seconds with a fraction": lambda i: f"cam0_17182{13 + i}.{4 + i}25",
    "rosbag stamp": lambda i: str(1403636579763555584 + 50_000_000 * i),
    "VisDrone": lambda i: f"0000011_{50 * i:05d}_d_{117 - i:07d}",
    "AOT": lambda i: f"{1566556046185850369 + 100_000_000 * i}b06b4ef1aba54a71b4ad4b9c5f28e1ab",
    "video of ffmpeg": lambda i: f"out.mp4_{i + 1:03d}",
    "blanks": lambda i: f"flight 3 picture {i + 2}",
    "clip and frame": lambda i: f"pass-{1 + i // 4}_{i % 4:06d}",
    "two videos": lambda i: f"vid{'AB'[i // 4]}_{i % 4:03d}",
    "letters": lambda i: "abcdefgh"[i] * 3,
}


def png(level):
    row = b"\0" + bytes([level]) * WIDTH

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(row * HEIGHT)) + chunk(b"IEND", b""))


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())


# Each writer makes a set of the names, {i: name}, with the pictures in the order of the keys.
def coco(root, names):
    for i, name in names.items():
        write(os.path.join(root, "images", "train", name), png(10 * i))
    ids = RANDOM.sample(range(100), len(names))
    json_of = {"images": [], "annotations": [], "categories": [{"id": 3, "name": "plane"}]}
    for (i, name), image in zip(names.items(), ids):
        json_of["images"].append({"id": image, "file_name": name, "width": WIDTH, "height": HEIGHT})
        json_of["annotations"].append({"id": i + 1, "image_id": image, "category_id": 3, "bbox": [i, 5, 10, 6], "iscrowd": 0})
    write(os.path.join(root, "annotations", "instances_train.json"), json.dumps(json_of))


def yolo(root, names):
    for i, name in names.items():
        write(os.path.join(root, "images", "train", name), png(10 * i))
        box = [(i + 5) / WIDTH, 8 / HEIGHT, 10 / WIDTH, 6 / HEIGHT]
        write(os.path.join(root, "labels", "train", name[:-4] + ".txt"), "0 " + " ".join(map(repr, box)) + "\n")
    write(os.path.join(root, "data.yaml"), "names: [plane]\n")


def voc(root, names):
    for number, (i, name) in enumerate(names.items()):
        write(os.path.join(root, "JPEGImages", name), png(10 * i))
        # The annotation's own name says nothing.
        write(os.path.join(root, "Annotations", f"{number:04d}.xml"),
              f"<annotation><filename>{name}</filename><size><width>{WIDTH}</width><height>{HEIGHT}</height></size><object>"
              f"<name>plane</name><bndbox><xmin>{i + 1}</xmin><ymin>6</ymin><xmax>{i + 10}</xmax><ymax>11</ymax></bndbox></object>"
              "</annotation>")


def cvat(root, names):
    images = ""
    for number, (i, name) in enumerate(names.items()):
        write(os.path.join(root, "images", name), png(10 * i))
        images += (f'<image id="{number}" name="{name}" width="{WIDTH}" height="{HEIGHT}"><box label="plane" occluded="0" '
                   f'xtl="{i}" ytl="5" xbr="{i + 10}" ybr="11"/></image>')
    write(os.path.join(root, "annotations.xml"),
          f"<annotations><version>1.1</version><meta><task><name>v</name><size>{len(names)}</size></task></meta>{images}"
          "</annotations>")


def aot(root, names):
    entities = []
    for number, (i, name) in enumerate(names.items()):
        write(os.path.join(root, "Images", "flight", name), png(10 * i))
        entities.append({"time": 10**18 + number * 10**8, "blob": {"frame": number}, "id": "Airplane1", "bb": [i, 5, 10, 6],
                         "flight_id": "flight", "img_name": name, "labels": {"is_above_horizon": 0}})
    RANDOM.shuffle(entities)
    write(os.path.join(root, "ImageSets", "groundtruth.json"),
          json.dumps({"samples": {"flight": {"metadata": {"resolution": {"width": WIDTH, "height": HEIGHT}}, "entities": entities}}}))


WRITERS = {"coco": coco, "yolo": yolo, "voc": voc, "cvat": cvat, "aot": aot}


def run(folder, *arguments):
    process = subprocess.run([PROGRAM, *arguments], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if process.returncode != 0:
        raise AssertionError(f"{' '.join(arguments)}: {process.stderr}")


def grey_level(path):
    """Of a picture of one level; of a jpg, as ffmpeg decodes it."""
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "gray", "-"], stdout=subprocess.PIPE,
                         check=True).stdout
    return sum(raw) / len(raw)


def clips_of(folder):
    """By clip, the pictures that the frames show and the x of their boxes."""
    clips = {}
    for name in os.listdir(os.path.join(folder, "sequences")):
        with open(os.path.join(folder, "sequences", name, "labels.jsonl"), encoding="utf-8") as file:
            frames = [json.loads(line) for line in file][1:]
        with open(os.path.join(folder, "sequences", name, "pictures.txt"), encoding="utf-8") as file:
            pictures = file.read().splitlines()
        boxes = [[label["box_px"][0] for label in frame["labels"]] for frame in frames]
        clips[name] = list(zip(pictures, boxes, strict=True))
    return clips


class Names(unittest.TestCase):
    def expect_own_boxes(self, folder, known=None):
        """Every picture has its own box; `known` gives the numbers of pictures by name, else they are looked at."""
        seen = []
        for clip in clips_of(folder).values():
            for path, boxes in clip:
                i = known[os.path.basename(path)] if known else round(grey_level(path) / 10)
                self.assertEqual([round(x) for x in boxes], [i], path)
                seen.append(i)
        self.assertEqual(sorted(seen), list(range(COUNT)))
        return seen

    def check(self, form, scheme, numbers):
        names = {i: SCHEMES[scheme](i) + ".png" for i in numbers}
        with self.subTest(form=form, scheme=scheme), tempfile.TemporaryDirectory() as folder:
            WRITERS[form](os.path.join(folder, "theirs"), names)
            run(folder, "dataset", "import", "theirs", "--format", form, "--out", "set")
            self.expect_own_boxes(os.path.join(folder, "set"), {name: i for i, name in names.items()})
            if form != "coco":
                return
            run(folder, "dataset", "export", "set", "--format", "yolo", "--split", "none", "--images", "png", "--out", "ours")
            run(folder, "dataset", "import", "ours", "--format", "yolo", "--out", "again")
            self.expect_own_boxes(os.path.join(folder, "again"))

    def test_labels_belong_to_the_pictures_that_they_name(self):
        self.assertGreaterEqual(len(SCHEMES), 24)
        for place, form in enumerate(WRITERS):
            for scheme in list(SCHEMES) if form == "coco" else list(SCHEMES)[place::5]:
                numbers = list(range(COUNT))
                if form != "aot":
                    RANDOM.shuffle(numbers)
                self.check(form, scheme, numbers)

    def test_sorted_as_well(self):
        for form in WRITERS:
            for scheme in ("unpadded", "UUID", "VisDrone", "two videos"):
                self.check(form, scheme, list(range(COUNT)))

    def test_two_series_in_a_folder_are_two_clips(self):
        for form in ("coco", "yolo", "voc", "cvat"):
            with tempfile.TemporaryDirectory() as folder:
                WRITERS[form](os.path.join(folder, "theirs"), {i: SCHEMES["two videos"](i) + ".png" for i in range(COUNT)})
                run(folder, "dataset", "import", "theirs", "--format", form, "--out", "set")
                self.assertEqual(sorted(map(len, clips_of(os.path.join(folder, "set")).values())), [4, 4])

    def test_names_that_no_list_holds_or_that_lead_outside_are_refused(self):
        for form, name, words in (("yolo", "a\nb.png", "control character"), ("voc", "a\tb.png", "control character"),
                                  ("coco", "../../x.png", "leads out")):
            with self.subTest(form=form), tempfile.TemporaryDirectory() as folder:
                WRITERS[form](os.path.join(folder, "theirs"), {0: name})
                done = subprocess.run([PROGRAM, "dataset", "import", "theirs", "--format", form, "--out", "set"], cwd=folder, text=True,
                                      capture_output=True)
                self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
                self.assertIn(words, done.stderr)
                self.assertFalse(os.path.exists(os.path.join(folder, "set")))


if __name__ == "__main__":
    unittest.main()
