"""What is wrong with a command is one line that says what was expected, with exit code 2."""

import argparse

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.cli.main import COMMANDS, build_parser, main
from geoprim_core.cli.values import positive, ratio, whole
from geoprim_core.ecc import detect_ellipses
from geoprim_core.io.images import read_image, write_image
from geoprim_core.synthetic import disc_image

pillow = pytest.importorskip("PIL.Image")


def actions(command):
    """Return every argument of a command and of what is below it."""
    found, waiting = [], [build_parser(command)._subparsers._group_actions[0].choices[command]]
    while waiting:
        for action in waiting.pop()._actions:
            if isinstance(action, argparse._SubParsersAction):
                waiting += action.choices.values()
            else:
                found.append(action)
    return found


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "a_file"
    path.write_text("x")
    return path


@pytest.mark.parametrize("command", COMMANDS)
def test_every_argument_says_what_it_is_and_what_it_is_without(command):
    for action in actions(command):
        assert action.help, action.dest
        if action.type in (int, float):
            pytest.fail(f"{action.dest}: wrong numbers of it are not told from right ones")
        if isinstance(action.default, int | float) and not isinstance(action.default, bool):
            told = action.help.replace("all processors", str(action.default))
            assert f"{action.default:g}" in told, f"{action.dest} does not say its default"


@pytest.mark.parametrize("command", COMMANDS)
def test_every_number_that_is_none_is_refused_by_what_was_expected(command):
    readers = [a for a in actions(command) if callable(a.type) and a.type.__name__ != "Path"]
    for action in readers:
        if action.dest == "param:overlay.title" or action.choices:
            continue
        with pytest.raises(argparse.ArgumentTypeError, match=r"^expected .*, got 'no\.number'$"):
            action.type("no.number")


@given(st.integers(-1000, 1000), st.integers(-5, 5), st.integers(6, 100))
def test_whole_numbers_are_taken_within_their_bounds_only(value, low, high):
    if low <= value <= high:
        assert whole(low, high)(str(value)) == value
    else:
        with pytest.raises(argparse.ArgumentTypeError):
            whole(low, high)(str(value))


@pytest.mark.parametrize("text", ["nan", "inf", "-1", "1e400", "", "1.5x"])
def test_what_is_no_ratio_and_no_time_is_refused(text):
    for reader in (ratio, positive):
        with pytest.raises(argparse.ArgumentTypeError, match=r"^expected a number"):
            reader(text)


def test_a_wrong_choice_is_answered_by_the_right_ones(disc, refused):
    line = refused("detect", disc, "--scheme", "7")
    assert line.startswith("geoprim detect: --scheme: expected one of refined, 1, 2, 3, got '7'")
    assert "expected one of detect, process" in refused("detcet", disc)


@pytest.mark.parametrize(
    "words",
    [
        ("detect", "IMAGE", "--overlay", "FILE/o.png"),
        ("explain", "IMAGE", "-o", "FILE"),
        ("polygons", "IMAGE", "-o", "FILE/o.png"),
        ("tangents", "IMAGE", "--csv", "FILE/t.csv"),
        ("bench", "IMAGE", "--repeat", "1", "--csv", "FILE/t.csv"),
        ("evaluate", "--sets", "noise", "--count", "1", "--output", "FILE"),
        ("calibrate", "--scenes", "1", "--singles", "0", "--output", "FILE/deeper"),
    ],
    ids=lambda words: words[0],
)
def test_a_file_in_the_way_of_a_folder_is_named(words, disc, file, refused):
    names = {"IMAGE": str(disc), "FILE": str(file)}
    filled = [names.get(w, w) for w in words]
    filled = [w.replace("FILE/", f"{file}/") for w in filled]
    assert f"{file} is a file, not a folder" in refused(*filled)


@pytest.mark.parametrize("command", ["tangents", "bench"])
def test_a_folder_in_the_place_of_a_table_is_told(command, disc, tmp_path, refused):
    words = [command, disc, "--csv", tmp_path, *(["--repeat", 1] if command == "bench" else [])]
    assert f"cannot write {tmp_path}: Is a directory" in refused(*words)


def test_a_format_that_is_not_known_is_answered_by_those_that_are(disc, tmp_path, refused):
    line = refused("detect", disc, "--overlay", tmp_path / "o.xyz")
    assert "o.xyz: expected a name that ends in .png, .jpg" in line


@pytest.mark.parametrize("command", ["evaluate", "calibrate"])
def test_an_image_or_nothing_is_no_ground_truth(command, disc, tmp_path, refused):
    assert "got a file" in refused(command, disc)
    line = refused(command, tmp_path, "--images", tmp_path / "nowhere")
    assert "nowhere: expected a folder" in line


def test_a_folder_without_curves_reproduces_nothing(tmp_path, refused):
    assert "expected chain codes" in refused("reproduce", "polygon", tmp_path)


def test_results_of_a_bag_are_not_shown_on_images(disc, tmp_path, refused):
    words = ("view", disc, "--results", tmp_path / "r.mcap", "--save", tmp_path / "s.mcap")
    assert "--results: expected a bag" in refused(*words)


def test_a_file_of_a_wrong_image_is_named_once(tmp_path, capsys):
    broken = tmp_path / "broken.png"
    broken.write_text("no image")
    assert main(["detect", str(broken)]) == 1
    assert capsys.readouterr().err.count("broken.png") == 1


def kinds(folder):
    """Write one picture in many kinds of files; return name -> path."""
    gray = disc_image(160, 120, centre=(70.25, 60.5), radius=35.5)
    colour = pillow.fromarray(np.repeat(gray[:, :, None], 3, axis=2))
    turned = pillow.Exif()
    turned[0x0112] = 6
    files = {
        "16 bits": (pillow.fromarray(gray.astype(np.uint16) * 257), "deep.png", {}),
        "float": (pillow.fromarray(gray.astype(np.float32) / 255), "float.tiff", {}),
        "alpha": (colour.convert("RGBA"), "alpha.png", {}),
        "gray and alpha": (colour.convert("LA"), "la.png", {}),
        "palette": (colour.convert("P"), "palette.png", {}),
        "CMYK": (colour.convert("CMYK"), "cmyk.jpg", {"quality": 98}),
        "turned by EXIF": (colour, "turned.jpg", {"quality": 98, "exif": turned}),
    }
    for image, name, options in files.values():
        image.save(folder / name, **options)
    return {kind: folder / name for kind, (_, name, _) in files.items()}


def test_every_kind_of_image_file_gives_its_disc(tmp_path):
    for kind, path in kinds(tmp_path).items():
        (found,) = detect_ellipses(read_image(path)).ellipses
        expected = (70.25, 60.5, 35.5)  # of the pixels as stored, turned or not
        assert np.allclose((found.x, found.y, found.semi_major), expected, atol=0.35), kind


@pytest.mark.parametrize("shape", [(1, 1), (1, 160), (3, 3)])
def test_the_smallest_images_hold_nothing_and_are_drawn(shape, tmp_path, capsys):
    path = tmp_path / "small.png"
    write_image(path, np.full(shape, 90, np.uint8))
    for words in (
        ["detect", path, "--overlay", tmp_path / "o.png"],
        ["explain", path, "-o", tmp_path / "steps"],
        ["polygons", path, "-o", tmp_path / "p.png"],
        ["tangents", path, "-o", tmp_path / "t.png", "--csv", tmp_path / "t.csv"],
    ):
        assert main([str(word) for word in words]) == 0
    assert capsys.readouterr().out.startswith(f"{path}: 0 ellipses")
