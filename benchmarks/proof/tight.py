# SPDX-License-Identifier: Apache-2.0
"""Boxes of the aircraft themselves from boxes that are two to three times as large, as ground-real's own labels are.

The rim of such a loose box shows what is behind the aircraft. The aircraft is the largest part that differs from the rim.
"""

import cv2
import numpy as np

RIM_PX = 2
LEAST_LEVELS = 8     # grey levels by which the aircraft differs from the rim's median
LEAST_SPREADS = 4    # the same in spreads of the rim's own levels
MADS_OF_SIGMA = 1.4826
JOINED_PX = 3        # side of the square that closes gaps between parts
NEIGHBOUR_FRAMES = 7  # before and after a frame, with whose median size that of its box is compared
MOST_JUMP = 1.5      # of a side, against that median


def tight_box(grey, loose):
    """x, y, width, height of the aircraft in a loose box. None where nothing stands out, and where the part that does reaches the loose box's
    edge: the loose box then does not hold all of it."""
    left, top = (max(0, int(round(v))) for v in loose[:2])
    right, bottom = (int(round(v)) for v in loose[:2] + loose[2:])
    part = grey[top:bottom, left:right].astype(np.float32)
    if min(part.shape) <= 2 * RIM_PX:
        return None
    rim = np.ones(part.shape, bool)
    rim[RIM_PX:-RIM_PX, RIM_PX:-RIM_PX] = False
    level = np.median(part[rim])
    spread = MADS_OF_SIGMA * np.median(np.abs(part[rim] - level))
    differs = (np.abs(part - level) > max(LEAST_LEVELS, LEAST_SPREADS * spread)).astype(np.uint8)
    closed = cv2.morphologyEx(differs, cv2.MORPH_CLOSE, np.ones((JOINED_PX, JOINED_PX), np.uint8))
    parts = cv2.connectedComponentsWithStats(closed, connectivity=8)[2][1:]  # the first is what does not differ
    if not len(parts):
        return None
    x, y, width, height, _ = parts[parts[:, cv2.CC_STAT_AREA].argmax()]
    if x == 0 or y == 0 or x + width == part.shape[1] or y + height == part.shape[0]:
        return None
    return np.array([left + x, top + y, width, height], float)


def steady(boxes):
    """The boxes {frame: box} without those whose size jumps against their neighbours."""
    kept = {}
    for frame, box in boxes.items():
        around = [boxes[k][2:] for k in range(frame - NEIGHBOUR_FRAMES, frame + NEIGHBOUR_FRAMES + 1) if k in boxes]
        usual = np.median(around, axis=0)
        if (np.maximum(box[2:] / usual, usual / box[2:]) <= MOST_JUMP).all():
            kept[frame] = box
    return kept


def tight_boxes(loose, greys):
    """{frame: [tight box, or None, for each of its loose boxes]} from {frame: [loose boxes]} and the frames' pictures, in order."""
    found = {}  # by place among a frame's boxes
    for (frame, boxes), grey in zip(sorted(loose.items()), greys):
        for place, box in enumerate(boxes):
            if (tight := tight_box(grey, box)) is not None:
                found.setdefault(place, {})[frame] = tight
    kept = {place: steady(boxes) for place, boxes in found.items()}
    return {frame: [kept.get(place, {}).get(frame) for place in range(len(boxes))] for frame, boxes in loose.items()}
