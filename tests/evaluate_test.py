# SPDX-License-Identifier: Apache-2.0
"""`airtruth evaluate` against the same measures written down once more in Python: python3 evaluate_test.py AIRTRUTH

Random truths with gaps and random results with gaps, exact hits, boxes over the edge and lines of nan, scored by both;
every number must agree to 1e-9. Then what is wrong with results must be said in one line, with exit code 2.
"""

import json
import math
import os
import random
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 640, 480


def overlap(a, b):
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return width * height / (a[2] * a[3] + b[2] * b[3] - width * height)


def within(box):
    x0, x1 = (min(max(v, 0), WIDTH) for v in (box[0], box[0] + box[2]))
    y0, y1 = (min(max(v, 0), HEIGHT) for v in (box[1], box[1] + box[3]))
    return x0, y0, x1 - x0, y1 - y0


def mean(values):
    return math.fsum(values) / len(values)


def reference(truth, answers, seconds):
    """The numbers of one sequence: lists of boxes or None, and of times."""
    shown = [i for i, box in enumerate(truth) if box]
    ious, distances, relatives, dx, dy = [], [], [], [], []
    for i in shown:
        answer = truth[0] if i == 0 else answers[i]
        last = next((answers[k] for k in range(i, -1, -1) if answers[k]), None)
        centre = lambda b: (b[0] + b[2] / 2, b[1] + b[3] / 2)
        tx, ty = centre(truth[i])
        if answer:
            ax, ay = centre(answer)
            ious.append(overlap(truth[i], answer))
            distances.append(math.hypot(ax - tx, ay - ty))
            relatives.append(math.hypot((ax - tx) / truth[i][2], (ay - ty) / truth[i][3]))
        else:
            ious.append(0.0)
            distances.append(math.inf)
            relatives.append(math.inf)
        if i > 0 and last:
            lx, ly = centre(last)
            dx.append(lx - tx)
            dy.append(ly - ty)
    success = [mean([iou > 0.05 * k for iou in ious]) for k in range(21)]
    precision = [mean([d <= k for d in distances]) for k in range(51)]
    normalised = [mean([d <= 0.01 * k for d in relatives]) for k in range(51)]
    got = [overlap(within(truth[i]), within(answers[i])) if answers[i] else 0.0 for i in shown if i > 0]
    rms = lambda values: math.sqrt(mean([v * v for v in values]))
    return {
        "frames": len(truth), "frames_with_target": len(shown), "success": success, "precision": precision,
        "normalised_precision": normalised, "auc": mean(success), "precision_20px": precision[20],
        "normalised_auc": mean(normalised), "average_overlap": mean(got), "success_50": mean([v > 0.5 for v in got]),
        "success_75": mean([v > 0.75 for v in got]), "centre_mean_px": mean([math.hypot(*p) for p in zip(dx, dy)]),
        "x_mean_px": mean([abs(v) for v in dx]), "x_rmse_px": rms(dx), "x_most_px": max(map(abs, dx)),
        "y_mean_px": mean([abs(v) for v in dy]), "y_rmse_px": rms(dy), "y_most_px": max(map(abs, dy)),
        "frames_per_second": mean([1 / s for s in seconds[1:]]),
    }


def overall(sequences):
    result = {"frames": sum(s["frames"] for s in sequences),
              "frames_with_target": sum(s["frames_with_target"] for s in sequences)}
    for key, value in sequences[0].items():
        if key in result:
            continue
        if isinstance(value, list):
            result[key] = [mean([s[key][k] for s in sequences]) for k in range(len(value))]
        elif key in ("average_overlap", "success_50", "success_75"):
            weights = [s["frames_with_target"] - 1 for s in sequences]
            result[key] = sum(w * s[key] for w, s in zip(weights, sequences)) / sum(weights)
        else:
            result[key] = mean([s[key] for s in sequences])
    return result


def differences(got, wanted, where):
    for key, value in wanted.items():
        for k, (a, b) in enumerate(zip(got[key], value) if isinstance(value, list) else [(got[key], value)]):
            if abs(a - b) > 1e-9 * max(1, abs(b)):
                yield f"{where} {key}[{k}]: {a} against {b}"


def drawn(rng):
    """A random sequence: truth and answers, with everything that goes wrong in them."""
    box = lambda: (rng.uniform(-4, 600), rng.uniform(-4, 440), rng.uniform(5, 80), rng.uniform(5, 60))
    truth, answers = [], []
    for i in range(rng.randint(12, 60)):
        t = box() if i == 0 or rng.random() < 0.8 else None
        near = t or box()
        kind = rng.random()
        if kind < 0.15:
            a = near
        elif kind < 0.8:
            a = tuple(v + rng.gauss(0, 6) for v in near[:2]) + tuple(max(1.0, v * rng.uniform(0.7, 1.4)) for v in near[2:])
        else:
            a = None if kind < 0.9 else box()
        truth.append(t)
        answers.append(a)
    truth[-1] = truth[-1] or box()
    answers[0] = answers[0] or truth[0]
    return truth, answers, [rng.uniform(0.001, 0.2) for _ in truth]


def lines(boxes, empty):
    return "".join(",".join(map(repr, b)) + "\n" if b else empty for b in boxes)


def write(folder, name, text):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def main():
    airtruth = os.path.abspath(sys.argv[1])
    run = lambda *command: subprocess.run([airtruth, *command], capture_output=True, text=True)
    with tempfile.TemporaryDirectory(prefix="airtruth_evaluate_") as root:
        checked = 0
        for seed in range(12):
            rng = random.Random(seed)
            place = os.path.join(root, str(seed))
            sequences = {f"s{k}": drawn(rng) for k in range(4)}
            for name, (truth, answers, seconds) in sequences.items():
                rows = "".join(f"{i},{','.join(map(repr, b))}\n" for i, b in enumerate(truth) if b)
                write(place + "/csv", name + ".csv", "frame,x,y,w,h\n" + rows)
                write(place + "/results/mine", name + ".txt", lines(answers, "nan,nan,nan,nan\n"))
                write(place + "/results/mine", name + "_time.txt", "".join(f"{s!r}\n" for s in seconds))
            for command in (["dataset", "import", place + "/csv", "-f", "csv", "--size", f"{WIDTH}x{HEIGHT}", "-o", place + "/set"],
                            ["evaluate", place + "/set", place + "/results/mine", "-o", place + "/evaluation"]):
                done = run(*command)
                if done.returncode != 0:
                    sys.exit(f"evaluate_test: {' '.join(command)}: {done.stderr}")
            with open(place + "/evaluation/evaluation.json", encoding="utf-8") as file:
                found = json.load(file)["trackers"][0]
            wanted = {name: reference(*sequence) for name, sequence in sequences.items()}
            off = [d for s in found["sequences"] for d in differences(s, wanted[s["name"]], s["name"])]
            off += differences(found["overall"], overall([wanted[n] for n in sorted(wanted)]), "overall")
            if len(found["sequences"]) != 4 or off:
                sys.exit("evaluate_test: seed %d\n  %s" % (seed, "\n  ".join(off[:10])))
            checked += 5
        place = os.path.join(root, "0")
        truth = drawn(random.Random(0))[0]
        for name, text, expected in (
                ("s0.txt", "1,2,3,4\n", "has 1 lines; s0 has"),
                ("s0.txt", "1,2,3,4\n" * (len(truth) + 1), f"has {len(truth) + 1} lines"),
                ("s0.txt", "1,2,3\n" * len(truth), ":1: has 3 numbers"),
                ("s0.txt", "1,2,x,4\n" * len(truth), ":1:5: 'x' is not a number"),
                ("other.txt", "1,2,3,4\n", "holds no result for any sequence")):
            bad = os.path.join(root, "bad")
            os.makedirs(bad, exist_ok=True)
            for old in os.listdir(bad):
                os.remove(os.path.join(bad, old))
            write(bad, name, text)
            done = run("evaluate", place + "/set", bad, "-o", root + "/never")
            if done.returncode != 2 or expected not in done.stderr or os.path.exists(root + "/never"):
                sys.exit(f"evaluate_test: {name}: {done.returncode}, {done.stderr!r}; expected {expected!r}")
        print(f"{checked} scores agree to 1e-9; 5 kinds of bad results are refused")


if __name__ == "__main__":
    main()
