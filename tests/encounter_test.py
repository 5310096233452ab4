# SPDX-License-Identifier: Apache-2.0
"""`airtruth encounter` as its users run it: python3 encounter_test.py AIRTRUTH SOURCE"""

import csv
import math
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

AIRTRUTH = ""
MODEL = ""
OWN = ""


class Encounter(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="airtruth-encounter-")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def run_it(self, *arguments):
        return subprocess.run(
            [AIRTRUTH, "encounter", *arguments], cwd=self.folder, capture_output=True, text=True, timeout=120
        )

    def done(self, *arguments):
        made = self.run_it(*arguments)
        self.assertEqual(made.returncode, 0, made.stderr)
        return made

    def refused(self, *arguments, says=()):
        made = self.run_it(*arguments)
        self.assertEqual(made.returncode, 2, made.stdout + made.stderr)
        self.assertEqual(made.stderr.count("\n"), 1, made.stderr)
        for word in says:
            self.assertIn(word, made.stderr)

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def rows(self, name):
        with open(self.path(name), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_a_seed_gives_the_same_file_on_any_number_of_threads(self):
        for name, jobs in (("a.csv", "1"), ("b.csv", "3")):
            self.done("sample", MODEL, "--count", "300", "--seed", "7", "--jobs", jobs, "-o", name)
        self.assertEqual(self.bytes_of("a.csv"), self.bytes_of("b.csv"))
        self.done("sample", MODEL, "--count", "300", "--seed", "8", "-o", "c.csv")
        self.assertNotEqual(self.bytes_of("a.csv"), self.bytes_of("c.csv"))
        # The first tracks do not depend on how many follow.
        self.done("sample", MODEL, "--count", "10", "--seed", "7", "-o", "d.csv")
        self.assertTrue(self.bytes_of("a.csv").startswith(self.bytes_of("d.csv")))

    def test_a_cut_by_altitude_holds(self):
        self.done("sample", MODEL, "--count", "200", "--altitude-ft", "1000", "1500", "-o", "a.csv")
        starts = [-float(row["down_m"]) / 0.3048 for row in self.rows("a.csv") if float(row["time_s"]) == 0]
        self.assertEqual(len(starts), 200)
        self.assertGreaterEqual(min(starts), 1000 - 1e-6)
        self.assertLessEqual(max(starts), 1500 + 1e-6)
        self.refused("sample", MODEL, "--altitude-ft", "8000", "9000", "-o", "b.csv", says=["no traffic in the cut"])
        self.refused("sample", MODEL, "--domain", "1", "-o", "b.csv", says=["has no geographic domain"])

    def test_pairs_pass_the_own_track_and_carry_weights(self):
        made = self.done(
            "sample", MODEL, "--own", OWN, "--count", "60", "--cpa-time", "20", "--hmd-m", "-90", "90", "-o", "a.csv"
        )
        self.assertIn("weights sum to", made.stdout)
        at = {}
        for row in self.rows("a.csv"):
            if float(row["time_s"]) == 20:
                at[row["encounter"], row["aircraft"]] = row
        weights = set()
        for number in range(1, 61):
            intruder = at[str(number), "intruder"]
            # The own aircraft flies north at 50 m/s from the origin, at 600 m.
            north, east = float(intruder["north_m"]) - 1000, float(intruder["east_m"])
            self.assertLessEqual(math.hypot(north, east), 90.001)
            self.assertLessEqual(abs(float(intruder["down_m"]) + 600), 150.001)
            along = north * (float(intruder["north_mps"]) - 50) + east * float(intruder["east_mps"])
            self.assertAlmostEqual(along, 0, delta=1e-6 * 100 * 150)
            weights.add(intruder["weight"])
        self.assertGreater(len(weights), 50)

    def test_geometric_encounters_cover_their_ranges(self):
        self.done("sample", "geometric", "--own", OWN, "--count", "36", "-o", "a.csv", "--speed-mps", "60")
        sectors = set()
        for row in self.rows("a.csv"):
            if row["aircraft"] == "intruder" and float(row["time_s"]) == 0:
                course = math.degrees(math.atan2(float(row["east_mps"]), float(row["north_mps"])))
                sectors.add(math.floor((course + 180) / 10))
        self.assertEqual(len(sectors), 36)

    def test_geometric_encounters_that_turn_come_no_nearer_than_stated(self):
        turning = ("sample", "geometric", "--own", OWN, "--vmd-m", "0", "-o", "a.csv", "--hmd-m")
        self.done(*turning, "200", "300", "--count", "300", "--turn-rate-dps", "-3", "3")
        own, least = {}, {}
        for row in self.rows("a.csv"):
            place = float(row["north_m"]), float(row["east_m"])
            key = row["encounter"], row["time_s"]
            if row["aircraft"] == "own":
                own[key] = place
            else:
                least[row["encounter"]] = min(least.get(row["encounter"], 1e9), math.dist(own[key], place))
        self.assertEqual(len(least), 300)
        self.assertGreaterEqual(min(least.values()), 195)

    def test_formats_convert_into_each_other(self):
        self.done("sample", MODEL, "--own", OWN, "--count", "3", "-o", "a.csv")
        self.done("convert", "a.csv", "b.dat")
        head = struct.unpack("<II3d", self.bytes_of("b.dat")[:32])
        self.assertEqual(head[:2], (3, 2))
        self.assertAlmostEqual(head[4], 600 / 0.3048)
        self.done("convert", "b.dat", "c.csv")
        first = [row for row in self.rows("a.csv") if row["encounter"] == "2"]
        again = [row for row in self.rows("c.csv") if row["encounter"] == "2"]
        self.assertEqual(len(first), len(again))
        for one, other in zip(first, again):
            for key in ("time_s", "north_m", "east_m", "down_m"):
                self.assertAlmostEqual(float(one[key]), float(other[key]), places=6)
        for extension in ("daa", "txt"):
            made = self.done("convert", "a.csv", "d." + extension, "--encounter", "2")
            self.assertIn("holds no weights", made.stderr)
            self.done("convert", "d." + extension, extension + ".csv")
            again = self.rows(extension + ".csv")
            self.assertEqual({row["aircraft"] for row in again}, {"own", "intruder"})
            key = lambda row: (row["aircraft"], float(row["time_s"]))
            for one, other in zip(sorted(first, key=key), sorted(again, key=key)):
                for column in ("north_m", "east_mps", "down_mps"):
                    self.assertAlmostEqual(float(one[column]), float(other[column]), places=6)

    def test_what_is_wrong_is_one_line_and_leaves_nothing(self):
        self.done("sample", MODEL, "--count", "3", "-o", "a.csv")
        before = self.bytes_of("a.csv")
        self.refused("sample", MODEL, "--count", "5", "-o", "a.csv", says=["exists already", "--overwrite"])
        self.assertEqual(self.bytes_of("a.csv"), before)
        self.done("sample", MODEL, "--count", "5", "-o", "a.csv", "--overwrite")
        self.assertNotEqual(self.bytes_of("a.csv"), before)
        self.refused("sample", MODEL, "-o", "a.doc", says=["expected .csv, .daa, .txt, .dat"])
        self.refused("sample", MODEL, "-o", "none/a.csv", says=["there is no folder"])
        self.refused("sample", "none.txt", "-o", "b.csv", says=["none.txt", "cannot open"])
        self.refused("sample", OWN, "-o", "b.csv", says=["own.csv:1: begins with"])
        self.refused("sample", MODEL, "--count", "0", "-o", "b.csv")
        self.refused("sample", MODEL, "--hmd-m", "0", "9", "-o", "b.csv", says=["expected --own"])
        self.refused("sample", "geometric", "-o", "b.csv", says=["--own is missing"])
        self.refused("sample", "geometric", "--own", OWN, "--domain", "1", "-o", "b.csv", says=["--domain"])
        self.refused("sample", MODEL, "--own", OWN, "--cpa-time", "99", "-o", "b.csv", says=["closest approach"])
        self.refused("sample", MODEL, "--own", OWN, "--hmd-m", "9", "3", "-o", "b.csv", says=["--hmd-m is 9 3"])
        with open(self.path("long.csv"), "w", encoding="utf-8") as file:
            file.write("encounter,aircraft,time_s,north_m,east_m,down_m\n1,own,0,0,0,-600\n1,own,1e9,9,0,-600\n")
        self.refused("sample", "geometric", "--own", "long.csv", "-o", "b.csv", says=["1000000000 s long", "3600"])
        self.refused("sample", MODEL, "--own", "long.csv", "-o", "b.csv", says=["1000000000 s long", "3600"])
        os.remove(self.path("long.csv"))
        self.done("sample", MODEL, "--own", OWN, "--count", "2", "-o", "pairs.csv")
        self.refused("convert", "pairs.csv", "b.daa", says=["holds one"])
        self.refused("convert", "pairs.csv", "b.daa", "--encounter", "3", says=["--encounter of 1 to 2"])
        with open(self.path("cut.dat"), "wb") as file:
            file.write(struct.pack("<II", 5, 2))
        self.refused("convert", "cut.dat", "b.csv", says=["cut.dat: announces 5 encounters"])
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.csv", "cut.dat", "pairs.csv"])

    def test_an_interrupt_leaves_nothing(self):
        process = subprocess.Popen(
            [AIRTRUTH, "encounter", "sample", MODEL, "--count", "50000000", "-o", "a.csv"],
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        deadline = time.monotonic() + 60
        while not os.listdir(self.folder) and time.monotonic() < deadline:
            time.sleep(0.01)
        self.assertTrue(os.listdir(self.folder))
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertIn("interrupted", said)
        self.assertEqual(os.listdir(self.folder), [])


if __name__ == "__main__":
    AIRTRUTH = os.path.abspath(sys.argv[1])
    examples = os.path.join(os.path.abspath(sys.argv[2]), "examples", "encounters")
    MODEL, OWN = os.path.join(examples, "light_aircraft.txt"), os.path.join(examples, "own.csv")
    unittest.main(argv=[sys.argv[0]])
