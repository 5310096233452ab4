# SPDX-License-Identifier: Apache-2.0
"""How fast training streams are: ./dev bench stream [--samples N] [CLIP.mp4 ...]

Makes samples of aircraft of 10 to 60 px over the clips (640x480 or so; without any, over virtual flights of that size) on one
thread, in the ways of the table below, and reads as many pictures of a data set of the same catalogue with OpenCV, from
JPEG files and from its videos at random places. Where Blender is installed, its own Python loop makes such crops, too
(blender_crops.py). Prints samples a second of wall-clock time and of CPU time.
"""

import argparse
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

TYPES = pathlib.Path("/usr/share/games/flightgear/AI/Aircraft")  # of the package flightgear-data-ai
REALISM = "realism = { auto = true, fallback = true }\n"
NO_CODEC = "sensor = { codec_step = 0 }\n"
WAYS = {  # name: (keys of each background, keys of [stream])
    "256 px crops": ("", ""),
    "the same, realism without codec": (REALISM + NO_CODEC, ""),
    "the same, with the codec": (REALISM, ""),
    "3 frames, realism without codec": (REALISM + NO_CODEC, "frames = 3\n"),
    "whole frames, 1 to 3 aircraft": ("", 'picture = "frame"\nintruders = [1, 3]\n'),
}


def catalogue(clips, background, stream):
    text = ""
    for clip in clips:
        text += (f'[[background]]\nname = "{clip.stem}"\nvideo = "{clip.absolute()}"\nlens = {{ vertical_fov_deg = 30 }}\n'
                 f'camera = {{ position_ned_m = [0, 0, -300] }}\n{background}')
    return text + ('[[random]]\ncount = 40\nframe_count = 10\naircraft = ["738/*", "c172/*", "Cub/*", "777/*"]\nsize_px = [10, 60]\n'
                   'azimuth_deg = [-17, 17]\nelevation_deg = [-12, 12]\nnegatives = 0.1\nstart = "random"\n'
                   f'[stream]\n{stream}')


def flights(program, folder):
    clips = [folder / f"flight{seed}.mp4" for seed in range(1, 6)]
    for seed, clip in enumerate(clips, 1):
        subprocess.run([program, "synth", "--out", clip, "--width", "640", "--height", "480", "--frames", "150", "--seed", str(seed),
                        "--no-own-aircraft"], check=True, capture_output=True)
    return clips


def report(name, pictures, begin):
    wall_s, cpu_s = time.monotonic() - begin[0], time.process_time() - begin[1]
    print(f"{name}: {pictures / wall_s:.1f} a second, {pictures / max(cpu_s, 1e-9):.1f} a CPU second")


def read_files(program, folder, clips):
    """What a loader without a stream does: the pictures of a set of the same catalogue."""
    import cv2
    cv2.setNumThreads(1)
    (folder / "set.toml").write_text(catalogue(clips, "", ""))
    subprocess.run([program, "dataset", "build", folder / "set.toml", "--out", folder / "set"], check=True, capture_output=True)
    subprocess.run([program, "dataset", "export", folder / "set", "-f", "coco", "--out", folder / "coco"], check=True,
                   capture_output=True)
    pictures = sorted((folder / "coco").rglob("*.jpg"))
    random.Random(1).shuffle(pictures)
    begin = time.monotonic(), time.process_time()
    for picture in pictures:
        cv2.imread(str(picture))
    report("read from JPEG files by OpenCV", len(pictures), begin)
    videos = sorted((folder / "set" / "sequences").rglob("*.mp4"))
    draw = random.Random(1)
    begin = time.monotonic(), time.process_time()
    for _ in range(200):
        video = cv2.VideoCapture(str(draw.choice(videos)))
        video.set(cv2.CAP_PROP_POS_FRAMES, draw.randrange(10))
        assert video.read()[0]
    report("read from videos at random frames by OpenCV", 200, begin)


def crops_by_blender(folder, clips, models, count=100):
    import cv2
    pictures = [folder / f"{clip.stem}.png" for clip in clips]
    for clip, picture in zip(clips, pictures):
        cv2.imwrite(str(picture), cv2.VideoCapture(str(clip)).read()[1])
    done = subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P",
                           pathlib.Path(__file__).resolve().with_name("blender_crops.py"), "--", folder, str(count), *pictures, "--", *models],
                          capture_output=True, text=True)
    said = [line.split() for line in done.stdout.splitlines() if line.startswith("seconds ")]
    if done.returncode != 0 or not said:
        sys.exit(done.stdout[-2000:] + done.stderr)
    wall_s, cpu_s = (float(value) for value in said[0][1:])
    print(f"256 px crops by Blender, without textures: {count / wall_s:.1f} a second, {count / cpu_s:.1f} a CPU second")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("bench")
    parser.add_argument("--samples", type=int, default=2000)
    parser.add_argument("clips", nargs="*", type=pathlib.Path)
    arguments = parser.parse_intermixed_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        clips = arguments.clips or flights(arguments.program, folder)
        for way, (background, stream) in WAYS.items():
            (folder / "stream.toml").write_text(catalogue(clips, background, stream))
            done = subprocess.run([arguments.bench, folder / "stream.toml", str(arguments.samples)], capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(done.stderr)
            print(f"{way}:\n  " + done.stdout.strip().replace("\n", "\n  "), flush=True)
        read_files(arguments.program, folder, clips)
        models = [path for name in ("738/Models/737-800.ac", "c172/Models/c172p.ac") if (path := TYPES / name).exists()]
        if shutil.which("blender") and models:
            crops_by_blender(folder, clips, models)


if __name__ == "__main__":
    main()
