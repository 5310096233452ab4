# SPDX-License-Identifier: Apache-2.0
"""Sheets for people: real and inserted aircraft in random order, which is which in another file, and what answers are worth."""

import csv

import cv2
import numpy as np
from scipy.special import betaincinv

TIMES = 6
SMALL, LARGE = 64, 60   # px of a picture that are shown at 1x and at 6x, at most, from its middle
GAP, HEADING = 12, 26   # px
PAPER, INK = (40, 40, 40), (255, 255, 255)
SIDES = ("left", "right")


def middle(picture, side):
    side = min(side, picture.shape[0])
    begin = (picture.shape[0] - side) // 2
    return picture[begin:begin + side, begin:begin + side]


def row_of(number, pair):
    """Both aircraft at 1x and 6x under their number."""
    width = 2 * (SMALL + TIMES * LARGE + 2 * GAP) + 2 * GAP
    row = np.full((HEADING + TIMES * LARGE + GAP, width, 3), PAPER, np.uint8)
    for i, picture in enumerate(pair):
        x = GAP + i * (width // 2)
        cv2.putText(row, f"{number} {SIDES[i]}", (x, HEADING - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.5, INK, 1, cv2.LINE_AA)
        for size, times in ((SMALL, 1), (LARGE, TIMES)):
            shown = np.repeat(np.repeat(middle(picture, size), times, axis=0), times, axis=1)
            row[HEADING:HEADING + len(shown), x:x + len(shown)] = shown
            x += size * times + GAP
    return row


def make_sheet(clips, each, seed):
    """The picture (RGB), and the key: number, side of the real aircraft, clip and frame. So many pairs of each clip."""
    dice = np.random.default_rng(seed)
    chosen = [(clip, i) for clip in clips for i in dice.choice(len(clip.frames), min(each, len(clip.frames)), replace=False)]
    rows, key = [], []
    for number, k in enumerate(dice.permutation(len(chosen)), 1):
        clip, i = chosen[k]
        side = int(dice.integers(2))
        rows.append(row_of(number, clip.pictures[i][::-1] if side else clip.pictures[i]))
        key.append((number, SIDES[side], clip.name, clip.frames[i]))
    if len(rows) > 1:  # two columns
        rows += [np.full_like(rows[0], PAPER)] * (len(rows) % 2)
        rows = [np.concatenate(rows[i:i + 2], axis=1) for i in range(0, len(rows), 2)]
    return np.concatenate(rows), key


def read_answers(path, refused):
    """Which side is said to be the real one, by number; of an answer sheet or of a key, which have a first line "pair,real..."."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError) as error:
        raise refused(f"{path} cannot be read: {getattr(error, 'strerror', None) or 'it is no text'}") from error
    answers = {}
    for line, row in enumerate(rows, 1):
        if line == 1 and row[:2] == ["pair", "real"]:
            continue
        if len(row) < 2 or row[1].strip() not in SIDES or row[0].strip() in answers:
            raise refused(f"{path}: '{','.join(row)[:60]}' is no answer; expected each pair once, as 3,left or 3,right")
        answers[row[0].strip()] = row[1].strip()
    return answers


def score(answers_path, key_path, refused):
    """Right, total, and the binomial 95 % interval of the share (Clopper and Pearson 1934)."""
    answers, key = read_answers(answers_path, refused), read_answers(key_path, refused)
    if not key or set(answers) != set(key):
        other = sorted(set(answers) ^ set(key))
        raise refused(f"{answers_path} does not answer the pairs of {key_path}; found only in one of them: {', '.join(other[:8])}")
    right = sum(answers[number] == key[number] for number in key)
    wrong = len(key) - right
    low = betaincinv(right, wrong + 1, 0.025) if right else 0
    high = betaincinv(right + 1, wrong, 0.975) if wrong else 1
    return right, len(key), low, high
