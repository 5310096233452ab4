# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of docs/concepts from virtual flights: python3 docs/concepts/make_pictures.py AIRTRUTH

AIRTRUTH is the path of the built program; ffmpeg puts frames side by side. The pictures are written beside this script.
"""

import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SIZE = ["--width", "640", "--height", "480", "--frames", "120", "--noise", "0"]
FISHEYE = """%YAML:1.0
---
image_width: 640
image_height: 480
fisheye_model: 1
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 300., 0., 319.5, 0., 300., 239.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 4
   dt: d
   data: [ 0., 0., 0., 0. ]
"""
SCENE = """[background]
video = "flight.mp4"
[lens]
vertical_fov_deg = 75
[camera]
position_ned_m = [0, 0, -150]
velocity_ned_mps = [25, 0, 0]
[light]
sun_azimuth_deg = 120
sun_elevation_deg = 40
[realism]
auto = true
fallback = true
[[intruder]]
id = "b737"
aircraft = "738/738-Ryanair"
waypoints_ned_m = [[420, -120, -175], [560, 160, -185]]
speed_mps = 80
"""


def main():
    airtruth = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="airtruth_pictures_") as folder:
        def run(*command):
            subprocess.run([*map(str, command)], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        def ffmpeg(*command):
            run("ffmpeg", "-y", "-v", "error", *command)

        for name, text in (("fisheye.yml", FISHEYE), ("scene.toml", SCENE)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as opened:
                opened.write(text)
        run(airtruth, "synth", "-o", "flight.mp4", *SIZE)
        run(airtruth, "synth", "-o", "pinhole.mp4", *SIZE, "--fov", "60", "--no-own-aircraft", "--shake", "0")
        run(airtruth, "synth", "-o", "fisheye.mp4", *SIZE, "--lens", "fisheye.yml", "--no-own-aircraft", "--shake", "0")
        ffmpeg("-i", "pinhole.mp4", "-i", "fisheye.mp4", "-filter_complex", "hstack,select=eq(n\\,30)", "-frames:v", 1,
               "-q:v", 4, os.path.join(HERE, "lens.jpg"))
        run(airtruth, "motion", "flight.mp4", "-o", "motion.csv", "--plot", os.path.join(HERE, "motion.png"), "--overwrite")
        run(airtruth, "render", "scene.toml", "--out", "out")
        run(airtruth, "inspect", "out/scene", "--frame", 60, "-o", os.path.join(HERE, "matte.png"), "--overwrite")
        run(airtruth, "overlay", "out/scene", "-o", "boxes.mp4")
        ffmpeg("-ss", 2, "-i", "boxes.mp4", "-frames:v", 1, "-q:v", 3, os.path.join(HERE, "truth.jpg"))


if __name__ == "__main__":
    main()
