"""Image files: what is written is read, and what cannot be is told."""

import cv2
import numpy as np
import pytest

from geoprim_core.errors import FileError, InputError
from geoprim_core.io.images import list_images, read_image, write_image
from geoprim_core.io.photographs import PHOTOGRAPHS, packaged_photographs


@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 3), (5, 7, 4), (1, 1)])
@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_png_keeps_every_pixel_under_any_name(tmp_path, shape, kind):
    image = np.random.default_rng(0).integers(0, np.iinfo(kind).max, shape).astype(kind)
    path = tmp_path / "näh Ω" / "bild ä.png"
    write_image(path, image)
    np.testing.assert_array_equal(read_image(path), image)


def test_a_very_large_image_passes(tmp_path):
    image = np.zeros((8000, 8000), np.uint8)
    image[4000, 7999] = 200
    write_image(tmp_path / "large.png", image)
    read = read_image(tmp_path / "large.png")
    assert read.shape == image.shape
    assert read[4000, 7999] == 200


@pytest.mark.parametrize(
    ("content", "text"), [(b"", "0 bytes"), (b"text", "not an image"), (b"\x89PNG\r\n", "image")]
)
def test_files_that_are_no_images_are_refused(tmp_path, content, text):
    (tmp_path / "a.png").write_bytes(content)
    with pytest.raises(FileError, match=rf"a.png.*{text}"):
        read_image(tmp_path / "a.png")


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(FileError, match=r"none.png: No such file"):
        read_image(tmp_path / "none.png")
    with pytest.raises(FileError, match="cannot read"):
        read_image(tmp_path)
    with pytest.raises(FileError, match="no such file or folder"):
        list_images(tmp_path / "none")


def test_images_that_cannot_be_written_are_refused(tmp_path):
    image = np.zeros((4, 4), np.uint8)
    for name in ("a", "a.xyz"):
        with pytest.raises(FileError, match=r"a name that ends in .png"):
            write_image(tmp_path / name, image)
    (tmp_path / "file").touch()
    with pytest.raises(FileError, match="cannot write"):
        write_image(tmp_path / "file" / "a.png", image)
    with pytest.raises(InputError, match="image"):
        write_image(tmp_path / "a.png", np.zeros((0, 4), np.uint8))


def test_a_folder_lists_its_images_by_name(tmp_path):
    for name in ("b.png", "a.JPG", "c.txt"):
        (tmp_path / name).touch()
    assert [p.name for p in list_images(tmp_path)] == ["a.JPG", "b.png"]
    assert list_images(tmp_path / "c.txt") == [tmp_path / "c.txt"]


def test_the_packaged_photographs_are_there():
    images = packaged_photographs()
    assert list(images) == list(PHOTOGRAPHS)
    assert len(images) >= 8
    coffee = images["coffee"]
    assert coffee.shape == (400, 600, 3)
    b, g, r = (float(np.median(c)) for c in cv2.split(coffee))
    assert r > g > b, "a brown table: red is the last channel"
