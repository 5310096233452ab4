#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over sources of src/ but the tests: tidy.py BUILD [--all]

BUILD holds compile_commands.json. Without --all the sources are those that the work tree and the commits of the last hours before HEAD touch, or
those since the commit that AIRTRUTH_TIDY_BASE names; a header counts for the source of its name. Most of clang-tidy's time goes into headers, so
that up to sixteen sources are read as one, which takes less than a third of the time. Where they do not compile as one, for example because
private names clash, each half of them is read as one.
With --all every header of src/ is read alone as well: sources that are read as one can lend each other what one of them fails to include.
The exit code is 1 where there is a finding.
"""
import concurrent.futures
import itertools
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MOST_SOURCES = 16
CHANGE_HOURS = 4  # the work of one change; the commits of a whole day can touch nearly all sources


def git(*arguments):
    return subprocess.run(["git", "-C", ROOT, *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


def touched():
    """The paths, without their ending, that differ from the base: AIRTRUTH_TIDY_BASE, or else the newest commit that is CHANGE_HOURS older than HEAD."""
    base = os.environ.get("AIRTRUTH_TIDY_BASE", "")
    if not base:
        before = int(git("log", "-1", "--format=%ct")) - CHANGE_HOURS * 3600
        base = git("rev-list", "-1", f"--before={before}", "HEAD").strip()
    if not base:
        return None  # a history that is younger, or shallow: everything
    names = git("diff", "--name-only", base).split() + git("ls-files", "--others", "--exclude-standard").split()
    return {os.path.splitext(ROOT / name)[0] for name in names}


def batches(flags):
    """The sources in groups, none larger than MOST_SOURCES, whose members have one set of flags: small folders together,
    large ones in parts of nearly equal size."""
    folders = {}
    for source in sorted(flags):
        folders.setdefault(os.path.dirname(source), []).append(source)
    parts = {}
    for members in folders.values():
        count = -(-len(members) // MOST_SOURCES)
        size = -(-len(members) // count)
        for first in range(0, len(members), size):
            parts.setdefault(tuple(flags[members[first]]), []).append(members[first:first + size])
    for alike in parts.values():
        group = []
        for part in sorted(alike, key=len, reverse=True):
            if group and len(group) + len(part) > MOST_SOURCES:
                yield group
                group = []
            group = group + part
        yield group


def flags_of(command):
    """The flags of a compile command without the compiler, the source and the object file."""
    words = shlex.split(command)[1:]
    return words[:words.index("-o")]


def tidy(source, flags):
    run = subprocess.run(
        ["clang-tidy", "--quiet", "--warnings-as-errors=*", f"--config-file={ROOT}/.clang-tidy", r"--header-filter=src/.*",
         source, "--", *flags, "-Wno-pragma-once-outside-header"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return run.returncode, run.stdout


def check(batch, flags, folder):
    if len(batch) == 1:
        return tidy(batch[0], flags[batch[0]])
    joined = pathlib.Path(folder) / f"{len(batch)}_{os.path.relpath(batch[0], ROOT).replace('/', '_')}"
    joined.write_text("".join(f'#include "{source}"\n' for source in batch))
    code, text = tidy(str(joined), flags[batch[0]])
    if "clang-diagnostic-error" not in text:
        return code, text
    half = len(batch) // 2
    results = [check(part, flags, folder) for part in (batch[:half], batch[half:])]
    return max(code for code, _ in results), "".join(text for _, text in results)


def check_header(header, flags):
    run = subprocess.run(["clang++", *flags, "-fsyntax-only", "-Wno-pragma-once-outside-header", "-x", "c++", header],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return run.returncode, run.stdout


def headers(flags):
    """Each header of src/ with the flags of a source that stands beside it."""
    of_folder = {os.path.dirname(source): words for source, words in flags.items()}
    for name in git("ls-files", "src/*.h").split():
        header = str(ROOT / name)
        if os.path.dirname(header) in of_folder:
            yield header, of_folder[os.path.dirname(header)]


def main():
    with open(pathlib.Path(sys.argv[1]) / "compile_commands.json") as file:
        commands = json.load(file)
    wanted = None if sys.argv[2:] == ["--all"] else touched()
    flags = {c["file"]: flags_of(c["command"]) for c in commands
             if c["file"].startswith(f"{ROOT}/src/") and not c["file"].endswith("_test.cpp")
             and (wanted is None or os.path.splitext(c["file"])[0] in wanted)}
    failed = False
    with tempfile.TemporaryDirectory() as folder, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        alone = list(headers(flags)) if wanted is None else []
        results = itertools.chain(pool.map(lambda batch: check(batch, flags, folder), batches(flags)),
                                  pool.map(lambda pair: check_header(*pair), alone))
        for code, text in results:
            failed = failed or code != 0
            print(text, end="", flush=True)
    with_headers = f", {len(alone)} headers alone" if alone else ""
    print(f"clang-tidy: {len(flags)} sources{with_headers}, {'findings above' if failed else 'no finding'}")
    sys.exit(1 if failed else 0)


main()
