# SPDX-License-Identifier: Apache-2.0
"""The report page in a real browser: python3 report_page_test.py AIRTRUTH

Makes a small data set with names that want to be markup, opens its page in headless Chromium from a server on loopback,
and has a script beside it look: everything is drawn, filters and sorting work, links lead to files, nothing is complained of.
"""

import functools
import html
import http.server
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time

from numbered_clip import HEIGHT, READ_NUMBER, WIDTH, box_of, write_otb

CATALOGUE = """
name = "<script><b onclick=x>set"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 6, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150], velocity_ned_mps = [20, 0, 0] }
[[background]]
name = "more & <i>more"
flight = { seed = 4, frame_count = 6, width = 160, height = 120 }
camera = { position_ned_m = [0, 0, -150] }
lens = { vertical_fov_deg = 75 }
[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
[[aircraft]]
name = "c172"
aircraft = "c172/news"
[truth]
volumes = ["nmac", "f3442"]
[[trajectory]]
name = "near"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
[[trajectory]]
name = "far"
waypoints_ned_m = [[300, -20, -190], [300, 60, -190]]
speed_mps = 60
[[product]]
name = "<img src=x onerror=alert(1)> {background} {trajectory} {aircraft}"
"""

# Runs in the page that holds the report in a frame.
LOOK = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const trap = `<script>window.found = []; for (const kind of ['error', 'warn']) console[kind] = (...all) => found.push(all.join(' '));
addEventListener('error', (e) => found.push(e.message || 'cannot load ' + e.target.src), true);<` + `/script>`;
(async () => {
  const text = await (await fetch('report.html')).text();
  const frame = document.getElementById('frame');
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  frame.srcdoc = text.replace('<head>', '<head>' + trap);
  await loaded;
  await wait(500);
  const page = frame.contentDocument;
  const names = () => [...page.querySelectorAll('.sequence h2')].map((h) => h.textContent);
  const set = async (id, value) => {
    const input = page.getElementById(id);
    if (input.type === 'checkbox') input.checked = value; else input.value = value;
    input.dispatchEvent(new Event('input', { bubbles: true }));
    await wait(100);
  };
  const drawn = (canvas) => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v !== 0);
  // Stills are decoded one after the other.
  for (let i = 0; i < 24 && ![...page.querySelectorAll('canvas')].every(drawn); ++i) await wait(250);
  const out = { title: page.getElementById('title').textContent, all: names(), count: page.getElementById('count').textContent };
  // Beside a still without an intruder there is nothing to enlarge.
  out.canvases = [...page.querySelectorAll('canvas:not([aria-label$=enlarged])')].map(drawn);
  out.blank = [...page.querySelectorAll('canvas')].filter((c) => !drawn(c)).map((c) => c.getAttribute('aria-label') || c.dataset.plot || c.className);
  out.enlarged = [...page.querySelectorAll('canvas[aria-label$=enlarged]')].map(drawn);
  out.films = page.querySelectorAll('.film canvas').length;
  // Every bin of every histogram has a label.
  out.unlabelled = [...page.querySelectorAll('.charts canvas')].map((c) => frame.contentWindow.eval('Chart').getChart(c))
    .filter((chart) => chart.config.type === 'bar')
    .filter((chart) => {
      const names = chart.scales[chart.options.indexAxis];
      return names.ticks.length !== chart.data.labels.length || names.ticks.some((tick) => !tick.label);
    }).map((chart) => chart.canvas.dataset.plot);
  out.injected = page.querySelectorAll('h2 *, #title *, #card dd *, #card b, option *').length;
  out.links = [];
  for (const a of page.querySelectorAll('.links a')) out.links.push((await fetch(a.getAttribute('href'), { method: 'HEAD' })).status);
  await set('aircraft', 'c172');
  out.c172 = names();
  await set('aircraft', '');
  await set('background', [...page.getElementById('background').options].map((o) => o.value)[1]);
  out.background = names();
  await set('background', '');
  await set('nearest-to', '220');
  out.near = names();
  await set('nearest-to', '');
  await set('find', 'FAR');
  out.far = names();
  await set('find', '');
  await set('meeting', 'crossing from left');
  out.crossing = names();
  await set('violates', 'nmac');
  out.crossing_nmac = names();
  await set('violates', '');
  await set('meeting', '');
  await set('closest-to', '220');
  out.closest = names();
  await set('first-m-from', '220');
  out.contradiction = names();
  await set('first-m-from', '');
  await set('closest-to', '');
  const chartOf = (plot) => frame.contentWindow.eval('Chart').getChart(page.querySelectorAll('.sequence .plot canvas')[plot]);
  const plan = () => [chartOf(0).scales.x.options.title.text, chartOf(0).scales.y.options.title.text];
  out.north_up = plan();
  await set('plan', 'course');
  out.course_up = plan();
  await set('plan', 'north');
  out.to_closest = chartOf(2).scales.closest.options.title.text;
  out.facts = page.querySelectorAll('.sequence .encounters tbody tr').length;
  await set('sort', 'closest_m');
  out.by_closest = names();
  await set('sort', 'nearest');
  out.nearest = names();
  await set('descending', true);
  out.farthest = names();
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
"""


# Of a page on clips whose frames carry their numbers as pixels, and on sequences of which half have no intruder.
PLAY = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
// The browser's virtual clock runs ahead of what decodes a video, but stands while an answer is awaited.
const realPause = async () => { await fetch('/pause'); await wait(1); };
""" + READ_NUMBER + """
(async () => {
  const text = await (await fetch('PAGE')).text();
  const frame = document.getElementById('frame');
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  frame.srcdoc = text.replace('<head>', `<head><script>window.found = []; addEventListener('error', (e) => found.push(e.message || 'cannot load'), true);<` + `/script>`);
  await loaded;
  await wait(500);
  const page = frame.contentDocument;
  const send = (element, kind) => element.dispatchEvent(new frame.contentWindow.Event(kind, { bubbles: true }));
  const card = page.querySelector('.sequence');
  const slider = card.querySelector('input[type=range]');
  const pair = () => [Number(/frame (\\d+)/.exec(card.querySelector('.film .note').textContent)[1]), numberOn(card.querySelector('.film canvas'))];
  const out = { summary: page.getElementById('summary').textContent, most: page.getElementById('most').textContent,
    encounters: page.querySelectorAll('#of-encounters, .encounters, option[data-encounters], [data-plot=meetings]').length };
  out.pairs = [pair()];
  for (const value of [0, 1, 7, slider.max]) {
    slider.value = value;
    send(slider, 'input');
    await wait(100);
    out.pairs.push(pair());
  }
  const play = card.querySelector('button');
  play.click(); // from its end on: begins again
  for (let k = 0; k < 12; ++k) { await wait(63); out.pairs.push(pair()); }
  const set = async (value) => {
    page.getElementById('shows').value = value;
    send(page.getElementById('shows'), 'input');
    await wait(50);
    return [...page.querySelectorAll('.sequence h2')].map((h) => h.textContent);
  };
  out.some = await set('some');
  out.none = await set('none');
  await set('');
  const file = [...page.querySelectorAll('.film button')].find((b) => b.textContent === 'Play the file');
  if (file) {
    const film = file.closest('.film');
    file.click();
    const video = film.querySelector('video');
    for (let k = 0; k < 300 && film.querySelector('video') && !video.videoWidth; ++k) await realPause();
    out.video = [video.videoWidth, video.videoHeight, film.querySelectorAll('video').length];
  }
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
"""

NEGATIVES = """
name = "negatives"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 8, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
[[random]]
name = "r{index}"
count = 4
frame_count = 8
aircraft = ["c172/*"]
range_m = [60, 90]
azimuth_deg = [-5, 5]
elevation_deg = [0, 5]
negatives = 0.5
"""


def data_of(page):
    """What the page holds of the set, as JSON."""
    with open(page, encoding="utf-8") as file:
        return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', file.read(), re.S).group(1))


def played(airtruth, browser, root):
    """The page shows the frames that it names, counts boxes where they are, and plays the file beside it."""
    run = lambda *command: subprocess.run([airtruth, "dataset", *command], check=True, stdout=subprocess.DEVNULL, cwd=root)
    write_otb(root + "/otb", ["numbered 100%"], 100)
    run("import", "otb", "--format", "otb", "--frame-rate", "25", "-o", "clips")
    run("report", "clips", "-o", "numbered.html")
    data = data_of(root + "/numbered.html")
    wanted = [0] * (32 * 24)
    for number in range(100):
        x, y, width, height = box_of(number)
        wanted[int((y + height / 2) * 24 / HEIGHT) * 32 + int((x + width / 2) * 32 / WIDTH)] += 1
    with open(root + "/n.toml", "w", encoding="utf-8") as file:
        file.write(NEGATIVES)
    run("build", "n.toml", "--out", "negatives")
    run("report", "negatives", "-o", "negatives.html")
    look = lambda page: looked_at(browser, root, (1400, 4000), PLAY.replace("PAGE", page))
    numbered = look("numbered.html")
    negatives_look = PLAY.replace("PAGE", "negatives.html").replace(
        "const pair = () =>", "const pair = () => [0, 0]; const unused = () =>")
    negatives = looked_at(browser, root, (1400, 4000), negatives_look)
    empty = [s["name"] for s in data_of(root + "/negatives.html")["sequences"] if not s["visible"]]
    faults = []
    for what, got, expected in (
            ("complaints", (numbered.get("found", numbered), negatives.get("found", negatives)), ([], [])),
            ("frames not the ones named", [p for p in numbered.get("pairs", []) if p[0] != p[1]], []),
            ("first and last frame seen", {0, 99} <= {p[0] for p in numbered.get("pairs", [])}, True),
            ("centres of boxes", data["centres"]["counts"], wanted),
            ("classes", data["classes"], {"aircraft": 100}),
            ("negative sequences", len(empty), 2),
            ("with an intruder and without", (len(negatives.get("some", [])), sorted(negatives.get("none", []))), (2, sorted(empty))),
            ("the summary", "negatives: 2 sequences and " in negatives.get("summary", ""), True),
            ("encounters where nothing is known of any", (numbered["encounters"], negatives["encounters"] > 0), (0, True)),
            ("the file's picture", negatives.get("video"), [160, 120, 1])):
        if got != expected:
            faults.append(f"{what}: {got!r}; expected {expected!r}")
    if faults:
        sys.exit("report_page_test:\n  " + "\n  ".join(faults))


class Handler(http.server.SimpleHTTPRequestHandler):
    """Files of a folder, and /pause, which answers after a tenth of a second."""

    def do_GET(self):
        if self.path != "/pause":
            super().do_GET()
            return
        time.sleep(0.1)
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


def looked_at(browser, folder, size, look=LOOK):
    """What the script `look` found in the page that it fetches from `folder`, in a frame of `size`."""
    width, height = size
    with open(os.path.join(folder, "look.html"), "w", encoding="utf-8") as page:
        page.write(f'<!DOCTYPE html><meta charset="utf-8"><pre id="result"></pre>'
                   f'<iframe id="frame" width="{width}" height="{height}"></iframe><script>{look}</script>')
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    command = [browser, "--headless", "--no-sandbox", "--disable-gpu", f"--window-size={width},{height}",
               f"--user-data-dir={os.path.join(folder, '.profile')}", "--virtual-time-budget=20000", "--dump-dom",
               f"http://127.0.0.1:{server.server_port}/look.html"]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=200).stdout
    server.shutdown()
    match = re.search(r'<pre id="result">(.*?)</pre>', dom, re.S)
    if not match or not match.group(1):
        sys.exit("report_page_test: the page never came to its end\n" + dom[-2000:])
    return json.loads(html.unescape(match.group(1)))


def browser_or_skip(test):
    """The browser's path. Without one the test ends as skipped."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if not browser:
        print(f"{test}: skipped: no chromium")
        sys.exit(77)
    return browser


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = browser_or_skip("report_page_test")
    with tempfile.TemporaryDirectory(prefix="airtruth_report_") as root:
        catalogue = os.path.join(root, "c.toml")
        with open(catalogue, "w", encoding="utf-8") as file:
            file.write(CATALOGUE)
        played(airtruth, browser, root)
        made = os.path.join(root, "set #1 50% <", "script><b>")
        page = os.path.join(root, "report.html")
        for command in (["build", catalogue, "--out", made], ["report", made, "-o", page]):
            subprocess.run([airtruth, "dataset", *command], check=True, stdout=subprocess.DEVNULL)
        for size in ((1600, 14000), (400, 24000)):
            out = looked_at(browser, root, size)
            faults = []

            def expect(what, got, wanted):
                if got != wanted:
                    faults.append(f"{what}: {got!r}; expected {wanted!r}")

            expect("errors", out.get("found", out), [])
            expect("title", out["title"], "<script><b onclick=x>set")
            expect("sequences", len(out["all"]), 8)
            expect("count", out["count"], "8 of 8")
            expect("canvases that are blank", out["blank"], [])
            expect("canvases drawn", (len(out["canvases"]), all(out["canvases"])), (14 + 3 * 8 + 8, True))
            expect("intruders enlarged", (len(out["enlarged"]), sum(out["enlarged"]) >= 7), (8, True))
            expect("films", out["films"], 8)
            expect("charts with bins that have no label", out["unlabelled"], [])
            expect("markup made of names", out["injected"], 0)
            expect("links", set(out["links"]), {200})
            expect("by aircraft", all(n.endswith("c172") for n in out["c172"]) and len(out["c172"]), 4)
            expect("by background", len({n.split("> ")[1][:3] for n in out["background"]}) and len(out["background"]), 4)
            expect("by range", sorted(out["near"]), sorted(n for n in out["all"] if " near " in n))
            expect("by name", sorted(out["far"]), sorted(n for n in out["all"] if " far " in n))
            expect("crossing", (len(out["crossing"]), all("<b> sky" not in n and "sky" in n for n in out["crossing"])), (4, True))
            expect("crossing, near collisions", sorted(out["crossing_nmac"]), sorted(n for n in out["crossing"] if " near " in n))
            expect("closest approach", sorted(out["closest"]), sorted(n for n in out["all"] if " near " in n))
            expect("no encounter is both", out["contradiction"], [])
            expect("plans", (out["north_up"], out["course_up"]),
                   (["east, m", "north, m"], ["right of the own course, m", "along the own course, m"]))
            expect("time axis", out["to_closest"], "seconds to the closest approach")
            expect("rows of encounters", out["facts"], 8)
            expect("by closest approach", [" near " in n for n in out["by_closest"]], [True] * 4 + [False] * 4)
            expect("nearest first", [" near " in n for n in out["nearest"]], [True] * 4 + [False] * 4)
            expect("farthest first", [" far " in n for n in out["farthest"]], [True] * 4 + [False] * 4)
            if faults:
                sys.exit("report_page_test: at %dx%d\n  %s" % (*size, "\n  ".join(faults)))
        with open(page, encoding="utf-8") as file:
            text = file.read()
        # Nothing is fetched from anywhere.
        outside = [u for u in re.findall(r'(?:src|href)\s*=\s*["\']?(https?:[^"\' >]+)', text)]
        if outside:
            sys.exit(f"report_page_test: the page asks for {outside[:3]}")
        print("8 sequences looked at wide and narrow: drawn, filtered, sorted, no complaint")


if __name__ == "__main__":
    main()
