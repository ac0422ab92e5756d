"""The `refined` scheme on scenes whose ellipses are known."""

from __future__ import annotations

import numpy as np
import pytest

from geoprim_core.ecc import detect_ellipses
from geoprim_core.ecc.refined import OUTCOMES, detect_refined, select, trace_refined
from geoprim_core.ecc.refined._kernels_covariance import BLUR_DOUBT
from geoprim_core.ecc.refined.params import RefinedParams
from geoprim_core.edges import EdgeParams, extract_contours
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.evaluation import match_ellipses
from geoprim_core.evaluation.scaling import strewn_arcs
from geoprim_core.fitting import overlap_matrix
from geoprim_core.synthetic import (
    degraded,
    disc_image,
    ellipse_image,
    render_ellipses,
    sorting_sequence,
    thesis_image,
)
from geoprim_core.types import Contours, Ellipse, Ellipses

SIZE = (260, 220)
CROSSING = Ellipses.from_array([[110, 100, 80, 45, 0.4], [140, 115, 70, 50, 2.2]])


def found_in(image, params=None):
    return detect_refined(extract_contours(image), None, params)


def assert_same(found, truth, tolerance):
    """Every true ellipse is found, nothing else, and each number within `tolerance` pixels."""
    assert len(found) == len(truth)
    near = overlap_matrix(truth, found.ellipses).argmax(axis=1)
    assert len(set(near.tolist())) == len(truth)
    rows, wanted = found.ellipses.array()[near], truth.array()
    assert np.abs(rows - wanted)[:, :4].max() < tolerance
    turn = (rows[:, 4] - wanted[:, 4] + np.pi / 2) % np.pi - np.pi / 2
    assert (np.abs(turn) * (wanted[:, 2] - wanted[:, 3])).max() < 2 * tolerance


@pytest.mark.parametrize("radius", [10.0, 14.7, 30.0, 90.25])
def test_a_disc_is_measured_to_a_twentieth_of_a_pixel(radius):
    found = found_in(disc_image(260, 220, centre=(128.3, 108.6), radius=radius))
    assert_same(found, Ellipses.from_array([[128.3, 108.6, radius, radius, 0.0]]), 0.05)
    assert found.coverage[0] == 1
    assert found.alignment[0] == 1
    assert found.continuity[0] == 1
    assert found.score[0] > 0.8


def test_the_shrinkage_of_the_blur_is_undone():
    image = disc_image(120, 100, centre=(60.2, 49.7), radius=20.0)
    assert abs(found_in(image).ellipses.semi_major[0] - 20.0) < 0.01
    left = found_in(image, RefinedParams(undo_blur=False))
    assert left.ellipses.semi_major[0] - 20.0 == pytest.approx(-0.025, abs=0.01)


@pytest.mark.parametrize("inside", [200, 70])
def test_an_ellipse_is_found_bright_or_dark(inside):
    truth = Ellipse(128.2, 101.4, 70.0, 25.0, 1.1)
    found = found_in(ellipse_image(*SIZE, truth, inside=inside, outside=130))
    assert_same(found, Ellipses.from_array([[128.2, 101.4, 70.0, 25.0, 1.1]]), 0.1)


@pytest.mark.parametrize("kind", ["occluded", "overlapping"])
@pytest.mark.parametrize("drawing", ["filled", "outlines"])
def test_two_crossing_ellipses_are_both_found(kind, drawing):
    levels = np.array([110.0, 220.0]) if drawing == "filled" else np.array([0.0, 0.0])
    background = 40.0 if drawing == "filled" else 235.0
    image = render_ellipses(
        CROSSING, SIZE, kind=kind, drawing=drawing, levels=levels, background=background
    )
    assert_same(found_in(image), CROSSING, 0.35)


def test_two_ellipses_that_overlap_nearly_all_over_are_both_found():
    truth = Ellipses.from_array([[130, 110, 90, 76, 0.3], [130, 110, 90, 76, 0.3 + np.pi / 2]])
    assert overlap_matrix(truth, truth)[0, 1] > RefinedParams().max_overlap
    levels = np.array([110.0, 220.0])
    image = render_ellipses(truth, SIZE, kind="overlapping", levels=levels, background=40.0)
    assert_same(found_in(image), truth, 0.35)


@pytest.mark.parametrize("radius", [5.2, 6.0, 8.0])
def test_a_small_disc_that_touches_another_is_found(radius):
    truth = Ellipses.from_array(
        [[60.2, 50.4, 25, 25, 0.0], [60.2 + 25 + radius, 50.4, radius, radius, 0.0]]
    )
    image = render_ellipses(truth, (130, 100), levels=np.array([200.0, 90.0]), background=30.0)
    assert_same(found_in(image), truth, 0.4)


def test_the_two_arcs_of_an_occluded_ellipse_are_joined():
    truth = Ellipses.from_array([[130, 110, 90, 40, 0.0], [130, 110, 90, 22, np.pi / 2]])
    image = render_ellipses(truth, SIZE, levels=np.array([200.0, 110.0]))
    found = found_in(image)
    assert_same(found, truth, 0.2)
    behind = overlap_matrix(truth, found.ellipses)[0].argmax()
    assert 0.5 < found.coverage[behind] < 0.95


@pytest.mark.parametrize("ink, paper", [(0.0, 235.0), (235.0, 20.0)])
def test_a_drawn_line_gives_one_ellipse_on_its_centre_line(ink, paper):
    truth = Ellipses.from_array([[128, 108, 84, 60, 0.7]])
    levels = np.array([ink])
    image = render_ellipses(truth, SIZE, drawing="outlines", levels=levels, background=paper)
    assert_same(found_in(image), truth, 0.08)
    apart = found_in(image, RefinedParams(stroke_reach=0.0, drawing_reach=0.0))
    assert np.abs(apart.ellipses.semi_major - 84).min() > 0.4


@pytest.mark.parametrize("radius", [7.0, 11.0, 30.0])
@pytest.mark.parametrize("width", [2.0, 3.0, 5.0])
def test_a_drawing_of_one_circle_is_a_line_drawing_however_small(radius, width):
    truth = Ellipses.from_array([[128.3, 108.4, radius, radius, 0.0]])
    image = render_ellipses(
        truth, SIZE, drawing="outlines", levels=np.array([20.0]), background=225.0, stroke=width
    )
    assert_same(found_in(image), truth, 0.5)


@pytest.mark.parametrize("noise", [0.0, 15.0])
def test_texture_with_edges_side_by_side_is_no_line_drawing(noise):
    random = np.random.default_rng(2)
    image = np.full((260, 300), 90.0)
    x = 0
    while x < 300:  # bars of 3 to 6 pixels: most edges have mates, but at no one distance
        width = random.integers(3, 7)
        image[:, x : x + width] = 190.0
        x += width + random.integers(7, 12)
    disc = disc_image(300, 260, centre=(150.4, 130.2), radius=55.0, inside=30, outside=225)
    image = np.where(disc == 225, image, disc) + random.normal(0, noise, disc.shape)
    image = np.clip(image, 0, 255).astype(np.uint8)
    trace = trace_refined(extract_contours(image))
    assert np.mean(trace.edges.stroke != 0.0) < 0.5
    assert_same(trace.detections, Ellipses.from_array([[150.4, 130.2, 55, 55, 0.0]]), 0.6)


def lettered(image, area, ink):
    """Rows of strokes as those of small print, 2 pixels wide, in an area (x, y, width, height)."""
    x0, y0, width, height = area
    for y in range(y0, y0 + height - 8, 12):
        for x in range(x0, x0 + width - 5, 9):
            image[y : y + 8, x : x + 2] = ink
            image[y + 3 * (x % 2) : y + 3 * (x % 2) + 2, x : x + 5] = ink
    return image


@pytest.mark.parametrize("ink, paper", [(20.0, 225.0), (225.0, 40.0)])
def test_a_drawn_circle_among_filled_shapes_is_found_on_its_centre_line(ink, paper):
    drawn = Ellipses.from_array([[70, 70, 45, 45, 0.0]])
    image = render_ellipses(
        drawn, SIZE, drawing="outlines", levels=np.array([ink]), background=paper, stroke=2.0
    )
    for corner in range(3):  # their outlines are several times as long as the circle's
        image[130:210, 15 + 80 * corner : 75 + 80 * corner] = ink
    image[20:120, 140:240] = ink
    assert_same(found_in(image, RefinedParams(stroke_alone=0.7)), drawn, 0.1)


def test_lines_darker_and_brighter_than_the_ground_are_found_on_their_centre_lines():
    drawn = Ellipses.from_array([[100, 108, 84, 60, 0.7], [150, 120, 70, 40, 2.0]])
    levels = np.array([20.0, 225.0])
    image = render_ellipses(
        drawn, SIZE, kind="overlapping", drawing="outlines", levels=levels, background=120.0
    )
    assert_same(found_in(image), drawn, 0.1)
    apart = found_in(image, RefinedParams(both_inks=False, second_look=False))
    assert overlap_matrix(drawn, apart.ellipses).max(axis=1).min() < 0.98


@pytest.mark.parametrize("radius", [6.0, 11.0, 30.0])
def test_a_drawn_circle_among_discs_is_found_on_its_centre_line(radius):
    drawn = Ellipses.from_array([[70.3, 70.6, radius, radius, 0.0]])
    discs = Ellipses.from_array([[180, 60, 45, 45, 0], [170, 160, 40, 40, 0], [60, 160, 45, 45, 0]])
    white, ink = 225.0, np.full(3, 40.0)
    image = render_ellipses(discs, SIZE, levels=ink, background=white).astype(float)
    ring = render_ellipses(drawn, SIZE, drawing="outlines", levels=ink[:1], background=white)
    found = found_in(np.minimum(image, ring).astype(np.uint8))
    assert overlap_matrix(drawn, found.ellipses).max() > 0.95
    assert len(found) == 4


@pytest.mark.parametrize("hidden", [90.0, 250.0])
def test_a_line_that_something_hides_in_part_is_found_on_its_centre_line(hidden):
    drawn = Ellipses.from_array([[110.3, 108.2, 60, 45, 0.4]])
    image = render_ellipses(
        drawn, SIZE, drawing="outlines", levels=np.array([20.0]), background=200.0
    )
    image[:, 140:] = hidden
    assert_same(found_in(image), drawn, 0.3)


@pytest.mark.parametrize("face, drawn", [(140.0, False), (40.0, True)])
def test_a_bright_ring_is_a_rim_unless_the_ground_is_the_same_on_both_sides(face, drawn):
    ring = Ellipses.from_array([[110.3, 100.6, 40.0, 40.0, 0.0], [110.3, 100.6, 37.0, 37.0, 0.0]])
    image = render_ellipses(ring, SIZE, levels=np.array([220.0, face]), background=40.0)
    largest = found_in(image).ellipses.semi_major.max()
    assert abs(largest - (38.5 if drawn else 40.0)) < 0.3
    assert found_in(image, RefinedParams(stroke_evenness=0.0)).ellipses.semi_major.max() < 39.0


def test_the_rim_of_a_coin_is_no_drawn_line():
    scene = next(iter(sorting_sequence("coins", seed=3, frames=1)))
    found = detect_ellipses(scene.image)
    matching = match_ellipses(
        found.ellipses, scene.ellipses, overlap=0.95, uncertain=~scene.required
    )
    assert matching.score().f_measure > 0.9


def test_a_drawn_circle_beside_a_page_of_text_is_found_on_its_centre_line():
    drawn = Ellipses.from_array([[70.4, 110.2, 55, 55, 0.0]])
    image = render_ellipses(
        drawn, SIZE, drawing="outlines", levels=np.array([20.0]), background=225.0, stroke=2.0
    )
    assert_same(found_in(lettered(image, (140, 10, 110, 200), 20)), drawn, 0.1)


@pytest.mark.parametrize("inside", [20, 120])
def test_a_disc_beside_ruled_lines_is_not_moved(inside):
    image = disc_image(*SIZE, centre=(70.4, 110.2), radius=55.0, inside=inside, outside=225)
    for y in range(8, SIZE[1] - 8, 14):
        image[y : y + 2, 136:-6] = 60
    trace = trace_refined(extract_contours(image))
    assert np.mean(trace.edges.stroke != 0.0) > 0.5
    assert_same(trace.detections, Ellipses.from_array([[70.4, 110.2, 55, 55, 0.0]]), 0.05)


def test_drawn_circles_in_noise_are_found_on_their_centre_lines():
    drawn = Ellipses.from_array([[70, 110, 55, 55, 0.0], [180, 70, 35, 35, 0.0]])
    ink = np.array([225.0, 225.0])
    image = render_ellipses(
        drawn, SIZE, drawing="outlines", levels=ink, background=60.0, stroke=2.0
    )
    noise = np.random.default_rng(8).normal(0, 22, image.shape)
    assert_same(found_in(np.clip(image + noise, 0, 255).astype(np.uint8)), drawn, 0.5)


@pytest.mark.parametrize("radius", [5.0, 5.5, 6.3])
@pytest.mark.parametrize("inside", [200, 40])
def test_a_disc_of_five_pixels_is_found(radius, inside):
    image = disc_image(60, 50, centre=(30.3, 24.6), radius=radius, inside=inside, outside=120)
    assert_same(found_in(image), Ellipses.from_array([[30.3, 24.6, radius, radius, 0.0]]), 0.15)


def lame_image(radius, power, turn=0.4, step=6):
    """Return a bright image with a dark |u|^power + |v|^power <= radius^power in its middle."""
    y, x = (np.mgrid[0 : 80 * step, 0 : 80 * step] + 0.5) / step - 0.5
    u = (x - 40.3) * np.cos(turn) + (y - 39.6) * np.sin(turn)
    v = (y - 39.6) * np.cos(turn) - (x - 40.3) * np.sin(turn)
    inside = np.abs(u) ** power + np.abs(v) ** power <= radius**power
    cover = inside.reshape(80, step, 80, step).mean(axis=(1, 3))
    return (200.5 - 160 * cover).astype(np.uint8)


@pytest.mark.parametrize("radius", [4.5, 5.0, 6.0, 7.0])
def test_a_small_patch_that_is_not_quite_round_is_no_disc(radius):
    assert len(found_in(lame_image(radius, 2.0))) == 1
    assert len(found_in(lame_image(radius, 2.5))) == 0
    assert len(found_in(lame_image(radius, 2.5), RefinedParams(small_weight=0.0))) == 1


def test_a_disc_with_a_wavy_outline_is_found():
    y, x = np.mgrid[0:120, 0:140]
    angle = np.arctan2(y - 59.6, x - 70.3)
    outside = np.hypot(x - 70.3, y - 59.6) - 25 - 1.3 * np.cos(3 * angle)
    found = found_in((40 + 160 * np.clip(0.5 - outside, 0, 1)).astype(np.uint8))
    assert_same(found, Ellipses.from_array([[70.3, 59.6, 25, 25, 0.0]]), 1.3)


def test_concentric_rings_are_both_found():
    truth = Ellipses.from_array([[130, 110, 90, 90, 0.0], [130, 110, 65, 65, 0.0]])
    image = render_ellipses(truth, SIZE, levels=np.array([200.0, 90.0]))
    assert_same(found_in(image), truth, 0.1)


def test_an_ellipse_half_out_of_frame_is_found():
    truth = Ellipse(20.0, 110.0, 80.0, 60.0, np.pi / 2)
    found = found_in(ellipse_image(*SIZE, truth))
    assert_same(found, Ellipses.from_array([[20.0, 110.0, 80.0, 60.0, np.pi / 2]]), 0.3)


@pytest.mark.parametrize("seed", range(4))
def test_pure_noise_gives_nothing(seed):
    noise = np.random.default_rng(seed).normal(128, 40, (480, 640))
    assert len(found_in(np.clip(noise, 0, 255).astype(np.uint8))) == 0


def test_straight_lines_give_nothing():
    image = np.full((220, 260), 40, np.uint8)
    image[40:180, 60:200] = 200
    image[90:130] = 120
    assert len(found_in(image)) == 0


@pytest.fixture(scope="module")
def busy():
    return thesis_image(10, seed=5, kind="overlapping")


def test_the_same_image_gives_the_same_bytes(busy):
    first, second = found_in(busy.image), found_in(busy.image)
    assert len(first) >= 9
    assert first.ellipses.array().tobytes() == second.ellipses.array().tobytes()
    assert first.score.tobytes() == second.score.tobytes()
    assert first.covariance.tobytes() == second.covariance.tobytes()


def test_a_quarter_turn_and_a_mirror_give_the_same_ellipses(busy):
    found = found_in(busy.image)
    width = busy.image.shape[1]
    x, y, a, b, angle = found.ellipses.columns()
    mirrored = Ellipses(width - 1 - x, y, a, b, (np.pi - angle) % np.pi)
    assert_same(found_in(np.ascontiguousarray(busy.image[:, ::-1])), mirrored, 0.1)
    turned = Ellipses(y, width - 1 - x, a, b, (angle + np.pi / 2) % np.pi)
    assert_same(found_in(np.ascontiguousarray(np.rot90(busy.image))), turned, 0.1)


def test_the_covariance_is_that_of_many_noisy_pictures():
    truth = Ellipse(80.3, 61.7, 45.0, 28.0, 0.5)
    clean = ellipse_image(160, 120, truth).astype(float)
    random = np.random.default_rng(3)
    rows, claimed = [], []
    for _ in range(150):
        noisy = np.clip(clean + random.normal(0, 12, clean.shape), 0, 255).astype(np.uint8)
        found = found_in(noisy)
        assert len(found) == 1
        rows.append(found.ellipses.array()[0])
        claimed.append(found.covariance[0])
    spread = np.std(rows, axis=0)
    told = np.sqrt(np.mean([np.diag(c) for c in claimed], axis=0))
    assert np.all(told / spread > 0.6)
    # The axes are in doubt also by a blur that the picture may have: at the major axis, where the
    # outline is bent most, by half its variance over the radius of curvature.
    doubt = 0.5 * BLUR_DOUBT / np.array([28.0**2 / 45.0, 45.0**2 / 28.0])
    assert np.all(told[[0, 1, 4]] / spread[[0, 1, 4]] < 1.7)
    assert np.all(told[2:4] < 1.7 * spread[2:4] + doubt)
    for covariance in claimed[:5]:
        assert np.array_equal(covariance, covariance.T)
        assert np.linalg.eigvalsh(covariance).min() > 0


def test_contours_without_gradient_or_sub_pixel_positions_do(busy):
    contours = extract_contours(disc_image(120, 100, centre=(60, 50), radius=30))
    bare = Contours(contours.points, contours.offsets, contours.closed, (120, 100))
    assert_same(detect_refined(bare), Ellipses.from_array([[60, 50, 30, 30, 0.0]]), 0.5)


def test_every_verified_ellipse_is_reported_or_says_why_not(busy):
    trace = trace_refined(extract_contours(busy.image))
    reasons = trace.selection.reasons
    assert len(reasons) == len(trace.verified)
    assert {k for k, reason in enumerate(reasons) if not reason} == set(trace.selection.chosen)
    assert set(reasons) <= set(OUTCOMES)
    assert len(trace.detections) == len(trace.selection.chosen)
    weak = [k for k, reason in enumerate(reasons) if reason == OUTCOMES[0]]
    assert np.all(trace.verified.score[weak] < RefinedParams().min_score)


@pytest.mark.parametrize("min_score", [0.5, 0.8, 0.95])
def test_the_selection_is_that_by_the_evidence_told_whether_or_not_it_was_made_anew(
    busy, min_score
):
    params = RefinedParams(min_score=min_score)
    trace = trace_refined(extract_contours(busy.image), None, params)
    again = select(trace.edges, trace.verified, params)
    assert np.array_equal(again.chosen, trace.selection.chosen)
    assert again.reasons == trace.selection.reasons


def test_the_bounds_on_work_say_when_they_bit(busy):
    contours = extract_contours(busy.image)
    free = trace_refined(contours)
    assert free.candidates.complete
    assert free.verified.complete
    tied = trace_refined(contours, None, RefinedParams(max_pairs=50))
    assert not tied.candidates.complete
    assert 0 < tied.candidates.pairs <= 50
    assert tied.candidates.possible > 50
    tied = trace_refined(contours, None, RefinedParams(max_candidates=3))
    assert not tied.verified.complete
    assert tied.verified.walked == 3


def test_arcs_are_cut_where_an_outline_bends_back():
    t = np.linspace(0, np.pi, 150)
    upper = np.stack([60 - 40 * np.cos(t), 60 - 40 * np.sin(t)], axis=1)
    lower = np.stack([140 - 40 * np.cos(t), 60 + 40 * np.sin(t)], axis=1)
    wave = np.concatenate([upper, lower[1:]])
    trace = trace_refined(Contours(wave, [0, len(wave)], [False], (200, 120)))
    assert len(trace.arcs) == 2
    assert np.abs(trace.arcs.table[:, 17] - 40).max() < 4


def test_wrong_arguments_are_named():
    with pytest.raises(InputError, match="contours"):
        detect_refined(np.zeros((4, 2)))
    empty = Contours(np.zeros((0, 2)), [0], [], (40, 30))
    with pytest.raises(ParameterError, match="params"):
        detect_refined(empty, None, EdgeParams())
    assert len(detect_refined(empty)) == 0


def stadium(width, height, centre, half_length, radius):
    """Return an image of a bright rectangle with half discs at both ends."""
    y, x = np.mgrid[0:height, 0:width]
    along = np.clip(np.abs(x - centre[0]) - half_length, 0, None)
    distance = np.hypot(along, y - centre[1]) - radius
    return (40 + 160 * np.clip(0.5 - distance, 0, 1)).astype(np.uint8)


@pytest.mark.parametrize("half_length", [18, 30])
def test_the_round_ends_of_a_stadium_are_no_circles(half_length):
    image = stadium(260, 220, (130, 110), half_length, 30)
    assert len(found_in(image)) == 0
    blind = found_in(image, RefinedParams(end_weight=0.0))
    assert len(blind) > 0  # its contour goes on: that tells


def test_ellipses_that_cross_are_no_clutter_to_each_other():
    scene = thesis_image(20, seed=11, kind="overlapping")
    found = found_in(scene.image)
    apart = found_in(scene.image, RefinedParams(explain_crossings=False))
    truth = scene.ellipses
    hits = [(overlap_matrix(truth, f.ellipses).max(axis=1) > 0.95).sum() for f in (found, apart)]
    assert hits[0] >= 0.9 * len(truth)
    assert hits[0] >= hits[1]


def test_edges_that_noise_leaves_across_strong_outlines_are_hardly_clutter():
    found = {0.0: 0, RefinedParams().crossing_height: 0}
    for seed in range(24):
        scene = degraded(thesis_image(24, seed=600 + seed), noise=8.0, seed=seed)
        for height in found:
            ellipses = found_in(scene.image, RefinedParams(crossing_height=height)).ellipses
            best = overlap_matrix(scene.ellipses, ellipses).max(axis=1)
            found[height] += int((best > 0.8).sum())
    every, faint = found.values()
    assert faint >= every + 5


@pytest.mark.parametrize(("drawing", "count"), [("outlines", 2), ("filled", 1)])
def test_circles_beside_each_other_are_two_where_they_are_drawn_lines(drawing, count):
    """Of filled ones the two edges may be those of one rim."""
    circles = Ellipses([80, 80], [75, 75], [60, 55], [60, 55], [0, 0])
    image = render_ellipses(circles, (160, 150), drawing=drawing, levels=[200, 120], background=40)
    assert len(found_in(image)) == count


def test_evidence_of_exact_arcs_is_a_number():
    """Gradients exactly along the normals once gave sums of squares that rounding made negative."""
    verified = trace_refined(strewn_arcs(50, 2000.0)).verified
    assert len(verified) > 20
    assert np.isfinite(verified.figures).all()
