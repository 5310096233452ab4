# SPDX-License-Identifier: Apache-2.0
"""SIGTERM and SIGINT end every command with 130 and leave nothing half-made: python3 interrupt_test.py AIRTRUTH [ROUNDS]

Each command is stopped at instants drawn by a seed; and in the middle of a read that never ends (a pipe that nobody writes),
which no look at a stop token can leave.
"""

import os
import random
import shutil
import sys
import tempfile
import time

import common
from common import Broken

TRACKER = "exec {python} {file} marker-{marker}"
# Says hello, and never answers again.
SILENT = "import sys, time\nprint('@@TRAX:hello trax.version=1 trax.image=path trax.region=rectangle', flush=True)\ntime.sleep(600)\n"


def commands(airtruth, data, out, marker):
    """Each command as a name, its words, and the folders or files that it makes."""
    tracker = TRACKER.format(python=sys.executable, file=f"{data}/silent.py", marker=marker)
    a = airtruth
    return [
        ("demo", [a, "demo", "--out", f"{out}/demo", "--frames", "60"]),
        ("render", [a, "render", f"{data}/long.toml", "--no-cache", "--out", out]),
        ("render auto", [a, "render", f"{data}/auto.toml", "--no-cache", "--out", out]),
        ("overlay", [a, "overlay", f"{data}/whole/long", "-o", f"{out}/o.mp4"]),
        ("motion", [a, "motion", f"{data}/clip.mkv", "-o", f"{out}/m.csv", "--plot", f"{out}/m.png", "--stabilised", f"{out}/s.mkv"]),
        ("calibrate", [a, "calibrate", f"{data}/clip.mkv", "-o", f"{out}/c.toml"]),
        ("mask", [a, "mask", f"{data}/clip.mkv", "-o", f"{out}/m.png"]),
        ("lens estimate", [a, "lens", "estimate", f"{data}/clip.mkv", "-o", f"{out}/l.yml"]),
        ("aircraft show", [a, "aircraft", "show", "738/738-Ryanair", "-o", f"{out}/a.png"]),
        ("aircraft list", [a, "aircraft", "list"]),
        ("synth", [a, "synth", "-o", f"{out}/s.mkv", "--width", "320", "--height", "240", "--frames", "200"]),
        ("dataset plan", [a, "dataset", "plan", f"{data}/set.toml"]),
        ("dataset build", [a, "dataset", "build", f"{data}/set.toml", "--out", f"{out}/set"]),
        ("dataset verify", [a, "dataset", "verify", f"{data}/set", "--deep"]),
        ("dataset report", [a, "dataset", "report", f"{data}/set", "-o", f"{out}/r.html"]),
        ("dataset export", [a, "dataset", "export", f"{data}/set", "-f", "coco", "-o", f"{out}/coco"]),
        ("dataset import", [a, "dataset", "import", f"{data}/coco", "-f", "coco", "-o", f"{out}/again"]),
        ("track", [a, "track", f"{data}/set", "-t", "am3", "-o", f"{out}/results"]),
        ("track silent", [a, "track", f"{data}/set", "-t", f"silent=trax:{tracker}", "-o", f"{out}/results"]),
        ("evaluate", [a, "evaluate", f"{data}/set", f"{data}/results/am3", "-o", f"{out}/evaluation", "--figures", "png"]),
        ("compare", [a, "compare", "--real", f"{data}/clip.mkv", "--boxes", f"{data}/boxes.csv", "--scene", f"{data}/long.toml",
                     "-o", f"{out}/compared"]),
        ("evision", [a, "evision", f"{data}/evision", "--airliner", "c172/news", "--frames", f"{out}/f.csv"]),
        ("inspect", [a, "inspect", f"{data}/whole/long", "--frame", "1", "-o", f"{out}/i.png"]),
    ]


def write_evision(data):
    """Annotations as E-Vision's: an aircraft that comes nearer, with a box in each frame."""
    xml, csv = "", "frame,camera_n_m,camera_e_m,camera_d_m,intruder_n_m,intruder_e_m,intruder_d_m\n"
    for k in range(1, 401):
        north = 1500 - 3 * k
        xml += (f"<frame_{k}><CameraPos_m><x>0.</x><y>0.</y><z>-150.</z></CameraPos_m><IntruderPos_m><x>{north}.</x><y>-20.</y>"
                f"<z>-150.</z></IntruderPos_m><Distance_m>{north}.</Distance_m><IntruderRect_pix><x>600</x><y>355</y>"
                f"<width>{9000 // north}</width><height>{3000 // north}</height></IntruderRect_pix></frame_{k}>\n")
        csv += f"{k},0,0,-150,{north},-20,-150\n"
    common.write(f"{data}/evision/groundtruth/1FNC172.xml", f'<?xml version="1.0"?>\n<opencv_storage>\n{xml}</opencv_storage>\n')
    common.write(f"{data}/evision/positions/1FNC172.csv", csv)


def inputs(airtruth, data):
    def airtruth_run(*words):
        common.run([airtruth, *words], codes=(0,))

    common.write(f"{data}/silent.py", SILENT)
    airtruth_run("synth", "-o", f"{data}/clip.mkv", "--width", "320", "--height", "240", "--frames", "40")
    long = common.SCENE.replace('"out"', '"long"').replace('model = "none"', 'model = "homography"')
    common.write(f"{data}/long.toml", long)
    common.write(f"{data}/auto.toml", long.replace('"long"', '"auto"') + "[realism]\nauto = true\nfallback = true\n")
    common.write(f"{data}/set.toml", common.CATALOGUE.replace("frame_count = 3", "frame_count = 30"))
    common.write(f"{data}/boxes.csv", "frame,x,y,width,height\n" + "".join(f"{i},{100 + i},100,12,8\n" for i in range(40)))
    write_evision(data)
    airtruth_run("render", f"{data}/long.toml", "--out", f"{data}/whole")
    airtruth_run("dataset", "build", f"{data}/set.toml", "--out", f"{data}/set")
    airtruth_run("dataset", "export", f"{data}/set", "-f", "coco", "-o", f"{data}/coco")
    airtruth_run("track", f"{data}/set", "-t", "am3", "-o", f"{data}/results")


def see_clean(done, name, out, whole, marker):
    if done.code not in (0, 2, 130) or (done.code == 130 and "interrupted" not in done.err):
        raise Broken(f"{name}: exit code {done.code} after a stop: {done.err[-400:]}")
    common.hold_to_rules(done, name, (0, 2, 130))
    common.gone(marker)
    if common.halves(out):
        raise Broken(f"{name}: half-made files are left: {common.halves(out)}")
    if whole:
        raise Broken(f"{name}: its inputs were changed: {whole}")


def wait_for_main(process):
    """Until the program has taken over its signals, the first thing that it does: before, they end it as any process."""
    until = time.monotonic() + common.HANG_S
    while process.poll() is None and time.monotonic() < until:
        try:
            with open(f"/proc/{process.pid}/status") as file:
                blocked = next(int(line.split()[1], 16) for line in file if line.startswith("SigBlk:"))
        except (OSError, StopIteration):
            return
        if blocked & (1 << (common.SIGNALS["SIGTERM"] - 1)):
            return
        time.sleep(0.005)


def stop_at_random(airtruth, root, data, rounds):
    dice = random.Random(5)
    before = common.state(data)
    stopped = over = 0
    for turn in range(rounds):
        for name, words in commands(airtruth, data, "{out}", "{marker}"):
            out = os.path.join(root, f"out-{turn}")
            marker = f"{os.getpid()}-{turn}"
            shutil.rmtree(out, ignore_errors=True)
            os.makedirs(out)
            which = dice.choice(list(common.SIGNALS))
            process = common.start([w.replace("{out}", out).replace("{marker}", marker) for w in words],
                                   env=common.environment(f"{root}/cache-{turn}"))
            wait_for_main(process)
            time.sleep(dice.uniform(0, 1.5) ** 2)
            process.send_signal(common.SIGNALS[which])
            done = common.end(process, f"{name} after {which}")
            stopped += done.code == 130
            over += done.code != 130
            see_clean(done, f"{name} after {which}", out, None, marker)
        if common.difference(before, common.state(data)):
            raise Broken(f"inputs were changed: {common.difference(before, common.state(data))}")
    print(f"{stopped} runs of {len(commands(airtruth, data, '', ''))} commands ended with 130, {over} were over before; nothing half-made")


def wait_for_reader(process, pipe):
    """Until the process has the pipe open, or is over; the limit only stops a hang."""
    until = time.monotonic() + common.HANG_S
    while process.poll() is None and time.monotonic() < until:
        try:
            files = [os.readlink(f"/proc/{process.pid}/fd/{n}") for n in os.listdir(f"/proc/{process.pid}/fd")]
        except OSError:
            files = []
        if pipe in files:
            return
        time.sleep(0.02)


def stop_in_a_read(airtruth, root, data):
    """Reading from a pipe that nobody writes: the stop token is never looked at."""
    pipe = f"{data}/pipe"
    os.makedirs(f"{data}/piped/sequences/x", exist_ok=True)
    os.mkfifo(pipe)
    held = os.open(pipe, os.O_RDWR)  # so that opening it for reading does not wait, and reading does
    scene = common.write(f"{data}/piped.toml", common.SCENE.replace("clip.mkv", "pipe"))
    masked = common.write(f"{data}/masked.toml", common.SCENE.replace('video = "clip.mkv"', 'video = "clip.mkv"\nmask = "pipe"'))
    cases = [["render", pipe], ["render", scene], ["render", masked], ["motion", pipe, "-o", "m.csv"], ["calibrate", pipe, "-o", "c.toml"],
             ["mask", pipe, "-o", "m.png"], ["lens", "estimate", pipe], ["dataset", "plan", pipe],
             ["dataset", "build", pipe, "--out", "set"], ["dataset", "import", pipe, "-f", "csv", "-o", "again"],
             ["track", pipe, "-t", "am3", "--init", "1,1,9,9", "-o", "results"],
             ["compare", "--real", f"{data}/clip.mkv", "--boxes", pipe, "--scene", scene, "-o", "compared"]]
    for i, words in enumerate(cases):
        out = os.path.join(root, f"piped-{i}")
        os.makedirs(out)
        process = common.start([airtruth, *words], cwd=out, env=common.environment(f"{root}/cache"))
        wait_for_reader(process, pipe)
        process.terminate()
        done = common.end(process, f"{words} on a pipe")
        if done.code != 130 or common.errors_of(done) != ["airtruth: error: interrupted; no half-written file is left behind"]:
            raise Broken(f"{words} on a pipe that nobody writes: exit code {done.code}: {done.err[-400:]}")
        if common.halves(out):
            raise Broken(f"{words}: half-made files are left: {common.halves(out)}")
    os.close(held)
    print(f"{len(cases)} commands ended with 130 in a read that never ends")


def body():
    airtruth = os.path.abspath(sys.argv[1])
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    with tempfile.TemporaryDirectory(prefix="airtruth_interrupt_") as root:
        data = os.path.join(root, "data")
        inputs(airtruth, data)
        stop_in_a_read(airtruth, root, data)
        os.unlink(f"{data}/pipe")
        stop_at_random(airtruth, root, data, rounds)


if __name__ == "__main__":
    common.main(body)
