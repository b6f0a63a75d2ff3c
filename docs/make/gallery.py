"""Runs the commands that docs/gallery.md shows, in the order of the page: what they draw becomes the picture below them,
what `glint compare` measures becomes the table of the page. So the page shows what its commands do, and nothing else."""
import json
import re
import shlex
import subprocess
from pathlib import Path

from PIL import Image

from drawing import save

WIDTH = 1100
BLOCK = re.compile(r"^## (?P<title>.*?)$(?:(?!^## ).)*?```sh\n(?P<commands>.*?)```\s*!\[.*?\]\((?P<picture>.*?)\)", re.M | re.S)
TABLE = re.compile(r"(<!-- numbers -->\n).*?(<!-- end -->)", re.S)
HEAD = ("| object | photographs | lamps found | sparse surface: distance | normals | result: distance | normals |\n"
        "|---|---|---|---|---|---|---|")


def commands(block):
    """The block's commands, each as a list of words; lines that end in a backslash go on."""
    return [shlex.split(line) for line in block.replace("\\\n", " ").splitlines() if line.strip()]


def value(words, flag):
    return words[words.index(flag) + 1]


def row(title, project, out, compared):
    def numbers(candidate):
        swept = candidate["regions"]["swept region"]
        return f"{100 * swept['distance_rel']['mean']:.3f} % | {swept['normal_deg']['mean']:.2f}°"

    before, after = compared["candidates"]
    report = json.loads((out / "report.json").read_text())
    lights = report["lights"]
    found = f"given ({len(lights['given'])})" if lights["given"] else (
        f"{sum(light['determined'] for light in lights['refined'])} of "
        f"{len(json.loads((project / 'truth/lights.json').read_text())['lights'])}")
    return f"| {title} | {report['project']['views']} | {found} | {numbers(before)} | {numbers(after)} |"


def make(program, page, work):
    """Makes every picture of the page and writes its table; `work` keeps the projects and results."""
    rows = [HEAD]
    for section in BLOCK.finditer(page.read_text(encoding="utf-8")):
        done = None
        for words in commands(section["commands"]):
            if words[1] == "synth" and (work / value(words, "-o") / "truth").exists():
                continue  # it takes longest, and makes the same again
            more = ["--json"] if words[1] == "compare" else []
            done = subprocess.run([program, *words[1:], "-q", *more], cwd=work, check=True, stdout=subprocess.PIPE)
        project, out = work / value(words, "--project"), (work / words[2]).parent
        rows.append(row(section["title"], project, out, json.loads(done.stdout)))
        print(rows[-1])
        picture = Image.open(work / value(words, "--picture")).convert("RGB")
        picture = picture.resize((WIDTH, round(picture.height * WIDTH / picture.width)), Image.LANCZOS)
        save(picture, page.parent / section["picture"], 256)
    text = page.read_text(encoding="utf-8")
    page.write_text(TABLE.sub(lambda m: "\n".join([m[1], *rows, "", m[2]]), text), encoding="utf-8")
