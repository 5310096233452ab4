# SPDX-License-Identifier: Apache-2.0
"""The evaluation's page in a real browser: python3 evaluation_page_test.py AIRTRUTH

Builds a small data set, follows it with four trackers and all protocols, and has a script beside the page look: everything is
drawn, the player shows what its cursor says, tables sort, trackers can be hidden, nothing is complained of. Then the same
plots as files.
"""

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

from report_page_test import looked_at

CATALOGUE = """
name = "<script><b onclick=x>set"
[[background]]
name = "sky"
flight = { seed = 3, frame_count = 40, width = 320, height = 240 }
lens = { vertical_fov_deg = 75 }
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
  await wait(500);
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
  out.pairs = page.querySelectorAll('#pairs tbody tr').length;
  out.overflow = page.documentElement.scrollWidth - page.documentElement.clientWidth;
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
"""

TRACKERS = ["am3", "am3s", "opencv-kcf", "opencv-mosse"]


def png_size(path):
    with open(path, "rb") as file:
        return struct.unpack(">II", file.read(24)[16:24])


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if not browser:
        print("evaluation_page_test: skipped: no chromium")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="airtruth_evaluation_") as root:
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
        for size in ((1400, 3600), (400, 9000)):
            out = looked_at(browser, root, size, LOOK)
            faults = []

            def expect(what, got, wanted):
                if got != wanted:
                    faults.append(f"{what}: {got!r}; expected {wanted!r}")

            expect("errors", out.get("found", out), [])
            expect("title", out["title"], "Trackers on set")
            expect("ranking", sorted(out["ranking"]), sorted(TRACKERS))
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
