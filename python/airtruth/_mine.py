# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import os
import pathlib
import tempfile
from dataclasses import dataclass
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._error import Error
from ._frames import Frame, Numbers, Samples
from ._program import run_from
from ._progress import Progress
from ._video import Path, VideoReader

_NEAR_PX = 10  # as far apart, or half of the longer side, two boxes are of one thing
_LEAST_WEIGHT = 0.001  # of a background


@dataclass(eq=False)
class FalseAlarm:
    """A detection in a video in which nothing flies."""

    frame: int  # index in the video, from 0
    time_s: float
    box: Numbers  # (4,): x, y, width, height in pixels of the frame
    score: float

    def around(self, size_px: Sequence[int], frame: Frame) -> NDArray[np.int64]:
        """The crop of this width and height about the box as (x, y, width, height), moved into the frame where it would reach out.
        ValueError where the frame is smaller.

        >>> alarm = airtruth.FalseAlarm(0, 0.0, np.array([150.0, 20.0, 10.0, 4.0]), 0.9)
        >>> alarm.around((64, 32), next(airtruth.VideoReader("clip.mkv")))
        array([96,  6, 64, 32])
        """
        size = _size(size_px)
        whole = np.array(frame.gray.shape[::-1], np.int64)
        if (size > whole).any():
            raise ValueError(f"size_px is {list(size_px)}; expected a width and a height up to those of the frame, {whole.tolist()}")
        corner = np.round(self.box[:2] + self.box[2:] / 2 - size / 2).astype(np.int64)
        return np.concatenate([np.clip(corner, 0, whole - size), size])


@dataclass(eq=False)
class HardNegatives:
    """What a detector takes for an aircraft in a video without one, which mine() finds.

    >>> mined = airtruth.mine("clip.mkv", detector="cmo", every=6, count=3)
    >>> len(mined.alarms), mined.crops((64, 48)).shape, mined.crops((64, 48), channels="gray").shape
    (3, (3, 48, 64, 3), (3, 48, 64))
    >>> sum(len(alarms) for frame, alarms in mined.frames())
    3
    """

    video: pathlib.Path
    detector: str
    alarms: List[FalseAlarm]  # the highest score first
    frame_rate_hz: Optional[float] = None  # of numbered pictures, as mine() was given it

    def frames(self) -> Iterator[Tuple[Frame, List[FalseAlarm]]]:
        """The frames with false alarms and those of each, in the order of the video, which is read anew."""
        by_frame: Dict[int, List[FalseAlarm]] = {}
        for alarm in self.alarms:
            by_frame.setdefault(alarm.frame, []).append(alarm)
        if not by_frame:
            return
        with VideoReader(self.video) as video:
            for frame in video:
                if frame.index in by_frame:
                    yield frame, by_frame.pop(frame.index)
                if not by_frame:
                    return
        raise Error(f"{self.video}: has no frame {min(by_frame)} any more")

    def crops(self, size_px: Sequence[int] = (192, 192), channels: str = "rgb") -> Samples:
        """The pictures of this width and height about each of the alarms, in their order: n x height x width x 3 of "rgb", n x height x
        width of "gray" (Frame.full_range_gray), uint8. ValueError where the frame is smaller than a crop."""
        if channels not in ("rgb", "gray"):
            raise ValueError(f"channels is {channels!r}; expected 'rgb' or 'gray'")
        width, height = _size(size_px)
        pictures = np.zeros((len(self.alarms), height, width) + ((3,) if channels == "rgb" else ()), np.uint8)
        place = {id(alarm): k for k, alarm in enumerate(self.alarms)}
        for frame, alarms in self.frames():
            picture = frame.rgb if channels == "rgb" else frame.full_range_gray
            for alarm in alarms:
                x, y, w, h = alarm.around(size_px, frame)
                pictures[place[id(alarm)]] = picture[y : y + h, x : x + w]
        return pictures

    def backgrounds(self, background: Mapping[str, Any], frame_count: int = 1) -> List[Dict[str, Any]]:
        """The tables [[background]] of a catalogue (docs/formats/catalogue.md) that show the frames with alarms alone, best first, so
        that aircraft are put beside what is mistaken for one. `background`: the table of the whole video with its lens, camera and
        light; each of those returned has its keys, and a `name`, `video`, `first_frame` and `frame_count` of its own: the frame of the
        alarm, and of a `frame_count` of more than 1 those after it. Together they have the weight of the one.

        >>> mined = airtruth.mine("clip.mkv", detector="cmo", every=6, count=3)
        >>> tables = mined.backgrounds({"name": "clip", "lens": {"vertical_fov_deg": 60}, "motion": {"model": "none"}})
        >>> tables[0]["name"] == f"clip-{mined.alarms[0].frame}", tables[0]["first_frame"] == mined.alarms[0].frame
        (True, True)
        >>> rule = {"count": 9, "aircraft": ["c172/*"], "size_px": [10, 30]}
        >>> stream = airtruth.Stream({"stream": {"size_px": [64, 64]}, "background": tables, "random": [rule]})
        >>> stream[0].first_frame in [alarm.frame for alarm in mined.alarms]
        True
        """
        name = background.get("name", self.video.stem)
        rate = {} if self.frame_rate_hz is None else {"frame_rate_hz": self.frame_rate_hz}
        weight = max(_LEAST_WEIGHT, background.get("weight", 1) / max(1, len({alarm.frame for alarm in self.alarms})))
        made = {}
        for alarm in self.alarms:
            if alarm.frame not in made:
                made[alarm.frame] = {
                    **rate,
                    **background,
                    "name": f"{name}-{alarm.frame}",
                    "video": str(self.video.absolute()),
                    "first_frame": alarm.frame,
                    "frame_count": frame_count,
                    "weight": weight,
                }
        return list(made.values())


def _size(size_px: Sequence[int]) -> NDArray[np.int64]:
    size = np.asarray(size_px, np.int64)
    if size.shape != (2,) or (size < 1).any():
        raise ValueError(f"size_px is {size.tolist()}; expected a width and a height of 1 px or more")
    return size


def _found(results: pathlib.Path) -> Numbers:
    """A row for each detection of an aircraft: frame from 0, track or -1, x, y, width, height, score."""
    text = next((path for path in sorted(results.glob("*/*.txt"))), None)
    if text is None:
        raise Error("airtruth detect left no results; expected the name of one detector")
    lines = text.read_text(encoding="utf-8").splitlines()
    rows = np.array([line.split(",")[:7] for line in lines], float).reshape(-1, 7)
    rows[:, [0, 2, 3]] -= 1  # MOTChallenge counts from 1
    categories = json.loads(text.with_suffix(".json").read_text(encoding="utf-8")).get("categories")
    counts: NDArray[np.bool_] = np.array([_core.claims_aircraft(category) for category in categories or ["aircraft"] * len(rows)], bool)
    return rows[counts]


def _thinned(rows: Numbers, every: int, count: Optional[int]) -> Numbers:
    """The rows by their score, without those of a thing that has a better one nearer than so many frames."""
    frame, track, box, score = rows[:, 0], rows[:, 1], rows[:, 2:6], rows[:, 6]
    centre, reach = box[:, :2] + box[:, 2:] / 2, np.maximum(_NEAR_PX, box[:, 2:].max(axis=1, initial=0) / 2)
    left, kept = np.ones(len(rows), bool), []
    for k in np.lexsort((frame, -score)):
        if not left[k]:
            continue
        kept.append(k)
        if len(kept) == count:
            break
        at_one_place = np.hypot(*(centre - centre[k]).T) <= np.maximum(reach, reach[k])
        left &= ~((np.abs(frame - frame[k]) < every) & (at_one_place | ((track == track[k]) & (track >= 0))))
    return rows[kept]


def mine(
    video: Path,
    *,
    detector: str = "network",
    every: int = 30,
    count: Optional[int] = 100,
    min_score: Optional[float] = None,
    lens: Optional[Path] = None,
    mask: Optional[Path] = None,
    frame_rate_hz: Optional[float] = None,
    progress: Optional[Progress] = None,
) -> HardNegatives:
    """Finds the hard negatives of a detector: what it takes for an aircraft in a video in which none flies, where each detection is
    a false alarm. Train with their pictures as background, and mine again with the detector that comes out.

    `detector`: any one that `airtruth detect --detector` takes (docs/detection.md): "network", which ships, "cmo",
    "onnx:aircraft.onnx" of your own, "exec:COMMAND". Networks run in a confined process. `every`: one thing counts once in so many frames,
    by its highest score; what is at one place of the picture, or on one track as of `airtruth detect --associate`, is one thing.
    `count`: at most so many alarms, those of the highest scores; None: all. `min_score`: only those of so high a score. `lens`: a calibration
    as of Lens.from_file(), which makes tracks better. `mask`: a picture that is black where the own aircraft is; what a detector finds
    there does not count. `frame_rate_hz`: of numbered pictures, which state none. A detection that its detector calls by another class, as "bird" or
    "drone", is no alarm; all other words are an aircraft's (docs/detection-measures.md).
    `progress` as in run().

    The video must not show an aircraft: it would be learned as background. airtruth.Error for a file that cannot be read, for an unknown
    detector and one that fails; ValueError for a number out of range. Ctrl-C ends the work.

    >>> airtruth.mine("clip.mkv", min_score=0.9).alarms
    []
    >>> mined = airtruth.mine("clip.mkv", detector="cmo", every=6, count=3)
    >>> [alarm.score for alarm in mined.alarms] == sorted((alarm.score for alarm in mined.alarms), reverse=True)
    True
    >>> mined.alarms[0].box.shape
    (4,)
    """
    for name, value in (("every", every), ("count", count)):
        if value is not None and not value >= 1:
            raise ValueError(f"{name} is {value}; expected 1 or more")
    path = pathlib.Path(os.fspath(video))
    options = {
        "detector": detector,
        "associate": True,
        "declare": "1/1",
        "confident": -1e300,
        "min_score": min_score,
        "lens": lens,
        "mask": mask,
        "mask_results": mask is not None,
        "frame_rate": frame_rate_hz,
    }
    with tempfile.TemporaryDirectory(prefix="airtruth_mine_") as folder:
        try:
            run_from(3, "detect", [path], {**options, "out": folder}, progress)
        except Error as error:  # in the words of the program
            raise Error(str(error).replace("--frame-rate", "frame_rate_hz")) from None
        rows = _thinned(_found(pathlib.Path(folder)), every, count)
    mined = HardNegatives(path, detector, [FalseAlarm(int(row[0]), 0.0, row[2:6].copy(), float(row[6])) for row in rows], frame_rate_hz)
    for frame, alarms in mined.frames():
        for alarm in alarms:
            alarm.time_s = frame.time_s if frame_rate_hz is None else frame.index / frame_rate_hz
    return mined
