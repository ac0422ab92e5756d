"""Rendered pictures with exact ground truth, drawn without any image library.

Every function is deterministic: the same arguments, seed included, give the same bytes.
"""

from geoprim_core.synthetic.assorted import assorted_scenes
from geoprim_core.synthetic.boundaries import (
    SILHOUETTES,
    fill_boundary,
    scaled_curve,
    shrunk_boundary,
    silhouette,
    trace_boundary,
)
from geoprim_core.synthetic.circles import ARRANGEMENTS, circles_image
from geoprim_core.synthetic.degradation import KanungoParams, degrade_curve, degrade_mask
from geoprim_core.synthetic.digitised import (
    DigitisedCurve,
    as_contours,
    digital_circle,
    digital_ellipse,
    digitise,
    flower_curve,
)
from geoprim_core.synthetic.discs import TARGETS, disc_scene, project_circle
from geoprim_core.synthetic.fitting_sets import (
    CONIC_KINDS,
    elliptic_arc,
    noisy_ellipse,
    open_conic,
    random_ellipse,
)
from geoprim_core.synthetic.formula_curves import FORMULA_CURVES, formula_curve
from geoprim_core.synthetic.scene import Scene
from geoprim_core.synthetic.shapes import (
    disc_image,
    ellipse_image,
    render_ellipses,
    render_parity,
    visible_shares,
)
from geoprim_core.synthetic.single import SingleEllipse, single_ellipses
from geoprim_core.synthetic.sorting import sorting_sequence
from geoprim_core.synthetic.sorting_lines import SORTING_LINES, SortingLine, SortingObject
from geoprim_core.synthetic.thesis import ALPHAS, thesis_image, thesis_set
from geoprim_core.synthetic.variants import degraded, rotated

__all__ = [
    "ALPHAS",
    "ARRANGEMENTS",
    "CONIC_KINDS",
    "FORMULA_CURVES",
    "SILHOUETTES",
    "SORTING_LINES",
    "TARGETS",
    "DigitisedCurve",
    "KanungoParams",
    "Scene",
    "SingleEllipse",
    "SortingLine",
    "SortingObject",
    "as_contours",
    "assorted_scenes",
    "circles_image",
    "degrade_curve",
    "degrade_mask",
    "degraded",
    "digital_circle",
    "digital_ellipse",
    "digitise",
    "disc_image",
    "disc_scene",
    "ellipse_image",
    "elliptic_arc",
    "fill_boundary",
    "flower_curve",
    "formula_curve",
    "noisy_ellipse",
    "open_conic",
    "project_circle",
    "random_ellipse",
    "render_ellipses",
    "render_parity",
    "rotated",
    "scaled_curve",
    "shrunk_boundary",
    "silhouette",
    "single_ellipses",
    "sorting_sequence",
    "thesis_image",
    "thesis_set",
    "trace_boundary",
    "visible_shares",
]
