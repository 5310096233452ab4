# SPDX-License-Identifier: Apache-2.0
"""Dots and rings of many detectors on a page, in a real browser: python3 dots_page_test.py AIRTRUTH

The page of an evaluation whose plot by size is replaced by four detectors' shares in ten bins, with a weighted one beside each:
every dot is full and every ring is empty, each stands free of its neighbour, and its interval reaches from bound to bound.
"""

import os
import subprocess
import sys
import tempfile

from numbered_clip import box_of, write_otb
from report_page_test import browser_or_skip, looked_at

LEAST_APART_PX = 5

LOOK = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const trap = `<script>window.found = []; for (const kind of ['error', 'warn']) console[kind] = (...all) => found.push(all.join(' '));
addEventListener('error', (e) => found.push(e.message || 'cannot load ' + e.target.src), true);<` + `/script>`;
const colours = ['#0072b2', '#e69f00', '#d55e00', '#56b4e9'];
const places = [...Array(10).keys()];
const of = (value) => places.map(() => value);
const made = (data) => {
  data.plots.by_size_px = {
    title: '', x: { label: 'longer side, px', min: null, max: null, names: places.map(String), logarithmic: false },
    y: { label: 'probability of detection', min: 0, max: 1, names: [], logarithmic: false },
    series: colours.flatMap((colour, k) => [false, true].map((hollow) => ({
      name: `${k}${hollow ? ', weighted' : ''}`, mark: 'dots', style: { colour, dash: [], width: 1 }, hollow,
      x: places, y: of(0.5), low: of(0.2), high: of(0.8) }))) };
  return data;
};
(async () => {
  const text = await (await fetch('evaluation/detection.html')).text();
  const start = text.indexOf('id="data">') + 10, end = text.indexOf('<' + '/script>', start);
  const frame = document.getElementById('frame');
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  frame.srcdoc = text.slice(0, start).replace('<head>', '<head>' + trap) + JSON.stringify(made(JSON.parse(text.slice(start, end)))) + text.slice(end);
  await loaded;
  await wait(500);
  const page = frame.contentDocument;
  const canvas = page.querySelector('canvas[data-plot=by_size_px]');
  const chart = frame.contentWindow.Chart.getChart(canvas);
  const ratio = chart.currentDevicePixelRatio;
  const context = canvas.getContext('2d');
  const at = (x, value) => [...context.getImageData(Math.floor(x * ratio), Math.floor(chart.scales.y.getPixelForValue(value) * ratio), 1, 1).data];
  const isPainted = ([r, g, b, alpha], k) => alpha > 100 && [r, g, b].every((v, i) => Math.abs(v - parseInt(colours[k].slice(1 + 2 * i, 3 + 2 * i), 16)) < 60);
  const marks = places.flatMap((place) => [...Array(8).keys()].map((k) => ({ k, x: chart.getDatasetMeta(k).data[place].x })));
  const painted = (k, x, value) => [-1, 0, 1].some((off) => isPainted(at(x + off, value), Math.floor(k / 2)));
  const out = {
    dots: marks.filter(({ k, x }) => k % 2 === 0 && isPainted(at(x, 0.5), Math.floor(k / 2))).length,
    rings: marks.filter(({ k, x }) => k % 2 === 1 && !isPainted(at(x, 0.5), Math.floor(k / 2))).length,
    whiskers: marks.filter(({ k, x }) => [0.25, 0.35, 0.65, 0.75].every((value) => painted(k, x, value))).length,
    beyond: marks.filter(({ k, x }) => painted(k, x, 0.15) || painted(k, x, 0.85)).length,
    apart: Math.min(...marks.slice(1).map(({ x }, i) => x - marks[i].x)),
    overflow: page.documentElement.scrollWidth - page.documentElement.clientWidth,
    found: frame.contentWindow.found,
  };
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ found: [String(error)] }); });
"""


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = browser_or_skip("dots_page_test")
    with tempfile.TemporaryDirectory(prefix="airtruth_dots_") as root:
        run = lambda *command: subprocess.run([airtruth, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=root)
        write_otb(root + "/otb", ["clip"], 5)
        run("dataset", "import", "otb", "--format", "otb", "--frame-rate", "25", "-o", "clips")
        os.makedirs(root + "/finder")
        with open(root + "/finder/clip.txt", "w", encoding="utf-8") as file:
            file.writelines(f"{k + 1},-1,{x + 1},{y + 1},{w},{h},0.9,-1,-1,-1\n" for k, (x, y, w, h) in enumerate(map(box_of, range(5))))
        run("evaluate", "clips", "finder", "-o", "evaluation")
        faults = []
        for size in ((1400, 4000), (400, 9000)):
            out = looked_at(browser, root, size, LOOK)
            wanted = {"dots": 40, "rings": 40, "whiskers": 80, "beyond": 0, "overflow": 0, "found": []}
            faults += [f"{size[0]} px wide: {what}: {out.get(what)!r}; expected {value!r}" for what, value in wanted.items() if out.get(what) != value]
            if out.get("apart", 0) < LEAST_APART_PX:
                faults.append(f"{size[0]} px wide: {out.get('apart')} px apart; expected {LEAST_APART_PX} at least")
        if faults:
            sys.exit("dots_page_test:\n  " + "\n  ".join(faults))
        print("80 dots and rings with their intervals, wide and narrow: each free of its neighbours")


if __name__ == "__main__":
    main()
