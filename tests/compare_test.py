# SPDX-License-Identifier: Apache-2.0
"""The command compare: python3 compare_test.py AIRTRUTH

An aircraft that render inserted stands for the real one, with the boxes of its own truth. Its type, attitude and light are known, and an
aircraft that compare inserts with the same type, attitude and light must measure alike.
"""

import csv
import json
import math
import os
import shutil
import struct
import subprocess
import unittest

import program
from program import made, path, read, run, write

YAW_DEG, PITCH_DEG, ROLL_DEG = 90, 0, 0
SCENE = f"""name = "real"
[background]
video = "sky.mkv"
[lens]
vertical_fov_deg = 60
[camera]
position_ned_m = [0, 0, -150]
[motion]
model = "none"
[light]
sun_azimuth_deg = 200
sun_elevation_deg = 40
exposure = 0.3
[[intruder]]
id = "one"
aircraft = "c172/news"
waypoints_ned_m = [[100, -20, -180], [100, 20, -180]]
speed_mps = 40
yaw_deg = {YAW_DEG}
pitch_deg = {PITCH_DEG}
roll_deg = {ROLL_DEG}
[output]
video = "mkv"
"""
NEWS = 'aircraft = "c172/news"\n'
FRAMES = 16
COMPARE = ("compare", "--real", "real/real.mkv", "--boxes", "boxes.csv", "--scene", "scene.toml")


def make_inputs():
    made("synth", "-o", "sky.mkv", "--width", "480", "--height", "360", "--frames", str(FRAMES), "--clouds", "0", "--noise", "0.5",
         "--shake", "0", "--quality", "5", "--no-own-aircraft", "--rotate-only", "--altitude", "800", "--truth", "sky.csv")
    write("scene.toml", SCENE)
    made("render", "scene.toml", "--out", ".")
    boxes = "frame,x,y,width,height\n"
    for line in read("real", "truth.jsonl").splitlines():
        frame = json.loads(line)
        if frame.get("intruders"):
            boxes += f"{frame['frame']}," + ",".join(map(str, frame["intruders"][0]["covered_box_px"])) + "\n"
    write("boxes.csv", boxes)
    made(*COMPARE, "-o", "alike", "--no-match")


def measures(folder):
    """Of a comparison: both values of each measure by the name's first words."""
    return {one["name"].split(",")[0]: (one["real"], one["inserted"]) for one in json.loads(read(folder, "comparison.json"))["measures"]}


def files(folder):
    """Every file below the folder with its content."""
    found = {}
    for root, _, names in os.walk(path(folder)):
        for name in names:
            with open(os.path.join(root, name), "rb") as file:
                found[os.path.relpath(os.path.join(root, name), path(folder))] = file.read()
    return found


class Compare(program.Case):
    def test_an_aircraft_like_the_real_one_measures_alike(self):
        found = measures("alike")
        # Shares within which two renderings agree that lie half a pixel and some degrees of view apart.
        shares = {"peak contrast above": 0.4, "peak contrast below": 0.15, "mean contrast above": 0.4, "mean contrast below": 0.15,
                  "edge": 0.15, "saturation": 0.15, "spectrum": 0.15, "motion against the background": 0.15}
        for name, share in shares.items():
            real, inserted = found[name]
            self.assert_near(inserted, real, share, name)
        # The aircraft crosses 40 m at 100 m and 40 m/s in 30 frames a second: 1.33 m a frame. The camera turns as sky.csv says.
        focal_px = 180 / 0.57735
        with open(path("sky.csv"), newline="", encoding="utf-8") as file:
            first, *_, last = csv.DictReader(file)
        turned = [math.radians(float(last[key]) - float(first[key])) / (FRAMES - 1) for key in ("yaw_deg", "pitch_deg")]
        motion_px = focal_px * math.hypot(1.333 / 100 + turned[0], turned[1])
        self.assert_near(found["motion against the background"][0], motion_px, 0.05, "motion of the real aircraft")
        # Darker than the sky beside it: the exposure says so.
        self.assertLess(found["contrast to the surroundings"][0], -10)

    def test_the_inserted_aircraft_cruises_with_its_gear_up(self):
        first = json.loads(read("alike", "sequence", "truth.jsonl").splitlines()[0])["intruders"][0]
        # 250 knots over ground, along its nose. A gear shows below 130 to 180 knots.
        for found, truth in zip(first["velocity_ned_mps"], (0, 250 * 1852 / 3600)):
            self.assertAlmostEqual(found, truth, 3)

    def test_the_exposure_of_the_scene_shows_in_the_contrast_alone_of_the_inserted_one(self):
        write("dark.toml", SCENE.replace("exposure = 0.3", "exposure = 0.1"))
        made("compare", "--real", "real/real.mkv", "--boxes", "boxes.csv", "--scene", "dark.toml", "-o", "dark", "--no-match")
        real, inserted = measures("dark")["mean contrast below"]
        self.assert_near(real, measures("alike")["mean contrast below"][0], 0.02, "the real aircraft")
        self.assertLess(inserted, 1.1 * real)  # both are below 0

    def test_pixels_that_are_not_square(self):
        """The inserted aircraft flies beside the real one in a clip of three quarters of the columns, too: both move as fast."""
        subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-i", path("real", "real.mkv"), "-vf", "scale=360:360:flags=area,setsar=4/3", "-c:v",
                        "ffv1", path("narrow.mkv")], check=True)
        head, *rows = read("boxes.csv").splitlines()
        narrow = [head]
        for row in rows:
            frame, x, y, width, height = row.split(",")
            narrow.append(f"{frame},{0.75 * float(x)},{y},{0.75 * float(width)},{height}")
        write("narrow.csv", "\n".join(narrow) + "\n")
        made("compare", "--real", "narrow.mkv", "--boxes", "narrow.csv", "--scene", "scene.toml", "-o", "narrow", "--no-match")
        real, inserted = measures("narrow")["motion against the background"]
        self.assert_near(inserted, real, 0.15, "motion against the background")
        # The sun is fitted where the aircraft is inserted.
        made("compare", "--real", "narrow.mkv", "--boxes", "narrow.csv", "--scene", "scene.toml", "-o", "narrow_sun", "--types", "c172/news")
        self.assertIn("sun", json.loads(read("narrow_sun", "comparison.json"))["pose"])

    def test_type_and_attitude_are_found(self):
        # The scale is that of the scene's own aircraft, which is not inserted.
        write("scaled.toml", SCENE.replace(NEWS, NEWS + "catalogue_scale = 4\n"))
        made(*COMPARE[:-1], "scaled.toml", "-o", "matched", "--types", "738/738-Ryanair,c172/news")
        pose = json.loads(read("matched", "comparison.json"))["pose"]
        self.assertEqual(pose["aircraft"], "c172/news")
        self.assertGreater(pose["overlap"], 0.7)
        for name, truth in (("yaw_deg", YAW_DEG), ("pitch_deg", PITCH_DEG), ("roll_deg", ROLL_DEG)):
            self.assertLess(abs(pose[name] - truth), 12, f"{name} of {pose}")

    def test_pictures_of_any_rate_have_the_aircraft_beside_the_real_one(self):
        write("pictures.toml", SCENE.replace('"real"', '"pictures"').replace('video = "mkv"', 'video = "png"'))
        made("render", "pictures.toml", "--out", ".")
        write("slow.toml", SCENE.replace('"sky.mkv"', '"sky.mkv"\nframe_rate_hz = 10'))
        made("compare", "--real", "pictures/pictures", "--boxes", "boxes.csv", "--scene", "slow.toml", "-o", "slow", "--no-match")
        self.assertGreaterEqual(json.loads(read("slow", "comparison.json"))["frames"], FRAMES - 2)
        real, inserted = measures("slow")["motion against the background"]
        self.assert_near(inserted, real, 0.15, "motion")

    def test_an_aircraft_of_any_axes_and_scale_is_as_large_as_the_real_one(self):
        # A block of 11 m along -y, 3 m high: in millimetres. The axes that an .obj has by itself show it upright.
        corners = [(x, y, z) for x in (-600, 600) for y in (-5500, 5500) for z in (-1500, 1500)]
        faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
        write("block.mtl", "newmtl dark\nKd 0.02 0.02 0.02\n")
        lines = ["mtllib block.mtl", "usemtl dark"] + [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {face}" for face in faces]
        write("block.obj", "\n".join(lines) + "\n")
        own = 'aircraft = "block.obj"\nmodel_forward = "-y"\nmodel_up = "z"\nmodel_scale = 0.001\n'
        for folder, aircraft in (("block", own), ("fourfold", NEWS + "catalogue_scale = 4\n")):
            with self.subTest(folder):
                write(f"{folder}.toml", SCENE.replace(NEWS, aircraft))
                made(*COMPARE[:-1], f"{folder}.toml", "-o", folder, "--no-match")
                self.assert_near(*reversed(measures(folder)["longest side"]), 0.15, "longest side")

    def test_the_folder_holds_what_the_documents_say(self):
        names = set(files("alike"))
        for name in ("comparison.json", "comparison.md", "figure.png", "patches.csv", "sequence/truth.jsonl"):
            self.assertIn(name, names)
        found = json.loads(read("alike", "comparison.json"))
        self.assertGreaterEqual(found["frames"], FRAMES - 2)
        for one in found["measures"]:
            self.assertIn(f"| {one['name']} |", read("alike", "comparison.md"))
        # Of each frame a line of the real and of the inserted aircraft, and a picture of both, of one size, side by side.
        rows = list(csv.DictReader(read("alike", "patches.csv").splitlines()))
        pictures = [name for name in names if name.startswith("patches/")]
        self.assertEqual([row["real"] for row in rows], ["1", "0"] * found["frames"])
        self.assertEqual(sorted(pictures), [f"patches/{int(row['frame']):06}.png" for row in rows[::2]])
        for name in pictures:
            with open(path("alike", name), "rb") as file:
                width, height = struct.unpack(">16x2I", file.read(24))
            self.assertEqual(width, 2 * height)
        for name, (real, inserted) in ((one["name"], (one["real"], one["inserted"])) for one in found["measures"]):
            if name in rows[0] and not name.startswith(("edge", "halo")):  # an edge that is nowhere clear does not count
                for which, value in (("1", real), ("0", inserted)):
                    values = sorted(float(row[name]) for row in rows if row["real"] == which)
                    self.assertTrue(values[0] <= value <= values[-1], name)
        self.assertIn("strongest red (Cr), code values", rows[0])

    def test_the_pitch_of_the_camera_is_the_one_that_is_stated_and_not_that_of_the_horizon(self):
        made(*COMPARE, "-o", "up", "--no-match", "--camera-pitch", "35")
        self.assertEqual(json.loads(read("up", "comparison.json"))["frames"], json.loads(read("alike", "comparison.json"))["frames"])

    def test_an_existing_folder_is_kept_unless_overwrite(self):
        shutil.copytree(path("alike"), path("kept"))
        before = files("kept")
        self.assert_refused(run(*COMPARE, "-o", "kept", "--no-match"), "exists already", "--overwrite")
        self.assertEqual(files("kept"), before)
        made(*COMPARE, "-o", "kept", "--no-match", "--overwrite", "--pairs", "2")
        self.assertNotEqual(files("kept")["figure.png"], before["figure.png"])
        self.assertEqual(files("kept")["comparison.json"], before["comparison.json"])

    def test_bad_input_is_refused_in_one_line_and_leaves_nothing(self):
        write("bad.csv", "frame,x,y,width,height\n0,10,10,5,5\n1,10,nan,5,5\n")
        write("sky.csv", "frame,x,y,width,height\n" + "".join(f"{i},300,60,20,12\n" for i in range(FRAMES)))
        write("empty.toml", SCENE[: SCENE.index("[[intruder]]")])
        write("text.mkv", "This is a letter and not a video.\n")
        cases = [
            ({"--boxes": "bad.csv"}, ("bad.csv:3", "nan")),
            ({"--boxes": "none.csv"}, ("none.csv",)),
            ({"--boxes": "sky.csv"}, ("real.mkv", "stands out")),  # a part of the sky without an aircraft
            ({"--scene": "empty.toml"}, ("empty.toml", "intruder")),
            ({"--scene": "none.toml"}, ("none.toml",)),
            ({"--real": "text.mkv"}, ("text.mkv",)),
            ({"--types": "c172/newz"}, ("no aircraft can be loaded",)),
        ]
        for change, words in cases:
            with self.subTest(change):
                options = {"--real": "real/real.mkv", "--boxes": "boxes.csv", "--scene": "scene.toml", **change}
                result = run("compare", *(word for option in options.items() for word in option), "-o", "refused")
                result.stderr = "".join(line for line in result.stderr.splitlines(True) if ": warning: " not in line)
                self.assert_refused(result, *words)
                self.assertFalse(os.path.exists(path("refused")))
                self.assertEqual([name for name in os.listdir(path()) if name.startswith(".")], [])

    def test_ctrl_c_leaves_nothing(self):
        stopped = program.interrupted([*COMPARE, "-o", "stopped"], program.has_written(".stopped.part"))
        self.assert_stopped(stopped)
        self.assertEqual([name for name in os.listdir(path()) if "stopped" in name], [])

    def test_realism_is_nowhere_farther_from_a_real_aircraft_than_the_plain_matte(self):
        real = os.path.join(os.environ.get("AIRTRUTH_SHARED", ""), "footage", "ground-real", "V_AIRPLANE_001.mp4")
        if not os.environ.get("AIRTRUTH_SHARED") or not os.path.exists(real):
            raise unittest.SkipTest("AIRTRUTH_SHARED/footage/ground-real/V_AIRPLANE_001.mp4 is not there")
        # Type, attitude and sun are those that compare finds in this clip.
        scene = """name = "ground"
[background]
video = "unused.mp4"
[lens]
vertical_fov_deg = 12
[light]
sun_azimuth_deg = 98
sun_elevation_deg = 16
[[intruder]]
aircraft = "beech-200/beech-200-d-ikob"
waypoints_ned_m = [[100, 0, 0], [200, 0, 0]]
speed_mps = 50
yaw_deg = 65
pitch_deg = 15
roll_deg = -28
"""
        off = {}
        for folder, realism in (("plain", ""), ("realistic", "[realism]\nauto = true\nfallback = true\n")):
            write(f"{folder}.toml", scene + realism)
            made("compare", "--real", real, "--boxes", real.replace(".mp4", ".csv"), "--origin", "1", "--scene", f"{folder}.toml",
                 "-o", folder, "--frames", "10", "--no-match")
            found = {one["name"]: one["inserted"] / one["real"] for one in json.loads(read(folder, "comparison.json"))["measures"]
                     if one["name"] in ("edge, 10 to 90 %, px", "spectrum, share above 1/4 cycle/px", "noise inside, code values",
                                        "peak contrast below, code values")}
            self.assertEqual(len(found), 4)
            off[folder] = {name: abs(math.log(share)) for name, share in found.items()}
        for name, plain in off["plain"].items():
            self.assertLess(off["realistic"][name], plain, name)
        self.assertLess(off["realistic"]["edge, 10 to 90 %, px"], math.log(1.25))


if __name__ == "__main__":
    program.main(make_inputs)
