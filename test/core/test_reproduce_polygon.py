"""The rerun of chapter 2: rows, claims with a known answer, chain codes, published rows."""

import doctest
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from geoprim_core.errors import FileError
from geoprim_core.evaluation import CurveMetrics, MeanMetrics, RelativeMetrics
from geoprim_core.evaluation.duality import check_duality, duality_rows, fit_line, piece_rows
from geoprim_core.evaluation.reproduce_polygon import (
    PROPOSED,
    Row,
    SetRow,
    available,
    curve_rows,
    formula_rows,
    image_rows,
    noisy_rows,
    scaled_rows,
)
from geoprim_core.evaluation.reproduce_polygon_claims import check_claims, check_images
from geoprim_core.evaluation.reproduce_polygon_report import Rerun, report_markdown, rows_csv
from geoprim_core.evaluation.thesis_tables import printed_rows
from geoprim_core.io.chain_codes import decode_chain, read_chain_codes, read_published_rows
from geoprim_core.synthetic import disc_image, silhouette


def made_up(label, *, cr=10.0, precision=0.4, table="2.7-5", curve="bean", pixels=100, **changes):
    metrics = CurveMetrics(pixels, round(100 / cr), 1.3, 20.0, precision, 10.0, 100.0)
    return Row(table, curve, label, metrics, **changes)


def verdict(rows, start):
    (claim,) = [claim for claim in check_claims(rows) if claim.text.startswith(start)]
    return claim.holds


def test_rows_name_their_curve_method_and_what_was_done_to_it():
    bean = {"bean": silhouette("bean")}
    rows = [*curve_rows(bean), *scaled_rows(bean), *noisy_rows(bean)]
    assert {row.label for row in rows} == {v.label for v in available() if v.table < "2.7"}
    assert all(row.metrics.pixels == len(bean["bean"]) for row in rows if row.table < "2.7")
    fifth = [row.metrics.pixels for row in rows if row.divisor == 5]
    assert fifth and max(fifth) < len(bean["bean"]) / 3
    assert all(row.metrics.vertices >= 2 for row in formula_rows())


def test_no_polygon_of_the_rerun_is_better_than_the_optimum():
    rows = list(curve_rows({"bean": silhouette("bean")}))
    judged = {row.label: row.relative for row in rows}
    assert all(0 < part.fidelity <= 1 and 0 < part.efficiency <= 1 for part in judged.values())
    assert judged["Break points"].merit == 1.0  # a polygon through all pixels
    assert judged["Masood(mod)"].merit < 1.0
    header, first = rows_csv(rows).splitlines()[:2]
    assert header.endswith(",fidelity,efficiency,merit")
    assert float(first.split(",")[-1]) == rows[0].relative.merit


def test_the_report_ranks_by_merit_and_names_the_curves_left_out():
    rows = [
        made_up("RDP(mod)", table="2.5-1", relative=RelativeMetrics(0.25, 1.0)),
        made_up("RDP(mod)", table="2.5-1", curve="star", relative=RelativeMetrics(1.0, 1.0)),
        made_up("PRO(1.0)", table="2.3-1", relative=RelativeMetrics(1.0, 0.81)),
        made_up("PRO(1.0)", table="2.3-1", curve="coast", pixels=3000),
        made_up("PRO(1.0)", noise=2, relative=RelativeMetrics(0.01, 1.0)),
    ]
    lines = report_markdown(Rerun(rows)).splitlines()
    first, second = "| PRO(1.0) | 1 | 1.00 | 0.81 | 0.90 |", "| RDP(mod) | 2 | 0.62 | 1.00 | 0.75 |"
    places = [k for k, line in enumerate(lines) if line.startswith((first, second))]
    assert lines[places[0]] == first + " 0.90 (bean) |"
    assert lines[places[1]] == second + " 0.50 (bean) |"
    assert "| PRO(1.0) | 0.90 (1) | 0.10 (1) | - | - |" in lines
    assert any("left out" in line and line.endswith(": coast (3000 px).") for line in lines)


def test_specks_of_an_image_are_counted_but_not_judged():
    speck = disc_image(90, 60, centre=(75, 42), radius=4)
    image = np.maximum(disc_image(90, 60, centre=(30, 30), radius=18), speck)
    row = image_rows([("discs", image)])[0]
    assert (row.judged, row.curves) == (1, 2)
    assert row.relative is not None and row.relative.count == 1
    alone = image_rows([("specks", speck)])[0]
    assert (alone.relative, alone.judged, alone.curves) == (None, 0, 1)


def test_claims_hold_and_fail_with_the_figures():
    calm = [made_up(label) for label in PROPOSED]
    loud = [made_up(label, precision=0.6, noise=1) for label in PROPOSED if "Masood" not in label]
    good = [*calm, *loud, made_up("Masood(mod)", cr=5.0, noise=1)]
    assert verdict(good, "Noise leaves CR") is True
    assert verdict(good, "Noise raises") is True
    bad = [*calm, *(made_up(label, cr=4.0, precision=0.3, noise=1) for label in PROPOSED)]
    assert verdict(bad, "Noise leaves CR") is False
    assert verdict(bad, "Noise raises") is False
    without = [row for row in good if row.label != "Carmona(mod)"]
    assert verdict(without, "Noise raises") is None
    rdp = [made_up("RDP(mod)", table="2.5-1")]
    assert verdict(rdp, "MD of RDP(mod)") is True


def test_lines_without_disturbance_have_no_duality():
    fits = {(name, fit.pixels): fit for name, fit in duality_rows()}
    for name in ("horizontal", "diagonal"):
        assert (fits[name, 60].precision, fits[name, 60].reliability) == (0.0, 0.0)
    assert fits["arc", 60].precision > 3 * fits["arc", 20].precision
    assert fits["spike of 3 px", 60].reliability < fits["spike of 3 px", 20].reliability / 2


@given(steps=st.lists(st.tuples(st.integers(-2, 2), st.integers(-2, 2)), min_size=2, max_size=40))
@settings(max_examples=60, deadline=None)
def test_sum_b_is_at_most_m_and_gives_the_printed_precision(steps):
    points = np.cumsum([(150, 130), *steps], axis=0).astype(float)
    if (points == points[0]).all():
        return
    fit = fit_line(points)
    assert fit.share <= 1 + 1e-9  # (2-8)
    x = points
    if np.linalg.matrix_rank(x) < 2:
        return
    inverse = np.linalg.inv(x.T @ x)
    b, c = (x @ power @ x.T for power in (inverse, inverse @ inverse))
    assert fit.share == pytest.approx(b.sum() / len(x), abs=1e-6)
    direct = np.sqrt(max(len(x) - b.sum(), 0) / c.sum())  # (2-5)
    assert fit.printed_precision == pytest.approx(direct, abs=1e-2, rel=1e-3)


def test_longer_pieces_are_fitted_less_precisely():
    pieces = piece_rows({"bean": silhouette("bean")}, (10, 40))
    assert [claim.holds for claim in check_duality(pieces)] == [True, True, False]


def test_claims_on_images_compare_the_methods():
    def row(label, value):
        return SetRow("set", label, MeanMetrics(3, value, value, value, 0.1, value, value))

    sets = [row("Masood(0.9)", 2.0), row("Masood(mod)", 1.0)]
    sets += [row("Carmona(0.45)", 1.0), row("Carmona(mod)", 2.0), row("PRO(0.2)", 0.1)]
    assert [claim.holds for claim in check_images(sets)] == [True, False, True]


def test_the_page_on_polygons_computes_what_it_says():
    page = Path(__file__).resolve().parents[2] / "docs" / "polygon.md"
    failed, tried = doctest.testfile(str(page), module_relative=False)
    assert failed == 0 and tried > 8


def test_printed_rows_are_beside_the_rows_of_their_scale_only():
    half = made_up("RDP(mod)", cr=10.0, table="2.7-2", curve="Africa", divisor=2)
    whole = made_up("RDP(mod)", cr=10.0, table="2.7-2", curve="Africa")
    report = report_markdown(Rerun([half, whole], published=list(printed_rows())))
    assert "| 2.7-2 | RDP(mod) | 1 | 10.0 / 17.0 | 7.0 |" in report


def test_the_report_tells_the_distance_to_published_rows():
    rows = [made_up(v, table="2.5-1", curve="Tin-oponer") for v in ("RDP(mod)", "RDP(1.0)")]
    published = [
        {"shape": "tinopener", "method": "RDP", "param": "mod", "N": "12", "MD": "1.5", "ISE": "25"}
    ]
    rerun = Rerun(rows, check_claims(rows), duality_rows(), published=published)
    assert "| 2.5-1 | RDP(mod) | 1 | 10.0 / 12.0 | 2.0 | 0.20 | 20 % | 0 |" in report_markdown(
        rerun
    )
    assert rows_csv(rows).splitlines()[1].startswith("2.5-1,Tin-oponer,RDP(mod),1,0,100,10,1.3,")


def test_chain_codes_come_back_as_pixels(tmp_path):
    file = tmp_path / "codes.json"
    file.write_text('{"square": {"start": [5, 7], "code": "00664422"}}')
    square = read_chain_codes(file)["square"]
    assert len(square) == 8 and square[0].tolist() == [5, 7]
    assert square.max(axis=0).tolist() == [7, 9]
    assert np.array_equal(decode_chain("07"), [[0, 0], [1, 0], [2, 1]])


def test_files_of_another_form_are_refused(tmp_path):
    file = tmp_path / "other.json"
    for text in ("{", '{"a": 1}', '{"a": {"code": "09"}}'):
        file.write_text(text)
        with pytest.raises(FileError):
            read_chain_codes(file)
    file.write_text("a,b\n1,2\n")
    with pytest.raises(FileError, match="columns"):
        read_published_rows(file)
