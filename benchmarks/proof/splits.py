# SPDX-License-Identifier: Apache-2.0
"""Which clips of a set are trained on, looked at, and held back. Split once, by name, before anything was measured."""

import dataclasses
import zlib

from sets import Refused


def numbered(kind, *numbers):
    return tuple(f"V_{kind}_{number:03}" for number in numbers)


@dataclasses.dataclass
class Split:
    train: tuple        # real clips with aircraft that a training may learn from
    backgrounds: tuple  # without an aircraft: negatives of every training, and what composites are made over
    looked_at: tuple
    held_back: tuple


SPLITS = {
    "ground-real": Split(
        numbered("AIRPLANE", 1, 2, 3, 6, 9, 13, 18, 35) + numbered("HELICOPTER", 1, 2, 3),
        numbered("BIRD", 1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12) + numbered("DRONE", 1, 3, 5, 7, 9, 11, 13),
        numbered("AIRPLANE", 4, 8, 15, 49) + numbered("HELICOPTER", 4, 5, 6) + numbered("BIRD", *range(13, 20)) + numbered("DRONE", *range(15, 30, 2)),
        numbered("AIRPLANE", 5, 7, 10, 11, 12, 14, 16, 17) + numbered("HELICOPTER", 7, 8, 9, 10, 11) + numbered("BIRD", *range(20, 31))
        + numbered("DRONE", *range(31, 50, 2))),
}
HELD_BACK_OF = 2  # of a set without a split nothing is trained on, and one clip in so many is held back


def split_of(real):
    """The split of a set by its clips; names that the folder lacks are left out."""
    here = [clip.name for clip in real.clips]
    if real.name in SPLITS:
        split = SPLITS[real.name]
        return Split(*(tuple(name for name in names if name in here) for names in dataclasses.astuple(split)))
    held_back = tuple(name for name in here if zlib.crc32(name.encode()) % HELD_BACK_OF == 0)
    return Split((), (), tuple(name for name in here if name not in held_back), held_back)


def tested(real, held_back, names):
    """The clips to measure on. `names`: of those held back these alone (of sets that have them)."""
    split = split_of(real)
    chosen = split.held_back if held_back else split.looked_at
    if held_back and names:
        trained = [name for name in names if name in split.train + split.backgrounds + split.looked_at]
        if trained:
            raise Refused(f"{', '.join(trained)} of {real.name} is trained on or looked at, and cannot be held back")
        chosen = tuple(name for name in chosen if name in names)
    return [clip for clip in real.clips if clip.name in chosen]
