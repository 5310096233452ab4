# SPDX-License-Identifier: Apache-2.0
"""Kills commands at random instants: python3 kill_campaign.py AIRTRUTH [KILLS EACH] [COMMAND...]

After each kill, what has its final name is whole: it is what an undisturbed run makes. After the next run everything is there, to
the byte, and nothing is left beside it. (tests/fault_campaign.py kills `dataset build`.)
"""

import os
import random
import shutil
import signal
import sys
import tempfile
import time

import common
from common import Broken

# What two undisturbed runs do not write the same: how long a tracker took.
NOT_THE_SAME = ("_time", "times", "/logs/", "run.json", "results.json")


def commands(airtruth, data):
    """Name: (words for an output folder, may what is there be part of the whole?)."""
    a = airtruth
    return {
        "render": (lambda out: [a, "render", f"{data}/moving.toml", "--no-cache", "--out", out], False),
        "render --overwrite": (lambda out: [a, "render", f"{data}/moving.toml", "--no-cache", "--overwrite", "--out", out], False),
        "export": (lambda out: [a, "dataset", "export", f"{data}/set", "-f", "coco", "-o", f"{out}/coco"], True),
        "export yolo": (lambda out: [a, "dataset", "export", f"{data}/set", "-f", "yolo", "--images", "png", "-o", f"{out}/yolo"], True),
        "export webdataset": (lambda out: [a, "dataset", "export", f"{data}/set", "-f", "webdataset", "-o", f"{out}/shards"], True),
        "report": (lambda out: [a, "dataset", "report", f"{data}/set", "--overwrite", "-o", f"{out}/report.html"], False),
        "track": (lambda out: [a, "track", f"{data}/set", "-t", "opencv-mil", "-t", "am3", "-o", f"{out}/results"], True),
        "evaluate": (lambda out: [a, "evaluate", f"{data}/set", f"{data}/results/opencv-mil", "-o", f"{out}/evaluation"], True),
        "calibrate": (lambda out: [a, "calibrate", f"{data}/clip.mkv", "--overwrite", "-o", f"{out}/camera.toml"], False),
    }


def prepare(airtruth, data):
    def run(*words):
        common.run([airtruth, *words], codes=(0,))

    os.makedirs(data)
    run("synth", "-o", f"{data}/clip.mkv", "--width", "96", "--height", "64", "--frames", "12")
    common.write(f"{data}/moving.toml", common.SCENE.replace('model = "none"', 'model = "homography"'))
    common.write(f"{data}/set.toml", common.CATALOGUE.replace("frame_count = 3", "frame_count = 8"))
    run("dataset", "build", f"{data}/set.toml", "--out", f"{data}/set")
    run("track", f"{data}/set", "-t", "opencv-mil", "-o", f"{data}/results")


class Killing:
    def __init__(self, root, name, words, grows):
        self.name, self.words, self.grows = name, words, grows
        # The same name for every run, since records name folders.
        self.out = os.path.join(root, "out")
        self.environment = common.environment(os.path.join(root, "cache"))

    def finish(self, what):
        done = common.run(self.words(self.out), f"{self.name} {what}", (0, 2), env=self.environment)
        if done.code == 2 and "exists already" not in done.err:
            raise Broken(f"{self.name} {what}: the next run failed: {done.err}")
        return common.state(self.out, NOT_THE_SAME)

    def fresh(self):
        shutil.rmtree(self.out, ignore_errors=True)
        os.makedirs(self.out)

    def see_whole(self, what):
        found = {name: value for name, value in common.state(self.out, NOT_THE_SAME).items()
                 if not any(part.startswith(".") for part in name.split("/"))}
        wrong = [name for name, value in found.items() if self.expected.get(name) != value]
        lacking = [] if self.grows or not found else sorted(set(self.expected) - set(found))
        if wrong or lacking:
            raise Broken(f"{self.name} {what}: {wrong[:5]} are not what an undisturbed run makes, {lacking[:5]} are not there")

    def run(self, kills, dice):
        self.fresh()
        self.expected = self.finish("undisturbed")
        self.fresh()
        # The second run is timed: the first one also fills caches.
        began = time.monotonic()
        again = self.finish("undisturbed again")
        whole_s = time.monotonic() - began
        if again != self.expected:
            raise Broken(f"{self.name}: two undisturbed runs differ in {common.difference(self.expected, again)}")
        if "overwrite" not in self.name:
            self.fresh()
        over = 0
        for kill in range(kills):
            process = common.start(self.words(self.out), env=self.environment)
            time.sleep(dice.uniform(0, whole_s))
            over += process.poll() is not None
            process.send_signal(signal.SIGKILL)
            process.communicate()
            self.see_whole(f"after kill {kill}")
            if dice.random() < 0.4 or kill + 1 == kills:
                if common.difference(self.expected, self.finish(f"after kill {kill}")):
                    raise Broken(f"{self.name} after kill {kill}: the next run differs in "
                                 f"{common.difference(self.expected, common.state(self.out, NOT_THE_SAME))}")
                if "overwrite" not in self.name:
                    self.fresh()
        print(f"{self.name}: {kills} kills ({over} came after the end): what was there was whole, the next run made the same bytes",
              flush=True)


def body():
    airtruth = os.path.abspath(sys.argv[1])
    kills = int(sys.argv[2]) if len(sys.argv) > 2 else 10
    with tempfile.TemporaryDirectory(prefix="airtruth_kills_") as root:
        data = os.path.join(root, "data")
        prepare(airtruth, data)
        for name, (words, grows) in commands(airtruth, data).items():
            if len(sys.argv) <= 3 or name in sys.argv[3:]:
                Killing(root, name, words, grows).run(kills, random.Random(f"7 {name}"))


if __name__ == "__main__":
    common.main(body)
