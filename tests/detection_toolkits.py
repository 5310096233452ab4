# SPDX-License-Identifier: Apache-2.0
"""The public toolkits whose measures `airtruth evaluate` states, where they are at hand, for detection_measures_test.py.

  AIRTRUTH_COCOAPI    a checkout of cocodataset/cocoapi
  AIRTRUTH_TRACKEVAL  a checkout of JonathonLuiten/TrackEval
  AIRTRUTH_AOT        a checkout of EricM2/airborne-detection-starter-kit

They need numpy, and AOT pandas before version 2. Sequences are as in detection_references.py.
"""

import importlib.util
import json
import os
import subprocess
import sys
import types


def folder(variable):
    """The checkout that an environment variable names; None, with a line, where it is unset."""
    place = os.environ.get(variable)
    if not place:
        print(f"{variable} is not set; its toolkit is not compared", file=sys.stderr)
    return place


def with_old_numpy():
    import numpy
    for name, value in (("float", float), ("int", int), ("bool", bool)):
        if name not in numpy.__dict__:
            setattr(numpy, name, value)
    return numpy


def least_cost(cost):
    """Rows and columns of the least total, as scipy.optimize.linear_sum_assignment; Kuhn 1955 with potentials, any shape."""
    numpy = with_old_numpy()
    cost = numpy.asarray(cost, dtype=float)
    flipped = cost.shape[0] > cost.shape[1]
    if flipped:
        cost = cost.T
    n, m = cost.shape
    u, v, row_of, way = [0.0] * (n + 1), [0.0] * (m + 1), [0] * (m + 1), [0] * (m + 1)
    for i in range(1, n + 1):
        row_of[0], j0 = i, 0
        least, used = [float("inf")] * (m + 1), [False] * (m + 1)
        while True:
            used[j0] = True
            i0, delta, j1 = row_of[j0], float("inf"), 0
            for j in range(1, m + 1):
                if used[j]:
                    continue
                value = cost[i0 - 1, j - 1] - u[i0] - v[j]
                if value < least[j]:
                    least[j], way[j] = value, j0
                if least[j] < delta:
                    delta, j1 = least[j], j
            for j in range(m + 1):
                if used[j]:
                    u[row_of[j]] += delta
                    v[j] -= delta
                else:
                    least[j] -= delta
            j0 = j1
            if row_of[j0] == 0:
                break
        while j0:
            row_of[j0] = row_of[way[j0]]
            j0 = way[j0]
    pairs = sorted((row_of[j] - 1, j - 1) for j in range(1, m + 1) if row_of[j])
    if flipped:
        pairs = sorted((c, r) for r, c in pairs)
    return numpy.array([r for r, _ in pairs], dtype=int), numpy.array([c for _, c in pairs], dtype=int)


def coco(place, images):
    """The toolkit's twelve numbers, as detection.json names them."""
    numpy = with_old_numpy()

    def iou(answers, truths, crowds):
        result = numpy.zeros((len(answers), len(truths)))
        for d, D in enumerate(answers):
            for g, G in enumerate(truths):
                w = min(D[2] + D[0], G[2] + G[0]) - max(D[0], G[0])
                h = min(D[3] + D[1], G[3] + G[1]) - max(D[1], G[1])
                if w > 0 and h > 0:
                    result[d, g] = w * h / (D[2] * D[3] if crowds[g] else D[2] * D[3] + G[2] * G[3] - w * h)
        return result

    package = types.ModuleType("pycocotools")
    package.__path__ = [os.path.join(place, "PythonAPI", "pycocotools")]
    mask = types.ModuleType("pycocotools.mask")
    mask.iou = iou
    package.mask = mask
    sys.modules.update({"pycocotools": package, "pycocotools.mask": mask})
    spec = importlib.util.spec_from_file_location("pycocotools.cocoeval", os.path.join(package.__path__[0], "cocoeval.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)

    class Set:
        def __init__(self, annotations):
            self.annotations = annotations

        def getImgIds(self):
            return list(range(1, len(images) + 1))

        def getCatIds(self):
            return [1]

        def getAnnIds(self, imgIds=(), catIds=()):
            return [a["id"] for a in self.annotations]

        def loadAnns(self, ids):
            return self.annotations

    truths, answers = [], []
    for number, (boxes, regions, found) in enumerate(images, 1):
        for box, crowd in [(b, 0) for b in boxes] + [(b, 1) for b in regions]:
            truths.append({"id": len(truths) + 1, "image_id": number, "category_id": 1, "bbox": list(box),
                           "area": box[2] * box[3], "iscrowd": crowd})
        for box, score in found:
            answers.append({"id": len(answers) + 1, "image_id": number, "category_id": 1, "bbox": list(box),
                            "area": box[2] * box[3], "score": score})
    evaluated = module.COCOeval(Set(truths), Set(answers), "bbox")
    out, sys.stdout = sys.stdout, open(os.devnull, "w")
    try:
        evaluated.evaluate()
        evaluated.accumulate()
        evaluated.summarize()
    finally:
        sys.stdout.close()
        sys.stdout = out
    names = ("ap", "ap_50", "ap_75", "ap_small", "ap_medium", "ap_large", "ar_1", "ar_10", "ar_100", "ar_small", "ar_medium", "ar_large")
    return {name: None if value == -1 else float(value) for name, value in zip(names, evaluated.stats)}


def trackeval(place, sequences):
    """(HOTA, CLEAR, Identity) over all sequences, with the toolkit's own names."""
    numpy = with_old_numpy()
    if importlib.util.find_spec("scipy") is None:
        scipy, optimize = types.ModuleType("scipy"), types.ModuleType("scipy.optimize")
        optimize.linear_sum_assignment = least_cost
        scipy.optimize = optimize
        sys.modules.update({"scipy": scipy, "scipy.optimize": optimize})
    sys.path.insert(0, place)
    for name in ("trackeval", "trackeval.datasets"):  # without the readers, which need more packages
        module = types.ModuleType(name)
        module.__path__ = [os.path.join(place, *name.split("."))]
        sys.modules[name] = module
    from trackeval.metrics.hota import HOTA
    from trackeval.metrics.clear import CLEAR
    from trackeval.metrics.identity import Identity
    with open(os.path.join(place, "trackeval", "datasets", "_base_dataset.py"), encoding="utf-8") as file:
        source = file.read()
    start = source.index("    def _calculate_box_ious")
    end = source.index("    @staticmethod", start)
    space = {"np": numpy, "deepcopy": __import__("copy").deepcopy, "TrackEvalException": Exception}
    exec("class Boxes:\n    @staticmethod\n" + source[start:end], space)

    results = ({}, {}, {})
    metrics = HOTA(), CLEAR({"PRINT_CONFIG": False}), Identity({"PRINT_CONFIG": False})
    for number, frames in enumerate(sequences):
        truth_ids = {t: i for i, t in enumerate(sorted({t[0] for truths, _ in frames for t in truths}))}
        answer_ids = {a: i for i, a in enumerate(sorted({a[0] for _, answers in frames for a in answers}))}
        boxes = lambda items: numpy.array([i[1] for i in items], dtype=float).reshape(-1, 4)
        data = {"num_timesteps": len(frames), "num_gt_ids": len(truth_ids), "num_tracker_ids": len(answer_ids),
                "num_gt_dets": sum(len(t) for t, _ in frames), "num_tracker_dets": sum(len(a) for _, a in frames),
                "gt_ids": [numpy.array([truth_ids[t[0]] for t in truths], dtype=int) for truths, _ in frames],
                "tracker_ids": [numpy.array([answer_ids[a[0]] for a in answers], dtype=int) for _, answers in frames],
                "similarity_scores": [space["Boxes"]._calculate_box_ious(boxes(t), boxes(a)) for t, a in frames]}
        for metric, result in zip(metrics, results):
            result[number] = metric.eval_sequence(data)
    return tuple(metric.combine_sequences(result) for metric, result in zip(metrics, results))


def aot(place, flights, work):
    """The summary of Amazon's code for all detections."""
    samples, found, clock = {}, [], 0
    for f, frames in enumerate(flights):
        name = f"flight{f:03d}"
        entities = []
        for i, (truths, answers) in enumerate(frames):
            clock += 100_000_000
            image = f"{clock:020d}{name}.png"
            common = {"time": clock, "flight_id": name, "img_name": image, "blob": {"frame": i}}
            for id, box, reach, above in truths:
                blob = {"frame": i} if reach is None else {"frame": i, "range_distance_m": reach}
                entities.append({**common, "id": f"{'Bird' if reach is None else 'Airplane'}{id:03d}", "bb": list(box), "blob": blob,
                                 "labels": {"is_above_horizon": above}})
            if not truths:
                entities.append({**common, "labels": {}})
            found.append({"img_name": image, "detections": [
                {"n": "airborne", "x": b[0] + b[2] / 2, "y": b[1] + b[3] / 2, "w": b[2], "h": b[3], "s": s, "track_id": t}
                for t, b, s in answers]})
        samples[name] = {"metadata": {"resolution": {"width": 640, "height": 480}}, "entities": entities}
    for path, content in (("truth/groundtruth.json", {"samples": samples}), ("results/mine.json", found)):
        os.makedirs(os.path.dirname(os.path.join(work, path)), exist_ok=True)
        with open(os.path.join(work, path), "w", encoding="utf-8") as file:
            json.dump(content, file)
    metrics = os.path.join(place, "core", "metrics")
    done = subprocess.run([sys.executable, "-W", "ignore", os.path.join(metrics, "run_airborne_metrics.py"), "-d", work + "/truth",
                           "-r", work + "/results", "-s", work + "/summaries"], cwd=metrics, capture_output=True, text=True)
    summaries = [p for p in os.listdir(work + "/summaries")] if os.path.isdir(work + "/summaries") else []
    summaries = [p for p in summaries if p.endswith(".json")]
    if done.returncode != 0 or not summaries:
        raise AssertionError("Amazon's code failed: " + done.stderr[-2000:])
    with open(os.path.join(work, "summaries", summaries[0]), encoding="utf-8") as file:
        return json.load(file)
