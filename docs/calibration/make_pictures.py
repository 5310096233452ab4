#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the pictures of docs/calibration that show a method on known input: air, sun, shutter, codec step, chroma spread.

usage: make_pictures.py PROGRAM

The methods are written here a second time, in their plainest form, so that a picture shows what a page says and not what
the program does. Frames come from `airtruth synth`. The other pictures are panels of `airtruth calibrate --plot`.
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

import cv2
import numpy as np

FOLDER = pathlib.Path(__file__).parent
rng = np.random.default_rng(1)


def gnuplot(name, script):
    """Runs a gnuplot script that draws a picture of 640 x 400 pixels."""
    head = f"""set terminal pngcairo size 640,400 font 'DejaVu Sans,10' noenhanced
set output '{FOLDER / name}'
set grid lc rgb '#dddddd'
set key noopaque
"""
    subprocess.run(["gnuplot"], input=head + script, text=True, check=True)


def block(name, rows):
    """Data of a gnuplot script."""
    return f"${name} << E\n" + "\n".join(" ".join(f"{v:.6g}" for v in row) for row in rows) + "\nE\n"


def linear(coded):
    """Light from coded values 0..1 (IEC 61966-2-1)."""
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def flight(program, folder, *options, fov_deg=60):
    """A virtual flight: its first frame as linear RGB, and its true attitude."""
    video, truth = folder / "flight.mkv", folder / "truth.csv"
    subprocess.run([program, "--quiet", "synth", "-o", video, "--truth", truth, "--width", "960", "--height", "720",
                    "--frames", "2", "--fov", str(fov_deg), "--shake", "0", "--noise", "0.3", "--quality", "6",
                    "--no-own-aircraft", "--overwrite", *options], check=True)
    read, frame = cv2.VideoCapture(str(video)).read()
    assert read
    with open(truth) as file:
        pose = next(csv.DictReader(line for line in file if not line.startswith("#")))
    return linear(frame[:, :, ::-1] / 255), {k: float(v) for k, v in pose.items() if v}


def directions(pose, width=960, height=720, fov_deg=60):
    """North, east and down of every pixel's ray."""
    focal = height / 2 / np.tan(np.radians(fov_deg) / 2)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    body = np.stack([np.full_like(x, focal), x, y], -1)
    body /= np.linalg.norm(body, axis=-1, keepdims=True)
    yaw, pitch, roll = (np.radians(pose[k]) for k in ("yaw_deg", "pitch_deg", "roll_deg"))
    cy, sy, cp, sp, cr, sr = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    world_from_body = np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                                [-sp, cp * sr, cp * cr]])
    return body @ world_from_body.T


def air(program, folder):
    altitude, true_per_km = 300, 0.2
    light, pose = flight(program, folder, "--altitude", str(altitude), "--extinction", str(true_per_km), "--clouds", "0.2")
    depression = np.degrees(np.arcsin(directions(pose)[..., 2]))
    borders = np.geomspace(2.5, 40, 15)
    points = []
    for low, high in zip(borders, borders[1:]):
        inside = (depression >= low) & (depression < high)
        if inside.sum() > 500:
            range_km = altitude / np.sin(np.radians(np.sqrt(low * high))) / 1000
            points.append((range_km, np.quantile(light[..., 1][inside], 0.03)))
    points = np.array(points)
    airlight = np.median(light[..., 1][(depression < -0.5) & (depression > -2)])

    def fit(per_km):
        t = np.exp(-per_km * points[:, 0])
        dark = (t * (points[:, 1] - airlight * (1 - t))).sum() / (t * t).sum()
        return ((points[:, 1] - dark * t - airlight * (1 - t)) ** 2).sum(), dark
    per_km = min(np.geomspace(0.02, 2, 400), key=lambda b: fit(b)[0])
    dark = fit(per_km)[1]
    gnuplot("air.png", block("points", points) + f"""
set title 'darkest ground of a virtual flight, extinction {true_per_km} per km'
set xlabel 'range, km'
set ylabel 'linear light, green'
set key bottom right
set xrange [0:*]
set yrange [0:*]
plot {dark} * exp(-{per_km} * x) + {airlight} * (1 - exp(-{per_km} * x)) lw 2 lc rgb '#ff7f0e' title 'fit: {per_km:.2f} per km', \\
     {airlight} lw 1 dt 2 lc rgb '#555555' title 'airlight: the sky at the horizon', \\
     $points with points pt 7 lc rgb '#1f77b4' title '3 % quantile of a band of ground'
""")


def sun(program, folder):
    true_azimuth, true_elevation, fov_deg = 40, 35, 95
    light, pose = flight(program, folder, "--sun-azimuth", str(true_azimuth), "--sun-elevation", str(true_elevation), "--clouds", "0.2", fov_deg=fov_deg)
    d = directions(pose, fov_deg=fov_deg)
    sky = np.degrees(np.arcsin(-d[..., 2])) > 2.5
    chosen = rng.permutation(np.flatnonzero(sky))[:4000]
    d, green = d.reshape(-1, 3)[chosen], np.minimum(light[..., 1].reshape(-1)[chosen], 1)

    def cost(azimuth, elevation):
        a, e = np.radians(azimuth), np.radians(elevation)
        toward = d @ np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), -np.sin(e)])
        up, lobe = -d[:, 2], np.maximum(toward, 0)
        terms = np.stack([np.ones_like(up), up, up**2, np.exp(-10 * up), toward**2, lobe**2, lobe**8, lobe**48], 1)
        weights = np.full(len(up), 0.5)
        for _ in range(6):
            solution = np.linalg.solve(terms.T @ (weights[:, None] * terms) + 1e-6 * np.eye(8), terms.T @ (weights * green))
            rest = green - terms @ solution
            last = (weights * rest**2).sum()
            weights = np.where(rest > 0, 0.12, 0.88)
        return last if solution[4:].sum() > 0 else np.nan
    azimuths, elevations = np.arange(-180, 180, 6), np.arange(5, 90, 4)
    costs = np.array([[cost(a, e) for a in azimuths] for e in elevations])
    rows = [(a, e, costs[j, i] / np.nanmin(costs)) for j, e in enumerate(elevations) for i, a in enumerate(azimuths)]
    j, i = np.unravel_index(np.nanargmin(costs), costs.shape)
    gnuplot("sun.png", block("costs", [r for r in rows if np.isfinite(r[2])]) + f"""
set title 'misfit of the sky by direction of the sun, a virtual flight that looks north'
set xlabel 'azimuth, degrees'
set ylabel 'elevation, degrees'
set cblabel 'misfit over the least'
set logscale cb
set xrange [-180:180]
set yrange [0:90]
set xtics 60
set palette defined (0 '#0b3c6f', 1 '#7fb2d9', 2 '#ffffff')
set key bottom right opaque box lc rgb '#dddddd'
plot $costs with points pt 5 ps 1.6 palette notitle, \\
     '+' using ({azimuths[i]}):({elevations[j]}) every ::0::0 with points pt 6 ps 2.5 lw 3 lc rgb '#ff7f0e' title 'least misfit', \\
     '+' using ({true_azimuth}):({true_elevation}) every ::0::0 with points pt 2 ps 2 lw 3 lc rgb '#d62728' title 'true sun'
""")


def moving_blur(picture, length_px):
    kernel = np.zeros((1, 41), np.float32)
    for place in np.linspace(-length_px / 2, length_px / 2, 64):
        at = int(np.floor(place))
        kernel[0, 20 + at] += (1 - place + at) / 64
        kernel[0, 21 + at] += (place - at) / 64
    return cv2.filter2D(picture, -1, kernel)


def shutter(program, folder):
    light, _ = flight(program, folder, "--altitude", "60", "--clouds", "0.4")
    ground = cv2.GaussianBlur(light[460:700, :, 1].astype(np.float32), (0, 0), 0.7)

    def detail(picture):
        return float((np.diff(picture[:, 60:-60], axis=1) ** 2).mean() / (np.diff(picture[:, 60:-60], axis=0) ** 2).mean())
    speed_px, share = 20, 0.5
    moving = moving_blur(ground, speed_px * share)
    tried = [(length / speed_px, detail(moving_blur(ground, length))) for length in np.arange(0.5, 20, 0.5)]
    # Frames of a camera that shakes sideways, each row at the time at which it is read.
    readout, height = 0.6, ground.shape[0]
    def shift(t):
        return 14 * np.sin(0.5 * t) + 6 * np.sin(0.8 * t + 1)
    columns, rows = np.meshgrid(np.arange(960, dtype=np.float32), np.arange(height, dtype=np.float32))
    frames = [cv2.remap(ground, (columns + shift(k + readout * (rows / height - 0.5))).astype(np.float32), rows,
                        cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT) for k in range(40)]
    window = cv2.createHanningWindow((800, 40), cv2.CV_32F)
    centres = np.arange(20, height - 19, 20)
    motions = np.array([[cv2.phaseCorrelate(a[y - 20:y + 20, 80:880], b[y - 20:y + 20, 80:880], window)[0][0] for y in centres]
                        for a, b in zip(frames, frames[1:])])
    speeds, shears = motions.mean(1), np.polyfit(centres, motions.T, 1)[0]
    changes = (speeds[2:] - speeds[:-2]) / 2
    gnuplot("shutter.png", block("tried", tried) + block("shears", np.stack([changes, shears[1:-1] * height], 1)) + f"""
set multiplot layout 1,2
set title 'exposure of {share} of the interval'
set xlabel 'blur of the frame at rest, of the interval'
set ylabel 'detail along the motion, of that across'
set logscale y
set xrange [0:1]
set arrow from {share}, graph 0 to {share}, graph 1 nohead dt 2 lc rgb '#555555'
plot $tried with lines lw 2 lc rgb '#ff7f0e' title 'frame at rest, blurred', \\
     {detail(moving)} lw 2 lc rgb '#1f77b4' title 'frame in motion'
unset arrow
unset logscale
set xrange [*:*]
set title 'readout of {readout} of the interval'
set xlabel 'change of speed, px per frame'
set ylabel 'shear over the height, px'
set key top left
plot {readout} * x lw 2 lc rgb '#ff7f0e' title 'slope {readout}', $shears with points pt 7 lc rgb '#1f77b4' title 'pairs of frames'
unset multiplot
""")


def codec_step(program, folder):
    video = folder / "clip.mkv"
    subprocess.run([program, "--quiet", "synth", "-o", video, "--width", "640", "--height", "480", "--frames", "120", "--overwrite"], check=True)
    log = subprocess.run(["ffmpeg", "-loglevel", "debug", "-i", video, "-c:v", "libx264", "-crf", "26", "-f", "null", "-"],
                         stderr=subprocess.PIPE, text=True, check=True).stderr
    steps = np.array([0.625 * 2 ** (float(q) / 6) for q in re.findall(r"frame=\s*\d+ QP=([\d.]+)", log)])
    counts, borders = np.histogram(steps, bins=24)
    low, middle, high = np.quantile(steps, [0.16, 0.5, 0.84])
    gnuplot("codec-step.png", block("counts", np.stack([(borders[:-1] + borders[1:]) / 2, counts], 1)) + f"""
set title 'quantiser of {len(steps)} frames of a virtual flight, libx264 at CRF 26'
set xlabel 'step, code values'
set ylabel 'frames'
set yrange [0:*]
set style fill solid
set boxwidth {(borders[1] - borders[0]) * 0.9}
set object 1 rectangle from {low}, graph 0 to {high}, graph 1 fc rgb '#f3e3d3' fs noborder behind
set arrow from {middle}, graph 0 to {middle}, graph 1 nohead lw 2 lc rgb '#ff7f0e'
plot $counts with boxes lc rgb '#1f77b4' title 'frames', \\
     NaN lw 2 lc rgb '#ff7f0e' title 'median: {middle:.1f}', NaN lw 9 lc rgb '#f3e3d3' title '16 to 84 %: the error is half of it'
""")


def chroma_spread(program, folder):
    luma_px, chroma_px, side, finer = 0.7, 1.6, 200, 8
    x, y = np.meshgrid(*[(np.arange(side * finer) + 0.5) / finer - side / 2] * 2)
    c, s = np.cos(0.15), np.sin(0.15)
    step = (c * x + s * y > 0).astype(np.float32)

    def seen(spread_px, every):
        soft = cv2.GaussianBlur(step, (0, 0), spread_px * finer)
        pixels = cv2.resize(soft, (side, side), interpolation=cv2.INTER_AREA)
        return cv2.resize(pixels, (side // every,) * 2, interpolation=cv2.INTER_AREA)
    luma = seen(luma_px, 1)
    chroma = seen(np.hypot(luma_px, chroma_px), 2)

    def profile(picture, every):
        u, v = np.meshgrid(*[(np.arange(side // every) + 0.5) * every - side / 2] * 2)
        place = c * u + s * v
        inside = (np.hypot(u, v) < 80) & (np.abs(place) < 6)
        noisy = picture[inside] + rng.normal(0, 0.03, inside.sum())
        bins = np.floor(place[inside] / 0.25)
        return np.array([[place[inside][bins == b].mean(), noisy[bins == b].mean()] for b in np.unique(bins)])
    # A pixel is a box of variance 1/12, and a chroma sample one of two pixels.
    of_luma = np.sqrt(luma_px**2 + 1 / 12)
    of_chroma = np.sqrt(luma_px**2 + chroma_px**2 + 4 / 12)
    gnuplot("chroma-spread.png", block("luma", profile(luma, 1)) + block("chroma", profile(chroma, 2)) + f"""
set title 'one edge in luma and in chroma at half the resolution'
set xlabel 'px across the edge'
set ylabel 'height of the step'
set key top left
set xrange [-6:6]
plot norm(x / {of_luma}) lw 2 lc rgb '#ff7f0e' notitle, norm(x / {of_chroma}) lw 2 lc rgb '#ff7f0e' title 'Gaussian steps', \\
     $luma with points pt 7 ps 0.7 lc rgb '#1f77b4' title 'luma: {luma_px} px', \\
     $chroma with points pt 7 ps 0.7 lc rgb '#9467bd' title 'chroma: a further {chroma_px} px'
""")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        for draw in (air, sun, shutter, codec_step, chroma_spread):
            draw(sys.argv[1], pathlib.Path(folder))


if __name__ == "__main__":
    main()
