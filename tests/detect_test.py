# SPDX-License-Identifier: Apache-2.0
"""airtruth detect as its users run it, with the shipped clients and with programs that misbehave: python3 detect_test.py AIRTRUTH CLIENTS EXAMPLE"""

import json
import os
import shutil
import struct
import sys
import unittest
import zlib

import program
from program import Case, made, path, read, run, write

WIDTH, HEIGHT, COUNT = 320, 240, 30
CLIENTS = EXAMPLE = ""
DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "network-detector")
HELLO = """echo '{"hello":{"protocol":1,"samples":"gray","frames":"shared_memory"}}'; """
LOOP = HELLO + """while read -r line; do case "$line" in '{"frame":'*) k=${line#*:}; k=${k%%,*}; if [ $k -lt 3 ]; then echo "{\\"frame\\":$k,\\"detections\\":[]}"; else SAY; fi;; '{"quit"'*) exit 0;; esac; done"""
ODD = {
    "dies": ("kill -SEGV $$", "was ended by signal 11"),
    "hangs": ("sleep 100", "did not answer in time"),
    "floods": ("exec yes nonsense", "did not answer in time"),
    "disorder": ("echo '{\"frame\":1,\"detections\":[]}'", "answered out of order: frame '1', when asked for frame 3"),
    "nan": ("echo '{\"frame\":3,\"detections\":[{\"box\":[1,1,5,5],\"score\":NaN}]}'", "sent NaN"),
    "outside": ("echo '{\"frame\":3,\"detections\":[{\"box\":[999,1,5,5],\"score\":1}]}'", "lies outside its image of 320x240"),
    "edge": ("echo '{\"frame\":3,\"detections\":[{\"box\":[319.9997,1,5,5],\"score\":1}]}'", "lies outside its image of 320x240"),
    "empty": ("echo '{\"frame\":3,\"detections\":[{\"box\":[9,1,0,5],\"score\":1}]}'", "has no area"),
}


def files_of(folder):
    """Relative path and content of every file but those that hold times."""
    found = {}
    for place, _, names in os.walk(path(folder)):
        for name in names:
            file = os.path.join(place, name)
            text = read(file)
            if name.endswith(".json") and '"seconds"' in text:
                text = json.dumps({key: value for key, value in json.loads(text).items() if key != "seconds"})
            found[os.path.relpath(file, path(folder))] = text
    return found


def target(number):
    """A dark bar that crosses the sky."""
    return 60 + 2 * number, 80 + number, 14, 6


def brightest(number):
    """The brightest pixel of a frame."""
    return 200 + number, 40


def png_of(number):
    """A grey sky with a pattern as fine as noise."""
    x0, y0, width, height = target(number)
    rows = []
    for y in range(HEIGHT):
        row = bytearray(140 + y // 12 + (x * 7919 + y * 104729 + number * 1299709) % 97 % 5 for x in range(WIDTH))
        if y0 <= y < y0 + height:
            row[x0:x0 + width] = bytes([70]) * width
        rows.append(row)
    x, y = brightest(number)
    rows[y][x] = 250
    return png(rows)


def png(rows):
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 0, 0, 0, 0)) + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def make_inputs():
    pictures = [png_of(number) for number in range(COUNT)]
    for name in ("one", "three", "two"):
        for number, picture in enumerate(pictures):
            write(f"otb/{name}/img/{number + 1:04}.png", picture)
        write(f"otb/{name}/groundtruth_rect.txt", "".join(f"{x + 1},{y + 1},{w},{h}\n" for x, y, w, h in map(target, range(COUNT))))
    made("dataset", "import", "otb", "-f", "otb", "--frame-rate", "25", "-o", "set")


class OverASet(Case):
    def test_every_frame_of_every_sequence(self):
        made("detect", "set", "-d", "cmo", "-d", "frame-difference", "-o", "all")
        for name in ("one", "three", "two"):
            facts = json.loads(read("all", "cmo", name + ".json"))
            self.assertEqual((facts["frames"], facts["width"], facts["height"], len(facts["seconds"])), (COUNT, 320, 240, COUNT))
        # Every frame's strongest detection is the target. Image ids count the frames of the set through.
        lines = [line.split(",") for line in read("all", "cmo", "two.txt").splitlines()]
        self.assertTrue(all(len(line) == 10 for line in lines))
        for number in range(COUNT):
            left, top, width, height = (float(v) for v in next(line for line in lines if int(line[0]) == number + 1)[2:6])
            for found, wanted in zip((left - 1, top - 1, width, height), target(number)):
                self.assertLessEqual(abs(found - wanted), 2, f"frame {number}: {left},{top} {width}x{height}")
        coco = json.loads(read("all", "cmo", "detections.json"))
        of_two = [one for one in coco if 2 * COUNT < one["image_id"] <= 3 * COUNT]
        self.assertEqual(len(of_two), len(lines))
        self.assertEqual([one["image_id"] - 2 * COUNT for one in of_two], [int(line[0]) for line in lines])
        self.assertEqual([round(one["bbox"][0] + 1, 3) for one in of_two], [float(line[2]) for line in lines])

    def test_the_same_bytes_for_any_number_of_jobs(self):
        made("detect", "set", "-d", "cmo-hmm", "-o", "j1")
        made("detect", "set", "-d", "cmo-hmm", "-o", "j3", "-j", "3")
        self.assertEqual(files_of("j1"), files_of("j3"))

    def test_a_second_run_goes_on(self):
        made("detect", "set", "-d", "cmo", "-o", "parts", "--only", "t*")
        self.assertFalse(os.path.exists(path("parts", "cmo", "detections.json")))
        before = read("parts", "cmo", "two.json")
        done = made("detect", "set", "-d", "cmo", "-o", "parts")
        self.assertIn("of 1 sequences", done.stdout)
        self.assertIn("2 were there", done.stdout)
        self.assertEqual(read("parts", "cmo", "two.json"), before)
        self.assertTrue(os.path.exists(path("parts", "cmo", "detections.json")))
        self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "parts", "--min-score", "9"), "min_score", "give another --out")

    def test_a_command_that_gave_no_results_may_be_mended(self):
        detect = lambda command: run("detect", "set", "-d", "own=exec:" + command, "-o", "mended", "--only", "one")
        self.assertIn("1 broken off", detect("false").stdout)
        self.assertEqual(detect(EXAMPLE).returncode, 0)
        self.assertTrue(read("mended", "own", "one.txt"))
        self.assert_refused(detect("false"), "mended/own: holds results with detector")

    def test_coco_results_of_fewer_sequences_do_not_outlive_a_new_one(self):
        made("detect", "set", "-d", "cmo", "-o", "grown", "--only", "two")
        write("grown/cmo/detections.json", "[]")  # of a set of this one sequence
        made("detect", "set", "-d", "cmo", "-o", "grown", "--only", "three")  # a run that ends before the last sequence
        self.assertFalse(os.path.exists(path("grown", "cmo", "detections.json")))
        made("detect", "set", "-d", "cmo", "-o", "grown")
        self.assertTrue(json.loads(read("grown", "cmo", "detections.json")))

    def test_scores_and_numbers_are_limited(self):
        made("detect", "set", "-d", "few=cmo", "-o", "few", "--max-per-frame", "2", "--min-score", "5")
        lines = [line.split(",") for line in read("few", "few", "one.txt").splitlines()]
        self.assertTrue(lines)
        self.assertTrue(all(float(line[6]) >= 5 for line in lines))
        for frame in range(COUNT):
            self.assertLessEqual(sum(int(line[0]) == frame + 1 for line in lines), 2)

    def test_ctrl_c_leaves_whole_sequences_alone(self):
        outcome = program.interrupted(["detect", "set", "-d", "cmo-hmm", "-o", "stopped"], program.has_written("stopped/cmo-hmm/one.json"))
        self.assert_stopped(outcome)
        for name in os.listdir(path("stopped", "cmo-hmm")):
            self.assertNotIn("part", name)
        made("detect", "set", "-d", "cmo-hmm", "-o", "stopped")
        made("detect", "set", "-d", "cmo-hmm", "-o", "unstopped")
        self.assertEqual(files_of("stopped"), files_of("unstopped"))


def mask_over(x0, y0, x1, y1):
    """A mask that is black in a rectangle."""
    return write("mask.png", png([bytes(0 if x0 <= x < x1 and y0 <= y < y1 else 255 for x in range(WIDTH)) for y in range(HEIGHT)]))


class OwnAircraft(Case):
    def near(self, file, place, within):
        """The frames in which a detection's centre is near a place, a function of the frame."""
        found = set()
        for line in read(*file).splitlines():
            frame, _, x, y, width, height = (float(v) for v in line.split(",")[:6])
            at_x, at_y = place(int(frame) - 1)
            if abs(x - 1 + width / 2 - at_x) <= within and abs(y - 1 + height / 2 - at_y) <= within:
                found.add(frame)
        return found

    def test_nothing_is_detected_on_it(self):
        mask = mask_over(0, 60, WIDTH, 130)
        middle = lambda number: (target(number)[0] + 7, target(number)[1] + 3)
        made("detect", "set", "--only", "one", "-d", "cmo", "-o", "masked", "--mask", mask)
        made("detect", "set", "--only", "one", "-d", "cmo", "-o", "unmasked", "--no-masks")
        self.assertEqual(self.near(("masked", "cmo", "one.txt"), middle, 10), set())
        self.assertEqual(len(self.near(("unmasked", "cmo", "one.txt"), middle, 10)), COUNT)
        self.assertGreater(len(self.near(("masked", "cmo", "one.txt"), brightest, 4)), COUNT // 2)
        self.assert_refused(run("detect", "set", "--only", "one", "-d", "cmo", "-o", "masked", "--mask", mask_over(0, 0, 9, 9)), "mask")

    def test_programs_see_it_unless_asked_otherwise(self):
        mask = mask_over(0, 30, WIDTH, 50)
        made("detect", "set", "--only", "one", "-d", f"b=exec:{EXAMPLE}", "-o", "seen", "--mask", mask)
        made("detect", "set", "--only", "one", "-d", f"b=exec:{EXAMPLE}", "-o", "dropped", "--mask", mask, "--mask-results")
        self.assertEqual(len(read("seen", "b", "one.txt").splitlines()), COUNT)
        self.assertEqual(read("dropped", "b", "one.txt"), "")


class OverAVideo(Case):
    def test_a_rate_of_a_video_is_refused(self):
        made("synth", "-o", "flown.mkv", "--frames", "2", "--width", "64", "--height", "64")
        self.assert_refused(run("detect", "flown.mkv", "-d", "cmo", "--frame-rate", "25", "-o", "flown"), "flown.mkv", "states its own rate")
        self.assertFalse(os.path.exists(path("flown")))

    def test_results_of_another_video_or_rate_are_not_kept(self):
        for folder in ("v1", "v2"):
            made("synth", "-o", write(f"{folder}/clip.mkv", ""), "--frames", "2", "--width", "64", "--height", "64", "--overwrite")
        detect = lambda video, *more: run("detect", video, "-d", "frame-difference", "-o", "origin", *more)
        self.assertEqual(detect("v1/clip.mkv").returncode, 0)
        self.assert_refused(detect("v2/clip.mkv"), "holds results with source", "v1/clip.mkv", "v2/clip.mkv")
        self.assertIn("1 were there", detect(path("v1", "clip.mkv")).stdout)
        self.assertEqual(detect("otb/one/img/", "--frame-rate", "10").returncode, 0)
        self.assert_refused(detect("otb/one/img", "--frame-rate", "100"), "frame_rate_hz 10.0; this run has 100.0")
        self.assertIn("1 were there", detect("otb/one/img", "--frame-rate", "10").stdout)
        facts = json.loads(read("origin", "frame-difference", "img.json"))
        for key in ("source", "frame_rate_hz"):  # as an older airtruth left it
            del facts[key]
        write("origin/frame-difference/img.json", json.dumps(facts))
        self.assertIn("1 were there", detect("otb/one/img", "--frame-rate", "100").stdout)

    def test_a_name_of_the_runs_own_files_is_refused(self):
        made("synth", "-o", "detector.mkv", "--frames", "2", "--width", "64", "--height", "64")
        self.assert_refused(run("detect", "detector.mkv", "-d", "frame-difference", "-o", "own-name"), "'detector'", "one file, detector.json")
        shutil.copytree(path("otb", "one"), path("otb-own", "detections"))
        made("dataset", "import", "otb-own", "-f", "otb", "--frame-rate", "25", "-o", "own-set")
        self.assert_refused(run("detect", "own-set", "-d", "frame-difference", "-o", "own-name"), "'detections'", "one file, detections.json")
        self.assertFalse(os.path.exists(path("own-name")))

    def test_results_of_other_content_at_the_same_path_are_not_kept(self):
        synth = lambda frames: made("synth", "-o", "anew.mkv", "--frames", frames, "--width", "64", "--height", "64", "--overwrite")
        synth("2")
        video = lambda: run("detect", "anew.mkv", "-d", "frame-difference", "-o", "anew")
        self.assertEqual(video().returncode, 0)
        self.assertIn("1 were there", video().stdout)
        synth("3")
        self.assert_refused(video(), "anew.json", "holds results with source_sha256", "give another --out")
        rate = lambda hz: made("dataset", "import", "otb", "-f", "otb", "--frame-rate", hz, "-o", "again")
        rate("25")
        detect = lambda: run("detect", "again", "--only", "one", "-d", "frame-difference", "-o", "of-again")
        self.assertEqual(detect().returncode, 0)
        warnings = lambda: made("evaluate", "again", "of-again/frame-difference", "--no-page", "-o", "of-again-measures").stderr
        self.assertNotIn("other content", warnings())
        shutil.rmtree(path("again"))
        rate("50")
        self.assertEqual(warnings().count("results of 1 sequences were made of other content"), 1)
        self.assertIn("(the first: one); `airtruth detect` with another --out", warnings())
        self.assert_refused(detect(), "one.json", "holds results with source_sha256")
        facts = json.loads(read("of-again", "frame-difference", "one.json"))
        del facts["source_sha256"]  # as an older airtruth left it
        write("of-again/frame-difference/one.json", json.dumps(facts))
        self.assertNotIn("other content", warnings())

    def test_the_rate_that_is_stated_for_a_set_without_one_is_of_its_results(self):
        made("dataset", "import", "otb", "-f", "otb", "-o", "rateless")
        detect = lambda *more: run("detect", "rateless", "--only", "one", "-d", "frame-difference", "-o", "rates", *more)
        self.assert_refused(detect("--min-score", "9"), "expected --frame-rate")
        self.assertEqual(detect("--frame-rate", "10").returncode, 0)  # what was refused leaves no settings to be of
        self.assert_refused(detect("--frame-rate", "100"), "frame_rate_hz 10.0; this run has 100.0")
        made("detect", "set", "--only", "one", "-d", "frame-difference", "-o", "own-rate")
        self.assertEqual(set(json.loads(read("own-rate", "frame-difference", "one.json"))), {"format", "sequence", "width", "height", "frames", "source_sha256", "seconds"})

    def test_its_name_is_that_of_its_file(self):
        made("detect", "otb/one/img", "-d", "cmo", "--frame-rate", "25", "-o", "video")
        self.assertEqual(sorted(os.listdir(path("video", "cmo"))), ["detector.json", "img.detections.json", "img.json", "img.txt"])


def boxes_of_truth(file):
    """The covered boxes of every frame."""
    frames = [json.loads(line)["intruders"] for line in read(file).splitlines()]
    return [[one["covered_box_px"] for one in intruders if one["state"] == "visible" and one.get("covered_box_px")] for intruders in frames]


def is_on(box, found):
    """Whether the middle of what was found lies in the box."""
    x, y = found[0] + found[2] / 2, found[1] + found[3] / 2
    return box[0] <= x <= box[0] + box[2] and box[1] <= y <= box[1] + box[3]


SCENE = """name = "one"
[background]
video = "clip.mkv"
[lens]
vertical_fov_deg = 40
[camera]
position_ned_m = [0, 0, -300]
[motion]
model = "none"
[[intruder]]
aircraft = "c172/news"
waypoints_ned_m = [[250, -30, -335], [250, 30, -335]]
speed_mps = 50
[[intruder]]
aircraft = "738/738-ANA"
waypoints_ned_m = [[700, 60, -420], [700, 160, -420]]
speed_mps = 120
"""


class ShippedNetwork(Case):
    """The network of data/network-detector, on a virtual flight in a clear sky with a light aircraft and an airliner, which no training saw."""

    FRAMES = 12
    MOST_BYTES = 1_000_000

    @classmethod
    def setUpClass(cls):
        made("synth", "-o", "clip.mkv", "--width", "640", "--height", "480", "--frames", str(cls.FRAMES), "--no-own-aircraft", "--clouds", "0",
             "--fov", "40", "--altitude", "300")
        write("scene.toml", SCENE)
        made("render", "scene.toml", "--out", ".", "--no-cache")
        cls.truth = boxes_of_truth("one/truth.jsonl")

    def found(self, folder):
        """The boxes found in every frame, from 0."""
        lines = [[float(v) for v in line.split(",")] for line in read(folder, "network", "one.txt").splitlines()]
        return [[(line[2] - 1, line[3] - 1, line[4], line[5]) for line in lines if line[0] == frame + 1] for frame in range(self.FRAMES)]

    def test_its_weights_are_at_most_a_megabyte(self):
        self.assertLessEqual(os.path.getsize(os.path.join(DATA, "aircraft.onnx")), self.MOST_BYTES)

    def test_it_is_what_detects_where_none_is_named_and_finds_aircraft_and_little_else(self):
        made("detect", "one/one.mp4", "-o", "shipped")
        self.assertEqual(os.listdir(path("shipped")), ["network"])
        found = self.found("shipped")
        wanted = sum(map(len, self.truth))
        self.assertEqual(wanted, 2 * self.FRAMES)
        hit = sum(any(is_on(box, one) for one in some) for boxes, some in zip(self.truth, found) for box in boxes)
        others = sum(not any(is_on(box, one) for box in boxes) for boxes, some in zip(self.truth, found) for one in some)
        self.assertGreaterEqual(hit, 0.9 * wanted)
        self.assertLessEqual(others, self.FRAMES // 2)
        record = json.loads(read("shipped", "network", "detector.json"))
        self.assertEqual((record["detector"], sorted(record["files"])), ("network", ["aircraft.json", "aircraft.onnx"]))
        made("detect", "one/one.mp4", "-d", "network=onnx:" + os.path.join(DATA, "aircraft.onnx"), "-o", "named")
        self.assertEqual(self.found("named"), found)

    def test_videos_below_a_set_are_looked_at_where_that_is_asked(self):
        made("detect", "one", "-d", "frame-difference", "-o", "alone")
        self.assertFalse(os.path.exists(path("alone", "frame-difference", "backgrounds")))
        made("detect", "one", "-d", "frame-difference", "-o", "below", "--backgrounds")
        self.assertEqual(sorted(os.listdir(path("below", "frame-difference", "backgrounds"))), ["clip.json", "clip.txt"])

    def test_a_set_that_was_moved_stands_on_its_own_files_and_never_on_others(self):
        os.makedirs(path("home", "backgrounds"))
        made("synth", "-o", "home/backgrounds/sky.mkv", "--width", str(WIDTH), "--height", str(HEIGHT), "--frames", "4", "--no-own-aircraft")
        shutil.copy(mask_over(0, 60, WIDTH, 130), path("home", "backgrounds", "sky.mask.png"))
        write("home.toml", SCENE.replace('"clip.mkv"', '"home/backgrounds/sky.mkv"\nmask = "home/backgrounds/sky.mask.png"'))
        made("render", "home.toml", "--out", "home/sequences", "--no-cache")
        detect = lambda folder, out: made("detect", folder, "-d", "cmo", "-o", out, "--backgrounds").stderr
        self.assertNotIn("sky.", detect("home", "as_made"))
        os.rename(path("home"), path("away"))
        shutil.copytree(path("away", "backgrounds"), path("home", "backgrounds"))
        for name in ("sky.mkv", "sky.mask.png"):
            with open(path("home", "backgrounds", name), "ab") as file:
                file.write(b"more")  # another file with the same pictures
        self.assertNotIn("sky.", detect("away", "as_moved"))
        self.assertEqual(files_of("as_moved"), files_of("as_made"))
        shutil.rmtree(path("away", "backgrounds"))
        said = detect("away", "of_others")
        self.assertIn("sky.mkv: the background of 'one' is another file now (its SHA-256 differs); it is left out", said)
        self.assertIn("sky.mask.png: the mask of 'one' is another file now (its SHA-256 differs)", said)

    def test_a_part_of_a_video_below_a_set_is_named_by_its_frames(self):
        for name, first in (("a", 2), ("b", 5)):
            text = SCENE.replace('"one"', f'"{name}"').replace('"clip.mkv"', f'"clip.mkv"\nfirst_frame = {first}\nframe_count = 4')
            write(name + ".toml", text)
            made("render", name + ".toml", "--out", "parts", "--no-cache")
        detect = lambda out, *more: made("detect", "parts", "-d", "frame-difference", "-o", out, "--backgrounds", *more)
        detect("whole")
        detect("stepwise", "--only", "b")
        self.assertIn("2 were there", detect("stepwise").stdout)  # b, and what it stands on
        self.assertEqual(sorted(os.listdir(path("whole", "frame-difference", "backgrounds"))),
                         ["clip.2-4.json", "clip.2-4.txt", "clip.5-4.json", "clip.5-4.txt"])
        self.assertEqual(files_of("stepwise"), files_of("whole"))

    def test_it_is_found_in_the_layout_of_an_installation(self):
        children = [name for name in os.listdir(program.built()) if name.startswith("airtruth-")]
        for name, place in (("airtruth", "bin"), *((name, "libexec/airtruth") for name in children)):
            os.makedirs(path("prefix", place), exist_ok=True)
            shutil.copy(os.path.join(program.built(), name), path("prefix", place, name))
        detect = lambda out: run("detect", "one/one.mp4", "-o", out, at=path("prefix", "bin", "airtruth"))
        self.assert_refused(detect("without"), "network-detector/aircraft.onnx, is not there")
        shutil.copytree(DATA, path("prefix", "share", "airtruth", "data", "network-detector"))
        done = detect("installed")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"in {self.FRAMES} frames", done.stdout)


class Refusals(Case):
    def test_one_line_each(self):
        self.assert_refused(run("detect", "set", "-d", "cmo-hnm", "-o", "x"), "did you mean 'cmo-hmm'")
        self.assert_refused(run("detect", "set", "-d", "cmo", "-d", "cmo=cmo-hmm", "-o", "x"), "two detectors are named 'cmo'")
        self.assert_refused(run("detect", "set", "-d", "../a=cmo", "-o", "x"), "no name")
        self.assert_refused(run("detect", "set", "-d", "exec: ", "-o", "x"), "names no command")
        self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "x", "--min-score", "nan"), "--min-score is 'nan'")
        self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "x", "--lens", "no.yml"), "no.yml")
        self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "x", "--mask", "no.png"), "no.png")
        self.assert_refused(run("detect", "nowhere", "-d", "cmo", "-o", "x"), "does not exist")
        self.assert_refused(run("detect", "set", "-d", "cmo", "-o", "x", "--only", "q*"), "no sequence fits")
        self.assert_refused(run("detect", write("no.mp4", "none"), "-d", "cmo", "-o", "x"), "no.mp4")
        self.assertFalse(os.path.exists(path("x")))


class Programs(Case):
    def test_both_clients_see_the_same(self):
        detectors = []
        for name, command in (("cpp", EXAMPLE), ("py", f"{sys.executable} {CLIENTS}/brightest_detector.py")):
            detectors += ["-d", f"{name}=exec:{command}", "-d", f"{name}-shared=exec:{command} --shared"]
        made("detect", "set", "--only", "one", "-o", "clients", *detectors)
        texts = [read("clients", name, "one.txt") for name in ("cpp", "cpp-shared", "py", "py-shared")]
        self.assertEqual(len(set(texts)), 1)
        lines = [line.split(",") for line in texts[0].splitlines()]
        self.assertEqual(len(lines), COUNT)
        for number, line in enumerate(lines):
            x, y = brightest(number)
            self.assertEqual([float(v) for v in line[:6]], [number + 1, -1, x - 1, y - 1, 5, 5])

    def test_each_fault_costs_its_sequence_alone(self):
        for name, (say, words) in ODD.items():
            write(name + ".sh", LOOP.replace("SAY", say))
            done = run("detect", "set", "-d", f"{name}=exec:sh {path(name + '.sh')}", "-d", "cmo", "-o", "odd", "--only", "o*", "--timeout", "2")
            self.assertEqual(done.returncode, 1, done.stderr)
            lines = done.stderr.splitlines()
            self.assertEqual(len(lines), 1, done.stderr)
            self.assertTrue(lines[0].startswith(f"airtruth: warning: {name} on one: the detector "), lines[0])
            self.assertIn(words, lines[0])
            self.assertEqual(sorted(os.listdir(path("odd", name))), ["detector.json", "logs"])
            self.assertIn(words, read("odd", name, "logs", "one.log"))
            self.assertTrue(os.path.exists(path("odd", "cmo", "one.json")))

    def test_the_next_sequence_is_run(self):
        write("picky.sh", HELLO + """read -r line; case "$line" in *'"sequence":"one"'*) echo not this one >&2; exit 4;; esac; """
              + LOOP[len(HELLO):].replace("SAY", "echo \"{\\\"frame\\\":$k,\\\"detections\\\":[]}\""))
        done = run("detect", "set", "-d", f"picky=exec:sh {path('picky.sh')}", "-o", "picky")
        self.assertEqual(done.returncode, 1)
        self.assertIn("ended with status 4; its last words: not this one", done.stderr)
        self.assertEqual(sorted(os.listdir(path("picky", "picky"))), ["detector.json", "logs", "three.json", "three.txt", "two.json", "two.txt"])

    def test_it_is_told_the_rate_of_pictures_that_were_rendered(self):
        made("synth", "-o", "flight.mkv", "--frames", "3", "--rate", "20", "--width", "320", "--height", "240")
        write("pictures.toml", 'name = "pictures"\n[background]\nvideo = "flight.mkv"\n[lens]\nvertical_fov_deg = 40\n[motion]\nmodel = "none"\n'
              + '[output]\nvideo = "png"\n')
        made("render", "pictures.toml", "--out", ".", "--no-cache")
        write("told.sh", HELLO + 'read -r line; echo "$line" >&2; ' + LOOP[len(HELLO):])
        made("detect", "pictures", "-d", f"told=exec:sh {path('told.sh')}", "-o", "told")
        self.assertAlmostEqual(json.loads(read("told", "told", "logs", "pictures.log"))["begin"]["frame_rate_hz"], 20, places=6)
        self.assert_refused(run("detect", "pictures", "-d", "cmo", "-o", "untold", "--frame-rate", "7"), "--frame-rate has no effect")

    def test_a_rendered_sequence_whose_video_ends_before_its_truth_is_refused(self):
        made("synth", "-o", "short.mkv", "--frames", "3", "--width", "320", "--height", "240")
        write("short.toml", 'name = "short"\n[background]\nvideo = "short.mkv"\n[lens]\nvertical_fov_deg = 40\n[motion]\nmodel = "none"\n'
              + '[output]\nvideo = "png"\n')
        made("render", "short.toml", "--out", ".", "--no-cache")
        last = max(os.path.join(place, name) for place, _, names in os.walk(path("short")) for name in names if name.endswith("000002.png"))
        os.rename(last, path("last.png"))
        detect = lambda: run("detect", "short", "-d", "frame-difference", "-o", "of-short")
        self.assert_refused(detect(), "ends before the labels of short do")
        os.rename(path("last.png"), last)
        self.assertIn("in 3 frames of 1 sequences", detect().stdout)


if __name__ == "__main__":
    EXAMPLE = os.path.abspath(sys.argv.pop())
    CLIENTS = os.path.abspath(sys.argv.pop())
    program.main(make_inputs)
