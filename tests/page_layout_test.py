# SPDX-License-Identifier: Apache-2.0
"""No text of a page is cut, overlaps another or leaves its card: python3 page_layout_test.py AIRTRUTH

The pages of one small set, whose data are multiplied and renamed beside each page: 1, 2 and 30 sequences, trackers and
detectors, with short and with long names, at 360, 420, 1024 and 1920 px. In all of them headless Chromium asks every line of
text where it lies, and of what is drawn on a canvas every call that writes: within its canvas, its card and the screen, and
upon no other text. Intervals lie within their axes, and axes of bars have names.
"""

import os
import subprocess
import sys
import tempfile

from report_page_test import browser_or_skip, looked_at

CATALOGUE = """
name = "pages"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 16, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
camera = { position_ned_m = [0, 0, -150], velocity_ned_mps = [20, 0, 0] }
[[aircraft]]
name = "c172"
aircraft = "c172/news"
[truth]
volumes = ["nmac"]
[[trajectory]]
name = "near"
waypoints_ned_m = [[150, -20, -160], [150, 60, -160]]
speed_mps = 60
[[product]]
name = "{background}"
"""
PAGES = ["report.html", "evaluation/report.html", "evaluation/detection.html"]
SIZES = [360, 420, 1024, 1920]
LONG = "a_recording_of_the_eighteenth_flight_along_the_northern_coast_with_a_very_long_name"

# In the page itself, before all else: what is written on each canvas since it was cleared. Text that is measured only is not seen.
TRAP = r"""
window.found = [];
addEventListener('error', (e) => found.push(e.message || 'cannot load ' + e.target.src), true);
const written = new Map();
const on = CanvasRenderingContext2D.prototype;
const { fillText, clearRect } = on;
on.clearRect = function (x, y, width, height) {
  const m = this.getTransform();
  if (width * m.a >= this.canvas.width - 1 && height * m.d >= this.canvas.height - 1) written.set(this.canvas, []);
  return clearRect.call(this, x, y, width, height);
};
on.fillText = function (text, x, y, ...more) {
  const { actualBoundingBoxLeft: l, actualBoundingBoxRight: r, actualBoundingBoxAscent: a, actualBoundingBoxDescent: d } = this.measureText(text);
  const m = this.getTransform();
  const corners = [[x - l, y - a], [x + r, y - a], [x - l, y + d], [x + r, y + d]].map(([px, py]) => [m.a * px + m.c * py + m.e, m.b * px + m.d * py + m.f]);
  const all = written.get(this.canvas) || written.set(this.canvas, []).get(this.canvas);
  const [xs, ys] = [corners.map((c) => c[0]), corners.map((c) => c[1])];
  if (String(text).trim()) all.push({ text: String(text), left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys) });
  return fillText.call(this, text, x, y, ...more);
};
window.written = written;
"""

LOOK = r"""
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
// `count` copies of what a list holds, each with a name of its own.
const times = (list, count, change) => Array.from({ length: count }, (_, k) => change(structuredClone(list[k % list.length]), k));
const named = (base, k, isLong) => (isLong ? `${LONG}_${k}` : `${base}${k}`);
const made = (data, count, isLong) => {
  const name = (base, k) => named(base, k, isLong);
  for (const kind of ['trackers', 'detectors']) {
    if (!data[kind]) continue;
    const before = data[kind].map((one) => one.name);
    const known = before.length;
    data[kind] = times(data[kind], count, (one, k) => ({ ...one, name: name(one.name, k) }));
    for (const sequence of data.sequences)
      sequence[kind] = times(sequence[kind], count, (one, k) => ({ ...one, [kind.slice(0, -1)]: k }));
    if (data.comparisons) data.comparisons = times(data.comparisons, data.comparisons.length ? count : 0,
      (one, k) => ({ ...one, a: data[kind][0].name, b: data[kind][k].name }));
    for (const plot of Object.values(data.plots || {})) {
      plot.series = times(plot.series, count, (one, k) => ({ ...one, name: name(one.name, k) }));
      if (plot.x.names.length && plot.x.label.startsWith('background')) {
        plot.x.names = times(plot.x.names, count, (one, k) => `${name(one, k)} (40)`);
        for (const series of plot.series) {
          series.x = plot.x.names.map((_, k) => k);
          for (const key of ['y', 'low', 'high']) if (series[key].length) series[key] = series.x.map(() => series[key][0]);
        }
      }
    }
  }
  data.sequences = times(data.sequences, count, (one, k) => ({ ...one, name: name(one.name, k), background: name('sky', k),
    ...(one.aircraft ? { aircraft: [name('c172', k)] } : {}) }));
  if (data.plots.classes) {
    data.plots.classes.x.names = Array.from({ length: count }, (_, k) => name('class', k));
    const [series] = data.plots.classes.series;
    series.x = data.plots.classes.x.names.map((_, k) => k);
    series.y = series.x.map(() => 5);
  }
  if (data.title) data.title = name('pages', 0);
  if (data.dataset) data.dataset = name('set', 0);
  return data;
};

// A line of text that shares ground with another; what lies in another line of the same word is none.
const overlap = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1.5 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 2.5;
const overlapping = (all) => {
  const sorted = [...all].sort((a, b) => a.top - b.top);
  const faults = [];
  for (let i = 0; i < sorted.length; ++i)
    for (let k = i + 1; k < sorted.length && sorted[k].top < sorted[i].bottom; ++k)
      if (sorted[i].node !== sorted[k].node && overlap(sorted[i], sorted[k])) faults.push(`"${sorted[i].text}" and "${sorted[k].text}"`);
  return faults;
};
const isScrolled = (element) => element.closest('.scrolls, .dense > div');

const faultsOf = (frame) => {
  const page = frame.contentDocument;
  const faults = [];
  const say = (what, all) => { if (all.length) faults.push(`${what}: ${all.slice(0, 3).join('; ')}${all.length > 3 ? ` and ${all.length - 3} more` : ''}`); };
  const width = page.documentElement.clientWidth;
  if (page.documentElement.scrollWidth > width) faults.push(`the page is ${page.documentElement.scrollWidth - width} px wider than the screen`);
  const lines = [];
  const outside = [];
  const cut = [];
  const walker = page.createTreeWalker(page.body, 4);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (!node.textContent.trim() || parent.closest('script, style, option, canvas')) continue;
    const range = page.createRange();
    range.selectNodeContents(node);
    const card = parent.closest('.sequence, .card, figure') || page.body;
    const room = card.getBoundingClientRect();
    for (const rect of range.getClientRects()) {
      if (!rect.width || isScrolled(parent)) continue;
      const text = node.textContent.trim().slice(0, 40);
      if (rect.left < room.left - 0.5 || rect.right > room.right + 0.5 || rect.bottom > room.bottom + 0.5) outside.push(`"${text}"`);
      lines.push({ text, node, left: rect.left, right: rect.right, top: rect.top, bottom: rect.bottom });
    }
    for (let holder = parent; holder !== page.body; holder = holder.parentElement) {
      if (isScrolled(holder) || !holder.clientWidth) break;
      if (frame.contentWindow.getComputedStyle(holder).overflowX !== 'visible' && holder.scrollWidth > holder.clientWidth + 1) {
        cut.push(`"${node.textContent.trim().slice(0, 40)}"`);
        break;
      }
    }
  }
  say('outside of its card', outside);
  say('cut', cut);
  say('on each other', overlapping(lines));
  for (const [canvas, all] of frame.contentWindow.written) {
    if (!canvas.isConnected || !canvas.clientWidth) continue;
    const id = canvas.id || canvas.dataset.plot || 'a plot';
    const beyond = all.filter((one) => one.left < -1 || one.top < -1 || one.right > canvas.width + 1 || one.bottom > canvas.height + 1);
    say(`beyond the canvas of ${id}`, beyond.map((one) => `"${one.text}"`));
    if (!['whole', 'close'].includes(id)) say(`on each other in ${id}`, overlapping(all.map((one) => ({ ...one, node: one }))));
  }
  const Chart = frame.contentWindow.eval('Chart');
  const { plots } = JSON.parse(page.getElementById('data').textContent);
  for (const canvas of page.querySelectorAll('canvas')) {
    const chart = Chart.getChart(canvas);
    if (!chart || !canvas.clientWidth) continue;
    const id = canvas.dataset.plot || canvas.id || 'a plot';
    if (chart.chartArea.height < 60 || chart.chartArea.width < 60) faults.push(`${id}: ${Math.round(chart.chartArea.width)} × ${Math.round(chart.chartArea.height)} px are left for the plot`);
    const { y } = chart.scales;
    if (chart.config.type === 'bar' && y && !y.options.title.text) faults.push(`${id}: the axis of bars has no name`);
    const plot = plots[canvas.dataset.plot];
    for (const { low, high } of plot ? plot.series : [])
      if (low.some((v) => v !== null && v < y.min - 1e-9) || high.some((v) => v !== null && v > y.max + 1e-9)) { faults.push(`${id}: an interval leaves its axis`); break; }
  }
  return [...faults, ...frame.contentWindow.found];
};

const MOST_TRIES = 20;  // of 0.1 s

(async () => {
  const frame = document.getElementById('frame');
  const out = [];
  let looked = 0;
  for (const address of PAGES) {
    const text = await (await fetch(address)).text();
    const start = text.indexOf('id="data">') + 10, end = text.indexOf('<' + '/script>', start);
    for (const count of [1, 2, 30])
      for (const isLong of [false, true]) {
        const data = JSON.stringify(made(JSON.parse(text.slice(start, end)), count, isLong)).replaceAll('<', '\\u003c');
        frame.width = SIZES[0];
        const loaded = new Promise((done) => frame.addEventListener('load', done, { once: true }));
        frame.srcdoc = text.slice(0, start).replace('<head>', '<head><script>' + TRAP + '<' + '/script>') + data + text.slice(end);
        await loaded;
        const page = frame.contentDocument;
        // Cards that are out of sight, and what is folded away, have a layout too.
        page.head.append(Object.assign(page.createElement('style'), { textContent: '.sequence { content-visibility: visible !important; }' }));
        for (const folded of page.querySelectorAll('details')) folded.open = true;
        // A card that is far from the screen is not drawn yet.
        await wait(100);
        for (const card of page.querySelectorAll('.sequence')) if (card.draw) card.remove();
        for (const width of SIZES) {
          frame.width = width;
          let faults = [];
          // A page may still be drawing on a busy machine: what stays is a fault.
          for (let tries = 0; tries === 0 || (faults.length && tries < MOST_TRIES); ++tries) {
            await wait(100);
            // Charts follow their place in the next picture of the screen, which this browser has none of.
            for (const chart of Object.values(frame.contentWindow.eval('Chart').instances)) chart.resize();
            faults = faultsOf(frame);
          }
          looked += 1;
          out.push(...faults.map((fault) => `${address}, ${count} ${isLong ? 'long' : 'short'}, ${width} px: ${fault}`));
        }
      }
  }
  document.getElementById('result').textContent = JSON.stringify({ faults: out, looked });
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ faults: [String(error.stack || error)], looked: 0 }); });
"""


def make_pages(airtruth, root):
    """The report of a set of one sequence, and the evaluation of trackers and detectors on it."""
    run = lambda *command: subprocess.run([airtruth, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=root)
    with open(root + "/c.toml", "w", encoding="utf-8") as file:
        file.write(CATALOGUE)
    run("dataset", "build", "c.toml", "--out", "set")
    run("dataset", "report", "set", "-o", "report.html")
    run("track", "set", "-o", "tracks", "-t", "am3", "opencv-mosse")
    run("track", "set", "-o", "tracks", "-t", "am3", "--protocol", "restart")
    run("detect", "set", "-o", "detections", "-d", "frame-difference", "cmo", "--associate")
    run("evaluate", "set", "tracks/am3", "tracks/opencv-mosse", "detections/frame-difference", "detections/cmo", "-o", "evaluation")


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = browser_or_skip("page_layout_test")
    with tempfile.TemporaryDirectory(prefix="airtruth_layout_") as root:
        make_pages(airtruth, root)
        given = f"const PAGES = {PAGES!r}, SIZES = {SIZES!r}, LONG = {LONG!r};\n"
        look = given + "const TRAP = " + repr_js(TRAP) + ";\n" + LOOK
        out = looked_at(browser, root, (1920, 5000), look)
        expected = len(PAGES) * 3 * 2 * len(SIZES)
        if out["looked"] != expected:
            out["faults"].append(f"looked {out['looked']} times; expected {expected}")
        if out["faults"]:
            sys.exit("page_layout_test:\n  " + "\n  ".join(out["faults"]))
        print(f"{expected} pages: no text cut, on another or outside of its card; intervals within their axes")


def repr_js(text):
    """The text as a string in a script."""
    return "`" + text.replace("\\", "\\\\").replace("`", "\\`").replace("${", "\\${") + "`"


if __name__ == "__main__":
    main()
