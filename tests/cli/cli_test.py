# SPDX-License-Identifier: Apache-2.0
"""Runs the program as its users do: python3 cli_test.py AIRTRUTH"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import wave

AIRTRUTH = ""
ROOT = ""

SCENE = """name = "clip"
[background]
video = "{video}"
{background}
[lens]
model = "pinhole"
{lens}
[camera]
position_ned_m = [0, 0, -150]
[motion]
model = "none"
{more}
[[intruder]]
id = "one"
aircraft = "{aircraft}"
waypoints_ned_m = {waypoints}
speed_mps = 50
[output]
video = "{output}"
"""


def scene(**change):
    """The text of a scene that renders, but for what `change` says."""
    keys = {
        "video": "flight.mkv",
        "background": "",
        "lens": "vertical_fov_deg = 75",
        "more": "",
        "aircraft": "c172/news",
        "waypoints": "[[60, -8, -150], [60, 100, -150]]",
        "output": "mkv",
    }
    keys.update(change)
    return SCENE.format(**keys)


def path(*names):
    return os.path.join(ROOT, *names)


def write(name, content):
    with open(path(name), "wb") as file:
        file.write(content.encode() if isinstance(content, str) else content)
    return path(name)


def run(*arguments, prefix=()):
    return subprocess.run(
        [*prefix, AIRTRUTH, *arguments], cwd=ROOT, capture_output=True, text=True, errors="replace", timeout=120
    )


def make_inputs():
    made = run("synth", "-o", "flight.mkv", "--width", "160", "--height", "120", "--frames", "12", "--no-own-aircraft")
    assert made.returncode == 0, made.stderr
    made = run("synth", "-o", "flight.mp4", "--width", "160", "--height", "120", "--frames", "12", "--no-own-aircraft")
    assert made.returncode == 0, made.stderr
    write("empty.mkv", b"")
    write("text.mkv", "This is a letter and not a video.\n" * 50)
    with wave.open(path("audio.wav"), "wb") as audio:
        audio.setnchannels(1)
        audio.setsampwidth(2)
        audio.setframerate(8000)
        audio.writeframes(bytes(16000))
    with open(path("flight.mp4"), "rb") as video:
        write("cut.mp4", video.read()[:200])
    # Binary PGM pictures, which need no library to write.
    write("small.pgm", b"P5\n16 12\n255\n" + b"\xff" * (16 * 12))
    write("black.pgm", b"P5\n160 120\n255\n" + b"\x00" * (160 * 120))


def write_pictures(folder):
    """Three numbered pictures with a pattern as fine as noise."""
    os.makedirs(path(folder), exist_ok=True)
    for number in range(3):
        write(f"{folder}/{number:05}.pgm", b"P5\n160 120\n255\n" + bytes((x * 7919 + number) % 251 for x in range(160 * 120)))


class Case(unittest.TestCase):
    def setUp(self):
        self.out = os.path.join(ROOT, "out-" + self.id().split(".")[-1])
        os.mkdir(self.out)

    def render(self, text, *arguments, out=None):
        return run("render", write("scene.toml", text), "--out", out or self.out, "--no-cache", *arguments)

    def assert_refused(self, result, *words):
        """One line that says what is wrong, exit code 2, and nothing left."""
        self.assertEqual(result.returncode, 2, result.stderr)
        lines = result.stderr.splitlines()
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertTrue(lines[0].startswith("airtruth: error: "), lines[0])
        for word in words:
            self.assertIn(word.lower(), lines[0].lower())
        self.assertEqual(os.listdir(self.out), [])


class Help(Case):
    def test_every_subcommand_explains_itself(self):
        for words in (["demo"], ["render"], ["overlay"], ["inspect"], ["motion"], ["synth"], ["aircraft"], ["evision"], ["track"], ["evaluate"],
                      ["aircraft", "list"], ["aircraft", "show"]):
            result = run(*words, "--help")
            self.assertEqual(result.returncode, 0, words)
            self.assertRegex(result.stdout, rf"airtruth.* {words[-1]}\b", words)
            self.assertEqual(result.stderr, "", words)

    def test_version_and_no_arguments(self):
        self.assertRegex(run("--version").stdout, r"^airtruth \d+\.\d+")
        self.assert_refused(run())
        self.assert_refused(run("rendre"), "did you mean 'render'")
        self.assert_refused(run("rendre", "--help"), "did you mean 'render'")
        self.assert_refused(run("render", "scene.toml", "--no-such-option"))


class BadVideo(Case):
    def test_is_refused_in_one_line(self):
        for video in ("missing.mkv", "empty.mkv", "text.mkv", "audio.wav", "cut.mp4"):
            with self.subTest(video):
                self.assert_refused(self.render(scene(video=video)), video)


class BadScene(Case):
    def test_unknown_key_gets_the_nearest_spelling(self):
        self.assert_refused(self.render(scene(background="first_frmae = 1")), "first_frmae", "first_frame", "scene.toml:4")

    def test_an_unknown_word_is_named_before_what_is_missing(self):
        for line, words in (("rendr", "no command 'rendr'; did you mean 'render'"), ("--quiet rendr --help", "no command 'rendr'"),
                            ("dataset plam", "no command 'plam'; did you mean 'plan'"), ("render --hlep", "no option '--hlep'; did you mean '--help'"),
                            ("render x.toml --ou=y", "no option '--ou'; did you mean '--out'")):
            self.assert_refused(run(*line.split()), words)

    def test_unknown_aircraft_gets_the_nearest_names(self):
        result = self.render(scene(aircraft="c172/newz"))
        self.assert_refused(result, "c172/newz", "scene.toml:")
        self.assertRegex(result.stderr.replace("c172/newz", ""), r"\bc172\b")

    def test_masks(self):
        self.assert_refused(self.render(scene(background='mask = "small.pgm"')), "small.pgm", "16", "160")
        self.assert_refused(self.render(scene(background='mask = "black.pgm"')), "black.pgm")
        self.assert_refused(self.render(scene(background='mask = "none.png"')), "none.png")

    def test_waypoints(self):
        for waypoints in ("[]", "[[60, 0, -150]]", "[[60, 0], [60, 9]]", '"north"', "[[60, 0, -150], [60, 0, -150]]",
                          "[[60, 0, nan], [60, 9, -150]]"):
            with self.subTest(waypoints):
                self.assert_refused(self.render(scene(waypoints=waypoints)), "scene.toml:")

    def test_focal_length(self):
        self.assert_refused(self.render(scene(lens="focal_px = [-480, 480]")), "focal_px", "-480", "scene.toml:")

    def test_not_toml_not_utf8_not_there(self):
        self.assert_refused(self.render("name = = 3\n"), "scene.toml:1")
        self.assert_refused(run("render", write("bad.toml", b'name = "\xff\xfe"\n'), "--out", self.out), "bad.toml", "utf-8")
        self.assert_refused(run("render", "no.toml", "--out", self.out), "no.toml")

    def test_a_video_where_a_scene_belongs(self):
        for command in (["render", "flight.mkv", "--out", self.out], ["preview", "flight.mp4", "-o", os.path.join(self.out, "p.png")],
                        ["render", ROOT, "--out", self.out]):
            self.assert_refused(run(*command), command[1], "airtruth scene new")

    def test_an_unknown_detector_gets_each_name_once(self):
        result = run("detect", "flight.mkv", "-d", "nonsense", "-o", os.path.join(self.out, "d"))
        self.assert_refused(result, "nonsense", "frame-difference")
        for name in ("onnx:MODEL.onnx", "exec:COMMAND", "cmo,"):
            self.assertEqual(result.stderr.count(name), 1, result.stderr)


class Output(Case):
    def test_that_exists_is_kept_until_overwrite(self):
        self.assertEqual(self.render(scene()).returncode, 0)
        record = os.path.join(self.out, "clip", "sequence.json")
        before = os.stat(record)
        again = self.render(scene())
        self.assertEqual(again.returncode, 2)
        self.assertEqual(len(again.stderr.splitlines()), 1)
        self.assertIn("--overwrite", again.stderr)
        after = os.stat(record)
        self.assertEqual((before.st_ino, before.st_mtime_ns), (after.st_ino, after.st_mtime_ns))
        replaced = self.render(scene(), "--overwrite")
        self.assertEqual(replaced.returncode, 0, replaced.stderr)
        self.assertNotEqual(os.stat(record).st_ino, before.st_ino)
        self.assertEqual(os.listdir(self.out), ["clip"])

    def test_folder_that_cannot_be_written(self):
        write("a_file", "not a folder")
        self.assert_refused(self.render(scene(), out=path("a_file", "below")))
        closed = "/proc/airtruth"  # closed to root too
        self.assert_refused(self.render(scene(), out=closed), closed)

    def test_full_disk(self):
        # A tiny disk in a mount namespace of its own, which goes when its shell does.
        script = ('mount -t tmpfs -o size=16k tmpfs "$1" || exit 77; shift; dir=$1; shift; '
                  '"$@"; code=$?; ls -A "$dir" | sed "s/^/left: /"; exit $code')
        scene_file = write("scene.toml", scene())
        result = subprocess.run(
            ["unshare", "-m", "sh", "-c", script, "sh", self.out, self.out, AIRTRUTH, "render", scene_file, "--out",
             self.out, "--no-cache"], cwd=ROOT, capture_output=True, text=True, timeout=120)
        if result.returncode == 77 or "unshare" in result.stderr:
            self.skipTest("a small disk cannot be mounted here")
        self.assert_refused(result)
        self.assertNotIn("left:", result.stdout)


class Render(Case):
    def test_leaves_a_whole_folder_that_overlay_and_inspect_read(self):
        result = self.render(scene())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        folder = os.path.join(self.out, "clip")
        self.assertEqual(sorted(os.listdir(folder)), ["clip.mkv", "clip.xml", "preview.jpg", "sequence.json", "truth.jsonl"])
        with open(os.path.join(folder, "truth.jsonl")) as file:
            truth = [json.loads(line) for line in file]
        frames = [line for line in truth if "frame" in line]
        self.assertEqual([line["frame"] for line in frames], list(range(12)))
        with open(os.path.join(folder, "sequence.json")) as file:
            self.assertEqual(json.load(file)["summary"]["frames"], 12)

        boxes = os.path.join(self.out, "boxes.mp4")
        result = run("overlay", folder, "-o", boxes)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(os.path.getsize(boxes), 1000)
        picture = os.path.join(self.out, "closeup.png")
        result = run("inspect", folder, "--frame", "3", "-o", picture)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(picture, "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        beyond = run("inspect", folder, "--frame", "12", "-o", os.path.join(self.out, "no.png"))
        self.assertEqual(beyond.returncode, 2)
        self.assertIn("expected 0 to 11", beyond.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.out, "no.png")))

    def test_an_intruder_never_in_view_is_a_warning(self):
        result = self.render(scene(waypoints="[[-60, -8, -150], [-60, 100, -150]]"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stderr, r"^airtruth: warning: .*'one' is never visible")

    def test_ctrl_c_ends_a_run_before_it_is_done_and_leaves_nothing(self):
        long = path("long.mkv")
        made = run("synth", "-o", long, "--width", "320", "--height", "240", "--frames", "120", "--no-own-aircraft")
        self.assertEqual(made.returncode, 0, made.stderr)
        # An aircraft all over the view by the oracle: a frame alone takes seconds.
        text = scene(video="long.mkv", more="[render]\nquality = 5", waypoints="[[15, -4, -150], [15, 400, -150]]")
        text = text.replace("speed_mps = 50", "speed_mps = 1")
        program = subprocess.Popen(
            [AIRTRUTH, "render", write("long.toml", text), "--out", self.out, "--no-cache"], cwd=ROOT,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 30
        part = os.path.join(self.out, ".clip.part")
        while not os.path.exists(os.path.join(part, "truth.jsonl")) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertIsNone(program.poll(), "the run was over before it could be interrupted")
        program.send_signal(signal.SIGINT)
        _, errors = program.communicate(timeout=120)  # of minutes of frames; the limit only stops a hang
        self.assertEqual(program.returncode, 130, errors)
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertEqual(os.listdir(self.out), [])


class Studio(Case):
    def test_an_interrupt_ends_it_and_leaves_the_folder_as_it_was(self):
        file = write("studio.toml", scene())
        before = sorted(os.listdir(ROOT))
        program = subprocess.Popen([AIRTRUTH, "studio", file], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertRegex(program.stdout.readline(), r"^http://127\.0\.0\.1:[0-9]+/\?token=[0-9a-f]{32}$")
        program.send_signal(signal.SIGINT)
        said, errors = program.communicate(timeout=120)
        self.assertEqual((program.returncode, said, errors), (130, "ended; steps that are not saved are kept for the next start\n", ""))
        self.assertEqual(sorted(os.listdir(ROOT)), before)

    def test_a_scene_or_video_that_is_not_there(self):
        for missing in ("none.toml", "none.mp4"):
            refused = run("studio", path(missing))
            self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
            self.assertIn(missing, refused.stderr)


class Track(Case):
    def track(self, *arguments, source="flight.mkv"):
        return run("track", source, "-t", "am3", "--out", path(self.out, "results"), *arguments)

    def test_a_video_from_a_box_on(self):
        for again in (False, True):
            done = self.track("--init", "60,40,30.5,20", "--first-frame", "2")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("were there" in done.stdout, again)
        with open(path(self.out, "results", "am3", "flight.txt"), encoding="utf-8") as file:
            lines = file.read().splitlines()
        self.assertEqual(len(lines), 10)
        self.assertEqual(lines[0], "60,40,30.5,20")
        for other, word in ((["--init", "61,40,30.5,20"], "another box"), (["--init", "60,40,30.5,20", "--seed", "2"], "seed")):
            refused = self.track(*other)
            self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
            self.assertIn(word, refused.stderr)

    def test_results_of_another_frame_or_video_are_not_kept(self):
        os.makedirs(path("elsewhere"), exist_ok=True)
        shutil.copy(path("flight.mkv"), path("elsewhere"))
        box = ["--init", "60,40,30.5,20"]
        self.assertEqual(self.track(*box).returncode, 0)
        for arguments, source, word in ((box + ["--first-frame", "2"], "flight.mkv", "first_frame 0"), (box, "elsewhere/flight.mkv", "elsewhere")):
            refused = self.track(*arguments, source=source)
            self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
            self.assertIn(word, refused.stderr)
        self.assertIn("1 were there", self.track(*box, source=path("flight.mkv")).stdout)
        shutil.copy(path("flight.mp4"), path("elsewhere", "flight.mkv"))
        anew = lambda: run("track", "elsewhere/flight.mkv", "-t", "am3", "--out", path(self.out, "anew"), *box)
        self.assertEqual(anew().returncode, 0)
        shutil.copy(path("flight.mkv"), path("elsewhere"))
        refused = anew()
        self.assertEqual((refused.returncode, refused.stderr.count("\n")), (2, 1), refused.stderr)
        self.assertIn("source_sha256", refused.stderr)
        os.remove(path(self.out, "results", "am3", "flight.run.json"))  # as an older airtruth left it
        self.assertIn("1 were there", self.track(*box, source="elsewhere/flight.mkv").stdout)

    def test_the_results_of_pictures_are_named_by_their_folder(self):
        for name, source in (("pics", "pics/"), ("pics2", "pics2/%05d.pgm")):
            write_pictures(name)
            done = self.track("--init", "60,40,30,20", source=source)
            self.assertEqual((done.returncode, "were there" in done.stdout), (0, False), done.stderr)
            self.assertTrue(os.path.exists(path(self.out, "results", "am3", name + ".txt")))

    def test_what_is_wrong_is_said_before_anything_is_made(self):
        for arguments, word in (([], "--init"), (["--init", "1,2,3"], "x,y,width,height"), (["--init", "1,2,0,4"], "above 0"),
                                (["--init", "1,2,nan,4"], "above 0"), (["--init", "500,1,3,4"], "160x120"),
                                (["--init", "1,2,3,4", "--first-frame", "99"], "past its end"),
                                (["--init", "1,2,3,4", "--protocol", "restart"], "truth"),
                                (["--init", "1,2,3,4", "--protocol", "restrat"], "did you mean 'restart'"),
                                (["--init", "1,2,3,4", "-t", "am4"], "did you mean 'am3'")):
            with self.subTest(arguments):
                self.assert_refused(self.track(*arguments), word)
        self.assert_refused(self.track(source="nothing"), "does not exist")
        self.assert_refused(self.track("--init", "1,2,3,4", source="text.mkv"), "text.mkv")

    def see_refused_beside(self, name, refused, *words):
        """The command that `refused` runs says that the folder is of others, and leaves the file in it alone."""
        file = path(self.out, *name)
        os.makedirs(os.path.dirname(file))
        with open(file, "w", encoding="utf-8") as mine:
            mine.write("60,40,30.5,20\n")
        done = refused()
        self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertEqual(os.listdir(os.path.dirname(file)), [name[-1]])
        os.remove(file)

    def test_results_of_others_are_not_taken_for_its_own(self):
        self.see_refused_beside(("results", "am3", "flight.txt"), lambda: self.track("--init", "60,40,30.5,20"), "holds no tracker.json")
        self.assertEqual(self.track("--init", "60,40,30.5,20").returncode, 0)

    def test_an_evaluation_replaces_no_page_of_others(self):
        self.see_refused_beside(("evaluation", "report.html"), lambda: run("evaluate", "nothing", "results", "-o", path(self.out, "evaluation")),
                                "holds no evaluation.json or detection.json")

    def test_what_evaluate_refuses(self):
        for arguments, word in ((["nothing", "results"], "nothing"), (["nothing", "results", "--figures", "gif"], "png, pdf or svg"),
                                (["nothing", "results", "--eao-range", "9", "3"], "backward")):
            with self.subTest(arguments):
                self.assert_refused(run("evaluate", *arguments, "-o", path(self.out, "evaluation")), word)


class Others(Case):
    def test_a_new_scene_names_its_video_relative_to_itself(self):
        os.mkdir(os.path.join(self.out, "scenes"))
        file = os.path.join(self.out, "scenes", "new.toml")
        made = run("scene", "new", "flight.mkv", "-o", file)
        self.assertEqual(made.returncode, 0, made.stderr)
        with open(file) as text:
            words = text.read()
        self.assertIn('video = "../../flight.mkv"', words)
        self.assertIn("# [realism]", words)
        # The closest approach lies within the clip's 0.37 s.
        self.assertLess(float(words.split("cpa_time_s = ")[1].split("#")[0]), 0.4)
        self.assertEqual(run("preview", file, "-o", os.path.join(self.out, "p.png")).returncode, 0)

    def test_preview_says_that_the_clip_is_shorter(self):
        for count, is_said in ((12, False), (500, True)):
            made = run("preview", write("scene.toml", scene(background=f"frame_count = {count}")),
                       "-o", os.path.join(self.out, f"{count}.png"))
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertEqual("frame_count is 500" in made.stderr and "only 12 frames" in made.stderr, is_said, made.stderr)

    def test_motion(self):
        table = os.path.join(self.out, "motion.csv")
        result = run("motion", "flight.mkv", "-o", table)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(table) as file:
            lines = file.read().splitlines()
        self.assertTrue(lines[0].startswith("frame,time_s,h11"))
        self.assertEqual(len(lines), 13)
        self.assertIn("--overwrite", run("motion", "flight.mkv", "-o", table).stderr)
        os.remove(table)
        self.assert_refused(run("motion", "text.mkv", "-o", table), "text.mkv")

    def test_degrees_of_a_log_tell_metres(self):
        # From here to there 4 m north and 19 m east.
        log = write("log.csv", "time_s,latitude_deg,longitude_deg,altitude_m\n" + "".join(
            f"{k},{33.125401 + 1e-5 * k:.6f},{-117.331234 + 5e-5 * k:.6f},100\n" for k in range(5)))
        said = run("log", "show", log).stdout
        self.assertIn("latitude: 33.125401 to 33.125441 degrees", said)
        self.assertIn("longitude: -117.331234 to -117.331034 degrees", said)

    def test_synth(self):
        for name in ("a", "b"):
            result = run("synth", "-o", os.path.join(self.out, name + ".mkv"), "--width", "64", "--height", "64",
                         "--frames", "2", "--truth", os.path.join(self.out, name + ".csv"))
            self.assertEqual(result.returncode, 0, result.stderr)
        tables = []
        for name in ("a.csv", "b.csv"):
            with open(os.path.join(self.out, name)) as file:
                tables.append(file.read())
        self.assertEqual(tables[0], tables[1])
        self.assertEqual(len(tables[0].splitlines()), 3)

    def test_no_control_character_of_a_name_reaches_the_terminal(self):
        made = run("synth", "-o", os.path.join(self.out, "a\x1b[31m.mkv"), "--width", "64", "--height", "64", "--frames", "2")
        self.assertEqual(made.returncode, 0, made.stderr)
        self.assertIn("a?[31m.mkv: 2 frames", made.stdout)

    def test_a_cache_that_others_may_write_is_said_once(self):
        made = run("synth", "-o", os.path.join(self.out, "w.mkv"), "--width", "160", "--height", "120", "--frames", "10")
        self.assertEqual(made.returncode, 0, made.stderr)
        cache = os.path.join(self.out, "cache")
        os.makedirs(os.path.join(cache, "airtruth", "motion"))
        os.chmod(os.path.join(cache, "airtruth", "motion"), 0o777)
        with open(os.path.join(self.out, "w.toml"), "w") as file:
            file.write("[background]\nvideo = \"w.mkv\"\n[lens]\nvertical_fov_deg = 60\n[motion]\nmodel = \"homography\"\n")
        result = run("render", os.path.join(self.out, "w.toml"), "--out", self.out, prefix=("env", "XDG_CACHE_HOME=" + cache))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr.count("nothing is kept there; expected a folder of the user's own"), 1, result.stderr)

    def test_calibrate_names_what_is_missing_and_nothing_else(self):
        """The extinction takes the lens and the altitude; a file that lacks one names that one."""
        made = run("synth", "-o", os.path.join(self.out, "c.mkv"), "--width", "160", "--height", "120", "--frames", "10", "--no-own-aircraft")
        self.assertEqual(made.returncode, 0, made.stderr)
        with open(os.path.join(self.out, "lens.yml"), "w") as file:
            file.write("image_width: 160\nimage_height: 120\ncamera_matrix: [100, 0, 79.5, 0, 100, 59.5, 0, 0, 1]\ndistortion_coefficients: [0, 0, 0, 0]\n")
        lens = ["--lens", os.path.join(self.out, "lens.yml")]
        cases = [([], "--lens", "--altitude"), (["--altitude", "80"], "--lens", ""), (lens, "--altitude", "")]
        for words, *named in cases:
            made = run("calibrate", os.path.join(self.out, "c.mkv"), "-o", os.path.join(self.out, "c.toml"), "--overwrite", *words)
            self.assertEqual(made.returncode, 0, made.stderr)
            notes = [line for line in made.stderr.splitlines() if "air.extinction_per_km" in line]
            self.assertEqual(len(notes), 1, made.stderr)
            for option in ("--lens", "--altitude"):
                self.assertEqual(option in notes[0], option in named, notes[0])

    def test_camera_profiles_are_listed_named_and_refused_for_other_sizes(self):
        listed = run("calibrate", "--list-profiles")
        self.assertEqual(listed.returncode, 0, listed.stderr)
        names = [line.split()[0] for line in listed.stdout.splitlines() if line.strip()]
        self.assertGreaterEqual(len(names), 3, listed.stdout)
        out = ["-o", os.path.join(self.out, "p.toml"), "--overwrite"]
        for size in ("160", "192"):
            made = run("synth", "-o", os.path.join(self.out, f"p{size}.mkv"), "--width", size, "--height", "120", "--frames", "10")
            self.assertEqual(made.returncode, 0, made.stderr)
        one, other = (os.path.join(self.out, f"p{size}.mkv") for size in ("160", "192"))
        for words, said in (([one, "--profile", names[0] + "x"], f"did you mean '{names[0]}'?"),
                            ([one, "--profile", names[0]], "the clip is 160 x 120"),
                            ([one, other], "expected clips of one camera in one size"),
                            ([one, one, "--plot", os.path.join(self.out, "p.png")], "--plot draws one clip")):
            refused = run("calibrate", *words, *out)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertEqual(len(refused.stderr.splitlines()), 1, refused.stderr)
            self.assertIn(said, refused.stderr)
        alone = run("calibrate", one, *out, "--profile", "none")
        self.assertEqual(alone.returncode, 0, alone.stderr)
        self.assertNotIn("median over", alone.stdout + alone.stderr)
        copy = shutil.copy(one, os.path.join(self.out, "copy.mkv"))
        usual = run("calibrate", one, copy, *out)
        self.assertEqual(usual.returncode, 0, usual.stderr)
        self.assertIn("of the median over 3 cameras", usual.stdout)  # 10 frames of 160 x 120 show no clean edge
        with open(os.path.join(self.out, "p.toml")) as file:
            self.assertIn("of the median over 3 cameras", file.read())

    def test_lens_crop_writes_what_the_refusal_offers(self):
        profile = os.path.join(self.out, "lens.yml")
        with open(profile, "w") as file:
            file.write("image_width: 160\nimage_height: 120\ncamera_matrix: [100, 0, 79.5, 0, 100, 59.5, 0, 0, 1]\ndistortion_coefficients: [0, 0, 0, 0]\n")
        wide = os.path.join(self.out, "wide.yml")
        refused = run("calibrate", "flight.mkv", "-o", os.path.join(self.out, "c.toml"), "--lens", profile)
        self.assertNotIn("lens.yml", refused.stderr)  # of the same shape
        made = run("lens", "crop", profile, "--size", "320x180", "-o", wide)
        self.assertEqual(made.returncode, 0, made.stderr)
        # Twice the size; the middle stays the middle.
        self.assertIn("focal_px = [200.0, 200.0]\nprincipal_point_px = [160.0, 90.0]", made.stdout)
        refused = run("motion", "flight.mkv", "-o", os.path.join(self.out, "m.csv"), "--model", "rotation", "--lens", wide)
        self.assertEqual(refused.returncode, 2)
        self.assertIn(f"was made for 320x180, but the video is 160x120", refused.stderr)
        self.assertIn(f"airtruth lens crop {wide} --size 160x120", refused.stderr)
        # A stated lens makes the motion a rotation, as in a scene.
        turned = os.path.join(self.out, "turned.csv")
        measured = run("motion", "flight.mkv", "-o", turned, "--lens", profile)
        self.assertEqual(measured.returncode, 0, measured.stderr)
        with open(turned) as file:
            self.assertTrue(file.readline().startswith("frame,time_s,qw"))
        plain = run("motion", "flight.mkv", "-o", turned, "--overwrite")
        self.assertIn("homography; with --lens rotation", plain.stdout)
        refused = run("lens", "crop", profile, "--size", "wide")
        self.assertEqual(refused.returncode, 2)

    def test_lens_crop_says_that_a_limit_is_lost(self):
        profile = os.path.join(self.out, "limited.json")
        for limit, said in ((1, True), (0, False)):  # the tangent of 45 degrees; none
            with open(profile, "w") as file:
                json.dump({"calib_dimension": {"w": 160, "h": 120},
                           "fisheye_params": {"camera_matrix": [[80, 0, 79.5], [0, 80, 59.5], [0, 0, 1]],
                                              "distortion_coeffs": [0, 0, 0, 0], "radial_distortion_limit": limit}}, file)
            made = run("lens", "crop", profile, "--size", "160x90")
            self.assertEqual(made.returncode, 0, made.stderr)
            self.assertEqual("the calibration ends at 45.0 degrees" in made.stderr, said, made.stderr)

    def test_aircraft(self):
        result = run("aircraft", "list", "c172")
        self.assertEqual(result.returncode, 0)
        self.assertIn("c172/news", result.stdout.splitlines())
        for words in ("C172", "C172/*", "*NEWS"):
            self.assertIn("c172/news", run("aircraft", "list", words).stdout.splitlines(), words)
        for name in run("aircraft", "list", "c172/*").stdout.splitlines():
            self.assertTrue(name.startswith("c172/"), name)
        self.assert_refused(run("aircraft", "list", "zeppelin"))
        self.assert_refused(run("aircraft", "show", "C172"), "unknown aircraft 'C172'", "c172/")
        self.assert_refused(run("aircraft", "show", "C172/NEWS"), "c172/news")
        result = run("aircraft", "show", "c172/news")
        self.assertEqual(result.returncode, 0, result.stderr)
        size = re.search(r"length ([\d.]+) m, span ([\d.]+) m", result.stdout)
        self.assertTrue(size, result.stdout)
        self.assertAlmostEqual(float(size[1]), 8.3, delta=0.8)  # a Cessna 172: 8.28 m long, 11.0 m across
        self.assert_refused(run("aircraft", "show", "c172/newz"), "c172/newz")


if __name__ == "__main__":
    AIRTRUTH = os.path.abspath(sys.argv.pop(1))
    ROOT = tempfile.mkdtemp(prefix="airtruth_cli_test_")
    os.environ["XDG_CACHE_HOME"] = os.path.join(ROOT, "cache")
    try:
        make_inputs()
        unittest.main(verbosity=1)
    finally:
        shutil.rmtree(ROOT, ignore_errors=True)
