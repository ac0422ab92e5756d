"""Configuration files: the ones that are shipped, and what is refused."""

from pathlib import Path

import pytest
import yaml

from geoprim_core.applications import ClassParams
from geoprim_core.applications.sorting import OTHER
from geoprim_core.ecc import DetectorParams
from geoprim_core.errors import FileError, ParameterError
from geoprim_core.io.config import load_config
from geoprim_core.io.marker_message import MarkersParams
from geoprim_core.io.shown import OverlayParams, ViewParams
from geoprim_core.synthetic import SORTING_LINES

FOLDER = Path(__file__).resolve().parents[2] / "config"
SHIPPED = sorted(FOLDER.glob("*.yaml"))


def written(tmp_path, parameters, node="/**"):
    path = tmp_path / "params.yaml"
    path.write_text(yaml.safe_dump({node: {"ros__parameters": parameters}}))
    return path


def flat(values, prefix=""):
    for name, value in values.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


@pytest.mark.parametrize("path", SHIPPED, ids=lambda p: p.name)
def test_every_shipped_key_is_a_parameter_of_its_very_type(path):
    """ROS takes 1 for a whole number and refuses it where a parameter is a float."""
    values = yaml.safe_load(path.read_text())["/**"]["ros__parameters"]
    params = (DetectorParams, ViewParams, MarkersParams)
    options = {o.name: o for kind in params for o in kind.options()} | {OTHER.name: OTHER}
    for label in values["labels"]:
        options |= {f"{label}.{o.name}": o for o in ClassParams.options()}
    for name, value in flat(values):
        if name != "labels":
            assert name in options
            assert type(value) is options[name].kind, name
    config = load_config(path)
    assert list(config.sorting.classes) == values["labels"]


def test_there_is_a_file_for_every_rendered_line_and_a_default():
    names = {f"sorting_{name}.yaml" for name in SORTING_LINES} | {"default.yaml"}
    assert names <= {path.name for path in SHIPPED}
    default = load_config(FOLDER / "default.yaml")
    assert default.detector == DetectorParams()
    assert default.overlay == OverlayParams()
    assert list(default.sorting.classes) == ["ellipse"]


@pytest.mark.parametrize("name", SORTING_LINES)
def test_shipped_classes_hold_the_objects_of_their_line_and_no_other(name):
    line = SORTING_LINES[name]
    config = load_config(FOLDER / f"sorting_{name}.yaml")
    assert config.plane_distance == line.distance
    assert set(config.sorting.classes) == {kind.label for kind in line.objects}
    for kind in line.objects:
        corners = [(d, d * r) for d in kind.diameter for r in kind.ratio]
        for label, params in config.sorting.classes.items():
            fits = [
                params.min_length <= length <= params.max_length
                and params.min_width <= width <= params.max_width
                and params.min_axis_ratio <= width / length <= params.max_axis_ratio
                for length, width in corners
            ]
            assert all(fits) if label == kind.label else not any(fits), (label, kind)


def test_sections_and_dotted_names_are_taken_together(tmp_path):
    path = tmp_path / "params.yaml"
    path.write_text(
        "/**:\n  ros__parameters:\n    use_sim_time: true\n    edges: {min_length: 9}\n"
        "edges_node:\n  ros__parameters:\n    edges.sigma: 1.5\n    image_transport: raw\n"
    )
    config = load_config(path)
    assert config.detector.edges.min_length == 9
    assert config.detector.edges.sigma == 1.5
    assert config.plane_distance == 0


def test_a_whole_number_is_taken_for_a_float(tmp_path):
    assert load_config(written(tmp_path, {"plane_distance": 2})).plane_distance == 2.0


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"edges": {"sigmas": 1.0}}, r"params.yaml: edges.sigmas.*'edges.sigma'"),
        ({"lables": ["a"]}, r"params.yaml: lables.*'labels'"),
        ({"edges": {"min_length": 2.5}}, r"params.yaml: edges.min_length: expected a whole number"),
        ({"labels": ["a"], "a": {"unit": "cm"}}, r"params.yaml: a.unit.*px, mm.*'cm'"),
        ({"labels": ["a"], "b": {"unit": "px"}}, r"params.yaml: b.unit.*'a.unit'"),
        ({"labels": ["edges"]}, r"params.yaml: labels.*'edges'"),
        ({"labels": "a"}, r"params.yaml: labels.*list"),
        ({"plane_distance": -1.0}, r"params.yaml: plane_distance.*from 0.0"),
        ({"plane_distance": "far"}, r"params.yaml: plane_distance.*a number"),
    ],
)
def test_a_refusal_names_file_key_and_what_was_expected(tmp_path, parameters, text):
    with pytest.raises(ParameterError, match=text):
        load_config(written(tmp_path, parameters))


@pytest.mark.parametrize(
    ("content", "text"),
    [
        ("", "got None"),
        ("- a\n", "ROS 2 parameter file"),
        ("edges: {sigma: 1.0}\n", r"edges: expected.*ros__parameters"),
        ("a: [\n", "not a YAML file"),
        ("\x00", "not a YAML file"),
    ],
)
def test_other_files_are_refused(tmp_path, content, text):
    path = tmp_path / "other.yaml"
    path.write_text(content)
    with pytest.raises(FileError, match=rf"other.yaml.*{text}"):
        load_config(path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(FileError, match=r"none.yaml: No such file"):
        load_config(tmp_path / "none.yaml")
