# SPDX-License-Identifier: Apache-2.0
"""Trains a tiny detector on aircraft put into your own video, and evaluates it on samples of another seed (or video) that it never saw:
python3 examples/train_from_stream.py VIDEO [--test VIDEO] [--fov DEG] [--steps N]. Needs airtruth (docs/python.md) and python3-torch."""
import argparse
import torch
from torch.nn import BatchNorm2d, Conv2d, InstanceNorm2d, ReLU, Sequential, functional
import airtruth

SIDE, CELL = 192, 4  # px: of a picture, and of a cell of the answer: logit of heat, offset x and y in cells, logarithm of width and height

def loader_of(video, fov, seed, length):
    stream = {"stream": {"size_px": [SIDE, SIDE], "intruders": [1, 2]},
              "background": [{"name": "own", "video": video, "lens": {"vertical_fov_deg": fov}, "motion": {"model": "none"},
                              "realism": {"auto": True, "fallback": True},
                              "camera": {"position_ned_m": [0, 0, -500], "velocity_ned_mps": [40, 0, 0]}}],
              "random": [{"aircraft": ["738/*", "c172/*"], "size_px": [12, 60], "azimuth_deg": [-fov / 2, fov / 2],
                          "elevation_deg": [-fov / 3, fov / 3], "negatives": 0.2}]}
    data = airtruth.torch.Dataset(airtruth.Stream(stream, seed=seed), length, channels="gray", dtype="float32")
    return torch.utils.data.DataLoader(data, batch_size=16, num_workers=2, collate_fn=airtruth.torch.collate)

def layer(inputs, outputs, stride=1, dilation=1):
    return Sequential(Conv2d(inputs, outputs, 3, stride, dilation, dilation), BatchNorm2d(outputs), ReLU())

def loss_of(answer, targets):
    cells, heat, off = torch.arange(SIDE // CELL), torch.zeros_like(answer[:, 0]), 0.0
    for k, box in ((k, box) for k, target in enumerate(targets) for box in target["boxes"]):
        centre, size = (box[:2] + box[2:]) / 2 / CELL, box[2:] - box[:2]
        (x, y), (wide, high) = centre.long().tolist(), (size / CELL / 6).clamp(min=0.7)
        heat[k] = torch.maximum(heat[k], torch.exp(-((cells - x) / wide) ** 2 / 2 - ((cells[:, None] - y) / high) ** 2 / 2))
        off = off + (answer[k, 1:, y, x] - torch.cat([centre - centre.floor(), size.log()])).abs().sum()
    p, peak = torch.sigmoid(answer[:, 0]).clamp(1e-4, 1 - 1e-4), heat == 1  # focal loss of Law and Deng 2018, equation 1
    return (off - torch.where(peak, (1 - p) ** 2 * p.log(), (1 - heat) ** 4 * p ** 2 * (1 - p).log()).sum()) / peak.sum().clamp(min=1)

def boxes_of(answer):  # x, y, width, height and the scores of the ten highest peaks
    heat = torch.sigmoid(answer[0])
    scores, at = (heat * (heat == functional.max_pool2d(heat[None], 3, 1, 1)[0])).flatten().topk(10)
    offset, size = answer[1:].flatten(1)[:, at].split(2)
    centre = (torch.stack([at % heat.shape[1], at // heat.shape[1]]) + offset) * CELL
    return torch.cat([centre - size.exp() / 2, size.exp()]).T.numpy(), scores.numpy()

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("video"), parser.add_argument("--test", help="another video to evaluate on")
    parser.add_argument("--fov", type=float, default=50, help="vertical field of view of the camera in degrees")
    parser.add_argument("--steps", type=int, default=400)
    options = parser.parse_args()
    network = Sequential(InstanceNorm2d(1, 1e-3), layer(1, 16, 2), layer(16, 32, 2), layer(32, 32, 1, 2), layer(32, 32, 1, 4), Conv2d(32, 5, 1))
    network[-1].bias.data[:] = torch.tensor([-4.6, 0.5, 0.5, 3, 2])  # at first a peak in a hundred cells, and boxes of 20 x 7 px
    optimiser = torch.optim.Adam(network.parameters())
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 5e-3, options.steps)
    for step, (pictures, targets) in enumerate(loader_of(options.video, options.fov, 1, options.steps * 16)):
        loss = loss_of(network(pictures), targets)
        optimiser.zero_grad(), loss.backward(), optimiser.step(), schedule.step()
        if step % 20 == 0: print(f"step {step}: loss {loss.item():.3f}", flush=True)
    truth, found = [], []
    for pictures, targets in loader_of(options.test or options.video, options.fov, 2, 160):
        truth += [torch.cat([target["boxes"][:, :2], target["boxes"][:, 2:] - target["boxes"][:, :2]], 1).numpy() for target in targets]
        found += [boxes_of(answer) for answer in network.eval()(pictures).detach()]
    ap = airtruth.evaluate.average_precision(truth, [boxes for boxes, _ in found], [scores for _, scores in found])
    print(f"{ap.curve_50.truths} aircraft in {len(truth)} pictures: AP at IoU 0.5 is {ap.ap_50:.3f}, by centre distance {ap.ap_centre:.3f}")
