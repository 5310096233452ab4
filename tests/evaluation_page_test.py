# SPDX-License-Identifier: Apache-2.0
"""The evaluation's page in a real browser: python3 evaluation_page_test.py AIRTRUTH

Builds a small data set, follows it with four trackers and all protocols, and has a script beside the page look: everything is
drawn, the player shows what its cursor says, tables sort, trackers can be hidden, nothing is complained of. Then the same
plots as files.
"""

import itertools
import json
import math
import os
import re
import struct
import subprocess
import sys
import tempfile

from numbered_clip import READ_NUMBER, box_of, write_otb
from report_page_test import browser_or_skip, looked_at

CATALOGUE = """
name = "<script><b onclick=x>set"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 40, width = 320, height = 240 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150] }
[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
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
  const text = await (await fetch('evaluation/report.html')).text();
  const frame = document.getElementById('frame');
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  frame.srcdoc = text.replace('<head>', '<head>' + trap);
  await loaded;
  await wait(500);
  const page = frame.contentDocument;
  const id = (name) => page.getElementById(name);
  const send = (element, kind, more = {}) => element.dispatchEvent(new frame.contentWindow[kind.startsWith('pointer') ? 'PointerEvent' : 'Event'](kind, { bubbles: true, ...more }));
  const drawn = (canvas) => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v !== 0);
  const content = (name) => id(name).toDataURL();
  const names = () => [...page.querySelectorAll('#ranking tbody tr td:first-child')].map((c) => c.textContent);
  const shownFrame = () => Number(/frame (\\d+)/.exec(id('caption').textContent)[1]);
  const out = { title: id('title').textContent, ranking: names(), injected: page.querySelectorAll('h1 *, option *, td b b').length };
  const heads = [...page.querySelectorAll('#ranking thead th')].map((c) => c.textContent.replace(/[^a-z/, ]/g, '').trim());
  out.rates = [...page.querySelectorAll('#ranking tbody tr')].map((row) => [row.cells[0].textContent,
    row.cells[heads.indexOf('fps, median')].textContent, row.cells[heads.indexOf('fps, mean')].textContent]);
  out.canvases = [...page.querySelectorAll('canvas')].filter((c) => !c.closest('[hidden]')).map((c) => [c.id, drawn(c)]);
  out.sequences = [...id('sequence').options].map((o) => o.textContent);
  out.first = shownFrame();
  const before = [content('whole'), content('close'), content('x'), content('error')];
  id('frame').value = 20;
  send(id('frame'), 'input');
  await wait(200);
  out.slid = shownFrame();
  out.changed = [content('whole'), content('close'), content('x'), content('error')].map((now, k) => now !== before[k]);
  // A pointer over the error's plot takes the slider and the picture along: at its left and right end.
  const plot = id('error');
  const at = async (share) => {
    const box = plot.getBoundingClientRect();
    send(plot, 'pointermove', { clientX: box.left + share * box.width, clientY: box.top + 20 });
    await wait(200);
    return [shownFrame(), Number(id('frame').value)];
  };
  out.left = await at(0.08);
  out.right = await at(0.99);
  out.middle = await at(0.55);
  id('play').click();
  for (let k = 0; k < 40 && shownFrame() <= out.middle[0] + 1; ++k) await wait(50);
  out.played = shownFrame();
  id('next').click();
  await wait(200);
  out.next = id('sequence').value;
  out.restarted = shownFrame();
  const legendBefore = content('x');
  page.querySelector('#shown input').click();
  await wait(200);
  out.hid = content('x') !== legendBefore;
  page.querySelectorAll('#ranking th button')[0].click();
  await wait(100);
  out.byName = names();
  page.querySelectorAll('#ranking th button')[0].click();
  await wait(100);
  out.byNameDown = names();
  out.vot = page.querySelectorAll('#vot tbody tr').length;
  out.dashes = id('eao-caption').textContent.split('; ').pop();
  out.pairs = page.querySelectorAll('#pairs tbody tr').length;
  out.overflow = page.documentElement.scrollWidth - page.documentElement.clientWidth;
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
"""

# Of a page whose sequences carry their frames' numbers as pixels.
NUMBERS = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const trap = `<script>window.found = []; for (const kind of ['error', 'warn']) console[kind] = (...all) => found.push(all.join(' '));
window.alert = () => found.push('alert');
addEventListener('error', (e) => found.push(e.message || 'cannot load ' + e.target.src), true);<` + `/script>`;
""" + READ_NUMBER + """
(async () => {
  const text = await (await fetch('numbered/report.html')).text();
  const frame = document.getElementById('frame');
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  frame.srcdoc = text.replace('<head>', '<head>' + trap);
  await loaded;
  await wait(500);
  const page = frame.contentDocument;
  const id = (name) => page.getElementById(name);
  const named = () => Number(/frame (\\d+)/.exec(id('caption').textContent)[1]);
  const out = { opened: id('sequence').selectedOptions[0].textContent, rows: page.querySelectorAll('#losses tbody tr').length };
  out.options = [...id('sequence').options].map((o) => o.textContent);
  out.trackers = [...page.querySelectorAll('#shown label')].map((l) => l.textContent);
  out.elements = page.querySelectorAll('#shown label > :not(input):not(.dot), td > :not(.dot):not(.range):not(b):not(span), option *').length;
  out.pairs = [[named(), numberOn(id('whole'))]];
  for (const value of [1, 2, 3, 57, 100, 101, 150, 198, 199]) {
    id('frame').value = value;
    id('frame').dispatchEvent(new frame.contentWindow.Event('input', { bubbles: true }));
    await wait(100);
    out.pairs.push([named(), numberOn(id('whole'))]);
  }
  id('play').click(); // from its end on: begins again
  for (let k = 0; k < 12; ++k) { await wait(63); out.pairs.push([named(), numberOn(id('whole'))]); }
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
"""

NAMES = ["a without results", "b \"numbered\" 100% '<script>alert(1)<script>"]
HOSTILE = ["<script>alert(1)<script>", "<img src=x onerror=alert(1)>", "' onclick=alert(1) \" %n", "plain"]


def numbered(airtruth, browser, root):
    """The page opens on the sequence that has results and shows the frame that it names; names are inert; colours differ."""
    run = lambda *command: subprocess.run([airtruth, *command], check=True, stdout=subprocess.DEVNULL, cwd=root)
    write_otb(root + "/otb", NAMES, 200)
    run("dataset", "import", "otb", "--format", "otb", "--frame-rate", "25", "-o", "clips")
    for offset, tracker in enumerate(HOSTILE):
        os.makedirs(f"{root}/hostile/{tracker}")
        with open(f"{root}/hostile/{tracker}/{NAMES[1]}.txt", "w", encoding="utf-8") as file:
            for number in range(200):
                x, y, width, height = box_of(number)
                file.write(f"{x + 2 * offset},{y + offset},{width},{height}\n")
    run("evaluate", "clips", *[f"hostile/{name}" for name in HOSTILE], "-o", "numbered")
    for size in ((1600, 3600), (400, 9000)):
        out = looked_at(browser, root, size, NUMBERS)
        faults = []
        for what, got, wanted in (
                ("complaints", out.get("found", out), []),
                ("opened on", out.get("opened"), NAMES[1]),
                ("trackers with results", out.get("rows"), len(HOSTILE)),
                ("sequences", out.get("options"), [NAMES[0] + " (no results)", NAMES[1]]),
                ("trackers", sorted(out.get("trackers", [])), sorted(HOSTILE)),
                ("markup made of names", out.get("elements"), 0),
                ("frames not the ones named", [p for p in out.get("pairs", []) if p[0] != p[1]], [])):
            if got != wanted:
                faults.append(f"{what}: {got!r}; expected {wanted!r}")
        seen = {p[0] for p in out.get("pairs", [])}
        if not {0, 199} <= seen or len(seen) < 8:
            faults.append(f"frames seen: {sorted(seen)}")
        nearest = nearest_colours(["#000000", *first_colours(6)])
        if nearest[0] < 15:
            faults.append(f"colours too near to each other: {nearest}")
        if faults:
            sys.exit("evaluation_page_test: numbered clip at %dx%d\n  %s" % (*size, "\n  ".join(faults)))


# Colours as people see them who lack one kind of cone: Machado, Oliveira and Fernandes (2009), full deficiency, in linear RGB.
VISION = {"normal": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
          "protan": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
          "deutan": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
          "tritan": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900))}


def lab(colour, vision):
    """CIELAB (D65) of #rrggbb as that vision sees it."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
              for c in (int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5))]
    r, g, b = (min(1, max(0, sum(m * c for m, c in zip(row, linear)))) for row in VISION[vision])
    xyz = ((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047, 0.2126 * r + 0.7152 * g + 0.0722 * b,
           (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883)
    x, y, z = (v ** (1 / 3) if v > 216 / 24389 else v * 24389 / 27 / 116 + 16 / 116 for v in xyz)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def first_colours(count):
    """The first colours of series, from kColours in show/plot/plot.h."""
    header = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "src", "show", "plot", "plot.h")
    with open(header, encoding="utf-8") as file:
        table = file.read().split("kColours = ", 1)[1].split(";", 1)[0]
    triples = re.findall(r"\{(\d+), (\d+), (\d+)\}", table)
    assert len(triples) == 12, triples
    return ["#%02x%02x%02x" % tuple(map(int, triple)) for triple in triples[:count]]


def nearest_colours(colours):
    """The two that are nearest to each other: CIE76 difference (2.3 is just noticeable), vision, both."""
    return min((math.dist(lab(a, vision), lab(b, vision)), vision, a, b)
               for vision in VISION for a, b in itertools.combinations(colours, 2))


TRACKERS = ["am3", "am3s", "opencv-kcf", "opencv-mosse"]


def png_size(path):
    with open(path, "rb") as file:
        return struct.unpack(">II", file.read(24)[16:24])


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = browser_or_skip("evaluation_page_test")
    with tempfile.TemporaryDirectory(prefix="airtruth_evaluation_") as root:
        numbered(airtruth, browser, root)
        run = lambda *command: subprocess.run([airtruth, *command], check=True, stdout=subprocess.DEVNULL, cwd=root)
        with open(root + "/c.toml", "w", encoding="utf-8") as file:
            file.write(CATALOGUE)
        run("dataset", "build", "c.toml", "--out", "set")
        run("track", "set", "-o", "results", "-t", *TRACKERS)
        # One seed, one result, on any number of threads.
        run("track", "set", "-o", "again", "-t", *TRACKERS, "-j", "3")
        for tracker in TRACKERS:
            for name in os.listdir(f"{root}/set/sequences"):
                texts = [open(f"{root}/{place}/{tracker}/{name}.txt", encoding="utf-8").read() for place in ("results", "again")]
                if texts[0] != texts[1]:
                    sys.exit(f"evaluation_page_test: {tracker} on {name} differs from run to run")
        run("track", "set", "-o", "results", "-t", "am3", "--protocol", "restart")
        run("track", "set", "-o", "results", "-t", "am3", "opencv-kcf", "--protocol", "multistart", "--anchor-step", "15")
        results = ["results/" + name for name in TRACKERS]
        run("evaluate", "set", *results, "-o", "evaluation", "--figures", "png")
        with open(root + "/evaluation/evaluation.json", encoding="utf-8") as file:
            overall = {t["name"]: t["overall"] for t in json.load(file)["trackers"]}
        rates = {name: tuple(float(f"{o[key]:.1f}") for key in ("frames_per_second_median", "frames_per_second")) for name, o in overall.items()}
        for size in ((1400, 3600), (400, 9000)):
            out = looked_at(browser, root, size, LOOK)
            faults = []

            def expect(what, got, wanted):
                if got != wanted:
                    faults.append(f"{what}: {got!r}; expected {wanted!r}")

            expect("errors", out.get("found", out), [])
            expect("title", out["title"], "Trackers on set")
            expect("ranking", sorted(out["ranking"]), sorted(TRACKERS))
            shown = {name: tuple(float(cell.replace(",", "")) for cell in (median, mean)) for name, median, mean in out["rates"]}
            expect("median and mean of frames/s", shown, rates)
            expect("canvases not drawn", [name for name, is_drawn in out["canvases"] if not is_drawn], [])
            expect("canvases", len(out["canvases"]), 8 + 5)
            expect("sequences", len(out["sequences"]), 2)
            expect("markup made of names", out["injected"], 0)
            expect("first frame", out["first"], 0)
            expect("slid to", out["slid"], 20)
            expect("slider moves pictures and cursors", out["changed"], [True] * 4)
            expect("pointer and slider", [a == b for a, b in (out["left"], out["right"], out["middle"])], [True] * 3)
            expect("pointer's ends", (out["left"][0] <= 6, out["right"][0] >= 36, 10 < out["middle"][0] < 30), (True,) * 3)
            expect("plays on", out["played"] > out["middle"][0], True)
            expect("next sequence from its start", (out["next"], out["restarted"]), ("1", 0))
            expect("a tracker can be hidden", out["hid"], True)
            expect("sorted by name", (out["byName"], out["byNameDown"]), (sorted(TRACKERS), sorted(TRACKERS, reverse=True)))
            expect("VOT's table", out["vot"], 2)
            expect("dashes of the two protocols", out["dashes"], "full: restart, dashed: multi-start")
            expect("pairs", out["pairs"], 4)
            expect("wider than the screen by", out["overflow"], 0)
            if faults:
                sys.exit("evaluation_page_test: at %dx%d\n  %s" % (*size, "\n  ".join(faults)))
        with open(root + "/evaluation/report.html", encoding="utf-8") as file:
            outside = re.findall(r'(?:src|href)\s*=\s*["\']?(https?:[^"\' >]+)', file.read())
        if outside:
            sys.exit(f"evaluation_page_test: the page asks for {outside[:3]}")
        figures = set(os.listdir(root + "/evaluation/figures"))
        plots = ["success", "precision", "normalised", "eao", "ranking", "range_m", "size_px", "contrast"]
        plots += [kind + name for kind in ("xy-", "frames-") for name in os.listdir(root + "/set/sequences")]
        missing = [name for name in plots if name + ".png" not in figures]
        if missing or any(min(png_size(f"{root}/evaluation/figures/{name}.png")) < 300 for name in plots):
            sys.exit(f"evaluation_page_test: figures: {missing}")
        print(f"the page drawn, scrubbed, sorted wide and narrow; {len(plots)} figures")


if __name__ == "__main__":
    main()
