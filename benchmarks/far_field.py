#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does measured motion follow what is far? far_field.py VIDEO [--lens CALIBRATION] [--strips OUT.png --frames 612 648]

The motion is that of airtruth.motion(): a rotation through the lens, or homographies without one. The answer to compare with is
independent of it: the sky and a strip of ground under the skyline are registered as a whole,
from frame to frame, by OpenCV's findTransformECC (Evangelidis and Psarakis 2008), forth and back; frames where the two differ
by more than 0.2 px are left out. At three places 25 px over the skyline, where an intruder would be, the table tells how far
the measured motion takes a point from where the far field goes. --strips draws twelve frames from each of the given ones on,
cut out around a cross that is carried by the measured motion alone: beside it the far field should stand still.
Needs the package airtruth (./dev python), python3-opencv and numpy.
"""

import argparse

import airtruth
import cv2
import numpy as np

STRIP_PX = 36  # under the skyline; at 500 px of focal length 4 degrees: ground from 14 heights on
OVER_PX = (20, 30)  # over the skyline, of the places that are looked at
MOST_LOOP_PX = 0.2  # between registration forth and back


def sky_and_far(picture):
    """Masks of the sky and of what is far; sky is what is bright in blue."""
    blue = cv2.GaussianBlur(picture, (0, 0), 3)[..., 0]
    level, _ = cv2.threshold(blue, 0, 255, cv2.THRESH_OTSU)
    mask = (blue > level).astype(np.uint8)
    for part in (1, 0):  # the largest part of the sky, then of the ground: an aircraft is neither
        count, labels, stats, _ = cv2.connectedComponentsWithStats((mask == part).astype(np.uint8))
        if count < 2:
            return None
        largest = (labels == 1 + np.argmax(stats[1:, 4])).astype(np.uint8)
        mask = largest if part == 1 else 1 - largest
    return mask, cv2.dilate(mask, np.ones((2 * STRIP_PX + 1,) * 2, np.uint8))


def places(sky):
    """Three places over the skyline, away from the picture's rim."""
    height, width = sky.shape
    distance = cv2.distanceTransform(sky, cv2.DIST_L2, 5)
    y, x = np.where((distance > OVER_PX[0]) & (distance < OVER_PX[1]))
    inside = (x > 0.14 * width) & (x < 0.86 * width) & (y > 0.14 * height) & (y < 0.86 * height)
    points = np.stack([x, y], 1)[inside].astype(float)
    if len(points) < 50:
        return []
    along = points @ np.linalg.svd(points - points.mean(0), full_matrices=False)[2][0]
    order = np.argsort(along)
    return [points[order[int(len(order) * share)]] for share in (0.15, 0.5, 0.85)]


def apply(h, point):
    q = h @ np.array([point[0], point[1], 1.0])
    return q[:2] / q[2]


def registered(start, end, far_in_end, guess):
    try:
        correlation, h = cv2.findTransformECC(start, end, guess.astype(np.float32), cv2.MOTION_HOMOGRAPHY,
                                              (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 40, 1e-5), far_in_end, 1)
    except cv2.error:
        return None
    return h if correlation > 0.9 else None


def far_steps(before, after):
    """Where the far field takes the places of one frame to the next: [(place, step)]."""
    found = [sky_and_far(before), sky_and_far(after)]
    if None in found:
        return []
    grey = [cv2.cvtColor(p, cv2.COLOR_BGR2GRAY) for p in (before, after)]
    soft = [cv2.GaussianBlur(g, (0, 0), 1.2).astype(np.float32) for g in grey]
    corners = cv2.goodFeaturesToTrack(grey[0], 300, 0.002, 6, mask=found[0][1])
    if corners is None:
        return []
    moved, good, _ = cv2.calcOpticalFlowPyrLK(grey[0], grey[1], corners, None, winSize=(21, 21), maxLevel=4)
    good = good[:, 0] == 1
    guess = cv2.estimateAffinePartial2D(corners[good], moved[good], ransacReprojThreshold=2)[0] if good.sum() > 8 else None
    if guess is None:
        return []
    guess = np.vstack([guess, [0, 0, 1]])
    forth = registered(soft[0], soft[1], found[1][1], guess)
    back = registered(soft[1], soft[0], found[0][1], np.linalg.inv(guess))
    if forth is None or back is None:
        return []
    steps = [(p, apply(forth, p) - p) for p in places(found[0][0])]
    return [(p, d) for p, d in steps if np.hypot(*(apply(back, p + d) - p)) < MOST_LOOP_PX]


class Carrier:
    """Carries OpenCV's pixels, whose centres are at whole numbers, from frame to frame by the measured motion."""

    def __init__(self, motion):
        self.lens = motion.lens
        self.known = [state in ("reference", "measured") for state in motion.state]
        self.homographies = motion.frame_from_reference
        self.turns = None if motion.lens is None else [matrix_of(q) for q in motion.cam_from_reference_cam]

    def knows(self, *frames):
        return all(0 <= frame < len(self.known) and self.known[frame] for frame in frames)

    def __call__(self, start, end, point):
        at = np.array(point, float) + 0.5
        if self.turns is None:
            return apply(self.homographies[end] @ np.linalg.inv(self.homographies[start]), at) - 0.5
        ray = self.turns[end] @ self.turns[start].T @ self.lens.ray_from_pixel([at])[0]
        return self.lens.pixel_from_cam([ray])[0] - 0.5


def matrix_of(quaternion):
    w, x, y, z = quaternion
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def pictures(video):
    source = cv2.VideoCapture(video)
    while True:
        more, picture = source.read()
        if not more:
            return
        yield picture


def strips(arguments, carry):
    """Twelve frames in a row from each first frame, cut out 96 x 96 around a carried cross, at twice the size."""
    cut, wanted = 48, {first + i: first for first in arguments.frames for i in range(12)}
    rows, start = {}, {}
    for k, picture in enumerate(pictures(arguments.video)):
        first = wanted.get(k)
        if first is None:
            continue
        if k == first:
            found = sky_and_far(picture)
            middle = places(found[0])[1] if found and places(found[0]) else np.array([picture.shape[1] / 2, picture.shape[0] / 2])
            start[first] = middle
        at = carry(first, k, start[first]) if carry.knows(first, k) else start[first]
        tile = cv2.getRectSubPix(picture, (2 * cut, 2 * cut), (float(at[0]), float(at[1])))
        tile = cv2.resize(tile, None, fx=1.5, fy=1.5, interpolation=cv2.INTER_CUBIC)
        cv2.drawMarker(tile, (tile.shape[1] // 2,) * 2, (0, 0, 255), cv2.MARKER_CROSS, 9, 1)
        rows.setdefault(first, []).append(tile)
    cv2.imwrite(arguments.strips, np.vstack([np.hstack(tiles) for tiles in rows.values()]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("video")
    parser.add_argument("--lens", help="a calibration file; for rotations")
    parser.add_argument("--every", type=int, default=120, help="frames in a line of the table")
    parser.add_argument("--strips", help="draw this picture instead")
    parser.add_argument("--frames", type=int, nargs="*", default=[], help="first frames of the strips")
    arguments = parser.parse_args()
    carry = Carrier(airtruth.motion(arguments.video, lens=arguments.lens))
    if arguments.strips:
        strips(arguments, carry)
        return
    errors, unknown, before = {}, 0, None
    for k, picture in enumerate(pictures(arguments.video)):
        steps = far_steps(before, picture) if before is not None else []
        if not carry.knows(k - 1, k):
            unknown += len(steps)
            steps = []
        for place, step in steps:
            errors.setdefault(k, []).append(np.hypot(*(carry(k - 1, k, place) - place - step)))
        before = picture
    print("| frames | places | median, px | rms, px | 90 % below, px |\n|---|---:|---:|---:|---:|")
    last = max(errors, default=0)
    for low, high in [(0, last + 1)] + [(a, a + arguments.every) for a in range(0, last + 1, arguments.every)]:
        e = np.array([value for k, values in errors.items() if low <= k < high for value in values])
        if len(e):
            print(f"| {low} to {high - 1} | {len(e)} | {np.median(e):.2f} | {np.sqrt((e ** 2).mean()):.2f} | {np.percentile(e, 90):.2f} |")
    print(f"\n{unknown} places where the motion is not known")


if __name__ == "__main__":
    main()
