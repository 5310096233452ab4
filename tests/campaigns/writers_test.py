# SPDX-License-Identifier: Apache-2.0
"""Two, three and eight runs that write the same outputs at once: every success is a whole result of one of them, and nothing
half-made stays: python3 writers_test.py AIRTRUTH [--rounds N] [--only COMMAND] [--seconds S]

Each run of a command has other options, so that its result tells whose it is. The results are made alone first.
SIGTERM ends it after the round, with the counts."""

import argparse
import itertools
import os
import random
import shutil
import signal
import sys
import tempfile
import time

import common
from common import Broken

WRITERS = 8  # at most at once
DETECTOR = """import sys, json
o = sys.stdout
o.write('{"hello":{"protocol":1,"samples":"gray","frames":"shared_memory"}}\\n'); o.flush()
for line in sys.stdin:
    if '"frame"' in line:
        o.write('{"frame":%d,"detections":[{"box":[%d,2,9,9],"score":0.5}]}\\n' % (json.loads(line)["frame"], int(sys.argv[1]))); o.flush()
"""


def inputs(airtruth, data, environment):
    def make(*words):
        common.run([airtruth, *words], codes=(0,), env=environment)

    common.write(f"{data}/scene.toml", common.SCENE)
    common.write(f"{data}/set.toml", common.CATALOGUE)
    common.write(f"{data}/own.csv", OWN)
    make("synth", "-o", f"{data}/clip.mkv", "--width", "96", "--height", "96", "--frames", "12", "--seed", "3")
    make("synth", "-o", f"{data}/lens.mkv", "--width", "320", "--height", "240", "--frames", "20", "--seed", "3")
    make("render", f"{data}/scene.toml", "--out", data)
    make("dataset", "build", f"{data}/set.toml", "-o", f"{data}/set")
    for k in range(WRITERS):
        common.write(f"{data}/s{k}.toml", common.SCENE.replace("[32, 9, -151]", f"[{30 + k}, 9, -151]"))
        os.makedirs(f"{data}/results{k}", exist_ok=True)
        make("track", f"{data}/set", "-t", "opencv-kcf" if k % 2 else "opencv-mil", "--seed", str(k + 1), "-o", f"{data}/results{k}")
        common.write(f"{data}/boxes{k}.csv", "".join(f"{i},{k + i},{k},9,7\n" for i in range(12)))
        make("encounter", "sample", "geometric", "-n", "1", "--own", f"{data}/own.csv", "--seed", str(k + 1), "-o", f"{data}/e{k}.csv")


OWN = ("encounter,weight,aircraft,time_s,north_m,east_m,down_m,north_mps,east_mps,down_mps\n"
       + "".join(f"1,1,own,{t},{50 * t},0,-1000,50,0,0\n" for t in range(60)))


def commands(airtruth, d):
    """Name: (the words of writer k that writes into `out`, with --overwrite or into a new folder)."""
    a = airtruth
    aircraft = common.run([a, "aircraft", "list"], codes=(0,)).out.split()[:2]
    return {
        "synth": lambda out, k: [a, "synth", "-o", f"{out}/f.mkv", "--truth", f"{out}/f.csv", "--mask", f"{out}/f.png", "--overwrite",
                                 "--width", "96", "--height", "96", "--frames", str(6 + k), "--seed", str(k)],
        "motion": lambda out, k: [a, "motion", f"{d}/clip.mkv", "-o", f"{out}/m.csv", "--stabilised", f"{out}/m.mkv", "--overwrite",
                                  "--reference", "smoothed", "--smoothing", str(0.1 + 0.1 * k)],
        "calibrate": lambda out, k: [a, "calibrate", f"{d}/clip.mkv", "-o", f"{out}/c.toml", "--gamma", str(2 + 0.05 * k), "--overwrite"],
        "mask": lambda out, k: [a, "mask", f"{d}/lens.mkv", "-o", f"{out}/m.png", "--overwrite"],
        "scene new": lambda out, k: [a, "scene", "new", f"{d}/{'lens' if k % 2 else 'clip'}.mkv", "-o", f"{out}/s.toml", "--overwrite"],
        "preview": lambda out, k: [a, "preview", f"{d}/s{k}.toml", "-o", f"{out}/p.png"],
        "render": lambda out, k: [a, "render", f"{d}/s{k}.toml", "--out", out, "--overwrite"],
        "overlay": lambda out, k: [a, "overlay", f"{d}/set/sequences/{'away' if k % 2 else 'across'}", "-o", f"{out}/o.mkv", "--overwrite"],
        "inspect": lambda out, k: [a, "inspect", f"{d}/out", "--frame", "2", "--zoom", str(k + 1), "-o", f"{out}/i.png", "--overwrite"],
        "aircraft show": lambda out, k: [a, "aircraft", "show", aircraft[k % 2], "-o", f"{out}/a.png", "--overwrite"],
        "encounter sample": lambda out, k: [a, "encounter", "sample", "geometric", "--own", f"{d}/own.csv", "-n", str(400 - 30 * k),
                                            "--seed", str(k + 1), "-o", f"{out}/e.csv", "--overwrite"],
        "encounter convert": lambda out, k: [a, "encounter", "convert", f"{d}/e{k}.csv", f"{out}/e.daa", "--overwrite"],
        "dataset build": lambda out, k: [a, "dataset", "build", f"{d}/set.toml", "-o", f"{out}/set"],
        "dataset export": lambda out, k: [a, "dataset", "export", f"{d}/set", "-f", "coco", "-o", f"{out}/coco", "--seed", str(k + 1),
                                          "--every", str(1 + k % 2)],
        "dataset import": lambda out, k: [a, "dataset", "import", f"{d}/boxes{k}.csv", "-f", "csv", "--video", f"{d}/clip.mkv",
                                          "-o", f"{out}/set"],
        "dataset report": lambda out, k: [a, "dataset", "report", f"{d}/{'set' if k % 2 else 'out'}", "-o", f"{out}/r.html", "--overwrite"],
        "detect": lambda out, k: [a, "detect", f"{d}/clip.mkv", "-d", f"own=exec:python3 {d}/detector.py {k}", "-o", f"{out}/d"],
        "track": lambda out, k: [a, "track", f"{d}/set", "-t", "opencv-mosse", "--seed", str(k + 1), "-o", f"{out}/t"],
        "evaluate": lambda out, k: [a, "evaluate", f"{d}/set", f"{d}/results{k}/{'opencv-kcf' if k % 2 else 'opencv-mil'}", "-o", f"{out}/e", "--no-page"],
        "demo": lambda out, k: [a, "demo", "-o", f"{out}/demo", "--frames", "4", "--seed", str(k + 1), "--overwrite"],
    }


def told_apart(folder):
    """The state of a result, without the files that hold measured seconds."""
    return {file: value for file, value in common.state(folder, leave_out=(".lock",)).items()
            if not file.endswith(("sequence.json", "dataset.json", "_time.txt", ".seconds", "own/clip.json")) and "manifest" not in file}


def alone(name, words_of, place, environment):
    results = []
    for k in range(WRITERS):
        out = os.path.join(place, f"alone-{k}")
        shutil.rmtree(out, ignore_errors=True)
        os.makedirs(out)
        common.run(words_of(out, k), codes=(0,), env=environment)
        results.append(told_apart(out))
        shutil.rmtree(out)
    return results


def at_once(name, words_of, out, writers, known, environment):
    """Returns how many succeeded."""
    shutil.rmtree(out, ignore_errors=True)
    os.makedirs(out)
    runs = [(k, common.start(words_of(out, k), env=environment)) for k in writers]
    won = []
    for k, process in runs:
        what = f"{name}, writer {k} of {writers}"
        if common.hold_to_rules(common.end(process, what), what).code == 0:
            won.append(k)
    if not won:
        raise Broken(f"{name}: none of {writers} succeeded")
    left = common.halves(out)
    if left:
        raise Broken(f"{name}: left {left}")
    state = told_apart(out)
    if not any(state == known[k] for k in won):
        nearest = min((common.difference(known[k], state) for k in won), key=len)
        raise Broken(f"{name}: what {won} of {writers} left is of none of them; it differs in {nearest}")
    return len(won)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("airtruth")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--seconds", type=float, default=1e9, help="begin no further round after so long")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    draw = random.Random(given.seed)
    begun = time.monotonic()
    broken = 0
    with tempfile.TemporaryDirectory() as root:
        environment = common.environment(os.path.join(root, "cache"))
        data = os.path.join(root, "data")
        common.write(f"{data}/detector.py", DETECTOR)
        inputs(given.airtruth, data, environment)
        wanted = {name: words for name, words in commands(given.airtruth, data).items() if given.only in name}
        known = {}
        counts = {name: [0, 0, 0] for name in wanted}
        is_ended = []
        signal.signal(signal.SIGTERM, lambda *_: is_ended.append(True))
        for number in itertools.count():
            if number == given.rounds or time.monotonic() - begun > given.seconds or is_ended:
                break
            for name, words_of in wanted.items():
                try:
                    if name not in known:
                        known[name] = alone(name, words_of, root, environment)
                    for writers in (2, 3, WRITERS):
                        chosen = draw.sample(range(WRITERS), writers)
                        won = at_once(name, words_of, os.path.join(root, "at-once"), chosen, known[name], environment)
                        counts[name][0] += 1
                        counts[name][1] += writers
                        counts[name][2] += won
                except Broken as fault:
                    broken += 1
                    print(f"broken: {fault}", flush=True)
        for name, (times, runs, won) in counts.items():
            print(f"{name:<18} {times:>5} times, {runs:>6} runs, {won:>6} succeeded")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
