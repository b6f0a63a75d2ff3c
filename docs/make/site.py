#!/usr/bin/env python3
"""site.py SOURCE OUT: every Markdown page below SOURCE as HTML below OUT; pictures go along."""
import re
import shutil
import sys
from pathlib import Path

import markdown

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - Glint</title><style>
:root {{ color-scheme: light dark; }}
body {{ font: 16px/1.55 system-ui, sans-serif; max-width: 60rem; margin: 0 auto; padding: 1rem 1.2rem 4rem; }}
nav {{ display: flex; flex-wrap: wrap; gap: .2rem 1rem; }} img {{ max-width: 100%; height: auto; background: #fff; }}
pre {{ padding: .8rem 1rem; overflow-x: auto; background: #8882; border-radius: .3rem; }}
code {{ font-size: .92em; }} a {{ color: #2268b0; }}
@media (prefers-color-scheme: dark) {{ a {{ color: #7ab4f5; }} }}
table {{ border-collapse: collapse; display: block; overflow-x: auto; }}
td, th {{ border-bottom: 1px solid #8885; padding: .3rem .8rem .3rem 0; text-align: left; vertical-align: top; }}
</style></head><body><nav>{menu}</nav>
{body}
</body></html>
"""
MENU = [("Documentation", "README.md"), ("Troubleshooting", "troubleshooting.md"), ("Gallery", "gallery.md"),
        ("Options", "reference/options.md"), ("Commands", "reference/commands.md"), ("Python", "reference/python.md"),
        ("C++", "reference/cpp/files.html")]


def html_name(link):
    """Where a link to a page leads on the site."""
    link = re.sub(r"(^|/)README\.md(?=#|$)", r"\1index.html", link)
    return re.sub(r"\.md(?=#|$)", ".html", link)


def main():
    source, out = Path(sys.argv[1]), Path(sys.argv[2])
    for file in sorted(source.rglob("*")):
        name = file.relative_to(source)
        target = out / html_name(str(name))
        target.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix == ".png":
            shutil.copyfile(file, target)
        if file.suffix != ".md":
            continue
        text = file.read_text(encoding="utf-8")
        body = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "sane_lists"])
        body = re.sub(r'href="(?!https?:)([^"]+)"', lambda m: f'href="{html_name(m[1])}"', body)
        up = "../" * (len(name.parts) - 1)
        menu = "".join(f'<a href="{up}{html_name(link)}">{title}</a>' for title, link in MENU)
        title = re.search(r"^# (.*)", text, re.M)[1]
        target.write_text(PAGE.format(title=title, menu=menu, body=body), encoding="utf-8")


main()
