# SPDX-License-Identifier: Apache-2.0
"""The commands calibrate and mask: python3 calibrate_test.py AIRTRUTH

The clip of calibrate is drawn here, with numpy and OpenCV: painted panels through a known point spread, with known noise. The clip of mask is a
virtual flight, whose own aircraft is known.
"""

import json
import os
import shutil
import subprocess
import sys

try:
    import cv2
    import numpy
    import tomllib
except ImportError as missing:
    DEBIAN_PYTHON = "/usr/bin/python3"
    if sys.executable != DEBIAN_PYTHON and os.path.exists(DEBIAN_PYTHON):
        os.execv(DEBIAN_PYTHON, [DEBIAN_PYTHON] + sys.argv)
    print(f"skipped: {missing}; expected Debian's python3-numpy and python3-opencv")
    sys.exit(77)

import program
from program import made, path, read, run, write

WIDTH, HEIGHT, FRAMES = 640, 480, 8
FINE = 4  # samples a pixel along each side of the drawing


def linear_from_srgb(v):
    return numpy.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(x):
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def panels(dice):
    """Light of a wall of painted panels, FINE samples a pixel."""
    wall = numpy.full((HEIGHT * FINE + 400, WIDTH * FINE + 400), 0.55, numpy.float32)
    for _ in range(40):
        middle, size = dice.uniform([0, 0], wall.shape[::-1]), dice.uniform(120, 500, 2)
        corners = cv2.boxPoints((tuple(map(float, middle)), tuple(map(float, size)), float(dice.uniform(0, 180))))
        cv2.fillConvexPoly(wall, corners.astype(numpy.int32), float(dice.uniform(0.15, 0.95)))
    return linear_from_srgb(wall).astype(numpy.float32)


def draw(name, spread_px, noise_gain, noise_floor, codec=("-c:v", "ffv1")):
    """A camera that moves along a wall of panels. docs/formats/scene.md says what the numbers mean: a Gaussian over the light of whole
    pixels, itself integrated over whole pixels, and noise whose variance in linear light x is gain x + floor."""
    dice = numpy.random.default_rng(1)
    # The drawing is reduced to pixels by their mean, which is one integration; the other one is a variance of 1/12.
    wall = cv2.GaussianBlur(panels(dice), (0, 0), float(numpy.hypot(spread_px, 12**-0.5)) * FINE)
    encoder = subprocess.Popen(["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "yuv420p", "-s", f"{WIDTH}x{HEIGHT}", "-r", "30",
                                "-i", "-", *codec, "-color_range", "tv", path(name)], stdin=subprocess.PIPE)
    for frame in range(FRAMES):
        x, y = 17 * frame, 11 * frame
        light = cv2.resize(wall[y:y + HEIGHT * FINE, x:x + WIDTH * FINE], (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA).astype(float)
        coded = srgb_from_linear(light)
        slope = 2e-3 / (linear_from_srgb(coded + 1e-3) - linear_from_srgb(coded - 1e-3))
        noisy = coded + slope * numpy.sqrt(noise_gain * light + noise_floor) * dice.standard_normal(light.shape)
        encoder.stdin.write(numpy.clip(numpy.rint(16 + 219 * noisy), 0, 255).astype(numpy.uint8).tobytes())
        encoder.stdin.write(bytes([128]) * (WIDTH * HEIGHT // 2))
    encoder.stdin.close()
    assert encoder.wait() == 0


def make_inputs():
    draw("panels.mkv", 0.8, 4e-4, 3e-5)
    made("synth", "-o", "own.mkv", "--width", "480", "--height", "360", "--frames", "60", "--mask", "own.png")
    made("synth", "-o", "free.mkv", "--width", "320", "--height", "240", "--frames", "60", "--no-own-aircraft")
    write("text.mkv", "This is a letter and not a video.\n")
    write("small.pgm", b"P5\n16 12\n255\n" + b"\xff" * (16 * 12))


def copies_of(name, count=20):
    """Names of copies of a clip, so that there is long work: a command takes each file once."""
    names = [f"copy{i}-{name}" for i in range(count)]
    for copy in names:
        shutil.copyfile(path(name), path(copy))
    return names


def calibrated(video, name):
    made("calibrate", video, "-o", name, "--profile", "none", "--overwrite")
    return tomllib.loads(read(name))


def own_aircraft(name):
    return cv2.imread(path(name), cv2.IMREAD_GRAYSCALE) < 128


class Calibrate(program.Case):
    def test_finds_the_noise_and_the_point_spread_that_were_put_in(self):
        for spread_px, gain, floor in ((0.6, 4e-4, 3e-5), (1.2, 1e-4, 1e-5)):
            draw("known.mkv", spread_px, gain, floor)
            found = calibrated("known.mkv", "known.toml")
            self.assert_near(found["optics"]["point_spread_px"], spread_px, 0.06, "point spread")
            self.assertLess(found["optics"].get("sharpening", 0), 0.05)
            # At a fifth, a half and the whole of the light that the camera takes: gain and floor compensate one another.
            for light in (0.2, 0.5, 1.0):
                truth = (gain * light + floor) ** 0.5
                self.assert_near((found["sensor"]["noise_gain"] * light + found["sensor"]["noise_floor"]) ** 0.5, truth, 0.06, f"noise at {light}")
            self.assertLess(found["sensor"]["noise_correlation_px"], 0.3)  # white noise

    def test_six_steps_of_x264_are_a_factor_of_two_of_its_quantiser(self):
        steps = []
        for crf in ("22", "28"):
            draw("coded.mp4", 0.8, 4e-4, 3e-5, ("-c:v", "libx264", "-qp", crf))
            steps.append(calibrated("coded.mp4", "coded.toml")["sensor"]["codec_step"])
        self.assert_near(steps[1] / steps[0], 2, 0.05, "ratio of the codec's steps")

    def test_no_edge_and_no_noise_is_of_a_damaged_frame(self):
        # The second frame is broken, and each later one is predicted from the one before.
        draw("coded.mkv", 0.8, 4e-4, 3e-5, ("-c:v", "libx264", "-qp", "18", "-bf", "0", "-sc_threshold", "0"))
        packets = subprocess.run(["ffprobe", "-v", "error", "-show_entries", "packet=pos,size", "-of", "json", path("coded.mkv")],
                                 check=True, capture_output=True).stdout
        second = json.loads(packets)["packets"][1]
        begin, size = int(second["pos"]), int(second["size"])
        with open(path("coded.mkv"), "r+b") as file:
            file.seek(begin + size // 2)
            file.write(numpy.random.default_rng(1).bytes(size // 3))
        made("calibrate", "coded.mkv", "-o", "damaged.toml", "--profile", "none", "--overwrite")
        self.assertIn("the clip shows 0 clean straight edges", read("damaged.toml"))
        self.assertIn("the clip has flat parts of 0 brightnesses", read("damaged.toml"))

    def test_the_camera_file_names_its_clip_and_goes_into_a_scene(self):
        found = calibrated("panels.mkv", "camera.toml")
        self.assertEqual((found["clip"]["video"], found["clip"]["frames"]), ("panels.mkv", FRAMES))
        self.assertEqual((found["clip"]["width"], found["clip"]["height"]), (WIDTH, HEIGHT))
        write("scene.toml", """name = "clip"
[background]
video = "panels.mkv"
[lens]
vertical_fov_deg = 60
[camera]
position_ned_m = [0, 0, -150]
[motion]
model = "none"
[realism]
file = "camera.toml"
[[intruder]]
aircraft = "c172/news"
waypoints_ned_m = [[100, -20, -150], [100, 20, -150]]
speed_mps = 40
[output]
video = "mkv"
""")
        made("render", "scene.toml", "--out", ".", "--no-cache")
        effective = read("clip", "sequence.json")
        self.assertIn(f"{found['sensor']['noise_gain']:.4g}"[:5], effective)

    def test_the_plot_is_a_picture_and_files_are_kept_unless_overwrite(self):
        made("calibrate", "panels.mkv", "-o", "plotted.toml", "--plot", "plot.png")
        plot = cv2.imread(path("plot.png"))
        self.assertGreater(min(plot.shape[:2]), 300)
        self.assertGreater(plot.std(), 10)  # not one colour
        write("kept.toml", "mine")
        self.assert_refused(run("calibrate", "panels.mkv", "-o", "kept.toml"), "exists already", "--overwrite")
        self.assertEqual(read("kept.toml"), "mine")
        made("calibrate", "panels.mkv", "-o", "kept.toml", "--overwrite")
        self.assertEqual(read("kept.toml"), read("plotted.toml"))

    def test_bad_input_is_refused_in_one_line_and_writes_nothing(self):
        cases = [(("none.mkv",), "none.mkv"), (("text.mkv",), "text.mkv"), (("panels.mkv", "--mask", "small.pgm"), "16x12"),
                 (("panels.mkv", "--lens", "none.yml"), "none.yml"), (("panels.mkv", "own.mkv"), "one size"),
                 (("own.mkv", "./own.mkv"), "./own.mkv: is given twice, first as own.mkv"),
                 (("panels.mkv", "--gamma", "9"), "gamma")]
        for arguments, word in cases:
            with self.subTest(arguments):
                self.assert_refused(run("calibrate", *arguments, "-o", "refused.toml"), word)
                self.assertFalse(os.path.exists(path("refused.toml")))

    def test_ctrl_c_leaves_nothing(self):
        self.assert_stopped(program.interrupted(["calibrate", "own.mkv", *copies_of("own.mkv"), "-o", "stopped.toml"], program.has_open("own.mkv")))
        self.assertEqual([name for name in os.listdir(path()) if "stopped" in name], [])

    def test_ctrl_c_may_reach_a_thread_that_a_library_began_before_the_program(self):
        # As OpenBLAS does; the program cannot block signals for it.
        source = write("early.c", "#include <pthread.h>\n#include <unistd.h>\nstatic void *wait_on(void *p) { for (;;) pause(); return p; }\n"
                                  "__attribute__((constructor)) static void begin(void) { pthread_t t; pthread_create(&t, 0, wait_on, 0); }\n")
        subprocess.run(["cc", "-shared", "-fPIC", "-o", path("early.so"), source, "-lpthread"], check=True)
        self.assert_stopped(program.interrupted(["calibrate", "own.mkv", *copies_of("own.mkv"), "-o", "stopped.toml"], program.has_open("own.mkv"),
                                                LD_PRELOAD=path("early.so")))


class Mask(program.Case):
    def test_covers_the_own_aircraft(self):
        said = made("mask", "own.mkv", "-o", "found.png").stdout
        truth, found = own_aircraft("own.png"), own_aircraft("found.png")
        self.assertGreater((truth & found).sum() / (truth | found).sum(), 0.9)
        self.assertIn(f"covers {100 * found.mean():.1f} %", said)

    def test_is_free_where_no_own_aircraft_is(self):
        made("mask", "free.mkv", "-o", "free.png")
        self.assertLess(own_aircraft("free.png").mean(), 0.001)

    def test_an_existing_file_is_kept_unless_overwrite(self):
        write("kept.png", "mine")
        self.assert_refused(run("mask", "own.mkv", "-o", "kept.png"), "exists already", "--overwrite")
        self.assertEqual(read("kept.png"), "mine")
        made("mask", "own.mkv", "-o", "kept.png", "--overwrite")
        self.assertTrue(own_aircraft("kept.png").any())

    def test_bad_input_is_refused_in_one_line_and_writes_nothing(self):
        made("synth", "-o", "still.mkv", "--width", "320", "--height", "240", "--frames", "40", "--speed", "0", "--shake", "0", "--noise", "0")
        made("synth", "-o", "one.mkv", "--width", "320", "--height", "240", "--frames", "1")
        for video in ("none.mkv", "text.mkv", "one.mkv"):
            with self.subTest(video):
                self.assert_refused(run("mask", video, "-o", "refused.png"), video)
                self.assertFalse(os.path.exists(path("refused.png")))

    def test_ctrl_c_leaves_nothing(self):
        self.assert_stopped(program.interrupted(["mask", "own.mkv", "-o", "stopped.png"], program.has_open("own.mkv")))
        self.assertEqual([name for name in os.listdir(path()) if "stopped" in name], [])


if __name__ == "__main__":
    program.main(make_inputs)
