# SPDX-License-Identifier: Apache-2.0
"""What the campaigns share: small inputs, runs that are held to the rules for outcomes, and the state of a folder.

The rules: a run ends by itself, never by a signal that nobody sent; its code is 0, 2 with one line of error that says what is
wrong, 130 after an interrupt, or 1 where a check (verify) found something; never the 1 of a fault of airtruth.
"""

import argparse
import hashlib
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

HANG_S = 240  # far beyond what any run here takes, on a machine of two busy cores
FAULT = "a fault of airtruth"

CATALOGUE = """name = "small"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 3, width = 64, height = 64 }
lens = { vertical_fov_deg = 60 }
camera = { position_ned_m = [0, 0, -150] }
motion = { model = "none" }
[[aircraft]]
name = "c172"
aircraft = "c172/news"
[[trajectory]]
name = "across"
waypoints_ned_m = [[30, -3, -150], [32, 9, -151]]
speed_mps = 20
[[trajectory]]
name = "away"
waypoints_ned_m = [[40, 0, -150], [80, 4, -152]]
speed_mps = 60
[[product]]
name = "{trajectory}"
[render]
quality = 1
[output]
video = "mkv"
"""

SCENE = """name = "out"
[background]
video = "clip.mkv"
[lens]
vertical_fov_deg = 60
[camera]
position_ned_m = [0, 0, -150]
[motion]
model = "none"
[[intruder]]
aircraft = "c172/news"
waypoints_ned_m = [[30, -3, -150], [32, 9, -151]]
speed_mps = 20
[render]
quality = 1
[output]
video = "mkv"
"""


class Broken(Exception):
    """airtruth broke a rule."""


class Done:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err


def _no_core():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def start(arguments, **more):
    more.setdefault("stdin", subprocess.DEVNULL)
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=_no_core, **more)


def end(process, what):
    try:
        out, err = process.communicate(timeout=HANG_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        raise Broken(f"{what}: hangs: no end after {HANG_S} s") from None
    return Done(process.returncode, out.decode(errors="replace"), err.decode(errors="replace"))


def errors_of(done):
    return [line for line in done.err.splitlines() if line.startswith("airtruth: error:")]


def hold_to_rules(done, what, codes=(0, 2)):
    """Raises Broken where the outcome is none that a user should see."""
    tail = done.err[-600:]
    if done.code < 0:
        raise Broken(f"{what}: ended by signal {-done.code}: {tail}")
    if FAULT in done.err or "Sanitizer" in done.err:
        raise Broken(f"{what}: {tail}")
    if done.code not in codes:
        raise Broken(f"{what}: exit code {done.code}, expected one of {codes}: {tail}")
    if done.code == 2:
        errors = errors_of(done)
        if len(errors) != 1 or not done.err.rstrip("\n").endswith(errors[0]):
            raise Broken(f"{what}: expected one line of error, found: {tail}")
    return done


def run(arguments, what=None, codes=(0, 2), **more):
    return hold_to_rules(end(start(arguments, **more), what or " ".join(map(str, arguments))), what or arguments, codes)


def state(folder, leave_out=()):
    """SHA-256 of every file below the folder, by relative name; names of folders with the value 'folder'."""
    found = {}
    for root, folders, files in os.walk(folder):
        for name in folders:
            path = os.path.join(root, name)
            found[os.path.relpath(path, folder)] = "link" if os.path.islink(path) else "folder"
        for name in files:
            path = os.path.join(root, name)
            if any(part in os.path.relpath(path, folder) for part in leave_out):
                continue
            if os.path.islink(path):
                found[os.path.relpath(path, folder)] = "link to " + os.readlink(path)
                continue
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = hashlib.sha256(file.read()).hexdigest()
    return found


def halves(folder):
    """What a run left that it had not finished: its hidden parts."""
    return sorted(name for name in state(folder) if any(p.startswith(".") and ".part" in p for p in name.split("/")))


def difference(before, after):
    return sorted(name for name in set(before) | set(after) if before.get(name) != after.get(name))[:10]


def environment(cache):
    """Of runs: a cache of their own, and nothing that a sanitizer would call a leak of a library's."""
    return dict(os.environ, XDG_CACHE_HOME=cache)


def write(path, text):
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path, "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())
    return path


def alive(marker):
    """Processes whose command line holds the marker."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                words = file.read()
        except OSError:
            continue
        if marker.encode() in words and int(pid) != os.getpid():
            found.append(int(pid))
    return found


def gone(marker, within_s=30):
    """Waits until no process holds the marker; the limit only stops a hang."""
    until = time.monotonic() + within_s
    while time.monotonic() < until:
        if not alive(marker):
            return
        time.sleep(0.05)
    raise Broken(f"processes are left behind: {alive(marker)}")


def keep(source, name):
    """Keeps a file that broke a rule where it outlives the run: beside the tests' other logs."""
    folder = os.environ.get("AIRTRUTH_BROKEN", "airtruth-broken")
    os.makedirs(folder, exist_ok=True)
    place = os.path.join(folder, name)
    if os.path.isdir(source):
        shutil.copytree(source, place, dirs_exist_ok=True)
    else:
        shutil.copy(source, place)
    return place


def campaign_arguments():
    """AIRTRUTH [--cases N] [--first I] [--kinds a,b] [--seed S]"""
    parser = argparse.ArgumentParser()
    parser.add_argument("airtruth", type=os.path.abspath)
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kinds", default="")
    parser.add_argument("--seed", default="1")
    how = parser.parse_args()
    how.wants = lambda kind: not how.kinds or kind in how.kinds.split(",")
    return how


def expect_none_broken(broken):
    if broken:
        raise Broken("\n  ".join([f"{len(broken)} broke a rule:", *broken]))


def main(body):
    try:
        body()
    except Broken as broken:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {broken}")


SIGNALS = {"SIGTERM": signal.SIGTERM, "SIGINT": signal.SIGINT}
