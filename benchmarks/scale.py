#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How the cost of a data set grows with its sequences (docs/scaling.md): python3 benchmarks/scale.py AIRTRUTH FOLDER

1. Plans a catalogue of --sequences sequences of 30 frames over one virtual flight, builds every n-th of them so that
   --sample are made, and computes the cost of the rest from these.
2. Compares the CPU time of the sample with as many transcodes of its background by ffmpeg.
3. Fills sets of --many small sequences with links to a few that are built, and measures what reads whole sets.

Prints Markdown tables. CPU seconds are those of all threads, so that other load on the machine changes them little.
"""

import argparse
import os
import shutil
import subprocess
import sys
import time

BACKGROUND = """name = "scale"
seed = 1
[[background]]
name = "day"
flight = {{ seed = 21, frame_count = {flown}, width = {width}, height = {height}, cloud_cover = 0.4 }}
lens = {{ vertical_fov_deg = 75 }}
camera = {{ position_ned_m = [0, 0, -150], velocity_ned_mps = [25, 0, 0] }}
light = {{ sun_azimuth_deg = 140, sun_elevation_deg = 45 }}
[[random]]
name = "r{{index}}"
count = {count}
frame_count = {frames}
aircraft = {aircraft}
size_px = [6, {largest}]
azimuth_deg = [-25, 25]
elevation_deg = [-4, 20]
bank_deg = "type"
intruders = [1, 2]
negatives = 0.2
"""
# The types of catalogues/random.toml.
AIRCRAFT = ('["738/738-A*", "738/738-S*", "738/738-T*", "733/*", "c172/*", "c182/*", "pa-28/*", "DH82/*", "Cub/*", "b1900d/*", '
            '"centrair-101/*", "Spitfire/*", "Beechcraft-Staggerwing/*", "Diamond-Da42/*", "DR400/*", "Citation-Bravo/*"]')


def run(*command):
    """(wall seconds, CPU seconds, peak MiB, what it printed) of a process; ends the benchmark where it fails."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"benchmark: {' '.join(command)} failed:\n{output}")
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, output


class Scale:
    def __init__(self, program, folder):
        self.program, self.folder = program, os.path.abspath(folder)
        os.makedirs(self.folder, exist_ok=True)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def dataset(self, *arguments):
        return run(self.program, "dataset", *arguments)

    def catalogue(self, name, **values):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(BACKGROUND.format(**values))
        return self.path(name)

    def new(self, name):
        shutil.rmtree(self.path(name), ignore_errors=True)
        return self.path(name)


def plan_and_sample(scale, sequences, sample, frames):
    catalogue = scale.catalogue("large.toml", count=sequences, frames=frames, flown=frames, width=1280, height=960,
                                aircraft=AIRCRAFT, largest=160)
    _, cpu, peak, output = scale.dataset("plan", catalogue)
    print(f"plan of {sequences} sequences of {frames} frames: {cpu:.2f} s of CPU time, {peak:.0f} MiB\n  {output.splitlines()[-1]}\n")
    every = max(1, sequences // sample)
    out = scale.new("sample")
    # The flight and its motion are made with the first sequence alone, before anything is timed.
    scale.dataset("build", catalogue, "--out", out, "--only", "r000000")
    clock, cpu, peak, output = scale.dataset("work", catalogue, "--out", out, "--index", "1", "--of", str(every))
    made = int(output.split(" sequences made")[0].split()[-1])
    print("| | sequences | CPU s | CPU s a sequence | peak MiB |\n|---|---:|---:|---:|---:|")
    print(f"| sample, every {every}th | {made} | {cpu:.1f} | {cpu / made:.2f} | {peak:.0f} |")
    print(f"| computed for all | {sequences} | {cpu / made * sequences:.0f} | {cpu / made:.2f} | |\n")
    size = sum(os.path.getsize(os.path.join(where, name)) for where, _, names in os.walk(os.path.join(out, "sequences")) for name in names)
    print(f"{size / (made + 1) / 1e3:.0f} kB a sequence: {size / (made + 1) * sequences / 1e9:.1f} GB for all; {clock:.0f} s by the clock for the sample\n")
    return out, made, cpu


def transcodes(scale, out, made, cpu):
    if shutil.which("ffmpeg") is None:
        return
    clip = os.path.join(out, "backgrounds", "day.mp4")
    command = ("ffmpeg", "-v", "error", "-nostdin", "-y", "-i", clip, "-c:v", "libx264", "-preset", "veryfast", "-crf", "18",
               "-pix_fmt", "yuv420p", scale.path("transcoded.mp4"))
    one = min(run(*command)[1] for _ in range(3))
    print(f"{made} transcodes of the background: {made * one:.1f} s of CPU time; the sample took {cpu / (made * one):.2f} times as much\n")


def place_of(out, i, count, per_folder):
    return os.path.join(out, "sequences", f"{i // per_folder + 1:04}" if count > per_folder else "", f"r{i:06}")


def fill(scale, count, per_folder):
    """A set of `count` small sequences, of which four are built and the others are links to these."""
    catalogue = scale.catalogue("many.toml", count=count, frames=6, flown=8, width=160, height=120,
                                aircraft='["738/738-Ryanair", "c172/news"]', largest=40)
    out = scale.new("many")
    for i in range(4):
        scale.dataset("build", catalogue, "--out", out, "--only", f"r{i:06}", "--folder-size", str(per_folder))
    for i in range(4, count):
        shutil.copytree(place_of(out, i % 4, count, per_folder), place_of(out, i, count, per_folder), copy_function=os.link)
    return catalogue, out


def many(scale, counts, per_folder):
    commands = {
        "status": lambda catalogue, out: ("status", out),
        "build, all there": lambda catalogue, out: ("build", catalogue, "--out", out),
        "verify": lambda catalogue, out: ("verify", out),
        "report": lambda catalogue, out: ("report", out, "--out", scale.path("many.html"), "--overwrite"),
        "export, COCO": lambda catalogue, out: ("export", out, "--format", "coco", "--images", "none", "--out", scale.new("coco")),
        "export, YOLO with pictures": lambda catalogue, out: ("export", out, "--format", "yolo", "--out", scale.new("yolo")),
    }
    rows = {name: [] for name in commands}
    for count in counts:
        catalogue, out = fill(scale, count, per_folder)
        for name, command in commands.items():
            _, cpu, peak, _ = scale.dataset(*command(catalogue, out))
            rows[name].append(f"{cpu:.2f} | {1000 * cpu / count:.2f} | {peak:.0f}")
        print(f"report of {count}: {os.path.getsize(scale.path('many.html')) / 1e6:.1f} MB\n", file=sys.stderr)
    print("| 160x120, 6 frames each | " + " | ".join(f"{count}: CPU s | ms a sequence | peak MiB" for count in counts) + " |")
    print("|---|" + "---:|" * (3 * len(counts)))
    for name, cells in rows.items():
        print(f"| {name} | " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the airtruth to measure")
    parser.add_argument("folder", help="where the sets go; 1 GB")
    parser.add_argument("--sequences", type=int, default=10_000)
    parser.add_argument("--frames", type=int, default=30)
    parser.add_argument("--sample", type=int, default=60, help="0 leaves the parts 1 and 2 out")
    parser.add_argument("--many", type=int, nargs="*", default=[1000, 4000], help="sizes of the sets of part 3; none leaves it out")
    parser.add_argument("--per-folder", type=int, default=1000, help="sequences in a numbered folder of part 3")
    arguments = parser.parse_args()
    scale = Scale(os.path.abspath(arguments.program), arguments.folder)
    if arguments.sample > 0:
        transcodes(scale, *plan_and_sample(scale, arguments.sequences, arguments.sample, arguments.frames))
    if arguments.many:
        many(scale, arguments.many, arguments.per_folder)


if __name__ == "__main__":
    main()
