#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does the codec's stage leave on an inserted aircraft what a camera's encoder leaves on a real one? codec_stage.py AIRTRUTH

Virtual flights stand for the scene before a camera codes it, so that both are known:
    real     aircraft put into the flight without loss, then all of it coded by libx264 (its usual settings: key, P and B pictures);
    stage    the flight alone coded in the same way, decoded, and the aircraft put in with [sensor] codec_step;
    without  the same without the stage;
    another  like real, with key pictures at other frames: what two codings of one scene differ by.
Light and motion are stated, so that all show the same aircraft in the same places. Prints the rms error of luma against the picture without
loss, over that of `real`: of pixels that the aircraft covers, and of those within 3 px of its box that it leaves alone.

Needs the package airtruth (docs/python.md), its program, and ffmpeg with libx264.
"""

import argparse
import os
import pathlib
import subprocess
import tempfile

import numpy as np

import airtruth

WIDTH, HEIGHT, FRAMES, VIEW_DEG = 640, 480, 60, 40
FLIGHTS = {"clouds and grain": (0.5, 0.7, (11, 12, 13)), "clear and clean": (0, 0.15, (21, 22))}  # cloud cover, noise of `synth`, seeds
QUANTISERS = (22, 28, 34)
STEP_AT_QP0 = 0.625  # of H.264's quantiser, in code values; it doubles with every 6
COVERED, ALONE = 10, 2  # code values by which the aircraft changes a pixel: at least; at most
RIM_PX = 3
AIRCRAFT = [("c172", 900, -8, 40, (25, 18, 0)), ("c172", 420, -2, 30, (25, -10, 1)), ("738", 1500, 6, 60, (45, -35, 0)),
            ("A320", 1100, 2, 90, (25, 47, 0))]  # type, range in m, azimuth in degrees, metres above the camera, velocity in m/s


def scene(video, codec_step, noise):
    names = [one.name for one in airtruth.aircraft()]
    intruders = []
    for kind, range_m, azimuth_deg, above_m, velocity in AIRCRAFT:
        azimuth = np.radians(azimuth_deg)
        begin = np.array([range_m * np.cos(azimuth), range_m * np.sin(azimuth), -150 - above_m])
        seconds = FRAMES / 30 + 1
        intruders.append({"aircraft": next(name for name in names if name.startswith(kind + "/")), "times_s": [0, seconds],
                          "waypoints_ned_m": [begin.tolist(), (begin + np.array(velocity) * seconds).tolist()]})
    return {"background": {"video": video}, "lens": {"vertical_fov_deg": VIEW_DEG}, "motion": {"model": "none"}, "intruder": intruders,
            "camera": {"position_ned_m": [0, 0, -150], "velocity_ned_mps": [25, 0, 0], "attitude_yaw_pitch_roll_deg": [0, 0, 0]},
            "light": {"sun_azimuth_deg": 120, "sun_elevation_deg": 40, "exposure": 0.9, "sky_colour": [0.25, 0.3, 0.4], "ground_colour": [0.12, 0.13, 0.08]},
            "optics": {"point_spread_px": 0.5},
            "sensor": {"noise_gain": 2e-4 * noise, "noise_floor": 2e-5 * noise, "chroma_spread_px": 1, "codec_step": codec_step}}


def luma_of(video):
    return [frame.gray.astype(float) for frame in airtruth.VideoReader(video)]


class Flight:
    """Pictures of one flight without loss, and as they are coded."""

    def __init__(self, airtruth_program, folder, seed, clouds, noise):
        self.folder, self.noise = folder, noise
        self.empty = os.path.join(folder, "flight.mp4")
        subprocess.run([airtruth_program, "synth", "--out", self.empty, "--seed", str(seed), "--width", str(WIDTH), "--height", str(HEIGHT), "--frames",
                        str(FRAMES), "--fov", str(VIEW_DEG), "--clouds", str(clouds), "--noise", str(noise), "--quality", "0", "--no-own-aircraft", "--quiet"],
                       check=True)
        described = {**scene(self.empty, 0, noise), "name": "flown", "output": {"video": "mkv"}}
        scene_file = os.path.join(folder, "flown.toml")
        pathlib.Path(scene_file).write_text(airtruth.toml_of(described), encoding="utf-8")
        subprocess.run([airtruth_program, "render", scene_file, "--out", folder, "--quiet"], check=True)
        self.shown, self.flown = list(airtruth.DataSet(folder)["flown"]), os.path.join(folder, "flown", "flown.mkv")
        self.luma, self.without_aircraft = [frame.gray.astype(float) for frame in self.shown], luma_of(self.empty)

    def coded(self, video, quantiser, first=0):
        out = os.path.join(self.folder, f"{os.path.basename(video)}-{quantiser}-{first}.mp4")
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-i", video, "-vf", f"select='gte(n,{first})'", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-qp",
                        str(quantiser), *(["-g", "17"] if first else []), out], check=True)
        return out

    def made(self, quantiser):
        """{name: luma of each frame}"""
        video = self.coded(self.empty, quantiser)
        inserted = {name: [frame.gray.astype(float) for frame in airtruth.render(scene(video, step, self.noise))]
                    for name, step in (("stage", STEP_AT_QP0 * 2 ** (quantiser / 6)), ("without", 0))}
        another = luma_of(self.coded(self.flown, quantiser, first=1))
        return {"real": luma_of(self.coded(self.flown, quantiser)), "another": another[:1] + another, **inserted}

    def errors(self, made):
        """{name: squared errors on the aircraft and beside it}, one of each aircraft and frame."""
        errors = {name: ([], []) for name in made}
        for index, frame in enumerate(self.shown):
            for intruder in frame.intruders:
                box = intruder.covered_box
                if index < 3 or box is None:
                    continue
                x, y, width, height = (int(side) for side in box)
                area = np.s_[max(0, y - RIM_PX):y + height + RIM_PX, max(0, x - RIM_PX):x + width + RIM_PX]
                change = np.abs(self.luma[index][area] - self.without_aircraft[index][area])
                for name, pictures in made.items():
                    error = (pictures[index][area] - self.luma[index][area]) ** 2
                    for place, where in enumerate((change > COVERED, change < ALONE)):
                        if where.sum() > 3:
                            errors[name][place].append(error[where].mean())
        return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("airtruth", help="the program")
    options = parser.parse_args()
    print(f"{'background':18} QP  {'pixels':8} error, code values; of it: another coding, with the stage, without")
    for words, (clouds, noise, seeds) in FLIGHTS.items():
        with tempfile.TemporaryDirectory() as folder:
            flights = []
            for seed in seeds:
                os.mkdir(os.path.join(folder, str(seed)))
                flights.append(Flight(options.airtruth, os.path.join(folder, str(seed)), seed, clouds, noise))
            for quantiser in QUANTISERS:
                each = [flight.errors(flight.made(quantiser)) for flight in flights]
                for place, pixels in enumerate(("covered", "beside")):
                    rms = {name: np.sqrt(np.mean(np.concatenate([one[name][place] for one in each]))) for name in each[0]}
                    print(f"{words:18} {quantiser}  {pixels:8} {rms['real']:5.2f}  " + "  ".join(f"{rms[name] / rms['real']:.2f}" for name in
                                                                                              ("another", "stage", "without")), flush=True)


if __name__ == "__main__":
    main()
