#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the catalogue of the set that the small network of docs/detection-real.md is trained on.

    python3 benchmarks/training_set.py training.toml
    airtruth dataset build training.toml --out training
    python3 benchmarks/train_detector.py training -o aircraft.onnx --minutes 8

Needs AIRTRUTH_SHARED. Made aircraft alone, of types and liveries that none of the measured sets has, over six virtual flights, frames 602
to 967 of overcast_b4, ten clips of birds and four of multirotors. No clip is one that benchmarks/detection.py holds back.
"""

import os
import sys

TYPES = ("777 787 A343 A380 AT7 E90 Fokker-100 Saab-2000 beech-200 c177 c310 Cessna337 Cessna208Caravan ercoupe DH3 G-164 "
         "Bombardier-Challenger T-38 FK9MK2 cri-cri").split()
# Cloud cover, the sun's elevation and azimuth, altitude in m, vertical field of view, all in degrees.
FLIGHTS = [(0.2, 50, 140, 150, 50), (0.4, 25, 260, 200, 60), (0.6, 60, 60, 120, 45), (0.8, 35, 200, 150, 70), (0.9, 45, 320, 250, 40),
           (0.3, 15, 100, 100, 55)]
FIRST_FLIGHT_SEED = 201
CLIPS = [f"birds/V_BIRD_{n:03}" for n in (1, 2, 3, 4, 6, 8, 9, 10, 11, 12)] + [f"drones/V_DRONE_{n:03}" for n in (1, 3, 5, 7)]

FLIGHT = """
[[background]]
name = "flight-{number}"
flight = {{ seed = {seed}, frame_count = 240, width = 640, height = 480, cloud_cover = {cover}, altitude_m = {altitude} }}
lens = {{ vertical_fov_deg = {fov} }}
camera = {{ position_ned_m = [0, 0, -{altitude}], velocity_ned_mps = [25, 0, 0] }}
light = {{ sun_azimuth_deg = {azimuth}, sun_elevation_deg = {elevation} }}
realism = {{ auto = true, fallback = true }}
"""

OVERCAST = """
[[background]]
name = "overcast"
video = "{footage}/fixed-wing/overcast_b4.mp4"
first_frame = 602
lens = {{ focal_px = [504.4, 504.4] }}
camera = {{ velocity_ned_mps = [20, 0, 0] }}
motion = {{ reference = "smoothed" }}
realism = {{ auto = true, fallback = true }}
"""

CLIP = """
[[background]]
name = "{name}"
video = "{footage}/ground-real/{clip}.mp4"
lens = {{ model = "pinhole", vertical_fov_deg = 12 }}
camera = {{ position_ned_m = [0, 0, -2], attitude_yaw_pitch_roll_deg = [0, 15, 0] }}
light = {{ sun_azimuth_deg = 150, sun_elevation_deg = 45 }}
motion = {{ reference = "smoothed" }}
realism = {{ auto = true, fallback = true, profile = "ground-zoom" }}
"""

RULE = """
[[random]]
name = "{name}-{{index}}"
count = {count}
frame_count = 10
backgrounds = {backgrounds}
aircraft = [{types}]
size_px = [5, 90]
azimuth_deg = [{azimuth}]
elevation_deg = [{elevation}]
intruders = [1, 3]
start = "random"
negatives = 0.1
"""


def catalogue(footage):
    text = 'name = "training"\nseed = 7\n'
    for number, (cover, elevation, azimuth, altitude, fov) in enumerate(FLIGHTS):
        text += FLIGHT.format(number=number, seed=FIRST_FLIGHT_SEED + number, cover=cover, elevation=elevation, azimuth=azimuth,
                              altitude=altitude, fov=fov)
    text += OVERCAST.format(footage=footage)
    for clip in CLIPS:
        text += CLIP.format(footage=footage, clip=clip, name=os.path.basename(clip))
    types = ", ".join(f'"{name}/*"' for name in TYPES)
    text += RULE.format(name="air", count=300, backgrounds='["flight-*", "overcast"]', types=types, azimuth="-25, 25", elevation="-12, 15")
    return text + RULE.format(name="ground", count=200, backgrounds='["V_*"]', types=types, azimuth="-6, 6", elevation="-4, 4")


def main():
    shared = os.environ.get("AIRTRUTH_SHARED")
    if len(sys.argv) != 2 or not shared:
        sys.exit("training_set: say where to, with AIRTRUTH_SHARED naming the folder of real clips; training_set.py training.toml")
    with open(sys.argv[1], "w") as file:
        file.write(catalogue(os.path.join(shared, "footage")))


if __name__ == "__main__":
    main()
