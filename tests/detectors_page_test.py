# SPDX-License-Identifier: Apache-2.0
"""The page of an evaluation of detectors in a real browser: python3 detectors_page_test.py AIRTRUTH

A clip whose frames carry their numbers as pixels, and two detectors' results that are written here, so that what the page
must show is known: one finds the target from frame 10 on, with a track, and raises a false alarm in three frames; the other,
with a name that wants to be markup, finds nothing.
"""

import json
import os
import re
import subprocess
import sys
import tempfile

from numbered_clip import READ_NUMBER, box_of, write_otb
from report_page_test import browser_or_skip, looked_at

CLIP = "b \"numbered\" 100% '<script>alert(1)<script>"
BLIND = "<img src=x onerror=alert(1)>"
FRAMES, FIRST_FOUND = 60, 10
ALARM_FRAMES = (30, 31, 32)
ALARM_BOX = (250, 200, 10, 8)

LOOK = """
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const trap = `<script>window.found = []; for (const kind of ['error', 'warn']) console[kind] = (...all) => found.push(all.join(' '));
window.alert = () => found.push('alert');
addEventListener('error', (e) => found.push(e.message || 'cannot load ' + e.target.src), true);<` + `/script>`;
""" + READ_NUMBER + """
(async () => {
  const text = await (await fetch('evaluation/detection.html')).text();
  const frame = document.getElementById('frame');
  const loaded = new Promise((done) => frame.addEventListener('load', done));
  frame.srcdoc = text.replace('<head>', '<head>' + trap);
  await loaded;
  await wait(500);
  const page = frame.contentDocument;
  const id = (name) => page.getElementById(name);
  const send = (element, kind, more = {}) => element.dispatchEvent(new frame.contentWindow[kind === 'click' ? 'MouseEvent' : 'Event'](kind, { bubbles: true, ...more }));
  const drawn = (canvas) => canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v !== 0);
  const texts = (selector) => [...page.querySelectorAll(selector)].map((one) => one.textContent);
  const named = () => Number(/frame (\\d+)/.exec(id('caption').textContent)[1]);
  const pair = () => [named(), numberOn(id('whole'))];
  const cells = () => [...page.querySelectorAll('#boxes tbody tr')].map((row) => [...row.cells].map((c) => c.textContent));
  const out = { title: id('title').textContent, detectors: texts('#ranking tbody td:first-child'), heads: texts('#ranking th'), left_out: texts('#left-out li') };
  out.rows = [...page.querySelectorAll('#ranking tbody tr')].map((row) => [...row.cells].map((c) => c.textContent));
  out.tracks = texts('#tracks tbody td:first-child');
  out.undrawn = [...page.querySelectorAll('canvas')].filter((c) => !drawn(c)).map((c) => c.id || c.dataset.plot);
  out.facts = id('facts').textContent;
  out.plots = [...page.querySelectorAll('canvas[data-plot]')].map((c) => c.dataset.plot);
  out.elements = page.querySelectorAll('h1 *, option *, figcaption img, td > :not(.dot), #shown label > :not(input):not(.dot)').length;
  out.pairs = [pair()];
  for (const value of [1, 9, 10, 30, 59]) {
    id('frame').value = value;
    send(id('frame'), 'input');
    await wait(100);
    out.pairs.push(pair());
    if (value === 30) [out.at_30, out.caption] = [cells(), id('caption').textContent];
    if (value === 9) out.at_9 = cells();
  }
  const strip = id('strip').getBoundingClientRect();
  send(id('strip'), 'click', { clientX: strip.left + 0.4 * strip.width, clientY: strip.top + 5 });
  await wait(100);
  out.clicked = pair();
  const colour = () => [...id('close').getContext('2d').getImageData(0, 0, 480, 480).data].reduce((a, b) => (a * 31 + b) % 1000003, 0);
  const before = colour();
  page.querySelectorAll('#shown input').forEach((box) => box.click());
  await wait(100);
  out.hid = colour() !== before;
  page.querySelectorAll('#shown input').forEach((box) => box.click());
  id('play').click();
  for (let k = 0; k < 8; ++k) { await wait(63); out.pairs.push(pair()); }
  const gallery = async (name) => {
    id('gallery-detector').value = [...id('gallery-detector').options].findIndex((o) => o.textContent === name);
    send(id('gallery-detector'), 'input');
    await wait(100);
    return [texts('#alarms figure'), texts('#misses figure'), [...page.querySelectorAll('.gallery canvas')].every(drawn)];
  };
  out.finder = await gallery('finder');
  page.querySelector('#alarms button').click();
  await wait(100);
  out.alarm = pair();
  out.blind = await gallery(BLIND);
  out.overflow = page.documentElement.scrollWidth - page.documentElement.clientWidth;
  out.found = frame.contentWindow.found;
  document.getElementById('result').textContent = JSON.stringify(out);
})().catch((error) => { document.getElementById('result').textContent = JSON.stringify({ broken: String(error) }); });
""".replace("BLIND", json.dumps(BLIND).replace("<", "\\u003c"))


def mot_line(frame, track, box, score):
    x, y, width, height = box
    return f"{frame + 1},{track},{x + 1},{y + 1},{width},{height},{score},-1,-1,-1\n"


def write_results(folder, lines):
    os.makedirs(folder)
    with open(os.path.join(folder, CLIP + ".txt"), "w", encoding="utf-8") as file:
        file.writelines(lines)


DATA = r'(?s)(?<=<script type="application/json" id="data">).*?(?=</script>)'


def declare_late(file_name):
    """Has the page say that the finder declares the aircraft 3 s after the closest approach, of which the clip states nothing,
    and that each picture is of that time."""
    with open(file_name, encoding="utf-8") as file:
        text = file.read()
    data = json.loads(re.search(DATA, text).group())
    finder = next(one for one in data["detectors"] if one["name"] == "finder")
    finder["tracks"]["encounters"][0]["declaration"]["to_closest_approach_s"] = -3
    for still in data["sequences"][0]["stills"]:
        still["objects"][0]["to_closest_s"] = -3
    with open(file_name, "w", encoding="utf-8") as file:
        file.write(re.sub(DATA, lambda _: json.dumps(data).replace("<", "\\u003c"), text))


def main():
    airtruth = os.path.abspath(sys.argv[1])
    browser = browser_or_skip("detectors_page_test")
    with tempfile.TemporaryDirectory(prefix="airtruth_detection_") as root:
        run = lambda *command: subprocess.run([airtruth, *command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=root)
        write_otb(root + "/otb", [CLIP], FRAMES)
        run("dataset", "import", "otb", "--format", "otb", "--frame-rate", "25", "-o", "clips")
        finder = [mot_line(k, 7, box_of(k), 5) for k in range(FIRST_FOUND, FRAMES)]
        finder += [mot_line(k, -1, ALARM_BOX, 9) for k in ALARM_FRAMES]
        write_results(root + "/results/finder", finder)
        write_results(root + "/results/" + BLIND, [mot_line(k, -1, (10, 200, 12, 12), 1) for k in range(FRAMES)])
        run("evaluate", "clips", "results/finder", "results/" + BLIND, "--detections", "--score", "1", "-o", "evaluation", "--figures", "svg")
        declare_late(root + "/evaluation/detection.html")
        faults = []
        for size in ((1400, 5000), (400, 12000)):
            out = looked_at(browser, root, size, LOOK)

            def expect(what, got, wanted):
                if got != wanted:
                    faults.append(f"{size[0]} px wide: {what}: {got!r}; expected {wanted!r}")

            expect("complaints", out.get("found", out), [])
            if "found" not in out:
                break
            expect("title", out["title"], "Detectors on clips")
            expect("detectors", sorted(out["detectors"]), sorted(["finder", BLIND]))
            row = dict(zip([re.sub(" [▲▼]", "", head) for head in out["heads"]], next(r for r in out["rows"] if r[0] == "finder")))
            expect("probability of detection", row["PD at the point"].split(" ")[0], "0.833")
            expect("false alarms an image", row["false alarms an image"], "0.05")
            expect("detectors with tracks", out["tracks"], ["finder"])
            expect("not drawn", out["undrawn"], [])
            expect("declared after the closest approach", ", 3 s after the closest approach" in out["facts"], True)
            expect("seen after the closest approach", ", 3 s after the closest approach" in out["caption"], True)
            expect("plots by range, which nothing is known of", [p for p in out["plots"] if "range" in p or "closest" in p], [])
            expect("plots", {"precision", "froc", "by_size_px", "by_contrast_to_noise", "false_alarms"} - set(out["plots"]), set())
            expect("says that ranges are unknown", any("range" in text for text in out["left_out"]), True)
            expect("markup made of names", out["elements"], 0)
            expect("frames not the ones named", [p for p in out["pairs"] + [out["clicked"], out["alarm"]] if p[0] != p[1]], [])
            expect("first and last frame seen", {0, FRAMES - 1} <= {p[0] for p in out["pairs"]}, True)
            expect("boxes of frame 30", sorted(out["at_30"]), sorted([
                ["finder", "9", "–", "false alarm: background"], ["finder", "5", "7", "found"], [BLIND, "1", "–", "false alarm: background"]]))
            expect("boxes of frame 9", out["at_9"], [[BLIND, "1", "–", "false alarm: background"]])
            expect("the strip leads to", 22 <= out["clicked"][0] <= 26, True)
            expect("detectors can be hidden", out["hid"], True)
            alarms, misses, is_drawn = out["finder"]
            expect("alarms and misses of one", (len(alarms), len(misses), is_drawn), (1, 1, True))
            expect("its alarm", ("score 9" in alarms[0], "background" in alarms[0], "3 frames" in alarms[0]), (True,) * 3)
            expect("its miss", "missed in 10 frames from 0 on" in misses[0], True)
            expect("the alarm's frame", out["alarm"][0] in ALARM_FRAMES, True)
            alarms, misses, is_drawn = out["blind"]
            expect("alarms and misses of the other", (len(alarms), len(misses), is_drawn), (1, 1, True))
            expect("its misses", "missed in 60 frames from 0 on" in misses[0], True)
            expect("wider than the screen by", out["overflow"], 0)
        with open(root + "/evaluation/detection.html", encoding="utf-8") as file:
            text = file.read()
        if re.findall(r'(?:src|href)\s*=\s*["\']?(https?:[^"\' >]+)', text):
            faults.append("the page asks for something outside")
        data = json.loads(re.search(DATA, text).group())
        found = {data["detectors"][one["detector"]]["name"]: one["found"] for one in data["sequences"][0]["detectors"]}
        if found != {"finder": "m" * FIRST_FOUND + "f" * (FRAMES - FIRST_FOUND), BLIND: "m" * FRAMES}:
            faults.append(f"frames found: {found}")
        figures = set(os.listdir(root + "/evaluation/figures"))
        missing = [n for n in ("precision", "froc", "by_size_px", "ranking") if f"detection_{n}.svg" not in figures]
        if missing:
            faults.append(f"figures missing: {missing}")
        if faults:
            sys.exit("detectors_page_test:\n  " + "\n  ".join(faults))
        print("two detectors looked at wide and narrow: drawn, played, galleries, no complaint")


if __name__ == "__main__":
    main()
