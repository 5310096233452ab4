# SPDX-License-Identifier: Apache-2.0
"""Aircraft that are made in code, from the list to the truth, without a package of models: python3 made_aircraft_test.py AIRTRUTH"""

import json
import math
import os
import subprocess
import unittest
import unittest.mock

from program import Case, main, made, path, read, run, write

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
WIDTH, HEIGHT, FIELD_DEG = 960, 640, 30
FOCAL_PX = HEIGHT / 2 / math.tan(math.radians(FIELD_DEG / 2))
SIZE_PX = 150
# Yaw, pitch and roll of an aircraft in front of a camera that looks north: what the camera sees of it.
SIDES = {"tail": (0, 0, 0), "left": (90, 0, 0), "nose": (180, 0, 0), "right": (-90, 0, 0), "below": (0, 90, 0), "above": (0, -90, 0)}
# Its longest side, with rotors turning; m.
TYPES = {"airship": 75.1, "glider": 17, "helicopter-light": 11.7, "helicopter-tandem": 30.1, "helicopter-turbine": 13, "helicopter-twin": 16.7,
         "paraglider": 9.1, "trike": 8.6}


def names():
    return made("aircraft", "list").stdout.split()


def scene(kind, exposure_s):
    """Six of a kind that hover in a grey sky, each seen from another side."""
    text = f"""
[background]
video = "grey"
frame_rate_hz = 30
[lens]
vertical_fov_deg = {FIELD_DEG}
[camera]
position_ned_m = [0, 0, -500]
attitude_yaw_pitch_roll_deg = [0, 0, 0]
[motion]
model = "none"
[shutter]
exposure_s = {exposure_s}
[output]
video = "mkv"
"""
    away_m = FOCAL_PX * TYPES[kind] / SIZE_PX
    for k, (side, (yaw, pitch, roll)) in enumerate(SIDES.items()):
        right_m = (k % 3 - 1) * 300 * away_m / FOCAL_PX
        down_m = -500 + (k // 3 - 0.5) * 300 * away_m / FOCAL_PX
        text += f"""
[[intruder]]
id = "{side}"
aircraft = "{kind}/white"
waypoints_ned_m = [[{away_m}, {right_m}, {down_m}], [{away_m + 0.01}, {right_m}, {down_m}]]
speed_mps = 0.002
yaw_deg = {yaw}
pitch_deg = {pitch}
roll_deg = {roll}
"""
    return text


def render_triangle(materials, ahead_m, yaw_deg):
    """A triangle of 12 m, 1 m below the camera, and its truth."""
    write("triangle.obj", materials + "v -6 0 0\nv 6 -5 0\nv 6 5 0\nf 1 2 3\nf 3 2 1\n")
    write("pass.toml", scene("trike", 0.00001).split("[[intruder]]")[0] + f"""
[[intruder]]
id = "near"
aircraft = "triangle.obj"
model_forward = "x"
model_up = "z"
waypoints_ned_m = [[{ahead_m}, 0.3, -499], [{ahead_m + 0.01}, 0.3, -499]]
speed_mps = 0.002
yaw_deg = {yaw_deg}
pitch_deg = 0
roll_deg = 0
""")
    made("render", "pass.toml", "--out", "out", "--overwrite")
    return json.loads(read("out", "pass", "truth.jsonl").splitlines()[0])["intruders"][0]


def luma_of(file):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", file, "-f", "rawvideo", "-pix_fmt", "gray", "-"], stdout=subprocess.PIPE, check=True).stdout
    return [raw[at:at + WIDTH * HEIGHT] for at in range(0, len(raw), WIDTH * HEIGHT)]


def changed_box(luma, cell_x, cell_y):
    """Left, top, right and bottom of what departs from the sky in a cell of the picture."""
    sky = luma[0]
    columns, rows = set(), set()
    for y in range(cell_y, cell_y + HEIGHT // 2):
        row = luma[y * WIDTH + cell_x:y * WIDTH + cell_x + WIDTH // 3]
        found = [x for x, value in enumerate(row) if abs(value - sky) > 1]
        if found:
            rows.add(y)
            columns.update((cell_x + found[0], cell_x + found[-1]))
    return min(columns), min(rows), max(columns) + 1, max(rows) + 1


class MadeAircraft(Case):
    def test_they_need_no_package(self):
        self.assertEqual({name.split("/")[0] for name in names()}, set(TYPES))
        self.assertEqual(len([name for name in names() if name.startswith("helicopter-light/")]), 6)
        shown = made("aircraft", "show", "helicopter-twin/rescue", "-o", "sheet.png").stdout
        for word in ("made in code", "rotor 13.80 m", "5 other liveries", "helicopter-twin/olive"):
            self.assertIn(word, shown)
        self.assertIn("as a Robinson R44", made("aircraft", "list", "helicopter-light/*", "--sizes").stdout)

    def test_a_name_that_is_none_is_one_line(self):
        self.assert_refused(run("aircraft", "show", "helicopter-light/pnik"), "helicopter-light/", "flightgear-data-ai")

    def test_truth_agrees_with_pixels_from_every_side(self):
        for kind in TYPES:
            # A helicopter's blades sweep by 20 to 30 degrees.
            for exposure_s in (0.00001, 0.01) if kind.startswith("helicopter") else (0.00001,):
                write("side.toml", scene(kind, exposure_s))
                made("render", "side.toml", "--out", "out", "--overwrite")
                luma = luma_of(path("out", "side", "side.mkv"))[0]
                truth = json.loads(read("out", "side", "truth.jsonl").splitlines()[0])
                for k, one in enumerate(truth["intruders"]):
                    box = one["exact_box_px"]
                    exact = box[0], box[1], box[0] + box[2], box[1] + box[3]
                    changed = changed_box(luma, k % 3 * WIDTH // 3, k // 3 * HEIGHT // 2)
                    for place, (a, b) in enumerate(zip(exact, changed)):
                        outside = a - b if place < 2 else b - a
                        self.assertLess(outside, 1, (kind, exposure_s, one["id"], exact, changed))
                        self.assertGreater(outside, -3, (kind, exposure_s, one["id"], exact, changed))

    def test_what_reaches_behind_the_camera_lies_in_its_exact_box(self):
        """Corners ahead bound only a part of what is seen, and where none is ahead nothing."""
        for ahead_m, yaw_deg in ((0, 0), (0, 180), (-1, 0), (4, 180)):
            near = render_triangle("", ahead_m, yaw_deg)
            (x, y, width, height), covered = near["exact_box_px"], near["covered_box_px"]
            self.assertEqual(near["state"], "visible")
            self.assertGreater(covered[2] * covered[3], 100 * 100, ahead_m)
            self.assertTrue(x < covered[0] + 1 and y < covered[1] + 1, (near["exact_box_px"], covered))
            self.assertTrue(x + width > covered[0] + covered[2] - 1 and y + height > covered[1] + covered[3] - 1, (near["exact_box_px"], covered))

    def test_a_file_that_a_model_names_in_other_letters_is_recorded_as_it_is_called(self):
        write("triangle.mtl", "newmtl red\nKd 1 0 0\n")
        render_triangle("mtllib TRIANGLE.MTL\nusemtl red\n", 4, 180)
        self.assertIn("/triangle.mtl", read("out", "pass", "sequence.json"))

    def test_a_catalogue_draws_them_by_pattern(self):
        write("set.toml", """
name = "set"
[[background]]
name = "sky"
flight = { seed = 1, frame_count = 4, width = 320, height = 240 }
lens = { vertical_fov_deg = 60 }
camera = { position_ned_m = [0, 0, -150], velocity_ned_mps = [20, 0, 0] }
[[random]]
count = 8
frame_count = 4
aircraft = ["helicopter-*", "glider/*"]
size_px = [20, 40]
bank_deg = "type"
[output]
video = "mkv"
""")
        plan = made("dataset", "plan", "set.toml")
        self.assertNotIn("cannot fly", plan.stderr)
        for kind in ("glider 2", "helicopter-light 2"):
            self.assertRegex(plan.stdout, rf"{kind.split()[0]}[ /\w]*\D{kind.split()[1]}")
        made("dataset", "build", "set.toml", "--out", "set")
        labelled = made("dataset", "export", "set", "--format", "coco", "--out", "coco", "--images", "none", "--split", "none")
        self.assertEqual(labelled.returncode, 0)

    @unittest.skipUnless(os.path.isdir("/usr/share/games/flightgear/AI/Aircraft"), "flightgear-data-ai is not installed")
    def test_the_shipped_traffic_can_be_flown(self):
        with unittest.mock.patch.dict(os.environ, {"AIRTRUTH_AIRCRAFT_PATH": ""}):
            plan = made("dataset", "plan", os.path.join(SOURCE, "catalogues", "traffic.toml"))
        self.assertIn("1000 sequences", plan.stdout)
        self.assertNotIn("cannot fly", plan.stdout + plan.stderr)


def without_models():
    os.environ["AIRTRUTH_AIRCRAFT_PATH"] = path("none")
    os.makedirs(path("grey"), exist_ok=True)
    for k in range(2):
        write(f"grey/{k}.pgm", b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + bytes([170]) * WIDTH * HEIGHT)
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", path("grey", f"{k}.pgm"), path("grey", f"{k}.png")], check=True)
        os.remove(path("grey", f"{k}.pgm"))


if __name__ == "__main__":
    main(without_models)
