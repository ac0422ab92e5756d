"""Letters on pictures: on dimmed ground, so that they are read anywhere, and apart; the legend."""

from __future__ import annotations

from typing import NamedTuple

import cv2
import numpy as np

from geoprim_core._check import AnyArray, FloatArray
from geoprim_core.io.score_colours import score_colours

_FONT = cv2.FONT_HERSHEY_SIMPLEX
_LETTERS = 0.45  # OpenCV's size of letters that are read at scale 1
_DIM = 0.3  # of the brightness, under letters
_PAD = 3.0  # between a legend's edge and what it holds, at scale 1
_LEGEND_SHARE = 0.06  # of a picture, which a legend may cover
_MANY = "000 ellipses"  # a legend is no wider for more ellipses
_WHITE = (255.0, 255.0, 255.0)

Colour = tuple[float, ...]


class Box(NamedTuple):
    """A rectangle of a picture: left, top, right, bottom in pixels."""

    left: float
    top: float
    right: float
    bottom: float

    def overlaps(self, other: Box) -> bool:
        """Tell whether there is an area in common."""
        beside = self.right <= other.left or other.right <= self.left
        return not (beside or self.bottom <= other.top or other.bottom <= self.top)


class Page:
    """A picture that gets texts which do not lie on each other.

    Parameters
    ----------
    canvas : (H, W, 3) uint8, drawn on
    scale : size of the letters, 1 for VGA
    """

    def __init__(self, canvas: AnyArray, scale: float) -> None:
        self.canvas, self.scale = canvas, scale
        self._taken: list[Box] = []
        self._sizes: dict[str, tuple[list[float], list[float]]] = {}

    def size_of(self, text: str) -> tuple[float, float]:
        """Return width and height in pixels of a text of one or more lines, with a margin."""
        widths, heights = self._line_sizes(text)
        return max(widths), sum(heights)

    def reserve(self, box: Box) -> None:
        """Keep texts out of a rectangle."""
        self._taken.append(box)

    def write_at(self, outline: FloatArray, text: str, short: str, colour: Colour) -> bool:
        """Write a text, or else a short one, where there is room at an outline; tell if there is.

        Parameters
        ----------
        outline : (n, 2)
        text, short : str
            The text goes inside in one line or a line a word, else outside.
        """
        stacked = text.replace(" ", "\n")
        for words, inside in ((text, 1), (stacked, 1), (text, 0), (short, 1), (short, 0)):
            for box in self._places(words, outline, bool(inside)) if words else ():
                if not any(box.overlaps(other) for other in self._taken):
                    self.write(words, box, colour)
                    return True
        return False

    def write(self, text: str, box: Box, colour: Colour, *, dimmed: bool = True) -> None:
        """Write a text that fills a box, each line in its middle, and keep later ones out of it."""
        if dimmed:
            dim(self.canvas, box)
        lines = text.split("\n")
        line = (box.bottom - box.top) / len(lines)
        for k, words in enumerate(lines, start=1):
            left = (box.left + box.right - self.size_of(words)[0]) / 2 + 1.5 * self._pen
            place = round(left), round(box.top + k * line - 2.0 * self._pen)
            cv2.putText(
                self.canvas, words, place, _FONT, self._size, colour, self._pen, cv2.LINE_AA
            )
        self.reserve(box)

    @property
    def _size(self) -> float:
        return _LETTERS * self.scale

    @property
    def _pen(self) -> int:
        return max(1, round(self.scale))

    def _line_sizes(self, text: str) -> tuple[list[float], list[float]]:
        if text not in self._sizes:  # a text is asked for at every place, and asking takes time
            self._sizes[text] = self._measured(text.split("\n"))
        return self._sizes[text]

    def _measured(self, lines: list[str]) -> tuple[list[float], list[float]]:
        sizes = [cv2.getTextSize(line, _FONT, self._size, self._pen)[0] for line in lines]
        margin = (4.0 if len(lines) == 1 else 3.0) * self._pen
        return [w + 3.0 * self._pen for w, _ in sizes], [h + margin for _, h in sizes]

    def _places(self, text: str, outline: FloatArray, inside: bool) -> list[Box]:
        """Return where a text could stand: in the middle if it fits, or above, below, beside."""
        wide, high = self.size_of(text)
        (left, top), (right, bottom) = outline.min(axis=0), outline.max(axis=0)
        x, y = (left + right - wide) / 2, (top + bottom - high) / 2
        places = [(x, top - high), (x, bottom), (right, y), (left - wide, y)]
        if inside:
            places = [(x, y)] if self._fits(text, right - left, bottom - top) else []
        return [self._inside(Box(u, v, u + wide, v + high)) for u, v in places]

    def _fits(self, text: str, width: float, height: float) -> bool:
        """Tell whether the corners of every line lie in an upright ellipse of some size."""
        widths, heights = self._line_sizes(text)
        ends = np.cumsum([0.0, *heights]) - sum(heights) / 2
        reach = np.maximum(np.abs(ends[:-1]), np.abs(ends[1:]))
        return bool(((np.array(widths) / width) ** 2 + (2 * reach / height) ** 2 < 1.0).all())

    def _inside(self, box: Box) -> Box:
        """Return a box moved into the picture, as far as it fits."""
        height, width = self.canvas.shape[:2]
        right = max(0.0, min(box.left, width - (box.right - box.left)))
        down = max(0.0, min(box.top, height - (box.bottom - box.top)))
        return Box(right, down, right + box.right - box.left, down + box.bottom - box.top)


def draw_caption(page: Page, text: str) -> None:
    """Write a line into the top left corner; leave it out where it has no room."""
    wide, high = page.size_of(text)
    if wide + 4.0 <= page.canvas.shape[1]:
        page.write(text, Box(2.0, 2.0, 2.0 + wide, 2.0 + high), _WHITE)


class Legend(NamedTuple):
    """The scale of scores under some lines of text."""

    lines: tuple[str, ...]
    low: float
    high: float

    def size(self, page: Page) -> tuple[float, float]:
        """Return width and height in pixels on a page."""
        texts = (*self.lines, _MANY, "  ".join(self._ends))
        wide = max(page.size_of(text)[0] for text in texts)
        pad = 2 * _PAD * page.scale
        return wide + pad, (len(self.lines) + 2) * page.size_of("0")[1] + pad

    def fits(self, page: Page) -> bool:
        """Tell whether it covers no more than a small share of a page."""
        (wide, high), (height, width) = self.size(page), page.canvas.shape[:2]
        room = wide <= width and high <= height
        return bool(room and wide * high <= _LEGEND_SHARE * width * height)

    def draw_in_corner(self, page: Page, busy: AnyArray) -> None:
        """Draw it in the corner with the fewest of some points (n, 2)."""
        height, width = page.canvas.shape[:2]
        self.draw(page, _freest_corner((width, height), self.size(page), busy))

    def draw(self, page: Page, box: Box) -> None:
        """Draw it in a box of its size, and keep texts out of it."""
        dim(page.canvas, box)
        pad, line = _PAD * page.scale, page.size_of("0")[1]
        left, top, right = box.left + pad, box.top + pad, box.right - pad
        for k, text in enumerate(self.lines):
            place = Box(left, top + k * line, right, top + (k + 1) * line)
            page.write(text, place, _WHITE, dimmed=False)
        top += len(self.lines) * line
        _draw_ramp(page.canvas, Box(left, top + 0.2 * line, right, top + 0.9 * line))
        _write_ends(page, self._ends, Box(left, top + line, right, top + 2 * line))
        page.reserve(box)

    @property
    def _ends(self) -> tuple[str, str, str]:
        return f"{self.low:.2f}", "score", f"{self.high:.2f}"


def _freest_corner(picture: tuple[int, int], size: tuple[float, float], busy: AnyArray) -> Box:
    """Return the box in the corner that covers the fewest points; bottom left where equal."""
    width, height = picture
    corners = [(x, y) for y in (height - size[1], 0.0) for x in (0.0, width - size[0])]
    boxes = [Box(x, y, x + size[0], y + size[1]) for x, y in corners]
    return min(boxes, key=lambda box: _points_in(box, busy))


def _points_in(box: Box, points: AnyArray) -> int:
    inside = (points >= box[:2]).all(axis=1) & (points <= box[2:]).all(axis=1)
    return int(np.count_nonzero(inside))


def dim(canvas: AnyArray, box: Box) -> None:
    """Darken a rectangle of a picture."""
    left, top, right, bottom = (max(0, round(v)) for v in box)
    part = canvas[top:bottom, left:right]
    part[:] = (part * _DIM).astype(np.uint8)


def _draw_ramp(canvas: AnyArray, box: Box) -> None:
    left, top, right, bottom = (round(v) for v in box)
    colours = 255 * score_colours(np.linspace(0.0, 1.0, right - left))[:, ::-1]
    canvas[top:bottom, left:right] = colours.round().astype(np.uint8)


def _write_ends(page: Page, texts: tuple[str, str, str], box: Box) -> None:
    for text, share in zip(texts, (0.0, 0.5, 1.0), strict=True):
        wide = page.size_of(text)[0]
        left = box.left + share * (box.right - box.left - wide)
        page.write(text, Box(left, box.top, left + wide, box.bottom), _WHITE, dimmed=False)
