"""Curves as SVG, for a file that needs nothing else: no scripts, no fonts, no network."""
import html

import numpy as np

COLOURS = ("#0b62b5", "#c4510b", "#4c7a1f", "#8a3fa0", "#8a5a00", "#555555")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 620, 210, 74, 10, 26, 34


def ticks(low, high, count=5):
    """Round numbers between low and high."""
    span = high - low
    if not np.isfinite(span) or span <= 0:
        return [low]
    step = 10 ** np.floor(np.log10(span / count))
    step *= next(k for k in (1, 2, 5, 10) if span / (step * k) <= count)
    return [round(one, 12) for one in np.arange(np.ceil(low / step) * step, high + step * 1e-9, step)]


class Chart:
    """Lines and bands over one axis. add() takes x, y and a name; None or NaN in y is a gap."""

    def __init__(self, title, unit, x_name):
        self.title, self.unit, self.x_name = title, unit, x_name
        self.lines, self.marks = [], []

    def add(self, x, y, name, band=None, dash=False, dots=False):
        x, y = np.asarray(x, float), np.asarray([np.nan if v is None else v for v in y], float)
        self.lines.append((x, y, name, None if band is None else np.asarray(band, float), dash, dots))

    def mark(self, x, text):
        self.marks.append((x, text))

    def text(self):
        known = [(x, y, band) for x, y, _, band, _, _ in self.lines if np.isfinite(y).any()]
        if not known:
            return f"<p>{html.escape(self.title)}: nothing was recorded.</p>"
        xs = np.concatenate([x[np.isfinite(y)] for x, y, _ in known])
        low = min(np.nanmin(y - (band if band is not None else 0)) for _, y, band in known)
        high = max(np.nanmax(y + (band if band is not None else 0)) for _, y, band in known)
        margin = max(0.05 * (high - low), 0.01 * max(abs(low), abs(high))) or 1.0  # noise does not fill the picture
        self.x0, self.x1, self.y0, self.y1 = xs.min(), max(xs.max(), xs.min() + 1e-9), low - margin, high + margin
        parts = [f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{html.escape(self.title)}">',
                 f'<text x="{LEFT}" y="16" class="title">{html.escape(self.title)}{", " + html.escape(self.unit) if self.unit else ""}</text>', *self._axes()]
        for number, line in enumerate(self.lines):
            parts += self._line(number, *line)
        for x, text in self.marks:
            parts.append(f'<line x1="{self.px(x):.1f}" x2="{self.px(x):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" class="mark"/>'
                         f'<title>{html.escape(text)}</title>')
        return "".join(parts) + "</svg>"

    def px(self, x):
        return LEFT + (x - self.x0) / (self.x1 - self.x0) * (WIDTH - LEFT - RIGHT)

    def py(self, y):
        return HEIGHT - BOTTOM - (y - self.y0) / (self.y1 - self.y0) * (HEIGHT - TOP - BOTTOM)

    def _axes(self):
        for y in ticks(self.y0, self.y1):
            yield (f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{self.py(y):.1f}" y2="{self.py(y):.1f}" class="grid"/>'
                   f'<text x="{LEFT - 5}" y="{self.py(y) + 4:.1f}" class="tick" text-anchor="end">{y:.6g}</text>')
        for x in ticks(self.x0, self.x1, 8):
            yield f'<text x="{self.px(x):.1f}" y="{HEIGHT - BOTTOM + 14}" class="tick" text-anchor="middle">{x:.6g}</text>'
        yield f'<text x="{WIDTH - RIGHT}" y="{HEIGHT - 4}" class="tick" text-anchor="end">{html.escape(self.x_name)}</text>'

    def _line(self, number, x, y, name, band, dash, dots):
        colour = COLOURS[number % len(COLOURS)]
        if band is not None:
            ring = [(a, b) for a, b in zip(x, y + band)] + [(a, b) for a, b in zip(x[::-1], (y - band)[::-1])]
            yield f'<polygon points="{self._points(ring)}" fill="{colour}" opacity=".18"/>'
        good = np.isfinite(y)
        for piece in np.split(np.arange(len(y)), np.flatnonzero(np.diff(good.astype(int))) + 1):
            if len(piece) and good[piece[0]]:
                yield (f'<polyline points="{self._points(zip(x[piece], y[piece]))}" fill="none" stroke="{colour}" '
                       f'stroke-width="1.6"{" stroke-dasharray=&#39;5 3&#39;" if dash else ""}/>').replace("&#39;", "'")
        if dots:
            yield "".join(f'<circle cx="{self.px(a):.1f}" cy="{self.py(b):.1f}" r="2" fill="{colour}"/>'
                          for a, b in zip(x[good], y[good]))
        yield (f'<text x="{LEFT + 4 + 150 * (number % 4)}" y="{HEIGHT - 4}" class="name" fill="{colour}">'
               f'{html.escape(name)}</text>')

    def _points(self, pairs):
        return " ".join(f"{self.px(a):.1f},{self.py(b):.1f}" for a, b in pairs)


def thin(x, y, points=1200):
    """Least and greatest of each bucket, so that no peak is lost."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    if len(x) <= points:
        return x, y
    size = int(np.ceil(len(x) / (points / 2)))
    count = len(x) // size
    block = y[:count * size].reshape(count, size)
    filled = np.where(np.isnan(block), 0.0, block)
    low, high = filled.argmin(axis=1), filled.argmax(axis=1)
    order = np.sort(np.stack([low, high], axis=1), axis=1) + (np.arange(count) * size)[:, None]
    return x[order.ravel()], y[order.ravel()]
