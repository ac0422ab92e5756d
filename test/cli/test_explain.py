"""`geoprim explain`: one picture a step, and a reason for every hypothesis that is not reported."""

import csv

import numpy as np
import pytest

from geoprim_core.cli.main import main
from geoprim_core.ecc import TABLE, DetectorParams, detect_ellipses
from geoprim_core.io.explain import explain_detection
from geoprim_core.io.images import read_image, write_image
from geoprim_core.synthetic import disc_image, thesis_image

STEPS = ["edges", "contours", "arcs", "hypotheses", "detections"]


@pytest.mark.parametrize("scheme", TABLE.names)
def test_what_is_reported_has_no_reason_and_the_rest_has_one(scheme):
    image = thesis_image(8, 5, kind="overlapping", drawing="filled").image
    params = DetectorParams.for_scheme(scheme)
    explained = explain_detection(image, params)
    found = detect_ellipses(image, params)
    reported = [h for h in explained.hypotheses if not h.reason]
    assert list(explained.pictures) == STEPS
    assert explained.detections.ellipses.array().tobytes() == found.ellipses.array().tobytes()
    assert len(reported) == len(found) > 0
    # The refit moves an ellipse by less than two pixels.
    for ellipse in found.ellipses:
        assert min(np.hypot(h.x - ellipse.x, h.y - ellipse.y) for h in reported) < 2.0


def test_the_pictures_show_the_steps():
    image = disc_image(90, 80, centre=(40.0, 38.0), radius=25.0)
    pictures = explain_detection(image).pictures
    y, x = np.nonzero(pictures["edges"][:, :, 0])
    np.testing.assert_allclose(np.hypot(x - 40, y - 38), 25.0, atol=1.0)
    y, x = np.nonzero(pictures["arcs"].max(axis=2) > 100)
    np.testing.assert_allclose(np.hypot(x - 40, y - 38), 25.0, atol=1.0)


def test_an_image_with_nothing_has_pictures_too():
    explained = explain_detection(np.zeros((30, 40), np.uint8))
    assert [p.shape for p in explained.pictures.values()] == [(30, 40, 3)] * len(STEPS)
    assert explained.hypotheses == ()


def test_the_command_writes_pictures_and_table(tmp_path, capsys):
    photo = tmp_path / "disc.png"
    write_image(photo, disc_image(90, 80, centre=(40.0, 38.0), radius=25.0))
    assert main(["explain", str(photo), "-o", str(tmp_path / "steps")]) == 0
    for number, name in enumerate(STEPS, start=1):
        assert read_image(tmp_path / "steps" / f"{number}_{name}.png").shape == (80, 90, 3)
    with (tmp_path / "steps" / "hypotheses.csv").open() as file:
        first = next(csv.DictReader(file))
    assert float(first["semi_major"]) == pytest.approx(25.0, abs=0.3)
    assert first["reason"] == ""
    assert "1 reported" in capsys.readouterr().out


def test_reported_hypotheses_have_the_scores_of_the_detections():
    """They once had the evidence as log odds, which it is not: .60 for .82."""
    explanation = explain_detection(thesis_image(12, seed=4).image)
    reported = [h.score for h in explanation.hypotheses if not h.reason]
    assert reported == pytest.approx(sorted(explanation.detections.score, reverse=True))
