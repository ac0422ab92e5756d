"""ROS parameters are the fields of the Params classes: ranges, units, refusals, YAML."""

from pathlib import Path

import numpy as np
import pytest
import rclpy
import yaml
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import DescribeParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter

from geoprim_core.applications.sorting import PLANE_DISTANCE, SortingParams
from geoprim_core.ecc import DetectorParams, detect_ellipses
from geoprim_core.errors import InputError, ParameterError
from geoprim_core.io.image_message import image_from_message
from geoprim_core.io.wire import from_wire
from geoprim_ros.chain import work_once
from geoprim_ros.nodes.detector_node import DetectorNode
from geoprim_ros.nodes.edges_node import EdgesNode
from geoprim_ros.nodes.ellipses_node import EllipsesNode
from geoprim_ros.nodes.markers_node import MarkersNode
from geoprim_ros.nodes.overlay_node import OverlayNode
from geoprim_ros.nodes.polygons_node import PolygonsNode
from geoprim_ros.param_dump import as_yaml, parameters_of

CONFIG = Path(__file__).parents[2] / "config"
SCENARIOS = sorted(CONFIG.glob("*.yaml"))


def _parameters(**values):
    return [Parameter(name.replace("__", "."), value=value) for name, value in values.items()]


def _call(graph, client, request):
    graph.spin_until(client.service_is_ready)
    future = client.call_async(request)
    graph.spin_until(future.done)
    return future.result()


@pytest.fixture
def edges(graph):
    return graph.add(EdgesNode(context=graph.context))


def test_descriptors_carry_text_unit_range_and_choices(graph, edges):
    options = [o for o in DetectorParams.options() if o.name.startswith("edges.")]
    client = graph.node("asker").create_client(
        DescribeParameters, "/edges_node/describe_parameters"
    )
    answer = _call(graph, client, DescribeParameters.Request(names=[o.name for o in options]))
    kinds = {
        bool: ParameterType.PARAMETER_BOOL,
        int: ParameterType.PARAMETER_INTEGER,
        float: ParameterType.PARAMETER_DOUBLE,
        str: ParameterType.PARAMETER_STRING,
    }
    for option, descriptor in zip(options, answer.descriptors, strict=True):
        assert descriptor.name == option.name
        assert descriptor.type == kinds[option.kind]
        assert descriptor.description.startswith(option.text)
        assert option.unit in descriptor.description
        assert all(choice in descriptor.additional_constraints for choice in option.choices)
        ranges = list(descriptor.floating_point_range) + list(descriptor.integer_range)
        bounds = [(r.from_value, r.to_value) for r in ranges]
        assert bounds == ([] if option.low is None else [(option.low, option.high)])


def test_the_stage_nodes_have_the_parameters_of_the_detector_between_them(graph):
    def declared(kind):
        node = graph.add(kind(context=graph.context))
        return {
            n
            for n in node._parameters
            if not n.startswith(("qos_overrides", "use_sim", "start_type", "lazy", "max_waiting"))
        }

    stages = [declared(kind) for kind in (EdgesNode, PolygonsNode, EllipsesNode)]
    assert set.union(*stages) == declared(DetectorNode)
    assert {o.name for o in DetectorParams.options()} <= set.union(*stages)
    assert sum(map(len, stages)) == len(set.union(*stages))


def test_a_live_change_takes_effect_as_a_new_object(edges):
    before = edges._params.value
    (result,) = edges.set_parameters(_parameters(edges__sigma=2.5))
    assert result.successful
    assert edges._params.value.edges.sigma == 2.5
    assert before.edges.sigma != 2.5
    assert edges.get_parameter("edges.sigma").value == 2.5
    assert edges.revision == 1


def test_a_whole_number_is_taken_for_a_float(edges):
    (result,) = edges.set_parameters(_parameters(edges__sigma=2))
    assert result.successful
    assert edges.get_parameter("edges.sigma").value == 2.0


def test_whole_numbers_of_a_file_stand_for_floats_and_names(graph, tmp_path):
    """`scheme: 2` of a YAML file is a number, and so is `sigma: 1`."""
    file = tmp_path / "scheme.yaml"
    file.write_text("/**:\n  ros__parameters:\n    ecc: {scheme: 2}\n    edges: {sigma: 1}\n")
    words = ["--ros-args", "--params-file", str(file)]
    node = graph.add(DetectorNode(context=graph.context, cli_args=words))
    assert node._params.value == DetectorParams.from_dict({"ecc.scheme": "2", "edges.sigma": 1.0})
    assert node.get_parameter("ecc.scheme").value == "2"
    (result,) = node.set_parameters(_parameters(ecc__scheme=3))
    assert result.successful and node._params.value.ecc.scheme == "3"
    with pytest.raises(ParameterError, match=r"ecc.scheme: expected one of .*, got 7 \(int\)"):
        EllipsesNode(context=graph.context, cli_args=["--ros-args", "-p", "ecc.scheme:=7"])


@pytest.mark.parametrize(
    "change",
    [
        {"edges.sigma": 99.0},
        {"edges.sigma": float("nan")},
        {"edges.sigma": "wide"},
        {"edges.linking": "nothing"},
        {"edges.min_length": 1},
        {"edges.low_auto": 9.0},
    ],
)
def test_a_refused_change_says_what_the_constructor_says(graph, edges, change):
    with pytest.raises(ParameterError) as refusal:
        DetectorParams().updated(change)
    before = edges._params.value
    messages = [Parameter(n, value=v).to_parameter_msg() for n, v in change.items()]
    client = graph.node("asker").create_client(SetParameters, "/edges_node/set_parameters")
    (result,) = _call(graph, client, SetParameters.Request(parameters=messages)).results
    assert not result.successful
    assert result.reason == str(refusal.value)
    assert edges._params.value is before
    assert edges.revision == 0


def test_an_atomic_change_is_all_or_nothing(graph, edges):
    client = graph.node("asker").create_client(
        SetParametersAtomically, "/edges_node/set_parameters_atomically"
    )

    def change(**values):
        messages = [p.to_parameter_msg() for p in _parameters(**values)]
        request = SetParametersAtomically.Request(parameters=messages)
        return _call(graph, client, request).result

    # Each alone would put the low threshold above the high one for a moment.
    assert change(edges__low_auto=6.0, edges__high_auto=8.0).successful
    assert edges._params.value.edges.low_auto == 6.0
    refused = change(edges__sigma=2.0, edges__high_auto=1.0)
    assert not refused.successful and "high_auto" in refused.reason
    assert edges._params.value.edges.sigma == DetectorParams().edges.sigma


def test_sorting_classes_change_live(graph):
    node = graph.add(EllipsesNode(context=graph.context))
    sorting = node._results._sorting
    assert list(sorting.value.classes.classes) == ["ellipse"]
    (result,) = node.set_parameters([Parameter("labels", value=["lid", "ring"])])
    assert result.successful, result.reason
    (result,) = node.set_parameters(_parameters(ring__max_length=50.0))
    assert result.successful, result.reason
    assert sorting.value.classes.classes["ring"].max_length == 50.0
    (result,) = node.set_parameters(_parameters(ring__min_length=60.0))
    assert not result.successful
    assert "ring.min_length" in result.reason and "max_length = 50.0" in result.reason
    (result,) = node.set_parameters(_parameters(plane_distance=-1.0))
    assert not result.successful and " m" in result.reason
    (result,) = node.set_parameters([Parameter("labels", value=["not a name"])])
    assert not result.successful and "labels" in result.reason
    assert list(sorting.value.classes.classes) == ["lid", "ring"]


def test_the_fields_of_a_label_go_and_come_with_it(graph):
    words = ["--ros-args", "-p", "ring.max_length:=40.0", "-p", "labels:=[lid, ring]"]
    node = graph.add(EllipsesNode(context=graph.context, cli_args=words))

    def change(**values):
        return node.set_parameters_atomically(_parameters(**values)).successful

    assert change(ring__min_length=12.0)
    assert change(labels=["lid"])
    assert not node.has_parameter("ring.min_length")
    assert change(labels=["lid", "ring"])
    ring = node._results._sorting.value.classes.classes["ring"]
    assert (ring.min_length, ring.max_length) == (12.0, 40.0)
    assert node.get_parameter("ring.min_length").value == 12.0
    assert change(ring__min_length=13.0)


def test_there_is_a_scenario_for_each_sorting_task():
    names = {path.stem for path in SCENARIOS}
    assert {f"sorting_{n}" for n in ("cans", "coins", "produce", "ores")} <= names


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_a_parameter_file_arrives_whole(graph, path):
    """Every value of the file is the parameter's value and part of the objects made from it."""
    (section,) = yaml.safe_load(path.read_text()).values()
    wanted = dict(_flat(section["ros__parameters"]))
    args = ["--ros-args", "--params-file", str(path)]
    node = graph.add(DetectorNode(context=graph.context, cli_args=args))
    markers = graph.add(MarkersNode(context=graph.context, cli_args=args))
    drawn = {n: wanted.pop(n) for n in list(wanted) if n.startswith(("overlay.", "markers."))}
    for name, value in drawn.items():
        assert markers.get_parameter(name).value == value, name
    assert {**markers._params.value.to_dict(), **markers._style.value.to_dict()}.items() >= (
        drawn.items()
    )
    for name, value in wanted.items():
        assert node.get_parameter(name).value == value, name
    detector = {n: v for n, v in wanted.items() if n in DetectorParams().to_dict()}
    sorting = {n: v for n, v in wanted.items() if n not in detector}
    distance = sorting.pop("plane_distance", PLANE_DISTANCE.default)
    assert node._params.value == DetectorParams.from_dict(detector)
    task = node._results._sorting.value
    assert task.classes == SortingParams.from_dict(sorting)
    assert task.plane_distance == distance


@pytest.mark.parametrize("kind", [EdgesNode, PolygonsNode, EllipsesNode, OverlayNode, MarkersNode])
def test_one_parameter_file_serves_every_node(graph, kind):
    """No node has a parameter of another type under a name that the files use."""
    for path in SCENARIOS:
        args = ["--ros-args", "--params-file", str(path)]
        node = graph.add(kind(context=graph.context, cli_args=args))
        ((_, section),) = yaml.safe_load(path.read_text()).items()
        for name, value in _flat(section["ros__parameters"]):
            if node.has_parameter(name):
                assert node.get_parameter(name).value == value


def _flat(values, prefix=""):
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def test_a_wrong_value_at_the_start_is_one_sentence(graph, tmp_path):
    for text, said in (("99.0", "5.0 px, got 99.0"), ("'wide'", "got 'wide'")):
        args = ["--ros-args", "-p", f"edges.sigma:={text}"]
        with pytest.raises(ParameterError, match=f"edges.sigma: expected a number.*{said}"):
            EdgesNode(context=graph.context, cli_args=args)


def test_qos_can_be_overridden(graph):
    node = EdgesNode(
        context=graph.context,
        cli_args=[
            "--ros-args",
            "-p", "qos_overrides./image.subscription.reliability:=reliable",
            "-p", "qos_overrides./image.subscription.depth:=7",
            "-p", "lazy:=false",
        ],
    )  # fmt: skip
    graph.add(node)
    (image,) = [s for s in node.subscriptions if s.topic_name == "/image"]
    assert image.qos_profile.reliability == rclpy.qos.ReliabilityPolicy.RELIABLE
    assert image.qos_profile.depth == 7
    always = ["--ros-args", "-p", "lazy:=false"]
    plain = graph.add(PolygonsNode(context=graph.context, cli_args=always))
    (contours,) = [s for s in plain.subscriptions if s.topic_name == "/contours"]
    assert contours.qos_profile.reliability == rclpy.qos.ReliabilityPolicy.RELIABLE
    assert contours.qos_profile.depth == 10


NODES = {
    kind: f"{kind.__name__}".removesuffix("Node").lower() + "_node"
    for kind in (EdgesNode, PolygonsNode, EllipsesNode, OverlayNode, MarkersNode, DetectorNode)
}
CHOICES = [(o.name, choice) for o in DetectorParams.options() for choice in o.choices]


def _another(option, value):
    """Return a valid value that is not the present one."""
    if option.choices:
        return next(c for c in option.choices if c != value) if len(option.choices) > 1 else value
    if option.kind is bool:
        return not value
    if option.kind is str:
        return value + "other"
    low = 0 if option.low is None else option.low
    high = 100 if option.high is None else option.high
    middle = option.kind(low + 0.75 * (value - low) if value > low else min(high, low + 1))
    return middle if middle != value else option.kind(min(high, value + 1))


@pytest.mark.parametrize("kind", NODES)
def test_every_parameter_changes_live(graph, kind):
    node = graph.add(kind(context=graph.context))
    live = node._params
    for name, option in live.options.items():
        value = _another(option, live.value.to_dict()[name])
        (result,) = node.set_parameters([Parameter(name, value=value)])
        assert result.successful, (name, value, result.reason)
        assert live.value.to_dict()[name] == value == node.get_parameter(name).value
    assert node.revision == len(live.options)


@pytest.mark.parametrize("kind", NODES)
def test_every_parameter_refuses_with_its_reason(graph, kind):
    node = graph.add(kind(context=graph.context))
    before = node._params.value
    for name, option in node._params.options.items():
        wrong = "no such thing" if option.kind is not str else -3
        (result,) = node.set_parameters([Parameter(name, value=wrong)])
        assert not result.successful
        assert result.reason.startswith(f"{name}: expected {option.expectation()}, got ")
    assert node._params.value is before


@pytest.mark.parametrize(("name", "choice"), CHOICES)
def test_every_method_is_switched_to_live_and_used(graph, feed, disc_message, name, choice):
    """The next frame is worked with the method, as the core does it."""
    params = DetectorParams.from_dict({name: choice})
    work_once(params)  # its kernels may be new
    node = graph.add(DetectorNode(context=graph.context))
    feed.wait("detections")
    feed.send(disc_message(1))
    (result,) = node.set_parameters([Parameter(name, value=choice)])
    assert result.successful
    message = disc_message(2)
    feed.send(message)
    graph.spin_until(lambda: all(len(g) == 2 for g in feed.got.values()))
    direct = detect_ellipses(image_from_message(message), params)
    found = from_wire(feed.got["ellipses"][-1])
    np.testing.assert_array_equal(found.ellipses.array(), direct.ellipses.array())
    assert feed.got["polygons"][-1].method == params.polygon_method


@pytest.mark.parametrize("kind", NODES)
def test_a_dump_started_from_is_the_same_node(graph, kind, tmp_path):
    """Changed live, dumped through the services, loaded with --params-file: dumped alike."""
    name = f"/{NODES[kind]}"
    words = ["-p", "qos_overrides./image.subscription.depth:=3", "-p", "lazy:=false"]
    node = graph.add(kind(context=graph.context, cli_args=["--ros-args", *words]))
    for option in node._params.options.values():
        value = _another(option, node._params.value.to_dict()[option.name])
        assert node.set_parameters([Parameter(option.name, value=value)])[0].successful
    if node.has_parameter("labels"):
        assert node.set_parameters([Parameter("labels", value=["can_52", "lid"])])[0].successful
        assert node.set_parameters([Parameter("lid.unit", value="mm")])[0].successful
    asker = graph.node("asker")
    first = parameters_of(asker, graph.executor, name)
    assert {n: node.get_parameter(n).value for n in first} == first
    assert len(first) == len(node._parameters)
    graph.executor.remove_node(node)
    graph.nodes.remove(node)
    node.destroy_node()

    file = tmp_path / "dump.yaml"
    file.write_text(as_yaml(name, first))
    words = ["--ros-args", "--params-file", str(file)]
    again = graph.add(kind(context=graph.context, cli_args=words))
    graph.spin_for(0.3)
    second = parameters_of(asker, graph.executor, name)
    assert second == first
    assert as_yaml(name, second) == file.read_text()
    assert again._params.value == node._params.value


def test_a_dump_is_printed_by_a_command(graph):
    graph.add(PolygonsNode(context=graph.context))
    process = graph.start("geoprim_ros.param_dump", "/polygons_node")
    graph.spin_until(lambda: process.poll() is not None, 60.0)
    out, err = process.communicate()
    assert (process.returncode, err) == (0, "")
    section = yaml.safe_load(out)["/polygons_node"]["ros__parameters"]
    assert section["polygon_method"] == DetectorParams().polygon_method
    assert section["lazy"] is True


def test_asking_a_node_that_is_not_there_is_one_sentence(graph):
    asker = graph.node("asker")
    with pytest.raises(InputError, match=r"running node that answers in 0\.2 s, got '/nobody'"):
        parameters_of(asker, graph.executor, "/nobody", 0.2)
