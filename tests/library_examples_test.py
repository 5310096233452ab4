# SPDX-License-Identifier: Apache-2.0
"""The C++ examples against the program's own files: python3 library_examples_test.py AIRTRUTH EXAMPLES

Makes a small virtual flight, renders two sequences, scores made-up results, and compares what each example prints with
truth.jsonl, evaluation.json and the video. package_test.sh calls it with the installed program and the examples that were
built against the installed library.
"""

import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

SIZE = WIDTH, HEIGHT = 160, 120
SCENE = """name = "{name}"
[background]
video = "../flight.mkv"
[lens]
model = "pinhole"
vertical_fov_deg = 75
[camera]
position_ned_m = [0, 0, -150]
[[intruder]]
id = "a"
aircraft = "{aircraft}"
waypoints_ned_m = [[120, -8, -150], [120, 100, -150]]
speed_mps = 50
[output]
video = "mkv"
"""


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def fails_with(words, message):
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 2 and message in done.stderr and done.stderr.count("\n") == 1, (words, done)


def check_projection(examples):
    text = run(f"{examples}/project_point")
    assert "pinhole, 1920 x 1080, 60.00 degrees wide" in text, text
    assert "(10, 0, 500) m -> pixel (993.3, 540.0) -> (10.000, 0.000, 500.000) m" in text, text
    fails_with([f"{examples}/project_point", "no_such.json", "640", "480"], "no_such.json")


def check_render(examples, scene, sequence):
    with open(f"{sequence}/truth.jsonl") as file:
        assert run(f"{examples}/render_in_memory", scene) == file.read(), "the truth differs from truth.jsonl"
    fails_with([f"{examples}/render_in_memory", "/no_such.toml"], "/no_such.toml")


def check_stream(examples, folder):
    catalogue = f"{folder}/stream.toml"
    with open(catalogue, "w") as file:
        file.write('[[background]]\nname = "sky"\nvideo = "flight.mkv"\nlens = { vertical_fov_deg = 75 }\n'
                   '[[random]]\naircraft = ["738/738-Ryanair", "c172/news"]\nsize_px = [10, 40]\n'
                   '[stream]\nsize_px = [64, 48]\n')
    boxes = []
    for line in run(f"{examples}/train_from_stream", catalogue, 6).splitlines():
        if line.startswith("  "):
            kind, x, y, width, height = line.split()
            boxes.append((kind, *map(float, (x, y, width, height))))
        else:
            assert re.fullmatch(r"\d sky \d+ 64x48", line), line
    assert len(boxes) == 6, boxes
    for kind, x, y, width, height in boxes:
        assert kind == "aircraft" and x >= 0 and y >= 0 and x + width <= 64 and y + height <= 48, boxes
    fails_with([f"{examples}/train_from_stream", "/no_such.toml", "1"], "/no_such.toml")


def luma_of(video):
    """The luma planes, decoded by ffmpeg; nothing where there is none."""
    if shutil.which("ffmpeg") is None:
        return None
    command = ["ffmpeg", "-v", "error", "-i", video, "-f", "rawvideo", "-pix_fmt", "yuv420p", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    size = WIDTH * HEIGHT * 3 // 2
    return [raw[at:at + WIDTH * HEIGHT] for at in range(0, len(raw), size)]


def check_read(examples, data_set, names):
    expected = []
    for name in names:
        luma = luma_of(f"{data_set}/{name}/{name}.mkv")
        with open(f"{data_set}/{name}/truth.jsonl") as file:
            for k, truth in enumerate(map(json.loads, file)):
                for intruder in truth["intruders"]:
                    if intruder["covered_box_px"] is None:
                        continue
                    x, y, width, height = intruder["covered_box_px"]
                    bright = luma[k][y * WIDTH + x] if luma else None
                    expected.append((name, k, intruder["id"], x, y, width, height, intruder["range_m"], bright))
    got = []
    for line in run(f"{examples}/read_dataset", data_set).splitlines():
        name, k, ident, x, y, width, height, range_m, _, bright = line.split()
        got.append((name, int(k), ident, int(x), int(y), int(width), int(height), float(range_m),
                    int(bright) if shutil.which("ffmpeg") else None))
    assert len(expected) > 10 and got == expected, (got[:2], expected[:2])
    fails_with([f"{examples}/read_dataset", "/no_such"], "/no_such")


def boxes_of(sequence):
    """The tracker's frames: from the first that shows the aircraft whole to the last that shows it."""
    with open(f"{sequence}/truth.jsonl") as file:
        shown = [line["intruders"][0] for line in map(json.loads, file)]
    boxes = [one.get("covered_box_px") for one in shown]
    whole = [i for i, one in enumerate(shown) if boxes[i] and one["cut_by_frame"] == 0]
    first = whole[0] if whole else next(i for i, box in enumerate(boxes) if box)
    last = max(i for i, box in enumerate(boxes) if box)
    return boxes[first:last + 1]


def check_scores(program, examples, data_set, names, folder):
    draw = random.Random(7)
    results = f"{folder}/tracker"
    os.makedirs(results)
    for name in names:
        lines = []
        for box in boxes_of(f"{data_set}/{name}"):
            x, y, width, height = box or (5, 5, 9, 9)
            answer = (x + draw.uniform(-4, 4), y + draw.uniform(-3, 3), width * draw.uniform(0.7, 1.3), height)
            lines.append("nan,nan,nan,nan" if draw.random() < 0.1 else ",".join(map(repr, answer)))
        with open(f"{results}/{name}.txt", "w") as file:
            file.write("\n".join(lines) + "\n")
    run(program, "evaluate", data_set, results, "--out", f"{folder}/scores", "--no-page")
    with open(f"{folder}/scores/evaluation.json") as file:
        tracker = json.load(file)["trackers"][0]
    expected = {one["name"]: one for one in tracker["sequences"]} | {"overall": tracker["overall"]}
    lines = run(f"{examples}/score_tracker", data_set, results).splitlines()
    assert len(lines) == len(expected) == len(names) + 1, lines
    for line in lines:
        name, auc, overlap, centre = re.fullmatch(r"(.*): AUC (.*), AO (.*), centre (.*) px", line).groups()
        wanted = expected[name]
        assert 0.1 < wanted["auc"] < 0.99, wanted["auc"]
        assert (float(auc), float(overlap), float(centre)) == (
            wanted["auc"], wanted["average_overlap"], wanted["centre_mean_px"]), (line, wanted)


def main(program, examples):
    check_projection(examples)
    with tempfile.TemporaryDirectory() as folder:
        run(program, "synth", "--out", f"{folder}/flight.mkv", "--width", WIDTH, "--height", HEIGHT, "--frames", 12,
            "--no-own-aircraft")
        data_set = f"{folder}/set"
        names = ["738", "c172"]
        os.makedirs(data_set)
        for name, aircraft in zip(names, ["738/738-Ryanair", "c172/news"]):
            os.makedirs(f"{folder}/scenes", exist_ok=True)
            with open(f"{folder}/scenes/{name}.toml", "w") as file:
                file.write(SCENE.format(name=name, aircraft=aircraft))
            run(program, "render", f"{folder}/scenes/{name}.toml", "--out", data_set, "--no-cache")
        check_render(examples, f"{folder}/scenes/738.toml", f"{data_set}/738")
        check_stream(examples, folder)
        check_read(examples, data_set, names)
        check_scores(program, examples, data_set, names, folder)
    print("the examples print what the program's own files hold")


if __name__ == "__main__":
    main(*sys.argv[1:])
