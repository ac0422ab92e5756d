"""Odd and useless images: the chain answers, quickly and with nothing, or refuses in one line."""

import numpy as np
import pytest

import geoprim_core
from geoprim_core.ecc import TABLE, DetectorParams
from geoprim_core.errors import ImageError, InputError
from geoprim_core.synthetic import disc_image

RANDOM = np.random.default_rng(7)
NOTHING = {
    "1x1": np.zeros((1, 1), np.uint8),
    "1x1 colour": np.full((1, 1, 3), 200, np.uint8),
    "1xN": np.arange(90, dtype=np.uint8)[None],
    "Nx1": np.arange(90, dtype=np.uint8)[:, None],
    "2x2": np.array([[0, 255], [255, 0]], np.uint8),
    "black": np.zeros((120, 160), np.uint8),
    "white": np.full((120, 160, 3), 255, np.uint8),
    "constant float": np.full((50, 60), 0.5),
    "gradient": np.tile(np.arange(160, dtype=np.uint8), (120, 1)),
    "noise": RANDOM.integers(0, 256, (240, 320), dtype=np.uint8),
    "colour noise": RANDOM.integers(0, 256, (120, 160, 3), dtype=np.uint8),
    "checkerboard": (np.indices((120, 160)).sum(axis=0) % 2 * 255).astype(np.uint8),
    "one pixel": np.pad(np.full((1, 1), 255, np.uint8), 40),
    "half planes": np.repeat(np.array([[20, 220]], np.uint8), 80, axis=1).repeat(90, axis=0),
}


@pytest.mark.parametrize("scheme", TABLE.names)
@pytest.mark.parametrize("name", NOTHING)
def test_nothing_is_found_where_nothing_is(name, scheme):
    found = geoprim_core.detect_ellipses(NOTHING[name], DetectorParams.for_scheme(scheme))
    height, width = NOTHING[name].shape[:2]
    assert found.image_size == (width, height)
    if scheme == "refined" or "noise" not in name:
        assert len(found) == 0


@pytest.mark.parametrize(
    "bad",
    [
        np.zeros((0, 0), np.uint8),
        np.zeros((4, 4, 5), np.uint8),
        np.full((9, 9), np.nan, np.float32),
        np.zeros((9, 9), np.int32),
        [[1, 2], [3, 4]],
        None,
    ],
    ids=["empty", "five channels", "NaN", "int32", "list", "None"],
)
def test_what_is_no_image_is_refused(bad):
    for function in (geoprim_core.detect_ellipses, geoprim_core.extract_contours):
        with pytest.raises(ImageError, match=r"^image: expected .*, got "):
            function(bad)


def test_wrong_parameters_are_refused():
    image = np.zeros((9, 9), np.uint8)
    with pytest.raises(InputError, match="params: expected a DetectorParams or None"):
        geoprim_core.detect_ellipses(image, {"edges": 1})
    contours = geoprim_core.extract_contours(image)
    with pytest.raises(
        InputError,
        match=r"method: expected a polygon.* method \(did you mean 'rdp_mod'\?\), one of rdp, ",
    ):
        geoprim_core.approximate(contours, method="rdp_modd")
    with pytest.raises(InputError, match=r"method: expected a .*one of .*ellifit"):
        geoprim_core.fit_ellipse([[0, 0]], method="circle")
    with pytest.raises(InputError, match=r"did you mean 'masood_mod'"):
        geoprim_core.approximate(contours, method="Masood(mod)")
    with pytest.raises(InputError, match="params: expected an EdgeParams or None"):
        geoprim_core.extract_contours(image, {"sigma": 1.0})
    with pytest.raises(InputError, match=r"contours: expected a Contours .*from_curves"):
        geoprim_core.approximate(np.zeros((9, 2)))


def test_a_large_image_with_one_disc():
    image = disc_image(8192, 8192, centre=(4000.0, 4200.0), radius=1500.0)
    found = geoprim_core.detect_ellipses(image)
    assert len(found) == 1
    assert found.ellipses.semi_major[0] == pytest.approx(1500, abs=0.1)


@pytest.mark.slow
def test_a_large_image_of_pure_noise():
    image = RANDOM.integers(0, 256, (4096, 4096), dtype=np.uint8)
    assert len(geoprim_core.detect_ellipses(image)) == 0


def test_the_same_image_gives_the_same_bytes():
    image = np.maximum(
        disc_image(200, 150, centre=(80.0, 70.0), radius=40.0),
        RANDOM.integers(0, 60, (150, 200), dtype=np.uint8),
    )
    for scheme in TABLE.names:
        params = DetectorParams.for_scheme(scheme)
        first = geoprim_core.detect_ellipses(image, params)
        again = geoprim_core.detect_ellipses(image.copy(), params)
        assert first.ellipses.array().tobytes() == again.ellipses.array().tobytes()
        assert first.score.tobytes() == again.score.tobytes()
        assert first.covariance.tobytes() == again.covariance.tobytes()


def test_the_image_is_not_written_to():
    image = disc_image(90, 80, centre=(40.0, 40.0), radius=20.0)
    before = image.copy()
    geoprim_core.detect_ellipses(image)
    np.testing.assert_array_equal(image, before)
