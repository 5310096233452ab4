#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Can a judge tell inserted aircraft from real ones, and which stage of realism takes that from it? ./dev ablation OUT

Needs clips of real aircraft with boxes (AIRTRUTH_SHARED/footage; their provenance stands there). For each clip: its camera
is calibrated, an aircraft is put beside the real one with each stage added to those before, and judges that learned from the
other clips are asked (benchmarks/judge). Prints Markdown tables; leaves those of each stage in OUT/NUMBER.md and .json, and a
sheet for people in OUT/NUMBER.png, whose key is OUT/NUMBER.key.csv. Comparisons that are there already are not made again. A
clip that `compare` refuses is named and left out.
"""

import argparse
import json
import os
import subprocess
import sys
import time
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "judge"))

import tables  # noqa: E402  its tables are the judge's

# The clips are split once, by name. Whoever works on light, optics or noise looks at these alone ...
ONBOARD = ["cumulus_a4", "overcast_b4"]
LOOKED_AT = (ONBOARD + [f"V_AIRPLANE_{n:03}" for n in (1, 2, 3, 4, 6, 8, 9, 13, 15, 18, 35, 49)]
             + [f"V_HELICOPTER_{n:03}" for n in (1, 2, 3, 4)])
# ... and measures on these once, when it is done.
HELD_BACK = ([f"V_AIRPLANE_{n:03}" for n in (5, 7, 10, 11, 12, 14, 16, 17)]
             + [f"V_HELICOPTER_{n:03}" for n in (5, 6, 7, 8, 9, 10, 11)])
SUN = {"cumulus_a4": (150, 50), "overcast_b4": (0, 60), "V_AIRPLANE_008": (180, 30), "V_AIRPLANE_018": (180, 30),
       "V_AIRPLANE_035": (180, 30), "V_AIRPLANE_049": (180, 30)}  # azimuth, elevation
OTHER_SUN = (0, 50)
# Each stage has the tables of those before it; None: another method.
STAGES = [("chroma-key", None), ("matte", []), ("+ shutter", ["shutter"]), ("+ air", ["air"]), ("+ optics", ["optics"]),
          ("+ noise", ["noise"]), ("+ chroma", ["chroma"]), ("+ codec (all)", ["codec"])]
# The clips from the ground are of one camera (data/camera-profiles): what one of them cannot tell, as a clip of sky alone
# cannot tell its sharpness, the camera's profile does. The onboard clips show enough edges of their own.
GROUND_PROFILE = "ground-zoom"
SENSOR = {"noise": ("noise_gain", "noise_floor", "noise_correlation_px"), "chroma": ("chroma_spread_px",), "codec": ("codec_step",)}


def run(command):
    process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if process.returncode != 0:
        sys.exit(f"ablation: {' '.join(command)} failed:\n{process.stderr}")
    return process.stdout


def place_of(shared, clip):
    """Video, boxes and the origin of the boxes."""
    if not clip.startswith("V_"):
        return (os.path.join(shared, "footage", "fixed-wing", clip + ".mp4"),
                os.path.join(HERE, "..", "data", "real-aircraft", clip + ".csv"), 0)
    for folder in ("ground-real", os.path.join("ground-real", "more")):
        video = os.path.join(shared, "footage", folder, clip + ".mp4")
        if os.path.exists(video):
            return video, os.path.splitext(video)[0] + ".csv", 1
    sys.exit(f"ablation: {clip}.mp4 is in no folder of {shared}/footage/ground-real")


def toml_table(name, values):
    def shown(value):
        if isinstance(value, str):
            return f'"{value}"'
        return "[" + ", ".join(map(shown, value)) + "]" if isinstance(value, list) else repr(value)
    return f"\n[{name}]\n" + "".join(f"{key} = {shown(value)}\n" for key, value in values.items())


def tables_of(camera, parts):
    tables = {}
    for part in parts:
        if part in ("shutter", "air", "optics"):
            tables[part] = dict(camera.get(part, {}))
            tables[part].pop("airlight", None)  # the background around the intruder knows better
        else:
            values = camera.get("sensor", {})
            tables.setdefault("sensor", {}).update({key: values[key] for key in SENSOR[part] if key in values})
    return "".join(toml_table(name, values) for name, values in tables.items() if values)


def scene_text(clip, method, tables, pose):
    if pose:
        aircraft, yaw, pitch, roll = pose["aircraft"], pose["yaw_deg"], pose["pitch_deg"], pose["roll_deg"]
    else:  # stands for what the search finds
        aircraft, yaw, pitch, roll = "738/738-Delta", 90, 0, 0
    sun = pose.get("sun") if pose else None
    azimuth, elevation = (sun["azimuth_deg"], sun["elevation_deg"]) if sun else SUN.get(clip, OTHER_SUN)
    view = 12 if clip.startswith("V_") else 41
    return (f'name = "s"\n[background]\nvideo = "unused.mp4"\n[lens]\nmodel = "pinhole"\nvertical_fov_deg = {view}\n'
            f"[light]\nsun_azimuth_deg = {azimuth}\nsun_elevation_deg = {elevation}\n"
            f'[[intruder]]\naircraft = "{aircraft}"\nyaw_deg = {yaw}\npitch_deg = {pitch}\nroll_deg = {roll}\n'
            f'waypoints_ned_m = [[100, 0, 0], [200, 0, 0]]\n'
            f'speed_mps = 50\n[composite]\nmethod = "{method}"\n' + tables)


def camera_of(program, clip, video, camera_file):
    if not os.path.exists(camera_file):
        profile = ["--profile", GROUND_PROFILE] if clip not in ONBOARD else []
        run([program, "--quiet", "calibrate", video, "-o", camera_file, *profile])
    with open(camera_file, "rb") as file:
        return tomllib.load(file)


def compare(arguments, shared, clip, number, stage, parts):
    """The comparison's folder; None where the clip is refused."""
    video, boxes, origin = place_of(shared, clip)
    camera = camera_of(arguments.program, clip, video, os.path.join(arguments.out, clip + ".camera.toml")) if parts else {}
    base = os.path.join(arguments.out, f"{number}")
    os.makedirs(base, exist_ok=True)
    scene = os.path.join(base, clip + ".toml")
    # The pose is searched once a clip: every stage shows the same aircraft in the same attitude.
    pose_file = os.path.join(arguments.out, clip + ".pose.json")
    pose = None
    if os.path.exists(pose_file):
        with open(pose_file) as file:
            pose = json.load(file)
    with open(scene, "w") as file:
        file.write(scene_text(clip, "chroma-key" if stage == "chroma-key" else "matte", tables_of(camera, parts), pose))
    comparison = os.path.join(base, clip)
    if os.path.exists(os.path.join(comparison, "patches")):
        return comparison
    print(f"{stage}: {clip}", file=sys.stderr, flush=True)
    # The onboard cameras look ahead; those on the ground look up at aircraft that fly level.
    level = ["--camera-pitch", "0"] if clip in ONBOARD else []
    kind = ["--helicopter"] if clip.startswith("V_HELICOPTER") and not pose else []
    process = subprocess.run([arguments.program, "--quiet", "compare", "--real", video, "--boxes", boxes, "--origin", str(origin),
                              "--scene", scene, "-o", comparison, "--frames", str(arguments.frames), "--overwrite",
                              "--no-match" if pose else "--match", *level, *kind],
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if process.returncode == 2:  # the clip cannot be compared; anything else is a fault of the program
        print(f"ablation: {clip} is left out: {process.stderr.strip()}", file=sys.stderr, flush=True)
        return None
    if process.returncode != 0:
        sys.exit(f"ablation: compare failed on {clip}:\n{process.stderr}")
    if not pose:
        with open(os.path.join(comparison, "comparison.json")) as file:
            found = json.load(file)["pose"]
        with open(pose_file, "w") as file:
            json.dump(found, file)
    return comparison


def judged(arguments, base, folders):
    """The verdict on a stage; leaves it as JSON and Markdown, and a sheet for people with its key."""
    judge = [sys.executable, "-B", os.path.join(HERE, "judge")]
    text = run([*judge, "verdict", *folders, "-o", base + ".json", "--pairs", str(arguments.pairs)])
    run([*judge, "sheet", *folders, "-o", base + ".png", "--seed", os.path.basename(base), "--overwrite"])  # one sheet does not give away another
    with open(base + ".md", "w") as file:
        file.write(text)
    with open(base + ".json") as file:
        return json.load(file)


def print_tables(verdicts):
    print(f"| stage | clips | {tables.JUDGES_HEAD}|---|---:|---|---|---|---|---|")
    for stage, verdict in verdicts:
        print(tables.judges_rows(verdict["judges"], f" {stage} | {len(verdict['clips'])} |"), end="")
    print("\n| stage | what alone tells most | the best by chance (1 draw of 20) |\n|---|---|---|")
    for stage, verdict in verdicts:
        best = verdict["single"]["best_by_chance"]
        print(f"| {stage} | {tables.single_words(verdict['single'], 3)} | {best['median']:.2f} ({best['high']:.2f}) |")
    print("\n" + tables.gaps_table([(stage, verdict["gaps"]) for stage, verdict in verdicts]), end="")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--frames", type=int, default=120, help="of each clip, from the first box of its longest shot on")
    parser.add_argument("--pairs", type=int, default=40, help="of each clip that the judges see at most, evenly over it")
    parser.add_argument("--held-back", action="store_true",
                        help="run the clips that nobody has looked at, and only those: once, when all else is done")
    parser.add_argument("--stages", nargs="+", metavar="STAGE", choices=[stage for stage, _ in STAGES],
                        help="only these of: " + ", ".join(f'"{stage}"' for stage, _ in STAGES))
    parser.add_argument("--clips", nargs="+", metavar="CLIP", help="only these of the list")
    arguments = parser.parse_args()
    shared = os.environ.get("AIRTRUTH_SHARED")
    if not shared:
        sys.exit("ablation: AIRTRUTH_SHARED is not set; expected the folder that holds footage/")
    clips = HELD_BACK if arguments.held_back else LOOKED_AT
    for clip in arguments.clips or []:
        if clip not in clips:
            sys.exit(f"ablation: {clip} is not in the list that is run")
    clips = [clip for clip in clips if not arguments.clips or clip in arguments.clips]
    os.makedirs(arguments.out, exist_ok=True)
    began = time.monotonic()
    verdicts = []
    for number, (stage, _) in enumerate(STAGES):
        if arguments.stages and stage not in arguments.stages:
            continue
        parts = [part for _, more in STAGES[1:number + 1] if more for part in more]
        made = [compare(arguments, shared, clip, number, stage, parts) for clip in clips]
        base = os.path.join(arguments.out, f"{number}")
        verdicts.append((stage, judged(arguments, base, [folder for folder in made if folder])))
    print_tables(verdicts)
    print(f"\n{time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
