# SPDX-License-Identifier: Apache-2.0
"""What can be known at once is said before long work: python3 early_errors_test.py AIRTRUTH

Every command here has one fault that needs no frame to be known and an input whose measuring fails with a message of its own. The fault's message
shows that nothing was measured before."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

AIRTRUTH = ""
ROOT = ""

SCENE = """name = "clip"
[background]
video = "short.mkv"
{background}
[lens]
{lens}
[camera]
position_ned_m = [0, 0, -150]
{camera}
{realism}
[[intruder]]
id = "one"
aircraft = "{aircraft}"
{path}
[output]
video = "{output}"
{more}
"""


def scene(**change):
    """A scene that is right but for what `change` says, and whose clip is too short to measure a camera on."""
    keys = {
        "background": "",
        "lens": "vertical_fov_deg = 75",
        "camera": "",
        "realism": "[realism]\nauto = true",
        "aircraft": "c172/news",
        "path": "waypoints_ned_m = [[60, -8, -150], [60, 100, -150]]\nspeed_mps = 50",
        "output": "mkv",
        "more": "",
    }
    keys.update(change)
    return SCENE.format(**keys)


def path(*names):
    return os.path.join(ROOT, *names)


def write(name, content):
    with open(path(name), "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path(name)


def run(*arguments):
    return subprocess.run([AIRTRUTH, *arguments], cwd=ROOT, capture_output=True, text=True, errors="replace", timeout=120)


class EarlyErrors(unittest.TestCase):
    def assert_says(self, result, *words):
        """One line, exit code 2, with these words in it."""
        self.assertEqual(result.returncode, 2, result.stderr)
        lines = [line for line in result.stderr.splitlines() if ": error: " in line]
        self.assertEqual(len(lines), 1, result.stderr)
        for word in words:
            self.assertIn(word.lower(), lines[0].lower())

    def render(self, text, out="out", *arguments):
        return run("render", write("scene.toml", text), "--out", path(out), "--no-cache", *arguments)

    def test_the_clip_itself_cannot_be_measured(self):
        self.assert_says(self.render(scene(), "none"), "cannot be measured")
        self.assertFalse(os.path.exists(path("none")))

    def test_an_output_that_exists(self):
        shutil.copytree(path("made"), path("there"))
        self.assert_says(self.render(scene(), "there"), "exists already")
        self.assertEqual(os.listdir(path("there")), ["clip"])
        self.assert_says(self.render(scene(), "there", "--overwrite"), "cannot be measured")
        self.assertEqual(sorted(os.listdir(path("there", "clip"))), sorted(os.listdir(path("made", "clip"))))

    def test_faults_of_a_scene(self):
        faults = {
            "the camera's path file": (scene(camera='path_file = "bad.csv"').replace("position_ned_m = [0, 0, -150]\n", ""), "bad.csv"),
            "a camera's path that begins late": (
                scene(camera='path_file = "late.csv"').replace("position_ned_m = [0, 0, -150]\n", ""), "scene.toml:7:1: the camera's path begins at 1.000 s"),
            "a camera's path that ends early": (
                scene(camera='path_file = "early.csv"', realism='[motion]\nmodel = "none"').replace("position_ned_m = [0, 0, -150]\n", ""),
                "scene.toml:7:1: the camera's path ends at 0.01"),
            "a first frame past the end": (scene(background="first_frame = 99"), f"scene.toml:2:1: {path('short.mkv')} holds "),
            "the intruder's path file": (scene(path='path_file = "bad.csv"'), "bad.csv"),
            "a path file that is missing": (scene(path='path_file = "none.csv"'), f"scene.toml:12:1: {path('none.csv')} does not exist"),
            "the mask's size": (scene(background='mask = "small.pgm"'), "16x12"),
            "a mask that is missing": (scene(background='mask = "none.png"'), f"scene.toml:2:1: {path('none.png')} does not exist"),
            "the lens file": (scene(lens='file = "bad.yml"'), "bad.yml"),
            "the camera file": (scene(realism='[realism]\nauto = true\nfile = "bad.toml"'), "bad.toml"),
            "the aircraft": (scene(aircraft="c172/newz"), "c172/newz"),
            "the format of an odd size": (scene(output="mp4").replace("short.mkv", "odd.mkv"), "odd size"),
            "the method": (scene(more='[composite]\nmethod = "chroma-key"'), "chroma-key"),
        }
        for name, (text, word) in faults.items():
            with self.subTest(name):
                self.assert_says(self.render(text, "fault"), word)
                self.assertFalse(os.path.exists(path("fault")))

    def test_nothing_is_left_of_folders_that_were_made(self):
        self.assert_says(self.render(scene(), os.path.join("a", "b", "c")), "cannot be measured")
        self.assertFalse(os.path.exists(path("a")))

    def test_outputs_of_the_other_commands(self):
        write("there.txt", "mine")
        faults = [
            (("calibrate", "short.mkv", "-o", "no/c.toml"), "no folder no"),
            (("calibrate", "short.mkv", "-o", "c.toml", "--plot", "p.txt"), "expected .png or .jpg"),
            (("calibrate", "short.mkv", "-o", "there.txt"), "exists already"),
            (("calibrate", "short.mkv", "-o", "."), "exists already"),
            (("calibrate", "short.mkv", "-o", "c.toml", "--lens", "bad.yml"), "bad.yml"),
            (("calibrate", "short.mkv", "-o", "c.toml", "--mask", "small.pgm"), "16x12"),
            (("mask", "short.mkv", "-o", "m.jpg"), "m.jpg: has the ending .jpg; expected .png"),
            (("motion", "short.mkv", "-o", "m.csv", "--stabilised", "s.txt"), ".txt"),
            (("motion", "short.mkv", "-o", "m.png"), "m.png: has the ending .png; expected .csv"),
            (("calibrate", "short.mkv", "-o", "c.png"), "c.png: has the ending .png; expected .toml"),
            (("lens", "estimate", "short.mkv", "-o", "l"), "l: has no ending; expected .yml or .yaml"),
            (("lens", "crop", "bad.yml", "--size", "4x4", "-o", "l.txt"), "l.txt: has the ending .txt; expected .yml or .yaml"),
            (("synth", "-o", "new.mkv", "--truth", "t.txt"), "expected .csv"),
            (("scene", "new", "short.mkv", "-o", "new.txt"), "expected .toml"),
            (("evision", "nowhere", "--frames", "f.txt"), "expected .csv"),
            (("dataset", "report", "made/clip", "-o", "r.txt"), "expected .html or .htm"),
            (("motion", "odd.mkv", "-o", "m.csv", "--stabilised", "s.mp4"), "odd size"),
            (("motion", "short.mkv", "-o", "m.csv", "--plot", "no/p.png"), "no folder no"),
            (("lens", "estimate", "short.mkv", "-o", "no/l.yml"), "no folder no"),
            (("synth", "-o", "new.mkv", "--truth", "no/t.csv"), "no folder no"),
            (("synth", "-o", "new.mkv", "--mask", "m.jpg"), "m.jpg: has the ending .jpg; expected .png"),
            (("evision", "nowhere", "--frames", "there.txt"), "exists already"),
            (("aircraft", "show", "c172/news", "-o", "there.txt"), "expected .png or .jpg"),
            (("aircraft", "list", "--sheet", "new.png", "--sizes"), "--sizes excludes --sheet"),
            (("aircraft", "list", "--sheet", "new.png", "--left-out"), "--left-out excludes --sheet"),
            (("overlay", "made/clip", "-o", "no/o.mp4"), "no folder no"),
            (("inspect", "made/clip", "--frame", "0", "-o", "i.txt"), "expected .png or .jpg"),
            (("dataset", "report", "made/clip", "-o", "no/r.html"), "no folder no"),
            (("track", "short.mkv", "--init", "1,1,9,9", "-t", "am3", "-o", "there.txt"), "there.txt is no folder"),
            (("evaluate", "made/clip", "nowhere", "-o", "e", "--against", "there.txt"), "is not JSON"),
        ]
        before = sorted(os.listdir(ROOT))
        for words, message in faults:
            with self.subTest(" ".join(words)):
                self.assert_says(run(*words), message)
                self.assertEqual(sorted(os.listdir(ROOT)), before)
        with open(path("there.txt")) as file:
            self.assertEqual(file.read(), "mine")

    def test_options_without_an_effect(self):
        write("scene.toml", scene())
        export = ("dataset", "export", "made/clip", "-f", "coco", "-o", "e")
        faults = [
            (("render", "scene.toml", "--gpu", "0"), '--gpu has no effect without method = "chroma-key"'),
            ((*export, "--drop-faint"), "--drop-faint has no effect without --min-contrast or --min-size"),
            ((*export, "--split", "none", "--shares", "5", "3", "2"), "--shares has no effect with --split none"),
            ((*export, "--split", "none", "--seed", "2"), "--seed has no effect with --split none"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--no-masks", "--mask", "small.pgm"), "--mask has no effect with --no-masks"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--no-masks", "--mask-results"), "--mask-results has no effect with --no-masks"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--mask", "small.pgm", "--mask-results"), "--mask-results has no effect without a network"),
            (("detect", "short.mkv", "-d", "exec:true", "-o", "r", "--mask-results"), "--mask-results has no effect without a mask"),
            (("detect", "made/clip", "-d", "exec:true", "-o", "r", "--mask-results"), "--mask-results has no effect without a mask"),
            (("detect", "made/clip", "-d", "cmo", "-o", "r", "--lens", "bad.yml"), "--lens has no effect over sequences that state their lens"),
            (("detect", "made/clip", "-d", "cmo", "-o", "r", "--frame-rate", "3"), "--frame-rate has no effect over sequences that state their rate"),
            (("motion", "short.mkv", "-o", "m.csv", "--smoothing", "2"), "--smoothing has no effect without --reference smoothed"),
            (("synth", "-o", "new.mkv", "--fov", "60", "--lens", "bad.yml"), "--fov has no effect with --lens"),
            (("synth", "-o", "new.mkv", "--frames", "9", "--duration", "1"), "--frames has no effect with --duration"),
            (("log", "align", "late.csv", "short.mkv", "--lens", "bad.yml", "--fov", "60"), "--fov has no effect with --lens"),
            (("lens", "estimate", "short.mkv", "--uncertain"), "--uncertain has no effect without --out"),
            (("track", "made/clip", "-t", "am3", "-o", "r", "--repetitions", "2"), "--repetitions has no effect without --protocol restart"),
            (("track", "made/clip", "-t", "am3", "-o", "r", "--timeout", "2"), "--timeout has no effect without a tracker that speaks TraX"),
            (("track", "short.mkv", "--init", "1,1,9,9", "-t", "am3", "-o", "r", "--only", "a"), "--only has no effect with --init"),
            (("track", "made/clip", "-t", "am3", "-o", "r", "--first-frame", "2"), "--first-frame has no effect without --init"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--declare", "2/3"), "--declare has no effect without --associate"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--timeout", "2"), "--timeout has no effect without a detector that is a program"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--only", "a*"), "--only has no effect on a video"),
            (("detect", "short.mkv", "-d", "cmo", "-o", "r", "--backgrounds"), "--backgrounds has no effect on a video"),
            (("dataset", "verify", "made", "--every", "2"), "--every has no effect without --deep"),
            (("dataset", "import", "bad.csv", "-f", "coco", "-o", "i", "--origin", "1"), "--origin has no effect without --format csv"),
            (("evaluate", "made/clip", "made", "-o", "e", "--score", "1"), "--score has no effect without results of a detector"),
            (("evaluate", "made/clip", "made/clip/sequence.json", "-o", "e", "--score", "1", "--false-alarms", "5"),
             "--false-alarms has no effect with --score"),
            (("evaluate", "made/clip", "made/clip/sequence.json", "-o", "e", "--origin", "1"), "--origin has no effect without results of a tracker"),
            (("studio", "scene.toml", "--lens", "bad.yml"), "--lens has no effect on a scene"),
            (("compare", "--real", "short.mkv", "--boxes", "late.csv", "--scene", "scene.toml", "-o", "c", "--no-match", "--helicopter"),
             "--helicopter has no effect with --no-match"),
        ]
        before = sorted(os.listdir(ROOT))
        for words, message in faults:
            with self.subTest(" ".join(words)):
                self.assert_says(run(*words), message)
                self.assertEqual(sorted(os.listdir(ROOT)), before)

    def test_a_number_that_is_not_finite(self):
        """CLI11's ranges let NaN through, and options without a range take inf."""
        for text in ("nan", "-NaN", "inf", "-inf"):
            for command, option in ((["detect", "odd.mkv", "-d", "exec:cat", "-o", "out"], "--timeout"),
                                    (["track", "odd.mkv", "--init", "1,2,30,40", "-t", "trax:cat", "-o", "out"], "--start-timeout"),
                                    (["synth", "-o", "new.mkv"], "--duration"), (["synth", "-o", "new.mkv"], "--sun-azimuth"),
                                    (["dataset", "export", "set", "-f", "coco", "-o", "out"], "--min-contrast"),
                                    (["calibrate", "odd.mkv", "-o", "out.toml"], "--heading"),
                                    (["evaluate", "set", "results", "-o", "out"], "--score")):
                with self.subTest(option + " " + text):
                    self.assert_says(run(*command, option + "=" + text), option)
        for shares in (("nan", "1", "1"), ("1e308", "1e308", "1e308")):
            self.assert_says(run("dataset", "export", "set", "-f", "coco", "-o", "out", "--shares", *shares), "--shares")
        self.assertFalse(os.path.exists(path("out")))

    def test_a_catalogue(self):
        catalogue = """name = "set"
[[background]]
name = "sky"
flight = {{ seed = 3, frame_count = 8, width = 160, height = 120 }}
lens = {{ {lens} }}
camera = {{ {camera} }}
{more}
[[aircraft]]
name = "one"
aircraft = "c172/news"
[[trajectory]]
name = "across"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
[[product]]
[composite]
method = "{method}"
"""
        right = {"lens": "vertical_fov_deg = 75", "camera": "position_ned_m = [0, 0, -150]", "more": "", "method": "matte"}
        faults = [
            ({"camera": 'path_file = "bad.csv"'}, "bad.csv"),
            ({"lens": 'file = "bad.yml"'}, "bad.yml"),
            ({"more": 'realism = { file = "bad.toml" }'}, "bad.toml"),
            ({"lens": 'model = "fisheye", vertical_fov_deg = 75', "method": "chroma-key"}, "chroma-key"),
        ]
        for change, word in faults:
            with self.subTest(word):
                text = write("catalogue.toml", catalogue.format(**{**right, **change}))
                self.assert_says(run("dataset", "plan", text), word)
                self.assert_says(run("dataset", "build", text, "--out", path("set")), word)
                self.assertFalse(os.path.exists(path("set")))
        text = write("catalogue.toml", catalogue.format(**right))
        self.assertEqual(run("dataset", "plan", text).returncode, 0)


def make_inputs():
    for name, size in (("short.mkv", ("160", "120")), ("odd.mkv", ("161", "121"))):
        made = run("synth", "-o", name, "--width", size[0], "--height", size[1], "--frames", "3", "--no-own-aircraft")
        assert made.returncode == 0, made.stderr
    write("small.pgm", b"P5\n16 12\n255\n" + b"\xff" * (16 * 12))
    write("bad.csv", "this is a letter\n")
    write("late.csv", "time_s,north_m,east_m,down_m\n1,0,0,-150\n2,10,0,-150\n")
    write("early.csv", "time_s,north_m,east_m,down_m\n0,0,0,-150\n0.01,1,0,-150\n")
    write("bad.yml", "this is a letter\n")
    write("bad.toml", "this is = a = letter\n")
    made = run("render", write("made.toml", scene(realism="[motion]\nmodel = \"none\"")), "--out", path("made"))
    assert made.returncode == 0, made.stderr


if __name__ == "__main__":
    AIRTRUTH = os.path.abspath(sys.argv.pop(1))
    ROOT = tempfile.mkdtemp(prefix="airtruth_early_errors_test_")
    os.environ["XDG_CACHE_HOME"] = os.path.join(ROOT, "cache")
    try:
        make_inputs()
        unittest.main()
    finally:
        shutil.rmtree(ROOT, ignore_errors=True)
