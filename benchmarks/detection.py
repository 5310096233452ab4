#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What do detectors find among real aircraft, and does a made set predict it? ./dev detection OUT

Needs clips of real aircraft, birds and multirotors with boxes (AIRTRUTH_SHARED/footage; their provenance stands there).
The real set holds the aircraft clips with tight boxes, and the birds and multirotors as objects that are no aircraft. The
made set holds aircraft of the same sizes, put into the skies of the bird clips. The same detectors run over both, and are
measured over the made set at the scores that give one false alarm an image over the real one. Prints a Markdown table and
leaves it as OUT/detection.md beside detection.png, the probability of detection by size. What is there already is kept.
"""

import argparse
import glob
import json
import math
import os
import shutil
import subprocess
import sys
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "proof"))
import sets
# The clips are split once, by name. Whoever works on detectors looks at the others; these are measured once, at the end.
HELD_BACK_AIRCRAFT = ([f"V_AIRPLANE_{n:03}" for n in (12, 13, 14, 15, 16, 17, 18, 35, 49)]
                      + [f"V_HELICOPTER_{n:03}" for n in (7, 9, 10, 11)])
FIRST_BIRD_HELD_BACK = 20
FIRST_MULTIROTOR_HELD_BACK = 31
ONBOARD = ["cumulus_a4", "overcast_b4"]
# Detectors that know no classes take birds and multirotors for aircraft, most of them in every frame of their clips.
FALSE_ALARMS_PER_IMAGE = 1.0
MADE = 40          # sequences of the made set
MADE_FRAMES = 150  # of each
IGNORED_MARGIN_PX = 12  # around a loose box or an unlabelled object


def run(command):
    process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if process.returncode != 0:
        sys.exit(f"detection: {' '.join(command)} failed:\n{process.stderr}")
    return process.stdout


def number_of(clip):
    return int(clip.rsplit("_", 1)[1])


def boxes_in(file, origin):
    """(frame, x, y, width, height) of each line; the first pixel is at (0, 0)."""
    return [(frame, *box) for frame, boxes in sets.boxes_in(file, origin).items() for box in boxes]


class Clips:
    def __init__(self, shared, held_back):
        self.ground = os.path.join(shared, "footage", "ground-real")
        self.onboard = os.path.join(shared, "footage", "fixed-wing")
        tight = {os.path.basename(f)[:-4] for f in glob.glob(os.path.join(self.ground, "tight", "*.csv"))}
        self.aircraft = sorted(c for c in tight if (c in HELD_BACK_AIRCRAFT) == held_back)
        self.birds = self.others("birds", FIRST_BIRD_HELD_BACK, held_back)
        self.multirotors = self.others("drones", FIRST_MULTIROTOR_HELD_BACK, held_back)

    def others(self, folder, first_held_back, held_back):
        clips = [os.path.basename(f)[:-4] for f in glob.glob(os.path.join(self.ground, folder, "*.mp4"))]
        return sorted(c for c in clips if (number_of(c) >= first_held_back) == held_back)

    def video(self, clip):
        for folder in (self.ground, *(os.path.join(self.ground, f) for f in ("more", "birds", "drones")), self.onboard):
            file = os.path.join(folder, clip + ".mp4")
            if os.path.exists(file):
                return file
        sys.exit(f"detection: {clip}.mp4 is in no folder of {self.ground}")

    def loose(self, clip):
        return os.path.splitext(self.video(clip))[0] + ".csv"


def write_ignored(file, regions):
    with open(file, "w") as out:
        out.write("sequence,first_frame,last_frame,x,y,width,height\n")
        for name, frame, x, y, width, height in regions:
            m = IGNORED_MARGIN_PX
            out.write(f"{name},{frame},{frame},{x - m},{y - m},{width + 2 * m},{height + 2 * m}\n")


def import_clips(arguments, clips, names, boxes_of, origin, what, out):
    """Imports clips into one set; boxes_of(clip) is a CSV file."""
    folder = os.path.join(arguments.out, f"boxes-{what}")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    videos = []
    for name in names:
        shutil.copy(boxes_of(name), os.path.join(folder, name + ".csv"))
        videos.append(f"{name}={clips.video(name)}")
    temporary = os.path.join(arguments.out, f"imported-{what}")
    shutil.rmtree(temporary, ignore_errors=True)
    run([arguments.program, "--quiet", "dataset", "import", folder, "--format", "csv", "--origin", str(origin), "--class", what,
         "--video", *videos, "-o", temporary])
    os.makedirs(os.path.join(out, "sequences"), exist_ok=True)
    for name in names:
        shutil.move(os.path.join(temporary, "sequences", name), os.path.join(out, "sequences", name))
    shutil.rmtree(temporary)
    shutil.rmtree(folder)


def real_set(arguments, clips):
    out = os.path.join(arguments.out, "real")
    if os.path.exists(os.path.join(out, "ignore.csv")):
        return out
    shutil.rmtree(out, ignore_errors=True)
    tight = lambda clip: os.path.join(clips.ground, "tight", clip + ".csv")
    import_clips(arguments, clips, clips.aircraft, tight, 0, "aircraft", out)
    import_clips(arguments, clips, clips.birds, clips.loose, 1, "bird", out)
    import_clips(arguments, clips, clips.multirotors, clips.loose, 1, "multirotor", out)
    # Frames of aircraft whose tight box is not known, and where the loose box is therefore neither right nor wrong.
    ignored = []
    for clip in clips.aircraft:
        known = {row[0] for row in boxes_in(tight(clip), 0)}
        ignored += [(clip, *row) for row in boxes_in(clips.loose(clip), 1) if row[0] not in known]
    write_ignored(os.path.join(out, "ignore.csv"), ignored)
    return out


def made_set(arguments, clips):
    out = os.path.join(arguments.out, "made")
    catalogue = os.path.join(arguments.out, "made.toml")
    # The aircraft fly in the frames that show the fewest birds; the birds count neither way.
    with open(catalogue, "w") as file:
        file.write('name = "made"\nseed = 1\n')
        for clip in clips.birds:
            file.write(f'\n[[background]]\nname = "{clip}"\nvideo = "{clips.video(clip)}"\n'
                       "lens = { model = \"pinhole\", vertical_fov_deg = 12 }\n"
                       "camera = { position_ned_m = [0, 0, -2], attitude_yaw_pitch_roll_deg = [0, 15, 0] }\n"
                       "light = { sun_azimuth_deg = 150, sun_elevation_deg = 45 }\n"
                       'realism = { auto = true, fallback = true, profile = "ground-zoom" }\n')
        file.write(f'\n[[random]]\nname = "made-{{index}}"\ncount = {MADE}\nframe_count = {MADE_FRAMES}\n'
                   'aircraft = ["733/*", "738/*", "757/*", "A319/*", "A320/*", "A332/*", "CR7/*", "b1900d/*", "Citation-Bravo/*", "c172/*"]\n'
                   "size_px = [5, 60]\nazimuth_deg = [-4, 4]\nelevation_deg = [-3, 4]\nnegatives = 0.1\n")
    run([arguments.program, "--quiet", "dataset", "build", catalogue, "--out", out])
    used = set()
    for record in glob.glob(os.path.join(out, "sequences", "*", "sequence.json")):
        with open(record) as text:
            used.add(os.path.basename(tomllib.loads(json.load(text)["scene_toml"])["background"]["video"]))
    ignored = [(os.path.basename(clips.video(clip)), *row) for clip in clips.birds if os.path.basename(clips.video(clip)) in used
               for row in boxes_in(clips.loose(clip), 1)]
    write_ignored(os.path.join(out, "ignore.csv"), ignored)
    return out


def detect(arguments, data, results):
    detectors = arguments.detectors + [f"network=onnx:{arguments.onnx}"] * (arguments.onnx is not None)
    run([arguments.program, "--quiet", "detect", data, "--detector", *detectors, "-o", results, "-j", "2",
         *(["--associate"] if arguments.associate else [])])
    return sorted(os.listdir(results))


def evaluate(arguments, data, results, out, *options):
    run([arguments.program, "--quiet", "evaluate", data, *results, "-o", out, *options])
    with open(os.path.join(out, "detection.json")) as file:
        return {detector["name"]: detector for detector in json.load(file)["detectors"]}


def shown(share):
    if not share:
        return "-"
    low, high = share["interval_95"]
    return f"{share['share']:.2f} ({low:.2f} to {high:.2f})"


def table(rows):
    lines = ["| set | detector | AP, centre | AP 50 | detected at the point | false alarms an image | false alarms by what they are |",
             "|---|---|---:|---:|---:|---:|---|"]
    for what, name, score in rows:
        ap = score["average_precision"]
        point = score["point"] or {"detection": None, "false_alarms_per_image": 0}
        number = lambda v: "-" if v is None else f"{v:.3f}"
        kinds = ", ".join(f"{kind} {count}" for kind, count in sorted(score["false_alarms_by"].items(), key=lambda k: -k[1]))
        lines.append(f"| {what} | {name} | {number(ap['ap_centre'])} | {number(ap['ap_50'])} | {shown(point['detection'])} | "
                     f"{point['false_alarms_per_image']:.3f} | {kinds or '-'} |")
    return "\n".join(lines) + "\n"


def plot(out, curves):
    """The probability of detection by size: the real set's lines are solid, the made one's dashed."""
    script = ["set terminal pngcairo size 1100,720 font 'sans,12'", f"set output '{out}'", "set logscale x 2", "set yrange [0:1.02]",
              "set xlabel 'longer side of the aircraft, px'", "set ylabel 'probability of detection'", "set key outside right",
              "set grid"]
    parts, data = [], []
    for number, (name, curve) in enumerate(sorted(curves.items())):
        for what, dash in (("real", 1), ("made", 2)):
            points = [(math.sqrt(max(b["from"], 1) * (b["to"] or 2 * b["from"])), b) for b in curve.get(what, []) if "share" in b]
            if not points:
                continue
            parts.append(f"'-' using 1:2:3:4 with yerrorlines lc {number + 1} dt {dash} pt {7 if dash == 1 else 6} title '{name}, {what}'")
            data.append("".join(f"{x} {b['share']} {b['interval_95'][0]} {b['interval_95'][1]}\n" for x, b in points) + "e\n")
    text = "\n".join(script) + "\nplot " + ", ".join(parts) + "\n" + "".join(data)
    subprocess.run(["gnuplot"], input=text, text=True, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--detectors", nargs="+", default=["cmo", "cmo-hmm", "frame-difference"])
    parser.add_argument("--onnx", help="a network as well: MODEL.onnx with its MODEL.json")
    parser.add_argument("--associate", action="store_true", help="detections to tracks")
    parser.add_argument("--held-back", action="store_true", help="the clips that are measured once, at the end")
    arguments = parser.parse_args()
    shared = os.environ.get("AIRTRUTH_SHARED")
    if not shared:
        sys.exit("detection: AIRTRUTH_SHARED names no folder with real clips")
    os.makedirs(arguments.out, exist_ok=True)
    clips = Clips(shared, arguments.held_back)
    sets = {"real": real_set(arguments, clips), "made": made_set(arguments, clips)}
    rows, curves = [], {}
    at = lambda *parts: os.path.join(arguments.out, *parts)
    names = {what: detect(arguments, data, at(f"results-{what}")) for what, data in sets.items()}
    real = evaluate(arguments, sets["real"], [at("results-real", n) for n in names["real"]], at("evaluation-real"),
                    "--false-alarms", str(FALSE_ALARMS_PER_IMAGE))
    for name, score in real.items():
        rows.append(("real", name, score))
        curves.setdefault(name, {})["real"] = score["by"].get("size_px", [])
        if not score["point"]:
            continue
        made = evaluate(arguments, sets["made"], [at("results-made", name)], at("evaluation-made", name), "--score",
                        repr(score["point"]["score"]))
        rows.append(("made", name, made[name]))
        curves[name]["made"] = made[name]["by"].get("size_px", [])
    text = table(rows)
    with open(at("detection.md"), "w") as file:
        file.write(text)
    plot(at("detection.png"), curves)
    print(text)


main()
