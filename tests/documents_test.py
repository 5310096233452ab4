# SPDX-License-Identifier: Apache-2.0
"""What the documents promise, held against the repository: python3 documents_test.py AIRTRUTH SOURCE

Links lead somewhere, every command of the program is named in the README, docs/reference/commands.md is what the program's
help says, the versions of CMakeLists.txt, CITATION.cff, CHANGELOG.md and the program agree, the paper and its data set are
named and linked, and no private idiom is left.
"""

import os
import re
import subprocess
import sys

IDIOMS = [r"paper's (own )?road", r"two roads"]
DATA_SET = "https://www.kaggle.com/adriancarrio/aircraft-detection-and-sky-segmentation-dataset"
TITLE = "A Ground-Truth Video Dataset for the Development and Evaluation of Vision-based Sense-and-Avoid systems"


def texts(source):
    """Every text file that is ours: path below `source` and content."""
    for folder, names, files in os.walk(source):
        names[:] = [name for name in names if name not in ("build", "demo", "corpus") and not name.startswith(".")]
        for file in files:
            path = os.path.join(folder, file)
            if os.path.samefile(path, __file__) or os.path.getsize(path) > 1 << 20:
                continue
            try:
                with open(path, encoding="utf-8") as opened:
                    yield os.path.relpath(path, source), opened.read()
            except UnicodeDecodeError:
                continue


def broken_links(source, path, text):
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^    .*$|`[^`]*`", "", text, flags=re.M)):
        if re.match(r"https?:|mailto:|#", target):
            continue
        file = os.path.join(source, os.path.dirname(path), target.split("#")[0])
        if not os.path.exists(file):
            yield f"{path}: the link {target} leads nowhere"


def commands(airtruth):
    """The names of the program's commands, of groups their commands too."""
    def below(*group):
        text = subprocess.run([airtruth, *group, "--help"], capture_output=True, text=True, check=True).stdout
        listed = re.split(r"\n(?:Subcommands|SUBCOMMANDS):\n", text)
        return re.findall(r"^  ([a-z][a-z-]*)  ", listed[1], re.M) if len(listed) > 1 else []
    return {name: below(name) for name in below()}


def flat(text):
    return re.sub(r"[\s>]+", " ", text)


def main():
    airtruth, source = map(os.path.abspath, sys.argv[1:3])
    files = dict(texts(source))
    faults = []
    for path, text in files.items():
        for idiom in IDIOMS:
            for found in re.finditer(idiom, flat(text), re.I):
                faults.append(f"{path}: '{found.group(0)}'")
        if path.endswith(".md"):
            faults += broken_links(source, path, text)
    readme = files["README.md"]
    known = commands(airtruth)
    if len(known) < 10:
        faults.append(f"--help lists the commands {sorted(known)}")
    for name in known:
        if not re.search(rf"airtruth {name}\b", readme):
            faults.append(f"README.md does not name `airtruth {name}`")
    version = re.search(r"project\(airtruth VERSION (\S+)", files["CMakeLists.txt"]).group(1)
    said = subprocess.run([airtruth, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    stated = {"airtruth --version": said,
              "CITATION.cff": re.search(r"^version: (\S+)", files["CITATION.cff"], re.M).group(1),
              "CHANGELOG.md": re.search(r"^## (\S+)", files["CHANGELOG.md"], re.M).group(1)}
    for where, what in stated.items():
        if what != version:
            faults.append(f"{where} states version {what}; CMakeLists.txt {version}")
    for path in ("README.md", "docs/paper.md"):
        for wanted in (TITLE, DATA_SET, "CITATION.cff"):
            if wanted not in flat(files[path]):
                faults.append(f"{path} does not hold '{wanted}'")
    reference = [sys.executable, os.path.join(source, "docs", "reference", "make_commands.py"), airtruth, "--check"]
    checked = subprocess.run(reference, capture_output=True, text=True)
    if checked.returncode != 0:
        faults.append(checked.stderr.strip())
    if TITLE not in flat(files["CITATION.cff"]):
        faults.append("CITATION.cff does not name the paper")
    if faults:
        sys.exit("documents_test:\n  " + "\n  ".join(sorted(faults)))
    print(f"{len(files)} files, {len(known)} commands, version {version}: no fault")


if __name__ == "__main__":
    main()
