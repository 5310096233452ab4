# SPDX-License-Identifier: Apache-2.0
"""What the documents promise, held against the repository: python3 documents_test.py AIRTRUTH SOURCE

Links lead somewhere, and so does every reference to a decision or to a page of docs/ in any file of the source. A decision states
its question, its choice and what reopens it on half a page, and the index lists it. Documents say what is, not how it came to be.
The README is short and names every command of the program, docs/reference/commands.md is what the program's help says, the
notebook of examples/ is what its script makes, the versions of CMakeLists.txt, CITATION.cff, CHANGELOG.md and the program agree,
the paper and its data set are named and linked, and no private idiom is left.
"""

import os
import re
import subprocess
import sys

IDIOMS = [r"paper's (own )?road", r"two roads"]
# How something came to be is in the history, not in a document.
HISTORY = [r"(?<!is )(?<!are )(?<!be )\bused to\b", r"no longer", r"\bformerly\b", r"\bpreviously\b", r"last time", r"\bnow takes\b",
           r"until now", r"before decision", r"earlier build", r"as it was before", r"stood here before",
           r"figures? (was|were) [\d.]+ before", r"measured before\b", r"before this (change|decision)"]
README_WORDS = (700, 900)
DECISION_LINES = 45
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


def lost_references(path, text, files):
    """References to decisions by number, and to pages of docs/ by path, that lead to no page."""
    numbers = {os.path.basename(page)[:4] for page in files if re.match(r"docs/decisions/\d{4}-", page)}
    for number in re.findall(r"\bdecisions?[ /](\d{1,4})\b", flat(text), re.I):
        if number.zfill(4) not in numbers:
            yield f"{path}: there is no decision {number}"
    for page in re.findall(r"(?<![\w/])docs/[a-z][\w./-]*\.md\b", text):
        if page not in files:
            yield f"{path}: there is no {page}"


def faults_of_decisions(files):
    index = files["docs/decisions/README.md"]
    for path, text in files.items():
        name = os.path.basename(path)
        if not re.match(r"docs/decisions/\d{4}-", path):
            continue
        if not text.startswith(f"# {name[:4]}. "):
            yield f"{path} does not begin with '# {name[:4]}. '"
        for part in ("**Question.**", "**Choice", "**Reopen**"):
            if part not in text:
                yield f"{path} has no {part}"
        if len(text.splitlines()) > DECISION_LINES:
            yield f"{path} has {len(text.splitlines())} lines; a decision has at most {DECISION_LINES}"
        if name not in index:
            yield f"docs/decisions/README.md does not list {name}"


def told_history(path, text):
    if path != "README.md" and not path.startswith("docs/"):
        return
    for words in HISTORY:
        for found in re.finditer(words, flat(text), re.I):
            yield f"{path}: '{found.group(0)}' tells how something came to be"


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
        faults += lost_references(path, text, files)
        if path.endswith(".md"):
            faults += broken_links(source, path, text)
            faults += told_history(path, text)
    faults += faults_of_decisions(files)
    readme = files["README.md"]
    words = len(readme.split())
    if not README_WORDS[0] <= words <= README_WORDS[1]:
        faults.append(f"README.md has {words} words; {README_WORDS[0]} to {README_WORDS[1]} are wanted")
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
    for script, *arguments in (["make_commands.py", airtruth], ["make_notebook.py"]):
        writer = [sys.executable, os.path.join(source, "docs", "reference", script), *arguments, "--check"]
        checked = subprocess.run(writer, capture_output=True, text=True)
        if checked.returncode != 0:
            faults.append(checked.stderr.strip())
    if TITLE not in flat(files["CITATION.cff"]):
        faults.append("CITATION.cff does not name the paper")
    if faults:
        sys.exit("documents_test:\n  " + "\n  ".join(sorted(faults)))
    print(f"{len(files)} files, {len(known)} commands, version {version}: no fault")


if __name__ == "__main__":
    main()
