"""Discs and ellipses drawn with smooth borders, exact to a small fraction of a pixel.

A pixel's cover falls linearly from one to zero while its distance from the outline goes from
-1/2 to 1/2, whatever the direction of the outline: an edge lies at half height, where it should.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geoprim_core import _check
from geoprim_core._check import FloatArray
from geoprim_core.errors import InputError
from geoprim_core.synthetic import _kernels
from geoprim_core.types import Ellipse, Ellipses

GreyImage = npt.NDArray[np.uint8]

MODES = ("occluded", "overlapping")
DRAWINGS = ("filled", "outlines")
_OUTLINE_SAMPLES = 1440


def disc_image(
    width: int,
    height: int,
    *,
    centre: tuple[float, float],
    radius: float,
    inside: float = 220,
    outside: float = 40,
) -> GreyImage:
    """Draw one disc.

    Parameters
    ----------
    width, height : int
        Size of the image in pixels.
    centre : (x, y) in pixels
    radius : float, in pixels
    inside, outside : float
        Grey levels in [0, 255].

    Returns
    -------
    (height, width) uint8

    Raises
    ------
    InputError
        The radius is not positive or the image has no pixels.

    Examples
    --------
    >>> image = disc_image(40, 30, centre=(20, 15), radius=9)
    >>> int(image[15, 20]), int(image[0, 0]), int(image[15, 29])
    (220, 40, 130)
    """
    x, y = centre
    if not radius > 0:
        raise InputError("radius", "a positive number", f"{radius}")
    disc = Ellipse(float(x), float(y), float(radius), float(radius), 0.0)
    return ellipse_image(width, height, disc, inside=inside, outside=outside)


def ellipse_image(
    width: int, height: int, ellipse: Ellipse, *, inside: float = 220, outside: float = 40
) -> GreyImage:
    """Draw one filled ellipse; as `disc_image`.

    Examples
    --------
    >>> from geoprim_core.types import Ellipse
    >>> image = ellipse_image(60, 40, Ellipse(30, 20, 20, 10, 0.0))
    >>> int(image[20, 50]), int(image[30, 30])
    (130, 130)
    """
    one = Ellipses.from_array([_row(ellipse)])
    levels = np.array([float(inside)])
    return render_ellipses(one, (width, height), levels=levels, background=outside)


def render_ellipses(
    ellipses: Ellipses,
    size: tuple[int, int],
    *,
    kind: str = "occluded",
    drawing: str = "filled",
    levels: FloatArray | float = 220.0,
    background: float = 40.0,
    stroke: float = 1.5,
) -> GreyImage:
    """Draw many ellipses in painter's order or lying through one another.

    ============  ===============================================  ==============================
    kind          filled                                           outlines
    ============  ===============================================  ==============================
    occluded      each disc hides what lies below it               each paper disc hides the lines
                                                                   below it
    overlapping   the step `levels - background` of every disc is  all lines are drawn
                  added to what it covers: one edge, of one
                  contrast and direction, all along each outline
    ============  ===============================================  ==============================

    Parameters
    ----------
    ellipses : Ellipses
        The first lies lowest.
    size : (width, height) in pixels
    kind : "occluded" or "overlapping"
    drawing : "filled" or "outlines"
    levels : (n,) or one number
        Grey levels in [0, 255] of the discs or lines.
    background : float
        Grey level of the ground. Sums of overlapping steps are clipped to [0, 255].
    stroke : float
        Width of the lines in pixels.

    Returns
    -------
    (height, width) uint8

    Raises
    ------
    InputError
        An unknown kind or drawing, or levels that do not match the ellipses.

    Examples
    --------
    >>> pair = Ellipses.from_array([[30, 20, 15, 10, 0.0], [40, 20, 15, 10, 0.0]])
    >>> occluded = render_ellipses(pair, (70, 40), levels=np.array([100.0, 200.0]))
    >>> int(occluded[20, 20]), int(occluded[20, 35])
    (100, 200)
    """
    width, height = _frame(size)
    _choice(kind, MODES, "kind")
    _choice(drawing, DRAWINGS, "drawing")
    if not stroke > 0:
        raise InputError("stroke", "a positive width in pixels", f"{stroke}")
    each = np.full(len(ellipses), levels) if np.ndim(levels) == 0 else levels
    tones = _check.finite(each, "levels", (len(ellipses),))
    image = np.full((height, width), float(background))
    rows = ellipses.array()
    hide = kind == "occluded"
    if drawing == "outlines":
        _kernels.paint_outlines(image, rows, tones, float(background), float(stroke), hide)
    elif hide:
        _kernels.paint_filled(image, rows, tones)
    else:
        _kernels.paint_added(image, rows, tones - background)
    result: GreyImage = _kernels.grey_bytes(image)
    return result


def render_parity(
    ellipses: Ellipses, size: tuple[int, int], *, inside: float = 220, outside: float = 40
) -> GreyImage:
    """Draw discs by the even-odd rule: full contrast at every outline, turning at crossings.

    Examples
    --------
    >>> pair = Ellipses.from_array([[30, 20, 15, 10, 0.0], [40, 20, 15, 10, 0.0]])
    >>> image = render_parity(pair, (70, 40))
    >>> int(image[20, 20]), int(image[20, 35]), int(image[20, 50])
    (220, 40, 220)
    """
    width, height = _frame(size)
    cover = np.zeros((height, width))
    _kernels.paint_parity(cover, ellipses.array())
    result: GreyImage = _kernels.grey_bytes(outside + (inside - outside) * cover)
    return result


def visible_shares(
    ellipses: Ellipses, size: tuple[int, int], *, kind: str = "occluded"
) -> FloatArray:
    """Return the visible share (n,) of each outline, by length.

    Visible is what lies in the frame and, for "occluded", inside no later ellipse.

    Raises
    ------
    InputError
        An unknown kind or a size without pixels.

    Examples
    --------
    >>> pair = Ellipses.from_array([[30, 30, 10, 10, 0.0], [40, 30, 10, 10, 0.0]])
    >>> [round(float(share), 3) for share in visible_shares(pair, (70, 60))]
    [0.667, 1.0]
    """
    width, height = _frame(size)
    _choice(kind, MODES, "kind")
    hide = kind == "occluded"
    result: FloatArray = _kernels.visible_shares(
        ellipses.array(), hide, width, height, _OUTLINE_SAMPLES
    )
    return result


def _row(ellipse: Ellipse) -> list[float]:
    return [ellipse.x, ellipse.y, ellipse.semi_major, ellipse.semi_minor, ellipse.angle]


def _frame(size: object) -> tuple[int, int]:
    frame = _check.image_size(size, "size")
    if frame is None:
        raise InputError("size", "(width, height) in pixels", "None")
    return frame


def _choice(value: str, known: tuple[str, ...], argument: str) -> None:
    if value not in known:
        raise InputError(argument, "one of " + ", ".join(known), _check.describe(value))
