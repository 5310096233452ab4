# SPDX-License-Identifier: Apache-2.0
"""Public sets of real aircraft behind one interface. None of them is in this repository: fetch one from where it stands, under its licence, and
give its folder.

A reader makes the clips of a folder; a clip has labelled frames, and its pictures when they are asked for. Boxes are x, y, width, height in px,
the first pixel at (0, 0). A kind is "airplane", "helicopter", "multirotor", "uav" (small and unmanned, of any plan), "bird" or "aircraft"
(unknown which). A set has `targets`, the kinds that a detector shall find there; the rest are others, which it may take for one.
"""

import csv
import dataclasses
import fnmatch
import functools
import pathlib
import re
import warnings
from typing import Callable, Optional

import airtruth
import cv2
import numpy as np

import tight

VIDEOS = (".mp4", ".avi", ".mov", ".mkv", ".m4v", ".mpg")
PICTURES = (".png", ".jpg", ".jpeg")


class Refused(Exception):
    """What the user gave cannot be used; said in one line."""


@dataclasses.dataclass
class Object:
    box: np.ndarray
    kind: str
    above_horizon: Optional[bool] = None  # None: not labelled


@dataclasses.dataclass
class Frame:
    number: int
    objects: list
    ignored: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 4)))  # boxes that count neither way
    picture: Optional[pathlib.Path] = None  # None: a frame of the clip's video


@dataclasses.dataclass
class Clip:
    name: str
    video: Optional[pathlib.Path]  # None: each frame has a picture
    frames: list

    def kinds(self):
        return {one.kind for frame in self.frames for one in frame.objects}

    def grey(self, frames):
        """The luma of some of its frames, which are in order; of a video as the decoder has it."""
        if self.video is None:
            for frame in frames:
                picture = cv2.imread(str(frame.picture), cv2.IMREAD_GRAYSCALE)
                if picture is None:
                    raise Refused(f"{frame.picture} cannot be read as a picture")
                yield picture
            return
        wanted = {frame.number for frame in frames}
        found = 0
        with airtruth.VideoReader(self.video) as video:
            for picture in video:
                if picture.index in wanted:
                    found += 1
                    yield picture.full_range_gray
                if found == len(wanted):
                    return
        raise Refused(f"{self.video} has no frame {max(wanted)}, which its labels have")


@dataclasses.dataclass
class Source:
    """A set before anybody has it."""
    title: str
    licence: str
    where: str
    targets: tuple
    read: Callable
    camera: str = "its own"  # sets of one camera state the same


@dataclasses.dataclass
class RealSet:
    name: str
    source: Source
    clips: list

    def matching(self, patterns):
        """The clips that any of the patterns (* and ?) names; Refused where one names none."""
        for pattern in patterns:
            if not fnmatch.filter([clip.name for clip in self.clips], pattern):
                raise Refused(f"{self.name} has no clip {pattern}")
        return [clip for clip in self.clips if any(fnmatch.fnmatchcase(clip.name, pattern) for pattern in patterns)]


def number_of(name):
    """The last number of a name: sets write it with and without zeros."""
    numbers = re.findall(r"\d+", name)
    return int(numbers[-1]) if numbers else None


def files_in(folder, endings):
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in endings)


def the_folder(root, *names):
    """The first of the folders that is there."""
    for name in names:
        if (root / name).is_dir():
            return root / name
    raise Refused(f"{root} holds no folder {' or '.join(names)}")


def split_line(path, number, line, separator, least):
    cells = [cell.strip() for cell in (line.split(separator) if separator else line.split())]
    if len(cells) < least:
        raise Refused(f"{path}:{number}: '{line[:60]}' has {len(cells)} cells; expected {least} or more")
    return cells


def boxes_in(path, origin):
    """frame: boxes, of a CSV with a box a line."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*holds boxes without a track")  # none is asked for
        [clip] = airtruth.read_labels(path, "csv")
    boxes = {frame.frame: [label.box_px for label in frame.labels] for frame in clip.frames if frame.labels}
    return {number: [box - (origin, origin, 0, 0) for box in found] for number, found in boxes.items()}


# The set of Svanstrom and others, from a zoom camera on the ground. Its own boxes are two to three times as large as the aircraft: those of the
# aircraft themselves are in a folder `tight` beside the clips, or are found in the pictures. A frame without one has its loose box as a region that
# counts neither way.
KINDS_BY_NAME = {"AIRPLANE": "airplane", "HELICOPTER": "helicopter", "BIRD": "bird", "DRONE": "multirotor"}


class LooseClip(Clip):
    """A clip with loose boxes alone. Its pictures are read where its frames are asked for."""

    def __init__(self, name, video, kind, loose):
        self.name, self.video, self.kind, self.loose = name, video, kind, loose

    @functools.cached_property
    def frames(self):
        found = tight.tight_boxes(self.loose, self.grey([Frame(number, []) for number in sorted(self.loose)]))
        return [Frame(number, [Object(box, self.kind) for box in found[number] if box is not None],
                      np.array([loose for loose, box in zip(boxes, found[number]) if box is None]).reshape(-1, 4))
                for number, boxes in sorted(self.loose.items())]


def read_ground_real(root):
    tight_files = {path.stem: path for path in root.glob("tight/*.csv")}
    clips = []
    for video in files_in(root, VIDEOS):
        labels = video.with_suffix(".csv")
        kind = KINDS_BY_NAME.get(video.stem.split("_")[1] if "_" in video.stem else "")
        if kind is None or not labels.exists():
            continue
        loose = boxes_in(labels, 1)
        if kind in ("bird", "multirotor"):
            frames = [Frame(number, [Object(box, kind) for box in boxes]) for number, boxes in sorted(loose.items())]
        elif video.stem not in tight_files:
            clips.append(LooseClip(video.stem, video, kind, loose))
            continue
        else:
            known = boxes_in(tight_files[video.stem], 0)
            frames = [Frame(number, [Object(box, kind) for box in known.get(number, [])],
                            np.zeros((0, 4)) if number in known else np.array(loose[number])) for number in sorted(set(loose) | set(known))]
        clips.append(Clip(video.stem, video, frames))
    return clips


# Clips with boxes in files of the same name, as `airtruth compare` reads them, and in ignore.csv what counts neither way in further frames.
def read_boxed(root):
    ignored = {}
    if (root / "ignore.csv").exists():
        with open(root / "ignore.csv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                box = np.array([float(row[key]) for key in ("x", "y", "width", "height")])
                for number in range(int(row["first_frame"]), int(row["last_frame"]) + 1):
                    ignored.setdefault(pathlib.Path(row["sequence"]).stem, {}).setdefault(number, []).append(box)
    clips = []
    for video in files_in(root, VIDEOS):
        labels = video.with_suffix(".csv")
        if not labels.exists():
            continue
        boxes, regions = boxes_in(labels, 0), ignored.get(video.stem, {})
        frames = [Frame(number, [Object(box, "airplane") for box in found]) for number, found in boxes.items()]
        frames += [Frame(number, [], np.array(found)) for number, found in regions.items() if number not in boxes]
        clips.append(Clip(video.stem, video, sorted(frames, key=lambda frame: frame.number)))
    return clips


# Airborne Object Tracking: ImageSets/groundtruth.json and Images/FLIGHT/TIMEFLIGHT.png, which the package reads.
AOT_KINDS = {"airplane": "airplane", "helicopter": "helicopter", "bird": "bird", "flock": "bird", "drone": "multirotor"}


def read_aot(root):
    parts = sorted({path.parent.parent for path in root.rglob("ImageSets/groundtruth.json")})
    if not parts:
        raise Refused(f"{root} holds no ImageSets/groundtruth.json")
    clips = []
    for part in parts:
        for clip in airtruth.read_labels(part, "aot", size=(2448, 2048)):
            frames = []
            for frame in clip.frames:
                picture = part / clip.media / frame.picture
                if not picture.exists():  # parts are fetched in pieces
                    continue
                objects = [Object(label.box_px, AOT_KINDS.get(label.category.lower().rstrip("0123456789"), "aircraft"), label.above_horizon)
                           for label in frame.labels]
                frames.append(Frame(frame.frame, objects, picture=picture))
            if frames:
                clips.append(Clip(clip.name, None, frames))
    return clips


def read_dogfight(root):
    """The corrected labels of NPS-Drones and FL-Drones by Ashraf and others, "frame, number of boxes, x1, y1, x2, y2, ..." in
    annotations/NAME.txt, beside the videos in videos/: they go together by their number."""
    videos = {number_of(path.stem): path for path in files_in(the_folder(root, "videos", "Videos"), VIDEOS)}
    clips = []
    for labels in sorted(the_folder(root, "annotations", "Annotations").rglob("*.txt")):
        video = videos.get(number_of(labels.stem))
        if video is None:
            continue
        frames = []
        for number, line in enumerate(labels.read_text(encoding="utf-8").splitlines(), 1):
            if not line.strip():
                continue
            try:
                cells = [float(cell) for cell in split_line(labels, number, line, ",", 2)]
            except ValueError as error:
                raise Refused(f"{labels}:{number}: '{line[:60]}' holds what is no number") from error
            corners = np.array(cells[2:2 + 4 * int(cells[1])])
            if len(corners) != 4 * int(cells[1]):
                raise Refused(f"{labels}:{number}: '{line[:60]}' says {int(cells[1])} boxes; found {len(corners) / 4:g}")
            objects = [Object(np.array([x0, y0, x1 - x0, y1 - y0]), "uav") for x0, y0, x1, y1 in corners.reshape(-1, 4)]
            frames.append(Frame(int(cells[0]), objects))
        clips.append(Clip(labels.stem, video, frames))
    return clips


def read_det_fly(root):
    """Pascal VOC: Annotations/NAME.xml and JPEGImages/NAME.jpg. Each picture is a clip of its own, since nothing states which belong together."""
    annotations = the_folder(root, "Annotations", "annotations")
    pictures = {path.stem: path for path in files_in(the_folder(root, "JPEGImages", "images"), PICTURES)}
    clips = []
    for path in sorted(annotations.rglob("*.xml")):
        if path.stem not in pictures:
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        objects = []
        for found in re.findall(r"<bndbox>(.*?)</bndbox>", text, re.S):
            try:
                x0, y0, x1, y1 = (float(re.search(rf"<{key}>\s*([-\d.]+)", found).group(1)) for key in ("xmin", "ymin", "xmax", "ymax"))
            except (AttributeError, ValueError) as error:
                raise Refused(f"{path}: a bndbox lacks a corner") from error
            objects.append(Object(np.array([x0 - 1, y0 - 1, x1 - x0 + 1, y1 - y0 + 1]), "multirotor"))
        clips.append(Clip(path.stem, None, [Frame(0, objects, picture=pictures[path.stem])]))
    return clips


def read_drone_vs_bird(root):
    """annotations/NAME.txt, a line a frame: "frame objects x y width height class ...", beside the videos in videos/."""
    videos = {path.stem: path for path in files_in(the_folder(root, "videos", "train_videos", "test_videos"), VIDEOS)}
    clips = []
    for labels in sorted(the_folder(root, "annotations").rglob("*.txt")):
        if labels.stem not in videos:
            continue
        frames = []
        for number, line in enumerate(labels.read_text(encoding="utf-8").splitlines(), 1):
            if not line.strip():
                continue
            cells = split_line(labels, number, line, None, 2)
            try:
                count, rest = int(cells[1]), cells[2:]
                if len(rest) < 5 * count:
                    raise ValueError
                objects = [Object(np.array([float(cell) for cell in rest[5 * k:5 * k + 4]]), "bird" if rest[5 * k + 4] == "bird" else "multirotor")
                           for k in range(count)]
                frames.append(Frame(int(cells[0]), objects))
            except ValueError as error:
                raise Refused(f"{labels}:{number}: '{line[:60]}' is no line of frame, count and boxes with a class") from error
        clips.append(Clip(labels.stem, videos[labels.stem], frames))
    return clips


SOURCES = {
    "ground-real": Source("Drone-detection-dataset (Svanstrom, Englund, Alonso-Fernandez 2021), video in visible light", "CC0 1.0",
                          "github.com/DroneDetectionThesis/Drone-detection-dataset", ("airplane", "helicopter"), read_ground_real, "ground-zoom"),
    "boxed": Source("clips with boxes beside them (data/real-aircraft names two)", "that of the clips", "-", ("airplane",), read_boxed),
    "aot": Source("Airborne Object Tracking (Amazon Prime Air 2021)", "CDLA-Permissive-1.0", "registry.opendata.aws/airborne-object-tracking",
                  ("airplane", "helicopter", "aircraft"), read_aot),
    "nps-drones": Source("NPS-Drones (Li and others 2016), labels of Ashraf and others 2021", "none stated; labels MIT",
                         "engineering.purdue.edu/~bouman/UAV_Dataset, github.com/mwaseema/Drone-Detection", ("uav",), read_dogfight),
    "fl-drones": Source("FL-Drones (Rozantsev, Lepetit, Fua 2017), labels of Ashraf and others 2021", "on request; labels MIT",
                        "epfl.ch/labs/cvlab, github.com/mwaseema/Drone-Detection", ("uav",), read_dogfight),
    "det-fly": Source("Det-Fly (Zheng and others 2021)", "none stated; academic use is asked to cite", "github.com/Jake-WU/Det-Fly", ("multirotor",),
                      read_det_fly),
    "drone-vs-bird": Source("Drone-vs-Bird Detection Challenge", "by a data usage agreement, for research", "github.com/wosdetc/challenge",
                            ("multirotor",), read_drone_vs_bird),
}


def read_set(name, folder):
    if name not in SOURCES:
        raise Refused(f"no reader of a set '{name}'; there are {', '.join(SOURCES)}")
    root = pathlib.Path(folder)
    if not root.is_dir():
        raise Refused(f"{folder} is no folder; expected that of {SOURCES[name].title}")
    clips = sorted(SOURCES[name].read(root), key=lambda clip: clip.name)
    if not any(clip.frames for clip in clips):
        raise Refused(f"{folder} holds no labelled clip of {SOURCES[name].title}")
    return RealSet(name, SOURCES[name], clips)
