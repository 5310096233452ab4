# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple

from . import _core
from ._frames import Numbers
from ._video import Path


@dataclass(eq=False)
class Label:
    """One object in one frame of labelled video. What a format does not state is None."""

    track: int  # the same throughout a clip; from 0
    category: str
    box_px: Numbers  # (4,): x, y, width, height; the first pixel covers [0, 1)
    visible: Optional[float]  # visible share, 0 to 1
    occluded: Optional[bool]
    truncated: Optional[bool]  # cut by the frame's edge
    range_m: Optional[float]
    above_horizon: Optional[bool]
    contrast_to_noise: Optional[float]
    area_px: Optional[float]
    object_class: str  # "ignore": a region in which detections count neither way
    mask: Optional[Dict[str, Any]]  # COCO's compressed run lengths: {"size": (height, width), "counts": text}


@dataclass(eq=False)
class LabelledFrame:
    """The labels of one frame."""

    frame: int
    time_s: Optional[float]
    picture: str  # file of the picture, relative to the clip's media; empty for a frame of a video
    labels: List[Label]


@dataclass(eq=False)
class Clip:
    """The labels of one video.

    >>> clip = airtruth.DataSet("set")["across"].labels
    >>> clip.name, len(clip.frames), clip.frames[3].labels[0].box_px
    ('across', 6, array([43., 57., 31., 10.]))
    """

    name: str
    media: os.PathLike[str]  # a video, a list or a folder of pictures; "." where there is none
    width: int  # 0: unknown
    height: int
    frame_rate_hz: Optional[float]
    frames: List[LabelledFrame]  # in order, including those without an object


def clip_of(fields: Dict[str, Any]) -> Clip:
    frames = []
    for frame in fields.pop("frames"):
        labels = [Label(**label) for label in frame.pop("labels")]
        frames.append(LabelledFrame(**frame, labels=labels))
    return Clip(**fields, frames=frames)


def read_labels(source: Path, format: str = "airtruth", *, size: Optional[Tuple[int, int]] = None, category: str = "aircraft") -> List[Clip]:
    """The clips of a labelled set. `format`: "airtruth" (one labels.jsonl), "coco", "yolo", "mot", "voc", "cvat", "aot", "otb",
    "got10k", "vot", "webdataset", "evision" or "csv" (docs/formats/exchange.md says which file or folder `source` is). `size`: width
    and height of the pictures where neither labels nor pictures state them. `category`: that of objects where the format has none.
    airtruth.Error with file and line, and for "table", which can only be written.

    >>> [clip.name for clip in airtruth.read_labels("coco", "coco")]
    ['across']
    """
    return [clip_of(fields) for fields in _core.read_clips(format, os.fspath(source), size, category).dicts()]


def convert_labels(
    source: Path,
    from_format: str,
    folder: Path,
    to_format: str,
    *,
    part: str = "train",
    size: Optional[Tuple[int, int]] = None,
    category: str = "aircraft",
) -> None:
    """Writes the labels of a set, without its pictures, as another format into a new folder, as the part of that name. The other
    arguments are those of read_labels(); a "table" can be written too. airtruth.Error where the folder exists and is not empty, and
    for a format that can only be read ("evision", "csv").

    >>> airtruth.convert_labels("coco", "coco", "mot", "mot")
    >>> [clip.name for clip in airtruth.read_labels("mot", "mot", size=(160, 120))]
    ['across']
    """
    clips = _core.read_clips(from_format, os.fspath(source), size, category)
    _core.write_clips(to_format, os.fspath(folder), part, clips)
