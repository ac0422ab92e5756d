"""The rerun of chapter 2: rows, claims with a known answer, chain codes, published rows."""

import numpy as np
import pytest

from geoprim_core.errors import FileError
from geoprim_core.evaluation import CurveMetrics
from geoprim_core.evaluation.reproduce_polygon import (
    PROPOSED,
    Row,
    available,
    curve_rows,
    duality_rows,
    formula_rows,
    noisy_rows,
    scaled_rows,
)
from geoprim_core.evaluation.reproduce_polygon_claims import check_claims
from geoprim_core.evaluation.reproduce_polygon_report import report_markdown, rows_csv
from geoprim_core.io.chain_codes import decode_chain, read_chain_codes, read_published_rows
from geoprim_core.synthetic import silhouette


def made_up(label, *, cr=10.0, precision=0.4, table="2.7-5", curve="bean", **changes):
    metrics = CurveMetrics(100, round(100 / cr), 1.3, 20.0, precision, 10.0, 100.0)
    return Row(table, curve, label, metrics, **changes)


def verdict(rows, start):
    (claim,) = [claim for claim in check_claims(rows) if claim.text.startswith(start)]
    return claim.holds


def test_rows_name_their_curve_method_and_what_was_done_to_it():
    bean = {"bean": silhouette("bean")}
    rows = [*curve_rows(bean), *scaled_rows(bean), *noisy_rows(bean)]
    assert {row.label for row in rows} == {v.label for v in available()}
    assert all(row.metrics.pixels == len(bean["bean"]) for row in rows if row.table < "2.7")
    fifth = [row.metrics.pixels for row in rows if row.divisor == 5]
    assert fifth and max(fifth) < len(bean["bean"]) / 3
    assert all(row.metrics.vertices >= 2 for row in formula_rows())


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
    rows = {(name, count): values for name, count, *values in duality_rows()}
    assert rows["horizontal", 60] == rows["diagonal", 60] == [0.0, 0.0]
    assert rows["bend", 60][0] > 3 * rows["bend", 20][0]


def test_the_report_tells_the_distance_to_published_rows():
    rows = [made_up("RDP(mod)", table="2.5-1", curve="Tin-oponer")]
    published = [
        {"shape": "tinopener", "method": "RDP", "param": "mod", "N": "12", "MD": "1.5", "ISE": "25"}
    ]
    report = report_markdown(rows, check_claims(rows), duality_rows(), [], published)
    assert "| RDP(mod) | 1 | 10.0 / 12.0 | 2.0 | 0.20 | 20 % | 0 |" in report
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
