# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, List, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._frames import Numbers
from ._progress import Progress, shown
from ._video import Path

# One number, or the edges of bins.
Range = Union[float, Sequence[float], Numbers]
Choice = Union[int, Sequence[int]]


@dataclass(eq=False)
class Encounters:
    """Encounters of aircraft: n encounters, and columns with a row for each of m states of an aircraft."""

    aircraft_names: List[str]  # of an encounter: ["own", "intruder"], or ["track"]
    weights: Numbers  # (n,): how many encounters of real traffic each one stands for, up to a common factor
    encounter: NDArray[np.int64]  # (m,): number from 1
    aircraft: NDArray[np.int64]  # (m,): index in aircraft_names
    time_s: Numbers  # (m,)
    position_ned_m: Numbers  # (m, 3)
    velocity_ned_mps: Numbers  # (m, 3)
    share: float  # of the model's traffic that domain, airspace and altitude select, 0 to 1
    draws: int  # tracks drawn in all, those that could not be used too
    effective_count: float  # how many encounters of equal weight tell as much


def _list(value: Any) -> Any:
    return [] if value is None else np.atleast_1d(value)


def sample_encounters(
    model: Path,
    *,
    own: Optional[Path] = None,
    count: int = 100,
    seed: int = 1,
    duration_s: Optional[int] = None,
    domain: Optional[Choice] = None,
    airspace: Optional[Choice] = None,
    altitude_ft: Optional[Sequence[float]] = None,
    cpa_time_s: Optional[float] = None,
    hmd_m: Optional[Range] = None,
    hmd_shares: Optional[Range] = None,
    vmd_m: Optional[Range] = None,
    vmd_shares: Optional[Range] = None,
    course_deg: Optional[Range] = None,
    speed_mps: Optional[Range] = None,
    climb_mps: Optional[Range] = None,
    turn_rate_dps: Optional[Range] = None,
    jobs: int = 0,
    progress: Optional[Progress] = None,
) -> Encounters:
    """Draws tracks from an encounter model, alone or paired with an own track to encounters, as `airtruth encounter sample` does: an
    encounter depends on the arguments and its number alone.

    `model`: the file of an encounter model of MIT-LL, or "geometric": steady flight from stated ranges. `own`: a file of encounters
    (docs/formats/encounters.md), with whose first aircraft each track is paired. `count`: 1 to 1,000,000. `jobs`: threads; 0: one for
    each core. A range is one number or the edges of bins; what is None has its default:

    `duration_s`: length of a track (that of the own track, else 60). `domain`, `airspace`: numbers from 1 (all). `altitude_ft`: lowest
    and highest at the start. `cpa_time_s`: of the closest approach, on the own track's clock (its middle). `hmd_m`, `vmd_m`:
    horizontal and vertical miss distance (-500 to 500, -150 to 150), and with `..._shares` the share of each bin (their widths).
    Of geometric: `course_deg` relative to the own one, 180 head-on, 90 from the left (-180 to 180), `speed_mps` (30 to 80),
    `climb_mps` (0), `turn_rate_dps` (0).

    `progress(done, total)` is called as encounters are drawn; without it a terminal shows a line.

    airtruth.Error for files that cannot be read, for what is out of range, and for what is stated and has no effect. Ctrl-C ends the
    work within 2 s.

    >>> met = airtruth.sample_encounters("geometric", own="own.csv", count=36, speed_mps=60, hmd_m=[-100, 100])
    >>> met.aircraft_names, met.weights.shape, met.position_ned_m.shape
    (['own', 'intruder'], (36,), (4392, 3))
    >>> flown = met.velocity_ned_mps[met.aircraft == 1]
    >>> np.hypot(flown[:, 0], flown[:, 1]).round(6)[:3]
    array([60., 60., 60.])
    """
    with shown("drawing", progress) as tell:
        fields = _core.sample_encounters(
            model=os.fspath(model), own=os.fspath(own or ""), count=count, seed=seed, duration_s=duration_s, domain=_list(domain),
            airspace=_list(airspace), altitude_ft=_list(altitude_ft), cpa_time_s=cpa_time_s, hmd_m=_list(hmd_m), hmd_shares=_list(hmd_shares),
            vmd_m=_list(vmd_m), vmd_shares=_list(vmd_shares), course_deg=_list(course_deg), speed_mps=_list(speed_mps),
            climb_mps=_list(climb_mps), turn_rate_dps=_list(turn_rate_dps), jobs=jobs, progress=tell,
        )
    return Encounters(**fields)
