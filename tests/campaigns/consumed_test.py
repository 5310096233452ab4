# SPDX-License-Identifier: Apache-2.0
"""Values that are read rightly and then used: python3 consumed_test.py AIRTRUTH [--cases N] [--first I] [--kinds a,b] [--seed S]

Spans of time, sizes, counts and distances multiply into frames, samples and bytes. Each case draws some of them over all orders of
magnitude, writes a file that parses, and runs what works with it. The rules of common.py hold; beyond them a run takes at most
MOST_S of processor time and MOST_BYTES of memory, whatever the values are. A case that broke a rule is kept (AIRTRUTH_BROKEN, else
./airtruth-broken).
"""

import collections
import os
import random
import resource
import shutil
import struct
import tempfile
import time
import zlib

import common
from common import Broken

MOST_S = 60  # of a clip of 8 frames of 96 x 64 px: some hundred times what a usual one takes
MOST_BYTES = 3 << 30  # ten times what a render of 1920 x 1080 takes


def number(dice, usual, most=1e12):
    """Mostly the usual value; else log-uniform, or one of the numbers at which programs break."""
    if dice.random() < 0.8:
        return usual
    if dice.random() < 0.2:
        return dice.choice((0, 1, -1, 2**31 - 1, 2**31, 2**53, 1e15, -1e9, 86400, 86401, 16384, 16385))
    value = 1e-6 * (most / 1e-6)**dice.random()
    return -value if dice.random() < 0.1 else value


def whole(dice, usual, most=1e10):
    return int(number(dice, usual, most))


def clip(dice, airtruth, place):
    """A scene whose times, speeds, distances and frames are anything."""
    n = lambda usual, most=1e12: repr(number(dice, usual, most))  # noqa: E731
    path = dice.choice((
        f"waypoints_ned_m = [[{n(30)}, {n(-3)}, {n(-150)}], [{n(32)}, {n(9)}, {n(-151)}]]\nspeed_mps = {n(20)}\nstart_s = {n(0)}",
        f"waypoints_ned_m = [[30, -3, -150], [{n(31)}, 0, -150], [32, 9, -151]]\ntimes_s = [0, {n(1)}, {n(2)}]",
        f"encounter = {{ cpa_time_s = {n(0.2)}, cpa_right_m = {n(30)}, cpa_above_m = {n(5)}, course_deg = 180, speed_mps = {n(40)} }}",
        f"path_file = \"path.csv\"\nstart_s = {n(0)}"))
    rows = "".join(f"{abs(number(dice, i))!r},{n(30)},{n(i)},{n(-150)}\n" for i in range(4))
    common.write(f"{place}/path.csv", "time_s,north_m,east_m,down_m\n" + rows)
    text = common.SCENE.replace("waypoints_ned_m = [[30, -3, -150], [32, 9, -151]]\nspeed_mps = 20", path)
    text = text.replace('"clip.mkv"', f'"clip.mkv"\nfirst_frame = {whole(dice, 2)}\nframe_count = {whole(dice, 4)}', dice.randrange(2))
    text = text.replace("position_ned_m = [0, 0, -150]",
                        f"position_ned_m = [{n(0)}, {n(0)}, {n(-150)}]\nvelocity_ned_mps = [{n(20, 1e4)}, 0, 0]", dice.randrange(2))
    text = text.replace("[motion]\nmodel = \"none\"", f"[motion]\nreference = \"smoothed\"\nsmoothing_s = {n(1)}", dice.randrange(2))
    text = text.replace("[output]\n", f"[output]\nkeyframe_s = {n(1)}\n")
    text += dice.choice(("", f"[shutter]\nexposure_s = {n(0.005, 10)}\nreadout_s = {n(0.01, 10)}\n", f"[optics]\npoint_spread_px = {n(1, 100)}\n"))
    common.write(f"{place}/scene.toml", text)
    return dice.choice(([airtruth, "render", f"{place}/scene.toml", "--no-cache", "--out", f"{place}/out"],
                        [airtruth, "preview", f"{place}/scene.toml", "-o", f"{place}/out.png"]))


def log(dice, airtruth, place):
    """A flight log whose clock jumps and whose places are anywhere."""
    t, height = number(dice, 0), number(dice, 500, 1e5)
    rows = []
    for i in range(dice.choice((2, 5, 60))):
        t += abs(number(dice, 0.2, 1e6)) if dice.random() < 0.1 else 0.2
        rows.append(f"{t!r},{47 + 1e-5 * i:.6f},8,{height:.1f},{i},0,0\n")
    common.write(f"{place}/log.csv", "time_s,latitude_deg,longitude_deg,altitude_m,yaw_deg,pitch_deg,roll_deg\n" + "".join(rows))
    scene = common.SCENE.replace("position_ned_m = [0, 0, -150]", f'log = "log.csv"\nlog_offset_s = {number(dice, 0.1)}')
    common.write(f"{place}/scene.toml", scene)
    return dice.choice(([airtruth, "log", "show", f"{place}/log.csv"],
                        [airtruth, "log", "align", f"{place}/log.csv", f"{place}/clip.mkv", "--fov", "60"],
                        [airtruth, "render", f"{place}/scene.toml", "--no-cache", "--out", f"{place}/out"]))


def catalogue(dice, airtruth, place):
    """Counts, lengths and ranges of a set."""
    n = lambda usual: repr(number(dice, usual))  # noqa: E731
    rule = dice.choice((
        f'[[random]]\nname = "r{{index}}"\ncount = {whole(dice, 3)}\naircraft = ["c172/*"]\nframe_count = {whole(dice, 3)}\n'
        f"range_m = [{n(100)}, {n(900)}]\nspeed_mps = [{n(20)}, {n(60)}]\n",
        f'[[random]]\nname = "r{{index}}"\ncount = 3\nframe_count = 3\nintruders = [1, {whole(dice, 2)}]\naircraft = ["c172/*"]\n',
        f'[[distractor]]\nkind = "bird"\ncount = [1, {whole(dice, 5)}]\nflock = [1, {whole(dice, 20)}]\nrange_m = [20, {n(300)}]\n'))
    text = common.CATALOGUE.replace("frame_count = 3, width = 64, height = 64",
                                    f"frame_count = {whole(dice, 3)}, width = {whole(dice, 64)}, height = {whole(dice, 64)}")
    common.write(f"{place}/set.toml", text + rule)
    return [airtruth, "dataset", "plan", f"{place}/set.toml"]


def picture(dice, airtruth, place):
    """Pictures of any size, which compress to nothing."""
    width, height = (min(2**31 - 1, max(1, whole(dice, dice.choice((1, 16, 64, 8192, 16384)), 1e6))) for _ in range(2))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))  # noqa: E731
    rows = zlib.compressobj(1)
    packed = b"".join(rows.compress(b"\0" * (1 + min(width, 1 << 20))) for _ in range(min(height, (64 << 20) // (1 + min(width, 1 << 20))))) + rows.flush()
    data = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) + chunk(b"IDAT", packed) +
            chunk(b"IEND", b""))
    common.write(f"{place}/frames/000000.png", data)
    common.write(f"{place}/frames/000001.png", data)
    common.write(f"{place}/scene.toml", common.SCENE.replace('"clip.mkv"', '"frames"\nframe_rate_hz = 30'))
    common.write(f"{place}/masked.toml", common.SCENE.replace('"clip.mkv"', '"clip.mkv"\nmask = "frames/000000.png"'))
    return dice.choice(([airtruth, "render", f"{place}/scene.toml", "--no-cache", "--out", f"{place}/out"],
                        [airtruth, "render", f"{place}/masked.toml", "--no-cache", "--out", f"{place}/out"],
                        [airtruth, "preview", f"{place}/scene.toml", "-o", f"{place}/out.png"],
                        [airtruth, "motion", f"{place}/frames", "-o", f"{place}/out.csv"]))


KINDS = {"clip": clip, "log": log, "catalogue": catalogue, "picture": picture}


class Campaign:
    def __init__(self, airtruth, root, seed):
        self.airtruth, self.root, self.seed = airtruth, root, seed
        self.environment = common.environment(os.path.join(root, "cache"))
        self.broken = []
        common.run([airtruth, "synth", "-o", f"{root}/clip.mkv", "--width", "96", "--height", "64", "--frames", "8"], codes=(0,))

    def case(self, kind, case):
        dice = random.Random(f"{self.seed} {kind} {case}")
        place = os.path.join(self.root, "case")
        shutil.rmtree(place, ignore_errors=True)
        os.makedirs(place)
        shutil.copy(os.path.join(self.root, "clip.mkv"), place)
        command = KINDS[kind](dice, self.airtruth, place)
        what = f"{kind} {case}"
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        try:
            done = common.run(command, what, env=self.environment, cwd=self.root)
            used = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime
            if seconds > MOST_S:
                raise Broken(f"{what}: took {seconds:.0f} s of processor time")
            # The largest of all children so far: the first one to exceed it is named.
            if used.ru_maxrss << 10 > MOST_BYTES >= before.ru_maxrss << 10:
                raise Broken(f"{what}: took {used.ru_maxrss >> 10} MiB of memory")
            if common.halves(place):
                raise Broken(f"{what}: half-made files are left: {common.halves(place)}")
            return done.code
        except Broken as broken:
            kept = common.keep(place, f"{kind}-{case}")
            self.broken.append(f"{broken} (kept in {kept}; command: {' '.join(command)})")
            return "broken"

    def run(self, kind, first, cases):
        began = time.monotonic()
        outcomes = collections.Counter(self.case(kind, case) for case in range(first, first + cases))
        print(f"{kind}: {cases} cases, {outcomes[0]} worked, {outcomes[2]} refused in one line, {outcomes['broken']} broke a rule "
              f"({(time.monotonic() - began) / max(1, cases):.2f} s each)", flush=True)


def body():
    how = common.campaign_arguments()
    with tempfile.TemporaryDirectory(prefix="airtruth_consumed_") as root:
        campaign = Campaign(how.airtruth, root, how.seed)
        for kind in KINDS:
            if how.wants(kind):
                campaign.run(kind, how.first, how.cases)
        common.expect_none_broken(campaign.broken)


if __name__ == "__main__":
    common.main(body)
