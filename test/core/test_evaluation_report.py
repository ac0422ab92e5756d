"""Ground-truth files are read as written, and a report sums up what was scored."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest

from geoprim_core.errors import FileError, InputError
from geoprim_core.evaluation import (
    POOLED,
    GroundTruth,
    ImageScore,
    Report,
    Score,
    evaluate_images,
    load_ground_truth,
    score_sequence,
)
from geoprim_core.plotting import plot_contours, plot_detections, plot_scores
from geoprim_core.synthetic import thesis_image
from geoprim_core.types import Contours, Detections, EllipseDetections, Ellipses


def write(folder, name, content):
    (folder / name).write_text(json.dumps(content))


def entry(theta, **more):
    return {"xc": 30.5, "yc": 20, "a": 12.0, "b": 8.0, "theta_deg": theta, **more}


def test_a_file_is_read_as_written(tmp_path):
    (tmp_path / "gt").mkdir()
    (tmp_path / "cups").mkdir()
    (tmp_path / "cups" / "two.png").write_bytes(b"")
    content = {
        "image": "cups/two.png",
        "ellipses": [entry(-45.0), entry(90.0, uncertain=True), entry(0.0, a=8.0, b=12.0)],
        "use": "recall-only",
    }
    write(tmp_path / "gt", "cups__two.json", content)
    write(tmp_path, "manifest.json", {"licence": "CC0"})  # of another kind
    (truth,) = load_ground_truth(tmp_path)
    assert load_ground_truth(tmp_path / "gt")[0].path == truth.path == tmp_path / "cups/two.png"
    assert (truth.name, truth.group, truth.recall_only) == ("cups/two.png", "cups", True)
    assert truth.uncertain.tolist() == [False, True, False]
    # -45 degrees is 135; where b is the larger one it becomes the major axis, a quarter turn on
    np.testing.assert_allclose(truth.ellipses.angle, np.deg2rad([135, 90, 90]))
    np.testing.assert_allclose(truth.ellipses.semi_major, 12)
    np.testing.assert_allclose(truth.ellipses.x, 30.5)


def test_an_image_without_ellipses_is_a_truth_too(tmp_path):
    write(tmp_path, "empty.json", {"image": "empty.png", "ellipses": []})
    (truth,) = load_ground_truth(tmp_path)
    assert len(truth.ellipses) == 0
    assert not truth.recall_only


@pytest.mark.parametrize(
    "content",
    [
        {"image": "a.png", "ellipses": [{"xc": 1, "yc": 2}]},
        {"image": "a.png", "ellipses": [entry(0.0, a=-3.0, b=-5.0)]},
        {"image": "a.png", "ellipses": [entry(0.0, a="wide")]},
        {"image": "a.png", "ellipses": 7},
        {"image": "a.png", "ellipses": [], "use": "sometimes"},
    ],
)
def test_a_wrong_file_is_named(tmp_path, content):
    write(tmp_path, "wrong.json", content)
    with pytest.raises(FileError, match=r"wrong\.json"):
        load_ground_truth(tmp_path)


def test_text_that_is_no_json_and_a_folder_without_files_are_refused(tmp_path):
    with pytest.raises(FileError, match="no ground-truth files"):
        load_ground_truth(tmp_path)
    (tmp_path / "broken.json").write_text("{")
    with pytest.raises(FileError, match=r"broken\.json"):
        load_ground_truth(tmp_path)


IMAGES = (
    ImageScore("1", "cans", 0.8, Score(1, 0, 0)),
    ImageScore("2", "cans", 0.8, Score(1, 3, 1)),
    ImageScore("3", "coins", 0.8, Score(4, 0, 0)),
    ImageScore("4", "cups", 0.8, Score(2, 2, None)),
    ImageScore("1", "cans", 0.95, Score(0, 1, 1)),
)


def test_a_row_has_pooled_counts_and_means_over_the_images():
    rows = {(row.group, row.overlap): row for row in Report(IMAGES).rows}
    cans = rows["cans", 0.8]
    assert (cans.images, cans.score) == (2, Score(2, 3, 1))
    assert cans.mean_f_measure == pytest.approx((1 + 2 / 6) / 2)
    assert cans.score.f_measure == pytest.approx(4 / 8)
    assert rows[POOLED, 0.8].score == Score(6, 3, 1)  # without the recall-only images
    assert rows["cups", 0.8].score == Score(2, 2, None)
    assert rows["cans", 0.95].score == Score(0, 1, 1)


def test_the_tables_hold_the_rows():
    report = Report(IMAGES)
    lines = list(csv.DictReader(io.StringIO(report.csv())))
    assert len(lines) == len(report.rows)
    cans = next(line for line in lines if (line["group"], line["overlap"]) == ("cans", "0.8"))
    assert (cans["hits"], cans["false"], cans["f_measure"]) == ("2", "1", "0.5")
    cups = next(line for line in lines if line["group"] == "cups")
    assert (cups["use"], cups["false"], cups["recall"], cups["precision"]) == (
        "recall-only",
        "",
        "0.5",
        "",
    )
    table = report.markdown().splitlines()
    assert len({line.count("|") for line in table}) == 1
    assert "| cups (recall only) | 0.8 | 1 | 2 | 2 | - | - | 0.500 | - | - | 0.500 | - |" in table
    images = list(csv.DictReader(io.StringIO(report.csv_images())))
    assert [line["hits"] for line in images] == ["1", "1", "4", "2", "0"]


def test_a_detector_that_never_answers_has_no_precision_anywhere():
    silent = Report((ImageScore("1", "cans", 0.8, Score(0, 3, 0)),))
    assert silent.markdown().splitlines()[2].split(" | ")[6:] == [
        "-", "0.000", "0.000", "-", "0.000", "0.000 |",
    ]  # fmt: skip
    (line,) = csv.DictReader(io.StringIO(silent.csv()))
    assert (line["precision"], line["mean_precision"]) == ("", "")
    assert (line["recall"], line["f_measure"], line["mean_f_measure"]) == ("0.0", "0.0", "0.0")


def test_the_mean_precision_is_that_of_the_images_where_something_was_found():
    scores = [Score(1, 0, 1), Score(0, 2, 0)]
    (row,) = Report(tuple(ImageScore(str(s), "g", 0.8, s) for s in scores)).rows
    assert (row.mean_precision, row.mean_recall) == (0.5, 0.5)
    assert row.mean_f_measure == pytest.approx(1 / 3)  # of both


def test_a_bar_without_a_measure_says_so():
    nothing = Report((ImageScore("1", "cups", 0.8, Score(0, 0, None)),))
    axes = plot_scores(nothing)
    assert [text.get_text() for text in axes.texts] == ["-"]
    assert axes.patches[0].get_width() == 0


def test_reports_are_joined():
    assert (Report(IMAGES[:2]) + Report(IMAGES[2:])).csv() == Report(IMAGES).csv()


def test_a_detector_that_knows_the_truth_is_perfect_and_a_blind_one_finds_nothing(tmp_path):
    scenes = {f"{seed}.png": thesis_image(4, seed) for seed in range(3)}
    truth = [GroundTruth(n, s.ellipses, path=tmp_path / n) for n, s in scenes.items()]
    known = {scene.image.tobytes(): scene.ellipses for scene in scenes.values()}

    def read(path):
        return scenes[path.name].image

    perfect = evaluate_images(lambda image: known[image.tobytes()], truth, read)
    blind = evaluate_images(lambda image: EllipseDetections.empty(), truth, read)
    count = sum(len(scene.ellipses) for scene in scenes.values())
    assert [row.score for row in perfect.rows] == [Score(count, 0, 0)] * 2
    assert [row.score for row in blind.rows] == [Score(0, count, 0)] * 2


def test_what_cannot_be_scored_is_refused():
    disc = Ellipses([5], [5], [3], [3], [0])
    with pytest.raises(InputError):
        score_sequence([([1, 2], GroundTruth("a", disc))])
    with pytest.raises(InputError):
        evaluate_images(lambda image: disc, [GroundTruth("a", disc)], lambda path: None)
    with pytest.raises(InputError):
        GroundTruth("a", disc, np.zeros(3, bool))


def test_drawn_ellipses_satisfy_their_equation():
    scene = thesis_image(4, 2)
    axes = plot_detections(scene.image, scene.ellipses)
    for line, e in zip(axes.lines, scene.ellipses, strict=True):
        d = line.get_xydata() - np.array([e.x, e.y])
        c, s = np.cos(e.angle), np.sin(e.angle)
        values = (d @ [c, s] / e.semi_major) ** 2 + (d @ [-s, c] / e.semi_minor) ** 2
        np.testing.assert_allclose(values, 1)


def test_colours_reach_the_plot_red_first_and_y_points_down():
    image = np.zeros((4, 6, 3), np.uint8)
    image[:, :, 0] = 250  # blue
    axes = plot_detections(image, EllipseDetections.empty())
    assert axes.images[0].get_array()[0, 0].tolist() == [0, 0, 250]
    assert axes.get_ylim() == (3.5, -0.5)


def test_labelled_objects_carry_their_label():
    found = Detections(("nut",), [0.9], [[1, 1, 9, 9]], Ellipses([5], [5], [4], [4], [0]))
    axes = plot_detections(np.zeros((12, 12), np.uint8), found)
    assert axes.texts[0].get_text() == "nut"


def test_contours_are_drawn_at_their_best_positions():
    points = np.array([[3.0, 3.0], [4.0, 3.0], [5.0, 4.0]])
    contours = Contours(points, [0, 3], [False], subpixel=points + 0.25)
    line = plot_contours(contours, np.zeros((9, 9), np.uint8)).lines[0]
    np.testing.assert_array_equal(line.get_xydata(), points + 0.25)


def test_bars_are_as_long_as_the_measures():
    axes = plot_scores(Report(IMAGES))
    lengths = [bar.get_width() for bar in axes.patches]
    assert lengths == pytest.approx([0.5, 1.0, 12 / 16, 0.5, 0.0])


@pytest.mark.parametrize(
    "call",
    [
        lambda: plot_scores([1]),
        lambda: plot_contours([1]),
        lambda: plot_detections(np.zeros((5, 5), np.uint8), [1]),
    ],
)
def test_what_cannot_be_drawn_is_refused(call):
    with pytest.raises(InputError):
        call()
