# SPDX-License-Identifier: Apache-2.0
"""Progress of long work: the caller's own function, or a line on a terminal."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from typing import Callable, Iterator, Optional

Progress = Callable[[int, int], object]

_REDRAW_S = 0.1


def _can_redraw() -> bool:
    return sys.stderr is not None and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"


class Line:
    """A line on the terminal of standard error: "measuring  12/322 (4 %)". Without a terminal that can redraw it draws nothing."""

    def __init__(self, stage: str) -> None:
        self._stage = stage
        self._drawn_s = 0.0
        self._is_drawn = False

    def draw(self, done: int, total: int, stage: str = "") -> None:
        now_s = time.monotonic()
        if (self._is_drawn and now_s - self._drawn_s < _REDRAW_S) or not _can_redraw():
            return
        count = f"{done}/{total} ({100 * done // total} %)" if total > 0 else str(done)
        self._drawn_s, self._is_drawn = now_s, True
        sys.stderr.write(f"\r\x1b[K{stage or self._stage}  {count}")
        sys.stderr.flush()

    def erase(self) -> None:
        if self._is_drawn:
            self._is_drawn = False
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


def checked(progress: Optional[Progress]) -> Optional[Progress]:
    if progress is not None and not callable(progress):
        raise TypeError("progress is no function of two numbers")
    return progress


@contextlib.contextmanager
def shown(stage: str, progress: Optional[Progress]) -> Iterator[Progress]:
    """What long work calls with the numbers done and in all, 0 where that is unknown: the caller's function, or the line."""
    told = checked(progress)
    if told:
        yield told
        return
    line = Line(stage)
    try:
        yield line.draw
    finally:
        line.erase()
