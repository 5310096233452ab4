# SPDX-License-Identifier: Apache-2.0
"""Judges that say which of two aircraft is the real one, each asked about a clip that it has not seen.

A judge learns from clips and then gives, for a clip, a matrix: how much rather the real aircraft of frame i (row) is the real one than the
inserted aircraft of frame j (column). Above 0 it is right. The share of all cells in which it is right is the area under the curve (Mann
and Whitney 1947), the share of the diagonal that of the pairs (two-alternative forced choice: both of one frame). Neither is folded: a
judge that is wrong counts as wrong.
"""

import cv2
import numpy as np
from joblib import Parallel, delayed
from sklearn.ensemble import ExtraTreesClassifier

SIDE = 48        # px of the square that the network sees at 1x
MOST_SHIFT = 3   # px by which a training picture is moved
STEPS = 120      # of training, whatever the number of clips
BATCH = 32       # pairs
CODES = 32       # code values that are 1 to the network
BOOTSTRAP = 2000  # draws


def equal_weights(parts):
    """Every clip counts alike, however many pairs it has."""
    return np.concatenate([np.full(len(part), 1 / len(part)) for part in parts]) * np.mean([len(part) for part in parts])


def learn_trees(clips, seed):
    """Extremely randomised trees (Geurts et al. 2006) that see one aircraft at a time. A number that an aircraft lacks is 0 to them. Among so
    few clips many weak votes find more than boosting, which takes the few numbers that part the clips that it has seen."""
    parts = [np.nan_to_num(clip).reshape(-1, clip.shape[2]) for clip in clips]
    model = ExtraTreesClassifier(300, min_samples_leaf=5, random_state=seed)
    model.fit(np.concatenate(parts), np.concatenate([np.tile([1, 0], len(clip)) for clip in clips]), equal_weights(parts))

    def preference(clip):
        real, made = (model.predict_proba(np.nan_to_num(clip[:, i]))[:, 1] for i in (0, 1))
        return real[:, None] - made[None, :]
    return preference


def patch_of(picture):
    """The middle of a picture for the network, less its rim's colour."""
    colour = cv2.cvtColor(picture, cv2.COLOR_RGB2YCrCb).astype(np.float32)
    rim = np.concatenate([colour[0], colour[-1], colour[:, 0], colour[:, -1]])
    colour = (colour - np.median(rim, axis=0)) / CODES
    side, want = colour.shape[0], SIDE + 2 * MOST_SHIFT
    if side < want:
        before = (want - side) // 2
        colour = cv2.copyMakeBorder(colour, before, want - side - before, before, want - side - before, cv2.BORDER_CONSTANT, value=(0, 0, 0))
    begin = (colour.shape[0] - want) // 2
    return colour[begin:begin + want, begin:begin + want].transpose(2, 0, 1)


def network():
    from torch import nn  # not at hand everywhere, and slow to load

    def block(inputs, outputs, stride):
        return [nn.Conv2d(inputs, outputs, 3, stride, 1), nn.BatchNorm2d(outputs), nn.ReLU()]
    return nn.Sequential(*block(3, 16, 2), *block(16, 32, 1), *block(32, 32, 2), nn.AdaptiveAvgPool2d(3), nn.Flatten(), nn.Dropout(0.3),
                         nn.Linear(32 * 9, 1))


def learn_network(clips, seed):
    """A small convolutional network that scores one aircraft, trained so that the real one of a pair has the larger score (Burges et al.
    2005, RankNet). A clip is (pairs, 2, 3, height, width)."""
    import torch
    torch.set_num_threads(1)  # the same sums on every machine
    torch.manual_seed(seed)
    dice = np.random.default_rng(seed)
    model = network()
    optimizer = torch.optim.AdamW(model.parameters(), weight_decay=1e-2)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, 4e-3, total_steps=STEPS)
    for _ in range(STEPS):
        y, x = dice.integers(0, 2 * MOST_SHIFT + 1, 2)
        chosen = [clip[dice.integers(len(clip))] for clip in (clips[k] for k in dice.integers(len(clips), size=BATCH))]
        batch = torch.from_numpy(np.stack(chosen)[..., y:y + SIDE, x:x + SIDE].copy())
        if dice.random() < 0.5:
            batch = batch.flip(-1)
        scores = model(batch.flatten(0, 1)).view(-1, 2)
        optimizer.zero_grad()
        torch.nn.functional.softplus(scores[:, 1] - scores[:, 0]).mean().backward()
        optimizer.step()
        schedule.step()
    model.eval()

    def preference(clip):
        middle = torch.from_numpy(clip[..., MOST_SHIFT:MOST_SHIFT + SIDE, MOST_SHIFT:MOST_SHIFT + SIDE].copy())
        with torch.no_grad():
            both = sum(model(side.flatten(0, 1)).view(-1, 2) for side in (middle, middle.flip(-1))).numpy()
        return both[:, :1] - both[None, :, 1]
    return preference


def right(preference):
    return float(np.mean(preference > 0) + np.mean(preference == 0) / 2)


def asked(learn, clips, i, seed):
    """Area and share of pairs of clip i, by a judge of the others."""
    preference = learn(clips[:i] + clips[i + 1:], seed)(clips[i])
    return right(preference), right(np.diagonal(preference))


def interval(values, seed, statistic=np.mean):
    """Of a value a clip, with 95 % by bootstrap over the clips (Efron 1979)."""
    values = np.asarray(values, float)
    drawn = np.random.default_rng(seed).integers(0, len(values), (BOOTSTRAP, len(values)))
    low, high = np.percentile(statistic(values[drawn], axis=1), (2.5, 97.5))
    return {"value": float(statistic(values)), "low": float(low), "high": float(high)}


def draws_of_names(clips, draws, seed):
    """Which clips' two aircraft go by each other's names. All or none is what was found, and is not drawn."""
    dice = np.random.default_rng(seed)
    drawn = []
    while len(drawn) < draws:
        swapped = dice.random(clips) < 0.5
        if 0 < swapped.sum() < clips:
            drawn.append(swapped)
    return drawn


def against(found, by_chance):
    return {"mean": float(np.mean(by_chance)), "low": float(np.min(by_chance)), "high": float(np.max(by_chance)),
            "draws": len(by_chance), "as_high": int(np.sum(np.array(by_chance) >= found))} if len(by_chance) else None


def verdict(name, learn, clips, draws, seed):
    """What a judge is right in, and what it would be if nothing were common to the inserted aircraft of several clips: a permutation of
    names by clip (Fisher 1935). A clip's pairs are one draw, since they show the same two aircraft: they are never permuted by themselves."""
    namings = [np.zeros(len(clips), bool)] + draws_of_names(len(clips), draws, seed)
    jobs = [([clip[:, ::-1] if swap else clip for clip, swap in zip(clips, naming)], i) for naming in namings for i in range(len(clips))]
    answers = np.array(Parallel(n_jobs=-1)(delayed(asked)(learn, [c.copy() for c in named], i, seed) for named, i in jobs))
    answers = answers.reshape(len(namings), len(clips), 2)
    result = {"name": name}
    for k, key in enumerate(("area", "pairs")):
        result[key] = {**interval(answers[0, :, k], seed), "clips": answers[0, :, k].tolist()}
        result[key]["by_chance"] = against(result[key]["value"], answers[1:, :, k].mean(axis=1))
    return result


def telling(clips, names, seed, draws=400):
    """How well each number alone tells: its area, mean over the clips, which of the two has more of it taken from the other clips. And what
    the best of so many numbers has by chance."""
    areas = np.array([[single_area(clip[:, 0, f], clip[:, 1, f]) for clip in clips] for f in range(len(names))]) - 0.5

    def means(areas):
        others = np.sign(areas.sum(axis=1, keepdims=True) - areas)
        return 0.5 + (others * areas).mean(axis=1)
    found = means(areas)
    best = [means(areas * np.where(swapped, -1, 1)).max() for swapped in draws_of_names(len(clips), draws, seed)]
    order = np.argsort(-found, kind="stable")
    ranked = [{"name": names[f], "area": float(found[f]), "real_has": "more" if areas[f].mean() > 0 else "less"} for f in order]
    return {"ranked": ranked, "best_by_chance": {"median": float(np.median(best)), "high": float(np.percentile(best, 95))}}


def single_area(real, made):
    real, made = real[~np.isnan(real)], made[~np.isnan(made)]
    return right(real[:, None] - made[None, :]) if len(real) and len(made) else 0.5
