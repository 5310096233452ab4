# SPDX-License-Identifier: Apache-2.0
"""The gaps between inserted and real aircraft, and all that judges found, as Markdown."""

import numpy as np

from clips import EDGE, LONGEST
from judges import interval

# What a person can act on, by the names that compare gives them.
MEASURES = (EDGE, "spectrum, share above 1/4 cycle/px", "noise inside, code values", "saturation", "strongest red (Cr), code values",
            "brightest decile, code values", "unsteadiness of the centre, px")
CLASSES = ((6, 10), (10, 20), (20, np.inf))  # px of the real aircraft's longest side
LEAST_PAIRS = 5  # of a clip in a class


def peak_contrast(clip, low, high):
    """Medians of both, to the side where the real one's is larger; None where the clip has too few pairs of that size."""
    size = clip.measures[LONGEST][:, 0]
    sides = [clip.measures[f"peak contrast {side}, code values"][(size > low) & (size <= high)] for side in ("above", "below")]
    if len(sides[0]) < LEAST_PAIRS:
        return None
    return max((tuple(np.median(side, axis=0)) for side in sides), key=lambda both: abs(both[0]))


def gaps_of(clips, seed):
    """Made over real, in the median over the clips that have both."""
    found = {name: [clip.summary.get(name) for clip in clips] for name in MEASURES}
    found["peak contrast, code values"] = [peak_contrast(clip, 0, np.inf) for clip in clips]
    for low, high in CLASSES:
        words = f"over {low} to {high} px" if high < np.inf else f"over {low} px"
        found[f"peak contrast, longest side {words}"] = [peak_contrast(clip, low, high) for clip in clips]
    gaps = []
    for name, both in found.items():
        both = np.array([one for one in both if one and None not in one and one[0] != 0]).reshape(-1, 2)
        gap = {"name": name, "clips": len(both)}
        if len(both):
            gap.update(real=float(np.median(both[:, 0])), inserted=float(np.median(both[:, 1])),
                       made_over_real=interval(both[:, 1] / both[:, 0], seed, np.median))
        gaps.append(gap)
    return gaps


def shown(one):
    return f"{one['value']:.3f} ({one['low']:.3f} to {one['high']:.3f})"


def chance(one):
    drawn = one["by_chance"]
    if not drawn:
        return "-"
    return f"{drawn['mean']:.3f} ({drawn['low']:.3f} to {drawn['high']:.3f}; {drawn['as_high']} of {drawn['draws']} as high)"


def gaps_table(stages):
    """stages: (name, gaps) each."""
    text = "| inserted over real, median over clips (95 %) | real | " + " | ".join(name for name, _ in stages) + " | clips |\n"
    text += "|---|---:|" + "---|" * len(stages) + "---:|\n"
    for k, gap in enumerate(stages[0][1]):
        cells = [shown(gaps[k]["made_over_real"]) if gaps[k]["clips"] else "-" for _, gaps in stages]
        text += f"| {gap['name']} | {gap['real']:.3g} | " if gap["clips"] else f"| {gap['name']} | - | "
        text += " | ".join(cells) + f" | {gap['clips']} |\n"
    return text


def judges_rows(judges, before=""):
    return "".join(f"|{before} {one['name']} | {shown(one['area'])} | {chance(one['area'])} | {shown(one['pairs'])} | {chance(one['pairs'])} |\n"
                   for one in judges)


JUDGES_HEAD = "judge | area (95 % over clips) | by chance (range of draws) | right pairs (95 % over clips) | by chance |\n"


def single_words(single, most=5):
    return ", ".join(f"{one['name']} {one['area']:.2f} (real has {one['real_has']})" for one in single["ranked"][:most])


def text_of(verdict):
    text = f"| {JUDGES_HEAD}|---|---|---|---|---|\n" + judges_rows(verdict["judges"])
    text += "".join(f"\n{words}\n" for words in verdict["left_out"])
    text += "\n| clip | pairs | " + " | ".join(one["name"] for one in verdict["judges"]) + " |\n|---|---:|" + "---:|" * len(verdict["judges"]) + "\n"
    for i, clip in enumerate(verdict["clips"]):
        cells = [f"{one['area']['clips'][i]:.3f}, {one['pairs']['clips'][i]:.3f}" for one in verdict["judges"]]
        text += f"| {clip['name']} | {clip['pairs']} | " + " | ".join(cells) + " |\n"
    single = verdict["single"]
    text += (f"\nWhat alone tells most: {single_words(single)}. The best of {len(single['ranked'])} numbers has "
             f"{single['best_by_chance']['median']:.2f} by chance, {single['best_by_chance']['high']:.2f} in one draw of 20.\n\n")
    return text + gaps_table([("inserted / real", verdict["gaps"])])
