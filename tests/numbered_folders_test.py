# SPDX-License-Identifier: Apache-2.0
"""A data set whose sequences lie in numbered folders, through everything that makes, lists or opens them: python3 numbered_folders_test.py AIRTRUTH"""

import json
import os
import shutil
import signal
import subprocess
import time

import program
from program import Case, made, main, path, read, run, write

SEQUENCES, PER_FOLDER = 5, 2
CATALOGUE = """[[background]]
name = "sky"
flight = { seed = 3, frame_count = 8, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
[output]
video = "mkv"
[[random]]
count = %d
frame_count = 6
aircraft = ["738/738-Ryanair", "c172/news"]
size_px = [20, 60]
azimuth_deg = [-5, 5]
elevation_deg = [-5, 5]
""" % SEQUENCES
PLACES = ["0001/r000000", "0001/r000001", "0002/r000002", "0002/r000003", "0003/r000004"]
NAMES = [place[5:] for place in PLACES]
DIVIDED = ("--folder-size", str(PER_FOLDER))


def places_of(folder):
    """The places of the finished sequences below sequences/, and of what is hidden there."""
    root = path(folder, "sequences")
    found, hidden = [], []
    for where, folders, files in os.walk(root):
        hidden += [name for name in folders + files if name.startswith(".")]
        if "sequence.json" in files:
            found.append(os.path.relpath(where, root))
    return sorted(found), hidden


def texts_below(folder):
    """Of an export; its record names the set's folder."""
    found = {}
    for where, _, names in os.walk(folder):
        for name in names:
            if name != "export.json":
                with open(os.path.join(where, name), "rb") as file:
                    found[os.path.relpath(os.path.join(where, name), folder)] = file.read()
    return found


def bytes_of(folder):
    """Name of a sequence and of its file -> content, but for the record, which holds paths."""
    found = {}
    for place in places_of(folder)[0]:
        where = path(folder, "sequences", place)
        for name in os.listdir(where):
            if name != "sequence.json":
                with open(os.path.join(where, name), "rb") as file:
                    found[os.path.basename(place), name] = file.read()
    return found


def make_inputs():
    write("set.toml", CATALOGUE)
    made("dataset", "build", path("set.toml"), "--out", path("flat"))
    made("dataset", "build", path("set.toml"), "--out", path("divided"), *DIVIDED)


class NumberedFolders(Case):
    @property
    def catalogue(self):
        return path("set.toml")

    def test_a_set_up_to_the_size_lies_in_one_folder(self):
        self.assertEqual(places_of("flat")[0], NAMES)
        self.assertFalse(os.path.exists(path("flat", "sequences", "layout.json")))
        made("dataset", "build", self.catalogue, "--out", path("just"), "--folder-size", str(SEQUENCES), "--only", "r000000")
        self.assertEqual(places_of("just")[0], NAMES[:1])

    def test_the_sequences_are_the_same_in_both_layouts(self):
        self.assertEqual(places_of("divided"), (PLACES, []))
        self.assertEqual(bytes_of("divided"), bytes_of("flat"))

    def test_the_manifest_states_where_they_lie(self):
        lines = [json.loads(line) for line in read("divided", "manifest", "00000.jsonl").splitlines()]
        self.assertEqual([line["folder"] for line in lines], ["sequences/" + place for place in PLACES])
        self.assertEqual([line["name"] for line in lines], NAMES)

    def test_status_and_verify_find_each(self):
        self.assertIn("5 of 5 sequences are there; complete", made("dataset", "status", path("divided")).stdout)
        said = made("dataset", "verify", path("divided"), "--deep", "--every", "3").stdout
        self.assertIn("5 sequences, 30 frames", said)
        self.assertIn(", 0 faults", said)

    def test_verify_finds_what_is_wrong_in_any_folder_in_the_order_of_the_catalogue(self):
        shutil.copytree(path("divided"), path("spoilt"))
        for place in (PLACES[4], PLACES[1]):
            os.truncate(path("spoilt", "sequences", place, "truth.jsonl"), 10)
        shutil.rmtree(path("spoilt", "sequences", PLACES[2]))
        said = {}
        for jobs in ("1", "3"):
            done = run("dataset", "verify", path("spoilt"), "--jobs", jobs)
            self.assertEqual(done.returncode, 1)
            said[jobs] = done.stderr
        self.assertEqual(said["1"], said["3"])
        named = [line.split(": ")[2] for line in said["1"].splitlines()]
        self.assertEqual(sorted(set(named), key=named.index), [NAMES[1], NAMES[2], NAMES[4]])
        self.assertIn(NAMES[2] + ": is not there", said["1"])
        self.assertIn("missing: " + NAMES[2], made("dataset", "status", path("spoilt")).stdout)

    def test_a_killed_build_goes_on_across_folders(self):
        command = [program._airtruth, "dataset", "build", self.catalogue, "--out", path("killed"), "--jobs", "1", *DIVIDED]
        kills = 0
        for _ in range(40):
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            before = len(places_of("killed")[0]) if os.path.isdir(path("killed", "sequences")) else 0
            until = time.monotonic() + program.HANG_S
            # Killed while a sequence is under way after at least one more is whole.
            while process.poll() is None and time.monotonic() < until:
                if os.path.isdir(path("killed", "sequences")):
                    whole, hidden = places_of("killed")
                    if len(whole) > before and hidden:
                        process.send_signal(signal.SIGKILL)
                        break
                time.sleep(0.002)
            if process.wait(timeout=program.HANG_S) == 0:
                break
            kills += 1
            self.assertNotIn("complete", made("dataset", "status", path("killed")).stdout)
        self.assertGreater(kills, 0)
        made("dataset", "build", self.catalogue, "--out", path("killed"))
        self.assertEqual(places_of("killed"), (PLACES, []))
        self.assertEqual(bytes_of("killed"), bytes_of("flat"))

    def test_a_set_keeps_the_layout_in_which_it_was_begun(self):
        made("dataset", "build", self.catalogue, "--out", path("old"), "--only", "r000000")
        said = made("dataset", "build", self.catalogue, "--out", path("old"), *DIVIDED).stdout
        self.assertIn("4 sequences made", said)
        self.assertIn("1 were there", said)
        self.assertEqual(places_of("old")[0], NAMES)
        made("dataset", "build", self.catalogue, "--out", path("new"), "--only", "r000004", *DIVIDED)
        self.assertEqual(places_of("new")[0], PLACES[4:])
        said = made("dataset", "build", self.catalogue, "--out", path("new"), "--folder-size", "3").stdout
        self.assertIn("4 sequences made", said)
        self.assertEqual(places_of("new")[0], PLACES)

    def test_workers_share_the_folders_of_a_submitted_set(self):
        made("dataset", "submit", self.catalogue, "--out", path("cluster"), "--slurm", "--dry-run", *DIVIDED)
        for index in ("1", "0"):
            made("dataset", "work", self.catalogue, "--out", path("cluster"), "--index", index, "--of", "2", "--jobs", "1")
        made("dataset", "verify", path("cluster"), "--finish")
        self.assertEqual(places_of("cluster"), (PLACES, []))
        self.assertEqual(read("cluster", "manifest", "00000.jsonl").count("\n"), SEQUENCES)

    def test_a_failed_sequence_leaves_nothing(self):
        broken = write("broken.ac", "this is no model")
        catalogue = write("bad.toml", CATALOGUE + f"""[[aircraft]]
name = "broken"
aircraft = "{broken}"
[[trajectory]]
name = "across"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
[[sequence]]
name = "bad"
background = "sky"
trajectory = "across"
aircraft = "broken"
""")
        done = run("dataset", "build", catalogue, "--out", path("bad"), "--folder-size", "1")
        self.assertEqual(done.returncode, 1)
        self.assertIn("bad: ", done.stderr)
        found, hidden = places_of("bad")
        self.assertEqual(len(found), SEQUENCES)
        self.assertEqual(hidden, [])
        self.assertEqual(len(os.listdir(path("bad", "sequences"))), SEQUENCES + 2)  # an empty folder, and layout.json

    def test_report_and_every_export_read_each(self):
        made("dataset", "report", path("divided"), "--out", path("report.html"))
        page = read("report.html")
        for place in PLACES:
            self.assertIn(f"divided/sequences/{place}/truth.jsonl", page)
        for kind in ("coco", "yolo", "mot", "voc", "cvat", "aot", "otb"):
            texts = {}
            for folder in ("flat", "divided"):
                out = path("exported")  # some formats name this folder
                said = made("dataset", "export", path(folder), "--format", kind, "--out", out, "--images", "none").stdout
                self.assertIn(": 5 sequences, 30 frames", said)
                texts[folder] = texts_below(out)
                shutil.rmtree(out)
            self.assertEqual(texts["flat"], texts["divided"], kind)

    def test_trackers_and_overlays_read_each(self):
        made("track", path("divided"), "--tracker", "opencv-kcf", "--out", path("tracks"))
        made("evaluate", path("divided"), path("tracks", "opencv-kcf"), "--out", path("scores"))
        scored = json.loads(read("scores", "evaluation.json"))
        self.assertEqual([one["name"] for one in scored["trackers"][0]["sequences"]], NAMES)
        made("overlay", path("divided", "sequences", PLACES[3]), "--out", path("overlay.mkv"))

    def test_a_broken_layout_is_one_line(self):
        shutil.copytree(path("divided", "sequences"), path("torn", "sequences"))
        write("torn/sequences/layout.json", '{"format": "airtruth layout 1"}')
        shutil.copy(path("divided", "catalogue.toml"), path("torn", "catalogue.toml"))
        for command in (("verify", path("torn")), ("status", path("torn")), ("report", path("torn"), "--out", path("torn.html")),
                        ("build", self.catalogue, "--out", path("torn"))):
            done = run("dataset", *command)
            self.assertEqual(done.returncode, 2, command)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn("layout.json", done.stderr)


if __name__ == "__main__":
    main(make_inputs)
