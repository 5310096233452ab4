#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Can a judge tell the inserted aircraft of comparisons from the real ones, and by what? /usr/bin/python3 -B benchmarks/judge COMMAND

    verdict COMPARISON... [-o verdict.json]   trees and a small network, each asked about a clip that it has not seen; gaps
    sheet COMPARISON... -o sheet.png          pairs in random order for people; which is which stands in sheet.key.csv
    score ANSWERS KEY                         how many of the answers are right

COMPARISON is a folder that `airtruth compare` left, one a clip. Needs python3-sklearn and python3-opencv of Debian; the network needs
python3-torch and is left out without it. How to read the numbers: docs/realism.md.
"""

import argparse
import csv
import importlib.util
import json
import os
import sys

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

NEEDS = "expected /usr/bin/python3 with Debian's python3-sklearn and python3-opencv"
try:
    import cv2
    import numpy as np

    import clips as comparisons
    import sheet
    from arguments import whole
    from clips import Refused
except ImportError as missing:
    sys.exit(f"judge: {missing}; {NEEDS}")


def verdict(arguments):
    if len(arguments.comparisons) < 3:
        raise Refused("a judge learns from other clips than it is asked about; expected three or more comparisons")
    import judges  # scikit-learn takes a second to load
    import tables
    clips, names = comparisons.read_clips(arguments.comparisons, arguments.pairs)
    if len({clip.name for clip in clips}) < len(clips):
        raise Refused("two comparisons have one name; a clip that is there twice is asked about by a judge that knows it")
    numbers = [clip.numbers for clip in clips]
    found, left_out = [], []
    found.append(judges.verdict("trees", judges.learn_trees, numbers, arguments.draws, arguments.seed))
    if arguments.no_network:
        left_out.append("The network is left out, as --no-network says.")
    elif importlib.util.find_spec("torch") is None:
        left_out.append("The network is left out: torch (Debian's python3-torch) is not installed.")
    else:
        patches = [np.stack([[judges.patch_of(picture) for picture in pair] for pair in clip.pictures]) for clip in clips]
        found.append(judges.verdict("network (CNN)", judges.learn_network, patches, arguments.network_draws, arguments.seed))
    told_by = [i for i, name in enumerate(names) if not name.startswith("HOG")]  # a cell of a histogram says nothing to a person
    result = {"clips": [{"name": clip.name, "pairs": len(clip.frames)} for clip in clips], "judges": found, "left_out": left_out,
              "single": judges.telling([clip[..., told_by] for clip in numbers], [names[i] for i in told_by], arguments.seed),
              "gaps": tables.gaps_of(clips, arguments.seed)}
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            json.dump(result, file, indent=1)
            file.write("\n")
    print(tables.text_of(result), end="")


def make_sheet(arguments):
    key_path = arguments.key or os.path.splitext(arguments.output)[0] + ".key.csv"
    for path in (arguments.output, key_path):
        if os.path.exists(path) and not arguments.overwrite:
            raise Refused(f"{path} exists already; --overwrite replaces it")
    if not arguments.output.endswith(".png"):
        raise Refused(f"{arguments.output} is no name of a sheet; expected one that ends in .png")
    clips = [comparisons.read_clip(folder, sys.maxsize) for folder in arguments.comparisons]
    picture, key = sheet.make_sheet(clips, arguments.each, arguments.seed)
    if not cv2.imwrite(arguments.output, cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)):
        raise Refused(f"{arguments.output} cannot be written")
    with open(key_path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([("pair", "real", "clip", "frame"), *key])
    print(f"{arguments.output}: {len(key)} pairs; which is which stands in {key_path}. Answers: a line a pair, as 3,left")


def score(arguments):
    right, total, low, high = sheet.score(arguments.answers, arguments.key, Refused)
    print(f"{right}/{total} right: {right / total:.3f} ({low:.3f} to {high:.3f}); 0.5 is chance")


def main():
    parser = argparse.ArgumentParser(prog="judge", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("verdict", help="what judges are right in, beside chance, and the gaps")
    command.set_defaults(run=verdict)
    command.add_argument("comparisons", nargs="+", metavar="COMPARISON")
    command.add_argument("-o", "--output", help="all of it as JSON")
    command.add_argument("--pairs", type=whole(2), default=40, help="of a clip at most, evenly over it (%(default)s)")
    command.add_argument("--draws", type=whole(0), default=20, help="of names by clip, for what chance gives trees (%(default)s)")
    command.add_argument("--network-draws", type=whole(0), default=5, help="the same for the network, which learns longer (%(default)s)")
    command.add_argument("--no-network", action="store_true", help="trees alone")
    command.add_argument("--seed", type=whole(0), default=1)
    command = commands.add_parser("sheet", help="pairs in random order for people")
    command.set_defaults(run=make_sheet)
    command.add_argument("comparisons", nargs="+", metavar="COMPARISON")
    command.add_argument("-o", "--output", required=True, help="the picture, .png")
    command.add_argument("--key", help="where which is which is written (OUTPUT with .key.csv)")
    command.add_argument("--each", type=whole(1), default=1, help="pairs of a clip; those of one clip are not independent (%(default)s)")
    command.add_argument("--seed", type=whole(0), default=1, help="another one, another order (%(default)s)")
    command.add_argument("--overwrite", action="store_true")
    command = commands.add_parser("score", help="answers to a sheet against its key")
    command.set_defaults(run=score)
    command.add_argument("answers", metavar="ANSWERS", help="a line a pair: 3,left where the left one is real")
    command.add_argument("key", metavar="KEY")
    arguments = parser.parse_args()
    try:
        arguments.run(arguments)
    except Refused as error:
        print(f"judge: {error}", file=sys.stderr)
        sys.exit(2)
    except ImportError as missing:
        sys.exit(f"judge: {missing}; {NEEDS}")
    except OSError as error:
        print(f"judge: {error.filename}: {error.strerror}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
