# SPDX-License-Identifier: Apache-2.0
"""`airtruth evaluate` reads the videos of sequences with results, and no others: python3 evaluate_videos_test.py AIRTRUTH

Of a set of two clips one is broken from its second picture on. Results for the whole one alone are scored, with the page; with
results for both, the broken one is an error.
"""

import json
import os
import re

import program
from numbered_clip import box_of, write_otb
from program import made, path, run, write

FRAMES = 12


def make_inputs():
    write_otb(path("otb"), ["broken", "whole"], FRAMES)
    made("dataset", "import", "otb", "--format", "otb", "--frame-rate", "25", "-o", "clips")
    for number in range(2, FRAMES + 1):
        write(f"otb/broken/img/{number:04}.png", "no picture")
    for name in ("broken", "whole"):
        boxes = [box_of(k) for k in range(FRAMES)]
        track = "".join(f"{x},{y},{w},{h}\n" for x, y, w, h in boxes)
        found = "".join(f"{k + 1},-1,{x + 1},{y + 1},{w},{h},0.9,-1,-1,-1\n" for k, (x, y, w, h) in enumerate(boxes))
        for folder in ("some", "all") if name == "whole" else ("all",):
            write(f"{folder}/tracker/{name}.txt", track)
            write(f"{folder}/detector/{name}.txt", found)


def page_data(*names):
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', program.read(*names), re.S).group(1))


class Videos(program.Case):
    def test_those_without_results_are_not_read(self):
        for kind, page in (("tracker", "report.html"), ("detector", "detection.html")):
            made("evaluate", "clips", f"some/{kind}", "-o", f"of-{kind}")
            stills = {one["name"]: len(one["stills"]) for one in page_data(f"of-{kind}", page)["sequences"]}
            self.assertEqual(stills.pop("broken", 0), 0)
            self.assertEqual(stills, {"whole": FRAMES})

    def test_those_with_results_are(self):
        for kind in ("tracker", "detector"):
            self.assertEqual(run("evaluate", "clips", f"all/{kind}", "-o", "no").returncode, 2)
            self.assertFalse(os.path.exists(path("no")))


if __name__ == "__main__":
    program.main(make_inputs)
