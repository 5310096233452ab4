# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import itertools
import operator
import os
import pathlib
from dataclasses import dataclass
from typing import Any, Iterator, List, Optional, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._frames import Frame, truth_of
from ._source import Source, cache_of, source_of
from ._video import Path

_MOST_INDEX = 2**40


@dataclass(eq=False)
class Sample:
    """One picture to learn from, or several in a row of one flight, with their truth.

    >>> sample = airtruth.Stream("training.toml", seed=7)[3]
    >>> sample.index, sample.background, sample.crop[2:], len(sample.frames)
    (3, 'clip', array([64, 64]), 1)
    >>> sample.frames[0].rgb.shape, sample.frames[0].boxes().shape == (len(sample.frames[0].intruders), 4)
    ((64, 64, 3), True)
    """

    index: int
    background: str  # its name in the catalogue
    first_frame: int  # number of the first picture's frame in the background's video
    crop: NDArray[np.int64]  # (4,): the part of the frame that the pictures show
    frames: List[Frame]  # as many as the catalogue's [stream] frames
    # How many encounters of real traffic it stands for, up to a factor that a stream shares; None where it is of no model of traffic.
    weight: Optional[float] = None


class Stream:
    """An endless series of labelled pictures of a catalogue, made when they are asked for: nothing is written but the cache. The
    catalogue is one that data sets are built from, with a table [stream]: a path, a text of several lines or a dict, as in render().

    A sample depends on the catalogue, the seed (0 to 2^64 - 1) and its index (0 to 2^40) alone, whatever was asked for before and by
    which thread or process; `airtruth render` of scene(index) makes the same pictures and truth, but for samples that
    [stream] other_cameras shows otherwise. Indices in a row are made fastest, and are mixed already. `threads` draw one sample; loaders
    with several workers take 1. `cache` as in render().

    A stream may be used by several threads, sent to other processes, and used after a fork, where it opens its files anew. Ctrl-C
    ends a sample within 2 s. airtruth.Error for faults in the catalogue and the files that it names; IndexError for an index out of
    range.

    >>> stream = airtruth.Stream("training.toml", seed=7)
    >>> bool((stream[5].frames[0].gray == stream[5].frames[0].gray).all())
    True
    >>> [sample.index for sample, _ in zip(stream, range(3))]
    [0, 1, 2]
    """

    def __init__(
        self,
        catalogue: Source,
        *,
        seed: int = 1,
        threads: int = 1,
        cache: Union[bool, Path] = True,
        folder: Optional[Path] = None,
    ) -> None:
        source, base = source_of(catalogue, folder)
        if isinstance(source, pathlib.Path):
            source = source.absolute()  # another process may work elsewhere
        self._arguments: Tuple[Any, ...] = (source, base, seed, threads, cache_of(cache))
        self._open()

    def _open(self) -> None:
        self._core = _core.Stream(*self._arguments)
        self._process = os.getpid()

    def _ready(self) -> _core.Stream:
        if self._process != os.getpid() or self._core.is_stopped:
            self._open()
        return self._core

    def __getitem__(self, index: int) -> Sample:
        """The sample of that index."""
        number = _checked(index)
        background, first_frame, weight, crop, made = self._ready().sample(number)
        frames = []
        for picture, fields, masks, covered in made:
            truth = truth_of(fields)
            frames.append(
                Frame(truth.frame, truth.time_s, *picture, damaged=truth.damaged, truth=truth, crop=crop, masks=masks, covered_in_crop=covered)
            )
        return Sample(number, background, first_frame, crop, frames, weight)

    def __iter__(self) -> Iterator[Sample]:
        """All samples from index 0 on; it does not end."""
        return (self[index] for index in itertools.count())

    def scene(self, index: int) -> str:
        """The sample's scene as the text of a scene file, with absolute paths.

        >>> stream = airtruth.Stream("training.toml", seed=7)
        >>> frame = next(airtruth.render(stream.scene(3)))
        >>> sample = stream[3]
        >>> x, y, width, height = sample.crop
        >>> bool((frame.gray[y:y + height, x:x + width] == sample.frames[0].gray).all())
        True
        """
        return self._ready().scene(_checked(index))

    def __getstate__(self) -> Tuple[Any, ...]:
        return self._arguments

    def __setstate__(self, state: Tuple[Any, ...]) -> None:
        self._arguments = state
        self._open()


def _checked(index: int) -> int:
    number = operator.index(index)
    if not 0 <= number <= _MOST_INDEX:
        raise IndexError(f"the index is {number}; expected 0 to {_MOST_INDEX}")
    return number
