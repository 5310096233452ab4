# SPDX-License-Identifier: Apache-2.0
"""Boxes that no clip has: `compare` works or refuses them in one line: python3 compare_boxes_test.py AIRTRUTH"""

import json
import os
import sys
import tempfile

import common
from common import Broken

HEAD = "frame,x,y,width,height\n"


def line(frames=12, x=lambda i: 40 + i, y=lambda i: 30, width=lambda i: 10, height=lambda i: 8):
    return HEAD + "".join(f"{i},{x(i)},{y(i)},{width(i)},{height(i)}\n" for i in range(frames))


# Each with the words that its line of error holds; None: any line of error, or none.
BOXES = {
    "one at 2^31 - 1": (line(x=lambda i: 2147483647 if i == 6 else 3 + i), "boxes.csv:8: '2147483647' is no place in a picture"),
    "one at -2^31": (line(y=lambda i: -2147483648 if i == 6 else 20), "boxes.csv:8: '-2147483648' is no place in a picture"),
    "1e308": (line(width=lambda i: "1e308"), "boxes.csv:2: '1e308' is no place in a picture"),
    "nan": (line(x=lambda i: "nan"), "boxes.csv:2: 'nan' is not a finite number"),
    "no size": (line(height=lambda i: 0), "boxes.csv:2: has a box without a size"),
    "a negative size": (line(width=lambda i: -5), "boxes.csv:2: has a box without a size"),
    "frames far apart": (HEAD + "0,40,30,10,8\n999999999,41,30,10,8\n", "spans the frames 0 to 999999999"),
    "a frame twice": (HEAD + "0,40,30,10,8\n0,41,30,10,8\n", "boxes.csv:3: is the second box of frame 0"),
    "a frame of 1e300": (HEAD + "0,40,30,10,8\n1e300,41,30,10,8\n", "boxes.csv:3: '1e300' is no frame"),
    "one box": (HEAD + "0,40,30,10,8\n", "holds fewer than two boxes"),
    "no line": ("", "does not begin with frame,x,y,width,height"),
    "too few cells": (HEAD + "0,40,30,10\n", "boxes.csv:2: has 4 cells; expected 5"),
    "moving as they should": (line(), None),
    "standing still": (line(x=lambda i: 40), None),
    "outside the picture": (line(x=lambda i: 4000 + i), None),
    "one far outside": (line(x=lambda i: 999999 if i == 6 else 40 + i), None),
    "all far outside": (line(x=lambda i: -999999 + i, y=lambda i: 999999), None),
    "larger than the picture": (line(width=lambda i: 900, height=lambda i: 700), None),
    "1e6 px wide": (line(width=lambda i: 1e6, height=lambda i: 1e6), None),
    "1e-9 px wide": (line(width=lambda i: 1e-9, height=lambda i: 1e-9), None),
    "a denormal's width": (line(width=lambda i: "5e-324", height=lambda i: "5e-324"), None),
    "across the edge": (line(x=lambda i: -5 + i), None),
    "frames that the video lacks": (line(frames=40), None),
    "the last frames alone": (HEAD + "10,40,30,10,8\n11,42,30,10,8\n", None),
    "beyond the video": (HEAD + "500,40,30,10,8\n501,42,30,10,8\n", None),
}


def clip_with_an_aircraft(airtruth, data):
    """An inserted aircraft stands for the real one. Its boxes, as its truth has them."""
    common.run([airtruth, "synth", "-o", f"{data}/clip.mkv", "--width", "320", "--height", "240", "--frames", "12", "--clouds", "0",
                "--noise", "0", "--no-own-aircraft"], codes=(0,))
    above = common.SCENE.replace("[[30, -3, -150], [32, 9, -151]]", "[[100, -30, -170], [100, 30, -170]]")
    common.write(f"{data}/scene.toml", above.replace("speed_mps = 20", "speed_mps = 60") + "[light]\nexposure = 0.01\n")  # dark before the sky
    common.run([airtruth, "render", f"{data}/scene.toml", "--out", f"{data}/real"], codes=(0,))
    with open(f"{data}/real/out/truth.jsonl") as file:
        frames = [json.loads(line) for line in file]
    boxes = {f["frame"]: f["intruders"][0]["covered_box_px"] for f in frames if f.get("intruders")}
    return HEAD + "".join(f"{frame}," + ",".join(map(str, box)) + "\n" for frame, box in boxes.items() if box)


def replaced(airtruth, root, out, boxes):
    """A comparison is replaced where that is asked for."""
    common.run([airtruth, "compare", "--real", f"{root}/data/real/out/out.mkv", "--boxes", boxes, "--scene", f"{root}/data/scene.toml",
                "-o", out, "--no-match", "--overwrite"], codes=(0,), env=common.environment(f"{root}/cache"))
    if not os.listdir(f"{out}/patches"):
        raise Broken(f"{out} holds no patches")


def compare(airtruth, root):
    data = os.path.join(root, "data")
    os.makedirs(data)
    true_boxes = clip_with_an_aircraft(airtruth, data)
    worked = 0
    for i, (what, (text, words)) in enumerate([*BOXES.items(), ("of its truth", (true_boxes, None))]):
        boxes = common.write(f"{data}/boxes.csv", text)
        out = os.path.join(root, f"out-{i}")
        done = common.run([airtruth, "compare", "--real", f"{data}/real/out/out.mkv", "--boxes", boxes, "--scene", f"{data}/scene.toml", "-o", out],
                          f"compare with boxes {what}", (2,) if words else (0, 2), env=common.environment(f"{root}/cache"))
        if words and words not in done.err:
            raise Broken(f"boxes {what}: expected '{words}', found: {done.err[-300:]}")
        if done.code == 2 and (os.path.exists(out) or common.halves(root)):
            raise Broken(f"boxes {what}: refused, and left {common.halves(root)}")
        worked += done.code == 0
        if what == "of its truth" and done.code != 0:
            raise Broken(f"the boxes of the aircraft's own truth: {done.err[-300:]}")
        if done.code == 0:
            replaced(airtruth, root, out, boxes)
    print(f"{len(BOXES) + 1} files of boxes: {worked} compared, the others refused in one line")


def body():
    airtruth = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="airtruth_boxes_") as root:
        compare(airtruth, root)


if __name__ == "__main__":
    common.main(body)
