# SPDX-License-Identifier: Apache-2.0
"""`airtruth evaluate` on detectors' results: python3 detection_measures_test.py AIRTRUTH

Random truths and detections, scored by the program and by the same measures written down once more (detection_references.py);
every number agrees to 1e-9. Where the public toolkits are at hand (detection_toolkits.py), theirs agree too. Then ignored
regions, classes, what is left out, and what is wrong with results.
"""

import json
import math
import os
import random

import detection_references as reference
import detection_toolkits as toolkits
import program
from program import made, path, run, write

WIDTH, HEIGHT, RATE_HZ = 640, 480, 10.0
CENTRE_PX = 10.0


def label(track, box, reach=None, above=None, kind=None):
    result = {"track": track, "category": kind or "738", "box_px": list(box)}
    if kind:
        result["class"] = kind
    if reach is not None:
        result["range_m"] = reach
    if above:
        result["above_horizon"] = above > 0
    return result


def write_sequence(folder, name, frames, rate=RATE_HZ):
    """frames: lists of labels."""
    head = {"format": "airtruth labels 1", "name": name, "width": WIDTH, "height": HEIGHT}
    if rate:
        head["frame_rate_hz"] = rate
    lines = [head] + [{"frame": i, "labels": labels} for i, labels in enumerate(frames)]
    write(f"{folder}/sequences/{name}/labels.jsonl", "".join(json.dumps(line) + "\n" for line in lines))
    categories = sorted({one["category"] for labels in frames for one in labels})
    write(f"{folder}/sequences/{name}/sequence.json", json.dumps(
        {"format": "airtruth labelled clip 1", "version": "1", "name": name, "imported_from": "csv", "frames": len(frames),
         "labels": sum(map(len, frames)), "categories": categories}))


def write_results(name, sequences):
    """COCO results; sequences: lists of frames of (track or None, box, score)."""
    image, results = 0, []
    for frames in sequences:
        for answers in frames:
            image += 1
            for track, box, score in answers:
                one = {"image_id": image, "category_id": 1, "bbox": list(box), "score": score}
                results.append(one if track is None else {**one, "track_id": track})
    return write(name, json.dumps(results))


def evaluated(folder, results, *options, out="out"):
    made("evaluate", folder, *results, "-o", out, "--no-page", *options)
    with open(path(out, "detection.json"), encoding="utf-8") as file:
        return json.load(file)


def drawn(rng):
    """A random flight: frames of (truths, birds, answers); truths are (id, box, range, above)."""
    frames = []
    aircraft = [{"id": i + 1, "x": rng.uniform(60, 560), "y": rng.uniform(60, 400), "v": rng.uniform(-1.5, 1.5), "size": rng.uniform(3, 8),
                 "far": rng.uniform(400, 1100), "closing": rng.uniform(2, 8), "above": rng.choice((-1, 1)), "track": 10 * (i + 1)}
                for i in range(rng.randint(1, 2))]
    bird = [rng.uniform(100, 500), rng.uniform(100, 300)]
    pause = rng.randrange(40, 60)
    next_track = 500
    for i in range(rng.randint(70, 130)):
        truths, birds, answers = [], [], []
        for one in aircraft:
            one["x"] += one["v"]
            one["size"] *= 1.01
            if rng.random() < 0.02:
                one["above"] = -one["above"]
            if pause <= i < pause + 2 * one["id"] + 1:
                continue  # a gap of 3 or 5 frames
            box = (one["x"], one["y"], one["size"] * 2, one["size"])
            truths.append((one["id"], box, abs(one["far"] - one["closing"] * i) + 40, one["above"]))
            if rng.random() < 0.01:
                one["track"] += 1
            if rng.random() < 0.75:
                jitter = one["size"] * rng.choice((0.05, 0.2, 0.5))
                answers.append((one["track"], (box[0] + rng.gauss(0, jitter), box[1] + rng.gauss(0, jitter),
                                               box[2] * rng.uniform(0.7, 1.3), box[3] * rng.uniform(0.7, 1.3)), rng.uniform(0.2, 1)))
        if i > 30:
            bird[0] += 0.7
            birds.append((9, (bird[0], bird[1], 9.0, 6.0)))
            if rng.random() < 0.3:
                answers.append((77, (bird[0] + rng.gauss(0, 1), bird[1], 9.0, 6.0), rng.uniform(0, 0.8)))
        if rng.random() < 0.25:
            next_track += rng.random() < 0.5
            answers.append((next_track, (rng.uniform(0, 600), rng.uniform(0, 440), rng.uniform(3, 30), rng.uniform(3, 30)), rng.uniform(0, 0.9)))
        if truths and rng.random() < 0.1:
            box = truths[0][1]
            answers.append((88, (box[0] + 2, box[1], box[2], box[3]), rng.uniform(0, 0.5)))
        frames.append((truths, birds, answers))
    return frames


def make_inputs():
    pass


class Random(program.Case):
    @classmethod
    def setUpClass(cls):
        rng = random.Random(20)
        cls.flights = [drawn(rng) for _ in range(6)]
        for k, frames in enumerate(cls.flights):
            write_sequence("random", f"flight-{k}", [
                [label(*truth) for truth in truths] + [label(*b, kind="bird") for b in birds] for truths, birds, _ in frames])
        results = write_results("mine.json", [[answers for _, _, answers in frames] for frames in cls.flights])
        cls.got = evaluated("random", [results])["detectors"][0]
        cls.tracks = [[(truths, answers) for truths, _, answers in frames] for frames in cls.flights]
        cls.images = [([t[1] for t in truths], [], [a[1:] for a in answers]) for frames in cls.flights for truths, _, answers in frames]
        cls.airborne = [[([*truths, *((i, b, None, 0) for i, b in birds)], answers) for truths, birds, answers in frames]
                        for frames in cls.flights]
        cls.hours = sum(map(len, cls.flights)) / RATE_HZ / 3600

    def assert_same(self, got, wanted, where):
        if wanted is None or got is None:
            self.assertEqual(got, wanted, where)
        elif isinstance(wanted, (list, tuple)):
            self.assertEqual(len(got), len(wanted), where)
            for k, (a, b) in enumerate(zip(got, wanted)):
                self.assert_same(a, b, f"{where}[{k}]")
        else:
            self.assertAlmostEqual(got, wanted, delta=1e-9 * max(1, abs(wanted)), msg=where)

    def test_average_precision(self):
        got = self.got["average_precision"]
        steps = [0.5 + 0.05 * k for k in range(10)]
        mean = lambda values: None if None in values else math.fsum(values) / len(values)
        ap = lambda **options: [reference.average_precision(self.images, s, **options) for s in steps]
        all_ = ap()
        self.assert_same(got["ap"], mean([p for p, _ in all_]), "ap")
        self.assert_same(got["ap_50"], all_[0][0], "ap_50")
        self.assert_same(got["ap_75"], all_[5][0], "ap_75")
        self.assert_same(got["ar_100"], mean([r for _, r in all_]), "ar_100")
        self.assert_same(got["ar_1"], mean([r for _, r in ap(most=1)]), "ar_1")
        for name, low, high in (("small", 0, 1024), ("medium", 1024, 9216), ("large", 9216, 1e10)):
            self.assert_same(got["ap_" + name], mean([p for p, _ in ap(low=low, high=high)]), name)
        low, high = got["ap_50_interval_95"]
        self.assertTrue(low < got["ap_50"] < high, (low, high))

    def test_coco_toolkit(self):
        place = toolkits.folder("AIRTRUTH_COCOAPI")
        if place:
            for name, value in toolkits.coco(place, self.images).items():
                self.assert_same(self.got["average_precision"][name], value, name)

    def test_regions_are_crowds(self):
        rng = random.Random(4)
        region = lambda: (rng.uniform(0, 500), rng.uniform(0, 350), rng.uniform(20, 120), rng.uniform(20, 100))
        regions = [[[region() for _ in range(rng.randint(0, 2))] for _ in frames] for frames in self.flights]
        for k, frames in enumerate(self.flights):
            write_sequence("crowds", f"flight-{k}", [
                [label(*t) for t in truths] + [label(30 + j, b, kind="ignore") for j, b in enumerate(crowds)]
                for (truths, _, _), crowds in zip(frames, regions[k])])
        results = write_results("crowds.json", [[answers for _, _, answers in frames] for frames in self.flights])
        got = evaluated("crowds", [results])["detectors"][0]["average_precision"]
        images = [(t, crowds, a) for (t, _, a), crowds in zip(self.images, [c for of_flight in regions for c in of_flight])]
        self.assertNotAlmostEqual(got["ap_50"], self.got["average_precision"]["ap_50"], places=3)
        self.assert_same(got["ap_50"], reference.average_precision(images, 0.5)[0], "ap_50")
        self.assert_same(got["ap_75"], reference.average_precision(images, 0.75)[0], "ap_75")
        place = toolkits.folder("AIRTRUTH_COCOAPI")
        if place:
            for name, value in toolkits.coco(place, images).items():
                self.assert_same(got[name], value, name)

    def test_free_response(self):
        def near(box, truth):
            return math.dist([box[k] + box[k + 2] / 2 for k in (0, 1)], [truth[k] + truth[k + 2] / 2 for k in (0, 1)])
        def found_by(box, truths):
            hits = [(near(box, t[1]), t[0]) for t in truths if near(box, t[1]) <= max(CENTRE_PX, max(t[1][2:]) / 2)]
            return min(hits)[1] if hits else None
        scores, alarms = [], []
        for frames in self.flights:
            for truths, _, answers in frames:
                best = {t[0]: None for t in truths}
                for _, box, score in answers:
                    id = found_by(box, truths)
                    if id is None:
                        alarms.append(score)
                    else:
                        best[id] = max(score, best[id] or 0)
                scores += [(best[t[0]], t[2]) for t in truths]
        images = len(self.images)
        allowed = [s for s in {*alarms, *(s for s, _ in scores if s)} if sum(a >= s for a in alarms) <= 0.1 * images]
        point = self.got["point"]
        self.assert_same(point["score"], min(allowed), "score")
        hit = lambda s: s is not None and s >= point["score"]
        self.assert_same(point["detection"]["share"], sum(hit(s) for s, _ in scores) / len(scores), "detection")
        false = sum(a >= point["score"] for a in alarms)
        self.assert_same(point["false_alarms_per_image"], false / images, "per image")
        self.assert_same(point["false_alarms_per_hour"], false / self.hours, "per hour")
        self.assert_same(point["false_alarms_per_flight"], false / len(self.flights), "per flight")
        self.assertEqual(sum(self.got["false_alarms_by"].values()), false)
        for bin in self.got["by"]["range_m"]:
            within = [hit(s) for s, r in scores if bin["from"] <= r < (bin["to"] or math.inf)]
            self.assertEqual(bin["trials"], len(within))
            self.assert_same(bin["share"], sum(within) / len(within), f"range {bin['from']}")
        last = self.got["froc"]["points"][-1]
        self.assert_same(last["false_alarms_per_image"], len(alarms) / images, "all")
        self.assert_same(last["detection"]["share"], sum(s is not None for s, _ in scores) / len(scores), "all found")

    def assert_aot(self, got, wanted, hfar):
        self.assert_same(got["fppi"], wanted["fppi"], "fppi")
        self.assert_same(got["hfar"], hfar, "hfar")
        self.assert_same(got["max_range_m"], wanted["max_range_m"], "range")
        for key in ("edr", "edr_below_horizon", "edr_mixed", "edr_above_horizon", "afdr"):
            self.assertEqual((got[key]["detected"], got[key]["total"]), wanted[key], key)

    def test_aot(self):
        wanted = reference.aot(self.airborne, self.hours)
        self.assertGreater(wanted["edr"][1], 3)
        self.assert_aot(self.got["aot"], wanted, wanted["hfar"])
        ranked = self.got["aot_at_fppi_0.0005"]
        if ranked:
            wanted = reference.aot(self.airborne, self.hours, ranked["score"])
            self.assertLessEqual(wanted["fppi"], 0.0005)
            self.assert_aot(ranked, wanted, wanted["hfar"])

    def test_aot_toolkit(self):
        place = toolkits.folder("AIRTRUTH_AOT")
        if not place:
            return
        summary = toolkits.aot(place, self.airborne, path("aot"))
        rate = lambda one: (one["detected"], one["total"])
        encounters = summary["Tracking"]["Encounters"]["300"]
        theirs = {"fppi": summary["fppi"], "max_range_m": summary["max_range"], "edr": rate(encounters["All"]),
                  "edr_below_horizon": rate(encounters["Below Horizon"]), "edr_mixed": rate(encounters["Mixed"]),
                  "edr_above_horizon": rate(encounters["Above Horizon"]),
                  "afdr": (summary["det_aircraft_in_range"], summary["tot_aircraft_in_range"])}
        # The challenge counts two minutes for each flight.
        self.assert_aot(self.got["aot"], theirs, summary["far"] * len(self.flights) * 2 / 60 / self.hours)
        self.assertEqual(self.got["aot"]["edr_by_frames"]["detected"], summary["Detection"]["Encounters"]["300"]["All"]["detected"])

    def test_tracks(self):
        got = self.got["tracks"]
        for key, curve in reference.hota(self.tracks).items():
            self.assert_same(got["hota"][key]["at_overlaps"], curve, key)
            self.assert_same(got["hota"][key]["mean"], math.fsum(curve) / 19, key)
        for key, value in reference.clear(self.tracks).items():
            self.assert_same(got["clear"][key], value, key)
        for key, value in reference.identity(self.tracks).items():
            self.assert_same(got["identity"][key], value, key)

    def test_tracks_toolkit(self):
        place = toolkits.folder("AIRTRUTH_TRACKEVAL")
        if not place:
            return
        hota, clear, identity = toolkits.trackeval(place, self.tracks)
        got = self.got["tracks"]
        for ours, theirs in (("hota", "HOTA"), ("det_a", "DetA"), ("ass_a", "AssA"), ("det_re", "DetRe"), ("det_pr", "DetPr"),
                             ("ass_re", "AssRe"), ("ass_pr", "AssPr"), ("loc_a", "LocA")):
            self.assert_same(got["hota"][ours]["at_overlaps"], list(map(float, hota[theirs])), theirs)
        for ours, theirs in (("mota", "MOTA"), ("motp", "MOTP"), ("recall", "CLR_Re"), ("precision", "CLR_Pr"), ("true_positives", "CLR_TP"),
                             ("false_negatives", "CLR_FN"), ("false_positives", "CLR_FP"), ("identity_switches", "IDSW"),
                             ("fragmentations", "Frag"), ("mostly_tracked", "MT"), ("partly_tracked", "PT"), ("mostly_lost", "ML")):
            self.assert_same(got["clear"][ours], float(clear[theirs]), theirs)
        for ours, theirs in (("idf1", "IDF1"), ("recall", "IDR"), ("precision", "IDP"), ("true_positives", "IDTP")):
            self.assert_same(got["identity"][ours], float(identity[theirs]), theirs)


HERE, BESIDE, AWAY = (100.0, 100.0, 12.0, 6.0), (300.0, 200.0, 12.0, 6.0), (500.0, 300.0, 12.0, 6.0)


class Classes(program.Case):
    """One sequence of 20 frames: an aircraft at HERE, a bird at BESIDE; the detector sees both and something at AWAY."""

    def set_up(self, name, other, frames=20, **more):
        write_sequence(name, "pass", [[label(1, HERE, 1000.0 - 10 * i, 1)] + ([label(2, BESIDE, kind=other)] if other else [])
                                      for i in range(frames)], **more)
        return write_results(name + ".json", [[[(1, HERE, 0.9), (2, BESIDE, 0.8), (3, AWAY, 0.7)]] * frames])

    def test_a_bird_is_a_false_alarm_by_its_name(self):
        got = evaluated("bird", [self.set_up("bird", "bird")], "--score", "0")["detectors"][0]
        self.assertEqual(got["false_alarms_by"], {"background": 20, "bird": 20})
        self.assertEqual(got["mistaken_by"]["bird"]["share"], 1)
        self.assertEqual(got["point"]["detection"]["share"], 1)
        self.assertEqual(got["point"]["false_alarms_per_image"], 2)
        self.assertEqual([one["what"] for one in got["strongest_false_alarms"]], ["bird", "background"])
        self.assertEqual(got["strongest_false_alarms"][0]["frames"], 20)
        self.assertEqual(got["tracks"]["false_tracks"], 2)

    def test_a_detector_that_calls_a_bird_one_raises_no_alarm(self):
        """By the words that an import knows, and by those of the set's own labels."""
        frames = [[label(1, HERE, 1000.0 - 10 * i, 1), {**label(2, BESIDE, kind="bird"), "category": "gull"}] for i in range(20)]
        write_sequence("named", "pass", frames)
        for word, alarms in {"Birds": 0, "gull": 0, "drone": 0, "glider": 1, "UFO": 1}.items():
            results = [{"image_id": i + 1, "category_id": k + 1, "category_name": name, "bbox": list(box), "score": 0.9}
                       for i in range(20) for k, (name, box) in enumerate([("aircraft", HERE), (word, BESIDE)])]
            got = evaluated("named", [write(f"{word}.json", json.dumps(results))], "--score", "0")["detectors"][0]
            self.assertEqual(got["point"]["false_alarms_per_image"], alarms, word)
            self.assertEqual(got["point"]["detection"]["share"], 1, word)

    def test_an_ignored_label_counts_neither_way(self):
        got = evaluated("ignore", [self.set_up("ignore", "ignore")], "--score", "0")["detectors"][0]
        self.assertEqual(got["false_alarms_by"], {"background": 20})
        self.assertAlmostEqual(got["average_precision"]["ap_50"], 1, places=9)
        self.assertEqual(got["aot"]["fppi"], 1)
        self.assertEqual(got["tracks"]["clear"]["false_positives"], 20)

    def test_regions_of_a_file(self):
        results = self.set_up("regions", None)
        head = "sequence,first_frame,last_frame,x,y,width,height\n"
        write("regions/ignore.csv", head + "# an airliner\npa*,,9,290,190,40,40\n")
        got = evaluated("regions", [results], "--score", "0")["detectors"][0]
        self.assertEqual(got["false_alarms_by"], {"background": 30})
        write("mine.csv", head + "pass,,,290,190,40,40\npass,5,,490,290,40,40\n")
        got = evaluated("regions", [results], "--score", "0", "--ignore", path("mine.csv"))["detectors"][0]
        self.assertEqual(got["false_alarms_by"], {"background": 5})
        for line, words in (("pass,5,3,1,1,1,1", ["mine.csv:2", "before it begins"]), ("pass,,,1,1,0,1", ["no area"]),
                            ("pass,x,,1,1,1,1", ["mine.csv:2", "x"]), ("other,,,1,1,1,1", ["'other' is neither"]),
                            ("pass,,,nan,1,1,1", ["nan"]), ("pass,1", ["2 cells"])):
            write("mine.csv", head + line + "\n")
            self.assert_refused(run("evaluate", "regions", results, "-o", "no", "--no-page", "--ignore", path("mine.csv")), *words)
        write("mine.csv", "x,y\n")
        self.assert_refused(run("evaluate", "regions", results, "-o", "no", "--ignore", path("mine.csv")), "heading", "mine.csv:1")

    def test_a_page_that_an_earlier_evaluation_left_is_named(self):
        results = self.set_up("paged", None)
        evaluate = lambda *more: made("evaluate", "paged", results, "-o", "paged-out", *more).stderr
        self.assertNotIn("earlier evaluation", evaluate() + evaluate())
        self.assertIn(os.path.join("paged-out", "detection.html") + ": is of an earlier evaluation", evaluate("--no-page"))

    def test_an_import_states_the_class(self):
        write("csv/V_BIRD_1.csv", "frame,x,y,w,h\n0,1,2,3,4\n")
        write("csv/plane.csv", "frame,x,y,w,h\n0,1,2,3,4\n")
        made("dataset", "import", "csv", "-f", "csv", "--size", "640x480", "--class", "V_BIRD*=bird", "-o", "classes")
        read = lambda name: json.loads(program.read("classes", "sequences", name, "labels.jsonl").splitlines()[1])["labels"][0]
        self.assertEqual((read("V_BIRD_1")["class"], read("V_BIRD_1")["category"]), ("bird", "bird"))
        self.assertNotIn("class", read("plane"))
        self.assert_refused(run("dataset", "import", "csv", "-f", "csv", "--size", "640x480", "--class", "goose", "-o", "no"), "goose", "bird")
        self.assert_refused(run("dataset", "import", "csv", "-f", "csv", "--size", "640x480", "--class", "x*=bird", "-o", "no"), "fits no clip")

    def test_what_the_truth_lacks_is_left_out_and_said(self):
        frames = [[label(1, HERE)]] * 20
        write_sequence("bare", "pass", frames, rate=None)
        results = write_results("bare.json", [[[(None, HERE, 0.9)]] * 20])
        followed = evaluated("bare", [write_results("followed.json", [[[(1, HERE, 0.9)]] * 20])])["detectors"][0]["tracks"]
        self.assertEqual((followed["declarations"]["declared"], followed["encounters"]), (None, []))
        done = made("evaluate", "bare", results, "-o", "bare-out", "--no-page")
        for words in ("range is unknown", "lens is unknown", "closest approach is unknown", "frame rate is unknown for 1 of 1 sequences;",
                      "; declarations leave them out", "reports no tracks"):
            self.assertIn(words, done.stderr)
        with open(path("bare-out", "detection.json"), encoding="utf-8") as file:
            got = json.load(file)
        detector = got["detectors"][0]
        self.assertIsNone(detector["point"]["false_alarms_per_hour"])
        self.assertIsNone(detector["tracks"])
        self.assertIsNone(detector["bearing"])
        self.assertNotIn("range_m", detector["by"])
        self.assertEqual(len(got["left_out"]), 6)

    def test_wrong_results_are_one_line(self):
        results = self.set_up("wrong", None)
        refused = lambda *arguments, words: self.assert_refused(
            run("evaluate", "wrong", *arguments, "-o", "no", "--no-page"), *words)
        again = write("again/wrong.json", program.read("wrong.json"))
        refused(results, again, words=["second set of results called 'wrong'"])
        refused(results, results, words=["is given twice"])
        box = '"category_id":1,"bbox":[1,1,5,5]'
        for text, words in (('[{"image_id":1,%s,"score":NaN}]' % box, ["bad.json"]), ('[{"image_id":1,%s,"score":1e999}]' % box, ["bad.json"]),
                            ('[{"image_id":99,%s,"score":1}]' % box, ["99"]), ('[{"image_id":"other/000001.jpg",%s,"score":1}]' % box, ["other"]),
                            ('[{"image_id":1,"category_id":1,"bbox":[700,1,5,5],"score":1}]', ["700"]), ("{}", ["bad.json"]), ("[", ["bad.json"])):
            refused(write("bad.json", text), words=words)
        refused(results, "--volume", "f3443", words=["f3443", "f3442"])
        refused(results, "--manoeuvre-s", "20", words=["--volume"])
        for option in ("--score", "--centre-px", "--false-alarms"):
            refused(results, option, "nan", words=[option])
        refused(results, "--volume", "f3442", "--manoeuvre-s", "nan", words=["--manoeuvre-s"])
        refused(path("absent"), words=["absent"])
        os.makedirs(path("nothing"), exist_ok=True)
        refused("nothing", words=["nothing"])
        write("mot/other.txt", "1,-1,10,10,5,5,0.5,-1,-1,-1\n")
        self.assertEqual(run("evaluate", "wrong", "mot", "-o", "no", "--no-page").returncode, 2)
        self.assertFalse(os.path.exists(path("no")))

    def test_what_is_a_detectors(self):
        """Every form of a detector's results is read as the same; a tracker's beside them stays one."""
        results = self.set_up("forms", None)
        lines = "".join(f"{i + 1},-1,{b[0] + 1},{b[1] + 1},{b[2]},{b[3]},{s},-1,-1,-1\n" for i in range(20) for b, s in ((HERE, 0.9), (AWAY, 0.7)))
        write("mot/pass.txt", lines)
        write("data/data/pass.txt", lines)
        write("det/pass/det/det.txt", lines)
        write("tracked/pass.txt", lines.replace(",-1,", ",4,", 1).replace("\n1,-1,", "\n1,5,"))
        write("alone/some.json", program.read("forms.json"))
        write("tracker/pass.txt", "100,100,12,6\n" * 20)
        done = made("evaluate", "forms", "mot", "data", "det", "alone", results, "tracker", "-o", "forms-out", "--no-page", "--score", "0")
        with open(path("forms-out", "detection.json"), encoding="utf-8") as file:
            got = {one["name"]: one for one in json.load(file)["detectors"]}
        self.assertEqual(sorted(got), ["alone", "data", "det", "forms", "mot"])
        for one in got.values():
            self.assertAlmostEqual(one["average_precision"]["ap_50"], got["mot"]["average_precision"]["ap_50"], places=9)
            self.assertEqual(one["false_alarms_by"]["background"], 40 if one["tracks"] else 20)
        with open(path("forms-out", "evaluation.json"), encoding="utf-8") as file:
            self.assertEqual([one["name"] for one in json.load(file)["trackers"]], ["tracker"])
        self.assertIn("tracker", done.stdout)
        self.assertEqual(evaluated("forms", ["tracked"], "--detections", out="tracked-out")["detectors"][0]["name"], "tracked")

    def test_intervals_are_those_of_sequences(self):
        """Two sequences, one found whole and one not at all: by hand."""
        for name, hit in (("a", True), ("b", False)):
            write_sequence("two", name, [[label(1, HERE)]] * 5)
        results = write_results("two.json", [[[(None, HERE, 0.9)]] * 5, [[]] * 5])
        share = evaluated("two", [results])["detectors"][0]["point"]["detection"]
        # The variance between the two is 2 * ((5 - 2.5)^2 + 2.5^2) / 10^2 = 0.25, so that of p (1 - p): one trial, less for
        # Student's 12.7 of one degree of freedom, but no less than one.
        self.assertEqual(share["share"], 0.5)
        self.assertEqual(share["sequences"], 2)
        for got, wanted in zip(share["interval_95"], reference.wilson_interval(0.5, 1)):
            self.assertAlmostEqual(got, wanted, places=9)


if __name__ == "__main__":
    program.main(make_inputs)
