# SPDX-License-Identifier: Apache-2.0
"""Writes docs/python.md from the docstrings and annotations of the Python package.

    python3 docs/reference/make_python.py PACKAGES            rewrites docs/python.md
    python3 docs/reference/make_python.py PACKAGES --check    exits with 1 where docs/python.md differs

PACKAGES is the folder that holds the built package `airtruth` (build/release/python).
"""

import dataclasses
import inspect
import os
import re
import sys
import types

from written_page import argument, write_or_check

PAGE = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "python.md")
HEAD = """# airtruth in Python

`import airtruth` after the installation of the Debian package, for Debian's own Python; `./dev python` builds it in a
checkout and prints the environment in which Python finds it. It needs NumPy and nothing else, but for airtruth.torch. This page is written by
[`make_python.py`](reference/make_python.py) from the docstrings of `python/airtruth`; change those, not this page. The
examples are run by `python_package_test`: "scene.toml" is a scene of 6 frames over "clip.mkv", and "set" the folder that
`airtruth render scene.toml --out set` makes of it. Those of airtruth.torch are run by `python_torch_test`, where torch is installed.

"""


def plain(text):
    """An annotation as a reader wants it: without the names of modules."""
    text = re.sub(r"(?:airtruth\.|_core\.|np\.|typing\.|pathlib\.|os\.)", "", str(text))
    return text.replace("'", "")


def signature_of(function):
    signature = inspect.signature(function)
    words = []
    for name, one in signature.parameters.items():
        if name in ("self", "cls"):
            continue
        if one.kind is one.KEYWORD_ONLY and not any(word.startswith("*") for word in words):
            words.append("*")
        stars = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
        default = "" if one.default is one.empty else f"={one.default!r}"
        words.append(f"{stars}{name}{default}")
    returned = "" if signature.return_annotation in (signature.empty, "None") else f" -> {plain(signature.return_annotation)}"
    return f"({', '.join(words)}){returned}"


def body_of(docstring):
    """A docstring as Markdown: its text, and its examples as code."""
    lines, in_example = [], False
    for line in inspect.cleandoc(docstring).splitlines():
        if line.startswith(">>> ") and not in_example:
            in_example = True
            if lines and lines[-1]:
                lines.append("")
        elif not line:
            in_example = False
        lines.append("    " + line if in_example else line)
    return [*lines, ""]


def source_of(name):
    """The lines of a class in the package."""
    folder = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "python", "airtruth")
    for file in sorted(os.listdir(folder)):
        if file.endswith(".py"):
            with open(os.path.join(folder, file), encoding="utf-8") as opened:
                found = re.search(rf"(?ms)^class {name}\b.*?(?=^\S|\Z)", opened.read())
            if found:
                return found.group(0)
    raise LookupError(name)


def fields_of(kind):
    """The fields of a dataclass with the comments that stand behind them in its source."""
    comments = dict(re.findall(r"(?m)^    (\w+):[^#\n]*#\s*(.*)$", source_of(kind.__name__)))
    rows = [(field.name, plain(field.type), comments.get(field.name, "")) for field in dataclasses.fields(kind)]
    return ["| field | type | |", "|---|---|---|", *(f"| `{name}` | `{type}` | {text} |" for name, type, text in rows), ""]


def class_page(title, kind, level):
    lines = [f"{level} {title}", "", *body_of(kind.__doc__)]
    if dataclasses.is_dataclass(kind):
        lines += fields_of(kind)
    for name, member in vars(kind).items():
        if name.startswith("_") or name in getattr(kind, "__dataclass_fields__", {}):
            continue
        if isinstance(member, property):
            lines += [f"**`.{name}`** `{plain(inspect.signature(member.fget).return_annotation)}`: {inspect.cleandoc(member.__doc__)}", ""]
        elif isinstance(member, (classmethod, staticmethod)) or inspect.isfunction(member):
            function = getattr(kind, name)
            lines += [f"**`.{name}{signature_of(function)}`**", "", *body_of(function.__doc__)]
    return lines


def page_of(title, thing, level="##"):
    if inspect.isclass(thing):
        if issubclass(thing, tuple):
            return [f"{level} {title}", "", *body_of(thing.__doc__), "Fields: " + ", ".join(f"`{name}`" for name in thing._fields) + ".", ""]
        return class_page(title, thing, level)
    return [f"{level} {title}{signature_of(thing)}", "", *body_of(thing.__doc__)]


def stand_in_for_torch():
    """The page is the same where torch is not installed."""
    torch = types.ModuleType("torch")
    torch.utils, torch.utils.data = types.ModuleType("torch.utils"), types.ModuleType("torch.utils.data")
    torch.utils.data.Dataset = object
    sys.modules.update({"torch": torch, "torch.utils": torch.utils, "torch.utils.data": torch.utils.data})


def whole_page(airtruth):
    lines = [HEAD + inspect.cleandoc(airtruth.__doc__), ""]
    for name in [*airtruth.__all__, "torch"]:
        thing = getattr(airtruth, name)
        if not inspect.ismodule(thing):
            lines += page_of(f"airtruth.{name}", thing)
            continue
        lines += [f"## airtruth.{name}", "", *body_of(thing.__doc__)]
        for own in (own for own, one in vars(thing).items() if getattr(one, "__module__", "") == thing.__name__):
            if own.startswith("_"):
                continue
            lines += page_of(f"airtruth.{name}.{own}", getattr(thing, own), "###")
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"


def main():
    sys.path.insert(0, os.path.abspath(argument(__doc__)))
    stand_in_for_torch()
    import airtruth

    page = whole_page(airtruth)
    write_or_check(page, PAGE, "the docstrings say; run: python3 docs/reference/make_python.py PACKAGES")


if __name__ == "__main__":
    main()
