# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._frames import Numbers
from ._progress import Progress, shown
from ._video import Path


@dataclass(eq=False)
class Measured:
    """One quantity of a camera file."""

    value: Union[None, float, Numbers]  # one number, or (3,): red, green, blue; None: not measured
    sigma: Union[None, float, Numbers]  # its standard error
    missing: str  # why it is not measured
    note: str  # a remark about the value
    source: str  # where it comes from, if not from these clips alone
    doubt: str  # a measurement that contradicts the value by more than the errors allow


@dataclass(eq=False)
class Calibration:
    """What a clip's camera and air do to light."""

    width: int  # of the clip
    height: int
    frame_rate_hz: float
    frames: int
    clips: int
    quantities: Dict[str, Dict[str, Measured]]  # by table and key of a camera file (docs/formats/camera.md)
    readout_direction: str  # "down" or "up"; empty where no readout is measured
    horizon_frame: NDArray[np.int64]  # (n,): the frames whose horizon was found, of one clip with a lens
    horizon_pitch_deg: Numbers  # (n,): of the camera, positive upwards
    horizon_roll_deg: Numbers  # (n,): positive with the right wing down
    no_horizon: str  # why there is none
    horizon_note: str  # a remark about them
    toml: str  # the camera file that `airtruth calibrate` writes


@dataclass
class CameraProfile:
    """A camera whose values are known."""

    name: str
    camera: str  # its description
    width: int  # of its pictures, px
    height: int
    clips: int  # that it was measured on


def calibrate(
    videos: Union[Path, Sequence[Path]],
    *,
    lens: Optional[Path] = None,
    mask: Optional[Path] = None,
    altitude_m: Optional[float] = None,
    heading_deg: float = 0,
    gamma: float = 0,
    profile: str = "",
    frame_rate_hz: Optional[float] = None,
    progress: Optional[Progress] = None,
) -> Calibration:
    """Measures what a clip's camera and air do to light, as `airtruth calibrate` does. Several clips of one camera give the values of
    the camera alone: optics, sensor and shutter.

    `lens`: a calibration as of Lens.from_file(), which sun, horizon and extinction need. `mask`: a picture that is black where the own
    aircraft is. `altitude_m`: height of the camera above the ground, for the extinction. `heading_deg`: where it looks in the first
    frame, from north, for the sun. `gamma`: exponent of the camera's tone curve, 1.2 to 3; 0: sRGB's curve. `profile`: a name of
    camera_profiles() for what the clip does not show; "none": its values alone; empty: the one that the first clip's tags and size tell, else the
    median over all. `frame_rate_hz`: of numbered pictures, which state none. `progress` as in motion().

    What the clip does not show is no error; airtruth.Error for files that cannot be read, clips of several sizes and arguments out of
    their range. Ctrl-C ends the work within 2 s.

    >>> found = airtruth.calibrate("clip.mkv")
    >>> step = found.quantities["sensor"]["codec_step"]
    >>> found.frames, step.value, step.missing
    (6, None, "the decoder of 'ffv1' does not report its quantiser")
    >>> spread = found.quantities["optics"]["point_spread_px"]
    >>> spread.value, round(spread.sigma, 2), spread.source
    (0.42, 0.22, 'of the median over 3 cameras; the clip does not show it')
    >>> pathlib.Path("camera.toml").write_text(found.toml) > 100
    True
    """
    several = [videos] if isinstance(videos, (str, bytes, os.PathLike)) else videos
    paths = [os.fspath(video) for video in several]
    with shown("measuring", progress) as tell:
        fields = _core.calibrate(
            videos=paths, lens=os.fspath(lens or ""), mask=os.fspath(mask or ""), altitude_m=altitude_m, heading_deg=heading_deg, gamma=gamma,
            profile=profile, frame_rate_hz=frame_rate_hz, progress=tell,
        )
    quantities: Dict[str, Dict[str, Measured]] = {}
    for name, quantity in fields["quantities"].items():
        table, key = name.split(".")
        quantities.setdefault(table, {})[key] = Measured(**quantity)
    fields["quantities"] = quantities
    return Calibration(**fields)


def camera_profiles() -> List[CameraProfile]:
    """The cameras that calibrate() knows.

    >>> "gopro-karma" in [profile.name for profile in airtruth.camera_profiles()]
    True
    """
    return [CameraProfile(**fields) for fields in _core.camera_profiles()]
