# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
import os
from typing import Any, Sequence, Tuple

from numpy.typing import ArrayLike

from . import _core
from ._frames import Numbers
from ._video import Path


class Lens:
    """The map from points in the camera frame (x right, y down, z forward; metres) to pixels, and from pixels to rays. Pixel (0, 0)
    is the top-left corner of the image; the centre of the first pixel is (0.5, 0.5).

    A lens is made by one of its functions below, or comes with a rendering or a sequence; it does not change.

    >>> lens = airtruth.Lens.pinhole((1662.8, 1662.8), (960, 540), 1920, 1080)
    >>> lens.pixel_from_cam([[0, 0, 500], [10, 0, 500], [0, 0, -500]]).round(1)
    array([[960. , 540. ],
           [993.3, 540. ],
           [  nan,   nan]])
    """

    def __init__(self, core: _core.Lens) -> None:
        if not isinstance(core, _core.Lens):
            raise TypeError("a Lens is made by Lens.pinhole() and the like")
        self._core = core

    @classmethod
    def pinhole(cls, focal_px: Sequence[float], principal_point_px: Sequence[float], width: int, height: int) -> Lens:
        """u = fx x/z + cx, v = fy y/z + cy. airtruth.Error for a focal length that is not positive and finite, as in all of these.

        >>> airtruth.Lens.pinhole((500, 500), (320, 240), 640, 480).model
        'pinhole'
        """
        return cls(_core.Lens.pinhole(focal_px, principal_point_px, width, height))

    @classmethod
    def pinhole_from_vertical_fov(cls, vertical_fov_deg: float, width: int, height: int) -> Lens:
        """Square pixels, and the axis through the centre of the image; 0 < field of view < 180 degrees.

        >>> airtruth.Lens.pinhole_from_vertical_fov(90, 640, 480).focal_px.round(6)
        array([240., 240.])
        """
        return cls(_core.Lens.pinhole_from_vertical_fov(vertical_fov_deg, width, height))

    @classmethod
    def brown_conrady(
        cls, focal_px: Sequence[float], principal_point_px: Sequence[float], distortion: Sequence[float], width: int, height: int
    ) -> Lens:
        """The model of Brown and Conrady, with 4, 5 or 8 coefficients in OpenCV's order: k1 k2 p1 p2 [k3 [k4 k5 k6]].

        >>> airtruth.Lens.brown_conrady((500, 500), (320, 240), [-0.2, 0.03, 0, 0], 640, 480).distortion
        array([-0.2 ,  0.03,  0.  ,  0.  ])
        """
        return cls(_core.Lens.brown_conrady(focal_px, principal_point_px, distortion, width, height))

    @classmethod
    def fisheye(
        cls,
        focal_px: Sequence[float],
        principal_point_px: Sequence[float],
        distortion: Sequence[float],
        width: int,
        height: int,
        max_angle_rad: float = math.pi,
    ) -> Lens:
        """The model of Kannala and Brandt, as OpenCV's fisheye module has it, with at most 4 coefficients. It is valid up to
        `max_angle_rad` from the axis, or to where its curve stops rising.

        >>> airtruth.Lens.fisheye((300, 300), (320, 240), [], 640, 480).pixel_from_cam([[1, 0, 0]]).round(1)
        array([[791.2, 240. ]])
        """
        return cls(_core.Lens.fisheye(focal_px, principal_point_px, distortion, width, height, max_angle_rad))

    @classmethod
    def from_file(cls, calibration: Path, width: int, height: int) -> Lens:
        """A calibration file (docs/lenses.md), scaled to an image of that size. airtruth.Error with file and line.

        >>> airtruth.Lens.from_file("calibration.yml", 640, 480).model
        'brown_conrady'
        """
        return cls(_core.Lens.from_file(os.fspath(calibration), width, height))

    def pixel_from_cam(self, points: ArrayLike) -> Numbers:
        """The pixels that show points: n x 3 in metres to n x 2. A row is NaN where the model has no image of the point (behind a
        pinhole, beyond the valid field, at the origin). Pixels may lie outside the image. TypeError and ValueError for other
        shapes and dtypes.

        >>> lens = airtruth.Lens.pinhole_from_vertical_fov(90, 640, 480)
        >>> lens.pixel_from_cam(np.array([[0, 0, 1], [1, 1, 1]], dtype=np.float32)).round(6)
        array([[320., 240.],
               [560., 480.]])
        """
        return self._core.pixel_from_cam(points)

    def ray_from_pixel(self, pixels: ArrayLike) -> Numbers:
        """The rays of pixels: n x 2 to n x 3, unit vectors in the camera frame. A row is NaN where no direction of the valid field
        reaches the pixel. Inverts pixel_from_cam() within 1e-9 rad.

        >>> airtruth.Lens.pinhole_from_vertical_fov(90, 640, 480).ray_from_pixel([[320, 240]])
        array([[0., 0., 1.]])
        """
        return self._core.ray_from_pixel(pixels)

    @property
    def width(self) -> int:
        """Width of the image, px."""
        return self._core.width

    @property
    def height(self) -> int:
        """Height of the image, px."""
        return self._core.height

    @property
    def model(self) -> str:
        """One of "pinhole", "brown_conrady" or "fisheye"."""
        return self._core.model

    @property
    def focal_px(self) -> Numbers:
        """(2,): fx, fy."""
        return self._core.focal_px

    @property
    def principal_point_px(self) -> Numbers:
        """(2,): cx, cy."""
        return self._core.principal_point_px

    @property
    def distortion(self) -> Numbers:
        """The coefficients; empty for a pinhole."""
        return self._core.distortion

    @property
    def max_angle_rad(self) -> float:
        """The largest angle from the axis for which the model is valid."""
        return self._core.max_angle_rad

    @property
    def horizontal_fov_deg(self) -> float:
        """The full field of view through the principal point."""
        return self._core.horizontal_fov_deg

    @property
    def vertical_fov_deg(self) -> float:
        """The full field of view through the principal point."""
        return self._core.vertical_fov_deg

    def __reduce__(self) -> Tuple[Any, ...]:
        distortion = [] if self.model == "pinhole" else [self.distortion.tolist()]
        limit = [self.max_angle_rad] if self.model == "fisheye" else []
        arguments = (self.focal_px.tolist(), self.principal_point_px.tolist(), *distortion, self.width, self.height, *limit)
        return getattr(Lens, self.model), arguments

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Lens) and self.__reduce__() == other.__reduce__()

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        return f"<airtruth.Lens {self.model} {self.width}x{self.height}>"
