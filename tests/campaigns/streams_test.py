# SPDX-License-Identifier: Apache-2.0
"""Standard streams that are closed, full or read by nobody; disks that are full and folders that may not be written:
python3 streams_test.py AIRTRUTH"""

import itertools
import os
import shutil
import subprocess
import sys
import tempfile

import common
from common import Broken


def closing(files):
    def close():
        for file in files:
            os.close(file)

    return close


def render(airtruth, data, out):
    return [airtruth, "render", f"{data}/scene.toml", "--no-cache", "--overwrite", "--out", out]


def closed_streams(airtruth, root, data):
    """No file of the output may get the number of a stream: a message would be written into it."""
    plain = os.path.join(root, "plain")
    common.run(render(airtruth, data, plain), codes=(0,))
    expected = common.state(plain)
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    for count in (1, 2, 3):
        for files in itertools.combinations((0, 1, 2), count):
            out = os.path.join(root, "closed")
            shutil.rmtree(out, ignore_errors=True)
            code = subprocess.run(render(airtruth, data, out), preexec_fn=closing(files), timeout=common.HANG_S, **quiet).returncode
            if code != 0 or common.difference(expected, common.state(out)):
                raise Broken(f"with {files} closed: exit code {code}, differs in {common.difference(expected, common.state(out))}")
    # An error goes nowhere, and is one all the same.
    code = subprocess.run([airtruth, "render", "/nowhere.toml"], preexec_fn=closing((0, 1, 2)), timeout=common.HANG_S, **quiet).returncode
    if code != 2:
        raise Broken(f"an error with all streams closed: exit code {code}")
    print("streams closed at the start, in all 7 ways: the same files")


def with_output(words, output, error=subprocess.PIPE):
    process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=output, stderr=error)
    err = process.communicate(timeout=common.HANG_S)[1]
    return common.Done(process.returncode, "", (err or b"").decode(errors="replace"))


def printing(airtruth, data):
    return [[airtruth, "--help"], [airtruth, "--version"], [airtruth, "render", "--help"], [airtruth, "aircraft", "list"],
            [airtruth, "aircraft", "show", "c172/news"], [airtruth, "dataset", "plan", f"{data}/set.toml"],
            [airtruth, "synth", "-o", f"{data}/again.mkv", "--width", "64", "--height", "64", "--frames", "2", "--overwrite"]]


def closed_pipe(airtruth, data):
    """Who reads no more wants no more: that is no error, and nothing of it is on standard error, where warnings of the input may stand."""
    for words in printing(airtruth, data):
        reading, writing = os.pipe()
        os.close(reading)
        done = with_output(words, writing)
        os.close(writing)
        errors = [line for line in done.err.splitlines() if not line.startswith("airtruth: warning: ")]
        if done.code != 0 or errors:
            raise Broken(f"{words} into a closed pipe: exit code {done.code}: {done.err}")
        reading, writing = os.pipe()
        os.close(reading)
        done = with_output(words, subprocess.DEVNULL, writing)
        os.close(writing)
        if done.code != 0:
            raise Broken(f"{words} with standard error into a closed pipe: exit code {done.code}")
    reading, writing = os.pipe()
    os.close(reading)
    done = with_output([airtruth, "render", "/nowhere.toml"], subprocess.DEVNULL, writing)
    os.close(writing)
    if done.code != 2:
        raise Broken(f"an error into a closed pipe: exit code {done.code}")
    print("output into a closed pipe: the run goes on, and ends well")


def full_output(airtruth, data):
    for words in printing(airtruth, data):
        with open("/dev/full", "wb") as full:
            done = common.hold_to_rules(with_output(words, full), f"{words} > /dev/full", (2,))
        if "standard output" not in done.err or "No space left" not in done.err:
            raise Broken(f"{words} > /dev/full: {done.err}")
        with open("/dev/full", "wb") as full:
            done = with_output([airtruth, "render", "/nowhere.toml"], subprocess.DEVNULL, full)
        if done.code != 2:
            raise Broken(f"an error into /dev/full: exit code {done.code}")
    print("standard output on a full disk: one line of error, code 2")


def writers(airtruth, data, out):
    """Each command that writes, with the place where it does."""
    a = airtruth
    return [
        render(a, data, out),
        [a, "demo", "--out", f"{out}/demo", "--frames", "4"],
        [a, "synth", "-o", f"{out}/s.mkv", "--truth", f"{out}/s.csv", "--mask", f"{out}/s.png", "--width", "640", "--height", "480",
         "--frames", "20"],
        [a, "motion", f"{data}/clip.mkv", "-o", f"{out}/m.csv", "--stabilised", f"{out}/t.mkv"],
        [a, "calibrate", f"{data}/clip.mkv", "-o", f"{out}/c.toml"],
        [a, "overlay", f"{data}/whole/out", "-o", f"{out}/o.mkv"],
        [a, "inspect", f"{data}/whole/out", "--frame", "1", "-o", f"{out}/i.png"],
        [a, "aircraft", "show", "c172/news", "-o", f"{out}/a.png"],
        [a, "dataset", "build", f"{data}/set.toml", "--out", f"{out}/set"],
        [a, "dataset", "report", f"{data}/set", "-o", f"{out}/r.html"],
        [a, "dataset", "export", f"{data}/set", "-f", "coco", "-o", f"{out}/coco"],
        [a, "dataset", "export", f"{data}/set", "-f", "aot", "-o", f"{out}/aot"],
        [a, "dataset", "submit", f"{data}/set.toml", "--slurm", "--dry-run", "--out", f"{out}/jobs"],
        [a, "track", f"{data}/set", "-t", "opencv-mil", "-o", f"{out}/results"],
        [a, "evaluate", f"{data}/set", f"{data}/results/opencv-mil", "-o", f"{out}/evaluation"],
    ]


def full_disk(airtruth, root, data):
    place = os.path.join(root, "small-disk")
    os.mkdir(place)
    for room_kb in (16, 64):
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={room_kb}k", "tmpfs", place], capture_output=True, check=False)
        if mounted.returncode != 0:
            print("full disk: skipped, no tmpfs can be mounted")
            return
        try:
            refused = 0
            for words in writers(airtruth, data, place):
                # A build and a run of trackers go on with the rest, and say 1 for what failed.
                codes = (0, 1, 2) if words[1:3] == ["dataset", "build"] or words[1] == "track" else (0, 2)
                done = common.run(words, f"{words[1:3]} on a disk of {room_kb} kB", codes, env=common.environment(f"{root}/cache"))
                if done.code != 0 and "No space left" not in done.err:
                    raise Broken(f"{words[1:3]} on a full disk: {done.err}")
                refused += done.code != 0
                if common.halves(place):
                    raise Broken(f"{words[1:3]} on a full disk leaves {common.halves(place)}")
                for name in os.listdir(place):
                    path = os.path.join(place, name)
                    shutil.rmtree(path) if os.path.isdir(path) else os.unlink(path)
        finally:
            subprocess.run(["umount", place], check=False)
        print(f"a disk of {room_kb} kB: {refused} of {len(writers(airtruth, data, place))} commands said that it is full; nothing half-made")


def no_permission(airtruth, root, data):
    """A folder that may be read and not written, as root too: a mount that is read-only."""
    place = os.path.join(root, "read-only")
    os.mkdir(place)
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "ro,size=64k", "tmpfs", place], capture_output=True, check=False).returncode != 0:
        print("no permission: skipped, no tmpfs can be mounted")
        return
    try:
        for words in writers(airtruth, data, place):
            codes = (1, 2) if words[1:3] == ["dataset", "build"] or words[1] == "track" else (2,)
            common.run(words, f"{words[1:3]} where nothing may be written", codes, env=common.environment(f"{root}/cache"))
    finally:
        subprocess.run(["umount", place], check=False)
    # A cache that may not be written is done without.
    cache = os.path.join(root, "no-cache")
    common.write(cache, "a file where a folder should be")
    common.run([airtruth, "render", f"{data}/moving.toml", "--out", f"{root}/cached"], "a cache that may not be written", (0,),
               env=common.environment(cache))
    print("a folder that may not be written: one line of error, code 2")


def unreadable(airtruth, root, data):
    """Files that may not be read, by a user who is not root."""
    setpriv = shutil.which("setpriv")
    if os.getuid() != 0 or not setpriv:
        print("files that may not be read: skipped, not run as root with setpriv")
        return
    as_nobody = [setpriv, "--reuid=65534", "--regid=65534", "--clear-groups"]
    if subprocess.run([*as_nobody, airtruth, "--version"], capture_output=True, check=False).returncode != 0:
        print("files that may not be read: skipped, another user cannot run the program from here")
        return
    os.chmod(root, 0o755)
    home = os.path.join(root, "home")
    os.makedirs(home)
    os.chmod(home, 0o777)
    for name in ("scene.toml", "clip.mkv", "set.toml"):
        os.chmod(f"{data}/{name}", 0)
        words = [airtruth, *{"scene.toml": ["render", f"{data}/scene.toml"], "clip.mkv": ["mask", f"{data}/clip.mkv", "-o", "m.png"],
                             "set.toml": ["dataset", "plan", f"{data}/set.toml"]}[name]]
        done = common.run([*as_nobody, *words], f"{words} unreadable", (2,), cwd=home, env=common.environment(home))
        os.chmod(f"{data}/{name}", 0o644)
        if "Permission denied" not in done.err:
            raise Broken(f"{words} unreadable: {done.err}")
    print("3 files that may not be read: one line of error, code 2")


def body():
    airtruth = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="airtruth_streams_") as root:
        data = os.path.join(root, "data")
        common.write(f"{data}/scene.toml", common.SCENE)
        common.write(f"{data}/moving.toml", common.SCENE.replace('model = "none"', 'model = "homography"'))
        common.write(f"{data}/set.toml", common.CATALOGUE)

        def prepare(*words):
            common.run([airtruth, *words], codes=(0,))

        prepare("synth", "-o", f"{data}/clip.mkv", "--width", "96", "--height", "64", "--frames", "8")
        prepare("render", f"{data}/scene.toml", "--out", f"{data}/whole")
        prepare("dataset", "build", f"{data}/set.toml", "--out", f"{data}/set")
        prepare("track", f"{data}/set", "-t", "opencv-mil", "-o", f"{data}/results")
        closed_streams(airtruth, root, data)
        closed_pipe(airtruth, data)
        full_output(airtruth, data)
        full_disk(airtruth, root, data)
        no_permission(airtruth, root, data)
        unreadable(airtruth, root, data)


if __name__ == "__main__":
    common.main(body)
