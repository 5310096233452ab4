#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trains a small aircraft detector on data sets that airtruth made, and writes it as ONNX for `airtruth detect`.

    python3 benchmarks/train_detector.py SET... -o aircraft.onnx [--minutes 12]
    python3 benchmarks/train_detector.py CATALOGUE.toml -o aircraft.onnx     new pictures at each step, from a training stream
    python3 benchmarks/train_detector.py SET... -o better.onnx --negatives VIDEO --mine-with onnx:aircraft.onnx

A stream needs crops of 280 px or more in [stream] size_px, and `negatives = 0.5` of its rules. Needs the package airtruth (docs/python.md), and python3-torch, python3-onnx
and python3-opencv of Debian 12. The network is fully convolutional and sees one grey picture;
it answers, for every cell of 4 x 4 px, how likely an aircraft's centre lies there, where in the cell, and how large it is
(Zhou, Wang and Kraehenbuehl 2019, "Objects as Points"). Beside aircraft.onnx it writes aircraft.json, which says how its input and
output are to be read (docs/formats/detector-model.md). The labels are the covered boxes of the sequences' truth.
"""

import argparse
import collections
import itertools
import json
import math
import os
import pathlib
import sys
import time

import cv2
import numpy as np
import torch
from torch import nn
from torch.nn import functional

import airtruth

STRIDE = 4          # px in a cell of the output
MULTIPLE = 8        # the input's sides are multiples of it: the network halves them three times
CROP = 192          # px: side of the square that a training step sees; twice the largest aircraft that it learns
MIN_SIGMA = 0.7     # cells: width of the peak of the smallest aircraft, so that a peak is wider than its sampling
NEGATIVE_PX = 280   # px: side of the picture about a false alarm; a crop that is scaled by 0.7 fits into it
MOST_PX = 128       # px: aircraft that are longer are left out of training
LEAST_CONTRAST = 25  # code values: who labels real video does not see less (docs/proof.md, "Faint aircraft")
MOST_WAITING = 256  # samples of a stream without an aircraft that wait to be used: 20 MB of crops of 280 px
MOST_DRAWN = 1000   # samples of a stream in a row without an aircraft that a network can learn: its catalogue has none
NO_BOXES = np.zeros((0, 4), np.float32)


def block(inputs, outputs, stride=1, dilation=1):
    return nn.Sequential(nn.Conv2d(inputs, outputs, 3, stride, dilation, dilation, bias=False), nn.BatchNorm2d(outputs))


class Residual(nn.Module):
    def __init__(self, channels, dilation=1):
        super().__init__()
        self.first = block(channels, channels, dilation=dilation)
        self.second = block(channels, channels)

    def forward(self, x):
        return functional.relu(x + self.second(functional.relu(self.first(x))))


class Network(nn.Module):
    """Grey pictures (n, 1, h, w) in 0..1 to heat (n, 1, h/4, w/4) as logits, offset (n, 2, ...) in cells, log of size in px."""

    def __init__(self, half=12, fine=24, coarse=48, dilations=(1, 2, 4)):
        super().__init__()
        self.to_2 = block(1, half, stride=2)
        self.to_4 = block(half, fine, stride=2)
        self.fine = Residual(fine)
        self.to_8 = block(fine, coarse, stride=2)
        self.context = nn.Sequential(*[Residual(coarse, dilation) for dilation in dilations])
        self.narrow = nn.Conv2d(coarse, fine, 1)
        self.joined = Residual(fine)
        self.head = nn.Conv2d(fine, fine, 3, padding=1)
        self.heat = nn.Conv2d(fine, 1, 1)
        self.offset = nn.Conv2d(fine, 2, 1)
        self.size = nn.Conv2d(fine, 2, 1)
        nn.init.constant_(self.heat.bias, -math.log(99))  # a peak in one cell of a hundred at first (Lin et al. 2017)
        nn.init.constant_(self.size.bias, math.log(20))

    def forward(self, x):
        fine = self.fine(functional.relu(self.to_4(functional.relu(self.to_2(x)))))
        coarse = self.context(functional.relu(self.to_8(fine)))
        x = self.joined(fine + functional.interpolate(self.narrow(coarse), scale_factor=2, mode="nearest"))
        x = functional.relu(self.head(x))
        return self.heat(x), self.offset(x), self.size(x)


class FastNetwork(Network):
    """The same with fewer channels and layers, in a quarter of the time."""

    def __init__(self):
        super().__init__(half=8, fine=8, coarse=32, dilations=(2, 4))


class ForExport(nn.Module):
    def __init__(self, network):
        super().__init__()
        self.network = network

    def forward(self, x):
        heat, offset, size = self.network(x)
        return torch.sigmoid(heat), offset, size


class Frames:
    """Grey frames with the boxes of their aircraft, and boxes of what counts neither as aircraft nor as background."""

    def __init__(self):
        self.pictures, self.boxes, self.ignored = [], [], []

    def add_set(self, folder, every):
        data = airtruth.DataSet(folder)
        for name in data.names:
            for frame in itertools.islice(data[name], 0, None, every):
                self.add(frame.full_range_gray, *boxes_of([vars(intruder) for intruder in frame.intruders]))

    def add(self, picture, boxes, ignored=NO_BOXES):
        boxes, ignored = without_faint(picture, boxes, ignored)
        self.pictures.append(picture)
        self.boxes.append(boxes)
        self.ignored.append(ignored)

    def draw(self, with_aircraft, random):
        for _ in range(20):
            index = random.integers(len(self.pictures))
            if not with_aircraft or len(self.boxes[index]):
                break
        return self.pictures[index], self.boxes[index], self.ignored[index]

    def place(self):
        """Where the drawing is, for a checkpoint."""
        return None

    def go_to(self, place):
        pass

    def words(self):
        return f"{len(self.pictures)} frames, {sum(map(len, self.boxes))} boxes"


class Streamed:
    """The same from a training stream, whose samples are new each time. What has no aircraft waits for a crop that need not have one: with
    `negatives = 0.5` in the catalogue half of the crops of a training are about an aircraft, and half have none."""

    def __init__(self, catalogue, seed):
        self.catalogue = catalogue
        self.stream = airtruth.Stream(pathlib.Path(catalogue), seed=seed)
        self.index = 0  # of the sample that is drawn next
        self.waiting = collections.deque(maxlen=MOST_WAITING)  # (index, sample) of those without an aircraft

    def read(self, index):
        sample = self.stream[index]
        frame = sample.frames[-1]
        boxes, ignored = boxes_of([vars(intruder) for intruder in frame.intruders])
        for some in (boxes, ignored):
            some[:, :2] -= sample.crop[:2]
        return frame.full_range_gray, *without_faint(frame.full_range_gray, boxes, ignored)

    def draw(self, with_aircraft, random):
        if not with_aircraft and self.waiting:
            return self.waiting.popleft()[1]
        for _ in range(MOST_DRAWN):
            sample = self.read(self.index)
            self.index += 1
            if not with_aircraft or len(sample[1]):
                return sample
            self.waiting.append((self.index - 1, sample))
        refuse(f"{self.catalogue}: {MOST_DRAWN} samples in a row show no aircraft; expected fewer negatives, or aircraft that are larger")

    def place(self):
        return [self.index, *(index for index, _ in self.waiting)]

    def go_to(self, place):
        self.index = place[0]
        self.waiting.extend((index, self.read(index)) for index in place[1:])

    def words(self):
        return "a stream"


class WithNegatives:
    """The same, and crops about what a detector takes for an aircraft in videos without one: a half of the crops that show no aircraft."""

    def __init__(self, frames, videos, detector):
        self.frames, self.pictures = frames, []
        for video in videos:
            for frame, alarms in airtruth.mine(video, detector=detector).frames():
                grey = frame.full_range_gray
                for alarm in alarms:
                    x, y, width, height = alarm.around(np.minimum(NEGATIVE_PX, grey.shape[::-1]), frame)
                    self.pictures.append(grey[y:y + height, x:x + width].copy())

    def place(self):
        return self.frames.place()

    def go_to(self, place):
        self.frames.go_to(place)

    def draw(self, with_aircraft, random):
        if with_aircraft or not self.pictures or random.random() < 0.5:
            return self.frames.draw(with_aircraft, random)
        return self.pictures[random.integers(len(self.pictures))], NO_BOXES, NO_BOXES

    def words(self):
        return f"{self.frames.words()}, {len(self.pictures)} mined false alarms"


def boxes_of(intruders):
    boxes, ignored = [], []
    for intruder in intruders:
        if intruder["state"] != "visible" or intruder.get("object_class", "aircraft") != "aircraft":
            continue
        box = intruder.get("covered_box_px")
        if box is None or max(box[2:]) > MOST_PX or intruder.get("cut_by_frame", 0) > 0.5:
            ignored.append(intruder.get("visible_box_px") if box is None else box)
        else:
            boxes.append(box)
    return [np.array([b for b in some if b is not None], np.float32).reshape(-1, 4) for some in (boxes, ignored)]


def contrast(picture, box):
    """The largest difference in the box from the median of what surrounds it, in code values; infinite where nothing does."""
    low, high = np.round(box[:2]).astype(int), np.round(box[:2] + box[2:]).astype(int)
    rim = max(3, int(max(box[2:]) / 2))
    (left, top), (right, bottom) = np.maximum(low - rim, 0), np.minimum(high + rim, picture.shape[::-1])
    patch = picture[top:bottom, left:right].astype(np.float32)
    inside = np.zeros(patch.shape, bool)
    inside[max(low[1] - top, 0):max(high[1] - top, 0), max(low[0] - left, 0):max(high[0] - left, 0)] = True
    return np.abs(patch[inside] - np.median(patch[~inside])).max() if inside.any() and not inside.all() else math.inf


def without_faint(picture, boxes, ignored):
    """(boxes, ignored): an aircraft that hardly stands out counts neither as aircraft nor as background."""
    faint = np.array([contrast(picture, box) < LEAST_CONTRAST for box in boxes], bool)
    return boxes[~faint], np.concatenate([ignored, boxes[faint]])


def crop_of(frames, random):
    """A square of a frame at a random scale, mirrored at random: half of them about an aircraft."""
    with_aircraft = random.random() < 0.5
    picture, boxes, ignored = frames.draw(with_aircraft, random)
    scale = math.exp(random.uniform(math.log(0.7), math.log(1.4)))
    side = int(round(CROP / scale))
    side = min(side, *picture.shape)
    scale = CROP / side
    high = np.array([picture.shape[1] - side, picture.shape[0] - side])
    corner = random.integers(0, high + 1)
    if with_aircraft and len(boxes):
        box = boxes[random.integers(len(boxes))]
        centre = box[:2] + box[2:] / 2
        corner = np.clip(np.round(centre - side * random.uniform(0.1, 0.9, 2)).astype(int), 0, high)
    x, y = corner
    pixels = cv2.resize(picture[y:y + side, x:x + side], (CROP, CROP),
                        interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR).astype(np.float32) / 255

    def moved(some):
        some = some.copy()
        some[:, :2] -= corner
        return some * scale
    boxes, ignored = moved(boxes), moved(ignored)
    if random.random() < 0.5:
        pixels = pixels[:, ::-1]
        for some in (boxes, ignored):
            some[:, 0] = CROP - some[:, 0] - some[:, 2]
    return other_camera(pixels, random), boxes, ignored


def other_camera(pixels, random):
    """Another exposure, tone curve, sharpness and noise: one camera should not be learned."""
    pixels = np.clip(pixels, 0, 1) ** math.exp(random.uniform(-0.4, 0.4))
    pixels = pixels * random.uniform(0.6, 1.3) + random.uniform(-0.1, 0.1)
    if random.random() < 0.3:
        pixels = cv2.GaussianBlur(pixels, (0, 0), random.uniform(0.3, 0.9))
    if random.random() < 0.5:
        pixels = pixels + random.normal(0, random.uniform(0.001, 0.015), pixels.shape)
    return np.clip(pixels, 0, 1).astype(np.float32)


class Targets:
    """What the network should answer for the boxes of a crop."""

    def __init__(self, boxes, ignored):
        cells = CROP // STRIDE
        self.heat = np.zeros((cells, cells), np.float32)
        self.weight = np.ones((cells, cells), np.float32)
        self.places, self.offsets, self.sizes = [], [], []
        ys, xs = np.mgrid[0:cells, 0:cells]
        for x, y, w, h in ignored:
            self.without(x, y, w, h)
        for x, y, w, h in boxes:
            cx, cy = (x + w / 2) / STRIDE, (y + h / 2) / STRIDE
            column, row = int(math.floor(cx)), int(math.floor(cy))
            if not (0 <= column < cells and 0 <= row < cells):
                self.without(x, y, w, h)
                continue
            sigma_x, sigma_y = (max(MIN_SIGMA, side / STRIDE / 6) for side in (w, h))
            peak = np.exp(-((xs - column) / sigma_x) ** 2 / 2 - ((ys - row) / sigma_y) ** 2 / 2)
            self.heat = np.maximum(self.heat, peak.astype(np.float32))
            self.places.append((row, column))
            self.offsets.append((cx - column, cy - row))
            self.sizes.append((math.log(max(w, 1)), math.log(max(h, 1))))

    def without(self, x, y, w, h):
        low = [max(0, int(v // STRIDE)) for v in (x, y)]
        high = [max(0, int(math.ceil(v / STRIDE))) for v in (x + w, y + h)]
        self.weight[low[1]:high[1], low[0]:high[0]] = 0


def loss_of(network, batch):
    pixels, targets = batch
    device = next(network.parameters()).device
    logits, offset, size = network(torch.from_numpy(pixels).to(device, memory_format=torch.channels_last))  # a fifth faster on the CPU
    logits = logits[:, 0]
    heat = torch.from_numpy(np.stack([t.heat for t in targets])).to(device)
    weight = torch.from_numpy(np.stack([t.weight for t in targets])).to(device)
    # Penalty-reduced focal loss: Law and Deng 2018, equation 1, with alpha 2 and beta 4.
    p = torch.sigmoid(logits)
    at_peak = (heat == 1).float()
    positive = at_peak * (1 - p) ** 2 * functional.logsigmoid(logits)
    negative = (1 - at_peak) * (1 - heat) ** 4 * p ** 2 * functional.logsigmoid(-logits)
    peaks = max(1.0, float(at_peak.sum()))
    focal = -((positive + negative) * weight).sum() / peaks
    index = [(n, *place) for n, t in enumerate(targets) for place in t.places]
    if not index:
        return focal
    n, rows, columns = (torch.tensor(i, device=device) for i in zip(*index))
    told_offset = torch.tensor([o for t in targets for o in t.offsets], dtype=torch.float32, device=device)
    told_size = torch.tensor([s for t in targets for s in t.sizes], dtype=torch.float32, device=device)
    return (focal + functional.l1_loss(offset[n, :, rows, columns], told_offset)
            + functional.l1_loss(size[n, :, rows, columns], told_size))


def batch_of(frames, random, size):
    pixels, targets = [], []
    for _ in range(size):
        crop, boxes, ignored = crop_of(frames, random)
        pixels.append(crop[None])
        targets.append(Targets(boxes, ignored))
    return np.stack(pixels), targets


def checkpoint_of(options):
    """Beside the output; removed once that is written."""
    return options.output + ".checkpoint"


def refuse(words):
    """Ends the program for what the user gave."""
    print(f"train_detector: {words}", file=sys.stderr)
    sys.exit(2)


def given(options):
    """What a training that goes on must have in common with its beginning."""
    return [[os.path.abspath(folder) for folder in options.sets], options.every, options.batch, options.seed,
            *([[os.path.abspath(video) for video in options.negatives], options.mine_with] if getattr(options, "negatives", None) else [])]


def done(options, step, spent):
    """The share of the training that is done; 1 or more: all of it."""
    return step / options.steps if options.steps else spent / options.minutes


def save(network, optimiser, random, frames, options, spent, step):
    unfinished = checkpoint_of(options) + ".part"
    torch.save({"network": network.state_dict(), "optimiser": optimiser.state_dict(), "random": random.bit_generator.state,
                "place": frames.place(), "spent": spent, "step": step, "given": given(options)}, unfinished)
    os.replace(unfinished, checkpoint_of(options))


def train(network, frames, options):
    random = np.random.default_rng(options.seed)
    optimiser = torch.optim.AdamW(network.parameters(), lr=2e-3, weight_decay=1e-4)
    before, step, mean = 0.0, 0, None
    if os.path.exists(checkpoint_of(options)):
        state = torch.load(checkpoint_of(options), map_location="cpu", weights_only=True)
        if state["given"] != given(options) or "place" not in state:
            refuse(f"{checkpoint_of(options)} is of a training on other sets, or with another --every, --batch, --seed or version of this script; remove it to begin anew")
        network.load_state_dict(state["network"])
        optimiser.load_state_dict(state["optimiser"])
        random.bit_generator.state = state["random"]
        before, step = state["spent"], state["step"]
        frames.go_to(state["place"])
        print(f"goes on from {checkpoint_of(options)}: {before:.1f} min, step {step}", flush=True)
    begun, shown = time.process_time(), before
    network.train()
    while True:
        spent = before + (time.process_time() - begun) / 60 / options.threads
        share = done(options, step, spent)
        if share >= 1:
            break
        for group in optimiser.param_groups:  # a short rise, then half a cosine
            group["lr"] = 2e-3 * min(1, (step + 1) / 50) * (0.5 + 0.5 * math.cos(math.pi * share))
        loss = loss_of(network, batch_of(frames, random, options.batch))
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(network.parameters(), 5)
        optimiser.step()
        step += 1
        mean = loss.item() if mean is None else 0.98 * mean + 0.02 * loss.item()
        if spent - shown >= 0.5:
            shown = spent
            print(f"{spent:5.1f} min  step {step:5d}  loss {mean:.3f}", flush=True)
            save(network, optimiser, random, frames, options, spent, step)
    network.eval()
    return step


def write(network, path, score_threshold=0.2, confident_score=0.4):
    name = os.path.splitext(path)[0]
    unfinished = path + ".part"
    names = ["grey", "heat", "offset", "size"]
    torch.onnx.export(ForExport(network), torch.zeros(1, 1, 480, 640), unfinished, opset_version=11,
                      input_names=names[:1], output_names=names[1:],
                      dynamic_axes={name: {2: f"{name}_height", 3: f"{name}_width"} for name in names})  # onnxruntime refuses other sizes else
    description = {
        "format": "airtruth detector model 1",
        "input": {"layout": "grey", "scale": 1 / 255, "fit": "frame", "multiple_px": MULTIPLE},
        "output": {"kind": "heat_map", "heat": "heat", "offset": "offset", "size": "size", "size_scale": "log"},
        "classes": ["aircraft"],
        "score_threshold": score_threshold,
        "confident_score": confident_score,
        "nms_iou": 0.3,
    }
    with open(name + ".json", "w", encoding="utf-8") as out:
        json.dump(description, out, indent=2)
        out.write("\n")
    os.replace(unfinished, path)


def frames_of(options):
    frames = sets_of(options)
    return WithNegatives(frames, options.negatives, options.mine_with) if options.negatives else frames


def sets_of(options):
    if options.sets[0].endswith(".toml"):
        return Streamed(options.sets[0], options.seed)
    frames = Frames()
    for folder in options.sets:
        frames.add_set(folder, options.every)
    return frames


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sets", nargs="+", metavar="SET", help="folders of `airtruth dataset build`, or one catalogue with a table [stream]")
    parser.add_argument("--negatives", nargs="+", default=[], metavar="VIDEO", help="videos in which nothing flies: what a detector finds there is learned as background")
    parser.add_argument("--mine-with", default="network", metavar="DETECTOR", help="the detector, as of `airtruth detect` (default network); onnx:aircraft.onnx is the one that was trained before")
    parser.add_argument("-o", "--output", required=True, help="the ONNX file; a .json is written beside it, and until then every half minute of training a .checkpoint, from which the same command goes on")
    parser.add_argument("--minutes", type=float, default=12, help="processor time to train for, on each thread (default 12)")
    parser.add_argument("--steps", type=int, help="train for so many steps instead, whatever they take")
    parser.add_argument("--every", type=int, default=2, help="take every n-th frame (default 2): neighbours are alike")
    parser.add_argument("--batch", type=int, default=24, help="crops in a step (default 24)")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--device", choices=("cpu", "cuda"), default="cpu", help="what PyTorch trains on (default cpu)")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if not options.output.endswith(".onnx"):
        parser.error(f"the output is {options.output}; expected a name that ends in .onnx")
    if options.device == "cuda" and not torch.cuda.is_available():
        parser.error("--device cuda: PyTorch finds no such device here")
    torch.set_num_threads(options.threads)
    cv2.setNumThreads(1)
    torch.manual_seed(options.seed)
    if any(source.endswith(".toml") for source in options.sets) and len(options.sets) > 1:
        parser.error("a catalogue stands alone; expected one catalogue, or data sets")
    try:
        frames = frames_of(options)
    except airtruth.Error as error:
        refuse(error)
    network = Network().to(options.device, memory_format=torch.channels_last)
    print(f"{frames.words()}, {sum(p.numel() for p in network.parameters())} parameters", flush=True)
    step = train(network, frames, options)
    write(network.to("cpu"), options.output)
    if os.path.exists(checkpoint_of(options)):
        os.remove(checkpoint_of(options))
    print(f"{step} steps; wrote {options.output}")


if __name__ == "__main__":
    main()
