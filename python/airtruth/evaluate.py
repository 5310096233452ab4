# SPDX-License-Identifier: Apache-2.0
"""The measures of `airtruth evaluate`, computed from arrays: a tracker's boxes (OTB, GOT-10k, VOT), a detector's boxes (COCO's average
precision, FROC, HOTA, AOT), and the uncertainty of means over sequences.

Boxes are n x 4: x, y, width, height in pixels, with fractions; a row with a NaN is no box. Whatever is not defined is None. A wrong
dtype is a TypeError; a wrong shape, an infinite number and a negative size are a ValueError.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._frames import Numbers

Interval = Tuple[float, float]
Size = Tuple[int, int]


@dataclass(eq=False)
class Score:
    """The measures of one sequence, or means over sequences. Curves are float64 arrays."""

    frames: int  # of the sequence
    counted: int  # of these, the frames that show the target
    x_mean_px: Optional[float]  # the E-Vision paper's errors of the box's centre
    x_rmse_px: Optional[float]
    x_most_px: Optional[float]
    y_mean_px: Optional[float]
    y_rmse_px: Optional[float]
    y_most_px: Optional[float]
    centre_mean_px: Optional[float]
    success: Numbers  # (21,): OTB, at overlaps above 0, 0.05 .. 1
    precision: Numbers  # (51,): OTB, at centre errors of at most 0, 1 .. 50 px
    auc: Optional[float]
    precision_20px: Optional[float]
    normalised: Numbers  # (51,): at centre errors over the truth's size of at most 0, 0.01 .. 0.5
    normalised_auc: Optional[float]
    average_overlap: Optional[float]  # GOT-10k
    success_50: Optional[float]
    success_75: Optional[float]
    frames_per_second: Optional[float]
    frames_per_second_median: Optional[float]
    counted_after_first: int  # frames after the first that show the target: those of GOT-10k's measures


@dataclass(eq=False)
class Curve:
    """A curve of precision over recall."""

    precision: Numbers  # (101,): at the recalls 0, 0.01 .. 1
    score: Numbers  # (101,): of the detection that reaches the recall; 0 where none does
    average_precision: float
    recall: float  # the largest
    truths: int  # that count


@dataclass(eq=False)
class AveragePrecision:
    """The numbers that COCO prints, and those by the distance of centres."""

    ap: Optional[float]  # mean over the overlaps 0.50, 0.55 .. 0.95
    ap_50: Optional[float]
    ap_75: Optional[float]
    ap_small: Optional[float]  # below 32 x 32 px
    ap_medium: Optional[float]
    ap_large: Optional[float]  # above 96 x 96 px
    ar_1: Optional[float]  # mean recall with at most 1, 10, 100 detections an image
    ar_10: Optional[float]
    ar_100: Optional[float]
    ar_small: Optional[float]
    ar_medium: Optional[float]
    ar_large: Optional[float]
    ap_centre: Optional[float]
    ap_50_interval: Optional[Interval]  # 95 %, by the bootstrap over sequences
    ap_centre_interval: Optional[Interval]
    curve_50: Optional[Curve]
    curve_centre: Optional[Curve]


@dataclass(eq=False)
class Froc:
    """The free-response operating characteristic: columns with a row for each of n thresholds, by falling score."""

    score: Numbers  # (n,): detections with this score or more
    detection: Optional[Numbers]  # (n,): share of aircraft in images that are found; None without any
    detection_low: Optional[Numbers]  # (n,): its 95 % interval, over sequences
    detection_high: Optional[Numbers]
    false_alarms_per_image: Numbers  # (n,)
    false_alarms_per_hour: Optional[Numbers]  # None without a rate
    false_alarms_per_flight: Numbers  # (n,): a flight is a sequence
    images: int
    flights: int
    hours: Optional[float]
    aircraft: int  # aircraft in images


@dataclass(eq=False)
class Hota:
    """Higher order tracking accuracy and its parts, each the mean over 19 thresholds of overlap."""

    hota: float
    det_a: float  # detection accuracy, and its recall and precision
    ass_a: float  # association accuracy, and its recall and precision
    det_re: float
    det_pr: float
    ass_re: float
    ass_pr: float
    loc_a: float  # overlap of what matches
    at_overlaps: Dict[str, Numbers]  # each of them at the overlaps 0.05, 0.10 .. 0.95: (19,)


Rate = Tuple[int, int, Optional[float]]


@dataclass
class AotScore:
    """The measures of the Airborne Object Tracking challenge. A rate is (detected, of, share); of 0 the share is None."""

    score: float  # detections with this score or more
    edr: Rate  # encounters that a track detects
    edr_below_horizon: Rate
    edr_mixed: Rate
    edr_above_horizon: Rate
    edr_by_frames: Rate  # encounters that detections of any tracks detect
    afdr: Rate  # objects in range that are detected, frame by frame
    max_range_m: Optional[float]  # up to which they are in range; None without a valid encounter
    hfar: Optional[float]  # false tracks an hour; None without a rate
    fppi: Optional[float]  # false detections an image; None without one


@dataclass
class Paired:
    """The comparison of two trackers on the same sequences."""

    difference: Optional[float]  # mean of a - b; None without a sequence
    interval: Optional[Interval]  # 95 %
    p_value: float  # two-sided, under random signs
    wins: int  # of a
    losses: int
    ties: int


@dataclass(eq=False)
class Restart:
    """VOT's measures of a tracker that is restarted after each failure; without a run they are None."""

    accuracy: Optional[float]
    failures: Optional[float]  # mean number of a run
    reliability: Optional[float]  # exp(-30 failures / length)
    eao: Optional[float]
    eao_curve: Numbers


@dataclass(eq=False)
class MultiStart:
    """VOT's measures of a tracker that starts at many frames; without a run they are None."""

    accuracy: Optional[float]
    robustness: Optional[float]
    eao: Optional[float]
    eao_curve: Numbers


def overlap(a: ArrayLike, b: ArrayLike) -> Numbers:
    """Intersection over union, 0 to 1, of the boxes in the same rows: n x 4 and n x 4 to n; 0 where one is no box.

    >>> airtruth.evaluate.overlap([[100, 100, 20, 10]], [[105, 100, 20, 10]])
    array([0.6])
    """
    return _core.overlap(a, b)


def score(truth: ArrayLike, answers: ArrayLike, *, seconds: Optional[ArrayLike] = None, size: Optional[Size] = None) -> Score:
    """Scores a tracker's boxes in the frames of one sequence, in order: n x 4 and n x 4. `seconds`: n times that the answers took.
    `size`: width and height of the picture; without it no box is clipped.

    >>> result = airtruth.evaluate.score([[0, 0, 20, 10], [100, 100, 20, 10]], [[0, 0, 20, 10], [105, 100, 20, 10]])
    >>> result.average_overlap, result.x_mean_px, result.success_75
    (0.6, 5.0, 0.0)
    """
    return Score(**_core.score(truth, answers, seconds, size))


def mean_of(scores: Iterable[Score]) -> Score:
    """Means over the sequences that have the measure: plain means (OTB), and GOT-10k's over the frames of all together.

    >>> one = airtruth.evaluate.score([[0, 0, 9, 9]] * 3, [[0, 0, 9, 9]] * 3)
    >>> airtruth.evaluate.mean_of([one, one]).frames
    6
    """
    all_scores = list(scores)
    for one in all_scores:
        if not isinstance(one, Score):
            raise TypeError(f"scores holds one of the type {type(one).__name__}; expected a Score")
    return Score(**_core.mean_of(all_scores))


def first_loss(truth: ArrayLike, answers: ArrayLike) -> Optional[int]:
    """The frame at which a tracker has lost its target: the first of 10 consecutive frames with the target whose overlap is at most
    0.1; fewer where the sequence ends within them. None where it never has.

    >>> airtruth.evaluate.first_loss([[0, 0, 9, 9]] * 20, [[0, 0, 9, 9]] * 4 + [[50, 50, 9, 9]] * 16)
    4
    """
    return _core.first_loss(truth, answers)


def _flags(boxes: Sequence[ArrayLike], flags: Optional[Sequence[ArrayLike]], otherwise: float = 0) -> Sequence[ArrayLike]:
    """For each image a number for each box: as they are given, or all the same."""
    return [np.full(len(np.asarray(one)), otherwise) for one in boxes] if flags is None else flags


def _by_sequence(
    truth: Sequence[ArrayLike],
    sequences: Optional[Sequence[int]],
    ignored: Optional[Sequence[ArrayLike]],
    regions: Optional[Sequence[ArrayLike]],
    **more: Sequence[ArrayLike],
) -> List[List[Tuple[ArrayLike, ...]]]:
    """The images of each sequence, each with its truth, what is ignored, its regions, and what more there is for it."""
    nowhere: Sequence[ArrayLike] = [np.zeros((0, 4))] * len(truth)
    columns = {"truth": truth, "ignored": _flags(truth, ignored), "regions": nowhere if regions is None else regions, **more}
    count = len(truth)
    numbers = [0] * count if sequences is None else [int(number) for number in sequences]
    for name, length in [*((name, len(column)) for name, column in columns.items()), ("sequences", len(numbers))]:
        if length != count:
            raise ValueError(f"truth is of {count} images, and {name} of {length}")
    grouped: Dict[int, List[Tuple[ArrayLike, ...]]] = {}
    for number, image in zip(numbers, zip(*columns.values())):
        grouped.setdefault(number, []).append(image)
    return list(grouped.values())


def average_precision(
    truth: Sequence[ArrayLike],
    detections: Sequence[ArrayLike],
    scores: Sequence[ArrayLike],
    *,
    sequences: Optional[Sequence[int]] = None,
    ignored: Optional[Sequence[ArrayLike]] = None,
    regions: Optional[Sequence[ArrayLike]] = None,
    centre_px: float = 10,
) -> AveragePrecision:
    """Average precision by COCO's rules. Each argument has an item for each image: boxes of its aircraft (n x 4), boxes of its
    detections (m x 4), their scores (m).

    `sequences`: a number for each image, equal for those of one sequence; intervals need two sequences. `ignored`: for each image n
    flags; a truth that is flagged counts neither way, and is taken by one detection. `regions`: for each image boxes (k x 4) in which
    any number of detections count neither way; `airtruth evaluate` has aircraft without a box of the labels' kind, and what ignore.csv
    lists, as regions. `centre_px`: with ap_centre, a detection may lie that far from its aircraft, or half of the aircraft's longer side.

    >>> boxes = [[10, 10, 20, 10], [100, 50, 20, 10], [300, 300, 20, 10]]
    >>> ap = airtruth.evaluate.average_precision([boxes[:2]], [[boxes[0], boxes[2], boxes[1]]], [[0.9, 0.8, 0.7]])
    >>> round(ap.ap_50, 4), ap.ap_large, ap.curve_50.truths
    (0.835, None, 2)
    """
    grouped = _by_sequence(truth, sequences, ignored, regions, detections=detections, scores=scores)
    fields = _core.average_precision(grouped, centre_px)
    for name in ("curve_50", "curve_centre"):
        fields[name] = fields[name] and Curve(**fields[name])
    return AveragePrecision(**fields)


def froc(
    truth: Sequence[ArrayLike],
    detections: Sequence[ArrayLike],
    scores: Sequence[ArrayLike],
    *,
    sequences: Optional[Sequence[int]] = None,
    ignored: Optional[Sequence[ArrayLike]] = None,
    regions: Optional[Sequence[ArrayLike]] = None,
    rate_hz: Optional[float] = None,
    centre_px: float = 10,
) -> Froc:
    """The free-response operating characteristic: probability of detection against false alarms, as the threshold on the score falls.
    The arguments are those of average_precision(); a detection finds the nearest aircraft within `centre_px` or half of the aircraft's
    longer side. One on a flagged aircraft alone, or with its centre in a region, is no false alarm. `rate_hz`: images a second; without it nothing is told of an hour.

    >>> boxes = [[10, 10, 20, 10], [100, 50, 20, 10], [300, 300, 20, 10]]
    >>> curve = airtruth.evaluate.froc([boxes[:2]], [[boxes[0], boxes[2], boxes[1]]], [[0.9, 0.8, 0.7]], rate_hz=10)
    >>> curve.score, curve.detection, curve.false_alarms_per_hour.round()
    (array([0.9, 0.8, 0.7]), array([0.5, 0.5, 1. ]), array([    0., 36000., 36000.]))
    """
    grouped = _by_sequence(truth, sequences, ignored, regions, detections=detections, scores=scores)
    return Froc(**_core.froc(grouped, rate_hz, centre_px))


def hota(
    truth: Sequence[ArrayLike],
    truth_tracks: Sequence[ArrayLike],
    detections: Sequence[ArrayLike],
    tracks: Sequence[ArrayLike],
    *,
    sequences: Optional[Sequence[int]] = None,
    ignored: Optional[Sequence[ArrayLike]] = None,
    regions: Optional[Sequence[ArrayLike]] = None,
    centre_px: float = 10,
) -> Hota:
    """Higher order tracking accuracy. Each argument has an item for each image, in the order of time: boxes of its aircraft (n x 4), the
    numbers of their tracks (n), boxes of its detections (m x 4), the numbers of their tracks (m; NaN: none, left out). A track is in an
    image once at most. `sequences` as in average_precision(). `ignored`, `regions` and `centre_px` as in froc(): flagged aircraft, and
    detections that froc() counts neither way, are left out.

    >>> box = [[10, 10, 20, 10]]
    >>> result = airtruth.evaluate.hota([box] * 4, [[1]] * 4, [box] * 4, [[7], [7], [7], [8]])
    >>> result.det_a, result.ass_a, round(result.hota, 4), result.at_overlaps["hota"].shape
    (1.0, 0.625, 0.7906, (19,))
    """
    grouped = _by_sequence(truth, sequences, ignored, regions, truth_tracks=truth_tracks, detections=detections, tracks=tracks)
    return Hota(**_core.hota(grouped, centre_px))


def _flights(
    truth: Sequence[ArrayLike],
    truth_tracks: Sequence[ArrayLike],
    detections: Sequence[ArrayLike],
    scores: Sequence[ArrayLike],
    tracks: Optional[Sequence[ArrayLike]],
    ranges_m: Optional[Sequence[ArrayLike]],
    above_horizon: Optional[Sequence[ArrayLike]],
    sequences: Optional[Sequence[int]],
    ignored: Optional[Sequence[ArrayLike]],
    regions: Optional[Sequence[ArrayLike]],
) -> List[List[Tuple[ArrayLike, ...]]]:
    return _by_sequence(
        truth, sequences, ignored, regions, truth_tracks=truth_tracks, ranges_m=_flags(truth, ranges_m, np.nan),
        above_horizon=_flags(truth, above_horizon), detections=detections, scores=scores, tracks=_flags(detections, tracks, np.nan),
    )


def aot(
    truth: Sequence[ArrayLike],
    truth_tracks: Sequence[ArrayLike],
    detections: Sequence[ArrayLike],
    scores: Sequence[ArrayLike],
    *,
    tracks: Optional[Sequence[ArrayLike]] = None,
    ranges_m: Optional[Sequence[ArrayLike]] = None,
    above_horizon: Optional[Sequence[ArrayLike]] = None,
    sequences: Optional[Sequence[int]] = None,
    ignored: Optional[Sequence[ArrayLike]] = None,
    regions: Optional[Sequence[ArrayLike]] = None,
    centre_px: float = 10,
    rate_hz: Optional[float] = None,
    min_score: Optional[float] = None,
    min_track_frames: int = 0,
) -> AotScore:
    """The measures of Amazon's Airborne Object Tracking challenge. Each argument has an item for each image, in the order of time: boxes
    of its objects (n x 4), the numbers of their tracks (n), boxes of its detections (m x 4), their scores (m), the numbers of their
    tracks (m; NaN: a track of its own), the objects' ranges (n; NaN: unknown), and where they are (n; -1 below the horizon, 0 on it, 1
    above). `sequences` as in average_precision(): a sequence is a flight. `rate_hz`: images a second, for the false alarms an hour.
    `min_score`: detections with this score or more (all). `min_track_frames`: detections of tracks with fewer frames so far do not count.
    `ignored`, `regions` and `centre_px` as in hota().

    >>> box, frames = [[10, 10, 20, 10]], 40
    >>> seen = airtruth.evaluate.aot([box] * frames, [[1]] * frames, [box] * frames, [[0.5]] * frames, tracks=[[7]] * frames,
    ...                              ranges_m=[[310.0]] * frames, rate_hz=10)
    >>> seen.edr, seen.afdr, seen.hfar
    ((1, 1, 1.0), (40, 40, 1.0), 0.0)
    """
    flights = _flights(truth, truth_tracks, detections, scores, tracks, ranges_m, above_horizon, sequences, ignored, regions)
    return AotScore(**_core.aot(flights, rate_hz, centre_px, min_score, min_track_frames))


def aot_ranks(
    truth: Sequence[ArrayLike],
    truth_tracks: Sequence[ArrayLike],
    detections: Sequence[ArrayLike],
    scores: Sequence[ArrayLike],
    *,
    tracks: Optional[Sequence[ArrayLike]] = None,
    ranges_m: Optional[Sequence[ArrayLike]] = None,
    above_horizon: Optional[Sequence[ArrayLike]] = None,
    sequences: Optional[Sequence[int]] = None,
    ignored: Optional[Sequence[ArrayLike]] = None,
    regions: Optional[Sequence[ArrayLike]] = None,
    centre_px: float = 10,
    rate_hz: Optional[float] = None,
) -> Tuple[Optional[AotScore], Optional[AotScore]]:
    """The challenge's two ranks: aot() at the least score with at most 0.5 false tracks an hour, and with at most 0.0005 false detections
    an image. None where no score does it.

    >>> box = [[10, 10, 20, 10]]
    >>> by_hfar, by_fppi = airtruth.evaluate.aot_ranks([box] * 2, [[1]] * 2, [box] * 2, [[0.5], [0.7]])
    >>> by_hfar, by_fppi.score
    (None, 0.5)
    """
    flights = _flights(truth, truth_tracks, detections, scores, tracks, ranges_m, above_horizon, sequences, ignored, regions)
    found = _core.aot_ranks(flights, rate_hz, centre_px)
    by_hfar, by_fppi = (None if fields is None else AotScore(**fields) for fields in found)
    return by_hfar, by_fppi


def bootstrap_mean(values: ArrayLike, weights: Optional[ArrayLike] = None) -> Optional[Interval]:
    """The 95 % interval (low, high) of the weighted mean of values, one for each sequence, by 10,000 draws of the percentile bootstrap
    from a fixed seed. None for fewer than two values.

    >>> low, high = airtruth.evaluate.bootstrap_mean([0.4, 0.5, 0.6, 0.7])
    >>> low < 0.55 < high
    True
    """
    return _core.bootstrap_mean(values, weights)


def paired(a: ArrayLike, b: ArrayLike) -> Paired:
    """Compares two trackers by their values in the same n sequences.

    >>> result = airtruth.evaluate.paired([0.5, 0.6, 0.7], [0.4, 0.5, 0.7])
    >>> result.wins, result.losses, result.ties
    (2, 0, 1)
    """
    return Paired(**_core.paired(a, b))


def kendall_tau(a: ArrayLike, b: ArrayLike) -> Optional[float]:
    """Agreement of two rankings of n things, -1 to 1 (tau-b); None where one of them is of ties alone.

    >>> airtruth.evaluate.kendall_tau([1, 2, 3], [10, 20, 30])
    1.0
    """
    return _core.kendall_tau(a, b)


def restart_score(sequences: Iterable[Tuple[ArrayLike, Optional[Size], Sequence[Tuple[ArrayLike, ArrayLike]]]], eao_range: Tuple[int, int]) -> Restart:
    """VOT's measures of 2013 to 2019. A sequence is (truth n x 4, size or None, runs), a run (boxes n x 4, marks n) with the marks of
    VOT's files: 1 begun, 2 failed, 0 unknown; 3 for an answer. EAO is the mean of the curve over the range.

    >>> truth = [[10 + k, 10, 20, 10] for k in range(30)]
    >>> run = truth, [1] + [3] * 29
    >>> airtruth.evaluate.restart_score([(truth, (160, 120), [run])], (5, 20)).accuracy
    1.0
    """
    return Restart(**_core.restart_score([(t, s, list(runs)) for t, s, runs in sequences], eao_range))


def multistart_score(
    sequences: Iterable[Tuple[ArrayLike, Optional[Size], Sequence[Tuple[int, bool, ArrayLike, ArrayLike]]]], eao_range: Tuple[int, int]
) -> MultiStart:
    """VOT's measures since 2020. A sequence is (truth n x 4, size or None, runs), a run (anchor, is_backward, boxes, marks): from the
    frame `anchor` to the sequence's end or, backward, to its beginning; boxes and marks as in restart_score().

    >>> truth = [[10 + k, 10, 20, 10] for k in range(30)]
    >>> run = 0, False, truth, [1] + [3] * 29
    >>> airtruth.evaluate.multistart_score([(truth, (160, 120), [run])], (5, 20)).robustness
    1.0
    """
    return MultiStart(**_core.multistart_score([(t, s, list(runs)) for t, s, runs in sequences], eao_range))


def anchors_of(truth: ArrayLike, step: int) -> List[Tuple[int, bool]]:
    """The starting frames of VOT since 2020, (frame, is_backward): one every `step` frames, moved to the next with the target.

    >>> airtruth.evaluate.anchors_of([[10, 10, 20, 10]] * 100, 50)
    [(0, False), (99, True)]
    """
    return _core.anchors_of(truth, step)


def eao_range(lengths: Sequence[int]) -> Tuple[int, int]:
    """The range of lengths over which VOT averages EAO for sequences of these lengths, in frames.

    >>> low, high = airtruth.evaluate.eao_range([100, 200, 300])
    >>> 100 <= low < high <= 300
    True
    """
    return _core.eao_range(lengths)
