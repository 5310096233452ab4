# SPDX-License-Identifier: Apache-2.0
"""How well trainings find the real aircraft of clips: by kind, size, horizon and camera, with intervals over clips and ratios between trainings.

A row asks for one kind of one set. Its images are those of the clips that show the kind and of those that show nothing to be found (birds,
multirotors). `ignoring`: a detection on a bird or multirotor counts neither way; else it is a false alarm.
"""

import dataclasses
import math

import airtruth
import numpy as np

import splits
from sets import Refused
from trainings import frames_tested

MARGIN_PX = 12   # around a box that counts neither way: such boxes are loose
CENTRE_PX = 10   # airtruth.evaluate's default: how far a detection may lie from its aircraft, or half the aircraft's longer side
FALSE_ALARMS = (0.1, 1)  # an image
SIZES = ((0, 10), (10, 20), (20, 40), (40, math.inf))  # px of the longer side
LARGE_PX = 40    # of a false alarm
RATIOS = (("composites", "real"), ("matte", "real"), ("mixed", "real"), ("composites", "matte"), ("composites", "cut-and-paste"),
          ("matte", "cut-and-paste"))
SEED = 1         # of the bootstrap


@dataclasses.dataclass
class Image:
    set: str
    known: bool      # whether its camera is that of the real clips and backgrounds that were trained on
    clip: str
    index: int       # among the clip's frames tested
    objects: list    # to be found
    others: list
    ignored: np.ndarray

    def boxes(self):
        return boxes_of(self.objects)


def boxes_of(objects):
    return np.array([one.box for one in objects], float).reshape(-1, 4)


def images_of(reals, arguments):
    cameras = {real.name: real.source.camera if real.source.camera != "its own" else real.name for real in reals}
    images = []
    for real in reals:
        for clip in splits.tested(real, arguments.held_back is not None, arguments.held_back):
            for index, frame in enumerate(frames_tested(clip, arguments.every)):
                targets = [one for one in frame.objects if one.kind in real.source.targets]
                others = [one for one in frame.objects if one.kind not in real.source.targets]
                images.append(Image(real.name, cameras[real.name] == cameras[arguments.train_on], clip.name, index, targets, others, frame.ignored))
    return images


def on(boxes, centres):
    """Whether each centre lies in one of the boxes, grown by the margin."""
    boxes = np.asarray(boxes, float).reshape(-1, 4)
    inside = (centres[:, None] >= boxes[:, :2] - MARGIN_PX) & (centres[:, None] <= boxes[:, :2] + boxes[:, 2:] + MARGIN_PX)
    return inside.all(axis=2).any(axis=1)


def near(boxes, centres):
    """Whether each centre is close enough to one of the boxes to find it."""
    reach = np.maximum(CENTRE_PX, boxes[:, 2:].max(axis=1, initial=0) / 2)
    return (np.linalg.norm(centres[:, None] - (boxes[:, :2] + boxes[:, 2:] / 2), axis=2) <= reach).any(axis=1)


def counted(image, detections, ignoring):
    """The detections that count, right or wrong."""
    boxes, scores = detections
    centres = boxes[:, :2] + boxes[:, 2:] / 2
    regions = np.concatenate([image.ignored.reshape(-1, 4), boxes_of(image.others) if ignoring else np.zeros((0, 4))])
    keep = ~on(regions, centres) | near(image.boxes(), centres)
    return boxes[keep], scores[keep]


class Row:
    """One question: its images, and the flags of the truths that are not asked for."""

    def __init__(self, images, name, kind, ignoring, part, asked):
        of_set = [image for image in images if image.set == name]
        shows = {image.clip for image in of_set if any(one.kind == kind for one in image.objects)}
        others = {image.clip for image in of_set if image.objects} - shows
        self.images = [image for image in of_set if image.clip not in others]
        self.truth = [image.boxes() for image in self.images]
        self.flags = [np.array([not (one.kind == kind and asked(one)) for one in image.objects], float) for image in self.images]
        self.count = int(sum((flags == 0).sum() for flags in self.flags))
        self.key = {"set": name, "camera": "known" if self.images and self.images[0].known else "unknown", "kind": kind, "ignoring": ignoring,
                    "part": part, "aircraft": self.count, "images": len(self.images), "clips": len(shows), "clips_without": 0}
        self.strata = [sorted(shows), sorted({image.clip for image in self.images} - shows)]
        self.key["clips_without"] = len(self.strata[1])
        self.of_clip = {}
        for place, image in enumerate(self.images):
            self.of_clip.setdefault(image.clip, []).append(place)

    def scores_of(self, found, places):
        """AP by centre and recall at each rate of false alarms, on images of those places."""
        truth, flags = ([part[k] for k in places] for part in (self.truth, self.flags))
        boxes, scores = ([found[k][j] for k in places] for j in (0, 1))
        ap = airtruth.evaluate.average_precision(truth, boxes, scores, ignored=flags, centre_px=CENTRE_PX).ap_centre
        curve = airtruth.evaluate.froc(truth, boxes, scores, ignored=flags, centre_px=CENTRE_PX)
        recalls = [np.nan if curve.detection is None else float(curve.detection[curve.false_alarms_per_image <= rate].max(initial=0))
                   for rate in FALSE_ALARMS]
        return np.array([np.nan if ap is None else ap, *recalls])

    def drawn(self, dice):
        """Places of a draw of clips, with replacement: those that show the kind and those that do not, each by themselves."""
        return [place for clips in self.strata if clips for k in dice.integers(len(clips), size=len(clips)) for place in self.of_clip[clips[k]]]


def rows_of(images, targets):
    """All the questions that the images can answer."""
    rows = []
    for name in dict.fromkeys(image.set for image in images):
        of_set = [image for image in images if image.set == name]
        has_others = any(image.others for image in of_set)
        kinds = [kind for kind in targets[name] if any(one.kind == kind for image in of_set for one in image.objects)]
        for kind in kinds:
            for ignoring in (False, True) if has_others else (False,):
                rows.append(Row(images, name, kind, ignoring, "all", lambda one: True))
            for low, high in SIZES:
                words = f"{low} to {high} px" if high < math.inf else f"over {low} px"
                rows.append(Row(images, name, kind, has_others, words, lambda one, low=low, high=high: low < max(one.box[2:]) <= high))
            for above, words in ((True, "above the horizon"), (False, "below the horizon")):
                rows.append(Row(images, name, kind, has_others, words, lambda one, above=above: one.above_horizon is above))
    return [row for row in rows if row.count]


def interval(values):
    values = values[~np.isnan(values)]
    return [float(v) for v in np.percentile(values, (2.5, 97.5))] if len(values) > 1 else None


def answers_to(row, found, arguments):
    """{training: (seeds, images) of counted detections}"""
    return {name: [[counted(image, of_seed[image.set, image.clip][image.index], row.key["ignoring"]) for image in row.images] for of_seed in seeds]
            for name, seeds in found.items()}


def measured_row(row, found, arguments):
    answers = answers_to(row, found, arguments)
    places = range(len(row.images))
    by_seed = {name: np.array([row.scores_of(one, places) for one in seeds]) for name, seeds in answers.items()}
    dice = np.random.default_rng(SEED)
    draws = {name: [] for name in answers}
    # A single clip has no spread over clips, and parts are told without.
    for _ in range(arguments.draws if len(row.strata[0]) > 1 and row.key["part"] == "all" else 0):
        chosen = row.drawn(dice)
        for name, seeds in answers.items():  # the same clips for all trainings: ratios are paired
            draws[name].append(np.mean([row.scores_of(one, chosen) for one in seeds], axis=0))
    result = {**row.key, "trainings": {}, "ratios": {}}
    for name, values in by_seed.items():
        drawn = np.array(draws[name]).reshape(-1, 1 + len(FALSE_ALARMS))
        result["trainings"][name] = {key: {"value": float(values[:, k].mean()), "interval": interval(drawn[:, k]), "seeds": values[:, k].tolist()}
                                     for k, key in enumerate(("ap", *(f"recall_{rate:g}" for rate in FALSE_ALARMS)))}
    for a, b in RATIOS:
        if a in by_seed and b in by_seed:
            top, bottom = by_seed[a][:, 0].mean(), by_seed[b][:, 0].mean()
            drawn = np.array([u[0] / v[0] if v[0] > 0 else np.nan for u, v in zip(draws[a], draws[b])])
            result["ratios"][f"{a}/{b}"] = {"value": float(top / bottom) if bottom > 0 else None, "interval": interval(drawn)}
    return result


def score_at(row, one, rate):
    """The least score at which so many false alarms an image come out."""
    boxes, scores = zip(*one)
    curve = airtruth.evaluate.froc(row.truth, boxes, scores, ignored=row.flags, centre_px=CENTRE_PX)
    allowed = curve.score[curve.false_alarms_per_image <= rate]
    return float(allowed.min()) if len(allowed) else math.inf


def errors_at(row, one, rate):
    """(misses, false alarms) at that rate: (image, object) and (image, box, what is there)."""
    least = score_at(row, one, rate)
    misses, alarms = [], []
    for image, flags, (boxes, scores) in zip(row.images, row.flags, one):
        boxes = boxes[scores >= least]
        centres = boxes[:, :2] + boxes[:, 2:] / 2
        truths = image.boxes()
        misses += [(image, thing) for thing, box, flag in zip(image.objects, truths, flags) if not flag and not near(box[None], centres).any()]
        for box, centre in zip(boxes[~near(truths, centres)], centres[~near(truths, centres)]):
            what = next((thing.kind for thing in image.others if on(thing.box, centre[None])[0]), "background")
            alarms.append((image, box, what))
    return misses, alarms


def alarms_of(row, found, arguments):
    """What false alarms are, by training, of the first seed, at the highest of the rates."""
    kinds = {}
    for name, seeds in answers_to(row, found, arguments).items():
        misses, alarms = errors_at(row, seeds[0], max(FALSE_ALARMS))
        by = {}
        for _, _, what in alarms:
            by[what] = by.get(what, 0) + 1
        kinds[name] = {"misses": len(misses), "false_alarms": len(alarms), "by": by, "large": int(sum(max(box[2:]) > LARGE_PX for _, box, _ in alarms))}
    return kinds


def measured(images, found, reals, arguments):
    """All of it, as JSON."""
    rows = rows_of(images, {real.name: real.source.targets for real in reals})
    if not rows:
        splits_words = "held back" if arguments.held_back is not None else "looked at"
        raise Refused(f"no clip that is {splits_words} shows anything to be found")
    result = {"seeds": arguments.seeds, "draws": arguments.draws, "rows": [measured_row(row, found, arguments) for row in rows]}
    result["errors"] = [{**row.key, "trainings": alarms_of(row, found, arguments)} for row in rows if row.key["part"] == "all"]
    return result
