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

CATALOGUE = """
name = "<script><b onclick=x>set"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 6, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
[[background]]
name = "more & <i>more"
flight = { seed = 4, frame_count = 6, width = 160, height = 120 }
lens = { vertical_fov_deg = 75 }
[[aircraft]]
name = "b737"
aircraft = "738/738-Ryanair"
[[aircraft]]
name = "c172"
aircraft = "c172/news"
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
  const out = { title: page.getElementById('title').textContent, all: names(), count: page.getElementById('count').textContent };
  out.canvases = [...page.querySelectorAll('canvas')].map(drawn);
  out.pictures = [...page.querySelectorAll('.pictures img')].map((i) => i.naturalWidth);
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
  await set('sort', 'nearest');
  out.nearest = names();
  await set('descending', true);
  out.farthest = names();
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
"""


def looked_at(browser, folder, size, look=LOOK):
    """What the script `look` found in the page that it fetches from `folder`, in a frame of `size`."""
    width, height = size
    with open(os.path.join(folder, "look.html"), "w", encoding="utf-8") as page:
        page.write(f'<!DOCTYPE html><meta charset="utf-8"><pre id="result"></pre>'
                   f'<iframe id="frame" width="{width}" height="{height}"></iframe><script>{look}</script>')
    quiet = type("Quiet", (http.server.SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(quiet, directory=folder))
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


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if not browser:
        print("report_page_test: skipped: no chromium")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="airtruth_report_") as root:
        catalogue = os.path.join(root, "c.toml")
        with open(catalogue, "w", encoding="utf-8") as file:
            file.write(CATALOGUE)
        made = os.path.join(root, "set #1 50% <", "script><b>")
        page = os.path.join(root, "report.html")
        for command in (["build", catalogue, "--out", made], ["report", made, "-o", page]):
            subprocess.run([airtruth, "dataset", *command], check=True, stdout=subprocess.DEVNULL)
        for size in ((1400, 4000), (400, 20000)):
            out = looked_at(browser, root, size)
            faults = []

            def expect(what, got, wanted):
                if got != wanted:
                    faults.append(f"{what}: {got!r}; expected {wanted!r}")

            expect("errors", out.get("found", out), [])
            expect("title", out["title"], "<script><b onclick=x>set")
            expect("sequences", len(out["all"]), 8)
            expect("count", out["count"], "8 of 8")
            expect("canvases drawn", (len(out["canvases"]), all(out["canvases"])), (5 + 3 * 8, True))
            expect("pictures", [w > 0 for w in out["pictures"]], [True] * 8)
            expect("markup made of names", out["injected"], 0)
            expect("links", set(out["links"]), {200})
            expect("by aircraft", all(n.endswith("c172") for n in out["c172"]) and len(out["c172"]), 4)
            expect("by background", len({n.split("> ")[1][:3] for n in out["background"]}) and len(out["background"]), 4)
            expect("by range", sorted(out["near"]), sorted(n for n in out["all"] if " near " in n))
            expect("by name", sorted(out["far"]), sorted(n for n in out["all"] if " far " in n))
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
