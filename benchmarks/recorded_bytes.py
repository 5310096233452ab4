#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Records what the program writes, so that a refactoring can be shown to change no byte. ./dev bytes OUT [--against OUT2]

Each case runs the program in a folder of its own and lists the SHA-256 of every artefact. A video is listed by the digest of
its decoded pictures (as ffmpeg decodes them). What differs from run to run by nature is left out: times, absolute paths,
checksums of files that hold those. With AIRTRUTH_SHARED the real clips are included. The list is OUT/bytes.json.

With --against, the lists of two folders are compared: every artefact that differs, is missing or is new is printed, and the
exit code is 1. Cases that are recorded already are not made again, so that an interrupted run goes on.
"""

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Keys of JSON objects whose values are measured times or follow from them.
TIMES = re.compile(r"seconds|frames_per_second|_time|created|threads")
# How many frames of a real clip are rendered.
REAL_FRAMES = 60
# Clips whose camera is calibrated, relative to AIRTRUTH_SHARED/footage.
CALIBRATED = ["fixed-wing/cumulus_a4.mp4", "gopro-karma/karma.mp4", "ground-real/V_AIRPLANE_018.mp4"]
REALISTIC = "fixed-wing/cumulus_a4.mp4"
COMMANDS = ["", "render", "synth", "motion", "calibrate", "mask", "lens", "aircraft", "overlay", "inspect", "compare",
            "dataset", "track", "evaluate", "evision", "demo"]


class Recorder:
    def __init__(self, program, out):
        self.program = os.path.abspath(program)
        self.out = os.path.abspath(out)
        self.cases = {}
        self.list = os.path.join(self.out, "bytes.json")
        os.makedirs(self.out, exist_ok=True)
        if os.path.exists(self.list):
            with open(self.list) as file:
                self.cases = json.load(file)

    def run(self, folder, *arguments):
        environment = dict(os.environ, XDG_CACHE_HOME=os.path.join(self.out, "cache"))
        process = subprocess.run([self.program, "--quiet", *arguments], cwd=folder, env=environment, text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        if process.returncode != 0:
            sys.exit(f"recorded_bytes: {' '.join(arguments)} exits with {process.returncode}:\n{process.stderr}")
        return process.stdout

    def record(self, name, make):
        """Runs make(folder), which returns the artefacts as {name: bytes or path}, unless the case is there already."""
        if name in self.cases:
            return
        print(name, file=sys.stderr, flush=True)
        folder = os.path.join(self.out, name)
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        artefacts = make(folder)
        self.cases[name] = {key: digest(value, folder) for key, value in sorted(artefacts.items())}
        with open(self.list + ".part", "w") as file:
            json.dump(self.cases, file, indent=1, sort_keys=True)
        os.replace(self.list + ".part", self.list)


def digest(value, folder):
    if isinstance(value, bytes):
        return hashlib.sha256(value).hexdigest()
    name = value.lower()
    if name.endswith((".mp4", ".mkv", ".avi")):
        pictures = subprocess.run(["ffmpeg", "-v", "error", "-i", value, "-f", "rawvideo", "-vsync", "0", "-"],
                                  stdout=subprocess.PIPE, check=True).stdout
        return hashlib.sha256(pictures).hexdigest()
    with open(value, "rb") as file:
        data = file.read()
    if name.endswith(".json"):
        data = json.dumps(without_times(json.loads(data)), sort_keys=True).encode()
    return hashlib.sha256(data.replace(os.path.dirname(folder).encode(), b"OUT")).hexdigest()


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(part) for key, part in value.items() if not TIMES.search(key)}
    return [without_times(part) for part in value] if isinstance(value, list) else value


def files_below(folder, skip=()):
    """Every file below a folder, but logs and what `skip` names."""
    result = {}
    for path, _, names in os.walk(folder):
        for name in names:
            if name not in skip and not name.endswith((".log", "_time.txt", "_time.value")):
                result[os.path.relpath(os.path.join(path, name), folder)] = os.path.join(path, name)
    return result


# sequence.json holds checksums of encoded files and the seconds of the run; its other contents are the scene's.
RECORDS = ("sequence.json", "tracker.json", "manifest.json", "dataset.json")


def write(folder, name, text):
    with open(os.path.join(folder, name), "w") as file:
        file.write(text)


def flight(recorder, folder, frames=60):
    recorder.run(folder, "synth", "-o", "flight.mp4", "--truth", "flight.csv", "--frames", str(frames), "--width", "640", "--height", "480")


def example(recorder, name):
    def make(folder):
        with open(os.path.join(ROOT, "examples", name)) as file:
            # Shorter than written, and without loss.
            text = re.sub(r'(?m)^frame_count = .*$', "", file.read())
        # The clip, of 30 frames a second, holds each time that the scene states.
        last_s = max(map(float, re.findall(r'(?m)^(?:cpa_)?time_s = ([0-9.]+)', text)), default=0)
        flight(recorder, folder, frames=max(60, int(30 * last_s) + 2))
        text = re.sub(r'(?m)^principal_point_px = .*$', "", text)
        write(folder, name, re.sub(r'(?m)^video = "(mp4|avi)".*$', 'video = "mkv"', text))
        recorder.run(folder, "render", name, "--out", "out")
        return {**files_below(os.path.join(folder, "out"), RECORDS), "flight.csv": os.path.join(folder, "flight.csv")}
    return make


REAL_SCENE = """name = "real"
[background]
video = "{video}"
frame_count = {frames}
[lens]
vertical_fov_deg = 41
[camera]
position_ned_m = [0, 0, -150]
velocity_ned_mps = [20, 0, 0]
[light]
sun_azimuth_deg = 150
sun_elevation_deg = 50
[[intruder]]
aircraft = "738/738-Delta"
waypoints_ned_m = [[280, -60, -175], [300, 60, -178]]
speed_mps = 60
[[intruder]]
id = "second"
aircraft = "c172/g-boix"
waypoints_ned_m = [[160, 40, -150], [170, -20, -152]]
speed_mps = 50
[output]
video = "mkv"
masks = true
[realism]
auto = true
fallback = true
"""


def realistic(recorder, footage):
    def make(folder):
        write(folder, "real.toml", REAL_SCENE.format(video=os.path.join(footage, REALISTIC), frames=REAL_FRAMES))
        recorder.run(folder, "render", "real.toml", "--out", "out")
        return files_below(os.path.join(folder, "out"), RECORDS)
    return make


def camera(recorder, video):
    def make(folder):
        recorder.run(folder, "calibrate", video, "-o", "camera.toml")
        recorder.run(folder, "motion", video, "-o", "motion.csv")
        return files_below(folder)
    return make


def quickstart(recorder):
    def make(folder):
        # The videos are without loss here, so that their pictures are the compositor's own.
        with open(os.path.join(ROOT, "catalogues", "quickstart.toml")) as file:
            write(folder, "quickstart.toml", file.read())
        recorder.run(folder, "dataset", "build", "quickstart.toml", "--out", "set")
        recorder.run(folder, "track", "set", "--tracker", "am3", "opencv-kcf", "-o", "results")
        recorder.run(folder, "evaluate", "set", "results/am3", "results/opencv-kcf", "-o", "evaluation")
        for form in ("coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot"):
            recorder.run(folder, "dataset", "export", "set", "--format", form, "--out", "as-" + form)
        recorder.run(folder, "dataset", "report", "set", "-o", "report.html")
        skip = RECORDS + ("index.html", "trackers.csv", "sequences.csv", "report.html")
        return {key: path for key, path in files_below(folder, skip).items() if not key.startswith("evaluation/")
                or key.endswith(("evaluation.json", "breakdown.csv"))}
    return make


def demo(recorder):
    def make(folder):
        recorder.run(folder, "demo", "--out", "demo")
        return files_below(os.path.join(folder, "demo"), RECORDS)
    return make


def words(recorder):
    def make(folder):
        result = {command or "airtruth": recorder.run(folder, *command.split(), "--help").encode() for command in COMMANDS}
        result["aircraft list"] = recorder.run(folder, "aircraft", "list").encode()
        return result
    return make


def compare(ours, others):
    different = 0
    for case in sorted(set(ours) | set(others)):
        mine, theirs = ours.get(case, {}), others.get(case, {})
        for key in sorted(set(mine) | set(theirs)):
            if mine.get(key) != theirs.get(key):
                state = "is missing" if key not in mine else "is new" if key not in theirs else "differs"
                print(f"{case}: {key} {state}")
                different += 1
    total = sum(len(case) for case in others.values())
    print(f"{total} artefacts in {len(others)} cases; {different} differ")
    return different


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--against", help="a folder recorded before")
    parser.add_argument("--only", help="a regular expression of the cases to record")
    arguments = parser.parse_args()
    recorder = Recorder(arguments.program, arguments.out)
    cases = {"help": words(recorder), "demo": demo(recorder), "quickstart": quickstart(recorder)}
    for name in sorted(os.listdir(os.path.join(ROOT, "examples"))):
        if name.endswith(".toml"):
            cases["example-" + name[:-5]] = example(recorder, name)
    shared = os.environ.get("AIRTRUTH_SHARED")
    if shared:
        footage = os.path.join(shared, "footage")
        for video in CALIBRATED:
            cases["camera-" + os.path.basename(video)[:-4]] = camera(recorder, os.path.join(footage, video))
        cases["realistic"] = realistic(recorder, footage)
    else:
        print("recorded_bytes: AIRTRUTH_SHARED is not set; the real clips are left out", file=sys.stderr)
    for name, make in cases.items():
        if not arguments.only or re.search(arguments.only, name):
            recorder.record(name, make)
    if arguments.against:
        with open(os.path.join(arguments.against, "bytes.json")) as file:
            others = json.load(file)
        chosen = {name for name in cases if not arguments.only or re.search(arguments.only, name)}
        return 1 if compare({name: case for name, case in recorder.cases.items() if name in chosen},
                            {name: case for name, case in others.items() if name in chosen}) else 0
    return 0


if __name__ == "__main__":
    sys.exit(main())
