"""Detectors side by side: what is counted, what a foreign one may do, and what the curves say."""

from __future__ import annotations

import csv
import io
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from geoprim_core.errors import InputError, ParameterError
from geoprim_core.evaluation import GroundTruth
from geoprim_core.evaluation.ablation import (
    DEPARTURES,
    Departure,
    ablation_detectors,
    ablation_markdown,
)
from geoprim_core.evaluation.benchmark_sets import BENCHMARK_SETS, BenchmarkImage
from geoprim_core.evaluation.comparison import compare_detectors
from geoprim_core.evaluation.comparison_tables import (
    alpha_curve,
    comparison_csv,
    comparison_images_csv,
    comparison_markdown,
    comparison_rows,
    precision_recall,
    summary_markdown,
    worst_images,
    worst_markdown,
)
from geoprim_core.evaluation.peers import OwnDetector, Peer, Run, as_bytes, ellipse_rows
from geoprim_core.evaluation.scaling import fitted_exponent, noise_image, strewn_arcs, tiled_image
from geoprim_core.evaluation.stability import CHANGES, changed_images, stability_markdown
from geoprim_core.plotting import (
    plot_alpha,
    plot_growth,
    plot_matching,
    plot_precision_recall,
    plot_time_accuracy,
)
from geoprim_core.synthetic import disc_image, ellipse_image
from geoprim_core.types import Ellipse, Ellipses

ROOT = Path(__file__).resolve().parents[2]
DISC = disc_image(120, 100, centre=(60, 50), radius=30)


@dataclass
class Told:
    """A detector that is told what to answer, image by image."""

    name: str
    answers: list

    def __post_init__(self):
        self.turn = 0

    def run(self, image):
        answer = self.answers[max(self.turn - 1, 0)]  # the first image comes twice
        self.turn += 1
        return answer

    def close(self):
        pass


def answer(rows, score=None, seconds=0.001):
    return Run(
        Ellipses.from_array(rows), None if score is None else np.array(score, float), seconds
    )


def image(name, rows, alpha=None, **more):
    truth = GroundTruth(name, Ellipses.from_array(rows), group=more.pop("group", "g"), **more)
    return BenchmarkImage(DISC, truth, alpha)


A, B, C = [50, 50, 20, 10, 0.3], [90, 30, 15, 15, 0.0], [20, 80, 9, 6, 1.0]
FAR = [300, 300, 9, 9, 0.0]


def compare(detectors, images, overlaps=(0.8,), **more):
    return compare_detectors(detectors, ((i, overlaps) for i in images), **more)


def test_a_perfect_detector_has_f_one_and_one_that_says_all_twice_half_the_precision():
    images = [image("1", [A, B], 2), image("2", [A, B, C], 3)]
    perfect = Told("perfect", [answer([A, B]), answer([C, B, A])])
    twice = Told("twice", [answer([A, A, B, B]), answer([A, B, C, A, B, C])])
    blind = Told("blind", [answer([]), answer([])])
    found = compare([perfect, twice, blind], images)
    rows = {r.detector: r for r in comparison_rows(found)}
    assert rows["perfect"].means == (1, 1, 1)
    assert (rows["twice"].score.precision, rows["twice"].score.recall) == (0.5, 1)
    assert rows["twice"].means == pytest.approx((1 / 2, 1, 2 / 3))
    assert (rows["blind"].score.recall, rows["blind"].score.misses) == (0, 5)
    assert rows["blind"].means == pytest.approx((np.nan, 0, 0), nan_ok=True)
    line = comparison_markdown(found).splitlines()[-1]
    assert line.startswith("| g | 0.8 | blind | 2 | - | 0.000 | 0.000 | - | 0.000 | 0.000 |")
    last = list(csv.DictReader(io.StringIO(comparison_csv(found))))[-1]
    assert (last["mean_precision"], last["precision"], last["f_measure"]) == ("", "", "0.0")
    assert np.isnan(plot_alpha(found, "g", 0.8, "precision").lines[2].get_ydata()).all()


def test_the_time_ratio_is_the_median_of_the_ratios_image_by_image():
    images = [image(str(k), [A]) for k in range(3)]
    ours = Told("ours", [answer([A], seconds=s) for s in (0.01, 0.03, 0.4)])
    peer = Told("peer", [answer([A], seconds=s) for s in (0.01, 0.01, 0.1)])
    found = compare([ours, peer], images, reference="peer")
    rows = {row.detector: row for row in comparison_rows(found)}
    assert rows["ours"].time_ratio == pytest.approx(3)  # of 1, 3, 4; of the medians also 3
    assert rows["peer"].time_ratio == 1
    assert rows["ours"].median_ms == pytest.approx(30)


def test_of_the_repeats_the_least_time_counts():
    times = iter([9.0, 0.5, 0.2, 0.3])  # the first is the warm-up

    class Waning(Told):
        def run(self, image):
            return answer([A], seconds=next(times))

    (measured,) = compare([Waning("waning", [])], [image("1", [A])], repeat=3).measurements
    assert measured.run.seconds == 0.2


def test_an_image_without_an_answer_is_counted_told_and_scored_as_empty():
    failed = Run(Ellipses.from_array([]), None, float("nan"), "no answer within 1 s")
    odd = Told("odd", [answer([A]), failed])
    steady = Told("steady", [answer([A]), answer([B])])
    found = compare([odd, steady], [image("1", [A]), image("2", [B])])
    rows = {row.detector: row for row in comparison_rows(found)}
    assert (rows["odd"].failed, rows["odd"].score.misses) == (1, 1)
    assert rows["odd"].time_ratio == pytest.approx(1)
    assert "odd on g/2: no answer within 1 s" in comparison_markdown(found)
    lines = list(csv.DictReader(io.StringIO(comparison_images_csv(found))))
    assert [line["problem"] for line in lines if line["image"] == "2"] == [failed.problem, ""]


def test_images_judged_by_recall_only_have_rows_of_their_own():
    images = [image("1", [A]), image("2", [A, B], recall_only=True)]
    found = compare([Told("d", [answer([A, FAR]), answer([A, FAR])])], images)
    full, partly = comparison_rows(found)
    assert (full.score.false, full.score.recall) == (1, 1)
    assert (partly.score.false, partly.score.recall) == (None, 0.5)
    table = list(csv.DictReader(io.StringIO(comparison_csv(found))))
    assert [line["use"] for line in table] == ["full", "recall-only"]
    assert "g (recall only)" in comparison_markdown(found)


def test_the_summary_has_a_line_a_set_and_a_column_a_detector():
    images = [
        image("1", [A, B]), image("2", [A], recall_only=True), image("3", [], group="noise"),
    ]  # fmt: skip
    ours = Told("ours", [answer([A]), answer([A, C]), answer([A])])
    peer = Told("peer", [answer([B, A], seconds=0.004), answer([]), answer([])])
    lines = summary_markdown(compare([ours, peer], images)).splitlines()
    assert lines[0] == "| set | overlap | images | ours | peer |"
    assert lines[2] == (
        "| g | 0.8 | 1 | 0.667 (0.667), 1.0 ms, x 0.25 | 1.000 (1.000), 4.0 ms, x 1.00 |"
    )
    assert lines[3].startswith("| g (recall) | 0.8 | 1 | 1.000 (1.000), 1.0 ms,")
    assert lines[4].startswith("| noise | 0.8 | 1 | 1 false, 1.0 ms, x 1.00 | 0 false,")


def test_the_precision_recall_curve_follows_the_falling_scores():
    found = compare([Told("d", [answer([A, FAR, B], [0.9, 0.8, 0.7])])], [image("1", [A, B, C])])
    recall, precision = precision_recall(found.of("d"), 0.8)
    assert recall == pytest.approx([1 / 3, 1 / 3, 2 / 3])
    assert precision == pytest.approx([1, 1 / 2, 2 / 3])
    axes = plot_precision_recall(found, "g", 0.8)
    np.testing.assert_allclose(axes.lines[0].get_xdata(), recall)
    with pytest.raises(InputError, match=r"measured: 0\.8"):
        precision_recall(found.of("d"), 0.9)


def test_without_scores_or_with_equal_ones_there_is_one_point():
    for score in (None, [0.5, 0.5, 0.5]):
        found = compare([Told("d", [answer([FAR, A, B], score)])], [image("1", [A, B, C])])
        recall, precision = precision_recall(found.of("d"), 0.8)
        assert (recall.tolist(), precision.tolist()) == ([2 / 3], [2 / 3])


def test_uncertain_ellipses_are_on_no_curve():
    uncertain = image("1", [A, B], uncertain=np.array([False, True]))
    found = compare([Told("d", [answer([B, A], [0.9, 0.8])])], [uncertain])
    recall, precision = precision_recall(found.of("d"), 0.8)
    assert (recall.tolist(), precision.tolist()) == ([1], [1])


def test_the_alpha_curve_has_the_means_of_each_number_of_ellipses():
    images = [image("1", [A], 4), image("2", [B], 4), image("3", [C], 8)]
    found = compare([Told("d", [answer([A]), answer([]), answer([C, FAR])])], images)
    alphas, curve = alpha_curve(found.of("d"), 0.8)
    assert alphas.tolist() == [4, 8]
    np.testing.assert_allclose(curve, [[1, 0.5, 0.5], [0.5, 1, 2 / 3]])
    line = plot_alpha(found, "g", 0.8, "recall").lines[0]
    np.testing.assert_allclose(line.get_ydata(), [0.5, 1])
    with pytest.raises(InputError):
        plot_alpha(found, "g", 0.8, "accuracy")


def test_the_worst_images_are_told_with_what_was_missed_and_what_was_false():
    images = [image("good", [A]), image("bad", [A, B]), image("worse", [C])]
    found = compare([Told("d", [answer([A]), answer([A]), answer([FAR], [0.75])])], images)
    assert [m.truth.name for m in worst_images(found.of("d"), 0.8)] == ["worse", "bad"]
    table = worst_markdown(found.of("d"), 0.8).splitlines()
    assert table[2] == "| worse | 0.000 | 20, 80; 9 x 6 | 300, 300; 9 x 9; 0.75 |"
    assert table[3] == "| bad | 0.667 | 90, 30; 15 x 15 |  |"


def test_a_picture_of_a_matching_has_every_ellipse_in_its_colour():
    certain = image("1", [A, B, C], uncertain=np.array([False, False, True]))
    found = compare([Told("d", [answer([A, FAR])])], [certain])
    (m,) = found.measurements
    axes = plot_matching(DISC, m.run.ellipses, m.truth, m.matching(0.8))
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == [
        "truth of a hit (1)", "hit (1)", "missed (1)", "uncertain truth (1)", "false (1)",
    ]  # fmt: skip
    with pytest.raises(InputError):
        plot_matching(DISC, Ellipses.from_array([A]), m.truth, m.matching(0.8))


def test_time_against_accuracy_has_a_point_a_detector_and_set():
    images = [image("1", [A], group="g"), image("2", [B], group="h")]
    detectors = [Told(name, [answer([A], seconds=0.002)] * 2) for name in "xy"]
    axes = plot_time_accuracy(compare(detectors, images))
    points = [line.get_xydata()[0].tolist() for line in axes.lines if len(line.get_xdata())]
    assert points == [[2, 1], [2, 1], [2, 0], [2, 0]]


PEER = """
import os, sys, time
import numpy as np

def echo(image):
    print("a detector may print")
    return [[image.shape[1], image.shape[0], image.ndim + 7, image[..., -1].mean() / 99, -0.5, .7]]

def odd(image):
    tone = int(image.ravel()[0])
    if tone == 1:
        raise ValueError("too dark for me")
    if tone == 2:
        time.sleep(60)
    if tone == 3:
        print("the last words", file=sys.stderr, flush=True)
        os._exit(3)
    if tone == 4:
        return [[1, 2, 3]]
    if tone == 5:
        return [[9, 9, 5, 4, 0], [1, 2, 3, np.nan, 0]]
    if tone == 6:
        return [[1, 2, 3, 4, 0]]
    if tone == 7:
        return "circles"
    return np.zeros((0, 5))

def sleeper(image):
    time.sleep(0.15)
    return []

number = 7
"""


@pytest.fixture(scope="module")
def peer_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("peers") / "peer.py"
    path.write_text(PEER)
    return path


def tone(value):
    return np.full((20, 30), value, np.uint8)


def test_a_peer_sees_the_image_and_its_rows_come_back(peer_file):
    peer = Peer("echo", f"{peer_file}:echo")
    try:
        colour = np.zeros((20, 30, 3), np.uint8)
        colour[:, :, 2] = 198
        run = peer.run(colour)
    finally:
        peer.close()
    assert run.problem == ""
    np.testing.assert_allclose(run.ellipses.array(), [[30, 20, 10, 2, np.pi - 0.5]])
    assert run.score.tolist() == [0.7]
    assert 0 < run.seconds < 20


def test_what_a_peer_does_wrong_is_told_and_the_next_image_is_answered(peer_file):
    peer = Peer("odd", f"{peer_file}:odd", time_limit=1.0)
    said = {
        1: "ValueError: too dark for me",
        2: "no answer within 1 s",
        3: "ended with code 3: the last words",
        4: "an array (n, 5) or (n, 6)",
        5: "in row 1",
        6: "semi_major >= semi_minor > 0",
        7: "could not convert",
    }
    try:
        for number, words in said.items():
            assert words in peer.run(tone(number)).problem
            assert peer.run(tone(0)).problem == "", f"after {words}"
    finally:
        peer.close()


def test_the_time_of_a_peer_is_that_inside_its_detector(peer_file):
    peer = Peer("sleeper", f"{peer_file}:sleeper")
    start = time.perf_counter()
    try:
        found = compare([peer, Told("d", [answer([], seconds=0.05)])], [image("1", [])])
    finally:
        peer.close()
    elapsed = time.perf_counter() - start
    slow = comparison_rows(found)[0]
    assert slow.time_ratio >= 3  # 0.15 s of sleep and more over 0.05 s
    assert 2 * slow.median_ms / 1e3 < 2 * elapsed


def test_sleep_costs_time_but_no_processor(peer_file):
    peer = Peer("sleeper", f"{peer_file}:sleeper", clock="processor")
    try:
        seconds = min(peer.run(tone(0)).seconds for _ in range(2))
    finally:
        peer.close()
    assert seconds < 0.15


@pytest.mark.parametrize(
    ("target", "python", "said"),
    [
        ("FILE:absent", None, "absent"),
        ("FILE:number", None, "not callable"),
        ("no_such_module_here:detect", None, "no_such_module_here"),
        ("/nowhere/peer.py:detect", None, "no file"),
        ("FILE", None, "expected module:callable"),
        ("FILE:echo", "/nowhere/python", "/nowhere/python"),
    ],
)
def test_a_peer_that_cannot_be_loaded_is_refused(target, python, said, peer_file):
    with pytest.raises(InputError, match=said):
        Peer("p", target.replace("FILE", str(peer_file)), python=python)


def test_a_plain_opencv_peer_finds_a_disc():
    peers = ROOT / "benchmarks" / "peer_contours.py"
    for name in ("fit_contours", "hough_circles"):
        peer = Peer(name, f"{peers}:{name}", python=sys.executable)
        try:
            found = compare([peer], [BenchmarkImage(DISC, GroundTruth("d", DISC_TRUTH))])
        finally:
            peer.close()
        assert comparison_rows(found)[0].score.recall == 1, name


DISC_TRUTH = Ellipses.from_array([[60, 50, 30, 30, 0]])


def test_images_reach_a_peer_as_bytes_without_alpha():
    deep = np.array([[0, 256], [65535, 40000]], np.uint16)
    assert as_bytes(deep).tolist() == [[0, 1], [255, 156]]
    assert as_bytes(np.array([[-1.0, 0.0], [1.0, 1.0]])).tolist() == [[0, 128], [255, 255]]
    assert as_bytes(np.zeros((4, 5, 4), np.uint8)).shape == (4, 5, 3)


def test_no_rows_are_no_ellipses():
    for nothing in ([], np.zeros((0, 5)), np.zeros((0, 6))):
        assert len(ellipse_rows(nothing)[0]) == 0


def test_what_cannot_be_compared_is_refused():
    told = Told("d", [answer([])])
    for call in (
        lambda: compare([], [image("1", [A])]),
        lambda: compare([told, told], [image("1", [A])]),
        lambda: compare([told], [image("1", [A])], reference="e"),
        lambda: compare([told], [image("1", [A])], repeat=0),
        lambda: Peer("p", "a:b", time_limit=0),
        lambda: Peer("p", "a:b", time_limit=np.inf),
        lambda: Peer("p", "a:b", clock="sundial"),
    ):
        with pytest.raises(InputError):
            call()


@pytest.mark.parametrize("departure", DEPARTURES, ids=lambda departure: departure.name)
def test_a_departure_changes_what_it_says_and_nothing_else(departure):
    whole, without = ablation_detectors([departure])
    before, after = whole.params.to_dict(), without.params.to_dict()
    changed = {name: value for name, value in after.items() if value != before[name]}
    assert changed == departure.changes


def test_the_departures_have_names_of_their_own():
    assert len({departure.name for departure in DEPARTURES}) == len(DEPARTURES)
    with pytest.raises(ParameterError):
        ablation_detectors([Departure("x", {"edges.colours": "gray"}, "")])


def test_without_colour_edges_a_disc_of_equal_lightness_is_lost():
    """Blue and red of one lightness: there is no edge in the gray image."""
    cover = disc_image(120, 100, centre=(60, 50), radius=30, inside=255, outside=0) / 255.0
    blue, red = np.array([200.0, 60, 20]), np.array([20.0, 60, 88.5])
    colours = red + cover[:, :, None] * (blue - red)
    flat = BenchmarkImage((colours + 0.5).astype(np.uint8), GroundTruth("d", DISC_TRUTH, group="g"))
    chosen = [d for d in DEPARTURES if d.name == "strongest colour channel"]
    found = compare(ablation_detectors(chosen), [flat], reference="everything")
    heading, _, whole, without = ablation_markdown(found).splitlines()
    assert heading.startswith("| without | g 0.8 |")
    assert whole.startswith("| nothing (F) | 1.000 |")
    assert without.startswith("| strongest colour channel | -1.000 |")


@pytest.mark.parametrize("name", CHANGES)
def test_the_truth_of_a_changed_image_lies_on_its_ellipse(name):
    e = Ellipse(70, 44, 31, 14, 0.6)
    plain = BenchmarkImage(
        ellipse_image(130, 90, e, inside=200, outside=0),
        GroundTruth("e", Ellipses.from_array([[e.x, e.y, e.semi_major, e.semi_minor, e.angle]])),
    )
    changed = {i.truth.group: i for i, _ in changed_images([(plain, (0.8,))])}[f" | {name}"]
    (true,) = changed.truth.ellipses
    expected = ellipse_image(*changed.image.shape[::-1], true, inside=200, outside=0)
    scale = 1.01 if name.startswith("gain") else 1.0
    assert np.abs(changed.image - scale * expected).max() <= 1.5


def test_a_detector_that_stands_still_is_found_unstable():
    """The circle lies right of the middle: mirrored or turned, it is elsewhere."""
    right = [80, 50, 15, 15, 0.0]
    still = Told("still", [answer([right])] * 5)
    plain = BenchmarkImage(DISC, GroundTruth("1", Ellipses.from_array([right]), group="g"))
    table = stability_markdown(compare_detectors([still], changed_images([(plain, (0.8,))])))
    row = table.splitlines()[2]
    assert row == "| g | 0.8 | still | 1.000 | -1.000 | -1.000 | +0.000 | +0.000 | 1.000 |"


def test_arcs_for_scaling_carry_the_normal_of_their_curve():
    contours = strewn_arcs(20)
    assert len(contours) == 20
    for k in range(20):
        part = slice(contours.offsets[k] + 1, contours.offsets[k + 1] - 1)
        along = np.gradient(contours.subpixel, axis=0)[part]
        angle = contours.gradient_angle[part]
        across = along[:, 0] * np.cos(angle) + along[:, 1] * np.sin(angle)
        assert np.abs(across / np.hypot(*along.T)).max() < 0.01
    steps = np.diff(contours.subpixel[: contours.offsets[1]], axis=0)
    assert np.hypot(*steps.T).max() < 2


def test_a_photograph_is_mirrored_on_beyond_its_border():
    photograph = np.random.default_rng(0).integers(0, 255, (30, 40, 3)).astype(np.uint8)
    grown = tiled_image(photograph)(100, 70)
    assert grown.shape == (70, 100, 3)
    assert (grown[:30, 40:80] == photograph[:, ::-1]).all()
    assert (grown[30:60, :40] == photograph[::-1]).all()
    assert (tiled_image(photograph)(20, 10) == photograph[:10, :20]).all()
    assert (noise_image(20, 10) == noise_image(20, 10)).all()


def test_an_exponent_is_fitted_to_known_times_only():
    size = np.array([1.0, 10, 100, 1000])
    seconds = np.array([np.nan, 3.0, 30.0, 300.0])
    assert fitted_exponent(size, seconds) == pytest.approx(1)
    assert np.isnan(fitted_exponent(size[:2], seconds[:2]))


def test_growth_is_drawn_with_the_exponents_of_its_stages():
    from geoprim_core.evaluation.scaling import Growth, growth_markdown

    size = np.array([10.0, 100, 1000])
    seconds = np.column_stack([np.full(3, np.nan), size, size**2]) * 1e-6
    growth = Growth("arcs", "arcs", size, 2 * size, size / 10, seconds)
    labels = [t.get_text() for t in plot_growth(growth).get_legend().get_texts()]
    assert "| arcs | 100 arcs | 200 | 10 |  | 0.10 |" in growth_markdown([growth])
    assert labels[:2] == ["polygons: exponent 1.00", "ecc: exponent 2.00"]
    assert "| arcs | exponent in arcs |  |  |  | 1.00 | 2.00 |" in growth_markdown([growth])


def test_our_detector_answers_a_set_without_a_problem():
    images = list(BENCHMARK_SETS["circles_clean"].images(1))
    (measured,) = compare([OwnDetector("refined")], images).measurements
    assert measured.run.problem == ""
    assert OwnDetector("refined").run(np.zeros((0, 5))).problem != ""
