#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How fast airtruth renders, beside the paper's method and a plain transcode of the same clip: ./dev bench

Prints Markdown tables. Every contender is a whole process, started anew and timed from the outside; a round runs each
of them once, in turn, so that a slow minute of the machine falls on all of them.
"""

import argparse
import math
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import time

VIEW_DEG = 75
WIDTH, HEIGHT = 1280, 960
SPEED_MPS = 25
SPAN_M = 34.3  # of 738/738-Ryanair, seen from behind
FOCAL_PX = HEIGHT / 2 / math.tan(math.radians(VIEW_DEG / 2))

SCENE = """name = "{name}"
[background]
video = "{video}"
mask = "{mask}"
[lens]
model = "pinhole"
vertical_fov_deg = {view}
[camera]
position_ned_m = [0, 0, -150]
velocity_ned_mps = [{speed}, 0, 0]
[[intruder]]
id = "b737"
aircraft = "738/738-Ryanair"
waypoints_ned_m = [[{ahead}, 40, -170], [{far}, 40, -170]]
speed_mps = {speed}
[composite]
method = "{method}"
[output]
video = "{output}"
quality = 18
"""

REALISM = """
[shutter]
exposure_s = 0.008
readout_s = 0.016
[air]
extinction_per_km = [0.15, 0.17, 0.21]
[optics]
point_spread_px = 0.7
sharpening = 0.4
[sensor]
noise_gain = 4e-4
noise_floor = 2e-5
noise_correlation_px = 0.5
codec_step = 6
"""


def run(command, environment=None):
    """(wall seconds, CPU seconds, peak MiB, what it printed) of a process; ends the benchmark where it fails."""
    start = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - start
    if status != 0:
        sys.exit(f"benchmark: {' '.join(command)} failed:\n{output}")
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, output


class Bench:
    def __init__(self, program, folder, frames):
        self.program, self.folder, self.frames = program, os.path.abspath(folder), frames
        os.makedirs(self.folder, exist_ok=True)
        self.clip = self.path(f"flight-{frames}.mp4")
        self.mask = self.path("flight-mask.png")
        self.environment = dict(os.environ, XDG_CACHE_HOME=self.path("cache"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def make_clip(self):
        if os.path.exists(self.clip) and os.path.exists(self.mask):
            return
        print(f"making the clip: {self.frames} frames of {WIDTH}x{HEIGHT}", file=sys.stderr)
        run([self.program, "synth", "-o", self.clip, "--mask", self.mask, "--frames", str(self.frames), "--width",
             str(WIDTH), "--height", str(HEIGHT), "--fov", str(VIEW_DEG), "--speed", str(SPEED_MPS), "--overwrite"])

    def scene(self, size_px, method="matte", output="mp4", clip=None, realism=""):
        name = f"{method}_{size_px}" + ("_real" if realism else "")
        ahead = FOCAL_PX * SPAN_M / size_px
        with open(self.path(name + ".toml"), "w") as file:
            file.write(SCENE.format(name=name, video=clip or self.clip, mask=self.mask, view=VIEW_DEG, speed=SPEED_MPS,
                                    ahead=ahead, far=ahead + 100 * self.frames, method=method, output=output) + realism)
        return self.path(name + ".toml")

    def render(self, scene, *more):
        return run([self.program, "render", scene, "--out", self.path("out"), "--overwrite", "--timings", *more],
                   self.environment)

    def transcode(self):
        return run(["ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-i", self.clip, "-c:v", "libx264",
                    "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", self.path("transcoded.mp4")])

    def contenders(self):
        chroma = self.scene(40, "chroma-key", "avi")
        by_size = {size: self.scene(size) for size in (40, 100)}
        real = {size: self.scene(size, realism=REALISM) for size in (40, 100)}
        return {
            "(a) the paper's method, 40 px": lambda: self.render(chroma, "--no-cache"),
            "(b) render, 40 px": lambda: self.render(by_size[40], "--no-cache"),
            "(b) render, 100 px": lambda: self.render(by_size[100], "--no-cache"),
            "(b) render, 40 px, motion cached": lambda: self.render(by_size[40]),
            "(b) render, 100 px, motion cached": lambda: self.render(by_size[100]),
            "(b) render, 40 px, motion cached, all realism": lambda: self.render(real[40]),
            "(b) render, 100 px, motion cached, all realism": lambda: self.render(real[100]),
            "(c) ffmpeg, decode and encode": self.transcode,
        }

    def race(self, rounds):
        contenders = self.contenders()
        self.render(self.scene(40))  # fills the cache of motion, and the files' cache
        times = {name: [] for name in contenders}
        for number in range(rounds):
            for name, contender in contenders.items():
                print(f"round {number + 1} of {rounds}: {name}", file=sys.stderr)
                times[name].append(contender())
        return {name: [statistics.median(column) for column in zip(*[t[:3] for t in runs])]
                for name, runs in times.items()}


def print_race(medians, frames):
    paper = medians["(a) the paper's method, 40 px"][0]
    plain = medians["(c) ffmpeg, decode and encode"][0]
    print("| | wall s | frames/s | CPU s | peak MiB | (a) / it | it / (c) |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name, (wall, cpu, peak) in medians.items():
        print(f"| {name} | {wall:.2f} | {frames / wall:.1f} | {cpu:.2f} | {peak:.0f} | {paper / wall:.2f} | {wall / plain:.2f} |")


def print_stages(bench, sizes, rounds):
    names = ["read", "move", "render", "composite", "write"]
    print("\n| intruder px | " + " | ".join(names) + " | wall ms a frame |")
    print("|---:|" + "---:|" * (len(names) + 1))
    for size in sizes:
        scene = bench.scene(size)
        rows = []
        for _ in range(rounds):
            wall, _, _, output = bench.render(scene, "--no-cache")
            stages = [float(re.search(rf"\b{name} ([0-9.]+) ms", output).group(1)) for name in names]
            rows.append(stages + [1000 * wall / bench.frames])
        print(f"| {size} | " + " | ".join(f"{statistics.median(column):.2f}" for column in zip(*rows)) + " |")


def print_memory(bench):
    long_clip = bench.path("flight-3000.mp4")
    loops = max(1, 3000 // bench.frames)
    run(["ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-stream_loop", str(loops - 1), "-i", bench.clip,
         "-c", "copy", long_clip])
    # What the decoder and encoder hold at once varies from run to run by some per cent.
    short_peak = statistics.median(bench.render(bench.scene(40), "--no-cache")[2] for _ in range(5))
    runs = [bench.render(bench.scene(40, clip=long_clip), "--no-cache") for _ in range(3)]
    long_peak = statistics.median(run[2] for run in runs)
    wall = statistics.median(run[0] for run in runs)
    os.remove(long_clip)
    print(f"\nPeak memory: {short_peak:.0f} MiB at {bench.frames} frames, {long_peak:.0f} MiB at {loops * bench.frames} "
          f"({100 * (long_peak / short_peak - 1):+.1f} %, in {wall:.0f} s)")


def processor():
    with open("/proc/cpuinfo") as file:
        found = re.search(r"model name\s*: (.*)", file.read())
    return found.group(1) if found else platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the airtruth to measure")
    parser.add_argument("folder", help="where the clip and the results go")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--no-memory", action="store_true", help="leave out the run of 3,000 frames")
    arguments = parser.parse_args()
    if shutil.which("ffmpeg") is None:
        sys.exit("benchmark: ffmpeg is missing; ./dev setup installs it")
    bench = Bench(arguments.program, arguments.folder, arguments.frames)
    bench.make_clip()
    print(f"{os.cpu_count()} x {processor()}, {arguments.frames} frames of {WIDTH}x{HEIGHT}, medians of "
          f"{arguments.rounds} rounds\n")
    print_race(bench.race(arguments.rounds), arguments.frames)
    print_stages(bench, (5, 20, 100, 400), min(3, arguments.rounds))
    if not arguments.no_memory:
        print_memory(bench)


if __name__ == "__main__":
    main()
