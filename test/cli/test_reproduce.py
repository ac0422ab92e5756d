"""`geoprim reproduce`: claims printed; report, rows and figures written."""

import csv

from geoprim_core.cli.main import main
from geoprim_core.io.images import write_image
from geoprim_core.synthetic import disc_image


def test_a_folder_of_chain_codes_rows_and_images_is_rerun(tmp_path, capsys):
    data = tmp_path / "data"
    square = "0" * 20 + "6" * 20 + "4" * 20 + "2" * 20
    disc = disc_image(80, 70, centre=(40, 35), radius=20)
    write_image(data / "disc.png", disc)
    write_image(data / "more" / "deep" / "disc.png", disc)
    (data / "more" / "torn.png").write_bytes(b"no picture")
    (data / "codes.json").write_text(f'{{"Square": {{"start": [3, 4], "code": "{square}"}}}}')
    (data / "rows.csv").write_text("shape,method,param,M,N,MD,ISE\nsquare,RDP,mod,80,4,0.5,1\n")
    words = ["reproduce", "polygon", data, "--output", tmp_path / "out", "--quiet"]
    assert main([str(word) for word in words]) == 0
    printed = capsys.readouterr()
    assert "2.5.1.3" in printed.out and "torn.png" in printed.err
    report = (tmp_path / "out" / "report.md").read_text()
    assert "| RDP(mod) | 1 | 4.0 / 4.0 | 0.0 | 0.50 | 100 % | 1 |" in report
    assert "| data | PRO(1.0) | 1 |" in report and "| deep | PRO(1.0) | 1 |" in report
    drawn = {path.name for path in (tmp_path / "out").glob("*.png")}
    assert {f"![{name}]({name})" for name in drawn} <= set(report.splitlines())
    with (tmp_path / "out" / "rows.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["curve"] == "Square"]
    assert {row["divisor"] for row in rows} == {"1", "2", "3", "4", "5"}
    assert (tmp_path / "out" / "polygons_rdp_mod.png").stat().st_size > 1000


def test_a_folder_that_is_not_there_is_one_line(tmp_path, capsys):
    assert main(["reproduce", "polygon", str(tmp_path / "nowhere")]) == 2
    assert "no such folder" in capsys.readouterr().err


def test_chapter_three_is_rerun_with_chosen_methods(tmp_path, capsys):
    out, page = tmp_path / "out", tmp_path / "docs" / "tangents.md"
    words = ["reproduce", "tangent", "--count", "1", "--methods", "lambda_mst", "--processes", "1"]
    words += ["--quiet", "-o", out, "--chooser", page]
    assert main([str(word) for word in words]) == 0
    printed = capsys.readouterr().out
    assert "exceeded at 0 of" in printed
    assert "DEB, R = 10, is better in the mean than lambda-MST" in printed
    report = (out / "report.md").read_text()
    assert report.count("## Ranking") == 3
    assert "`lambda_mst`" in page.read_text()
    with (out / "rows.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {row["setting"] for row in rows if row["family"] == "flower"} == set("1234567")
    for stem in ("bounds", "convergence", "ellipses", "flowers", "isotropy", "ranking", "sweep"):
        assert (out / f"{stem}.png").stat().st_size > 10_000


def test_a_count_of_nothing_is_refused(capsys):
    assert main(["reproduce", "tangent", "--count", "-3"]) == 2
    assert "--count" in capsys.readouterr().err
