# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import contextlib
from types import TracebackType
from typing import Iterator, Optional, Type, Union

from . import _core
from ._frames import Frame, truth_of
from ._lens import Lens
from ._progress import Line, Progress, checked
from ._source import Source, cache_of, source_of
from ._video import Path, VideoInfo


class Rendering(contextlib.AbstractContextManager["Rendering"], Iterator[Frame]):
    """The frames of a scene, which render() begins: an iterator over Frame, and a context that closes it.

    >>> with airtruth.render("scene.toml") as frames:
    ...     frames.video.width, frames.lens.model, sum(1 for frame in frames)
    (160, 'pinhole', 6)
    """

    def __init__(self, core: _core.Renderer, progress: Optional[Progress] = None) -> None:
        self._core = core
        self._progress = progress
        self._line = Line("rendering")
        self._done = 0
        self._total = self.video.frame_count_estimate

    @property
    def video(self) -> VideoInfo:
        """The background, with the number of frames that the scene makes of it. airtruth.Error after close()."""
        return VideoInfo(**self._core.info())

    @property
    def lens(self) -> Lens:
        """The camera's lens. airtruth.Error after close()."""
        return Lens(self._core.lens())

    def __next__(self) -> Frame:
        # A terminal shows the line while a frame is awaited, and is the caller's own between frames.
        if not self._progress:
            self._line.draw(self._done, self._total)
        try:
            got = self._core.next()
        finally:
            self._line.erase()
        if got is None:
            raise StopIteration
        picture, fields = got
        truth = truth_of(fields)
        self._done += 1
        if self._progress:
            self._progress(self._done, self._total)
        return Frame(truth.frame, truth.time_s, *picture, damaged=truth.damaged, truth=truth)

    def close(self) -> None:
        """Ends the work and frees its memory. Frames that were made stay."""
        self._core.close()

    def __exit__(self, kind: Optional[Type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]) -> None:
        self.close()


def render(
    scene: Source,
    *,
    threads: int = 0,
    cache: Union[bool, Path] = True,
    progress: Optional[Progress] = None,
    folder: Optional[Path] = None,
) -> Rendering:
    """Puts a scene's intruders into its video, frame by frame, in memory: the pictures and truth that `airtruth render` makes of the
    scene, before its codec. Nothing is written but the cache.

    `scene` is the path of a scene file; a text of several lines in its form (docs/formats/scene.md); or a dict of the same keys.
    Relative paths in a text or a dict are relative to `folder` (default: the working folder).
    `threads`: frames made at the same time; 0: one for each core; at most 256. Pictures and truth do not depend on it.
    `cache`: whether measured motion and calibration of a clip are kept and found again; a path: in that folder.
    `progress(done, total)` is called after each frame; total is 0 where it is unknown. Without it a terminal shows a line.

    What is wrong with the scene is an airtruth.Error with file and line, raised here; what the renderer warns of goes to Python's
    `warnings`. Ctrl-C ends the work within 2 s. A rendering belongs to the process that began it.

    >>> for frame in airtruth.render("scene.toml"):
    ...     if frame.index == 3:
    ...         frame.intruders[0].covered_box, round(frame.intruders[0].range_m)
    (array([43, 57, 31, 10]), 30)
    >>> scene = {"background": {"video": "clip.mkv"}, "lens": {"vertical_fov_deg": 60}, "motion": {"model": "none"},
    ...          "camera": {"position_ned_m": [0, 0, -150]},
    ...          "intruder": [{"aircraft": "c172/news", "waypoints_ned_m": [[60, -8, -150], [60, 8, -150]], "speed_mps": 40}]}
    >>> len(list(airtruth.render(scene, threads=1, cache=False)))
    6
    """
    return Rendering(_core.Renderer(*source_of(scene, folder), threads, cache_of(cache)), checked(progress))
