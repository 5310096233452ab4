# SPDX-License-Identifier: Apache-2.0
"""Reads files that are broken at random: python3 mutation_campaign.py AIRTRUTH [--cases N] [--first I] [--kinds a,b] [--seed S]

Each case breaks one good file by its own seed and runs what reads it. The rules of common.py hold: no signal, no fault of
airtruth, no hang; a run that fails says so in one line and leaves nothing. At the end of each kind the good file gives the same
bytes as at the start. A file that broke a rule is kept (AIRTRUTH_BROKEN, else ./airtruth-broken) under its kind and number;
--first I --cases 1 runs it again.
"""

import collections
import os
import random
import re
import shutil
import struct
import sys
import tempfile
import time

import common
from common import Broken

NUMBERS = ["1e308", "-1e308", "1e39", "5e-324", "-0", "nan", "inf", "-inf", "9223372036854775807", "-9223372036854775808", "4294967296",
           "2147483647", "-1", "0", "1e999", "0.1", "1", "2", "7.5", "40", "null", "[]", "{}", '""', "true"]
WORDS = ["../../../etc/passwd", "/dev/null", "/dev/zero", "%s%n%d", "$(touch pwned)", "`touch pwned`", "\"'<script>", "\u202eevil", "\0",
         "a" * 300, "\xff\xfe", "\n", "-rf", "C:\\x"]


def broken_bytes(dice, data):
    """One to four small wounds."""
    data = bytearray(data)
    for _ in range(dice.choice((1, 1, 2, 4))):
        size = max(1, len(data))
        at = dice.randrange(size)
        many = min(dice.choice((1, 2, 4, 16, 64, 256)), size)
        wound = dice.randrange(7)
        if wound == 0 and data:
            data[at] ^= 1 << dice.randrange(8)
        elif wound == 1:
            data[at:at + many] = dice.randbytes(many)
        elif wound == 2:
            del data[at:at + many]
        elif wound == 3:
            data[at:at] = data[at:at + many]
        elif wound == 4:
            data[at:at + 4] = dice.choice((b"\xff\xff\xff\xff", b"\0\0\0\0", b"\x7f\xff\xff\xff", b"\x80\0\0\0", b"\xff\xff\xff\x7f"))
        elif wound == 5:
            del data[at:]
        else:
            source = dice.randrange(size)
            data[at:at + many] = data[source:source + many]
    return bytes(data)


def broken_text(dice, data):
    text = data.decode("latin-1")
    for _ in range(dice.choice((1, 1, 2, 3))):
        wound = dice.randrange(6)
        if wound == 0:
            tokens = list(re.finditer(r"-?\d+(\.\d+)?([eE][-+]?\d+)?", text))
            new = dice.choice(NUMBERS)
        elif wound == 1:
            tokens = list(re.finditer(r'"[^"\n]*"', text))
            new = '"' + dice.choice(WORDS) + '"'
        elif wound == 2:
            tokens = list(re.finditer(r"[A-Za-z_]+", text))
            new = dice.choice(WORDS + NUMBERS)
        elif wound == 3:
            tokens = list(re.finditer(r"[^\n]*\n", text))
            new = dice.choice(("", "\n", dice.choice(tokens).group(0) if tokens else ""))
        elif wound == 4:
            tokens = list(re.finditer(r"[][{},:;=<>/]", text))
            new = dice.choice(("", "[", "]", "{", "}", ",", "<", "[[[[[[[["))
        else:
            text = broken_bytes(dice, text.encode("latin-1")).decode("latin-1")
            continue
        if tokens:
            token = dice.choice(tokens)
            text = text[: token.start()] + new.encode("utf-8").decode("latin-1") + text[token.end():]
    return text.encode("latin-1")


class Kind:
    """A kind of file: the good ones, and the command that reads them: command(folder, broken file, output)."""

    def __init__(self, name, files, command):
        self.name, self.files, self.command = name, files, command


def render(airtruth):
    return lambda place, name, out: [airtruth, "render", f"{place}/scene.toml", "--no-cache", "--out", out]


def is_text(name):
    return not name.endswith((".mkv", ".mp4", ".avi", ".png", ".jpg", ".3ds", ".rgb", ".tga", ".bin"))


def how_for(name):
    return broken_text if is_text(name) else broken_bytes


MODEL_AC = """AC3Db
MATERIAL "m" rgb 0.8 0.7 0.6  amb 0.2 0.2 0.2  emis 0 0 0  spec 0.5 0.5 0.5  shi 10  trans 0
OBJECT world
kids 1
OBJECT poly
name "body"
texture "skin.png"
texrep 1 1
numvert 4
0 0 0
4 0 0
4 0 3
0 1 3
numsurf 2
SURF 0x30
mat 0
refs 3
0 0 0
1 1 0
2 1 1
SURF 0x30
mat 0
refs 4
0 0 0
1 1 0
2 1 1
3 0 1
kids 0
"""
MODEL_OBJ = """mtllib m.mtl
v 0 0 0
v 4 0 0
v 4 3 0
v 0 3 1
vt 0 0
vt 1 0
vt 1 1
usemtl skin
f 1/1 2/2 3/3
f 1/1 3/3 4/2
f 1/1 4/2 2/3
"""
LENS_YML = """%YAML:1.0
---
image_width: 96
image_height: 64
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 60.5, 0., 47.5, 0., 60.5, 31.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.1, 0.01, 0.001, 0.001, 0.001 ]
"""
LENS_JSON = """{"calib_dimension": {"w": 96, "h": 64},
"fisheye_params": {"camera_matrix": [[60,0,47.5],[0,60,31.5],[0,0,1]], "radial_distortion_limit": 2.5,
"distortion_coeffs": [0.06, 0.01, -0.01, 0.004]}}
"""
CAMERA = """[clip]
video = "clip.mkv"
width = 96
height = 64
frames = 4
[shutter]
exposure_s = 0.004
readout_s = 0.01
[air]
extinction_per_km = [0.1, 0.1, 0.1]
airlight = [0.5, 0.5, 0.5]
[optics]
point_spread_px = 0.7
sharpening = 0.4
sharpening_px = 1.0
[sensor]
noise_gain = 1e-4
noise_floor = 1e-5
noise_correlation_px = 0.5
chroma_spread_px = 2
codec_step = 4
[light]
sun_azimuth_deg = 10.0
sun_elevation_deg = 30.0
"""
PATH = "time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg\n0,30,-3,-150,90,1,2\n0.5,31,4,-151,91,2,3\n3,32,9,-150,92,1,2\n"


# Regions of VOT's binary results: a byte of type, then little-endian numbers.
BEGUN = struct.pack("<BI", 0, 1)
RECTANGLE = struct.pack("<B4f", 1, 20.5, 30.25, 12, 9)
POLYGON = struct.pack("<BH8f", 2, 4, 20, 30, 33, 31, 32, 40, 21, 39)
MASK = struct.pack("<B2h3H", 3, 20, 30, 4, 3, 5) + struct.pack("<5H", 1, 2, 1, 4, 4)


def prepare(airtruth, data):
    """The good files, each kind's in a folder of its own."""

    def run(*words):
        common.run([airtruth, *words], codes=(0,))

    os.makedirs(data)
    run("synth", "-o", f"{data}/clip.mkv", "--mask", f"{data}/own.png", "--width", "96", "--height", "64", "--frames", "4")
    for kind in ("video", "mask", "scene", "camera", "model"):
        os.makedirs(f"{data}/{kind}")
        shutil.copy(f"{data}/clip.mkv", f"{data}/{kind}")
        common.write(f"{data}/{kind}/scene.toml", common.SCENE)
    for ending in ("mp4", "avi"):
        run("synth", "-o", f"{data}/video/clip.{ending}", "--width", "96", "--height", "64", "--frames", "4")
    shutil.copy(f"{data}/own.png", f"{data}/mask/own.png")
    common.write(f"{data}/mask/scene.toml", common.SCENE.replace('"clip.mkv"', '"clip.mkv"\nmask = "own.png"'))
    full = common.SCENE + "".join(CAMERA.partition("[shutter]")[1:]).partition("[light]")[0]
    common.write(f"{data}/scene/scene.toml", full + "[light]\nexposure = 1.2\nsky_colour = [0.5, 0.6, 0.7]\n")
    posed = common.SCENE.replace("vertical_fov_deg = 60", 'file = "lens.yml"').replace("position_ned_m = [0, 0, -150]", "")
    flown = posed.replace("waypoints_ned_m = [[30, -3, -150], [32, 9, -151]]\nspeed_mps = 20", 'path_file = "path.csv"')
    common.write(f"{data}/camera/scene.toml", flown + '[realism]\nfile = "camera.toml"\n')
    for name, text in (("lens.yml", LENS_YML), ("lens.json", LENS_JSON), ("camera.toml", CAMERA), ("path.csv", PATH)):
        common.write(f"{data}/camera/{name}", text)
    common.write(f"{data}/catalogue/set.toml", common.CATALOGUE + '[[random]]\nname = "r{index}"\ncount = 2\naircraft = ["c172/*"]\n')
    common.write(f"{data}/model/m.ac", MODEL_AC)
    common.write(f"{data}/model/m.obj", MODEL_OBJ)
    common.write(f"{data}/model/m.mtl", "newmtl skin\nKd 0.8 0.7 0.6\nmap_Kd skin.png\n")
    common.write(f"{data}/model/w.xml", "<?xml version='1.0'?>\n<PropertyList><path>m.ac</path><offsets><z-m>1.5</z-m></offsets></PropertyList>\n")
    shutil.copy(f"{data}/own.png", f"{data}/model/skin.png")
    common.write(f"{data}/set.toml", common.CATALOGUE)
    run("dataset", "build", f"{data}/set.toml", "--out", f"{data}/labels/set")
    for form in ("coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot", "webdataset"):
        run("dataset", "export", f"{data}/labels/set", "-f", form, "-o", f"{data}/labels/{form}", "--images", "png")
    run("track", f"{data}/labels/set", "-t", "opencv-mil", "-o", f"{data}/results/results")
    shutil.copytree(f"{data}/labels/set", f"{data}/results/set")
    shutil.copytree(f"{data}/labels/set", f"{data}/vot/set")
    for name, regions in (("across", (BEGUN, RECTANGLE, POLYGON)), ("away", (BEGUN, MASK, RECTANGLE))):
        common.write(f"{data}/vot/results/opencv-mil/baseline/{name}/{name}_001.bin", struct.pack("<hI", 1, 3) + b"".join(regions))


def label_files(data):
    found = []
    for root, _, files in os.walk(f"{data}/labels"):
        found += [os.path.relpath(os.path.join(root, name), f"{data}/labels") for name in files
                  if name.endswith(".tar") or is_text(name) and not name.endswith((".csv", ".md"))]
    return sorted(found)


def result_files(data):
    return sorted(os.path.relpath(os.path.join(root, name), f"{data}/results") for root, _, files in os.walk(f"{data}/results/results")
                  for name in files)


def kinds(airtruth, data):
    def model(place, name, out):
        shown = name if name.endswith((".ac", ".obj", ".xml")) else ("m.obj" if name.endswith(".mtl") else "m.ac")
        return [airtruth, "aircraft", "show", f"{place}/{shown}"]

    def camera(place, name, out):
        if name == "lens.json":
            with open(f"{place}/scene.toml") as file:
                text = file.read()
            common.write(f"{place}/scene.toml", text.replace("lens.yml", "lens.json"))
        return render(airtruth)(place, name, out)

    def video(place, name, out):
        common.write(f"{place}/scene.toml", common.SCENE.replace("clip.mkv", name))
        return render(airtruth)(place, name, out)

    def labels(place, name, out):
        form = name.split("/")[0]
        if form == "set":
            return [airtruth, "dataset", "export", f"{place}/set", "-f", "coco", "--images", "none", "-o", out]
        return [airtruth, "dataset", "import", f"{place}/{form}", "-f", form, "-o", out]

    def results(place, name, out):
        return [airtruth, "evaluate", f"{place}/set", f"{place}/results/opencv-mil", "--no-page", "-o", out]

    return [
        Kind("video", ["clip.mkv", "clip.mp4", "clip.avi"], video),
        Kind("mask", ["own.png"], render(airtruth)),
        Kind("scene", ["scene.toml"], render(airtruth)),
        Kind("catalogue", ["set.toml"], lambda place, name, out: [airtruth, "dataset", "plan", f"{place}/set.toml"]),
        Kind("camera", ["camera.toml", "lens.yml", "lens.json", "path.csv"], camera),
        Kind("model", ["m.ac", "m.obj", "m.mtl", "w.xml", "skin.png"], model),
        Kind("labels", label_files(data), labels),
        Kind("results", result_files(data), results),
        Kind("vot", ["results/opencv-mil/baseline/across/across_001.bin", "results/opencv-mil/baseline/away/away_001.bin"], results),
    ]


class Campaign:
    def __init__(self, airtruth, root, seed):
        self.airtruth, self.root, self.seed = airtruth, root, seed
        self.data = os.path.join(root, "data")
        self.environment = common.environment(os.path.join(root, "cache"))
        self.broken = []

    def good(self, kind, name):
        """What a run on the good files makes: its output and what it prints."""
        place, out = os.path.join(self.data, kind.name), os.path.join(self.root, "out")
        shutil.rmtree(out, ignore_errors=True)
        done = common.run(kind.command(place, name, out), f"{kind.name} unbroken", (0,), env=self.environment)
        return common.state(out), re.sub(r"[\d.]+ (s|frames/s)\b", "", done.out)

    def case(self, kind, number):
        dice = random.Random(f"{self.seed} {kind.name} {number}")
        name = dice.choice(kind.files)
        place, out = os.path.join(self.root, "case"), os.path.join(self.root, "out")
        for folder in (place, out):
            shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(os.path.join(self.data, kind.name), place)
        with open(os.path.join(place, name), "rb") as file:
            data = file.read()
        common.write(os.path.join(place, name), how_for(name)(dice, data))
        before = common.state(place)
        what = f"{kind.name} {number} ({name})"
        command = kind.command(place, name, out)
        before.update({n: s for n, s in common.state(place).items() if n == "scene.toml"})
        try:
            done = common.run(command, what, env=self.environment, cwd=self.root)
            if done.code == 2 and kind.name not in ("labels",) and os.path.isdir(out) and common.state(out):
                raise Broken(f"{what}: failed, and left {sorted(common.state(out))[:5]}")
            if common.halves(out) and kind.name != "labels":
                raise Broken(f"{what}: half-made files are left: {common.halves(out)}")
            if common.difference(before, common.state(place)):
                raise Broken(f"{what}: changed its inputs: {common.difference(before, common.state(place))}")
            if os.path.exists(os.path.join(self.root, "pwned")):
                raise Broken(f"{what}: ran what it read")
            return done.code
        except Broken as broken:
            kept = common.keep(place, f"{kind.name}-{number}")
            self.broken.append(f"{broken} (kept in {kept}; command: {' '.join(command)})")
            return "broken"

    def run(self, kind, first, cases):
        name = kind.files[0]
        at_first = self.good(kind, name)
        began = time.monotonic()
        outcomes = collections.Counter(self.case(kind, number) for number in range(first, first + cases))
        if self.good(kind, name) != at_first:
            self.broken.append(f"{kind.name}: the unbroken file gives other bytes after the campaign")
        print(f"{kind.name}: {cases} broken files, {outcomes[0]} read, {outcomes[2]} refused in one line, {outcomes['broken']} broke a rule "
              f"({(time.monotonic() - began) / max(1, cases):.2f} s each)", flush=True)


def body():
    how = common.campaign_arguments()
    with tempfile.TemporaryDirectory(prefix="airtruth_mutations_") as root:
        campaign = Campaign(how.airtruth, root, how.seed)
        prepare(campaign.airtruth, campaign.data)
        for kind in kinds(campaign.airtruth, campaign.data):
            if how.wants(kind.name):
                campaign.run(kind, how.first, how.cases)
        common.expect_none_broken(campaign.broken)


if __name__ == "__main__":
    common.main(body)
