# SPDX-License-Identifier: Apache-2.0
"""A page of the documentation that a script writes, and checks with --check."""

import sys


def argument(usage):
    """The script's one argument beside --check."""
    arguments = [word for word in sys.argv[1:] if word != "--check"]
    if len(arguments) != 1:
        sys.exit(usage)
    return arguments[0]


def write_or_check(page, path, difference):
    """Writes the page; with --check, exits with 1 and the difference in words where the file holds another."""
    if "--check" not in sys.argv:
        with open(path, "w", encoding="utf-8") as opened:
            opened.write(page)
        return
    with open(path, encoding="utf-8") as opened:
        if opened.read() != page:
            sys.exit(f"{path} is not what {difference}")
