# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
import pathlib
from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._error import Error
from ._frames import Frame, truth_of
from ._labels import Clip, clip_of
from ._lens import Lens
from ._video import Path, VideoReader

Columns = Dict[str, NDArray[Any]]
# How the columns of a vector are named in a table, by the end of its name.
_PARTS = {
    "box_px": ("x", "y", "width", "height"),
    "ned_m": ("north", "east", "down"),
    "ned_mps": ("north", "east", "down"),
    "yaw_pitch_roll_deg": ("yaw", "pitch", "roll"),
    "in_cam_m": ("x", "y", "z"),
    "centroid_px": ("x", "y"),
}


class Sequence:
    """One video of a data set with what is known about it, as it was when it was read.

    >>> sequence = airtruth.DataSet("set")["across"]
    >>> sequence.name, sequence.video.name, len(sequence)
    ('across', 'across.mkv', 6)
    >>> sequence.truth["range_m"].shape, sequence.truth["covered_box_px"][3]
    ((6,), array([43., 57., 31., 10.]))
    """

    def __init__(self, core: _core.Sequence, boxes: str) -> None:
        self._core = core
        self._boxes = boxes
        self._truth: Optional[Columns] = None
        self._reader: Optional[Tuple[int, int, VideoReader]] = None  # process, the next frame's number, reader

    @property
    def name(self) -> str:
        """As the set names it."""
        return self._core.name

    @property
    def folder(self) -> pathlib.Path:
        """Where its files lie."""
        return self._core.folder

    @property
    def video(self) -> pathlib.Path:
        """Its own video; "." for an imported clip without pictures."""
        return self._core.video

    @property
    def is_imported(self) -> bool:
        """Whether the clip was labelled elsewhere and imported: its labels are all that is known, and its truth is made of them,
        with the labels' boxes as exact boxes. A frame to which they give no time has that of its number at their frame rate; NaN
        where they state none."""
        return self._core.is_imported

    @property
    def lens(self) -> Optional[Lens]:
        """None for an imported clip."""
        lens = self._core.lens
        return None if lens is None else Lens(lens)

    @property
    def labels(self) -> Clip:
        """The boxes of the frames in which an intruder is visible."""
        return clip_of(self._core.labels)

    @property
    def truth(self) -> Columns:
        """NumPy columns, a row for each intruder and frame: `frame`, `time_s`, the fields of Intruder and those of Encounter. Vectors
        of k numbers are n x k. What is not defined is NaN."""
        if self._truth is None:
            self._truth = self._core.intruder_columns()
        return self._truth

    @property
    def frames(self) -> Columns:
        """NumPy columns, a row for each frame: the fields of FrameTruth but its intruders; a matrix is a row of 9 numbers."""
        return self._core.frame_columns()

    def __len__(self) -> int:
        return self._core.length

    def frame(self, k: int) -> Frame:
        """The picture of frame k and its truth. Frames in a row are read fastest. IndexError where there is none; airtruth.Error
        where the video cannot be read.

        >>> frame = airtruth.DataSet("set")["across"].frame(3)
        >>> frame.rgb.shape, frame.intruders[0].covered_box
        ((120, 160, 3), array([43, 57, 31, 10]))
        """
        try:
            k = range(len(self))[k]
        except IndexError:
            raise IndexError(f"there is no frame {k}; {self.name} has {len(self)}") from None
        truth = truth_of(self._core.truth(k))
        process, following, reader = self._reader or (0, 0, None)
        if reader is None or process != os.getpid() or following != truth.frame:
            reader = VideoReader(self.video, truth.frame)
        self._reader = None
        picture = next(reader, None)
        if picture is None:
            raise Error(f"{self.video}: has no frame {truth.frame}")
        self._reader = (os.getpid(), truth.frame + 1, reader)
        picture.index, picture.time_s, picture.truth = truth.frame, truth.time_s, truth
        return picture

    def __iter__(self) -> Iterator[Frame]:
        return (self.frame(k) for k in range(len(self)))

    def __getstate__(self) -> Tuple[pathlib.Path, str, str]:
        return self.folder, self.name, self._boxes

    def __setstate__(self, state: Tuple[pathlib.Path, str, str]) -> None:
        folder, name, boxes = state
        self.__init__(_core.DataSet(os.fspath(folder)).sequence(name, boxes), boxes)  # type: ignore[misc]


class DataSet:
    """The sequences of a folder that `airtruth dataset build`, `dataset import` or `render` has made. A set may be incomplete.
    airtruth.Error where the folder holds none.

    `boxes` are those of the labels: "covered" (of the pixels that the aircraft covers: for training), "exact" or "visible".

    >>> data = airtruth.DataSet("set")
    >>> data.names, "across" in data
    (['across'], True)
    >>> data["across"].frame(0).intruders[0].aircraft
    'c172/news'
    """

    def __init__(self, folder: Path, *, boxes: str = "covered") -> None:
        self.folder = pathlib.Path(folder)
        self.boxes = boxes
        self._core = _core.DataSet(os.fspath(folder))

    @property
    def names(self) -> List[str]:
        """Sorted."""
        return self._core.names

    def __len__(self) -> int:
        return len(self.names)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __getitem__(self, name: str) -> Sequence:
        """Reads a sequence. airtruth.Error for a name that the set lacks, and for a file that is missing or broken."""
        return Sequence(self._core.sequence(name, self.boxes), self.boxes)

    def table(self) -> Columns:
        """One-dimensional columns over all sequences, a row for each intruder and frame, as pandas.DataFrame() takes them: `sequence`
        and those of Sequence.truth, in which a vector has a column for each part (`covered_box_px_width`, `position_ned_m_down`).

        >>> table = airtruth.DataSet("set").table()
        >>> len(table["frame"]), table["sequence"][0], table["covered_box_px_width"][3]
        (6, 'across', 31.0)
        """
        tables = [self[name].truth for name in self.names]
        counts = [len(table["frame"]) for table in tables]
        result: Columns = {"sequence": np.repeat(np.array(self.names, dtype="U"), counts)}
        for key in tables[0]:
            column = np.concatenate([table[key] for table in tables])
            if column.ndim == 1:
                result[key] = column
                continue
            parts = next(parts for end, parts in _PARTS.items() if key.endswith(end))
            result.update({f"{key}_{part}": column[:, i] for i, part in enumerate(parts)})
        return result

    def __getstate__(self) -> Tuple[pathlib.Path, str]:
        return self.folder, self.boxes

    def __setstate__(self, state: Tuple[pathlib.Path, str]) -> None:
        self.__init__(state[0], boxes=state[1])  # type: ignore[misc]

    def _repr_html_(self) -> str:
        """The sequences as a table for a notebook."""
        from ._show import html_of_set

        return html_of_set(self)
