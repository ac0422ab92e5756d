"""What of an image was found: truth, hits, misses and false ellipses in colours."""

from __future__ import annotations

from typing import Any

from geoprim_core._check import AnyArray
from geoprim_core.errors import InputError
from geoprim_core.evaluation.ground_truth import GroundTruth
from geoprim_core.evaluation.matching import Matching
from geoprim_core.plotting._axes import image_axes
from geoprim_core.plotting.overlays import _outline
from geoprim_core.types import Ellipses

COLOURS = {
    "hit": "#00c853",
    "missed": "#ff9100",
    "false": "#ff1744",
    "uncertain": "#00b0ff",
    "truth": "#ffffff",
}
"""Part -> colour."""


def plot_matching(
    image: AnyArray,
    found: Ellipses,
    truth: GroundTruth,
    matching: Matching,
    ax: Any | None = None,
) -> Any:
    """Draw detections over an image in the colour of what became of them.

    Hits are green, with their true ellipse thin and white below; missed true ellipses are orange,
    false detections red and dashed, uncertain ones (true, or found and not counted) blue. In an
    image that is judged by recall only, unmatched detections are not false: they are blue too.

    Parameters
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4)
    found : Ellipses
    truth : GroundTruth
    matching : Matching
        Of these two.
    ax : matplotlib Axes or None
        None: a new figure without a window.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        The matching is of other ellipses.
    """
    if len(matching.truth_of) != len(found) or len(matching.uncertain) != len(truth.ellipses):
        got = f"{len(matching.truth_of)} and {len(matching.uncertain)}"
        raise InputError("matching", f"one of {len(found)} and {len(truth.ellipses)} ellipses", got)
    axes = image_axes(image, None, ax)
    caught = matching.truth_of[matching.hit]
    unmatched = "uncertain" if truth.recall_only else "false"
    _draw(axes, truth.ellipses.select(caught), "truth", 0.8, "-", f"truth of a hit ({len(caught)})")
    _draw(axes, found.select(matching.hit), "hit", 1.8, "-", f"hit ({matching.hit.sum()})")
    missed = truth.ellipses.select(matching.missed)
    _draw(axes, missed, "missed", 1.8, "-", f"missed ({len(missed)})")
    uncertain = truth.ellipses.select(matching.uncertain)
    _draw(axes, uncertain, "uncertain", 1.0, ":", f"uncertain truth ({len(uncertain)})")
    loose = found.select(matching.false)
    label = f"not judged ({len(loose)})" if truth.recall_only else f"false ({len(loose)})"
    _draw(axes, loose, unmatched, 1.8, "--", label)
    if axes.lines:
        style = {"fontsize": 7, "framealpha": 0.8, "facecolor": "#404040", "labelcolor": "white"}
        axes.legend(loc="upper right", **style)
    return axes


def _draw(axes: Any, ellipses: Ellipses, part: str, width: float, style: str, label: str) -> None:
    before = len(axes.lines)
    for row in ellipses.array():
        x, y = _outline(row)
        axes.plot(x, y, style, color=COLOURS[part], linewidth=width)
    if len(axes.lines) > before:
        axes.lines[-1].set_label(label)
