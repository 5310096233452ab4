# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import contextlib
import os
from dataclasses import dataclass
from types import TracebackType
from typing import Iterator, Optional, Type, Union

from . import _core
from ._frames import Frame

Path = Union[str, "os.PathLike[str]"]


@dataclass
class VideoInfo:
    """What a video states of itself."""

    width: int
    height: int
    frame_rate_hz: float
    frame_count_estimate: int  # as the container gives it; 0: unknown
    codec: str  # FFmpeg's name, for example "h264"
    pixel_format: str  # FFmpeg's name, for example "yuv420p"


class VideoReader(contextlib.AbstractContextManager["VideoReader"], Iterator[Frame]):
    """The frames of a video (H.264, HEVC, MJPEG, FFV1, ... in mp4, mov, avi, mkv, webm) or of numbered images ("frames/%04d.png", or
    their folder), one after the other, from `first_frame` on, which has the index 0 and the time 0 s.

    The reader is an iterator, and a context that closes it. airtruth.Error for a file that is missing or no video, past its end,
    after close(), in two threads at a time, and in a process that was forked after the reader was made.

    >>> with airtruth.VideoReader("clip.mkv", first_frame=2) as video:
    ...     [(frame.index, frame.gray.shape) for frame in video]
    [(0, (120, 160)), (1, (120, 160)), (2, (120, 160)), (3, (120, 160))]
    """

    def __init__(self, video: Path, first_frame: int = 0) -> None:
        self._core = _core.VideoReader(os.fspath(video), first_frame)

    @property
    def info(self) -> VideoInfo:
        """Size, rate and format."""
        return VideoInfo(**self._core.info())

    def __next__(self) -> Frame:
        got = self._core.next()
        if got is None:
            raise StopIteration
        picture, index, time_s, damaged = got
        return Frame(index, time_s, *picture, damaged=damaged)

    def close(self) -> None:
        """Closes the file. Frames that were read stay."""
        self._core.close()

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()
