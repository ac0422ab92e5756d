"""The rerun of thesis 4.5: trials, outcomes with a known answer, claims, verdicts, the chooser."""

import math

import numpy as np
import pytest

from geoprim_core.evaluation import DetectionCounts
from geoprim_core.evaluation.reproduce_fitting import (
    SECTIONS,
    Outcome,
    Setting,
    make_trial,
    measure_setting,
    run_experiments,
    thesis_settings,
)
from geoprim_core.evaluation.reproduce_fitting_claims import THESIS_METHODS, check_claims
from geoprim_core.evaluation.reproduce_fitting_outcomes import Outcomes
from geoprim_core.evaluation.reproduce_fitting_report import (
    best_rows,
    chooser_lines,
    report_markdown,
    rows_csv,
)
from geoprim_core.fitting import TABLE, ellifit, nsaf, taubin
from geoprim_core.types import Ellipse, EllipseFit


def made_up(method, setting, good, detected=1000, trials=1000, error=1.0):
    truths = 0 if setting.open else trials
    counts = DetectionCounts(truths, detected, good, good)
    return Outcome(setting, method, trials, trials, counts, *(error,) * 3, *(0.1,) * 3)


def test_the_settings_are_those_of_the_thesis():
    settings = thesis_settings()
    assert list(dict.fromkeys(s.section for s in settings)) == list(SECTIONS)
    assert [s.noise for s in settings if s.section == "4.5.2"] == list(range(2, 21, 2))
    assert {s.ellipses for s in settings if s.section == "4.5.3"} == {4, 8, 12, 16, 20, 24}
    half = [s.span / 2 for s in settings if s.section == "4.5.4 digital"]
    assert half == list(range(90, 181, 10))


@pytest.mark.parametrize("section", [s for s in SECTIONS if s != "4.5.3"])
def test_a_trial_is_the_same_again_and_another_one_differs(section):
    setting = Setting(section, 180.0, 5.0)
    first, again, other = (make_trial(setting, 3, k) for k in (1, 1, 2))
    assert np.array_equal(first.curves[0], again.curves[0])
    assert not np.array_equal(first.curves[0], other.curves[0])
    assert len(first.truths) == (0 if setting.open else 1)


def test_an_image_trial_has_the_smooth_curves_of_its_ellipses():
    trial = make_trial(Setting("4.5.3", ellipses=8), 0, 0)
    assert len(trial.curves) >= len(trial.truths) >= 1
    assert all(curve.shape[0] >= 6 for curve in trial.curves)


def test_perfect_and_useless_methods_are_told_apart():
    truth = {}

    def oracle(points):
        return EllipseFit(truth[points.tobytes()])

    def useless(points):
        return EllipseFit(Ellipse(0, 0, 5, 5, 0))

    setting = Setting("4.5.2", noise=10)
    for index in range(20):
        trial = make_trial(setting, 0, index)
        truth[trial.curves[0].tobytes()] = trial.truths[0]
    perfect, bad = measure_setting(setting, {"oracle": oracle, "useless": useless}, 20)
    assert perfect.counts.recall == perfect.counts.precision == 1
    assert (bad.counts.detected, bad.counts.good) == (20, 0)
    assert 0 < perfect.distance <= perfect.e14 < bad.distance


def test_the_processes_make_no_difference():
    settings = [Setting("4.5.1", 135.0), Setting("4.5.4 digital", 270.0)]
    fits = {"nsaf": nsaf, "ellifit": ellifit, "taubin": taubin}
    alone = [o for run in run_experiments(settings, fits, 8, 5, 1) for o in run]
    spread = [o for run in run_experiments(settings, fits, 8, 5, 2) for o in run]
    assert rows_csv(alone) == rows_csv(spread)


def test_ellifit_finds_no_ellipse_in_exact_open_conics_and_direct_fits_do():
    fits = {"ellifit": ellifit, "nsaf": nsaf}
    none, many = measure_setting(Setting("4.5.4 analytic", 240.0), fits, 60)
    assert none.counts.detected == 0 and many.counts.detected > 30
    assert math.isnan(none.distance)


def test_the_slow_method_takes_a_tenth_of_the_open_conics():
    rows = measure_setting(Setting("4.5.4 digital", 240.0), {"ahn": nsaf, "nsaf": nsaf}, 20)
    assert [row.trials for row in rows] == [2, 20]


def claim(outcomes, start):
    (found,) = [c for c in check_claims(Outcomes(outcomes)) if c.text.startswith(start)]
    return found.holds


def test_claims_hold_and_fail_with_the_figures():
    noisy = [Setting("4.5.2", 360.0, noise) for noise in (10, 20)]
    for best, worst, holds in ((990, 900, True), (600, 900, False)):
        rows = [
            made_up(m, s, best if m == "ellifit" else worst, best if m == "ellifit" else 1000)
            for s in noisy
            for m in THESIS_METHODS
        ]
        assert claim(rows, "ElliFit is superior with up to 20 %") is holds
    without = [row for row in rows if row.method != "liu"]
    assert claim(without, "ElliFit is superior with up to 20 %") is None
    open_conic = Setting("4.5.4 analytic", 180.0)
    shares = dict.fromkeys(THESIS_METHODS, 800) | {"ellifit": 0, "ahn": 10}
    rows = [made_up(m, open_conic, 0, n) for m, n in shares.items()]
    assert claim(rows, "ElliFit detects none, Ahn a few") is True
    rows[0] = made_up("ellifit", open_conic, 0, 1)
    assert claim(rows, "ElliFit detects none, Ahn a few") is False


@pytest.mark.parametrize(
    ("own", "verdict"), [(960, "best"), (950, "tied"), (945, "tied"), (940, "behind")]
)
def test_ours_against_the_peers(own, verdict):
    arc, conic = Setting("4.5.1", 135.0), Setting("4.5.4 digital", 180.0)
    rows = [made_up("nsaf", arc, own), made_up("peer", arc, 950)]
    rows += [made_up("nsaf", conic, 0, 1000 - own), made_up("peer", conic, 0, 50)]
    found = best_rows(Outcomes(rows), ["nsaf"], ["peer"])
    assert [row.verdict for row in found] == [verdict, verdict]


def test_the_chooser_names_the_best_and_the_best_of_the_selective():
    arc, conic = Setting("4.5.1", 90.0), Setting("4.5.4 digital", 180.0)
    rows = [made_up("geometric", arc, 990), made_up("taubin", arc, 900), made_up("nsaf", arc, 100)]
    rows += [made_up(m, conic, 0, n) for m, n in (("geometric", 500), ("taubin", 9), ("nsaf", 900))]
    lines = chooser_lines(Outcomes(rows), ["geometric", "taubin", "nsaf"])
    assert lines[2].split(" | ")[1:] == ["geometric 99.0 %", "taubin 90.0 % |"]
    assert "taubin 0.9 %, geometric 50.0 %, nsaf 90.0 %" in lines[3]
    report = report_markdown(Outcomes(rows), [], ["geometric", "taubin"], ["nsaf"])
    assert "| 4.5.1 | 90 deg | 99.0 % | geometric | 10.0 % | nsaf | best |" in report


def test_every_own_method_is_run():
    from geoprim_core.evaluation.reproduce_fitting import own_fits

    assert tuple(own_fits()) == TABLE.names
