# SPDX-License-Identifier: Apache-2.0
"""What was measured as Markdown, and pictures of what trainings miss and take for an aircraft."""

import pathlib

import cv2
import numpy as np

import measure
import trainings

SIDE, TIMES, COLUMNS, MOST = 48, 2, 10, 40  # px of a picture that is shown, its enlargement, and how many
LEAST_STEP, LEAST_SHARE = 8, 0.3  # a part that is brighter or darker than its surroundings: grey levels, and share of the larger of both steps
RING_PX = 6


def number(value):
    return "-" if value is None or value != value else f"{value:.3f}"


def shown(one):
    text = number(one["value"])
    if one.get("interval"):
        text += " ({:.2f} to {:.2f})".format(*one["interval"])
    return text


def words_of(row):
    others = "birds and multirotors count neither way" if row["ignoring"] else "birds and multirotors are false alarms"
    if not row["clips_without"]:
        others = "every detection elsewhere is a false alarm"
    return (f"{row['kind']}, {row['part']}, {row['set']} ({row['camera']} camera): {row['aircraft']} in {row['images']} images, {row['clips']} clips "
            f"with and {row['clips_without']} without; {others}")


def whole_rows(rows):
    text = ""
    for row in rows:
        text += f"\n### {words_of(row)}\n\n| trained on | AP by centre | recall at 0.1 false alarms an image | at 1 | AP of each seed |\n|---|---|---|---|---|\n"
        for name, one in row["trainings"].items():
            seeds = ", ".join(number(value) for value in one["ap"]["seeds"])
            text += f"| {trainings.TRAININGS[name].words} | {shown(one['ap'])} | {shown(one['recall_0.1'])} | {shown(one['recall_1'])} | {seeds} |\n"
        ratios = "; ".join(f"{name} {shown(ratio)}" for name, ratio in row["ratios"].items())
        text += f"\nRatios of AP: {ratios}.\n" if ratios else ""
    return text


def part_rows(rows):
    """By size and horizon: recall at both rates."""
    if not rows:
        return ""
    names = list(rows[0]["trainings"])
    text = "\n## By size and horizon: AP by centre; recall at 0.1 and at 1 false alarm an image\n\n| set | kind | part | aircraft | "
    text += " | ".join(trainings.TRAININGS[name].words for name in names) + " |\n|---|---|---|---:|" + "---|" * len(names) + "\n"
    for row in rows:
        cells = ["{}; {}, {}".format(*(number(row["trainings"][name][key]["value"]) for key in ("ap", "recall_0.1", "recall_1"))) for name in names]
        text += f"| {row['set']} | {row['kind']} | {row['part']} | {row['aircraft']} | " + " | ".join(cells) + " |\n"
    return text


def error_rows(errors):
    text = ("\n## What is missed and what is taken for an aircraft, at 1 false alarm an image, first seed\n\n"
            f"| set | kind | others | trained on | missed | false alarms | by what they are | over {measure.LARGE_PX} px |\n|---|---|---|---|---:|---:|---|---:|\n")
    for row in errors:
        for name, one in row["trainings"].items():
            kinds = ", ".join(f"{what} {count}" for what, count in sorted(one["by"].items(), key=lambda pair: -pair[1])) or "-"
            others = "count neither way" if row["ignoring"] else "are false alarms"
            text += (f"| {row['set']} | {row['kind']} | {others} | {trainings.TRAININGS[name].words} | {one['misses']} of {row['aircraft']} | "
                     f"{one['false_alarms']} | {kinds} | {one['large']} |\n")
    return text


def text_of(result, arguments):
    rows = result["rows"]
    clips = "held back" if arguments.held_back is not None else "looked at"
    length = f"{arguments.steps} steps" if arguments.steps else f"{arguments.minutes:g} minutes"
    text = (f"# Clips {clips}\n\n{result['seeds']} seed(s) of each training; {length}, {arguments.frames} frames with aircraft and {arguments.negatives} without. "
            f"In brackets: 95 % intervals by {result['draws']} draws of clips; with one clip there is none.\n\n## As a whole\n")
    return text + whole_rows([row for row in rows if row["part"] == "all"]) + part_rows([row for row in rows if row["part"] != "all"]) + error_rows(result["errors"])


def look_of(grey, box):
    """"dark", "bright", "both" or "faint": which parts an aircraft has beside its surroundings."""
    x, y, width, height = (int(round(v)) for v in box)
    around = grey[max(0, y - RING_PX):y + height + RING_PX, max(0, x - RING_PX):x + width + RING_PX].astype(float)
    inside = grey[max(0, y):y + height, max(0, x):x + width].astype(float)
    if not inside.size or around.size <= inside.size:
        return "faint"
    level = (around.sum() - inside.sum()) / (around.size - inside.size)
    bright, dark = inside.max() - level, level - inside.min()
    least = max(LEAST_STEP, LEAST_SHARE * max(bright, dark))
    return "both" if min(bright, dark) > least else "bright" if bright > least else "dark" if dark > least else "faint"


def greys_of(places, reals, arguments):
    """{(set, clip, index): grey} of the images; each clip is decoded once."""
    clips = {(real.name, clip.name): clip for real in reals for clip in real.clips}
    wanted = {}
    for image in places:
        wanted.setdefault((image.set, image.clip), set()).add(image.index)
    greys = {}
    for key, indices in wanted.items():
        frames = trainings.frames_tested(clips[key], arguments.every)
        for index, grey in zip(sorted(indices), clips[key].grey([frames[index] for index in sorted(indices)])):
            greys[key + (index,)] = grey.copy()
    return greys


def looks_of(images, reals, arguments):
    """{(set, clip, index, place among its objects): look}, from the pictures."""
    greys = greys_of([image for image in images if image.objects], reals, arguments)
    return {(image.set, image.clip, image.index, place): look_of(greys[image.set, image.clip, image.index], one.box)
            for image in images for place, one in enumerate(image.objects)}


def look_rows(images, found, reals, arguments):
    """Recall at 0.1 false alarms an image by what an aircraft looks like before its background, first seed."""
    looks = looks_of(images, reals, arguments)
    rows = [row for row in measure.rows_of(images, {real.name: real.source.targets for real in reals})
            if row.key["part"] == "all" and (row.key["ignoring"] or not row.key["clips_without"])]
    names = list(found)
    text = ("\n## By look: recall at 0.1 false alarms an image, first seed\n\n| set | kind | parts beside the background | aircraft | "
            + " | ".join(trainings.TRAININGS[name].words for name in names) + " |\n|---|---|---|---:|" + "---:|" * len(names) + "\n")
    for row in rows:
        answers = measure.answers_to(row, found, arguments)
        missed = {name: {(image.clip, image.index, id(thing)) for image, thing in measure.errors_at(row, answers[name][0], 0.1)[0]} for name in names}
        asked = [(looks[image.set, image.clip, image.index, place], (image.clip, image.index, id(thing)))
                 for image, flags in zip(row.images, row.flags) for place, (thing, flag) in enumerate(zip(image.objects, flags)) if not flag]
        for look in ("dark", "bright", "both", "faint"):
            some = [key for one, key in asked if one == look]
            if some:
                cells = [number(1 - sum(key in missed[name] for key in some) / len(some)) for name in names]
                text += f"| {row.key['set']} | {row.key['kind']} | {look} | {len(some)} | " + " | ".join(cells) + " |\n"
    return text


def patch_of(grey, box):
    padded = cv2.copyMakeBorder(grey, SIDE, SIDE, SIDE, SIDE, cv2.BORDER_REPLICATE)
    x, y = (int(round(v)) for v in np.asarray(box[:2]) + np.asarray(box[2:]) / 2 + SIDE / 2)
    x, y = (min(max(0, v), limit - SIDE) for v, limit in zip((x, y), padded.shape[::-1]))
    return np.repeat(np.repeat(padded[y:y + SIDE, x:x + SIDE], TIMES, 0), TIMES, 1)


def spread(places):
    """At most MOST of them, evenly."""
    return [places[k * len(places) // MOST] for k in range(MOST)] if len(places) > MOST else places


def sheet_of(patches):
    patches = patches + [np.full_like(patches[0], 255)] * (-len(patches) % COLUMNS)
    return np.concatenate([np.concatenate(patches[k:k + COLUMNS], 1) for k in range(0, len(patches), COLUMNS)])


def write_pictures(images, found, reals, arguments):
    """OUT/pictures/SET-KIND-TRAINING-misses.png and -false-alarms.png at one false alarm an image, first seed. They show the sets' footage."""
    sheets = {}
    for row in measure.rows_of(images, {real.name: real.source.targets for real in reals}):
        if row.key["part"] != "all" or row.key["ignoring"]:
            continue
        for name, seeds in measure.answers_to(row, found, arguments).items():
            misses, alarms = measure.errors_at(row, seeds[0], max(measure.FALSE_ALARMS))
            stem = f"{row.key['set']}-{row.key['kind']}-{name}"
            sheets[stem + "-misses"] = spread([(image, thing.box) for image, thing in misses])
            sheets[stem + "-false-alarms"] = spread([(image, box) for image, box, _ in alarms])
    greys = greys_of([image for places in sheets.values() for image, _ in places], reals, arguments)
    folder = pathlib.Path(arguments.out) / "pictures"
    folder.mkdir(exist_ok=True)
    for stem, places in sheets.items():
        (folder / f"{stem}.png").unlink(missing_ok=True)
        if places:
            cv2.imwrite(str(folder / f"{stem}.png"), sheet_of([patch_of(greys[image.set, image.clip, image.index], box) for image, box in places]))
