"""The command line: what it prints, what it refuses, and that a refusal is one line."""

import csv
import json

import numpy as np
import pytest

from geoprim_core.cli.main import COMMANDS, main
from geoprim_core.ecc import DetectorParams
from geoprim_core.io.images import read_image, write_image
from geoprim_core.synthetic import thesis_image


def test_detect_prints_the_disc_and_draws_it(disc, tmp_path, capsys):
    overlay = tmp_path / "pictures" / "found.png"
    words = ["detect", str(disc), "--json", "--overlay", str(overlay), "--overlay.legend", "false"]
    assert main(words) == 0
    found = json.loads(capsys.readouterr().out)
    (ellipse,) = found["ellipses"]
    assert (found["width"], found["height"]) == (160, 120)
    assert abs(ellipse["x"] - 70.25) < 0.1
    assert abs(ellipse["y"] - 60.5) < 0.1
    assert abs(ellipse["semi_major"] - 35.5) < 0.2
    drawn, plain = read_image(overlay), read_image(disc)
    assert drawn.shape == (480, 640, 3)
    changed = (drawn != plain.repeat(4, axis=0).repeat(4, axis=1)[..., None]).any(axis=2)
    y, x = (np.array(np.nonzero(changed)) - 1.5) / 4
    radius = np.hypot(x - 70.25, y - 60.5)
    assert np.mean(np.abs(radius - 35.5) < 3) > 0.5, "the outline lies on the rim"


def test_detect_prints_a_table(disc, capsys):
    assert main(["detect", str(disc)]) == 0
    first, heading, row = capsys.readouterr().out.splitlines()
    assert first.endswith("disc.png: 1 ellipse")
    assert heading.split() == ["x", "y", "semi_major", "semi_minor", "angle_deg", "score"]
    assert [float(v) for v in row.split()[:2]] == pytest.approx([70.25, 60.5], abs=0.1)


def test_detect_says_where_a_bound_on_the_work_was_reached(tmp_path, capsys):
    path = tmp_path / "busy.png"
    write_image(path, thesis_image(8, seed=3, kind="overlapping").image)
    assert main(["detect", str(path), "--json"]) == 0
    free = capsys.readouterr()
    assert json.loads(free.out)["complete"]
    assert json.loads(free.out)["reason"] == free.err == ""
    assert main(["detect", str(path), "--json", "--ecc.refined.max_candidates", "2"]) == 0
    tied = capsys.readouterr()
    assert not json.loads(tied.out)["complete"]
    reason = json.loads(tied.out)["reason"]
    assert reason.startswith("max_candidates = 2: ")
    assert tied.err == f"geoprim detect: {path}: incomplete: {reason}\n"


def test_every_scheme_finds_the_disc(disc, capsys):
    for scheme in ("1", "2", "3", "refined"):
        assert main(["detect", str(disc), "--json", "--scheme", scheme]) == 0
        assert len(json.loads(capsys.readouterr().out)["ellipses"]) == 1, scheme


def test_a_bad_image_does_not_hide_the_good_one(disc, tmp_path, capsys):
    broken = tmp_path / "broken.png"
    broken.write_bytes(b"no picture")
    assert main(["detect", str(broken), str(disc)]) == 1
    captured = capsys.readouterr()
    assert "disc.png: 1 ellipse" in captured.out
    assert "broken.png" in captured.err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["detect", "DISC", "--edges.sigma", "-1"], "--edges.sigma: expected a number from"),
        (["detect", "DISC", "--edges.sigma", "wide"], "--edges.sigma: expected a number from"),
        (["detect", "DISC", "--edges.linking", "x"], "--edges.linking: expected one of"),
        (["detect", "DISC", "--scheme", "4"], "--scheme: expected one of refined, 1"),
        (["process", "none.mcap", "--output", "o.mcap"], "none.mcap"),
        (["evaluate", "nowhere"], "nowhere: no such file or folder"),
        (["bench", "nowhere"], "nowhere"),
        (["dance"], "expected one of detect, process"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_a_refusal_says_what_was_expected(words, said, disc, refused):
    assert said in refused(*[disc if word == "DISC" else word for word in words])


def test_an_overlay_that_cannot_be_written(disc, capsys):
    code = main(["detect", str(disc), "--overlay", "/dev/null/found.png"])
    assert code == 2
    assert "/dev/null" in capsys.readouterr().err


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help(command, capsys):
    with pytest.raises(SystemExit) as end:
        main([command, "--help"])
    assert end.value.code == 0
    assert "usage: geoprim " + command in capsys.readouterr().out


def test_every_parameter_is_an_option_with_its_range(capsys):
    with pytest.raises(SystemExit):
        main(["detect", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    for option in DetectorParams.options():
        assert f"--{option.name}" in text


@pytest.mark.parametrize("command", ["detect", "process", "explain"])
def test_the_usage_is_not_buried_under_the_parameters(command, capsys):
    """It had listed them all, over ninety lines; they follow in groups."""
    with pytest.raises(SystemExit):
        main([command, "--help"])
    usage, _, rest = capsys.readouterr().out.partition("\n\n")
    assert len(usage.splitlines()) <= 6
    assert "--edges." not in usage and "--edges.sigma" in rest


def test_tangents_draws_normals_and_writes_angles(disc, tmp_path, capsys):
    words = ["tangents", disc, "--method", "deb", "--radius", 5, "-o", tmp_path / "normals.png"]
    assert main([str(w) for w in [*words, "--csv", tmp_path / "angles.csv"]]) == 0
    assert "1 contours" in capsys.readouterr().out
    with (tmp_path / "angles.csv").open() as file:
        rows = list(csv.DictReader(file))
    drawn = read_image(tmp_path / "normals.png")[:, :, :3].astype(int)
    green = np.argwhere((drawn[:, :, 1] - drawn[:, :, 0] > 60) & (drawn[:, :, 1] > 200))
    points = np.array([(float(row["x"]), float(row["y"])) for row in rows])
    centre = points.mean(axis=0)
    angle = np.array([float(row["angle"]) for row in rows])
    across = np.abs(np.sum((points - centre) * np.stack([np.cos(angle), np.sin(angle)], 1), axis=1))
    assert (across < 0.25 * np.hypot(*(points - centre).T)).all()  # on a circle: perpendicular
    assert len(green) > 20
    reach = np.hypot(green[:, 1] - centre[0], green[:, 0] - centre[1])
    radius = np.hypot(*(points - centre).T).mean()
    assert (np.abs(reach - radius) < 10).all()


def test_tangents_refuses_the_parameter_of_another_method(disc, capsys):
    assert main(["tangents", str(disc), "--method", "lr1", "--radius", "5"]) == 2
    assert "radius" in capsys.readouterr().err


def test_calibrate_judges_scores_and_covariances(tmp_path, capsys):
    words = ["calibrate", "--scenes", "1", "--singles", "30", "--fit", "--output", str(tmp_path)]
    assert main(words) == 0
    text = capsys.readouterr().out
    assert text.count("| occluded filled |") == 2, "before and after the fit"
    assert "log_odds [" in text
    assert "joint 68 %" in text
    assert (tmp_path / "reliability.png").stat().st_size > 1000
    assert (tmp_path / "coverage.png").stat().st_size > 1000
