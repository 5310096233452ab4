# SPDX-License-Identifier: Apache-2.0
"""The measures of detections and tracks written down once more, naively, for detection_measures_test.py.

A sequence is a list of frames (truths, answers): truths are (id, box, range or None, above: -1, 0 or 1), answers (track, box,
score). Boxes are (x, y, width, height).
"""

import itertools
import math


def overlap(a, b):
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return 1.0 if a == b else min(1.0, width * height / (a[2] * a[3] + b[2] * b[3] - width * height))


def best_pairs(scores):
    """The pairs (row, column) of the largest sum, by trying all."""
    rows, columns = len(scores), len(scores[0]) if scores else 0
    if not rows or not columns:
        return []
    if rows <= columns:
        choices = ([*enumerate(p)] for p in itertools.permutations(range(columns), rows))
    else:
        choices = ([(r, c) for c, r in enumerate(p)] for p in itertools.permutations(range(rows), columns))
    return max(choices, key=lambda pairs: sum(scores[r][c] for r, c in pairs))


# COCO, one class. Boxes alone; `regions` are crowds.
def average_precision(images, threshold, low=0.0, high=1e10, most=100):
    """images: lists of (truths, regions, [(box, score)]). Returns (AP, recall), or (None, None) without a truth."""
    results, count = [], 0
    for truths, regions, answers in images:
        area = lambda b: b[2] * b[3]
        outside = lambda b: area(b) < low or area(b) > high
        boxes = [(b, outside(b), False) for b in truths] + [(b, True, True) for b in regions]
        boxes.sort(key=lambda b: b[1])
        count += sum(not ignored for _, ignored, _ in boxes)
        taken = set()
        for box, score in sorted(answers, key=lambda a: -a[1])[:most]:
            best, found = min(threshold, 1 - 1e-10), None
            for i, (truth, ignored, crowd) in enumerate(boxes):
                if i in taken and not crowd:
                    continue
                if found is not None and not boxes[found][1] and ignored:
                    break
                alike = overlap(box, truth)
                if crowd and alike > 0:
                    width = min(box[0] + box[2], truth[0] + truth[2]) - max(box[0], truth[0])
                    height = min(box[1] + box[3], truth[1] + truth[3]) - max(box[1], truth[1])
                    alike = width * height / area(box)
                if alike >= best:
                    best, found = alike, i
            if found is not None:
                taken.add(found)
            if (boxes[found][1] if found is not None else outside(box)):
                continue
            results.append((score, found is not None))
    if not count:
        return None, None
    results.sort(key=lambda r: -r[0])
    curve, hits = [], 0
    for i, (_, hit) in enumerate(results):
        hits += hit
        curve.append((hits / count, hits / (i + 1)))
    at = lambda recall: max((p for r, p in curve if r >= recall), default=0.0)
    return math.fsum(at(k / 100) for k in range(101)) / 101, curve[-1][0] if curve else 0.0


# Amazon's AOT.
def extended_overlap(truth, answer):
    def grown(b):
        width = math.sqrt(100 * b[2] / b[3])
        height = 100 / width
        return b[0] + b[2] / 2 - width / 2, b[1] + b[3] / 2 - height / 2, width, height
    if truth[2] * truth[3] >= 100:
        return overlap(truth, answer)
    return overlap(grown(truth), grown(answer) if answer[2] * answer[3] < 100 - 1e-6 else answer)


def aot(flights, hours, score=0.0):
    images = false = in_range = found = 0
    false_tracks, rows = set(), []
    for f, frames in enumerate(flights):
        for i, (truths, answers) in enumerate(frames):
            images += 1
            answers = [a for a in answers if a[2] >= score]
            for track, box, _ in answers:
                if all(extended_overlap(t[1], box) < 0.02 for t in truths):
                    false += 1
                    false_tracks.add((f, track))
            for id, box, reach, above in truths:
                rows.append((f, id, i, reach, above, [a[0] for a in answers if extended_overlap(box, a[1]) >= 0.2]))
    encounters, before = [], None
    for row in sorted((r for r in rows if r[3] is not None and r[3] <= 700), key=lambda r: r[:3]):
        if before is None or row[0] != before[0] or not 0 <= row[2] - before[2] <= 3:
            encounters.append([])
        encounters[-1].append(row)
        before = row
    encounters = [e for e in encounters if len(e) >= 30 and min(r[3] for r in e) <= 330]
    edr = {"edr": [], "edr_below_horizon": [], "edr_mixed": [], "edr_above_horizon": []}
    for e in encounters:
        detected = False
        for last in range(29, len(e)):
            window = [t for r in e[last - 29:last + 1] for t in r[5]]
            if max((window.count(t) for t in set(window)), default=0) >= 15:
                detected = e[last][3] >= 300 or e[last][2] - e[0][2] < 30
                break
        above = sum(r[4] for r in e)
        key = "edr_above_horizon" if above == len(e) else "edr_below_horizon" if above == -len(e) else "edr_mixed"
        for k in ("edr", key):
            edr[k].append(detected)
    most = max((r[3] for e in encounters for r in e), default=None)
    for row in rows:
        if most is not None and row[3] is not None and 0 <= row[3] <= most:
            in_range += 1
            found += bool(row[5])
    return {"fppi": false / images, "hfar": len(false_tracks) / hours, "afdr": (found, in_range), "max_range_m": most,
            **{k: (sum(v), len(v)) for k, v in edr.items()}}


# Tracks.
def hota(sequences):
    """Each curve over the 19 overlaps, over all sequences."""
    steps = [0.05 + 0.05 * k for k in range(19)]
    sums = {k: [0.0] * 19 for k in ("tp", "fn", "fp", "ass_a", "ass_re", "ass_pr", "loc")}
    for frames in sequences:
        shared, truth_count, answer_count = {}, {}, {}
        for truths, answers in frames:
            s = [[overlap(t[1], a[1]) for a in answers] for t in truths]
            for t in truths:
                truth_count[t[0]] = truth_count.get(t[0], 0) + 1
            for a in answers:
                answer_count[a[0]] = answer_count.get(a[0], 0) + 1
            for i, t in enumerate(truths):
                for j, a in enumerate(answers):
                    all_ = sum(s[i]) + sum(row[j] for row in s) - s[i][j]
                    if all_ > 0:
                        shared[t[0], a[0]] = shared.get((t[0], a[0]), 0) + s[i][j] / all_
        align = {k: v / (truth_count[k[0]] + answer_count[k[1]] - v) for k, v in shared.items()}
        matches = [{} for _ in steps]
        for truths, answers in frames:
            s = [[overlap(t[1], a[1]) for a in answers] for t in truths]
            pairs = best_pairs([[align.get((t[0], a[0]), 0) * s[i][j] for j, a in enumerate(answers)] for i, t in enumerate(truths)])
            for k, step in enumerate(steps):
                good = [(i, j) for i, j in pairs if s[i][j] >= step - 1e-15]
                sums["tp"][k] += len(good)
                sums["fn"][k] += len(truths) - len(good)
                sums["fp"][k] += len(answers) - len(good)
                for i, j in good:
                    sums["loc"][k] += s[i][j]
                    key = truths[i][0], answers[j][0]
                    matches[k][key] = matches[k].get(key, 0) + 1
        for k in range(19):
            for (t, a), n in matches[k].items():
                sums["ass_a"][k] += n * n / (truth_count[t] + answer_count[a] - n)
                sums["ass_re"][k] += n * n / truth_count[t]
                sums["ass_pr"][k] += n * n / answer_count[a]
    per = lambda a, b: [x / max(1, y) for x, y in zip(a, b)]
    result = {k: per(sums[k], sums["tp"]) for k in ("ass_a", "ass_re", "ass_pr")}
    result["loc_a"] = [x / n if n else 1.0 for x, n in zip(sums["loc"], sums["tp"])]
    result["det_a"] = per(sums["tp"], [a + b + c for a, b, c in zip(sums["tp"], sums["fn"], sums["fp"])])
    result["det_re"] = per(sums["tp"], [a + b for a, b in zip(sums["tp"], sums["fn"])])
    result["det_pr"] = per(sums["tp"], [a + b for a, b in zip(sums["tp"], sums["fp"])])
    result["hota"] = [math.sqrt(a * b) for a, b in zip(result["det_a"], result["ass_a"])]
    return result


def clear(sequences):
    total = dict.fromkeys(("true_positives", "false_negatives", "false_positives", "identity_switches", "fragmentations",
                           "mostly_tracked", "partly_tracked", "mostly_lost"), 0)
    overlaps = 0.0
    for frames in sequences:
        last, before, seen, hit, pieces = {}, {}, {}, {}, {}
        for truths, answers in frames:
            for t in truths:
                seen[t[0]] = seen.get(t[0], 0) + 1
            good = []
            if truths and answers:
                scores = [[0 if overlap(t[1], a[1]) < 0.5 - 2.3e-16 else overlap(t[1], a[1]) + 1000 * (before.get(t[0]) == a[0])
                           for a in answers] for t in truths]
                good = [(i, j) for i, j in best_pairs(scores) if scores[i][j] > 0]
                now = {truths[i][0]: answers[j][0] for i, j in good}
                for t, a in now.items():
                    total["identity_switches"] += t in last and last[t] != a
                    pieces[t] = pieces.get(t, 0) + (t not in before)
                    hit[t] = hit.get(t, 0) + 1
                last.update(now)
                before = now
                overlaps += sum(overlap(truths[i][1], answers[j][1]) for i, j in good)
            total["true_positives"] += len(good)
            total["false_negatives"] += len(truths) - len(good)
            total["false_positives"] += len(answers) - len(good)
        total["fragmentations"] += sum(n - 1 for n in pieces.values())
        for t, n in seen.items():
            share = hit.get(t, 0) / n
            total["mostly_tracked" if share > 0.8 else "partly_tracked" if share >= 0.2 else "mostly_lost"] += 1
    tp, fn, fp = total["true_positives"], total["false_negatives"], total["false_positives"]
    return {**total, "mota": (tp - fp - total["identity_switches"]) / (tp + fn), "motp": overlaps / max(1, tp),
            "recall": tp / (tp + fn), "precision": tp / (tp + fp)}


def identity(sequences):
    tp = truths_all = answers_all = 0
    for frames in sequences:
        agree, truths, answers = {}, {}, {}
        for frame_truths, frame_answers in frames:
            for t in frame_truths:
                truths[t[0]] = truths.get(t[0], 0) + 1
                for a in frame_answers:
                    if overlap(t[1], a[1]) >= 0.5:
                        agree[t[0], a[0]] = agree.get((t[0], a[0]), 0) + 1
            for a in frame_answers:
                answers[a[0]] = answers.get(a[0], 0) + 1
        # Tracks that agree nowhere need no partner.
        good = sorted({a for _, a in agree})
        scores = [[agree.get((t, a), 0) for a in good] for t in sorted(truths)]
        tp += sum(scores[i][j] for i, j in best_pairs(scores))
        truths_all += sum(truths.values())
        answers_all += sum(answers.values())
    fn, fp = truths_all - tp, answers_all - tp
    return {"true_positives": tp, "false_negatives": fn, "false_positives": fp, "idf1": tp / (tp + 0.5 * fp + 0.5 * fn)}


def wilson_interval(p, n):
    z = 1.959963984540054
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return [0.0 if p == 0 else middle - half, 1.0 if p == 1 else middle + half]
