# SPDX-License-Identifier: Apache-2.0
"""Catalogues and data sets through the program, as its users run it: python3 dataset_test.py AIRTRUTH"""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

AIRTRUTH = ""
ROOT = ""

SKY = """[[background]]
name = "sky"
flight = { seed = 3, frame_count = 8, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
"""

RANDOM = """[[random]]
count = 4
frame_count = 6
aircraft = ["738/738-Ryanair"]
"""

PARTS = """[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
[[trajectory]]
name = "across"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
"""


def path(*names):
    return os.path.join(ROOT, *names)


def write(name, text):
    os.makedirs(os.path.dirname(path(name)), exist_ok=True)
    with open(path(name), "w") as file:
        file.write(text)
    return path(name)


def run(*arguments, **how):
    return subprocess.run(
        [AIRTRUTH, *arguments], cwd=how.pop("cwd", ROOT), capture_output=True, text=True, errors="replace", timeout=120, **how
    )


class Refusals(unittest.TestCase):
    def refused(self, text, *words):
        done = run("dataset", "plan", write("refused.toml", text))
        self.assertEqual(done.returncode, 2, f"{text}\n{done.stdout}{done.stderr}")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_a_first_frame_past_the_end(self):
        self.assertEqual(run("synth", "-o", "short.mkv", "--frames", "8", "--width", "160", "--height", "120").returncode, 0)
        flight = re.search("flight = .*", SKY).group()
        for source in (flight, 'video = "short.mkv"'):
            begins = lambda frame: SKY.replace(flight, f"{source}\nfirst_frame = {frame}") + RANDOM
            self.assertEqual(run("dataset", "plan", write("last.toml", begins(7))).returncode, 0)
            self.refused(begins(8), "refused.toml:1:1:", "holds 8 frames; first_frame = 8 is past its end")

    def test_every_empty_list_is_one_line(self):
        random = lambda line: SKY + re.sub(rf"(?m)^{line.split()[0]} = .*\n", "", RANDOM) + line + "\n"
        for key in ("aircraft", "backgrounds"):
            self.refused(random(f"{key} = []"), "refused.toml:", key, "empty")
        for key in ("range_m", "azimuth_deg", "elevation_deg", "speed_mps", "heading_deg", "climb_deg",
                    "sun_azimuth_deg", "sun_elevation_deg"):
            self.refused(random(f"{key} = []"), "refused.toml:", key, "array of 0")
        for key in ("backgrounds", "trajectories", "aircraft"):
            self.refused(SKY + PARTS + f"[[product]]\n{key} = []\n", "refused.toml:", key, "empty")
        for key in ("background", "aircraft", "trajectory"):
            tables = [SKY] + PARTS.split("[[trajectory]]")
            tables = [t if t.startswith("[[") else "[[trajectory]]" + t for t in tables]
            kept = "".join(t for t in tables if not t.startswith(f"[[{key}]]"))
            self.refused(f"{key} = []\n" + kept + "[[product]]\n", "refused.toml", f"there is no [[{key}]]")
        for key in ("sequence", "product", "random"):
            self.refused(f"{key} = []\n" + SKY + PARTS, "refused.toml", "makes no sequence")
        for line in ("waypoints_ned_m = []", "times_s = []"):
            text = PARTS.replace("speed_mps = 60\n", "times_s = [0, 1]\n")
            text = re.sub(rf"(?m)^{line.split()[0]} = .*\n", line + "\n", text)
            self.refused(SKY + text + "[[product]]\n", "refused.toml:", "waypoints")
        for key, values in (("camera", ("position_ned_m", "velocity_ned_mps", "attitude_yaw_pitch_roll_deg")),
                            ("lens", ("focal_px", "principal_point_px")),
                            ("light", ("sky_colour", "ground_colour")),
                            ("air", ("extinction_per_km", "airlight"))):
            for value in values:
                sky = re.sub(rf"(?m)^{key} = .*\n", "", SKY)
                self.refused(sky + f"{key} = {{ {value} = [] }}\n" + RANDOM, "refused.toml:", value)
        self.refused("[slurm]\nsbatch = []\n" + SKY + RANDOM, "refused.toml:2", "sbatch", "empty")


class Slurm(unittest.TestCase):
    def scripts(self, folder, catalogue, *options):
        out = path(folder)
        done = run("dataset", "submit", catalogue, "--out", out, "--slurm", "--dry-run", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        texts = []
        for name in ("work.sh", "verify.sh"):
            with open(os.path.join(out, "slurm", name)) as file:
                texts.append(file.read())
        return texts

    def test_options_come_from_the_table_and_from_the_command_line(self):
        table = '[slurm]\ntime = "1-02:30:00"\nmemory = "4G"\npartition = "short,long"\naccount = "avionics"\ncpus = 2\nsbatch = ["--nice=100"]\n'
        catalogue = write("cluster.toml", table + SKY + RANDOM)
        for text in self.scripts("cluster", catalogue, "--sbatch", "--time=20:00", "--sbatch", "--exclude node[1-3]"):
            lines = [line for line in text.splitlines() if line.startswith("#SBATCH ")]
            for wanted in ("--time=1-02:30:00", "--mem=4G", "--partition=short,long", "--account=avionics", "--cpus-per-task=2"):
                self.assertIn("#SBATCH " + wanted, lines)
            # sbatch takes the last of two.
            self.assertGreater(lines.index("#SBATCH --time=20:00"), lines.index("#SBATCH --time=1-02:30:00"))
            self.assertIn("#SBATCH --exclude=node[1-3]", lines)

    def test_an_array_is_read_as_sbatch_states_it(self):
        catalogue = write("array.toml", SKY + RANDOM)
        count = self.scripts("array-all", catalogue)[0].split("--array=0-")[1].split("\n")[0]
        for number, (options, array) in enumerate((
                (("--array-size", "2"), "0-1"), (("--array-size", "2%1"), "0-1%1"), (("--array-size", "%4"), f"0-{count}%4"),
                (("--sbatch", "--array=0-1%4"), "0-1%4"), (("--sbatch", "--array %3"), f"0-{count}%3"),
                (("--sbatch", "--array=0"), "0-0"), (("--array-size", "2", "--sbatch", "--array=%4"), "0-1%4"))):
            work, verify = self.scripts(f"array{number}", catalogue, *options)
            self.assertEqual([line for line in work.splitlines() if "--array" in line], ["#SBATCH --array=" + array], options)
            self.assertIn(f"--of {int(array.split('-')[1].split('%')[0]) + 1} ", work)
            self.assertNotIn("--array", verify)
        work, _ = self.scripts("array-table", write("array2.toml", '[slurm]\nsbatch = ["--array=%7"]\n' + SKY + RANDOM))
        self.assertIn(f"#SBATCH --array=0-{count}%7\n", work)
        for option, value in (("--array-size", "0"), ("--array-size", "2%"), ("--array-size", "%0"), ("--array-size", "a%4"),
                              ("--sbatch", "--array=1,3"), ("--sbatch", "--array=0-9:2"), ("--sbatch", "--array=0-9%0"),
                              ("--sbatch", "--array")):
            done = run("dataset", "submit", catalogue, "--out", path("never"), "--slurm", "--dry-run", option, value)
            self.assertEqual(done.returncode, 2, value)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertFalse(os.path.exists(path("never")))

    def test_values_are_checked(self):
        for line, word in (("time = \"soon\"", "time"), ("time = \"1:2:3:4\"", "time"), ("memory = \"4 G\"", "memory"),
                           ("memory = \"lots\"", "memory"), ("partition = \"a b\"", "partition"),
                           ("account = \"$(id)\"", "account"), ("cpus = 0", "cpus"), ("sbatch = [\"--wrap=id\"]", "wrap"),
                           ("sbatch = [\"time=3\"]", "--name=value"), ("sbatch = [\"--mem=`id`\"]", "sbatch")):
            done = run("dataset", "plan", write("bad.toml", f"[slurm]\n{line}\n" + SKY + RANDOM))
            self.assertEqual(done.returncode, 2, line)
            self.assertRegex(done.stderr, r"bad\.toml:2:")
            self.assertIn(word, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)
        catalogue = write("good.toml", SKY + RANDOM)
        for value in ("--mem=4G\nrm -rf /", "--comment=\"x\"", "-p x", "mem", "--array=1-9", "--output=/etc/x", "--x=$(id)", "--x=a;b", ""):
            done = run("dataset", "submit", catalogue, "--out", path("never"), "--slurm", "--dry-run", "--sbatch", value)
            self.assertEqual(done.returncode, 2, value)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertFalse(os.path.exists(path("never")))

    def test_names_go_into_the_script_as_they_are(self):
        """The words that a shell makes of the script's command are the ones that were given, and nothing else is run."""
        odd = "a'b\"c $(touch EVIL) `touch EVIL` ; touch EVIL # %a -x &"
        catalogue = write(odd + "/cat\nalogue.toml", SKY + RANDOM)
        video = write("v\n#SBATCH --x/video '1'.mp4", "")
        made = run("synth", "-o", path("plain.mp4"), "--width", "160", "--height", "120", "--frames", "4")
        self.assertEqual(made.returncode, 0, made.stderr)
        os.replace(path("plain.mp4"), video)
        work, verify = self.scripts(odd + "/out", catalogue, "--background", "sky=" + video)
        for text, number in ((work, 2), (verify, 3)):
            directives = [line for line in text.split("exec ")[0].splitlines()]
            self.assertEqual(directives[0], "#!/bin/sh")
            self.assertTrue(all(line.startswith("#SBATCH --") for line in directives[1:]), text)
            command = text[text.index("exec ") + 5:]
            script = write("echo.sh", "for word in " + command.strip() + "; do printf '%s\\0' \"$word\"; done\n")
            shell = subprocess.run(["sh", script], cwd=ROOT, capture_output=True, text=True,
                                   env={"PATH": os.environ["PATH"], "SLURM_ARRAY_TASK_ID": "3"})
            words = shell.stdout.split("\0")[:-1]
            self.assertEqual(words[1], "dataset", shell.stderr)
            self.assertIn(path(odd, "out"), words)
            if number == 2:
                self.assertEqual(words[3], catalogue)
                self.assertEqual(words[-1], "sky=" + path("v\n#SBATCH --x/video '1'.mp4"))
        self.assertFalse([name for _, _, names in os.walk(ROOT) for name in names if name == "EVIL"])
        # As sbatch reads the line: in double quotes a backslash keeps the character after it; %% is one %.
        log = re.search(r'(?m)^#SBATCH --output="((?:[^"\\]|\\.)*)"$', work).group(1)
        self.assertEqual(re.sub(r"\\(.)", r"\1", log).replace("%%", "%"), path(odd, "out", "slurm", "work-%a.log"))

    def test_a_job_is_found_among_notes_and_none_is_left_alone(self):
        note = "echo 'sbatch: note: 1234 core hours are left' >&2\n"
        write("bin/sbatch", f"#!/bin/sh\n{note}echo \"$*\" >> calls\n[ -e refuses ] && case \"$*\" in *afterany*) echo 'sbatch: error: limit' >&2; exit 1;; esac\necho '4711;far'\n{note}")
        write("bin/scancel", "#!/bin/sh\necho \"$*\" > cancelled\n")
        for name in ("sbatch", "scancel"):
            os.chmod(path("bin", name), 0o755)
        submit = lambda out: run("dataset", "submit", write("noted.toml", SKY + RANDOM), "--out", path(out), "--slurm", env={**os.environ, "PATH": path("bin") + ":" + os.environ["PATH"]})
        done = submit("noted")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(path("calls")) as calls:
            self.assertIn("--dependency=afterany:4711 ", calls.read().splitlines()[1])
        write("refuses", "")
        done = submit("refused")
        self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1), done.stderr)
        self.assertIn("sbatch failed: sbatch: note: 1234 core hours are left; sbatch: error: limit; expected", done.stderr)
        with open(path("cancelled")) as cancelled:
            self.assertEqual(cancelled.read(), "--clusters=far 4711\n")

    def test_a_path_that_no_script_can_hold_is_refused(self):
        catalogue = write("plain.toml", SKY + RANDOM)
        for name in ("line\nbreak", "back\\slash"):
            done = run("dataset", "submit", catalogue, "--out", path(name), "--slurm", "--dry-run")
            self.assertEqual(done.returncode, 2)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertFalse(os.path.exists(path(name)))


class Clips(unittest.TestCase):
    """Random sequences over videos of other programs."""

    def truths(self, name, video, keys):
        """The frames of each sequence of a set of six."""
        subprocess.run(["ffmpeg", "-nostdin", "-v", "error", "-y", *video.split(), path(name)], check=True)
        table = f'[[background]]\nname = "clip"\nvideo = "{name}"\nlens = {{ vertical_fov_deg = 75 }}\nmotion = {{ model = "none" }}\n'
        write(name + ".toml", table + keys + "azimuth_deg = [-5, 5]\nelevation_deg = [-5, 5]\n" + '[output]\nvideo = "mkv"\n')
        done = run("dataset", "build", path(name + ".toml"), "--out", path(name + ".set"))
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        folder = path(name + ".set", "sequences")
        found = []
        for sequence in sorted(os.listdir(folder)):
            with open(os.path.join(folder, sequence, "truth.jsonl")) as file:
                found.append([json.loads(line) for line in file])
        self.assertEqual(len(found), 6)
        return found

    def test_random_starts_lie_within_the_picture_where_the_sound_is_longer(self):
        video = "-f lavfi -i testsrc2=s=160x120:r=25:d=0.8 -f lavfi -i sine=d=4 -c:v libx264 -c:a aac"
        keys = '[[random]]\ncount = 6\nframe_count = 5\nstart = "random"\naircraft = ["c172/news"]\nsize_px = [8, 12]\n'
        for frames in self.truths("sound.mkv", video, keys):
            self.assertEqual(len(frames), 5)

    def test_what_is_drawn_over_a_variable_rate_flies_to_the_end(self):
        video = "-f lavfi -i testsrc2=s=160x120:r=25:d=6 -vf select='lt(n,100)+not(mod(n,5))' -fps_mode vfr -c:v libx264"
        keys = ('first_frame = 98\n[[distractor]]\nkind = "balloon"\n[[random]]\ncount = 6\nframe_count = 12\n'
                'aircraft = ["c172/news"]\nsize_px = [12, 12]\n')
        for frames in self.truths("variable.mp4", video, keys):
            self.assertAlmostEqual(frames[-1]["time_s"], 0.04 * 2 + 0.2 * 9, places=6)
            self.assertNotIn("ended", [thing["state"] for frame in frames for thing in frame["intruders"]])
            boxes = [thing["exact_box_px"] for frame in frames for thing in frame["intruders"] if thing["aircraft"] == "c172/news"]
            self.assertLess(min(abs(max(box[2:]) - 12) for box in boxes if box), 0.01)


class Sets(unittest.TestCase):
    """Sequences with several intruders and with none, through everything that reads a data set."""

    FORMATS = ("coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot")

    @classmethod
    def setUpClass(cls):
        cls.catalogue = write("mixed.toml", SKY + """[output]
video = "mkv"
[[random]]
count = 4
frame_count = 6
aircraft = ["738/738-Ryanair", "c172/news"]
size_px = [20, 60]
azimuth_deg = [-5, 5]
elevation_deg = [-5, 5]
speed_mps = "type"
bank_deg = "type"
intruders = [1, 2]
negatives = 0.5
start = "random"
time_of_day_h = [9, 15]
""")
        made = run("dataset", "build", cls.catalogue, "--out", path("mixed"))
        assert made.returncode == 0 and "4 sequences made" in made.stdout and "complete" in made.stdout, made.stdout + made.stderr
        cls.kinds = {}
        for name in sorted(os.listdir(path("mixed", "sequences"))):
            with open(path("mixed", "sequences", name, "truth.jsonl")) as file:
                cls.kinds[name] = len(json.loads(file.readline())["intruders"])

    def test_half_of_them_are_negatives(self):
        self.assertEqual(sum(1 for kind in self.kinds.values() if kind == 0), 2, self.kinds)

    def test_the_plan_says_what_is_drawn(self):
        said = run("dataset", "plan", self.catalogue)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertEqual(said.stdout.count("no intruder"), 2)
        self.assertIn(f"intruders: {sum(self.kinds.values())} in 2 sequences; 2 sequences without one", said.stdout)
        self.assertRegex(said.stdout, r"sizes: [0-9]+ to [0-9]+ px, half of them below [0-9]+ px")
        self.assertRegex(said.stdout, r"types: .*(738|c172) [12]")
        self.assertEqual(said.stderr, "")

    def test_the_plan_warns_of_what_is_not_flyable(self):
        fast = write("fast.toml", SKY + "[[random]]\ncount = 9\naircraft = [\"c172/*\"]\nspeed_mps = [131, 131]\n")
        said = run("dataset", "plan", fast)
        self.assertEqual(said.returncode, 0)
        self.assertRegex(said.stderr, r"r000000: c172/\S+ \(light piston\) cannot fly its path: at [0-9.]+ s it flies 131\.0 m/s, the fastest of its class 92 m/s")
        self.assertIn("9 of 9 intruders", said.stderr)

    def test_verify_report_and_status_take_negatives(self):
        for command in (("verify", path("mixed"), "--deep", "--every", "2"), ("status", path("mixed")),
                        ("report", path("mixed"), "--out", path("mixed.html"))):
            done = run("dataset", *command)
            self.assertEqual(done.returncode, 0, f"{command}: {done.stdout}{done.stderr}")

    def test_every_format_takes_negatives(self):
        for kind in self.FORMATS:
            done = run("dataset", "export", path("mixed"), "--format", kind, "--out", path("as", kind), "--split", "none")
            self.assertEqual(done.returncode, 0, f"{kind}: {done.stdout}{done.stderr}")

    def test_a_set_of_negatives_alone_is_exported(self):
        alone = write("none.toml", SKY + RANDOM.replace("count = 4", "count = 1") + "negatives = 1\n")
        self.assertEqual(run("dataset", "build", alone, "--out", path("none")).returncode, 0)
        for kind in self.FORMATS:
            done = run("dataset", "export", path("none"), "--format", kind, "--out", path("of none", kind))
            self.assertIn(done.returncode, (0, 2), f"{kind}: {done.stdout}{done.stderr}")
            if done.returncode:
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for command in (("dataset", "verify", path("none")), ("dataset", "report", path("none"), "--out", path("none.html"))):
            done = run(*command)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_trackers_and_pictures_take_negatives(self):
        negative = [name for name, kind in self.kinds.items() if kind == 0][0]
        folder = path("mixed", "sequences", negative)
        done = run("overlay", folder, "--out", path("overlay.mkv"))
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        tracked = run("track", path("mixed"), "--tracker", "opencv-kcf", "--out", path("tracks"))
        self.assertEqual(tracked.returncode, 0, tracked.stdout + tracked.stderr)
        scored = run("evaluate", path("mixed"), path("tracks", "opencv-kcf"), "--out", path("scores"))
        self.assertEqual(scored.returncode, 0, scored.stdout + scored.stderr)

    def test_render_takes_a_scene_without_an_intruder(self):
        self.assertEqual(run("synth", "-o", path("bare.mkv"), "--width", "160", "--height", "120", "--frames", "5").returncode, 0)
        for method in ("matte", "chroma-key"):
            scene = write(f"{method}.toml", f'[background]\nvideo = "bare.mkv"\n[lens]\nvertical_fov_deg = 75\n[output]\nvideo = "mkv"\n'
                          f'[composite]\nmethod = "{method}"\n')
            done = run("render", scene, "--out", path("bare"), *(("--gpu", "none") if method == "chroma-key" else ()))
            if method == "chroma-key" and "EGL" in done.stderr:
                continue
            self.assertEqual(done.returncode, 0, done.stderr)
            made = path("bare", method)
            for name in (f"{method}.mkv", f"{method}.xml", "truth.jsonl", "sequence.json", "preview.jpg"):
                self.assertTrue(os.path.getsize(os.path.join(made, name)) > 0, name)
            # What is not covered leaves as it came.
            frames = [subprocess.run(["ffmpeg", "-v", "error", "-i", video, "-f", "md5", "-"], capture_output=True, text=True).stdout
                      for video in (path("bare.mkv"), os.path.join(made, f"{method}.mkv"))]
            if all(frames):
                self.assertEqual(frames[0], frames[1])

    def test_render_warns_of_a_path_that_the_type_cannot_fly(self):
        run("synth", "-o", path("short.mkv"), "--width", "160", "--height", "120", "--frames", "12")
        scene = write("fast scene.toml", 'name = "fast"\n[background]\nvideo = "short.mkv"\n[lens]\nvertical_fov_deg = 75\n'
                      '[[intruder]]\naircraft = "c172/news"\nwaypoints_ned_m = [[200, -40, -150], [200, 400, -150]]\nspeed_mps = 131\n')
        done = run("render", scene, "--out", path("fast"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"fast scene\.toml:6:1: intruder 'intruder-1': c172/news \(light piston\) cannot fly its path: at [0-9.]+ s it flies "
                         r"131\.0 m/s, the fastest of its class 92 m/s")


if __name__ == "__main__":
    AIRTRUTH = os.path.abspath(sys.argv.pop(1))
    with tempfile.TemporaryDirectory(prefix="airtruth_dataset_test_") as folder:
        ROOT = folder
        unittest.main(verbosity=1)
