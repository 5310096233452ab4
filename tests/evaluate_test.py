# SPDX-License-Identifier: Apache-2.0
"""`airtruth evaluate` against the same measures written down once more in Python: python3 evaluate_test.py AIRTRUTH

Random truths with gaps and random results with gaps, exact hits, boxes over the edge and lines of nan, scored by both;
every number must agree to 1e-9. Then what is wrong with results must be said in one line, with exit code 2.
"""

import json
import math
import os
import random
import statistics
import subprocess
import sys
import tempfile

WIDTH, HEIGHT = 640, 480


def overlap(a, b):
    width = min(a[0] + a[2], b[0] + b[2]) - max(a[0], b[0])
    height = min(a[1] + a[3], b[1] + b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    return 1.0 if a == b else min(1.0, width * height / (a[2] * a[3] + b[2] * b[3] - width * height))


def within(box):
    """As GOT-10k's toolkit bounds boxes, whose first pixel is 1."""
    x, y = (min(max(v + 1, 0), size) for v, size in zip(box, (WIDTH, HEIGHT)))
    return x, y, min(box[2], WIDTH - x), min(box[3], HEIGHT - y)


def mean(values):
    return math.fsum(values) / len(values)


def reference(truth, answers, seconds):
    """The numbers of one sequence: lists of boxes or None, and of times."""
    shown = [i for i, box in enumerate(truth) if box]
    ious, distances, relatives, dx, dy = [], [], [], [], []
    for i in shown:
        answer = truth[0] if i == 0 else answers[i]
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
        if i > 0 and answers[i]:
            dx.append(ax - tx)
            dy.append(ay - ty)
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
        "frames_per_second_median": statistics.median([1 / s for s in seconds[1:]]),
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


# VOT, as its toolkit does it: boxes as sets of whole pixels; a mark or nan is an empty region, and two of these are equal.
def pixel_overlap(answer, truth):
    answer = None if isinstance(answer, int) else answer
    if not answer or not truth:
        return 0.0 if answer or truth else 1.0
    a, b = ([round(v) for v in box] for box in (answer, truth))
    low = [min(a[k], b[k]) for k in (0, 1)]
    high = [max(a[k] + a[k + 2] - 1, b[k] + b[k + 2] - 1) for k in (0, 1)]
    if low[0] >= high[0] or low[1] >= high[1]:
        return 1.0
    low, high = [max(0, v) for v in low], [min(size - 1, v) for size, v in zip((WIDTH, HEIGHT), high)]
    if low[0] >= high[0] or low[1] >= high[1]:
        return 0.0
    pixels = lambda box: {(x, y) for x in range(max(low[0], box[0]), min(high[0], box[0] + box[2] - 1) + 1)
                          for y in range(max(low[1], box[1]), min(high[1], box[1] + box[3] - 1) + 1)}
    a, b = pixels(a), pixels(b)
    return len(a & b) / len(a | b) if a | b else 0.0


def restart_reference(sequences, low, high):
    """sequences: lists of (truth, runs); a run holds 0, 1, 2 or a box (or None) for each frame."""
    accuracy = failures = weight = 0.0
    fragments = []
    for truth, runs in sequences:
        mean_accuracy = mean_failures = 0.0
        for run in runs:
            overlaps = [pixel_overlap(e, t) for e, t in zip(run, truth)]
            starts = [i for i, e in enumerate(run) if e == 1]
            fails = [i for i, e in enumerate(run) if e == 2]
            skipped = {j for i in starts for j in range(i, i + 10)} | set(fails) | {i for i, e in enumerate(run) if e == 0 or e is None}
            kept = [overlaps[i] for i in range(len(run)) if i not in skipped]
            mean_accuracy += (mean(kept) if kept else 0.0) / len(runs)
            mean_failures += len(fails) / len(runs)
            for k, start in enumerate(starts):
                ended = k < len(fails)
                fragments.append((overlaps[start:fails[k]] if ended else overlaps[start:], ended))
        accuracy += mean_accuracy * len(truth)
        failures += mean_failures * len(truth)
        weight += len(truth)
    longest = max(len(o) for o, _ in fragments)
    curve = []
    for j in range(longest):
        active = [(o + [0.0] * longest if ended else o) for o, ended in fragments if ended or j < len(o)]
        curve.append(mean([mean(o[1:j + 1]) if j else o[0] for o in active]))
    part = curve[low:high + 1]
    length = weight / len(sequences)
    return {"accuracy": accuracy / weight, "failures": failures / weight,
            "reliability": math.exp(-30 * failures / weight / length), "eao_curve": curve, **({"eao": mean(part)} if part else {})}


def multistart_reference(sequences, low, high):
    """sequences: lists of (truth, {(anchor, backward): run})."""
    total_overlap = before = robustness = weight = 0.0
    sums, active = [0.0] * high, [0] * high  # the toolkit's curve ends at high - 1
    for truth, runs in sequences:
        progress_sum = frames = 0
        for (anchor, backward), run in runs.items():
            shown = truth[anchor::-1] if backward else truth[anchor:]
            overlaps = [pixel_overlap(e, t) for e, t in zip(run, shown)]
            grace, progress = 10, len(run)
            for j, value in enumerate(overlaps):
                if value <= 0.1 and shown[j]:
                    grace -= 1
                    if grace == 0:
                        progress = j + 1 - 10
                        break
                else:
                    grace = 10
            failed = progress < len(run)
            kept = overlaps[:progress] + [0.0] * (len(run) - progress)
            progress_sum += progress
            frames += len(run)
            total_overlap += sum(overlaps[:progress])
            for j in range(1, high):
                if j < len(kept):
                    sums[j] += mean(kept[1:j + 1])
                    active[j] += 1
                elif failed:
                    sums[j] += sum(kept[1:]) / max(1, j - 1)
                    active[j] += 1
        before += progress_sum
        robustness += progress_sum / frames * len(truth)
        weight += len(truth)
    last = max((j for j in range(high) if active[j]), default=-1)
    curve = [sums[j] / active[j] if active[j] else 0.0 for j in range(last + 1)]
    part = curve[low:high + 1]
    return {"accuracy": total_overlap / before if before else 0.0, "robustness": robustness / weight, "eao_curve": curve,
            **({"eao": mean(part)} if part else {})}


def vot_runs(rng, truth, answers):
    """Random runs of both protocols, with all marks in them."""
    restart, mark = [], 1
    for i, answer in enumerate(answers):
        if mark == 1 and not truth[i]:
            restart.append(0)
        elif mark == 1:
            restart.append(1)
            mark = None
        elif rng.random() < 0.12:
            restart.append(2)
            restart += [0] * min(4, len(answers) - len(restart))
            mark = 1
        elif len(restart) <= i:
            restart.append(answer)
    restart = restart[:len(truth)]
    begun, clean = False, []
    for e in restart:  # answers that follow no start are none
        begun = True if e == 1 else False if isinstance(e, int) else begun
        clean.append(e if begun or isinstance(e, int) else 0)
    anchors = {}
    for anchor in sorted({0, len(truth) // 3, len(truth) - 1, 2 * len(truth) // 3}):
        backward = anchor >= (len(truth) + 1) // 2
        shown = answers[anchor::-1] if backward else answers[anchor:]
        anchors[anchor, backward] = [1] + list(shown[1:])
    return clean, anchors


def sign_test(a, b):
    """Fisher's, over all changes of sign."""
    d = [x - y for x, y in zip(a, b)]
    sums = [sum(v if bits >> i & 1 else -v for i, v in enumerate(d)) for bits in range(2 ** len(d))]
    return mean([abs(s) >= abs(sum(d)) - 1e-12 for s in sums])


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
    return "".join(f"{b}\n" if isinstance(b, int) else ",".join(map(repr, b)) + "\n" if b else empty for b in boxes)


def write(folder, name, text):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def check_ranges_and_speed(run_airtruth, place):
    """By hand: 60 frames whose curves end at 59, and a tracker of 1 us that is lost from frame 30 on and then answers in 4 ns."""
    length, lost = 60, 30
    truth = [(100.0 + i, 80.0, 20.0, 10.0) for i in range(length)]
    answers = truth[:lost] + [(500.0, 400.0, 20.0, 10.0)] * (length - lost)
    write(place + "/csv", "a.csv", "frame,x,y,w,h\n" + "".join(f"{i},{','.join(map(repr, b))}\n" for i, b in enumerate(truth)))
    write(place + "/mine", "a.txt", lines(answers, ""))
    write(place + "/mine", "a_time.txt", "0.5\n" + "0.000001000\n" * (lost - 1) + "0.000000004\n" * (length - lost))
    write(place + "/mine/baseline/a", "a_001.txt", lines([1] + truth[1:], ""))
    write(place + "/mine/multistart/a", "a_00000000.txt", lines([1] + truth[1:], ""))
    run_airtruth("dataset", "import", place + "/csv", "-f", "csv", "--size", f"{WIDTH}x{HEIGHT}", "-o", place + "/set")

    def evaluated(*options, results=place + "/mine"):
        done = run_airtruth("evaluate", place + "/set", results, "--no-page", "-o", place + "/evaluation", *options)
        if done.returncode != 0:
            sys.exit(f"evaluate_test: {options}: {done.stderr}")
        with open(place + "/evaluation/evaluation.json", encoding="utf-8") as file:
            evaluation = json.load(file)
        return evaluation, evaluation["trackers"][0], done.stderr

    evaluation, tracker, warnings = evaluated()
    speed = tracker["overall"]
    wanted = {"frames_per_second": (29 * 1e6 + 30 * 2.5e8) / 59, "frames_per_second_median": 2.5e8}
    off = list(differences(speed, wanted, "all frames"))
    if evaluation["eao_range"] != [58, 59] or tracker["restart"]["eao"] != 1 or tracker["multistart"]["eao"] != 1 or warnings or off:
        sys.exit(f"evaluate_test: the default range {evaluation['eao_range']}, {off}: {warnings}")
    _, tracker, _ = evaluated("--speed-until-loss")
    off = list(differences(tracker["overall"], {"frames_per_second": 1e6, "frames_per_second_median": 1e6}, "until the loss"))
    if off or tracker["sequences"][0]["first_loss"]["frame"] != lost:
        sys.exit(f"evaluate_test: {off}")
    for low, high, restart, multistart in ((60, 70, None, None), (50, 70, 1, 1)):
        _, tracker, warnings = evaluated("--eao-range", str(low), str(high))
        if warnings.count("runs ends at 59") != 2 or (tracker["restart"]["eao"], tracker["multistart"]["eao"]) != (restart, multistart):
            sys.exit(f"evaluate_test: --eao-range {low} {high}: {tracker['restart']['eao']} {tracker['multistart']['eao']} {warnings}")
    # GOT-10k's repetitions: exact, half a width beside (an overlap of a third), and far away, with a column of times each.
    for k, shift in enumerate((0, 10, 200)):
        write(place + "/got/a", f"a_{k + 1:03d}.txt", lines([(b[0] + shift, *b[1:]) for b in truth], ""))
    write(place + "/got/a", "a_time.txt", "0.5,0.25,1\n" * length)
    _, tracker, _ = evaluated(results=place + "/got")
    wanted = {"average_overlap": 4 / 9, "success_50": 1 / 3, "success_75": 1 / 3, "frames_per_second": 7 / 3}
    off = [d for part in (tracker["overall"], tracker["sequences"][0]) for d in differences(part, wanted, "repetitions")]
    if off:
        sys.exit(f"evaluate_test: {off}")
    for name in ("a.txt", "a_time.txt"):
        os.remove(os.path.join(place, "mine", name))
    _, tracker, _ = evaluated()  # VOT's runs alone
    with open(place + "/evaluation/breakdown.csv", encoding="utf-8") as file:
        rows = file.readlines()
    if tracker["restart"]["eao"] != 1 or tracker.get("overall") or len(rows) != 1:
        sys.exit(f"evaluate_test: runs alone: {tracker['restart']}, {tracker.get('overall')}, {rows}")


def main():
    airtruth = os.path.abspath(sys.argv[1])
    run_airtruth = lambda *command: subprocess.run([airtruth, *command], capture_output=True, text=True)
    with tempfile.TemporaryDirectory(prefix="airtruth_evaluate_") as root:
        checked = 0
        for seed in range(12):
            rng = random.Random(seed)
            place = os.path.join(root, str(seed))
            sequences = {f"s{k}": drawn(rng) for k in range(4)}
            mine = place + "/results/mine"
            restarts, multistarts, others = {}, {}, {}
            for name, (truth, answers, seconds) in sequences.items():
                rows = "".join(f"{i},{','.join(map(repr, b))}\n" for i, b in enumerate(truth) if b)
                write(place + "/csv", name + ".csv", "frame,x,y,w,h\n" + rows)
                write(mine, name + ".txt", lines(answers, "nan,nan,nan,nan\n"))
                write(mine, name + "_time.txt", "".join(f"{s!r}\n" for s in seconds))
                others[name] = [tuple(v + rng.gauss(0, 9) for v in b[:2]) + b[2:] if b else None for b in answers]
                # The other tracker's are laid out as GOT-10k's toolkit does it, and begin at 1.
                write(f"{place}/results/other/{name}", name + "_001.txt", lines(others[name], "0,0,0,0\n"))
                # The same answers as MOTChallenge has them: frames and pixels from 1, with another object beside.
                first = next(i for i, b in enumerate(truth) if b)
                rows = [(first + i + 1, 7, b[0] + 1, b[1] + 1, b[2], b[3]) for i, b in enumerate(answers) if b]
                rows += [(first + i + 1, 9, 3000 + i, 1, 20, 20) for i in range(len(truth))]
                write(place + "/results/mot", name + ".txt", "".join(",".join(map(repr, r)) + ",0.9,-1,-1,-1\n" for r in sorted(rows)))
                runs = [vot_runs(rng, truth, answers) for _ in range(2)]
                restarts[name] = (truth, [run for run, _ in runs])
                multistarts[name] = (truth, runs[0][1])
                for k, (run, _) in enumerate(runs):
                    write(f"{mine}/baseline/{name}", f"{name}_{k + 1:03d}.txt", lines(run, "nan,nan,nan,nan\n"))
                for (anchor, _), run in runs[0][1].items():
                    write(f"{mine}/multistart/{name}", f"{name}_{anchor:08d}.txt", lines(run, "nan,nan,nan,nan\n"))
            for command in (["dataset", "import", place + "/csv", "-f", "csv", "--size", f"{WIDTH}x{HEIGHT}", "-o", place + "/set"],
                            ["evaluate", place + "/set", mine, place + "/results/other", place + "/results/mot", "--eao-range", "8", "25", "-o", place + "/evaluation"]):
                done = run_airtruth(*command)
                if done.returncode != 0:
                    sys.exit(f"evaluate_test: {' '.join(command)}: {done.stderr}")
            with open(place + "/evaluation/evaluation.json", encoding="utf-8") as file:
                evaluation = json.load(file)
            found = next(t for t in evaluation["trackers"] if t["name"] == "mine")
            wanted = {name: reference(*sequence) for name, sequence in sequences.items()}
            ordered = sorted(wanted)
            off = [d for s in found["sequences"] for d in differences(s, wanted[s["name"]], s["name"])]
            off += differences(found["overall"], overall([wanted[n] for n in ordered]), "overall")
            off += differences(found["restart"], restart_reference([restarts[n] for n in ordered], 8, 25), "restart")
            off += differences(found["multistart"], multistart_reference([multistarts[n] for n in ordered], 8, 25), "multistart")
            for s in found["sequences"]:
                off += differences(s["restart"], restart_reference([restarts[s["name"]]], 8, 25), "restart " + s["name"])
                off += differences(s["multistart"], multistart_reference([multistarts[s["name"]]], 8, 25), "multistart " + s["name"])
            other = {name: reference(sequences[name][0], others[name], [1] * len(others[name])) for name in ordered}
            mot = next(t for t in evaluation["trackers"] if t["name"] == "mot")["overall"]
            off += differences({k: v for k, v in mot.items() if not k.startswith("frames_per_second")},
                               {k: v for k, v in found["overall"].items() if isinstance(v, (int, float, list)) and not k.startswith("frames_per_second")}, "MOT")
            pair = next(c for c in evaluation["comparisons"] if {c["a"], c["b"]} == {"mine", "other"})
            sign = 1 if pair["a"] == "mine" else -1
            aucs = [wanted[n]["auc"] for n in ordered], [other[n]["auc"] for n in ordered]
            off += differences(pair, {"auc_difference": sign * mean([x - y for x, y in zip(*aucs)]), "p_value": sign_test(*aucs)}, "pair")
            if len(found["sequences"]) != 4 or off:
                sys.exit("evaluate_test: seed %d\n  %s" % (seed, "\n  ".join(off[:10])))
            checked += 9
        check_ranges_and_speed(run_airtruth, root + "/ranges")
        place = os.path.join(root, "0")
        truth = drawn(random.Random(0))[0]
        for name, text, expected in (
                ("s0.txt", "1,2,3,4\n", "has 1 lines; s0 has"),
                ("s0.txt", "1,2,3,4\n" * (len(truth) + 1), f"has {len(truth) + 1} lines"),
                ("s0.txt", "1,2,3\n" * len(truth), ":1: has 3 numbers"),
                ("s0.txt", "1,2,x,4\n" * len(truth), ":1:5: 'x' is not a number"),
                ("other.txt", "1,2,3,4\n", "holds no result for any aircraft"),
                ("s0.txt", "1,2,3,4\n" * len(truth), "s0_time.txt: has 1 lines")):
            bad = os.path.join(root, "bad")
            os.makedirs(bad, exist_ok=True)
            for old in os.listdir(bad):
                os.remove(os.path.join(bad, old))
            write(bad, name, text)
            if "_time" in expected:
                write(bad, "s0_time.txt", "0.1\n")
            done = run_airtruth("evaluate", place + "/set", bad, "-o", root + "/never")
            if done.returncode != 2 or expected not in done.stderr or os.path.exists(root + "/never"):
                sys.exit(f"evaluate_test: {name}: {done.returncode}, {done.stderr!r}; expected {expected!r}")
        print(f"{checked} scores agree to 1e-9; 6 kinds of bad results are refused")


if __name__ == "__main__":
    main()
