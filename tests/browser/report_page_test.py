#!/usr/bin/env python3
"""report.html in a browser: report_page_test.py GLINT FOLDER [--screenshots].

Makes a small project with an image called like markup, runs glint on it (once to the end, once so that it gives up),
and opens the reports in headless Chromium. Exits 77 (ctest: skipped) where Chromium is not installed: it brings 300 MB
of packages that nothing else here needs, so scripts/setup leaves it out and scripts/check_report installs it.
"""

import os
import shutil
import subprocess
import sys

import webdriver

TAB = "\ue004"
ARROW_RIGHT = "\ue014"
ESCAPE = "\ue00c"
MARKUP = "view_<!--<script>alert(1)&amp;.jpg"
LAPTOP, PHONE = (1366, 850), (390, 844)
VIEWS = 14

checks = failures = 0


def expect(truth, what):
    global checks, failures
    checks += 1
    failures += not truth
    print(("ok    " if truth else "FAILED"), what, flush=True)


def glint(program, *arguments):
    result = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    return result.returncode, result.stderr


def make_reports(program, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    project = f"{folder}/p"
    code, said = glint(program, "synth", "ellipsoid", "-o", project, "--views", str(VIEWS), "--size", "240x180", "-q")
    expect(code == 0, f"glint synth ({said.strip()})")
    for images in ("sparse/0/images.txt", "sparse/0/images.bin"):
        path = f"{project}/{images}"
        if os.path.exists(path):
            rename_in(path)
    os.rename(f"{project}/images/view_004.jpg", f"{project}/images/{MARKUP}")
    common = ["run", project, "--lights", f"{project}/truth/lights.json", "--set", "refine.voxel_rel=0.03"]
    common += ["--set", "refine.levels=2", "--set", "seed.open_hollows=false", "--set", "seed.outlines.use=none", "-q"]
    code, said = glint(program, *common, "-o", f"{folder}/done")
    expect(code == 0, f"glint run ({said.strip()})")
    code, _ = glint(program, *common, "-o", f"{folder}/gives_up", "--mesh", f"{folder}/done/seed.ply", "--set", "detect.min_strength=1")
    expect(code == 3, f"glint run that gives up exits 3, found {code}")
    return f"{folder}/done/report.html", f"{folder}/gives_up/report.html"


def rename_in(path):
    with open(path, "rb") as file:
        text = file.read()
    with open(path, "wb") as file:
        file.write(text.replace(b"view_004.jpg", MARKUP.encode()))


def open_page(browser, page):
    browser.open(page)
    browser.wait_for("return document.documentElement.dataset.ready === 'true'")


def settle(browser):
    """Waits until what was asked to be drawn has been."""
    browser.run("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")


def pixels(browser):
    settle(browser)
    return webdriver.decode_png(browser.screenshot(selector="#canvas", scale=0.4))


def difference(a, b):
    """Share of the bytes that differ by more than a little."""
    differ = sum(abs(x - y) > 12 for p, q in zip(a[2], b[2]) for x, y in zip(p[::7], q[::7]))
    return differ / sum(len(p[::7]) for p in a[2])


def dark_share(picture):
    """Share of the pixels that are nearly black: the dark stripes of the reflection lines."""
    width, height, rows, channels = picture
    return sum(max(row[x : x + 3]) < 60 for row in rows for x in range(0, width * channels, channels)) / (width * height)


def surface_share(picture):
    """Share of the picture's height that is not the background at its left edge, in the column of its middle."""
    width, height, rows, channels = picture
    middle = width // 3 * channels
    return sum(max(abs(row[middle + k] - row[k]) for k in range(3)) > 25 for row in rows) / height


def quiet(browser, what):
    said = browser.log()
    expect(not said, f"{what}: nothing on the console ({said})")


def check_viewer(browser):
    browser.run("document.getElementById('surface').scrollIntoView()")
    striped = pixels(browser)
    expect(dark_share(striped) > 0.03, f"the viewer draws reflection lines ({dark_share(striped):.3f} of it is dark)")
    last = striped
    for mode in ("plain", "photo", "confidence", "moved", "curvature", "sigma"):
        browser.click(f"label[for=mode-{mode}]")
        now = pixels(browser)
        expect(difference(last, now) > 0.01, f"colour by {mode} changes the picture ({difference(last, now):.3f})")
        last = now
    for thing in ("cameras", "rays", "lights"):
        browser.click(f"label[for=show-{thing}]")
    now = pixels(browser)
    expect(difference(last, now) > 0.001, "cameras, rays and lights are drawn")
    expect(surface_share(last) > 2 * surface_share(now), "the view steps back to have the cameras in the picture")
    browser.click("label[for=mode-zebra]")
    browser.run("for (const t of ['cameras', 'rays', 'lights']) document.getElementById('show-' + t).click()")
    before, after = (share_of(browser, share) for share in (100, 0))
    expect(difference(before, after) > 0.01, f"before and after differ ({difference(before, after):.3f})")
    both = share_of(browser, 50)
    expect(difference(both, before) > 0.003 and difference(both, after) > 0.003, "the slider shows a part of each")
    browser.drag(".divider", 120, 0)
    moved = pixels(browser)
    expect(difference(both, moved) > 0.003, "dragging the line moves it")
    share_of(browser, 0)  # without the line in the middle, where the mouse goes down
    browser.drag("#canvas", 120, 40)
    turned = pixels(browser)
    expect(difference(after, turned) > 0.02, "dragging turns the surface")
    browser.run("document.getElementById('canvas').focus()")
    browser.press(["+", "+", ARROW_RIGHT])
    expect(difference(turned, pixels(browser)) > 0.02, "keys turn and zoom")
    browser.press(["0"])
    browser.run("document.activeElement.blur()")  # the focus draws a frame
    expect(difference(after, pixels(browser)) < 0.002, "0 resets the view")
    browser.run("const s = document.getElementById('standpoint'); s.value = 3; s.dispatchEvent(new Event('change'))")
    expect(difference(after, pixels(browser)) > 0.02, "the view from a camera is another one")


def share_of(browser, share):
    browser.run(
        "const r = document.getElementById('divide'); r.value = arguments[0]; r.dispatchEvent(new Event('input'))", share
    )
    return pixels(browser)


def check_gallery(browser):
    expect(browser.run("return document.querySelectorAll('#gallery li').length") == VIEWS, "all photographs")
    names = browser.run("return [...document.querySelectorAll('#gallery .name')].map(n => n.textContent)")
    expect(MARKUP in names, "a name like markup is a text")
    expect(browser.run("return document.querySelectorAll('#gallery script, main script').length") == 0, "and no element")
    # One in which a highlight was used.
    first = browser.run(
        "const cards = [...document.querySelectorAll('#gallery button')];"
        "const i = cards.findIndex(c => !c.textContent.includes('0 used')); cards[i].focus(); return i"
    )
    browser.press(["\ue007"])
    expect(browser.run("return document.getElementById('lightbox').open"), "Enter opens a photograph")
    spots = browser.run("return document.querySelectorAll('#lightbox .spot').length")
    expect(spots > 0, f"{spots} highlights in it")
    reasons = set()
    for _ in range(8):
        browser.press([TAB])
        focused = browser.run("return document.activeElement.classList.contains('spot')")
        if focused:
            reasons.add(browser.run("return document.querySelector('#lightbox .reason').textContent"))
    expect(any(r.startswith("Used") for r in reasons), f"Tab says why one was used ({sorted(reasons)[:1]})")
    browser.press([ARROW_RIGHT])
    title = browser.run("return document.querySelector('#lightbox h3').textContent")
    expect(title == names[(first + 1) % VIEWS], f"the arrow key goes to the next ({title})")
    index = names.index(MARKUP)
    browser.press([ESCAPE])
    expect(not browser.run("return document.getElementById('lightbox').open"), "Escape closes it")
    browser.click(f"#gallery li:nth-child({index + 1}) button")
    title = browser.run("return document.querySelector('#lightbox h3').textContent")
    expect(title == MARKUP, "the large view shows the name as a text too")
    smallest = "#lightbox .spot:last-child ellipse.rejected"  # on top of all others
    if browser.run("return Boolean(document.querySelector(arguments[0]))", smallest):
        browser.hover(smallest)
        said = browser.run("return document.querySelector('#lightbox .reason').textContent")
        expect(said.startswith("Rejected: "), f"pointing says why one was rejected ({said})")
    browser.press([ESCAPE])


def check_words(browser):
    text = browser.run("return document.body.innerText")
    for part in ("What to know about this run", "taken as exact", "fixed in the world", "glint run", "To repeat it", "iteration"):
        expect(part in text, f"the page says {part!r}")
    expect(browser.run("return document.querySelectorAll('#plots figure').length") >= 5, "plots of convergence")
    expect(browser.run("return document.querySelectorAll('#advice li').length") >= 1, "advice")
    expect("voxel_rel: 0.03" in browser.run("return document.getElementById('config').textContent"), "configuration")
    browser.run("document.getElementById('theme').click()")
    expect(browser.run("return document.documentElement.dataset.theme") == "dark", "the button makes it dark")
    requests = browser.run("return performance.getEntriesByType('resource').filter(r => !r.name.startsWith('data:')).length")
    expect(requests == 0, f"{requests} requests to elsewhere")


def check_width(browser, what):
    wider = browser.run("return document.documentElement.scrollWidth - document.documentElement.clientWidth")
    expect(wider <= 0, f"{what}: nothing sticks out to the right ({wider} px)")


def check_look(browser, page, folder, name, dark):
    browser.prefer_dark(dark)
    open_page(browser, page)
    settle(browser)
    name += "_dark" if dark else ""
    check_width(browser, name)
    hidden = browser.run(
        "const box = document.querySelector('#lights .scroll'); return box.scrollWidth - box.clientWidth")
    expect(hidden <= 0, f"{name}: the table of lights is seen whole ({hidden} px are not)")
    background = browser.run("return getComputedStyle(document.body).backgroundColor")
    expect((background == "rgb(18, 21, 26)") == dark, f"{name}: its background is {background}")
    if "--screenshots" in sys.argv:
        browser.screenshot(f"{folder}/{name}_top.png")
        for part in ("surface", "photographs"):
            browser.run("document.getElementById(arguments[0]).scrollIntoView()", part)
            settle(browser)
            browser.screenshot(f"{folder}/{name}_{part}.png")
    quiet(browser, name)


def main():
    program, folder = sys.argv[1], os.path.abspath(sys.argv[2])
    if webdriver.missing():
        print(f"skipped: not installed: {', '.join(webdriver.missing())} (scripts/check_report installs them)")
        return 77
    done, gives_up = make_reports(program, folder)
    expect(os.path.getsize(done) < 25e6, f"report.html is {os.path.getsize(done) / 1e6:.1f} MB")
    with webdriver.Browser(*LAPTOP) as browser:
        open_page(browser, done)
        check_viewer(browser)
        check_gallery(browser)
        check_words(browser)
        quiet(browser, "laptop")
        open_page(browser, gives_up)
        expect("no result" in browser.run("return document.body.innerText"), "a run that gave up says so")
        expect("Problem" in browser.run("return document.getElementById('advice').innerText"), "and why")
        quiet(browser, "a run that gave up")
        for dark in (False, True):
            check_look(browser, done, folder, "laptop", dark)
    with webdriver.Browser(*PHONE, touch=True) as browser:
        for dark in (False, True):
            check_look(browser, done, folder, "phone", dark)
    print(f"{checks - failures} passed, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
