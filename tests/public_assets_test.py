# SPDX-License-Identifier: Apache-2.0
"""The public test files of other projects are read, read with a warning, or refused in one line. public_assets_test.py AIRTRUTH [KIND]

AIRTRUTH_ASSETS names a folder that holds clones of datumaro (label sets), pyulog and gpmf-parser (flight logs), assimp (models),
and gyroflow and its lens_profiles (lenses), any of them. The program runs on every file in it that is of a kind it reads. A crash,
a hang, the exit code 1, more than one line of refusal, and a success that leaves nothing fail the test; the rest is counted.
KIND is labels, logs, models or lenses, and leaves the other kinds out. -v lists each refusal and warning.
"""

import collections
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile

ASSETS = os.environ.get("AIRTRUTH_ASSETS")
HANG_S = 120
MODELS = (".ac", ".obj", ".3ds", ".stl", ".ply", ".dae", ".gltf", ".glb", ".fbx")
LOGS = (".ulg", ".srt", ".gpx")
# Endings of logs in this clone; elsewhere they may be anything.
GPMF = "gpmf-parser", (".raw", ".mp4")


def head_of(path, size=4096):
    with open(path, "rb") as file:
        return file.read(size)


def is_coco(path):
    try:
        with open(path, encoding="utf-8-sig") as file:
            content = json.load(file)
    except (ValueError, RecursionError):
        return False
    return isinstance(content, dict) and {"images", "annotations", "categories"} <= set(content)


def label_sets(folder, folders, files):
    """(format, source) of the label sets whose root is this folder."""
    names = set(folders) | set(files)
    at = lambda name: os.path.join(folder, name)
    if "annotations" in folders and any(is_coco(os.path.join(at("annotations"), name))
                                        for name in os.listdir(at("annotations")) if name.endswith(".json")):
        yield "coco", folder
    if os.path.basename(folder) != "annotations":
        yield from (("coco", at(name)) for name in files if name.endswith(".json") and is_coco(at(name)))
    if "Annotations" in folders:
        yield "voc", folder
    for name in files:
        if name.endswith(".xml") and b"<annotations" in head_of(at(name)):
            yield "cvat", at(name)
    if os.path.basename(folder) != "Annotations" and any(name.endswith(".xml") and b"<annotation>" in head_of(at(name)) for name in files):
        yield "voc", folder
    if names & {"data.yaml", "obj.names", "labels"} or any(re.fullmatch(r"obj_.*_data", name) for name in folders):
        yield "yolo", folder
    if os.path.basename(folder) != "gt" and os.path.exists(at("gt/gt.txt")):
        yield "mot", folder
    if "groundtruth.txt" in files:
        yield "vot", folder
    if "groundtruth_rect.txt" in files:
        yield "otb", folder


def work_in(root):
    """(kind, arguments, what must be left) of every file and set below a folder; OUT stands for a new path."""
    for folder, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in (".git", "contrib"))
        for format, source in label_sets(folder, folders, files):
            yield "labels", ["dataset", "import", source, "--format", format, "--frame-rate", "10", "-o", "OUT"]
        for name in sorted(files):
            path = os.path.join(folder, name)
            ending = os.path.splitext(name)[1].lower()
            if ending in MODELS and os.path.getsize(path) < 64 << 20:
                yield "models", ["aircraft", "show", path, "-o", "OUT.jpg"]
            if ending in LOGS or (GPMF[0] in path.split(os.sep) and ending in GPMF[1]):
                yield "logs", ["log", "show", path]
            if ending == ".json" and b'"calib_dimension"' in head_of(path):
                yield "lenses", ["lens", "crop", path, "--size", size_of(path), "-o", "OUT.yml"]


def size_of(profile):
    found = re.search(rb'"calib_dimension"\s*:\s*{\s*"w"\s*:\s*(\d+)\s*,\s*"h"\s*:\s*(\d+)', head_of(profile))
    return "x".join(number.decode() for number in found.groups()) if found else "1920x1080"


def outcome(program, arguments, scratch):
    """What became of a run, and the first line that says it."""
    left = None
    with tempfile.TemporaryDirectory(dir=scratch) as folder:
        arguments = [argument.replace("OUT", os.path.join(folder, "out"), 1) if argument.startswith("OUT") else argument
                     for argument in arguments]
        left = arguments[arguments.index("-o") + 1] if "-o" in arguments else None
        try:
            run = subprocess.run([program, *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace",
                                 timeout=HANG_S, cwd=folder, env=dict(os.environ, XDG_CACHE_HOME=folder))
        except subprocess.TimeoutExpired:
            return "FAILED: hangs", f"after {HANG_S} s"
        lines = run.stderr.splitlines()
        first = lines[0] if lines else ""
        if run.returncode == 2:
            faults = [line for line in lines if line.startswith("airtruth: error: ")]
            return ("refused", faults[0]) if len(faults) == 1 and lines[-1] == faults[0] else ("FAILED: no one line", run.stderr)
        if run.returncode != 0:
            return f"FAILED: code {run.returncode}", run.stderr
        if not run.stdout.strip() or (left and not os.path.exists(left)):
            return "FAILED: leaves nothing", run.stderr
        return ("read with a warning", first) if lines else ("read", "")


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "-v"]
    program = os.path.abspath(arguments[0])
    if not ASSETS or not os.path.isdir(ASSETS):
        print("skipped: AIRTRUTH_ASSETS names no folder")
        sys.exit(77)
    work = [item for item in work_in(os.path.abspath(ASSETS)) if item[0] in (arguments[1:] or item[0])]
    counts = collections.Counter()
    failures = []
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        outcomes = pool.map(lambda item: outcome(program, item[1], scratch), work)
        for (kind, command), (what, said) in zip(work, outcomes):
            counts[kind, what] += 1
            if what.startswith("FAILED"):
                failures.append(f"{what}: {' '.join(command)}\n    {said[-400:]}")
            elif "-v" in sys.argv and said:
                print(f"{what}: {' '.join(command[:5])}\n    {said}")
    for (kind, what), count in sorted(counts.items()):
        print(f"{kind}: {count} {what}")
    print(f"{len(work)} inputs, {len(failures)} failures")
    sys.exit("\n".join(failures) if failures else (0 if work else 77))


if __name__ == "__main__":
    main()
