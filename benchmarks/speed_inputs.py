# SPDX-License-Identifier: Apache-2.0
"""Clips, scenes and the catalogue that benchmarks/speed.py measures on."""

import math
import os
import subprocess
import sys

WIDTH, HEIGHT = 1280, 960
VIEW_DEG = {"flight": 75, "real": 41}
SPEED_MPS = 25
SPAN_M = 34.3  # of 738/738-Ryanair, seen from behind
REAL_CLIP = "footage/fixed-wing/cumulus_a4.mp4"  # below AIRTRUTH_SHARED
SET_SEQUENCES, SET_FRAMES = 24, 100

SCENE = """name = "{name}"
[background]
video = "{video}"
{mask}
[lens]
model = "pinhole"
vertical_fov_deg = {view}
[camera]
position_ned_m = [0, 0, -150]
velocity_ned_mps = [{speed}, 0, 0]
[[intruder]]
id = "b737"
aircraft = "738/738-Ryanair"
waypoints_ned_m = [[{ahead}, 40, -170], [{far}, 40, -170]]
speed_mps = {speed}
[composite]
method = "{method}"
[output]
video = "{output}"
quality = 18
"""

REALISM = """
[shutter]
exposure_s = 0.008
readout_s = 0.016
[air]
extinction_per_km = [0.15, 0.17, 0.21]
[optics]
point_spread_px = 0.7
sharpening = 0.4
[sensor]
noise_gain = 4e-4
noise_floor = 2e-5
noise_correlation_px = 0.5
codec_step = 6
"""

CATALOGUE = """name = "set"
seed = 1
[[background]]
name = "flight"
video = "{video}"
lens = {{ vertical_fov_deg = {view} }}
camera = {{ position_ned_m = [0, 0, -150], velocity_ned_mps = [{speed}, 0, 0] }}
light = {{ sun_azimuth_deg = 130, sun_elevation_deg = 40 }}
{aircraft}{trajectories}
[[product]]
name = "{{trajectory}}-{{aircraft}}"
frame_count = {frames}
"""
SET_AIRCRAFT = ["738/738-Ryanair", "733/733-AirBaltic", "c172/g-boix", "c172/news"]


def made(path, command):
    """The path of a file; it is made by the command where it is not there. Ends the benchmark where that fails."""
    if not os.path.exists(path):
        print(f"making {os.path.basename(path)}", file=sys.stderr)
        process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if process.returncode != 0:
            sys.exit(f"benchmark: {' '.join(command)} failed:\n{process.stdout}")
    return path


def ffmpeg(*arguments):
    return ["ffmpeg", "-hide_banner", "-loglevel", "error", "-nostdin", "-y", *arguments]


def flight_command(program, clip, mask, frames, width=WIDTH, height=HEIGHT):
    return [program, "synth", "-o", clip, "--mask", mask, "--frames", str(frames), "--width", str(width), "--height",
            str(height), "--fov", str(VIEW_DEG["flight"]), "--speed", str(SPEED_MPS), "--overwrite"]


def make_clips(program, folder, frames):
    """{name: path} of the clips: a virtual flight, one frame of it, a small one for calibrate, and the real clip (where
    AIRTRUTH_SHARED has it) scaled to the size of the others."""
    def path(name):
        return os.path.join(folder, name)

    clips = {"flight": made(path(f"flight-{frames}.mp4"),
                            flight_command(program, path(f"flight-{frames}.mp4"), path("mask.png"), frames))}
    clips["one"] = made(path("one.mp4"), ffmpeg("-i", clips["flight"], "-c", "copy", "-frames:v", "1", path("one.mp4")))
    clips["small"] = made(path("small.mp4"),
                          flight_command(program, path("small.mp4"), path("small-mask.png"), 300, 640, 480))
    source = os.path.join(os.environ.get("AIRTRUTH_SHARED", ""), REAL_CLIP)
    if os.path.exists(source):
        clips["real"] = made(path(f"real-{frames}.mp4"),
                             ffmpeg("-i", source, "-vf", f"scale={WIDTH}:{HEIGHT}", "-frames:v", str(frames), "-c:v",
                                    "libx264", "-crf", "18", path(f"real-{frames}.mp4")))
    else:
        print("no real clip: AIRTRUTH_SHARED is not set or holds no " + REAL_CLIP, file=sys.stderr)
    return clips


def write_scene(folder, clip_name, clip, size_px, frames, method="matte", output="mp4", realism=False):
    view = VIEW_DEG["real" if clip_name == "real" else "flight"]
    focal_px = HEIGHT / 2 / math.tan(math.radians(view / 2))
    ahead = focal_px * SPAN_M / size_px
    name = f"{clip_name}-{method}-{size_px}" + ("-realism" if realism else "")
    mask = f'mask = "{os.path.join(folder, "mask.png")}"' if clip_name != "real" else ""
    path = os.path.join(folder, name + ".toml")
    with open(path, "w") as file:
        file.write(SCENE.format(name=name, video=clip, mask=mask, view=view, speed=SPEED_MPS, ahead=ahead,
                                far=ahead + 100 * frames, method=method, output=output) + (REALISM if realism else ""))
    return path


def write_catalogue(folder, clip):
    aircraft = "".join(f'[[aircraft]]\nname = "a{n}"\naircraft = "{name}"\n' for n, name in enumerate(SET_AIRCRAFT))
    trajectories = "".join(
        f'[[trajectory]]\nname = "t{n}"\nwaypoints_ned_m = [[{400 + 150 * n}, {-60 - 30 * n}, -175], '
        f'[{430 + 150 * n}, {100 + 30 * n}, -185]]\nspeed_mps = {45 + 5 * n}\n'
        for n in range(SET_SEQUENCES // len(SET_AIRCRAFT)))
    path = os.path.join(folder, "set.toml")
    with open(path, "w") as file:
        file.write(CATALOGUE.format(video=clip, frames=SET_FRAMES, view=VIEW_DEG["flight"], speed=SPEED_MPS,
                                    aircraft=aircraft, trajectories=trajectories))
    return path
