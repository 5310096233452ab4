# SPDX-License-Identifier: Apache-2.0
"""A small set with distractors of every kind, from the catalogue to the exports: python3 distractors_test.py AIRTRUTH"""

import glob
import json

from program import Case, main, made, path, read, run, write

KINDS = {"bird", "multirotor", "balloon", "glint", "dirt", "insect"}
ON_THE_LENS = {"glint", "dirt", "insect"}

CATALOGUE = """
name = "set"
seed = 4
negatives = 0.5
[[background]]
name = "sky"
flight = { seed = 1, frame_count = 10, width = 320, height = 240 }
lens = { vertical_fov_deg = 60 }
camera = { position_ned_m = [0, 0, -150], velocity_ned_mps = [20, 0, 0] }
light = { sun_azimuth_deg = 15, sun_elevation_deg = 25 }
shutter = { exposure_s = 0.002 }
[output]
video = "mkv"
masks = true
[[random]]
name = "s{index}"
count = 4
frame_count = 10
aircraft = ["c172/*"]
size_px = [20, 40]
azimuth_deg = [-10, 10]
elevation_deg = [0, 10]
""" + "".join(f"""
[[distractor]]
kind = "{kind}"
""" + ("" if kind in ON_THE_LENS else "range_m = [10, 30]\nazimuth_deg = [-15, 15]\nelevation_deg = [-5, 12]\n")
              + ("flock = [2, 3]\nspread_m = [1, 2]\n" if kind == "bird" else "") for kind in sorted(KINDS))


def truth_of(sequence):
    return [json.loads(line) for line in read("set", "sequences", sequence, "truth.jsonl").splitlines()]


class ASet(Case):
    def test_plan_counts_what_is_no_aircraft(self):
        plan = made("dataset", "plan", "set.toml").stdout
        self.assertIn("2 sequences without one", plan)
        for kind in KINDS - {"bird"}:
            self.assertIn(f"{kind} 4", plan)

    def test_truth_has_every_class_and_the_lens_has_no_range(self):
        classes = set()
        for k in range(4):
            for frame in truth_of(f"s00000{k}"):
                for one in frame["intruders"]:
                    classes.add(one.get("class", "aircraft"))
                    self.assertEqual(one["range_m"] is not None, one.get("class") not in ON_THE_LENS and one["state"] != "ended", one)
        self.assertEqual(classes, KINDS | {"aircraft"})

    def test_it_comes_out_the_same_when_it_is_drawn_again(self):
        verified = made("dataset", "verify", "set", "--deep", "--every", "1")
        self.assertIn("40 drawn anew, 0 faults", verified.stdout)

    def test_the_e_vision_file_and_the_encounters_are_of_aircraft(self):
        for k in range(4):
            name = f"s00000{k}"
            record = json.loads(read("set", "sequences", name, "sequence.json"))
            aircraft = [i for i in truth_of(name)[0]["intruders"] if "class" not in i]
            self.assertEqual(len(record["encounters"]), len(aircraft))
            self.assertEqual(len(glob.glob(path("set", "sequences", name, "*.xml"))), 1)

    def test_exports_name_the_kinds(self):
        made("dataset", "export", "set", "--format", "coco", "--out", "coco", "--images", "none", "--one-class", "--split", "none")
        found = json.loads(read("coco", "annotations", "instances_all.json"))
        names = {c["id"]: c["name"] for c in found["categories"]}
        self.assertEqual(set(names.values()), KINDS | {"aircraft"})
        seen = {names[a["category_id"]] for a in found["annotations"]}
        self.assertIn("aircraft", seen)
        self.assertIn("bird", seen)
        made("dataset", "export", "set", "--format", "otb", "--out", "otb", "--images", "none", "--split", "none")
        self.assertEqual(len(glob.glob(path("otb", "all", "*", "groundtruth_rect.txt"))), 2)

    def test_trackers_follow_aircraft_alone(self):
        made("track", "set", "--tracker", "opencv-mosse", "-o", "results")
        tracked = [name for name in glob.glob(path("results", "**", "s0*.txt"), recursive=True) if not name.endswith("_time.txt")]
        self.assertEqual(len(tracked), 2)

    def test_the_page_tells_them_apart(self):
        made("dataset", "report", "set", "-o", "set.html")
        self.assertIn("2 of 4 sequences have no aircraft; distractors: 4 balloon", read("set.html"))

    def test_chroma_key_has_no_lens(self):
        write("key.toml", "[background]\nvideo = \"set/backgrounds/sky.mp4\"\n[lens]\nvertical_fov_deg = 60\n[composite]\nmethod = \"chroma-key\"\n"
                          "[[distractor]]\nkind = \"dirt\"\npixel = [10, 10]\n")
        videos = glob.glob(path("set", "**", "sky*.m*"), recursive=True)
        self.assertTrue(videos)
        write("key.toml", read("key.toml").replace("set/backgrounds/sky.mp4", videos[0]))
        self.assert_refused(run("render", "key.toml", "--out", "out"), "key.toml:", "chroma-key", "dirt")

    def test_a_scene_of_distractors_alone_has_no_intruder(self):
        write("dirt.toml", f"[background]\nvideo = \"{glob.glob(path('set', '**', 'sky*.m*'), recursive=True)[0]}\"\n"
                           "[lens]\nvertical_fov_deg = 60\n[[distractor]]\nkind = \"dirt\"\npixel = [10, 10]\n")
        self.assertIn("frames, no intruder, ", made("render", "dirt.toml", "--out", "out").stdout)


def make_set():
    write("set.toml", CATALOGUE)
    made("dataset", "build", "set.toml", "--out", "set")


if __name__ == "__main__":
    main(make_set)
