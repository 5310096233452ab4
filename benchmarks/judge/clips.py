# SPDX-License-Identifier: Apache-2.0
"""Clips that `airtruth compare` left, and the numbers by which a judge may tell an aircraft of theirs from another.

Both aircraft of a pair stand along one axis of every array: 0 the real one, 1 the inserted one. A picture's distance is
counted from the silhouette's outline in pixels, outwards. Nothing here depends on how large an aircraft is or where it flies.
"""

import csv
import dataclasses
import glob
import json
import os

import cv2
import numpy as np

RINGS = ((-99, -2), (-2, -1), (-1, 0), (0, 1), (1, 2), (2, 3), (3, 5))  # px from the outline, that colour is averaged over
HOG = cv2.HOGDescriptor((24, 24), (24, 24), (8, 8), (8, 8), 9)  # 3 x 3 cells, brought to one length together
BLOCK = 8  # px: as the blocks of most codecs
DCT = np.sqrt(2 / BLOCK) * np.cos(np.pi / BLOCK * np.outer(np.arange(BLOCK), np.arange(BLOCK) + 0.5))
DCT[0] /= np.sqrt(2)
DIAGONAL = np.add.outer(np.arange(BLOCK), np.arange(BLOCK))  # of a block's coefficients: 0 its mean, 14 the finest
LONGEST = "longest side, px"
EDGE = "edge, 10 to 90 %, px"


class Refused(Exception):
    """What the user gave cannot be used; said in one line."""


@dataclasses.dataclass
class Clip:
    name: str
    frames: list        # one number for both of a pair
    pictures: list      # of each pair: two RGB pictures of one size, 8-bit
    measures: dict      # name: (pairs, 2), as compare measured them; nan: none
    summary: dict       # name: what compare says of the whole clip, real and inserted
    numbers: np.ndarray = None  # (pairs, 2, numbers): what trees read


def read_clip(folder, most_pairs):
    """At most so many pairs, evenly over the clip."""
    name = os.path.basename(os.path.abspath(folder))
    files = sorted(glob.glob(os.path.join(folder, "patches", "*.png")))
    try:
        with open(os.path.join(folder, "patches.csv"), newline="", encoding="utf-8") as file:
            rows = {(int(row["frame"]), int(row["real"])): row for row in csv.DictReader(file)}
        with open(os.path.join(folder, "comparison.json"), encoding="utf-8") as file:
            summary = {one["name"]: (one["real"], one["inserted"]) for one in json.load(file)["measures"]}
    except OSError as error:
        raise Refused(f"{folder} is no comparison: {os.path.basename(error.filename)} cannot be read") from error
    except (KeyError, TypeError, ValueError) as error:
        raise Refused(f"{folder}: patches.csv or comparison.json is not as `airtruth compare` writes it: {error!r}") from error
    if len(files) < 2:
        raise Refused(f"{folder} holds fewer than two pairs; expected patches/FRAME.png of `airtruth compare`")
    if len(files) > most_pairs:
        files = [files[i * len(files) // most_pairs] for i in range(most_pairs)]
    frames, pictures, measured = [], [], []
    for path in files:
        both = cv2.imread(path)
        if both is None or both.shape[1] != 2 * both.shape[0]:
            raise Refused(f"{path} does not hold two square pictures side by side")
        both = cv2.cvtColor(both, cv2.COLOR_BGR2RGB)
        try:
            frames.append(int(os.path.splitext(os.path.basename(path))[0]))
            pair = [rows[frames[-1], real] for real in (1, 0)]
            measured.append([{key: float(one[key]) for key in one if key not in ("frame", "real")} for one in pair])
        except (KeyError, TypeError, ValueError) as error:
            raise Refused(f"{folder}: patches.csv has no such line as {os.path.basename(path)} needs: {error!r}") from error
        pictures.append((both[:, :both.shape[0]], both[:, both.shape[0]:]))
    names = [key for key in measured[0][0] if not key.startswith("centre")]
    measures = {key: np.array([[one[key] for one in pair] for pair in measured]) for key in names}
    if EDGE in measures:
        measures[EDGE][measures[EDGE] == 0] = np.nan  # nowhere clear
    return Clip(name, frames, pictures, measures, summary)


def silhouette_of(grey):
    """What differs from the rim, closed, the largest part: as compare finds it, but for a level rim."""
    rim = np.ones(grey.shape, bool)
    width = max(2, grey.shape[0] // 8)
    rim[width:-width, width:-width] = False
    level = np.median(grey[rim])
    apart = np.abs(grey - level)
    mask = (apart > max(8, 4 * 1.4826 * np.median(apart[rim]))).astype(np.uint8)
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)))
    if len(statistics) < 2:  # nothing stands out: the middle
        labels = np.zeros(grey.shape, int)
        labels[tuple(slice(n // 2 - 1, n // 2 + 2) for n in grey.shape)] = 1
        return labels == 1
    return labels == 1 + np.argmax(statistics[1:, cv2.CC_STAT_AREA])


def mean_where(values, where):
    return values[where].mean(axis=0) if where.any() else np.full(values.shape[2:], np.nan)


def numbers_of(picture):
    """By name: colour by distance from the outline, detail by frequency (DCT), and gradients (HOG)."""
    colour = cv2.cvtColor(picture, cv2.COLOR_RGB2YCrCb).astype(np.float32)
    grey = colour[..., 0]
    mask = silhouette_of(grey)
    distance = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 5) - cv2.distanceTransform(mask.astype(np.uint8), cv2.DIST_L2, 5)
    outside = distance > 3
    sky = np.median(colour[outside], axis=0) if outside.any() else np.median(colour, axis=(0, 1))
    contrast = abs(np.median(grey[mask]) - sky[0]) + 4
    numbers = {}
    for low, high in RINGS:
        ring = mean_where((colour - sky) / contrast, (distance > low) & (distance <= high))
        where = f"{low} to {high} px" if low > -99 else f"below {high} px"
        numbers.update({f"{channel} {where} from the outline": value for channel, value in zip(("Y", "Cr", "Cb"), ring)})
    windows = np.lib.stride_tricks.sliding_window_view(grey, (BLOCK, BLOCK))[::4, ::4]
    touched = np.lib.stride_tricks.sliding_window_view(mask, (BLOCK, BLOCK))[::4, ::4].any(axis=(2, 3))
    size = np.abs(DCT @ (windows[touched] if touched.any() else windows.reshape(-1, BLOCK, BLOCK)) @ DCT.T).mean(axis=0)
    for k in range(1, 2 * BLOCK - 1):
        numbers[f"DCT, diagonal {k} of 14"] = np.log((size[DIAGONAL == k].mean() + 0.05) / contrast)
    small = cv2.resize(grey, (24, 24), interpolation=cv2.INTER_AREA).astype(np.uint8)
    numbers.update({f"HOG {i}": value for i, value in enumerate(HOG.compute(small).ravel())})
    return numbers


def read_clips(folders, most_pairs):
    """The clips with their numbers, and the numbers' names."""
    clips = [read_clip(folder, most_pairs) for folder in folders]
    names = [name for name in clips[0].measures if name != LONGEST]
    for folder, clip in zip(folders, clips):
        if list(clip.measures) != list(clips[0].measures):
            raise Refused(f"{folder} has other measures than the first comparison")
        of_pictures = [[numbers_of(picture) for picture in pair] for pair in clip.pictures]
        measured = np.stack([clip.measures[name] for name in names], axis=2)
        clip.numbers = np.concatenate([measured, [[list(one.values()) for one in pair] for pair in of_pictures]], axis=2)
    return clips, names + list(of_pictures[0][0])
