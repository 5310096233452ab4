#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does a detector that is trained on composites alone see real aircraft? ./dev proof OUT --set ground-real=FOLDER [--set NAME=FOLDER ...]

Trains the same small network with the same steps and seeds on real clips, on composites from a training stream, on the plain matte, on cut and
paste, and on composites with a tenth of the real; measures each on real clips that nothing was trained on. Leaves tables in OUT/proof.md and
OUT/proof.json, misses and false alarms as pictures beside them. What is there already is not made again: the same command goes on. With
--held-back it measures the clips held back, once, when all else is done (OUT/held-back.md). docs/proof.md has the figures and what they mean.
"""

import argparse
import os
import pathlib
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))

NEEDS = "expected /usr/bin/python3 with Debian's python3-torch and python3-opencv, and the package airtruth (./dev python)"
try:
    import cv2

    import measure
    import page
    import sets
    import splits
    import trainings
    from arguments import whole
    from sets import Refused
except ImportError as missing:
    sys.exit(f"proof: {missing}; {NEEDS}")


def detected(arguments, reals, material):
    """{training: [of each seed {(set, clip): detections}]}"""
    found = {name: [] for name in arguments.only}
    for seed in range(1, arguments.seeds + 1):  # a whole round of trainings before the next seed: a run that ends early compares all of them
        for name in arguments.only:
            network = trainings.network_of(name, seed, material, arguments)
            of_sets = {}
            for real in reals:
                clips = splits.tested(real, arguments.held_back is not None, arguments.held_back)
                part = "held-back" if arguments.held_back is not None else "looked-at"
                path = pathlib.Path(arguments.out) / "detections" / f"{name}-{seed}" / f"{real.name}-{part}.json"
                for clip, frames in trainings.detections_of(network, clips, arguments, path).items():
                    of_sets[real.name, clip] = frames
            found[name].append(of_sets)
    return found


def run(arguments):
    if arguments.list:
        for name, source in sets.SOURCES.items():
            print(f"{name}: {source.title}. Licence: {source.licence}. {source.where}. Finds: {', '.join(source.targets)}")
        return
    if not arguments.out or not arguments.sets:
        raise Refused("say where to, and which sets; ./dev proof OUT --set ground-real=FOLDER")
    if arguments.device == "cuda" and not trainings.torch.cuda.is_available():
        raise Refused("--device cuda: PyTorch finds no such device here")
    unknown = [name for name in arguments.only if name not in trainings.TRAININGS]
    if unknown:
        raise Refused(f"no training '{unknown[0]}'; there are {', '.join(trainings.TRAININGS)}")
    reals = []
    for given in arguments.sets:
        name, _, folder = given.partition("=")
        if not folder:
            raise Refused(f"--set {given}: expected NAME=FOLDER")
        reals.append(sets.read_set(name, folder))
    names = [real.name for real in reals]
    if arguments.train_on not in names:
        raise Refused(f"--train-on {arguments.train_on} is no set of this run; there are {', '.join(names)}")
    cv2.setNumThreads(1)
    material = trainings.Material(reals[names.index(arguments.train_on)], arguments)
    found = detected(arguments, reals, material)
    part = "held-back" if arguments.held_back is not None else "proof"
    images = measure.images_of(reals, arguments)
    result = measure.measured(images, found, reals, arguments)
    trainings.written(pathlib.Path(arguments.out) / f"{part}.json", result)
    text = page.text_of(result, arguments)
    if arguments.held_back is None:  # what is held back is measured, and not looked at
        text += page.look_rows(images, found, reals, arguments)
        page.write_pictures(images, found, reals, arguments)
    (pathlib.Path(arguments.out) / f"{part}.md").write_text(text, encoding="utf-8")
    print(text, end="")


def main():
    parser = argparse.ArgumentParser(prog="proof", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", nargs="?", metavar="OUT")
    parser.add_argument("--set", dest="sets", action="append", metavar="NAME=FOLDER", help="a set of real aircraft that you fetched; --list names them")
    parser.add_argument("--list", action="store_true", help="the sets that can be read, with their licences")
    parser.add_argument("--train-on", default="ground-real", metavar="NAME", help="the set whose camera is known (%(default)s)")
    parser.add_argument("--catalogue", help="composites of this catalogue with a table [stream], in place of the one over the set's own clips")
    parser.add_argument("--only", type=lambda text: text.split(","), default=trainings.COMPARED, metavar="NAME,...",
                        help="of " + ", ".join(trainings.TRAININGS))
    parser.add_argument("--seeds", type=whole(1), default=3, help="trainings of each kind (%(default)s)")
    parser.add_argument("--steps", type=whole(1), help="of each training (800 unless --minutes is given)")
    parser.add_argument("--minutes", type=float, help="processor time of each training instead")
    parser.add_argument("--frames", type=whole(1), default=1600, help="with aircraft that each training sees (%(default)s)")
    parser.add_argument("--negatives", type=whole(1), default=800, help="frames without an aircraft, the same for all (%(default)s)")
    parser.add_argument("--batch", type=whole(1), default=24, help="crops in a step (%(default)s)")
    parser.add_argument("--device", choices=("cpu", "cuda"), default="cpu", help="what PyTorch trains on (%(default)s)")
    parser.add_argument("--every", type=whole(1), default=10, help="measure on every n-th labelled frame of a clip (%(default)s)")
    parser.add_argument("--draws", type=whole(0), default=200, help="of clips for the intervals (%(default)s)")
    parser.add_argument("--held-back", nargs="*", metavar="CLIP", help="measure the clips held back, or these of them, instead of those looked at")
    arguments = parser.parse_args()
    if not arguments.minutes and not arguments.steps:
        arguments.steps = 800
    try:
        run(arguments)
    except (Refused, trainings.airtruth.Error) as error:
        print(f"proof: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
