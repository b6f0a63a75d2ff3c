#!/usr/bin/env python3
"""reference.py GLINT OUT: the reference pages, from the program and the Python module themselves."""
import dataclasses
import html
import inspect
import re
import subprocess
import sys
from pathlib import Path


def said_by(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def options(program):
    """The commented YAML of `glint config` as a table a section."""
    lines = ["# Options", "", "What `glint config` prints: give the ones to change with `--set section.option=value`, or in",
             "a YAML file with `--config`. `_rel` is a fraction of the object's bounding-box diagonal.", ""]
    comment, sections, table = [], [], False
    for line in said_by(program, "config").splitlines()[2:]:
        indent, text = (len(line) - len(line.lstrip())) // 2, line.strip()
        if text.startswith("#"):
            comment.append(text[1:].strip())
        elif ":" in text:
            name, value = (part.strip() for part in text.split(":", 1))
            sections = sections[:indent] + [name]
            said, comment = " ".join(comment), []
            if value:
                if not table:
                    lines += ["| option | default | range, unit | meaning |", "|---|---|---|---|"]
                    table = True
                meaning, limits = re.fullmatch(r"(.*?)(?: \(([^()]*(?:\([^()]*\)[^()]*)*)\))?", said).groups()
                cells = [f"`{'.'.join(sections)}`", f"`{value}`", html.escape(limits or ""), html.escape(meaning)]
                lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
            else:
                lines += ["", "#" * min(2 + indent, 4) + " " + ".".join(sections), "", html.escape(said), ""]
                table = False
    return lines


def commands(program):
    names = re.findall(r"^  ([a-z]+) {2,}", said_by(program, "--help").split("Subcommands:")[1], re.M)
    lines = ["# Commands", "", "Exit codes: 0 done, 2 bad input or configuration, 3 no honest result, 1 a bug."]
    for name in names:
        lines += ["", f"## glint {name}", "", "```", said_by(program, name, "--help").strip(), "```"]
    return lines


def documentation(item):
    """Google's layout of docstrings: `Args:` and the like become lists."""
    lines = []
    for line in inspect.cleandoc(item.__doc__).splitlines():
        head = re.fullmatch(r"(Args|Returns|Raises|Attributes):", line)
        field = re.fullmatch(r"    (\w[\w, ]*): (.*)", line)
        if head:
            lines += [f"**{head[1]}**", ""]
        elif field:
            lines.append(f"- `{field[1]}`: {field[2]}")
        else:
            lines.append(line[4:] if line.startswith("     ") else line)
    return lines


def python():
    import glint

    lines = ["# Python", "", "`import glint`", "", *documentation(glint)]
    items = [(name, getattr(glint, name)) for name in glint.__all__]
    for title, chosen in (
        ("Functions", [i for i in items if inspect.isfunction(i[1])]),
        ("Exceptions", [i for i in items if inspect.isclass(i[1]) and issubclass(i[1], Exception)]),
        ("Classes", [i for i in items if inspect.isclass(i[1]) and not issubclass(i[1], Exception)]),
    ):
        lines += ["", f"## {title}"]
        for name, item in chosen:
            shown = name
            if inspect.isfunction(item):
                parameters = [str(p.replace(annotation=p.empty)) for p in inspect.signature(item).parameters.values()]
                keyword = [p.kind == p.KEYWORD_ONLY for p in inspect.signature(item).parameters.values()]
                if True in keyword:
                    parameters.insert(keyword.index(True), "*")
                shown = f"{name}({', '.join(parameters)})"
            lines += ["", f"### {name}", "", "```python", shown, "```", "", *documentation(item)]
            if inspect.isclass(item):
                for member, value in vars(item).items():
                    if member.startswith("_") or not getattr(value, "__doc__", None):
                        continue
                    if isinstance(value, property) or hasattr(value, "func") or inspect.isfunction(value):
                        call = "()" if inspect.isfunction(value) else ""
                        lines.append(f"- `{member}{call}`: {' '.join(inspect.cleandoc(value.__doc__).split())}")
                if dataclasses.is_dataclass(item) and item.__mro__[1] is not object:
                    lines += ["", f"And all of `{item.__mro__[1].__name__}`."]
    return lines


def main():
    program, out = sys.argv[1], Path(sys.argv[2])
    out.mkdir(parents=True, exist_ok=True)
    for name, lines in (("options", options(program)), ("commands", commands(program)), ("python", python())):
        if sum(line.startswith(("| `", "## ", "### ")) for line in lines) < 10:
            sys.exit(f"reference.py: hardly anything is said of the {name}: has its form changed?")
        (out / f"{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


main()
