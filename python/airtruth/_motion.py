# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import List, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._frames import Numbers
from ._lens import Lens
from ._progress import Progress, shown
from ._source import cache_of
from ._video import Path


@dataclass
class GyroAgreement:
    """How a gyroscope in the video's telemetry agrees with the measured rotation, and bridges it."""

    correlation: float
    offset_s: float  # time of the gyroscope minus time of the video
    rms_dps: float


@dataclass(eq=False)
class Motion:
    """How a clip's camera moved: columns with a row for each of n frames."""

    width: int  # of the clip
    height: int
    lens: Optional[Lens]  # of a rotation; None: the motion is homographies
    frame: NDArray[np.int64]  # (n,)
    time_s: Numbers  # (n,)
    frame_from_reference: Numbers  # (n, 3, 3): p_in_frame ~ H p_in_reference, in pixels; the identity for a rotation
    cam_from_reference_cam: Optional[Numbers]  # (n, 4): quaternions w, x, y, z; None for homographies
    inliers: NDArray[np.int64]  # (n,)
    rms_px: Numbers  # (n,): of the inliers' errors
    state: List[str]  # "reference", "measured", "bridged", "cut" or "turned_away"
    gyro: Optional[GyroAgreement]  # None without a gyroscope that agrees


def motion(
    video: Path,
    *,
    model: str = "auto",
    lens: Optional[Path] = None,
    mask: Optional[Path] = None,
    reference: str = "first_frame",
    smoothing_s: float = 1,
    frame_rate_hz: Optional[float] = None,
    cache: Union[bool, Path] = True,
    progress: Optional[Progress] = None,
) -> Motion:
    """Measures how a video's camera moved, as `airtruth motion` does.

    `model`: "rotation", on the sphere, through a known lens; "homography", of one plane; "auto": a rotation with a lens, a homography
    without. `lens`: a calibration as of Lens.from_file(). `mask`: a picture that is black where the own aircraft is.
    `reference`: "first_frame", or "smoothed": the camera's path under a window whose standard deviation is `smoothing_s`.
    `frame_rate_hz`: of numbered pictures, which state none. `cache` as in render(), whose measured motion is the same. `progress(done, total)` is called as the
    frames are measured; without it a terminal shows a line.

    airtruth.Error for a file that cannot be read and for arguments that do not fit together. Ctrl-C ends the work within 2 s.

    >>> moved = airtruth.motion("clip.mkv")
    >>> moved.state[:2], moved.frame_from_reference.shape, moved.cam_from_reference_cam
    (['reference', 'measured'], (6, 3, 3), None)
    """
    with shown("measuring", progress) as tell:
        fields = _core.motion(
            video=os.fspath(video), model=model, lens=os.fspath(lens or ""), mask=os.fspath(mask or ""), reference=reference,
            smoothing_s=smoothing_s, frame_rate_hz=frame_rate_hz, cache=cache_of(cache), progress=tell,
        )
    fields["lens"] = fields["lens"] and Lens(fields["lens"])
    fields["gyro"] = fields["gyro"] and GyroAgreement(**fields["gyro"])
    return Motion(**fields)
