# SPDX-License-Identifier: Apache-2.0
"""Names that are commands, markup, options, paths or no text at all, wherever a name can stand:
python3 names_test.py AIRTRUTH [--short] [PART...]

--short: a few names and changes of each part. Each works, or is one line of error; nothing is run, and nothing outside the output is written or removed.
"""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile

import common
from common import Broken

NAMES = {
    "quotes": "a'b\"c",
    "command": "$(touch pwned)",
    "backticks": "`touch pwned`",
    "semicolon": "a;touch pwned;",
    "newline": "a\ntouch pwned\n",
    "script": "<script>document.title='pwned'</script>",
    "closing": "</script><b>x",
    "dash": "-rf",
    "option": "--help",
    "percent": "%s%n%05d",
    "long": "x" * 300,
    "long200": "y" * 200,
    "right-to-left": "abc\u202egnp.exe",
    "hebrew": "\u05e9\u05dc\u05d5\u05dd",
    "blank": " a b ",
    "dollar": "$HOME",
    "backslash": "a\\nb",
    "dots": "..",
    "up": "../up",
    "absolute": "/tmp/airtruth-absolute",
    "hidden": ".hidden",
    "bytes": b"\xff\xfe\x80",
    "brackets": "a[0]*?",
    "braces": "{x}{0}",
    "comma": "a,b=c",
    "part": ".x.part",
}


def toml(name):
    """A TOML string of the name; bytes that are no UTF-8 stand as they are."""
    if isinstance(name, bytes):
        return b'"' + name + b'"'
    return json.dumps(name, ensure_ascii=False).replace("\u007f", "\\u007f").encode()


def filled(text, name):
    return text.encode().replace(b"@NAME@", toml(name))


SCENE = common.SCENE.replace('name = "out"', "name = @NAME@").replace("aircraft =", "id = @NAME@\naircraft =")


# All that a shell, a page and a plot can trip over in one that a file can have.
NAMES["all"] = "-a'b\"c;$(touch pwned)`touch pwned`%s<script>document.title='pwned'<b>x\\n{0}[a]*"
SHORT = ("bytes", "long", "up", "all")
SHORT_CHANGES = 6  # of the records, every n-th


class Names:
    def __init__(self, airtruth, root):
        self.airtruth, self.root = airtruth, root
        self.data = os.path.join(root, "data")
        self.work = os.path.join(root, "work")
        self.environment = common.environment(os.path.join(root, "cache"))
        self.worked = self.refused = 0
        self.step = 1

    def run(self, what, *words, codes=(0, 2)):
        done = common.run([self.airtruth, *words], what, codes, cwd=self.work, env=self.environment)
        self.worked += done.code == 0
        self.refused += done.code == 2
        for place in (self.work, self.root, self.data, "/tmp"):
            if os.path.exists(os.path.join(place, "pwned")):
                raise Broken(f"{what}: a name was run")
        return done

    def see_outside(self, what):
        """Only the work folder may change."""
        if common.difference(self.outside, self.outside_now()):
            raise Broken(f"{what}: changed outside its output: {common.difference(self.outside, self.outside_now())}")

    def outside_now(self):
        found = common.state(self.data)
        found.update({n: "there" for n in os.listdir(self.root) if n not in ("work", "cache")})
        found["/tmp/airtruth-absolute"] = os.path.exists("/tmp/airtruth-absolute")
        return found

    def prepare(self):
        os.makedirs(self.data)
        common.run([self.airtruth, "synth", "-o", f"{self.data}/clip.mkv", "--width", "64", "--height", "64", "--frames", "3"], codes=(0,))
        common.write(f"{self.data}/set.toml", common.CATALOGUE)
        common.run([self.airtruth, "dataset", "build", f"{self.data}/set.toml", "--out", f"{self.data}/set"], codes=(0,))
        common.run([self.airtruth, "track", f"{self.data}/set", "-t", "opencv-mil", "-o", f"{self.data}/results"], codes=(0,))
        self.outside = self.outside_now()

    def fresh(self):
        shutil.rmtree(self.work, ignore_errors=True)
        os.makedirs(self.work)
        shutil.copy(f"{self.data}/clip.mkv", self.work)

    def scene(self, label, name):
        self.fresh()
        common.write(f"{self.work}/scene.toml", filled(SCENE, name))
        if self.run(f"a scene named {label}", "render", "scene.toml", "--no-cache", "--out", "out").code != 0:
            return
        folder = os.path.join("out", name)
        self.run(f"overlay of {label}", "overlay", f"./{folder}", "-o", "o.mkv")
        self.run(f"inspect of {label}", "inspect", f"./{folder}", "--frame", "1", "-o", "i.png")
        self.run(f"report of {label}", "dataset", "report", f"./{folder}", "-o", "r.html")
        self.see_page(label, "r.html")

    def see_page(self, label, page):
        path = os.path.join(self.work, page)
        if not os.path.exists(path):
            return
        with open(path, errors="replace") as file:
            text = file.read()
        for name in ("<script>document.title", "</script><b>x"):
            if name in text:
                raise Broken(f"{page} of {label}: a name stands in it as markup")

    def catalogue(self, label, name):
        """A data set, whose background, aircraft, trajectory and sequences have the name, through all that follows."""
        self.fresh()
        text = common.CATALOGUE.replace('"small"', "@NAME@").replace('"sky"', "@NAME@").replace('"c172"\n', "@NAME@\n").replace(
            '"across"', "@NAME@").replace("{trajectory}", "{trajectory}")
        text = text.replace('name = "away"', 'name = "other"')
        common.write(f"{self.work}/c.toml", filled(text, name))
        if self.run(f"a catalogue of {label}", "dataset", "build", "c.toml", "--out", "set").code != 0:
            return
        self.run(f"verify of {label}", "dataset", "verify", "set", codes=(0,))
        self.run(f"report of {label}", "dataset", "report", "set", "-o", "r.html", codes=(0,))
        self.see_page(label, "r.html")
        for form in ("coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot", "webdataset"):
            if self.run(f"{form} of {label}", "dataset", "export", "set", "-f", form, "--images", "png", "-o", f"e-{form}").code == 0:
                self.run(f"{form} of {label} again", "dataset", "import", f"e-{form}", "-f", form, "-o", f"i-{form}")
                if os.path.exists(f"{self.work}/i-{form}"):
                    self.run(f"report of {form} of {label}", "dataset", "report", f"i-{form}", "-o", f"r-{form}.html")
                    self.see_page(label, f"r-{form}.html")
        self.run(f"track of {label}", "track", "set", "-t", "opencv-mil", "-o", "results", codes=(0,))
        self.run(f"evaluation of {label}", "evaluate", "set", "results/opencv-mil", "-o", "evaluation", "--figures", "svg", codes=(0,))
        self.see_page(label, "evaluation/report.html")
        self.see_scripts(label, "dataset", "submit", "c.toml", "--slurm", "--dry-run", "--out", "jobs")

    def see_scripts(self, label, *words):
        """Slurm's scripts are shell: read by one that runs none of their programs, they run no name."""
        if self.run(f"submit of {label}", *words).code != 0:
            return
        for root, _, files in os.walk(self.work):
            for file in files:
                path = os.path.join(root, file)
                if not file.endswith((".sh", ".sbatch")) and "slurm" not in root:
                    continue
                with open(path, "rb") as opened:
                    if not opened.read(2) == b"#!":
                        continue
                stub = {"PATH": os.path.join(self.root, "no-programs"), "SLURM_ARRAY_TASK_ID": "0", "SLURM_ARRAY_TASK_COUNT": "1",
                        "SLURM_ARRAY_TASK_MAX": "0", "HOME": self.work}
                subprocess.run(["/bin/bash", path], cwd=self.work, env=stub, capture_output=True, timeout=common.HANG_S, check=False)
                if subprocess.run(["/bin/bash", "-n", path], capture_output=True, check=False).returncode != 0:
                    raise Broken(f"{file} of {label} is no shell script")
                for place in (self.work, os.path.dirname(path)):
                    if os.path.exists(os.path.join(place, "pwned")):
                        raise Broken(f"{file} of {label}: a name was run")

    def folder(self, label, name):
        """Files and output folders of the name. A path that leads elsewhere is what the user asked for."""
        if label in ("up", "absolute", "dots"):
            return
        self.fresh()
        raw = name if isinstance(name, bytes) else name.encode()
        here = b"./" + raw if b"/" not in raw else raw
        common.write(f"{self.work}/c.toml", common.CATALOGUE)
        self.run(f"a data set in {label}", "dataset", "build", "c.toml", "--out", here)
        self.see_scripts(label, "dataset", "submit", "c.toml", "--slurm", "--dry-run", "--out", b"./jobs-" + raw.replace(b"/", b"_"))
        self.run(f"results in {label}", "track", f"{self.data}/set", "-t", "opencv-mil", "-o", here)
        self.run(f"an evaluation in {label}", "evaluate", f"{self.data}/set", f"{self.data}/results/opencv-mil", "-o", b"e" + raw.replace(b"/", b"_"),
                 "--figures", "svg")
        if b"/" in raw or len(raw) > 240 or raw == b"..":
            return
        clip = os.path.join(self.work.encode(), raw + b".mkv")
        shutil.copy(f"{self.data}/clip.mkv", clip)
        self.run(f"the mask of a video named {label}", "mask", b"./" + raw + b".mkv", "-o", b"./" + raw + b".png")
        self.run(f"the camera of a video named {label}", "calibrate", b"./" + raw + b".mkv", "-o", b"./" + raw + b".toml")
        self.run(f"the motion of a video named {label}", "motion", b"./" + raw + b".mkv", "-o", b"./" + raw + b".csv", "--plot", b"./" + raw + b"-m.png")
        self.run(f"results on a video named {label}", "track", b"./" + raw + b".mkv", "-t", "opencv-mil", "--init", "5,5,12,12", "-o", "res")
        common.write(f"{self.work}/scene.toml", filled(common.SCENE.replace('"clip.mkv"', "@NAME@"), raw + b".mkv" if isinstance(name, bytes) else name + ".mkv"))
        self.run(f"a scene over a video named {label}", "render", "scene.toml", "--no-cache", "--out", "out")

    def tracker(self, label, name):
        self.fresh()
        raw = name if isinstance(name, bytes) else name.encode()
        self.run(f"a tracker named {label}", "track", f"{self.data}/set", "-t", raw, "-o", "results")
        self.run(f"a TraX tracker named {label}", "track", f"{self.data}/set", "-t", raw + b"=trax:false", "--start-timeout", "20", "-o", "results")
        if b"/" in raw or len(raw) > 240 or raw == b"..":
            return
        shutil.copytree(f"{self.data}/results/opencv-mil".encode(), os.path.join(self.work.encode(), b"r", raw))
        self.run(f"results named {label}", "evaluate", f"{self.data}/set", b"r/" + raw, "-o", "evaluation", "--figures", "svg")
        self.see_page(label, "evaluation/report.html")


class Tampered(Names):
    """Data sets whose records were changed: they point nowhere outside."""

    def each(self, what, change, *commands):
        self.fresh()
        shutil.copytree(f"{self.data}/set", f"{self.work}/set")
        change()
        for words in commands or (("dataset", "verify", "set"), ("dataset", "report", "set", "-o", "r.html"),
                                  ("dataset", "export", "set", "-f", "coco", "-o", "coco"), ("track", "set", "-t", "opencv-mil", "-o", "res"),
                                  ("evaluate", "set", f"{self.data}/results/opencv-mil", "-o", "evaluation"),
                                  ("dataset", "build", f"{self.data}/set.toml", "--out", "set")):
            done = self.run(f"{what}: {' '.join(words[:2])}", *words, codes=(0, 1, 2))
            if "TOP-SECRET" in done.out + done.err:
                raise Broken(f"{what}: read what lies outside")
            self.see_outside(what)

    def edit(self, file, change):
        path = f"{self.work}/set/{file}"
        with open(path) as opened:
            text = opened.read()
        common.write(path, change(text))

    def json(self, file, keys, value):
        def change(text):
            record = json.loads(text)
            at = record
            for key in keys[:-1]:
                at = at[key]
            at[keys[-1]] = value
            return json.dumps(record)

        self.edit(file, change)

    def walk(self, record, path=()):
        """Every place of a JSON value."""
        if isinstance(record, dict):
            for key, value in record.items():
                yield (*path, key), value
                yield from self.walk(value, (*path, key))
        elif isinstance(record, list):
            for i, value in list(enumerate(record))[:2]:
                yield (*path, i), value
                yield from self.walk(value, (*path, i))

    def records(self):
        secret = common.write(f"{self.root}/secret/across/truth.jsonl", "TOP-SECRET\n")
        self.outside = self.outside_now()
        values = ["../../secret/across", secret, f"{self.root}/secret", 10**18, -1, 1e308, None, [], {}, "", "..", "a" * 300, "a\nb", True]
        count = 0
        for file in ("dataset.json", "sequences/across/sequence.json"):
            path = f"{self.data}/set/{file}"
            if not os.path.exists(path):
                continue
            with open(path) as opened:
                record = json.load(opened)
            for i, (keys, _) in list(enumerate(self.walk(record)))[:: self.step]:
                # Two of the values for each place, all of them over the places.
                for value in (values[i % len(values)], values[(i + 5) % len(values)]):
                    self.each(f"{file} {keys} = {value!r:.40}", lambda f=file, k=keys, v=value: self.json(f, k, v),
                              *self.light_commands(count))
                    count += 1
        print(f"{count} changes to the records of a data set: none led outside")

    def light_commands(self, count):
        every = [("dataset", "verify", "set"), ("dataset", "report", "set", "-o", "r.html"), ("dataset", "export", "set", "-f", "yolo", "-o", "y"),
                 ("evaluate", "set", f"{self.data}/results/opencv-mil", "--no-page", "-o", "evaluation"), ("dataset", "build", f"{self.data}/set.toml", "--out", "set")]
        return [every[count % len(every)]]

    def verified(self, what, change, words):
        """verify says what is wrong, even where the file outside is as the record has it."""
        self.fresh()
        shutil.copytree(f"{self.data}/set", f"{self.work}/set")
        change()
        done = self.run(what, "dataset", "verify", "set", codes=(1,))
        if words not in done.err:
            raise Broken(f"{what}: expected '{words}', found: {done.err[-400:]}")

    def leading_outside(self):
        secret = common.write(f"{self.root}/secret/across/truth.jsonl", "TOP-SECRET\n")
        found = {"name": "../../../../secret/across/truth.jsonl", "sha256": hashlib.sha256(b"TOP-SECRET\n").hexdigest()}
        sequence = "sequences/across/sequence.json"
        for name in (found["name"], secret):
            self.verified(f"an output {name}", lambda n=name: self.json(sequence, ("outputs", 0), {**found, "name": n}),
                          "is outside of this sequence")
            self.verified(f"a manifest {name}", lambda n=name: self.json("dataset.json", ("manifest", 0), {**found, "name": n}),
                          "of dataset.json is outside of it")
        self.verified("a sequence named elsewhere", lambda: self.json(sequence, ("name",), "../../../secret/across/across"),
                      "expected a plain file name")

        def link():
            path = f"{self.work}/set/sequences/across/truth.jsonl"
            shutil.move(path, f"{self.root}/moved.jsonl")
            os.symlink(f"{self.root}/moved.jsonl", path)

        self.verified("truth that is a link", link, "is outside of this sequence")
        os.unlink(f"{self.root}/moved.jsonl")

    def files(self):
        self.leading_outside()
        self.outside = self.outside_now()
        manifest = [n for n in ("manifest/000000.txt", "manifest.txt", "manifest") if os.path.isfile(f"{self.data}/set/{n}")]
        for folder in ("manifest",):
            if os.path.isdir(f"{self.data}/set/{folder}"):
                manifest += [f"{folder}/{n}" for n in os.listdir(f"{self.data}/set/{folder}")]
        for file in manifest:
            for line in ("../../secret/across", "/etc", "", "0" * 64 + "  ../../../secret/across/truth.jsonl", "x" * 5000):
                self.each(f"{file} with '{line[:30]}'", lambda f=file, t=line: self.edit(f, lambda text: text + t + "\n"))

        def link(what, place):
            def change():
                path = f"{self.work}/set/{place}"
                shutil.rmtree(path) if os.path.isdir(path) else os.unlink(path)
                os.symlink(what, path)

            return change

        outside = f"{self.root}/secret"
        for place in ("sequences/across", "sequences/across/truth.jsonl", "sequences/across/sequence.json", "sequences", "dataset.json"):
            self.each(f"{place} is a link", link(f"{outside}/across", place))
        print(f"{len(manifest)} manifests and 5 links: none led outside")


def body():
    airtruth = os.path.abspath(sys.argv[1])
    is_short = "--short" in sys.argv
    with tempfile.TemporaryDirectory(prefix="airtruth_names_") as root:
        names = Names(airtruth, root)
        names.prepare()
        chosen = {label: name for label, name in NAMES.items() if not is_short or label in SHORT}
        parts = [word for word in sys.argv[2:] if word != "--short"]
        for part in parts or ["scene", "catalogue", "folder", "tracker", "records", "files"]:
            if part in ("records", "files"):
                tampered = Tampered(airtruth, root)
                tampered.step = SHORT_CHANGES if is_short else 1
                getattr(tampered, part)()
                continue
            names.outside = names.outside_now()
            for label, name in chosen.items():
                getattr(names, part)(label, name)
                names.see_outside(f"{part} {label}")
            print(f"{part}: {len(chosen)} names, {names.worked} commands worked, {names.refused} were refused in one line", flush=True)


if __name__ == "__main__":
    common.main(body)
