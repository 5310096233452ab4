# SPDX-License-Identifier: Apache-2.0
"""Kills builds of a small data set at random instants, fills its disk, cuts its files short; and sees that nothing is lost
and nothing half is taken for whole: python3 fault_campaign.py AIRTRUTH [KILLS]
"""

import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

CATALOGUE = """name = "faults"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 10, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
[[aircraft]]
name = "c172"
aircraft = "c172/news"
[[trajectory]]
name = "across"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
[[trajectory]]
name = "away"
waypoints_ned_m = [[60, 0, -155], [400, 20, -170]]
speed_mps = 90
[[trajectory]]
name = "up"
waypoints_ned_m = [[120, 10, -150], [140, 12, -190]]
speed_mps = 30
[[product]]
name = "{trajectory}-{aircraft}"
[output]
video = "mkv"
"""


def hashes(folder):
    """SHA-256 of every file of every sequence that is there."""
    found = {}
    root = os.path.join(folder, "sequences")
    for name in os.listdir(root) if os.path.isdir(root) else []:
        if name.startswith("."):
            continue
        for file in os.listdir(os.path.join(root, name)):
            with open(os.path.join(root, name, file), "rb") as opened:
                data = opened.read()
            if file == "sequence.json":  # names the folder that the background lies in
                data = json.dumps(json.loads(data)["summary"]).encode()
            found[name + "/" + file] = hashlib.sha256(data).hexdigest()
    return found


def build(airtruth, catalogue, folder):
    return subprocess.Popen([airtruth, "dataset", "build", catalogue, "--out", folder, "--quiet"], stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE, text=True)


def check(folder, expected, what):
    """What is there is whole, and as an undisturbed build makes it."""
    found = hashes(folder)
    for name, value in found.items():
        if expected.get(name) != value:
            sys.exit(f"fault_campaign: after {what}: {name} is not what an undisturbed build makes")
    for sequence in {name.split("/")[0] for name in found}:
        lacking = {n for n in expected if n.startswith(sequence + "/")} - set(found)
        if lacking:
            sys.exit(f"fault_campaign: after {what}: {sequence} lacks {sorted(lacking)}")
    return len(found)


def finish(airtruth, catalogue, folder, expected, what):
    process = build(airtruth, catalogue, folder)
    errors = process.communicate()[1]
    if process.returncode != 0:
        sys.exit(f"fault_campaign: after {what}: the next build failed: {errors}")
    if check(folder, expected, what) != len(expected):
        sys.exit(f"fault_campaign: after {what}: the next build left something out")
    left = [n for n in os.listdir(os.path.join(folder, "sequences")) if n.startswith(".")]
    if left:
        sys.exit(f"fault_campaign: after {what}: {left} is left behind")


def kill_builds(airtruth, catalogue, root, expected, whole_s, kills):
    done = finished = rounds = 0
    dice = random.Random(1)
    while done < kills:
        folder = os.path.join(root, f"kill-{rounds}")
        rounds += 1
        complete = False
        while not complete and done < kills:
            process = build(airtruth, catalogue, folder)
            time.sleep(dice.uniform(0, 0.7 * whole_s))
            complete = process.poll() is not None
            if complete:
                finished += 1
            else:
                process.send_signal(signal.SIGKILL)
                done += 1
            process.communicate()
            check(folder, expected, f"kill {done}")
        finish(airtruth, catalogue, folder, expected, f"kill {done}")
    print(f"{done} builds killed at random instants ({finished} were over before), {rounds} data sets finished afterwards: "
          "nothing lost, nothing half taken for whole")


def full_disk(airtruth, catalogue, root, expected):
    folder = os.path.join(root, "small-disk")
    os.mkdir(folder)
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=500k", "tmpfs", folder], capture_output=True).returncode != 0:
        print("full disk: skipped, no tmpfs can be mounted")
        return
    try:
        data = os.path.join(folder, "set")
        process = build(airtruth, catalogue, data)
        errors = process.communicate()[1]
        # The first sequence that does not fit ends the build.
        if process.returncode != 2 or errors.count("No space left") != 1:
            sys.exit(f"fault_campaign: on a full disk: exit code {process.returncode}, {errors}")
        check(data, expected, "a full disk")
        subprocess.run(["mount", "-o", "remount,size=64m", folder], check=True)
        finish(airtruth, catalogue, data, expected, "a full disk")
    finally:
        subprocess.run(["umount", folder], check=False)
    print("a full disk: said so; the next build, with room, finished")


def cut_files(airtruth, folder, expected):
    dice = random.Random(2)
    names = [n for n in sorted(expected) if not n.endswith("sequence.json")]
    for name in dice.sample(names, 6):
        path = os.path.join(folder, "sequences", name)
        with open(path, "rb") as file:
            data = file.read()
        with open(path, "wb") as file:
            file.write(data[: len(data) * 2 // 3])
        found = subprocess.run([airtruth, "dataset", "verify", folder], capture_output=True, text=True)
        with open(path, "wb") as file:
            file.write(data)
        if found.returncode != 1 or os.path.basename(name) not in found.stderr:
            sys.exit(f"fault_campaign: verify did not see that {name} was cut: {found.stdout}{found.stderr}")
    print("6 files cut short: verify named each")


def main():
    airtruth = sys.argv[1]
    kills = int(sys.argv[2]) if len(sys.argv) > 2 else 200
    with tempfile.TemporaryDirectory(prefix="airtruth_faults_") as root:
        catalogue = os.path.join(root, "faults.toml")
        with open(catalogue, "w") as file:
            file.write(CATALOGUE)
        undisturbed = os.path.join(root, "undisturbed")
        start = time.monotonic()
        if build(airtruth, catalogue, undisturbed).wait() != 0:
            sys.exit("fault_campaign: an undisturbed build failed")
        whole_s = time.monotonic() - start
        expected = hashes(undisturbed)
        kill_builds(airtruth, catalogue, root, expected, whole_s, kills)
        full_disk(airtruth, catalogue, root, expected)
        cut_files(airtruth, undisturbed, expected)


if __name__ == "__main__":
    main()
