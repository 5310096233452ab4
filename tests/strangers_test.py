# SPDX-License-Identifier: Apache-2.0
"""People's own files are read right, or what was not read is said. strangers_test.py AIRTRUTH [CASE...]

The files are those of AIRTRUTH_SHARED/strangers, a folder for each kind of fault with a README of what is right. Each case below
runs the program on one of them. A case that is listed in OPEN is known to be wrong still; it must then fail, so that the list
cannot go stale.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile

SHARED = os.environ.get("AIRTRUTH_SHARED")
# Cases whose fault is not mended.
OPEN = set()


class Case:
    """What a case works with: the program, the folder of its files, and a scratch folder."""

    def __init__(self, program, files, scratch):
        self.program = program
        self.files = files
        self.scratch = scratch
        self.count = 0

    def path(self, *names):
        return os.path.join(self.files, *names)

    def run(self, *arguments, code=0):
        process = subprocess.run([self.program, *arguments], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                 env=dict(os.environ, XDG_CACHE_HOME=self.scratch), cwd=self.scratch)
        assert process.returncode == code, f"{' '.join(arguments)}: code {process.returncode}\n{process.stdout}{process.stderr}"
        return process.stdout + process.stderr

    def imported(self, format, source, *options):
        """Imports; returns what was said, and the clips by name: the first line of labels.jsonl and its frames."""
        self.count += 1
        out = os.path.join(self.scratch, f"set{self.count}")
        said = self.run("dataset", "import", self.path(source), "--format", format, "--out", out, *options)
        clips = {}
        for folder in sorted(os.listdir(os.path.join(out, "sequences"))):
            where = os.path.join(out, "sequences", folder)
            if os.path.isdir(where):
                with open(os.path.join(where, "labels.jsonl"), encoding="utf-8") as file:
                    lines = [json.loads(line) for line in file]
                clips[folder] = {"head": lines[0], "frames": lines[1:], "folder": where}
        self.set = out
        return said, clips


def boxes(frame):
    return [label["box_px"] for label in frame["labels"]]


def pictures(clip):
    with open(os.path.join(clip["folder"], "pictures.txt"), encoding="utf-8") as file:
        return file.read().split("\n")[:-1]


def grey_of(path):
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "gray", "-"], stdout=subprocess.PIPE,
                         check=True).stdout
    return sum(raw) / len(raw)


def expect_own_pictures(clips, frames):
    """Grey level 10 i in a picture means that its box has x = i."""
    seen = []
    for clip in clips.values():
        for frame, path in zip(clip["frames"], pictures(clip), strict=True):
            i = round(grey_of(path) / 10)
            assert [box[0] for box in boxes(frame)] == [i], (path, i, boxes(frame))
            seen.append(i)
    assert len(seen) == frames, (len(seen), frames)
    return seen


def own_pictures(format, source, clips=1):
    def case(it):
        _, read = it.imported(format, source)
        assert len(read) == clips, list(read)
        frames = sum(len(clip["frames"]) for clip in read.values())
        seen = expect_own_pictures(read, frames)
        return seen
    return case


def ordered(format, source):
    def case(it):
        seen = own_pictures(format, source)(it)
        assert seen == sorted(seen), seen
    return case


def only(clips):
    assert len(clips) == 1, list(clips)
    return next(iter(clips.values()))


def coco_ids(it):
    it.imported("coco", "zero")
    it.run("evaluate", it.set, it.path("zero_perfect.json"), "--detections", "-o", "e")
    assert ap_of(it) == 1.0, ap_of(it)


def ultralytics(it):
    for results in ("ultra.json", "ultra_str.json"):
        it.imported("coco", "gaps_coco")
        it.run("evaluate", it.set, it.path(results), "--detections", "-o", "e" + results)
        assert ap_of(it, "e" + results) == 1.0, ap_of(it, "e" + results)


def all_empty(it):
    it.imported("mot", "gt")
    it.run("evaluate", it.set, it.path("empty"), "--detections", "-o", "e", "--no-page")
    with open(os.path.join(it.scratch, "e", "detection.json"), encoding="utf-8") as file:
        (detector,) = json.load(file)["detectors"]
    assert (detector["sequences"], detector["detections"], detector["average_precision"]["ap"]) == (3, 0, 0), detector


def ap_of(it, folder="e"):
    with open(os.path.join(it.scratch, folder, "detection.json"), encoding="utf-8") as file:
        return json.load(file)["detectors"][0]["average_precision"]["ap"]


def rate_of_import(it):
    _, clips = it.imported("mot", "mot_spaces")
    assert only(clips)["head"]["frame_rate_hz"] == 10


def track_of_cvat(it):
    said, clips = it.imported("coco", "coco_nullseg")
    label = only(clips)["frames"][0]["labels"][0]
    assert label["track"] == 3 and label["occluded"] is True, label
    assert "without a track" not in said, said


def official_coco(it):
    said, clips = it.imported("coco", "coco")
    assert "captions" in said, said
    assert clips


def corners(it):
    _, clips = it.imported("csv", "l_xyxy.csv")
    assert boxes(only(clips)["frames"][0]) == [[1, 2, 2, 2]]


def polygon_track(it):
    _, clips = it.imported("cvat", "cvat_poly")
    shown = {frame["frame"]: boxes(frame) for frame in only(clips)["frames"] if frame["labels"]}
    assert shown == {2: [[10, 10, 10, 6]], 3: [[10, 10, 10, 6]]}, shown


def project(it):
    _, clips = it.imported("cvat", "export_project")
    assert len(clips) == 3, list(clips)
    for clip in clips.values():
        assert [frame["picture"] for frame in clip["frames"]] == ["img0.jpg", "img1.jpg"], clip["frames"]
        assert boxes(clip["frames"][0])[0] == [0, 2, 4, 2], clip["frames"]


def rotation(it):
    _, clips = it.imported("cvat", "cvat_rot")
    shown = [boxes(frame) for frame in only(clips)["frames"] if frame["labels"]]
    assert len(shown) == 1 and all(abs(a - b) < 1e-9 for a, b in zip(shown[0][0], [23, 7, 4, 30])), shown


def byte_order_mark_of_mot(it):
    _, clips = it.imported("mot", "mot_crlf_bom")
    assert sum(len(frame["labels"]) for frame in only(clips)["frames"]) > 0


def duplicate_id(it):
    out = os.path.join(it.scratch, "set")
    said = it.run("dataset", "import", it.path("mot_dupid"), "--format", "mot", "--out", out, code=2)
    assert "gt.txt:2" in said, said


def mot15(it):
    said, clips = it.imported("mot", "mot15_3d")
    for frame in only(clips)["frames"]:
        for label in frame["labels"]:
            assert label["visible"] is None and label["range_m"] is None, label
    assert "columns 8 to 10" in said, said


def two_targets(it):
    _, clips = it.imported("otb", "otb_jog")
    assert {label["track"] for frame in only(clips)["frames"] for label in frame["labels"]} == {1, 2}


def yolo_of_cvat(it):
    _, clips = it.imported("yolo", "cvat_yolo")
    clip = only(clips)
    assert len(clip["frames"]) == 3 and len(pictures(clip)) == 3
    assert {label["category"] for frame in clip["frames"] for label in frame["labels"]} == {"plane"}


def byte_order_mark_of_yolo(it):
    _, clips = it.imported("yolo", "bomy")
    assert sum(len(frame["labels"]) for clip in clips.values() for frame in clip["frames"]) > 0


def missing_text(it):
    _, clips = it.imported("yolo", "yolo_missing")
    clip = only(clips)
    assert len(clip["frames"]) == 5 and len(pictures(clip)) == 5
    labels = [label for frame in clip["frames"] for label in frame["labels"]]
    assert len(labels) == 2 and {label["category"] for label in labels} <= {"plane", "bird"}, labels


def mixed_sizes(it):
    said, clips = it.imported("yolo", "yolo_mixed")
    frames = only(clips)["frames"]
    assert boxes(frames[1]) == [[48, 36, 32, 24]], frames[1]
    assert "differ in size" in said, said


def roboflow(it):
    _, clips = it.imported("yolo", "robo_yolo")
    assert len(clips) == 2 and all(len(clip["frames"]) == len(pictures(clip)) == 3 for clip in clips.values()), clips


def capital_ending(it):
    _, clips = it.imported("yolo", "upper_yolo")
    assert len(pictures(only(clips))) == len(only(clips)["frames"]) > 0


def lens(name):
    """Renders nothing: `motion` with the lens on a picture of its size reads the file as every command does."""
    def read(it, size, code=0):
        it.run("synth", "-o", "v.mp4", "--frames", "2", "--width", str(size[0]), "--height", str(size[1]))
        return it.run("motion", "v.mp4", "--model", "rotation", "--lens", it.path(name), "-o", "m.csv", code=code)
    return read


def lens_said(name, size, words, code=2):
    def case(it):
        said = lens(name)(it, size, code)
        assert words in said, said
    return case


def lens_read(name, size):
    def case(it):
        lens(name)(it, size)
    return case


def listed_size(it):
    # On a picture of half the size the focal length is half as long.
    it.run("lens", "crop", it.path("cv_size_seq.yml"), "--size", "640x360", "-o", "half.yml")
    with open(os.path.join(it.scratch, "half.yml"), encoding="utf-8") as file:
        text = file.read()
    assert "data: [ 250.0, 0.0, 319.75" in text, text


def log(name, positions, *words):
    def case(it):
        said = it.run("log", "show", it.path(name))
        assert f"positions: {positions}," in said, said
        for word in words:
            assert word in said, said
    return case


def model(name, words=None):
    """The model is shown; what is not read of it is said, and nothing else."""
    def case(it):
        said = it.run("aircraft", "show", it.path(*name.split("/")), "-o", "sheet.jpg")
        assert (words in said) if words else ("warning" not in said), said
    return case


def case_of_letters(it):
    said = it.run("aircraft", "show", it.path("test1.3ds"), "-o", "sheet.jpg")
    assert "1 textures" in said and "IMAGE1" not in said, said


SCENE = """name = "s"
[background]
video = "{video}"
{more}
[lens]
{lens}
[[intruder]]
aircraft = "738/738-Delta"
waypoints_ned_m = [[280, -60, -175], [300, 60, -178]]
speed_mps = 60
[output]
video = "mkv"
"""


CATALOGUE = """name = "c"
[[background]]
name = "sky"
video = "v.mp4"
lens = { vertical_fov_deg = 45 }
[[random]]
count = 3
frame_count = 2
aircraft = ["738/738-Delta"]
"""


def rendered(it, video, lens="vertical_fov_deg = 45", more="", code=0):
    with open(os.path.join(it.scratch, "s.toml"), "w", encoding="utf-8") as file:
        file.write(SCENE.format(video=it.path(video), lens=lens, more=more))
    return it.run("render", "s.toml", "--out", "out", "--overwrite", code=code)


def edit_list(it):
    assert "ends early" not in rendered(it, "f_editlist.mp4")


def high_range(it):
    assert "HLG" in rendered(it, "hlg.mkv", code=2)
    rendered(it, "sdr.mkv")


def picture_rate(it):
    assert "frame_rate_hz" in rendered(it, "", code=2)
    rendered(it, "", more="frame_rate_hz = 10")
    with open(os.path.join(it.scratch, "out", "s", "truth.jsonl"), encoding="utf-8") as file:
        frames = [json.loads(line) for line in file]
    times = [frame["time_s"] for frame in frames if "time_s" in frame]
    assert [round(t, 9) for t in times] == [0, 0.1, 0.2], times


def interlaced(it):
    assert "interlaced" in rendered(it, "f_interlaced.mp4")


def open_group(it):
    it.run("motion", it.path("og_cut.ts"), "-o", "m.csv")
    with open(os.path.join(it.scratch, "m.csv"), encoding="utf-8") as file:
        assert sum(1 for line in file if line[0].isdigit()) == 60


def turned(it):
    said = rendered(it, "f_rot90.mp4", lens=f'file = "{it.path("gf320.json")}"', code=2)
    assert "turned by 90 degrees" in said and "lens crop" not in said, said


def pixel_shape(it):
    rendered(it, "f_sar43.mp4")
    with open(os.path.join(it.scratch, "out", "s", "truth.jsonl"), encoding="utf-8") as file:
        text = file.read()
    assert "217.27" in text and "289.70" in text, text[:600]


def network(it, name, output, classes, side, code=0):
    """Runs a network over a made video; returns what was said, and the detections of its first frame."""
    model = shutil.copy(it.path(name), it.scratch)
    with open(os.path.splitext(model)[0] + ".json", "w", encoding="utf-8") as file:
        json.dump({"format": "airtruth detector model 1", "output": output, "score_threshold": 0.01,
                   "classes": [f"class{i}" for i in range(classes)],
                   "input": {"layout": "rgb", "scale": 1 / 255, "fit": "letterbox", "width": side, "height": side}}, file)
    it.run("synth", "-o", "v.mp4", "--frames", "2", "--width", str(side), "--height", str(side), "--overwrite")
    shutil.rmtree(os.path.join(it.scratch, "found"), ignore_errors=True)
    return it.run("detect", "v.mp4", "--detector", "onnx:" + model, "-o", "found", code=code)


def external_data(it):
    said = network(it, "v5_external.onnx", {"kind": "yolov5", "boxes": "output0"}, 2, 64, code=2)
    assert "second file, 'v5_external.onnx.data'" in said, said


def yolov8(it):
    output = {"kind": "yolov8", "boxes": "output0"}
    network(it, "v8simple_op12.onnx", output, 2, 64)
    with open(os.path.join(it.scratch, "found", "v8simple_op12", "v.detections.json"), encoding="utf-8") as file:
        found = json.load(file)
    # The network ends with a sigmoid: numbers from 0 to 1, the score the highest of the two classes.
    assert found and all(0 < value < 1 for one in found for value in (one["score"], *one["bbox"][2:])), found
    assert "1 x 7 x boxes" in network(it, "v8simple_op12.onnx", output, 3, 64, code=2)
    said = network(it, "v8simple_op12.onnx", {"kind": "yolov5", "boxes": "output0"}, 2, 64, code=2)
    assert 'kind "yolov8"' in said, said


def throttle(it):
    with open(os.path.join(it.scratch, "c.toml"), "w", encoding="utf-8") as file:
        file.write(CATALOGUE)
    it.run("synth", "-o", "v.mp4", "--frames", "2", "--width", "160", "--height", "120")
    for option, array in (("--sbatch=--array=0-399%4", "0-2%4"), ("--array-size=2%1", "0-1%1"), ("--array-size=%2", "0-2%2")):
        shutil.rmtree(os.path.join(it.scratch, "set"), ignore_errors=True)
        it.run("dataset", "submit", "c.toml", "--out", "set", "--slurm", "--dry-run", option)
        with open(os.path.join(it.scratch, "set", "slurm", "work.sh"), encoding="utf-8") as file:
            assert f"#SBATCH --array={array}\n" in file.read(), option


CASES = {
    "det-rate-of-import-mot": rate_of_import,
    "ev-all-empty": all_empty,
    "ev-coco-ids-from-0": coco_ids,
    "ev-ultralytics-predictions": ultralytics,
    "lab-coco-cvat-trackid": track_of_cvat,
    "lab-coco-official-folder-real": official_coco,
    "lab-coco-roboflow-names": ordered("coco", "roboflow_coco"),
    "lab-coco-two-videos": own_pictures("coco", "two_videos_coco", clips=2),
    "lab-coco-uuid-names": own_pictures("coco", "uuid_coco"),
    "lab-coco-visdrone-names": own_pictures("coco", "visdrone_coco"),
    "lab-csv-xyxy": corners,
    "lab-cvat-images-left": ordered("cvat", "left_cvat"),
    "lab-cvat-images-unpadded": ordered("cvat", "unpadded_cvat"),
    "lab-cvat-polygon-track": polygon_track,
    "lab-cvat-project-real": project,
    "lab-cvat-rotation": rotation,
    "lab-mot-bom": byte_order_mark_of_mot,
    "lab-mot-duplicate-id": duplicate_id,
    "lab-mot15-3d": mot15,
    "lab-otb-two-targets": two_targets,
    "lab-yolo-11-cvat": yolo_of_cvat,
    "lab-yolo-bom": byte_order_mark_of_yolo,
    "lab-yolo-missing-txt": missing_text,
    "lab-yolo-mixed-sizes": mixed_sizes,
    "lab-yolo-roboflow-layout": roboflow,
    "lab-yolo-uppercase-jpg": capital_ending,
    "lens-distortion-singular": lens_said("dc_key.yaml", (640, 480), "Distortion_Coefficient"),
    "lens-fisheye-no-flag": lens_said("cv_fisheye_4x1_noflag.yml", (1280, 720), "holds four numbers"),
    "lens-gyroflow-tele": lens_read("Blackmagic_Pocket Cinema Camera 6K Pro_Contax Zeiss 50mm f1.4__6k_16by9_6144x3456-24.00fps.json",
                                    (1024, 576)),
    "lens-image-size-list": listed_size,
    "lens-kalibr": lens_read("kalibr_camchain.yaml", (752, 480)),
    "lens-omni": lens_said("omni_matrix.yaml", (752, 480), "omni"),
    "log-bin-nan-start": log("bin_nanpos.bin", 96, "altitude is nan"),
    "log-dji-embedded-subtitles": log("dji_embedded.mp4", 60),
    "log-gopro-karma-real": log("gp_karma.mp4", 47, "33.125"),
    "log-gpx-one-without-ele": log("oneele_missing.gpx", 29, "<ele>"),
    "log-gpx-one-without-time": log("onemissing_time.gpx", 29, "<time>"),
    "log-srt-bad-latitude": log("badlat.srt", 59, "947"),
    "log-srt-comma-decimals": log("comma_decimals.srt", 60, "latitude: 47 to 47.00059"),
    "log-srt-one-bad": log("teleport.srt", 59, "out of reach"),
    "log-ulog-corrupt-middle": log("ulg_corrupt_mid.ulg", 30, "damaged from byte"),
    "log-ulog-instance-1": log("ulg_gps_instance1.ulg", 32),
    "log-ulog-q_nan_first": log("q_nan_first.ulg", 13, "quaternion"),
    "log-ulog-q_zero_first": log("q_zero_first.ulg", 13, "quaternion"),
    "mod-emissive": model("emissive.glb"),
    "mod-gazebo-layout-real": model("meshes/x8_elevon_left.dae"),
    "mod-texture-case-real": case_of_letters,
    "mod-texture-missing": model("winpath.obj", "Red Paint.PNG is not there"),
    "mod-texture-transform-real": model("textureTransform/TextureTransformTest.gltf", "turned or scaled"),
    "mod-vertex-colours-glb": model("vcol_f32.glb", "vertices"),
    "mod-vertex-colours-u8": model("vcol_u8.glb", "vertices"),
    "onnx-external-data": external_data,
    "onnx-yolov8-layout": yolov8,
    "slurm-throttle": throttle,
    "vid-edit-list": edit_list,
    "vid-hlg": high_range,
    "vid-image-folder-rate": picture_rate,
    "vid-interlaced": interlaced,
    "vid-open-gop-cut": open_group,
    "vid-rotated-calibration": turned,
    "vid-sar-4-3": pixel_shape,
    "lens-unknown-distortion-key": lens_said("coeffs_key.yaml", (640, 480), "holds four numbers"),
}


def main():
    program = os.path.abspath(sys.argv[1])
    if not SHARED or not os.path.isdir(os.path.join(SHARED, "strangers")):
        print("skipped: AIRTRUTH_SHARED/strangers is not there")
        sys.exit(77)
    wrong = []
    for name in sys.argv[2:] or CASES:
        with tempfile.TemporaryDirectory() as scratch:
            try:
                CASES[name](Case(program, os.path.join(os.path.abspath(SHARED), "strangers", name), scratch))
                fault = None
            except Exception as error:  # a missing file or key is a failed case as well
                fault = f"{type(error).__name__}: {error}"
        print(f"{name}: {'right' if fault is None else fault}", flush=True)
        if (fault is None) == (name in OPEN):
            wrong.append(name)
    print(f"{len(CASES)} cases, {len(OPEN)} known to be wrong; unexpected: {wrong or 'none'}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
