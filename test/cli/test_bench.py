"""The benchmark commands: their tables, files and pictures."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from geoprim_core.cli.main import main
from geoprim_core.evaluation.polygon_speed import long_wave, measure_polygons
from geoprim_core.fitting import TABLE
from geoprim_core.io.images import read_image, write_image
from geoprim_core.synthetic import disc_image
from geoprim_core.types import Contours

ROOT = Path(__file__).resolve().parents[2]
CONTOURS = f"contours={ROOT / 'benchmarks' / 'peer_contours.py'}:fit_contours"


@pytest.fixture
def folder(tmp_path):
    """Two discs, one of which is listed at a wrong place."""
    place = tmp_path / "discs"
    for name, x in (("right", 70), ("wrong", 30)):
        write_image(place / f"{name}.png", disc_image(140, 120, centre=(70, 60), radius=35))
        ellipse = {"xc": x, "yc": 60, "a": 35, "b": 35, "theta_deg": 0}
        (place / f"{name}.json").write_text(
            json.dumps({"image": f"{name}.png", "ellipses": [ellipse]})
        )
    return place


def rows_of(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_tangents_are_timed(tmp_path, capsys):
    words = ["bench", "tangents", "--methods", "deb", "epf_h3", "--sizes", "200", "--repeat", "1"]
    assert main([*words, "--output", str(tmp_path), "--quiet"]) == 0
    table = (tmp_path / "tangents.md").read_text()
    assert table in capsys.readouterr().out
    rows = [line.split("|")[1:3] for line in table.splitlines()[2:]]
    assert [name.strip() for name, _ in rows] == ["deb", "epf_h3"]
    assert all(float(nanoseconds.replace(",", "")) > 0 for _, nanoseconds in rows)


def test_detectors_are_compared_over_a_folder_and_a_set(folder, tmp_path, capsys):
    words = ["bench", "detectors", folder, "--sets", "circles_clean", "occluded_filled"]
    words += ["--count", 2, "--schemes", "refined", "3", "--peer", CONTOURS, "--repeat", 1]
    words += ["--output", tmp_path / "out", "--overlays", tmp_path / "drawn"]
    assert main([str(word) for word in words]) == 0
    text = capsys.readouterr().out
    assert "| discs | 0.8 | refined | 2 | 0.500 | 0.500 | 0.500 |" in text
    assert "time / contours" in text
    assert "| wrong.png | 0.000 | 30, 60; 35 x 35 | 70, 60; 35 x 35;" in text
    table = rows_of(tmp_path / "out" / "scores.csv")
    assert {row["detector"] for row in table} == {"refined", "scheme 3", "contours"}
    assert {(row["set"], row["overlap"]) for row in table} == {
        ("discs", "0.8"), ("circles_clean", "0.8"), ("circles_clean", "0.95"),
        ("occluded_filled", "0.95"),
    }  # fmt: skip
    assert all(row["failed"] == "0" and float(row["median_ms"]) > 0 for row in table)
    for name in ("scores.md", "time_accuracy.png", "precision_recall_discs_0.8.png"):
        assert (tmp_path / "out" / name).stat().st_size > 100
    assert read_image(tmp_path / "out" / "alpha_occluded_filled_0.95.png").ndim == 3
    drawn = read_image(tmp_path / "drawn" / "refined_discs_01_wrong.png")[:, :, :3]
    red, orange = (np.abs(drawn.astype(int) - c).sum(axis=2) < 40 for c in (RED, ORANGE))
    assert red.sum() > 100, "the false one"
    assert orange.sum() > 100, "the missed one"


RED, ORANGE = np.array([0x44, 0x17, 0xFF]), np.array([0x00, 0x91, 0xFF])  # blue first


def test_evaluate_judges_another_detector_and_draws_the_worst(folder, tmp_path, capsys):
    words = ["evaluate", folder, "--detector", CONTOURS.split("=")[1]]
    words += ["--output", tmp_path / "out", "--overlays", tmp_path / "drawn"]
    assert main([str(word) for word in words]) == 0
    text = capsys.readouterr().out
    assert "The worst, overlap 0.8" in text
    drawn = sorted(path.name for path in (tmp_path / "drawn").glob("*.png"))
    # both edges of the one-pixel Canny line are contours: one of them is false in either image
    assert drawn == ["fit_contours_images_01_wrong.png", "fit_contours_images_02_right.png"]
    assert {row["overlap"] for row in rows_of(tmp_path / "out" / "scores.csv")} == {"0.8", "0.95"}
    assert (tmp_path / "out" / "scores.png").is_file()
    assert (tmp_path / "out" / "precision_recall_images_0.8.png").is_file()


def test_evaluate_gives_another_detector_the_time_that_it_is_told(folder, tmp_path, capsys):
    slow = tmp_path / "slow.py"
    slow.write_text("import time\ndef find(image):\n    time.sleep(600)\n")
    words = ["evaluate", str(folder), "--detector", f"{slow}:find", "--time-limit", "0.2"]
    assert main(words) == 0
    text = capsys.readouterr().out
    assert "right.png: no answer within 0.2 s" in text
    assert "| images | 0.8 | 2 | 0 | 2 | 0 | - | 0.000 | 0.000 | - | 0.000 | 0.000 |" in text


def test_evaluate_judges_rendered_sets(capsys):
    assert main(["evaluate", "--sets", "circles_clean", "noise", "--count", "1"]) == 0
    text = capsys.readouterr().out
    assert "| circles_clean | 0.95 | 1 |" in text
    assert "| noise | 0.8 | 1 | 0 | 0 | 0 |" in text


def test_an_ablation_of_one_departure(folder, tmp_path, capsys):
    words = ["bench", "ablation", folder, "--only", "colour", "--output", tmp_path / "out"]
    assert main([str(word) for word in words]) == 0
    text = capsys.readouterr().out
    assert "| nothing (F) | 0.500 |" in text
    assert "| strongest colour channel | +0.000 |" in text  # the discs are gray
    assert (tmp_path / "out" / "scores.md").read_text() == text.split("\nwritten")[0]


def test_the_chain_is_timed_at_one_size(folder, tmp_path, capsys):
    write_image(folder / "upright.png", np.zeros((90, 60), np.uint8))
    words = ["bench", str(folder), "--size", "96", "64", "--clock", "processor", "--repeat", "1"]
    assert main([*words, "--csv", str(tmp_path / "times.csv")]) == 0
    text = capsys.readouterr().out
    for stage in ("edges", "arcs", "pairs", "verification", "whole chain"):
        assert f"| {stage} |" in text
    rows = rows_of(tmp_path / "times.csv")
    assert [(row["width"], row["height"]) for row in rows] == [
        ("96", "64"), ("64", "96"), ("96", "64"),
    ]  # fmt: skip
    assert main(["bench", str(folder), "--size", "0", "64"]) == 2
    assert "size" in capsys.readouterr().err


def test_scaling_gives_times_and_exponents(tmp_path, capsys):
    words = ["bench", "scaling", "--max-width", "640", "--max-arcs", "200", "--repeat", "1"]
    assert main([*words, "--output", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "| photograph | 307200 pixels |" in text
    assert "| noise | exponent in edge pixels |" in text
    assert "| arcs, frame grows with them | 200 arcs |" in text
    assert (tmp_path / "scaling_photograph.png").is_file()
    assert (tmp_path / "scaling_crowded_arcs.png").is_file()


def test_the_speed_of_all_fits_is_a_table(tmp_path, capsys):
    words = ["bench", "fitting", "--arcs", "20", "--repeat", "1", "--quiet"]
    assert main([*words, "--output", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    rows = {line.split(" | ")[0].strip("| "): line.split(" | ")[1:] for line in text.splitlines()}
    assert {*TABLE.names, "cv2.fitEllipse", "cv2.fitEllipseAMS"} <= set(rows)
    assert rows["cv2.fitEllipseDirect"][2] == "1.00"
    assert all(float(rows[name][3]) > 0 for name in TABLE.names)
    assert (tmp_path / "fitting_speed.md").read_text() == text.split("\nwritten")[0]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["bench", "detectors", "nowhere"], "nowhere: no such folder"),
        (["bench", "detectors", "--sets", "photos"], "names of sets or families"),
        (["bench", "detectors", "--peer", "x"], "NAME=MODULE:CALLABLE"),
        (["bench", "detectors", "--peer", "x=nowhere:f"], "nowhere"),
        (["bench", "detectors", "--schemes"], "at least one detector"),
        (["bench", "detectors", "--count", "0"], "--count: expected a whole number of at least 1"),
        (["bench", "ablation", "--only", "nonsense"], "--only"),
        (["bench", "fitting", "--arcs", "0"], "--arcs: expected a whole number of at least 1"),
        (
            ["evaluate", "--sets", "noise", "--detector", "a:b", "--time-limit", "nan"],
            "a number above 0",
        ),
        (["evaluate"], "images with ground truth or a rendered set"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else None,
)
def test_a_refusal_is_one_line(words, said, capsys):
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_a_curve_too_long_for_a_method_has_no_time():
    wave = {"wave": lambda: Contours(long_wave(20_000), [0, 20_000], [False])}
    times = measure_polygons(["rdp", "optimal"], wave, {}, repeat=1)
    assert times.reference == "rdp" and np.isnan(times.seconds["optimal"][0])
    assert "| optimal | - |" in times.markdown()


def test_polygon_methods_are_timed_and_drawn(tmp_path, capsys):
    words = ["bench", "polygon", "--methods", "rdp_mod", "--workloads", "1", "--repeat", "1"]
    assert main([*words, "--output", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "| rdp_mod | " in text and "| opencv | " in text
    assert text.startswith((tmp_path / "polygon_speed.md").read_text())
    picture = tmp_path / "disc.png"
    write_image(picture, disc_image(140, 120, centre=(70, 60), radius=35))
    assert (
        main(["polygons", str(picture), "--method", "rdp_mod", "-o", str(tmp_path / "o.png")]) == 0
    )
    method, contours, points, vertices, _ = capsys.readouterr().out.splitlines()[1].split()
    assert method == "rdp_mod" and int(contours) >= 1 and int(points) > 5 * int(vertices) > 40
    assert (read_image(tmp_path / "o.png") != read_image(picture)[:, :, None]).any()
