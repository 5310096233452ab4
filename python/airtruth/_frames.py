# SPDX-License-Identifier: Apache-2.0
"""Frames and their truth as plain values: they can be kept, pickled and sent to other processes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from . import _core

Numbers = NDArray[np.float64]
Samples = NDArray[np.uint8]


def rows_of(values: Numbers) -> List[Numbers]:
    """The rows of an n x m array; NumPy 2 types the elements that a loop over the array itself gives as numbers."""
    return [values[k] for k in range(len(values))]


class Volume(NamedTuple):
    """Whether an intruder violates a volume of airspace that the scene asks for."""

    name: str
    inside: bool
    to_violation_s: Optional[float]  # 0 inside; None where there is no violation within the lookahead

_FULL_FROM_LIMITED = np.clip(np.rint((np.arange(256) - 16) * (255 / 219)), 0, 255).astype(np.uint8)


@dataclass
class Encounter:
    """The measures of detect-and-avoid between the own aircraft and an intruder, if both keep their velocities
    (docs/formats/truth.md). A measure that is not defined is None.

    >>> frame = next(airtruth.render("scene.toml"))
    >>> encounter = frame.intruders[0].encounter
    >>> encounter.hmd_m <= encounter.horizontal_m
    True
    """

    horizontal_m: float  # distance over the ground
    above_m: float  # how much higher the intruder is
    closing_speed_mps: Optional[float]
    bearing_deg: Optional[float]  # from north towards east, 0 to 360
    bearing_rate_dps: Optional[float]
    relative_bearing_deg: Optional[float]  # from the own course, right positive
    line_of_sight_rate_dps: Optional[float]
    tcpa_s: Optional[float]  # time to the horizontal closest approach
    dcpa_m: Optional[float]  # horizontal distance there
    hmd_m: float  # least horizontal distance within the lookahead
    vmd_m: float  # least difference of height within the lookahead
    tau_mod_s: Optional[float]  # modified tau with a DMOD of 0.66 nmi
    tcoa_s: Optional[float]  # time to the same height
    volumes: List[Volume] = field(default_factory=list)


@dataclass(eq=False)
class Intruder:
    """The truth of one intruder in one frame, under the names of truth.jsonl (docs/formats/truth.md). What is not defined is None.

    World: north, east, down in metres. Camera: x right, y down, z forward. Boxes: arrays (x, y, width, height) in pixels of the
    frame, whose top-left corner is (0, 0). Vectors are float64 arrays.

    >>> intruder = next(airtruth.render("scene.toml")).intruders[0]
    >>> intruder.id, intruder.state
    ('a', 'visible')
    >>> bool(abs(np.linalg.norm(intruder.position_in_cam_m) - intruder.range_m) < 1e-6)
    True
    """

    id: str
    aircraft: str
    object_class: str  # "aircraft", "bird", "multirotor", "balloon", "glint", "dirt" or "insect"
    state: str  # "visible", "hidden", "outside", "behind" or "ended"
    position_ned_m: Optional[Numbers]  # (3,)
    velocity_ned_mps: Optional[Numbers]  # (3,)
    attitude_yaw_pitch_roll_deg: Optional[Numbers]  # (3,)
    position_in_cam_m: Optional[Numbers]  # (3,)
    range_m: Optional[float]
    range_rate_mps: Optional[float]  # negative while the range decreases
    azimuth_deg: Optional[float]  # in the camera as it was; right is positive
    elevation_deg: Optional[float]  # up is positive
    nominal_azimuth_deg: Optional[float]  # from the boresight of the unshaken camera
    nominal_elevation_deg: Optional[float]
    exact_box_px: Optional[Numbers]  # (4,) of the projected shape, not clipped by the frame
    covered_box_px: Optional[NDArray[np.int64]]  # (4,) of the pixels that it covers: for training and scoring
    covered_area_px: Optional[int]  # number of those pixels
    visible_box_px: Optional[NDArray[np.int64]]  # (4,) of the pixels that changed
    contrast_to_noise: Optional[float]
    visible_area_px: int
    alpha_sum_px: float
    centroid_px: Optional[Numbers]  # (2,)
    hidden_by_own_aircraft: float  # shares of its silhouette, 0 to 1
    hidden_by_occluder: Optional[float]
    hidden_by_intruder: float
    cut_by_frame: float
    encounter: Optional[Encounter] = None

    @property
    def covered_box(self) -> Optional[NDArray[np.int64]]:
        """covered_box_px: (x, y, width, height) of the pixels that the intruder covers; None where it covers none."""
        return self.covered_box_px

    @property
    def exact_box(self) -> Optional[Numbers]:
        """exact_box_px: (x, y, width, height) of the projected shape; None where projection has no answer."""
        return self.exact_box_px

    @property
    def visible_box(self) -> Optional[NDArray[np.int64]]:
        """visible_box_px: (x, y, width, height) of the pixels that changed; None where none did."""
        return self.visible_box_px


@dataclass(eq=False)
class FrameTruth:
    """The truth of one frame.

    >>> truth = next(airtruth.render("scene.toml")).truth
    >>> truth.frame, truth.time_s, truth.frame_from_reference.shape
    (0, 0.0, (3, 3))
    """

    frame: int  # from 0
    time_s: float
    damaged: bool  # the background's frame came from corrupt data
    camera_position_ned_m: Numbers  # (3,) of the nominal, unshaken camera
    camera_attitude_yaw_pitch_roll_deg: Numbers  # (3,)
    motion_state: str  # "reference", "measured", "bridged", "cut", "turned_away" or "none"
    frame_from_reference: Numbers  # (3, 3): a pixel of the nominal picture to one of the frame
    frame_from_reference_per_s: Numbers  # (3, 3)
    rotation: Optional[Numbers]  # (4,) w, x, y, z: from the nominal camera's axes to the measured one's
    rate_radps: Numbers  # (3,) in the camera's axes
    intruders: List[Intruder]  # in the order of the scene


@dataclass(eq=False)
class Frame:
    """A picture, and where it is known its truth.

    `planes` are the decoder's own, uint8: Y, Cb, Cr, or Y alone, or G, B, R; Cb and Cr of "yuv420p" have half the width and
    height. They belong to the frame, and may be written to.

    >>> frame = next(airtruth.render("scene.toml"))
    >>> frame.rgb.shape, frame.rgb.dtype.name, frame.gray.shape
    ((120, 160, 3), 'uint8', (120, 160))
    >>> [plane.shape for plane in frame.planes], frame.pixel_format
    ([(120, 160), (60, 80), (60, 80)], 'yuv420p')
    """

    index: int  # from 0
    time_s: float
    planes: Tuple[Samples, ...]
    pixel_format: str  # "gray", "yuv420p", "yuv422p", "yuv440p", "yuv444p" or "gbrp"
    matrix: str  # "bt601", "bt709", "bt2020", or "rgb" for "gbrp"
    is_full_range: bool  # False: luma 16 to 235
    damaged: bool = False
    truth: Optional[FrameTruth] = None  # in pixels of the whole frame of the video
    crop: Optional[NDArray[np.int64]] = None  # (4,): the part of that frame that the picture shows; None: all of it
    masks: Optional[Samples] = None  # (n, H, W): 255 alpha of each intruder's pixels, of a stream with masks = true
    covered_in_crop: Optional[Numbers] = None  # (n, 4), with a crop: bounds of what each intruder covers of the picture, in its pixels; NaN: nothing

    @property
    def rgb(self) -> Samples:
        """H x W x 3, uint8, sRGB; computed at each access. ValueError or airtruth.Error where the planes were replaced by others
        than the format has."""
        return _core.rgb(self.planes, self.pixel_format, self.matrix, self.is_full_range)

    @property
    def gray(self) -> Samples:
        """H x W, uint8: the plane Y as it is, without a copy; of "gbrp" the luma of BT.601, computed at each access.
        `airtruth detect` sends it to a program that asks for gray."""
        if self.pixel_format != "gbrp":
            return self.planes[0]
        green, blue, red = (plane.astype(np.uint32) for plane in self.planes)
        luma: Samples = ((9798 * red + 19235 * green + 3735 * blue + 16384) >> 15).astype(np.uint8)  # OpenCV's integers
        return luma

    @property
    def full_range_gray(self) -> Samples:
        """H x W, uint8: `gray` in the full range of 0 to 255: what `airtruth detect` shows a network of grey
        pictures. Computed at each access."""
        if self.is_full_range:
            return self.gray.copy()
        full: Samples = _FULL_FROM_LIMITED[self.gray]
        return full

    @property
    def intruders(self) -> List[Intruder]:
        """Those of the truth; empty where no truth is known."""
        return self.truth.intruders if self.truth else []

    def boxes(self, kind: str = "covered") -> Numbers:
        """The boxes of the intruders in pixels of this picture, n x 4, of the kind "covered", "exact" or "visible". A row is NaN where
        an intruder has no such box. With a crop, the covered ones bound what the crop shows, and the others are cut at its edges.
        ValueError for another kind.

        >>> frame = airtruth.DataSet("set")["across"].frame(3)
        >>> frame.boxes()
        array([[43., 57., 31., 10.]])
        """
        if kind not in ("covered", "exact", "visible"):
            raise ValueError(f"kind is {kind!r}; expected 'covered', 'exact' or 'visible'")
        if kind == "covered" and self.covered_in_crop is not None:
            return self.covered_in_crop.copy()
        found = [getattr(intruder, kind + "_box_px") for intruder in self.intruders]
        rows = np.array([[np.nan] * 4 if box is None else box for box in found], dtype=float).reshape(-1, 4)
        return rows if self.crop is None else _core.in_crop(rows, self.crop)

    def _repr_html_(self) -> str:
        """The picture for a notebook, with the covered boxes, else the exact ones."""
        from ._show import html_of_frame

        return html_of_frame(self)


def truth_of(fields: Dict[str, Any]) -> FrameTruth:
    intruders = []
    for one in fields.pop("intruders"):
        encounter = one.pop("encounter")
        if encounter is not None:
            volumes = [Volume(*volume) for volume in encounter.pop("volumes")]
            encounter = Encounter(**encounter, volumes=volumes)
        intruders.append(Intruder(**one, encounter=encounter))
    return FrameTruth(**fields, intruders=intruders)
