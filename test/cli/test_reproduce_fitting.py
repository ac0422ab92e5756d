"""`geoprim reproduce fitting`: claims printed, report, rows and figures written."""

import csv

from geoprim_core.cli.main import main
from geoprim_core.io.peer_fits import peer_fits


def test_a_small_rerun_writes_report_rows_and_figures(tmp_path, capsys):
    words = ["reproduce", "fitting", "--count", "3", "--processes", "1", "--quiet"]
    words += ["--sections", "4.5.1", "4.5.2 sector", "--methods", "ellifit", "nsaf"]
    words += ["cv2.fitEllipse", "-o", str(tmp_path)]
    assert main(words) == 0
    assert "| situation |" in capsys.readouterr().out
    report = (tmp_path / "report.md").read_text()
    assert "Peers: cv2.fitEllipse" in report and "## 4.5.2 sector" in report
    assert (tmp_path / "4.5.2_sector.png").stat().st_size > 5000
    with (tmp_path / "rows.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["method"] for row in rows} == {"ellifit", "nsaf", "cv2.fitEllipse"}
    whole = [r for r in rows if r["section"] == "4.5.1" and float(r["span"]) == 360]
    assert {row["recall"] for row in whole} == {"1.0"}


def test_unknown_names_are_one_line(capsys):
    assert main(["reproduce", "fitting", "--methods", "best"]) == 2
    assert main(["reproduce", "fitting", "--sections", "9"]) == 2
    assert main(["reproduce", "fitting", "--count", "0"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 3


def test_all_peers_fit_a_circle():
    circle = [(5, 0), (0, 5), (-5, 0), (0, -5), (3, 4), (4, 3), (-3, 4)]
    for fit in peer_fits().values():
        found = fit(circle).ellipse
        assert abs(found.semi_major - 5) < 1e-3 and abs(found.x) < 1e-3
