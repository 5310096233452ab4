# SPDX-License-Identifier: Apache-2.0
"""Writes examples/train_from_stream.ipynb from examples/train_from_stream.py.

    python3 docs/reference/make_notebook.py            rewrites the notebook
    python3 docs/reference/make_notebook.py --check    exits with 1 where it differs

The script's definitions are a cell each. The cells of its `if __name__` block end with its arguments and with each of its loops;
the command line is replaced by ARGUMENTS. No outputs are stored.
"""

import ast
import json
import pathlib
import textwrap

from written_page import write_or_check

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "examples" / "train_from_stream.py"
ARGUMENTS = '["flight.mp4", "--fov", "50", "--steps", "400"]'
TITLE = """# Own video to a trained and evaluated detector

{what}

Put the name of your video and its camera's vertical field of view in degrees where the arguments stand. Needs airtruth for Python
(docs/python.md) and python3-torch. Written by docs/reference/make_notebook.py from train_from_stream.py: change that."""


def is_main(statement):
    return isinstance(statement, ast.If) and "__name__" in ast.unparse(statement.test)


def source_of(lines, statements):
    return textwrap.dedent("\n".join(lines[statements[0].lineno - 1:statements[-1].end_lineno]))


def groups(statements, ends):
    """Splits statements after each one for which ends(statement) is true."""
    found = [[]]
    for statement in statements:
        found[-1].append(statement)
        if ends(statement):
            found.append([])
    return [group for group in found if group]


def code_cells(text):
    """The sources of the code cells."""
    lines, body = text.splitlines(), ast.parse(text).body[1:]
    main = next(statement for statement in body if is_main(statement))
    heads = [statement for statement in body if not isinstance(statement, ast.FunctionDef) and statement is not main]
    functions = [[statement] for statement in body if isinstance(statement, ast.FunctionDef)]
    steps = groups(main.body, lambda statement: isinstance(statement, ast.For) or "parse_args" in ast.unparse(statement))
    cells = [source_of(lines, group) for group in [heads, *functions, *steps]]
    return [cell.replace("parse_args()", f"parse_args({ARGUMENTS})") for cell in cells]


def cell(kind, source):
    fields = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "metadata": {}, **fields, "source": source.splitlines(keepends=True)}


def notebook(text):
    """The text of the notebook of a script's text."""
    what = " ".join(ast.get_docstring(ast.parse(text)).split(":\n")[0].split()) + "."
    cells = [cell("markdown", TITLE.format(what=what)), *(cell("code", source) for source in code_cells(text))]
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}, "language_info": {"name": "python"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 4}, indent=1) + "\n"


if __name__ == "__main__":
    write_or_check(notebook(SCRIPT.read_text(encoding="utf-8")), SCRIPT.with_suffix(".ipynb"),
                   "its script makes; run: python3 docs/reference/make_notebook.py")
