# SPDX-License-Identifier: Apache-2.0
# mypy: allow-subclassing-any, no-warn-unused-ignores, no-warn-return-any
"""Training streams as data sets of PyTorch. This module alone needs torch (Debian's python3-torch); airtruth loads it where
`airtruth.torch` is first used.

A label is the place of its class in CLASSES, from 1; 0 is the background, as torchvision's detectors have it.
"""

from __future__ import annotations

import operator
from typing import Any, Dict, List, Sequence, Tuple

import numpy as np
import torch  # type: ignore
import torch.utils.data  # type: ignore

from ._frames import Intruder, rows_of
from ._stream import Sample, Stream

CLASSES = ("aircraft", "bird", "multirotor", "balloon", "glint", "dirt", "insect")


class Dataset(torch.utils.data.Dataset):  # type: ignore
    """Dataset(stream, length, first=0, *, channels="rgb", dtype="uint8", distractors=False, min_visible=0.3): the samples first to
    first + length - 1 of a stream as a map-style data set, of which an item is (picture, target).

    `picture`: tensor C x H x W, uint8 of 0 to 255 or, with dtype="float32", of 0 to 1; C is 3 with channels="rgb" and 1 with
    "gray" (Frame.full_range_gray). Of a stream with several `frames`, C is that of all of them, the earliest first, and the target is of the last.

    `target`: a dict as the detectors of torchvision take it. `boxes` (n x 4, float32): x0, y0, x1, y1 in pixels of the picture, of
    the visible objects with a covered box, cut at the picture's edges; `labels` (n, int64); `range_m` (n, float32), NaN for what is
    on the lens; `index` (int64): the sample's. `ignored` (k x 4, float32): boxes of the objects that are seen and count neither as
    an object nor as background: less than the share `min_visible` of the covered box lies in the picture, or there is none (then
    the visible box). Of a stream with `masks`, `masks` (n x H x W, uint8): 1 where the object covers at least half of the pixel.

    `distractors`: False: birds, dirt and the like have no box: they are background; True: they have boxes, and the labels of their
    classes.

    Samples depend on their indices alone, not on the workers of a DataLoader, which may be forked or spawned. Leave its `shuffle`
    False: indices are mixed already, and those in a row are made fastest. Each worker keeps decoded frames of its own, up to the
    catalogue's `memory_mb`. IndexError beyond the length; ValueError for other arguments than these; else as Stream.

    >>> data = airtruth.torch.Dataset(airtruth.Stream("training.toml", seed=7), length=1000)
    >>> picture, target = data[3]
    >>> picture.shape, picture.dtype, target["boxes"].shape[1], int(target["index"])
    (torch.Size([3, 64, 64]), torch.uint8, 4, 3)
    >>> loader = torch.utils.data.DataLoader(data, batch_size=4, num_workers=2, collate_fn=airtruth.torch.collate)
    >>> pictures, targets = next(iter(loader))
    >>> pictures.shape, len(targets)
    (torch.Size([4, 3, 64, 64]), 4)
    """

    def __init__(
        self,
        stream: Stream,
        length: int,
        first: int = 0,
        *,
        channels: str = "rgb",
        dtype: str = "uint8",
        distractors: bool = False,
        min_visible: float = 0.3,
    ) -> None:
        if channels not in ("rgb", "gray"):
            raise ValueError(f"channels is {channels!r}; expected 'rgb' or 'gray'")
        if dtype not in ("uint8", "float32"):
            raise ValueError(f"dtype is {dtype!r}; expected 'uint8' or 'float32'")
        if not 0 <= min_visible <= 1:
            raise ValueError(f"min_visible is {min_visible}; expected 0 to 1")
        self._stream, self._first, self._length = stream, operator.index(first), operator.index(length)
        if self._first < 0 or self._length < 0:
            raise ValueError(f"first is {first} and length {length}; expected 0 or more")
        self._channels, self._dtype, self._distractors, self._min_visible = channels, dtype, distractors, min_visible

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, place: int) -> Tuple[torch.Tensor, Dict[str, torch.Tensor]]:
        number = operator.index(place)
        if not -self._length <= number < self._length:
            raise IndexError(f"the place is {number} of {self._length}")
        sample = self._stream[self._first + number % self._length]
        return self._picture(sample), self._target(sample)

    def _picture(self, sample: Sample) -> torch.Tensor:
        pictures = [np.moveaxis(frame.rgb, 2, 0) if self._channels == "rgb" else frame.full_range_gray[np.newaxis] for frame in sample.frames]
        picture = torch.from_numpy(np.concatenate(pictures))
        return picture if self._dtype == "uint8" else picture.float() / 255

    def _target(self, sample: Sample) -> Dict[str, torch.Tensor]:
        frame = sample.frames[-1]
        taken, ignored, labels, ranges, places = [], [], [], [], []
        boxes = zip(frame.intruders, rows_of(frame.boxes()), rows_of(frame.boxes("visible")))
        for place, (intruder, covered, visible) in enumerate(boxes):
            is_object = self._distractors or intruder.object_class == "aircraft"
            if not is_object or intruder.state != "visible":
                continue
            share = _share(intruder, covered)
            if share == 0 or share < self._min_visible:
                ignored.append(covered if share > 0 else visible)
                continue
            taken.append(covered)
            labels.append(CLASSES.index(intruder.object_class) + 1)
            ranges.append(np.nan if intruder.range_m is None else intruder.range_m)
            places.append(place)
        target = {
            "boxes": _corners(taken),
            "labels": torch.tensor(labels, dtype=torch.int64),
            "range_m": torch.tensor(ranges, dtype=torch.float32),
            "ignored": _corners(ignored),
            "index": torch.tensor(sample.index, dtype=torch.int64),
        }
        if frame.masks is not None:
            target["masks"] = torch.from_numpy((frame.masks[places] >= 128).astype(np.uint8))
        return target


def _share(intruder: Intruder, in_picture: np.ndarray[Any, Any]) -> float:
    """The share of an intruder's covered box that lies in the picture."""
    whole = intruder.covered_box
    return 0.0 if whole is None or np.isnan(in_picture[0]) else float(in_picture[2] * in_picture[3] / (whole[2] * whole[3]))


def _corners(boxes: List[np.ndarray[Any, Any]]) -> torch.Tensor:
    """(x, y, width, height), without those that are not in the picture, as x0, y0, x1, y1."""
    rows = np.array(boxes, np.float32).reshape(-1, 4)
    rows = rows[~np.isnan(rows[:, 0])]
    rows[:, 2:] += rows[:, :2]
    return torch.from_numpy(rows)


def collate(items: Sequence[Tuple[torch.Tensor, Dict[str, torch.Tensor]]]) -> Tuple[torch.Tensor, List[Dict[str, torch.Tensor]]]:
    """A batch for DataLoader(collate_fn=airtruth.torch.collate): pictures B x C x H x W, and a list of B targets, whose boxes are of
    unequal number. The detectors of torchvision take both as they are (pictures of dtype="float32").

    >>> data = airtruth.torch.Dataset(airtruth.Stream("training.toml", seed=7), length=3)
    >>> pictures, targets = airtruth.torch.collate([data[0], data[1]])
    >>> pictures.shape, [int(target["index"]) for target in targets]
    (torch.Size([2, 3, 64, 64]), [0, 1])
    """
    pictures, targets = zip(*items)
    return torch.stack(pictures), list(targets)


def ultralytics(pictures: torch.Tensor, targets: Sequence[Dict[str, torch.Tensor]]) -> Dict[str, torch.Tensor]:
    """The result of collate() as the batch that Ultralytics' models and losses take: `img` (the pictures), and of all n boxes
    `batch_idx` (n, float32: which picture), `cls` (n x 1, float32: the label less 1, an aircraft is 0) and `bboxes` (n x 4, float32:
    centre x, y, width, height as shares of the picture).

    >>> data = airtruth.torch.Dataset(airtruth.Stream("training.toml", seed=7), length=8)
    >>> batch = airtruth.torch.ultralytics(*airtruth.torch.collate(list(data)))
    >>> batch["img"].shape, batch["cls"].shape == (len(batch["bboxes"]), 1), bool((batch["bboxes"] <= 1).all())
    (torch.Size([8, 3, 64, 64]), True, True)
    """
    height, width = pictures.shape[-2:]
    boxes = torch.cat([target["boxes"] for target in targets]) / torch.tensor([width, height, width, height])
    counts = torch.tensor([len(target["boxes"]) for target in targets])
    return {
        "img": pictures,
        "batch_idx": torch.repeat_interleave(torch.arange(len(targets)), counts).float(),
        "cls": torch.cat([target["labels"] for target in targets]).float()[:, None] - 1,
        "bboxes": torch.cat([(boxes[:, :2] + boxes[:, 2:]) / 2, boxes[:, 2:] - boxes[:, :2]], dim=1),
    }
