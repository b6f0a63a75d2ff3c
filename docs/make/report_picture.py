#!/usr/bin/env python3
"""report_picture.py REPORT PICTURE: the viewer of a report.html as a laptop and a phone show it, by headless Chromium."""
import io
import sys
from pathlib import Path

from PIL import Image

sys.path.append(str(Path(__file__).resolve().parents[2] / "tests/browser"))
import webdriver
from drawing import save

HEIGHT = 620


def shot(page, size, mode, dark, touch):
    """The window with the viewer in it, colours by `mode`."""
    with webdriver.Browser(*size, touch=touch) as browser:
        browser.prefer_dark(dark)
        browser.open(page)
        browser.wait_for("return document.documentElement.dataset.ready === 'true'", 300)
        browser.run("document.getElementById(arguments[0]).click()", f"mode-{mode}")
        browser.run("document.getElementById('surface').scrollIntoView()")
        browser.run("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")
        picture = Image.open(io.BytesIO(browser.screenshot())).convert("RGB")
    return picture.resize((round(picture.width * HEIGHT / picture.height), HEIGHT), Image.LANCZOS)


def main():
    laptop = shot(sys.argv[1], (1280, 900), "zebra", dark=False, touch=False)
    phone = shot(sys.argv[1], (390, 844), "confidence", dark=True, touch=True)
    picture = Image.new("RGB", (laptop.width + phone.width, HEIGHT))
    picture.paste(laptop, (0, 0))
    picture.paste(phone, (laptop.width, 0))
    save(picture, Path(sys.argv[2]), 256)


main()
