#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Can a judge tell inserted aircraft from real ones, and which stage of realism takes that from it? ./dev ablation OUT

Needs clips of real aircraft with boxes (AIRTRUTH_SHARED/footage; their provenance stands there). For each clip: its camera
is calibrated, an aircraft is put beside the real one with each stage added to those before, and a judge is trained on the
other clips. Prints Markdown tables. What is there already is not made again.
"""

import argparse
import os
import subprocess
import sys
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
# clip, boxes' origin, aircraft, yaw (0: seen from behind), vertical view, sun azimuth and elevation
CLIPS = {
    "cumulus_a4": ("fixed-wing", 0, "c172/news", 5, 41, 150, 50),
    "overcast_b4": ("fixed-wing", 0, "c172/news", 175, 41, 0, 60),
    "V_AIRPLANE_001": ("ground-real", 1, "738/738-Delta", -60, 12, 0, 50),
    "V_AIRPLANE_002": ("ground-real", 1, "738/738-Delta", -75, 12, 0, 50),
    "V_AIRPLANE_003": ("ground-real", 1, "738/738-JAL", -80, 12, 0, 50),
    "V_AIRPLANE_008": ("ground-real", 1, "738/738-Belavia", 110, 12, 180, 30),
    "V_AIRPLANE_018": ("ground-real", 1, "738/738-Belavia", 120, 12, 180, 30),
    "V_AIRPLANE_035": ("ground-real", 1, "738/738-Belavia", 120, 12, 180, 30),
    "V_AIRPLANE_049": ("ground-real", 1, "c172/news", 150, 12, 180, 30),
}
# Each stage has the tables of those before it; None: another method.
STAGES = [("chroma-key", None), ("matte", []), ("+ shutter", ["shutter"]), ("+ air", ["air"]), ("+ optics", ["optics"]),
          ("+ noise", ["noise"]), ("+ codec (all)", ["codec"])]
NOISE = ("noise_gain", "noise_floor", "noise_correlation_px")


def run(command):
    process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if process.returncode != 0:
        sys.exit(f"ablation: {' '.join(command)} failed:\n{process.stderr}")
    return process.stdout


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
            keys = NOISE if part == "noise" else ("codec_step",)
            values = camera.get("sensor", {})
            tables.setdefault("sensor", {}).update({key: values[key] for key in keys if key in values})
    return "".join(toml_table(name, values) for name, values in tables.items() if values)


def scene_text(clip, method, tables):
    _, _, aircraft, yaw, view, azimuth, elevation = CLIPS[clip]
    return (f'name = "s"\n[background]\nvideo = "unused.mp4"\n[lens]\nmodel = "pinhole"\nvertical_fov_deg = {view}\n'
            f"[light]\nsun_azimuth_deg = {azimuth}\nsun_elevation_deg = {elevation}\n"
            f'[[intruder]]\naircraft = "{aircraft}"\nyaw_deg = {yaw}\nwaypoints_ned_m = [[100, 0, 0], [200, 0, 0]]\n'
            f'speed_mps = 50\n[composite]\nmethod = "{method}"\n' + tables)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--frames", type=int, default=120, help="of each clip, from its first box on")
    arguments = parser.parse_args()
    shared = os.environ.get("AIRTRUTH_SHARED")
    if not shared:
        sys.exit("ablation: AIRTRUTH_SHARED is not set; expected the folder that holds footage/")
    os.makedirs(arguments.out, exist_ok=True)
    program = arguments.program
    verdicts = []
    for number, (stage, _) in enumerate(STAGES):
        parts = [part for _, more in STAGES[1:number + 1] if more for part in more]
        folders = []
        for clip, (folder, origin, *_) in CLIPS.items():
            video = os.path.join(shared, "footage", folder, clip + ".mp4")
            boxes = (os.path.join(HERE, "..", "data", "real-aircraft", clip + ".csv") if folder == "fixed-wing"
                     else os.path.splitext(video)[0] + ".csv")
            camera_file = os.path.join(arguments.out, clip + ".camera.toml")
            if not os.path.exists(camera_file):
                run([program, "--quiet", "calibrate", video, "-o", camera_file])
            with open(camera_file, "rb") as file:
                camera = tomllib.load(file)
            base = os.path.join(arguments.out, f"{number}")
            os.makedirs(base, exist_ok=True)
            scene = os.path.join(base, clip + ".toml")
            with open(scene, "w") as file:
                file.write(scene_text(clip, "chroma-key" if stage == "chroma-key" else "matte", tables_of(camera, parts)))
            comparison = os.path.join(base, clip)
            if not os.path.exists(os.path.join(comparison, "patches.csv")):
                print(f"{stage}: {clip}", file=sys.stderr)
                run([program, "--quiet", "compare", "--real", video, "--boxes", boxes, "--origin", str(origin), "--scene", scene,
                     "-o", comparison, "--frames", str(arguments.frames), "--overwrite"])
            folders.append(comparison)
        verdicts.append((stage, run([program, "judge", *folders]).splitlines()))
    print("| stage | area under the curve | what alone tells most |\n|---|---|---|")
    for stage, lines in verdicts:
        telling = lines[lines.index("what alone tells most:") + 1:][:3]
        print(f"| {stage} | {lines[0].split(' curve ')[1].split(';')[0]} | "
              + ", ".join(" ".join(line.split()[:-1]) + " " + line.split()[-1] for line in telling) + " |")
    print("\n| clip | " + " | ".join(stage for stage, _ in verdicts) + " |\n|---|" + "---:|" * len(verdicts))
    for clip in CLIPS:
        cells = [next(line.split()[-1] for line in lines if line.split()[:1] == [clip]) for _, lines in verdicts]
        print(f"| {clip} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
