#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What do detectors find in encounters over real onboard video? ./dev detection-encounters OUT

Needs three real clips (AIRTRUTH_SHARED/footage; their provenance stands there): two of a small fixed-wing aircraft's nose camera and
one of a gimballed camera on a multirotor. Makes two data sets: 100 encounters, and the catalogue of 24 over the two nose-camera clips.
Runs detectors over both and prints a Markdown table of each, which it leaves as OUT/encounters.md and OUT/evision.md beside the
evaluations. Real aircraft of the clips count neither way (data/real-aircraft/ignore.csv). What is there already is kept.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
IGNORED = os.path.join(ROOT, "data", "real-aircraft", "ignore.csv")
MOST_FRAMES = 960           # of a sequence of the catalogue: the shorter of its two clips has 969
VERTICAL_FOV_DEG = 41       # the nose camera's lens, as its maker states it
FALSE_ALARMS_PER_IMAGE = 0.1
# One gull in 56 frames of a clip over which a third of the encounters fly makes 0.1 false alarms an image by itself.
MORE_FALSE_ALARMS_PER_IMAGE = 1
MANOEUVRE_S = 2             # before a near mid-air collision; clips of 6.7 s leave no room for 20 s

# The part of each clip in which its camera holds its direction, and its lens and attitude there (docs/real-clips.md).
CLIPS = {
    "cumulus": ("fixed-wing/cumulus_a4.mp4", "first_frame = 205\nlens = { focal_px = [504.4, 504.4] }\n"
                "camera = { velocity_ned_mps = [20, 0, 0], attitude_yaw_pitch_roll_deg = [0, -5.6, 8.0] }\n"),
    "overcast": ("fixed-wing/overcast_b4.mp4", "first_frame = 44\nlens = { focal_px = [504.4, 504.4] }\n"
                 "camera = { velocity_ned_mps = [20, 0, 0], attitude_yaw_pitch_roll_deg = [0, 1.6, 1.4] }\n"),
    "cliff": ("gopro-karma/karma.mp4", "lens = { vertical_fov_deg = 60 }\ncamera = { velocity_ned_mps = [8, 0, 0] }\n"),
}

# 100 encounters in the proportions of catalogues/encounters.toml, in clips of 200 frames.
RULES = """
[[encounter_model]]
name = "traffic-{index}"
kind = "bayes"
model = "%s/examples/encounters/light_aircraft.txt"
count = 50
frame_count = 200
aircraft = ["c172/*", "c182/*", "pa-28/*", "DR400/*", "Diamond-Da42/*", "Beechcraft-Staggerwing/*", "Cub/*", "DH82/*"]
cpa_time_s = [3, 6]
hmd_m = [-300, -80, 80, 300]
hmd_shares = [1, 3, 1]
vmd_m = [-60, -20, 20, 90]
vmd_shares = [1, 2, 1]
negatives = 0.05
two_intruders = 0.1

[[encounter_model]]
name = "ahead-{index}"
kind = "geometric"
count = 38
frame_count = 200
aircraft = ["c172/*", "c182/*", "pa-28/*", "DR400/*", "Diamond-Da42/*", "b1900d/*", "Citation-Bravo/*", "centrair-101/*"]
course_deg = [100, 260]
speed_mps = [25, 90]
cpa_time_s = [3.5, 6.2]
hmd_m = [-200, 200]
vmd_m = [-50, 60]
climb_mps = [-2, 2]
turn_rate_dps = [-2, 2]
negatives = 0.05
two_intruders = 0.1

[[encounter_model]]
name = "overtaking-{index}"
kind = "geometric"
count = 12
frame_count = 200
aircraft = ["c172/*", "pa-28/*", "Diamond-Da42/*", "Beechcraft-Staggerwing/*"]
course_deg = [-20, 20]
speed_mps = [40, 65]
cpa_time_s = [0.5, 3]
hmd_m = [-80, 80]
vmd_m = [-40, 60]
negatives = 0.05
two_intruders = 0.1
"""


def run(command):
    process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if process.returncode != 0:
        sys.exit(f"detection_encounters: {' '.join(command)} failed:\n{process.stderr}")
    return process.stdout


def clip(shared, name):
    return os.path.join(shared, "footage", CLIPS[name][0])


def encounters(arguments, shared):
    text = 'name = "encounters-real"\nseed = 1\n'
    for name, (_, keys) in CLIPS.items():
        text += (f'\n[[background]]\nname = "{name}"\nvideo = "{clip(shared, name)}"\n{keys}'
                 'motion = { reference = "smoothed" }\nrealism = { auto = true, fallback = true }\n')
    return built(arguments, "encounters", text + RULES % ROOT, [])


def catalogue(arguments, shared):
    with open(os.path.join(ROOT, "catalogues", "evision.toml")) as file:
        text = file.read()
    text = text.replace("vertical_fov_deg = 90", f"vertical_fov_deg = {VERTICAL_FOV_DEG}")
    text = re.sub(r"frame_count = (\d+)\ntimes_s", lambda m: f"frame_count = {min(int(m[1]), MOST_FRAMES)}\ntimes_s", text)
    videos = [f"{number}={clip(shared, name)}" for number, name in (("1", "cumulus"), ("2", "overcast"), ("3", "cumulus"))]
    return built(arguments, "evision", text, [word for video in videos for word in ("--background", video)])


def built(arguments, name, text, options):
    os.makedirs(arguments.out, exist_ok=True)
    file, out = (os.path.join(arguments.out, name + end) for end in (".toml", "-set"))
    with open(file, "w") as output:
        output.write(text)
    run([arguments.program, "--quiet", "dataset", "build", file, "--out", out, "-j", str(arguments.jobs), *options])
    shutil.copy(IGNORED, os.path.join(out, "ignore.csv"))
    return out


def measured(arguments, name, data):
    results, out = (os.path.join(arguments.out, name + end) for end in ("-results", "-evaluation"))
    detectors = arguments.detectors + [f"network=onnx:{arguments.onnx}"] * (arguments.onnx is not None)
    run([arguments.program, "--quiet", "detect", data, "--detector", *detectors, "--associate", "-o", results, "-j", str(arguments.jobs)])
    folders = [os.path.join(results, detector.split("=")[0]) for detector in detectors]
    scores = evaluated(arguments, data, folders, out, FALSE_ALARMS_PER_IMAGE, [])
    more = evaluated(arguments, data, folders, out + "-more", MORE_FALSE_ALARMS_PER_IMAGE, ["--no-page"])
    for name, score in scores.items():
        score["more"] = more[name]["point"]
    return list(scores.values())


def evaluated(arguments, data, folders, out, false_alarms, options):
    run([arguments.program, "--quiet", "evaluate", data, *folders, "-o", out, "--false-alarms", str(false_alarms),
         "--volume", "nmac", "--manoeuvre-s", str(MANOEUVRE_S), *options])
    with open(os.path.join(out, "detection.json")) as file:
        return {detector["name"]: detector for detector in json.load(file)["detectors"]}


def shown(share):
    if not share or "share" not in share:
        return "-"
    low, high = share["interval_95"]
    return f"{share['share']:.2f} ({low:.2f} to {high:.2f})"


def table(detectors):
    at = (FALSE_ALARMS_PER_IMAGE, MORE_FALSE_ALARMS_PER_IMAGE)
    lines = [f"| detector | AP, centre | detected at {at[0]:g} false alarms an image | at {at[1]:g} | declared | at range, mean | in time "
             "| false tracks |", "|---|---:|---:|---:|---:|---:|---:|---:|"]
    for score in sorted(detectors, key=lambda d: -d["average_precision"]["ap_centre"]):
        ap = score["average_precision"]
        low, high = ap["ap_centre_interval_95"]
        declared = score["tracks"]["declarations"]
        metres = declared.get("range_m")
        in_time = declared.get("in_time") or {}
        lines.append(f"| {score['name']} | {ap['ap_centre']:.3f} ({low:.2f} to {high:.2f}) | {shown(score['point']['detection'])} | "
                     f"{shown(score['more']['detection'])} | "
                     f"{shown(declared['declared'])} | {metres['mean']:.0f} m | {shown(in_time)} of {in_time.get('trials', 0):.0f} | "
                     f"{score['tracks']['false_tracks']} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--sets", nargs="+", choices=["encounters", "evision"], default=["encounters", "evision"])
    parser.add_argument("--detectors", nargs="+", default=["cmo", "cmo-hmm", "frame-difference"])
    parser.add_argument("--onnx", help="a network as well: MODEL.onnx with its MODEL.json")
    parser.add_argument("--build-only", action="store_true", help="make the sets and run no detector")
    parser.add_argument("-j", "--jobs", type=int, default=2)
    arguments = parser.parse_args()
    shared = os.environ.get("AIRTRUTH_SHARED")
    if not shared:
        sys.exit("detection_encounters: AIRTRUTH_SHARED names no folder with real clips")
    for name in arguments.sets:
        data = (encounters if name == "encounters" else catalogue)(arguments, shared)
        if not arguments.build_only:
            text = table(measured(arguments, name, data))
            with open(os.path.join(arguments.out, name + ".md"), "w") as file:
                file.write(text)
            print(text)


if __name__ == "__main__":
    main()
