# SPDX-License-Identifier: Apache-2.0
"""Writes docs/reference/commands.md from the help of the program itself.

    python3 docs/reference/make_commands.py AIRTRUTH            rewrites commands.md beside this script
    python3 docs/reference/make_commands.py AIRTRUTH --check    exits with 1 where commands.md differs from the help

AIRTRUTH is the path of the built program.
"""

import os
import re
import subprocess
import sys

from written_page import argument, write_or_check

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "commands.md")
HEAD = """# Commands

Every command of the program with its arguments and options. This page is written by
[`make_commands.py`](make_commands.py) from the program's own `--help`; change the help in `src/cli/`, not this page.
The installed manual pages (`man airtruth-render`) hold the same text.

`--quiet`, `--json-log` and `--version` belong to `airtruth` itself and stand before the command:
`airtruth --quiet render scene.toml`.

From Python, `airtruth.run("dataset build", "set.toml", out="set")` is `airtruth dataset build set.toml --out set`
([airtruth.run](../python.md)).
"""
EXIT_CODES = """
## Exit codes

| code | meaning |
|---|---|
| 0 | The command did its work. |
| 1 | A check found a fault (`dataset verify`), one part failed while the others went on (`dataset build`, `track`, `detect`), or airtruth has a fault, which the message states. |
| 2 | An input is wrong, or a disk refused a file. One line names the file and the line, what was found and what was expected. |
| 130 | The command was interrupted. |
"""


def help_of(airtruth, command):
    """The help text of a command, which is a list of words: [] is the program itself."""
    return subprocess.run([airtruth, *command, "--help"], capture_output=True, text=True, check=True).stdout


def sections_of(text):
    """The parts of a help text: its description, its usage line, and each titled block with its (name, text) entries."""
    head, *blocks = re.split(r"^(Positionals|Options|Subcommands):\n", text, flags=re.M)
    description, usage = head.split("Usage: ", 1)
    titled = {title: entries_of(block) for title, block in zip(blocks[::2], blocks[1::2])}
    return " ".join(description.split()), usage.strip(), titled


def entries_of(block):
    """(name, text) of each entry: a name starts in column 2, its text in column 30 of the same or of the next lines."""
    lines = [line for line in block.splitlines() if line.strip()]
    deeper = [line.startswith(" " * 30) for line in lines] + [False]
    entries = []
    for line, is_text, next_is_text in zip(lines, deeper, deeper[1:]):
        if is_text:
            entries[-1][1] = f"{entries[-1][1]} {line.strip()}".strip()
        elif next_is_text:
            entries.append([line.strip(), ""])
        else:
            entries.append([line[:30].strip(), line[30:].strip()])
    return entries


def cell(text):
    return text.replace("|", "\\|")


def table_of(title, entries):
    rows = [f"| `{cell(name)}` | {cell(text)} |" for name, text in entries]
    return [f"| {title} | |", "|---|---|", *rows, ""]


def lines_for(airtruth, command):
    description, usage, titled = sections_of(help_of(airtruth, command))
    lines = [f"{'#' * (1 + len(command))} airtruth {' '.join(command)}", "", description, "", f"    {usage}", ""]
    for title, label in (("Positionals", "Argument"), ("Options", "Option")):
        entries = [entry for entry in titled.get(title, []) if not entry[0].startswith("-h,")]
        if entries:
            lines += table_of(label, entries)
    for name, _ in titled.get("Subcommands", []):
        lines += lines_for(airtruth, [*command, name])
    return lines


def page_of(airtruth):
    description, usage, titled = sections_of(help_of(airtruth, []))
    names = [name for name, _ in titled["Subcommands"]]
    lines = [HEAD, "| command | |", "|---|---|"]
    lines += [f"| [`airtruth {name}`](#airtruth-{name}) | {text} |" for name, text in titled["Subcommands"]]
    lines += ["", *table_of("Option of airtruth", [entry for entry in titled["Options"] if not entry[0].startswith("-h,")])]
    for name in names:
        lines += lines_for(airtruth, [name])
    return "\n".join(lines).rstrip() + "\n" + EXIT_CODES


def main():
    page = page_of(os.path.abspath(argument(__doc__)))
    write_or_check(page, PAGE, "the help says; run: python3 docs/reference/make_commands.py PROGRAM")


if __name__ == "__main__":
    main()
