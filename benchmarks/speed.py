#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How fast airtruth is, beside the paper's method and a plain transcode of the same clip: ./dev bench

Prints Markdown tables. Every contender is a whole process, started anew and timed from the outside, in wall-clock and in CPU
seconds. A round runs each contender once, in turn, so that a slow minute of the machine falls on all of them; a ratio is
formed within each round, and the median of the rounds' ratios is printed.

--check compares the ratios with those of benchmarks/speed.json and exits with 1 where one is more than 10 % above: for
people to run before a release, on an idle machine. --store writes that file.
"""

import argparse
import fnmatch
import json
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import time

import speed_inputs as inputs

STORED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "speed.json")
MAX_RISE = 1.10  # of a ratio over the stored one: medians of five rounds differ by up to 5 % on a shared machine
PAPER = "paper's method, flight, 40 px"
PAPER_ROUNDS = 3  # it takes a minute, and is an order of magnitude away from the others
MEMORY_SIZES = (300, 3000)  # frames
ENCODER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "src", "picture", "video", "writer.cpp")


def own_encoder():
    """ffmpeg's options for the settings of airtruth's own encoder, read from its source: a transcode with them differs
    from a render in nothing but the intruder."""
    with open(ENCODER, encoding="utf-8") as opened:
        source = opened.read()
    threads = re.search(r"kX264Threads = (\d+);", source).group(1)
    settings = re.search(r'kX264Settings = "([^"]+)";', source).group(1)
    return "-threads", threads, "-x264-params", settings


def run(commands, environment=None):
    """(wall seconds, CPU seconds, peak MiB, output) of commands, as many side by side as there are cores. Ends the
    benchmark where one fails."""
    start = time.monotonic()
    waiting, running, outputs = list(commands), {}, []
    cpu, peak = 0.0, 0.0
    while waiting or running:
        while waiting and len(running) < os.cpu_count():
            log = open(os.path.join("/tmp", f"airtruth-bench-{os.getpid()}-{len(waiting)}.log"), "w+")
            process = subprocess.Popen(waiting[0], stdout=log, stderr=subprocess.STDOUT, env=environment)
            running[process.pid] = (waiting.pop(0), log)
        pid, status, usage = os.wait3(0)
        command, log = running.pop(pid)
        log.seek(0)
        outputs.append(log.read())
        log.close()
        os.remove(log.name)
        if status != 0:
            sys.exit(f"benchmark: {' '.join(command)} failed:\n{outputs[-1]}")
        cpu += usage.ru_utime + usage.ru_stime
        peak = max(peak, usage.ru_maxrss / 1024)
    return time.monotonic() - start, cpu, peak, "".join(outputs)


class Contender:
    """A command with the baseline that it is measured against, and the frames that it makes."""

    def __init__(self, run_once, baseline, frames, max_rounds=None):
        self.run_once, self.baseline, self.frames, self.max_rounds = run_once, baseline, frames, max_rounds
        self.rounds = []  # (wall s, CPU s, peak MiB)


class Bench:
    def __init__(self, program, folder, frames):
        self.program, self.folder, self.frames = os.path.abspath(program), os.path.abspath(folder), frames
        os.makedirs(self.folder, exist_ok=True)
        self.clips = inputs.make_clips(self.program, self.folder, frames)
        self.environment = dict(os.environ, XDG_CACHE_HOME=self.path("cache"))

    def path(self, name):
        return os.path.join(self.folder, name)

    def airtruth(self, *arguments, environment=None):
        return run([[self.program, *arguments]], environment or self.environment)

    def scene(self, clip, size_px, **more):
        return inputs.write_scene(self.folder, clip, self.clips[clip], size_px, self.frames, **more)

    def render(self, scene, *more, environment=None):
        return self.airtruth("render", scene, "--out", self.path("out"), "--overwrite", "--timings", *more,
                             environment=environment)

    def render_without_motion(self, scene):
        """A render of a new clip with an aircraft that was used before: no motion is known, the ambient occlusion is."""
        cache = self.path("cache-without-motion")
        shutil.rmtree(os.path.join(cache, "airtruth", "motion"), ignore_errors=True)
        return self.render(scene, environment=dict(os.environ, XDG_CACHE_HOME=cache))

    def rendering(self, clip, size_px, cached, **more):
        scene = self.scene(clip, size_px, **more)
        return lambda: (self.render if cached else self.render_without_motion)(scene)

    def transcode(self, clip, frames=None, settings=()):
        length = ["-frames:v", str(frames)] if frames else []
        return inputs.ffmpeg("-i", clip, *length, "-c:v", "libx264", "-preset", "veryfast", *settings, "-crf", "18", "-pix_fmt",
                             "yuv420p", self.path(f"transcoded-{time.monotonic_ns()}.mp4"))

    def transcodes(self, clip, count=1, frames=None, settings=()):
        result = run([self.transcode(clip, frames, settings) for _ in range(count)])
        for name in os.listdir(self.folder):
            if name.startswith("transcoded-"):
                os.remove(self.path(name))
        return result

    def build_set(self, catalogue):
        shutil.rmtree(self.path("set"), ignore_errors=True)
        return self.airtruth("dataset", "build", catalogue, "--out", self.path("set"))

    def on_clip(self, clip):
        """The contenders that render over one clip: baseline and renders."""
        base = f"ffmpeg, {clip}"
        frames = self.frames
        rows = {base: Contender(lambda: self.transcodes(self.clips[clip]), base, frames)}
        rows[f"{base}, airtruth's settings"] = Contender(
            lambda: self.transcodes(self.clips[clip], settings=own_encoder()), base, frames)
        for size in (40, 100):
            for cached, word in ((False, "motion unknown"), (True, "motion cached")):
                rows[f"render, {clip}, {size} px, {word}"] = Contender(self.rendering(clip, size, cached), base, frames)
        rows[f"render, {clip}, 100 px, all realism"] = Contender(
            self.rendering(clip, 100, True, realism=True), f"render, {clip}, 100 px, motion cached", frames)
        return rows

    def contenders(self):
        flight = self.clips["flight"]
        paper = self.scene("flight", 40, method="chroma-key", output="avi")
        start = self.scene("one", 40)
        catalogue = inputs.write_catalogue(self.folder, flight)
        set_frames = inputs.SET_SEQUENCES * inputs.SET_FRAMES
        rows = self.on_clip("flight")
        if "real" in self.clips:
            rows.update(self.on_clip("real"))
        base = "ffmpeg, flight"
        rows[PAPER] = Contender(lambda: self.render(paper, "--no-cache"), base, self.frames, PAPER_ROUNDS)
        rows["24 transcodes"] = Contender(
            lambda: self.transcodes(flight, inputs.SET_SEQUENCES, inputs.SET_FRAMES), "24 transcodes", set_frames)
        rows["24-video data set"] = Contender(lambda: self.build_set(catalogue), "24 transcodes", set_frames)
        rows["virtual flight"] = Contender(
            lambda: run([inputs.flight_command(self.program, self.path("synth.mp4"), self.path("synth.png"), 100)]), base, 100)
        rows["calibrate, 300 frames of 640x480"] = Contender(
            lambda: self.airtruth("calibrate", self.clips["small"], "-o", self.path("camera.toml"), "--overwrite"), base, 300)
        rows["start of a sequence (one frame)"] = Contender(lambda: self.render(start), base, 1)
        return rows

    def race(self, rounds, pattern):
        every = self.contenders()
        chosen = {name for name in every if fnmatch.fnmatch(name, pattern)}
        chosen |= {every[name].baseline for name in chosen} | {every[every[name].baseline].baseline for name in chosen}
        rows = {name: row for name, row in every.items() if name in chosen}
        for name, row in rows.items():  # not counted: fills the program's caches, and those of files
            if name != PAPER:
                row.run_once()
                if "motion unknown" in name:
                    self.rendering(name.split(", ")[1], 40, True)()
        for number in range(rounds):
            for name, row in rows.items():
                if number < (row.max_rounds or rounds):
                    print(f"round {number + 1} of {rounds}: {name}", file=sys.stderr)
                    row.rounds.append(row.run_once()[:3])
        return rows


def ratios(rows, name):
    """Medians over the rounds of a contender's wall and CPU time over its baseline's."""
    pairs = list(zip(rows[name].rounds, rows[rows[name].baseline].rounds))
    return tuple(statistics.median(own[part] / base[part] for own, base in pairs) for part in (0, 1))


def print_race(rows):
    print("| | wall s | CPU s | CPU ms a frame | frames/s | peak MiB | wall ratio | CPU ratio | to |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|---|")
    for name, row in rows.items():
        wall, cpu, peak = (statistics.median(column) for column in zip(*row.rounds))
        of_wall, of_cpu = ratios(rows, name)
        print(f"| {name} | {wall:.2f} | {cpu:.2f} | {1000 * cpu / row.frames:.1f} | {row.frames / wall:.1f} | {peak:.0f} | "
              f"{of_wall:.2f} | {of_cpu:.2f} | {row.baseline} |")
    render = "render, flight, 40 px, motion unknown"
    if PAPER in rows and render in rows:
        pairs = list(zip(rows[PAPER].rounds, rows[render].rounds))
        wall, cpu = (statistics.median(paper[part] / own[part] for paper, own in pairs) for part in (0, 1))
        print(f"\nrender, 40 px, motion unknown, is {wall:.1f} times faster than the paper's method ({cpu:.1f} in CPU time).")


def print_stages(bench, sizes, rounds):
    """CPU milliseconds a frame by stage, as --timings prints them."""
    table = {}
    for size in sizes:
        scene = bench.scene("flight", size)
        outputs = [bench.render_without_motion(scene)[3] for _ in range(rounds)]
        lines = [re.search(r"CPU time a frame:(.*)", text).group(1) for text in outputs]
        found = [dict(re.findall(r"(\w[\w ]*?) ([0-9.]+) ms", line)) for line in lines]
        table[size] = {name: statistics.median(float(one[name]) for one in found) for name in found[0]}
    names = list(next(iter(table.values())))
    print("\nCPU ms a frame in each stage:\n\n| intruder px | " + " | ".join(names) + " |")
    print("|---:|" + "---:|" * len(names))
    for size, row in table.items():
        print(f"| {size} | " + " | ".join(f"{row[name]:.2f}" for name in names) + " |")


def print_memory(bench):
    """Peak memory by the number of frames, of a render and of the plain transcode."""
    peaks = {}
    for frames in MEMORY_SIZES:
        clip = bench.path(f"flight-long-{frames}.mp4")
        loops = -(-frames // bench.frames)
        run([inputs.ffmpeg("-stream_loop", str(loops - 1), "-i", bench.clips["flight"], "-c", "copy", "-frames:v",
                           str(frames), clip)])
        scene = inputs.write_scene(bench.folder, "flight", clip, 40, frames)
        peaks[frames] = statistics.median(bench.render(scene, "--no-cache")[2] for _ in range(5))
        os.remove(clip)
    short, long = MEMORY_SIZES
    print(f"\nPeak memory: {peaks[short]:.0f} MiB at {short} frames, {peaks[long]:.0f} MiB at {long} "
          f"({100 * (peaks[long] / peaks[short] - 1):+.1f} %; medians of five)")


def check(rows):
    """1 where a ratio is more than 10 % above the stored one, else 0; prints each that is."""
    if not os.path.exists(STORED):
        sys.exit(f"benchmark: {STORED} is missing; --store writes it")
    with open(STORED) as file:
        stored = json.load(file)
    worse = 0
    for name in rows:
        for kind, value in zip(("wall", "cpu"), ratios(rows, name)):
            before = stored.get(name, {}).get(kind)
            if before is None:
                print(f"check: {name}: no stored ratio ({kind})")
            elif value > before * MAX_RISE:
                worse = 1
                print(f"check: {name}: {kind} ratio {value:.2f}, stored {before:.2f}")
    print("check: " + ("slower than stored" if worse else "no ratio is more than 10 % above the stored one"))
    return worse


def store(rows):
    table = {}
    if os.path.exists(STORED):
        with open(STORED) as file:
            table = json.load(file)
    for name in rows:
        wall, cpu = ratios(rows, name)
        table[name] = {"wall": round(wall, 3), "cpu": round(cpu, 3)}
    with open(STORED, "w") as file:
        json.dump(table, file, indent=1)
        file.write("\n")


def processor():
    with open("/proc/cpuinfo") as file:
        found = re.search(r"model name\s*: (.*)", file.read())
    return found.group(1) if found else platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the airtruth to measure")
    parser.add_argument("folder", help="where clips and results go")
    parser.add_argument("--rounds", type=int, default=5, help="rounds (5)")
    parser.add_argument("--frames", type=int, default=300, help="frames of the clips at 1280x960 (300)")
    parser.add_argument("--only", default="*", metavar="PATTERN", help="contenders whose name fits (* and ?), and their baselines")
    parser.add_argument("--no-stages", action="store_true", help="leave out the table of stages")
    parser.add_argument("--no-memory", action="store_true", help="leave out the peak memory of 3,000 frames")
    parser.add_argument("--check", action="store_true", help="exit with 1 where a ratio is 10 %% above the stored one")
    parser.add_argument("--store", action="store_true", help="write the ratios to benchmarks/speed.json")
    arguments = parser.parse_args()
    if shutil.which("ffmpeg") is None:
        sys.exit("benchmark: ffmpeg is missing; ./dev setup installs it")
    bench = Bench(arguments.program, arguments.folder, arguments.frames)
    print(f"{os.cpu_count()} x {processor()}, {arguments.frames} frames of {inputs.WIDTH}x{inputs.HEIGHT}, medians of "
          f"{arguments.rounds} rounds\n")
    rows = bench.race(arguments.rounds, arguments.only)
    print_race(rows)
    if not arguments.no_stages:
        print_stages(bench, (5, 20, 40, 100, 400), min(3, arguments.rounds))
    if not arguments.no_memory:
        print_memory(bench)
    if arguments.store:
        store(rows)
    return check(rows) if arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
