"""A little drawing on top of Pillow: everything is drawn three times as large and scaled down, for smooth edges."""
import numpy as np
from PIL import Image, ImageDraw, ImageFont

SCALE = 3
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
INK, GREY, BLUE, ORANGE, GREEN, RED = (30, 30, 30), (150, 150, 150), (43, 108, 176), (221, 107, 32), (47, 133, 90), (197, 48, 48)


class Canvas:
    """Coordinates in pixels of the finished picture, y down."""

    def __init__(self, width, height, background=(255, 255, 255)):
        self.size = (width, height)
        self.image = Image.new("RGB", (width * SCALE, height * SCALE), background)
        self.draw = ImageDraw.Draw(self.image)

    def _at(self, p):
        return float(p[0]) * SCALE, float(p[1]) * SCALE

    def line(self, points, color=INK, width=1.5):
        self.draw.line([self._at(p) for p in points], fill=color, width=round(width * SCALE), joint="curve")

    def dashes(self, a, b, color=GREY, width=1.5, step=7):
        a, b = np.asarray(a, float), np.asarray(b, float)
        count = max(1, int(np.linalg.norm(b - a) / step))
        for k in range(0, count, 2):
            self.line([a + (b - a) * k / count, a + (b - a) * min(1, (k + 1) / count)], color, width)

    def arrow(self, a, b, color=INK, width=2.0, head=8):
        a, b = np.asarray(a, float), np.asarray(b, float)
        along = (b - a) / np.linalg.norm(b - a)
        across = np.array([-along[1], along[0]])
        self.line([a, b - along * head * 0.8], color, width)
        self.polygon([b, b - along * head + across * head * 0.4, b - along * head - across * head * 0.4], color)

    def polygon(self, points, color):
        self.draw.polygon([self._at(p) for p in points], fill=color)

    def dot(self, p, radius=4, color=INK):
        x, y = self._at(p)
        r = radius * SCALE
        self.draw.ellipse([x - r, y - r, x + r, y + r], fill=color)

    def ring(self, p, radius, color=GREY, width=1):
        x, y = self._at(p)
        r = radius * SCALE
        self.draw.ellipse([x - r, y - r, x + r, y + r], outline=color, width=round(width * SCALE))

    def text(self, p, text, color=INK, size=15, anchor="lm"):
        self.draw.text(self._at(p), text, fill=color, font=ImageFont.truetype(FONT, size * SCALE), anchor=anchor)

    def paste(self, image, p):
        self.image.paste(image.resize((image.width * SCALE, image.height * SCALE), Image.LANCZOS), tuple(int(v) * SCALE for v in p))

    def finished(self):
        return self.image.resize(self.size, Image.LANCZOS)


def save(image, path, colors=0):
    """A small PNG: with a palette where that is enough."""
    if colors:
        # Where there are many, rare ones count, too: those of a scale would be lost among those of the photographs.
        method, rounds = (Image.Quantize.MAXCOVERAGE, 2) if colors >= 128 else (Image.Quantize.MEDIANCUT, 0)
        image = image.quantize(colors, method=method, dither=Image.Dither.NONE, kmeans=rounds)
    image.save(path, optimize=True)
    print(f"{path}: {image.width} x {image.height}, {path.stat().st_size // 1024} KB")
