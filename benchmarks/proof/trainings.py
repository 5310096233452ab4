# SPDX-License-Identifier: Apache-2.0
"""What the same network is trained on, one training after another, and what each then finds.

Network and loop are those of benchmarks/train_detector.py. Every training sees the same number of frames with aircraft, the same frames of birds
and multirotors without one, the same steps and the same seed.
"""

import argparse
import dataclasses
import json
import os
import pathlib
import time
import warnings
import zlib
from typing import Callable

import airtruth
import cv2
import numpy as np
import torch
import train_detector
from torch.nn import functional

import catalogue
from sets import Refused
from splits import split_of

REALISM = {"auto": True, "fallback": True}
TENTH = 10
REPEATED = 5      # how often a real frame beside composites is drawn for one of theirs
PASTE_GAIN = (0.5, 1.5)   # of a pasted aircraft's brightness
PASTE_TRIES = 20
LEAST_SCORE = 0.02
MOST_DETECTIONS = 30  # of a frame
NMS_OVERLAP = 0.3
SHIPPED_SCORE, SHIPPED_CONFIDENT_SCORE = 0.35, 0.5
THREADS = 1  # the same sums on every machine


class Material:
    """The real clips and backgrounds that trainings are made of, read once."""

    def __init__(self, real, options):
        self.real, self.options, self.split = real, options, split_of(real)
        if not self.split.train:
            raise Refused(f"{real.name} has no clips to train on; there is a split of ground-real alone")
        self.train = [clip for clip in real.clips if clip.name in self.split.train]
        self.background_clips = [clip for clip in real.clips if clip.name in self.split.backgrounds]
        if not self.train or not self.background_clips:
            raise Refused(f"{real.name}: the folder holds none of the clips that are trained on, or none without an aircraft")
        self.negatives = None

    def drawn(self, clips, count):
        """(grey, frame) of so many frames, evenly over the clips and over each."""
        each = [count // len(clips) + (k < count % len(clips)) for k in range(len(clips))]
        for clip, some in zip(clips, each):
            wanted = [frame for frame in clip.frames if frame.objects]
            some = min(some, len(wanted))
            chosen = [wanted[k * len(wanted) // some] for k in range(some)]
            yield from zip((grey.copy() for grey in clip.grey(chosen)), chosen)

    def with_aircraft(self, count):
        for grey, frame in self.drawn(self.train, count):
            boxes = np.array([one.box for one in frame.objects], np.float32).reshape(-1, 4)
            large = boxes[:, 2:].max(axis=1) > train_detector.MOST_PX if len(boxes) else np.zeros(0, bool)
            yield grey, boxes[~large], np.concatenate([boxes[large], frame.ignored.astype(np.float32)])

    def without(self):
        """Frames of birds and multirotors, which are background."""
        if self.negatives is None:
            self.negatives = [grey for grey, _ in self.drawn(self.background_clips, self.options.negatives)]
        return self.negatives

    def realism(self):
        """Of the backgrounds: what a clip does not show is the set's camera's, where airtruth knows that."""
        with airtruth.VideoReader(self.background_clips[0].video) as video:
            size = video.info.width, video.info.height
        known = any((one.name, (one.width, one.height)) == (self.real.source.camera, size) for one in airtruth.camera_profiles())
        return {**REALISM, **({"profile": self.real.source.camera} if known else {})}

    def stream(self, realism, seed, masks=False):
        if self.options.catalogue:
            if not realism:
                raise Refused("a catalogue states its realism itself; matte and cut-and-paste need the one of this command")
            return airtruth.Stream(self.options.catalogue, seed=seed, threads=1)
        text = catalogue.of_clips([(clip.name, os.path.abspath(clip.video)) for clip in self.background_clips], self.realism() if realism else None)
        text["stream"]["masks"] = masks
        return airtruth.Stream(text, seed=seed, threads=1)


def samples(stream, count):
    """(sample's last frame, boxes, ignored) of the first so many."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a clip does not show is left out, as the page of realism says
        for index in range(count):
            frame = stream[index].frames[-1]
            boxes, ignored = train_detector.boxes_of([vars(intruder) for intruder in frame.intruders])
            yield frame, boxes, ignored


def real(material, frames, seed):
    for one in material.with_aircraft(material.options.frames):
        frames.add(*one)


def add_samples(frames, stream, count):
    for frame, boxes, ignored in samples(stream, count):
        frames.add(frame.full_range_gray, boxes, ignored)


def composites(material, frames, seed):
    add_samples(frames, material.stream(True, seed), material.options.frames)


def matte(material, frames, seed):
    add_samples(frames, material.stream(False, seed), material.options.frames)


def cut_and_paste(material, frames, seed):
    """Rendered aircraft cut from one picture and pasted into another anywhere, hard at the edges, at any brightness (Dwibedi, Misra and Hebert
    2017, without blending): neither light, nor sharpness, nor place is matched."""
    dice = np.random.default_rng(seed)
    below = material.without()
    for frame, boxes, _ in samples(material.stream(False, seed, masks=True), material.options.frames):
        picture = below[dice.integers(len(below))].copy()
        pasted = []
        shown = frame.full_range_gray
        mask = frame.masks.max(axis=0) > 127 if len(frame.masks) else None
        for box in boxes.astype(int):
            x, y, width, height = box
            patch, shape = shown[y:y + height, x:x + width].astype(np.float32), mask[y:y + height, x:x + width]
            if dice.random() < 0.5:
                patch, shape = patch[:, ::-1], shape[:, ::-1]
            height, width = patch.shape
            if height >= picture.shape[0] or width >= picture.shape[1]:
                continue
            place = [int(dice.integers(picture.shape[axis] - size)) for axis, size in enumerate((height, width))]
            under = picture[place[0]:place[0] + height, place[1]:place[1] + width]
            under[shape] = np.clip(patch * dice.uniform(*PASTE_GAIN), 0, 255)[shape]
            pasted.append((place[1], place[0], width, height))
        frames.add(picture, np.array(pasted, np.float32).reshape(-1, 4))


def mixed(material, frames, seed):
    composites(material, frames, seed)
    for one in material.with_aircraft(max(1, material.options.frames // TENTH)):
        for _ in range(REPEATED):
            frames.add(*one)


def shipped(material, frames, seed):
    """The plain matte over the clips, and a quarter as many over virtual flights: clouds, ground below, an own aircraft in view; and as many
    frames of these flights without an aircraft."""
    matte(material, frames, seed)
    for negatives in (0, 1):
        add_samples(frames, airtruth.Stream(catalogue.of_flights(negatives), seed=seed, threads=1), material.options.frames // 4)


@dataclasses.dataclass
class Training:
    words: str
    frames: Callable  # adds the frames with aircraft
    network: type = train_detector.Network
    ships: bool = False  # whether the network is written for `airtruth detect`


TRAININGS = {
    "real": Training("real clips of the camera", real),
    "composites": Training("composites from the stream", composites),
    "matte": Training("plain matte, without realism", matte),
    "cut-and-paste": Training("cut and paste, nothing matched", cut_and_paste),
    "mixed": Training("composites and a tenth of the real", mixed),
    "shipped": Training("the network that ships", shipped, train_detector.FastNetwork, ships=True),
}
COMPARED = [name for name, training in TRAININGS.items() if not training.ships]


def options_of(folder, options, seed):
    """What the loop of train_detector takes."""
    return argparse.Namespace(output=str(folder / "network"), sets=[], every=1, batch=options.batch, seed=seed, minutes=options.minutes,
                              steps=options.steps, threads=THREADS)


def written(path, value):
    unfinished = path.with_name(path.name + ".part")
    unfinished.write_text(json.dumps(value) + "\n", encoding="utf-8")
    os.replace(unfinished, path)


def stated(name, options, seed):
    """What a training that is there already must have been made with."""
    text = json.dumps(catalogue.of_clips([], None)) + (json.dumps(catalogue.of_flights(0)) if TRAININGS[name].ships else "")
    rules = f"{zlib.crc32(text.encode()):08x}"
    return {"frames": options.frames, "negatives": options.negatives, "batch": options.batch, "steps": options.steps,
            "minutes": None if options.steps else options.minutes, "seed": seed, "train_on": options.train_on,
            "least_contrast": train_detector.LEAST_CONTRAST,
            "catalogue": "" if name == "real" else str(options.catalogue or f"of this command, {rules}")}


def network_of(name, seed, material, options):
    """The trained network; trained now unless it is there already."""
    folder = pathlib.Path(options.out) / "trainings" / f"{name}-{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    weights, record = folder / "network.pt", folder / "training.json"
    torch.set_num_threads(THREADS)
    torch.manual_seed(seed)
    training = TRAININGS[name]
    network = training.network().to(memory_format=torch.channels_last)
    if record.exists():
        known = json.loads(record.read_text(encoding="utf-8"))
        if known["stated"] != stated(name, options, seed):
            raise Refused(f"{folder} was trained otherwise ({known['stated']}); give another OUT or remove it")
        network.load_state_dict(torch.load(weights))
        return network.eval()
    begun = time.process_time()
    frames = train_detector.Frames()
    training.frames(material, frames, seed)
    for grey in material.without():
        frames.add(grey, train_detector.NO_BOXES)
    made = time.process_time()
    print(f"{name}, seed {seed}: {frames.words()}, made in {made - begun:.0f} s", flush=True)
    loop = options_of(folder, options, seed)
    steps = train_detector.train(network.to(options.device), frames, loop)
    network.to("cpu")
    torch.save(network.state_dict(), str(weights) + ".part")
    os.replace(str(weights) + ".part", weights)
    if training.ships:
        train_detector.write(network, str(folder / "aircraft.onnx"), SHIPPED_SCORE, SHIPPED_CONFIDENT_SCORE)
    written(record, {"stated": stated(name, options, seed), "words": frames.words(), "steps": steps, "made_s": made - begun,
                     "trained_s": time.process_time() - made})
    checkpoint = pathlib.Path(train_detector.checkpoint_of(loop))
    checkpoint.unlink(missing_ok=True)
    return network


def kept(boxes, scores):
    """Greedy suppression of what overlaps something of a higher score."""
    chosen = []
    for index in np.argsort(-scores, kind="stable"):
        if not chosen or airtruth.evaluate.overlap(np.repeat(boxes[index][None], len(chosen), 0), boxes[chosen]).max() < NMS_OVERLAP:
            chosen.append(index)
        if len(chosen) == MOST_DETECTIONS:
            break
    return chosen


class Detector:
    """A trained network that answers on whole pictures, compiled for each size: two fifths faster, and the same to 3e-6."""

    def __init__(self, network):
        self.network, self.of_size = network.eval(), {}

    def __call__(self, pixels):
        size = tuple(pixels.shape)
        with torch.no_grad(), warnings.catch_warnings():
            warnings.simplefilter("ignore", torch.jit.TracerWarning)
            if size not in self.of_size:
                self.of_size[size] = torch.jit.freeze(torch.jit.trace(self.network, pixels))
            return self.of_size[size](pixels)


def detections_in(detector, grey):
    """Boxes (n x 4) and scores of a picture, as docs/formats/detector-model.md reads the answer."""
    multiple, stride = train_detector.MULTIPLE, train_detector.STRIDE
    height, width = (-(-side // multiple) * multiple for side in grey.shape)
    whole = cv2.copyMakeBorder(grey, 0, height - grey.shape[0], 0, width - grey.shape[1], cv2.BORDER_REPLICATE)
    pixels = torch.from_numpy(whole.astype(np.float32) / 255)[None, None].to(memory_format=torch.channels_last)
    logits, offset, size = detector(pixels)
    heat = torch.sigmoid(logits)
    peaks = heat * (heat == functional.max_pool2d(heat, 3, 1, 1))
    scores, cells = peaks.flatten().topk(min(4 * MOST_DETECTIONS, peaks.numel()))
    scores, cells = (part[scores > LEAST_SCORE].numpy() for part in (scores, cells))
    rows, columns = np.divmod(cells, heat.shape[3])
    centre = (np.stack([columns, rows], 1) + offset[0][:, rows, columns].numpy().T) * stride
    sides = np.exp(np.clip(size[0][:, rows, columns].numpy().T, 0, 7))
    boxes = np.concatenate([centre - sides / 2, sides], axis=1).reshape(-1, 4).astype(float)
    chosen = kept(boxes, scores)
    return boxes[chosen], scores[chosen]


def frames_tested(clip, every):
    return clip.frames[::every]


def detections_of(network, clips, options, path):
    """{clip: [(boxes, scores) of each frame tested]}; detected now unless it is there already."""
    if path.exists():
        known = json.loads(path.read_text(encoding="utf-8"))
        if known["every"] == options.every and set(known["clips"]) == {clip.name for clip in clips}:
            return {name: [(np.array(b, float).reshape(-1, 4), np.array(s, float)) for b, s in frames] for name, frames in known["clips"].items()}
    detector, found = Detector(network), {}
    for clip in clips:
        found[clip.name] = [detections_in(detector, grey) for grey in clip.grey(frames_tested(clip, options.every))]
    path.parent.mkdir(parents=True, exist_ok=True)
    written(path, {"every": options.every, "clips": {name: [(np.round(b, 2).tolist(), np.round(s, 5).tolist()) for b, s in frames]
                                                     for name, frames in found.items()}})
    return detections_of(network, clips, options, path)
