"""A graph of its own for every test: own domain, this machine only, nodes in an own context."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress

import numpy as np
import pytest

# Before anything of ROS is imported.
os.environ["ROS_PYTHON_CHECK_FIELDS"] = "1"
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ.setdefault("ROS_LOG_DIR", tempfile.mkdtemp(prefix="geoprim_ros_log_"))

# The programs that tests end by a signal inherit what this process ignores: hang-ups under nohup,
# interrupts and quits in the background of a shell.
for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):
    if signal.getsignal(number) is signal.SIG_IGN:
        signal.signal(number, signal.SIG_DFL)

rclpy = pytest.importorskip("rclpy")
pytest.importorskip("geoprim_msgs.msg")

from geoprim_msgs.msg import Contours, Detections, EllipseDetections, Polygons  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402
from rclpy.qos import QoSProfile  # noqa: E402
from sensor_msgs.msg import CameraInfo, Image  # noqa: E402

from geoprim_core.io.image_message import image_record  # noqa: E402
from geoprim_core.synthetic import disc_image  # noqa: E402
from geoprim_ros.conversions import to_message  # noqa: E402
from geoprim_ros.domains import owners, private_domain, take_domain  # noqa: E402
from geoprim_ros.shared_memory import clean  # noqa: E402

# For what is not run inside a test.
os.environ["ROS_DOMAIN_ID"] = str(private_domain().number)
LEFT_S = 15.0  # a node that was told to end may take so long

RESULTS = {
    "contours": Contours,
    "polygons": Polygons,
    "ellipses": EllipseDetections,
    "detections": Detections,
}
DISC = {"centre": (161.3, 118.7), "radius": 60.0}


class Graph:
    """Nodes in one context and one executor, and processes beside them."""

    def __init__(self, domain=None):
        self.domain = domain
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.nodes = []
        self.processes = []

    def add(self, node):
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def node(self, name, **options):
        return self.add(rclpy.create_node(name, context=self.context, **options))

    def start(self, module, *args):
        """Start a module in a process of its own."""
        command = [sys.executable, "-m", module, *map(str, args)]
        domain = {} if self.domain is None else {"ROS_DOMAIN_ID": str(self.domain)}
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, **domain},
        )  # fmt: skip
        self.processes.append(process)
        return process

    def spin_until(self, condition, timeout=20.0, what=""):
        """Spin until something is true; discovery alone can take three seconds."""
        end = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < end, f"not reached in {timeout} s: {what or condition}"
            self.executor.spin_once(timeout_sec=0.02)

    def spin_for(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def collect(self, node, kind, topic, depth=50):
        """Subscribe reliably and return the list that fills."""
        got = []
        node.create_subscription(kind, topic, got.append, depth)
        return got

    def close(self):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.communicate(timeout=10)
        if self.processes:
            # What they announced last is heard before the participant goes: Fast DDS can hang
            # where both meet (see geoprim_ros.deadline).
            self.spin_for(0.2)
        for node in self.nodes:
            self.executor.remove_node(node)
            node.destroy_node()
        self.executor.shutdown(timeout_sec=1.0)
        self.context.try_shutdown()


class Feed:
    """A source of images and a collector of results."""

    def __init__(self, graph, topics=tuple(RESULTS), name="feed"):
        self.graph = graph
        self.node = graph.node(name)
        self.images = self.node.create_publisher(Image, "image", QoSProfile(depth=10))
        self.infos = self.node.create_publisher(CameraInfo, "camera_info", QoSProfile(depth=10))
        self.got = {topic: self.collect(topic) for topic in topics}

    def collect(self, topic):
        return self.graph.collect(self.node, RESULTS[topic], topic)

    def wait(self, *topics):
        """Wait until the image has a reader and the topics have writers."""
        ready = self.images.get_subscription_count
        count = self.node.count_publishers
        # A process may have to compile its kernels first.
        self.graph.spin_until(lambda: ready() and all(count(t) for t in topics), 120.0)
        self.graph.spin_for(0.3)

    def send(self, message, topic="detections"):
        """Publish an image and wait for one more result."""
        before = len(self.got[topic])
        self.images.publish(message)
        self.graph.spin_until(lambda: len(self.got[topic]) > before, what=f"a result on {topic}")
        return self.got[topic][-1]

    def ask(self, kind, service, request):
        """Call a service and return its answer."""
        client = self.node.create_client(kind, service)
        self.graph.spin_until(client.service_is_ready, 60.0, f"service {service}")
        future = client.call_async(request)
        self.graph.spin_until(future.done, 60.0, f"an answer of {service}")
        return future.result()


def value_of(reports, name, key):
    """Return what a node told last under a key on /diagnostics, or None."""
    for report in reversed(reports):
        for status in report.status:
            if status.name.startswith(name):
                return next((v.value for v in status.values if v.key == key), None)
    return None


@pytest.fixture(scope="session", autouse=True)
def nothing_stays_in_memory():
    """Take away what the killed processes of the tests leave."""
    yield
    clean(settled_s=1.0)


def left_in(domain, limit_s=LEFT_S):
    """Wait until a domain is empty; return number -> command of who stays, which is ended."""
    end = time.monotonic() + limit_s
    while domain.sockets() and time.monotonic() < end:
        time.sleep(0.02)
    found = owners(domain.sockets())
    for number in found.keys() - {os.getpid()}:
        with suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
    return found


@pytest.fixture
def who_stays():
    return left_in


@pytest.fixture
def make_domain():
    """Take domains that hold nobody but who is put there; each has to be left empty."""
    taken = []

    def make():
        taken.append(take_domain())
        return taken[-1].number

    yield make
    left = [found for domain in taken if (found := left_in(domain))]
    for domain in taken:
        domain.release()
    assert not left, f"still in the domain of the test when it was over: {left}"


@pytest.fixture(autouse=True)
def domain(make_domain):
    """The domain of the test and of all that it starts."""
    before, number = os.environ["ROS_DOMAIN_ID"], make_domain()
    os.environ["ROS_DOMAIN_ID"] = str(number)
    yield number
    os.environ["ROS_DOMAIN_ID"] = before


@pytest.fixture
def told():
    return value_of


@pytest.fixture
def feed(graph):
    return Feed(graph)


@pytest.fixture
def make_feed(graph):
    """Make a feed that listens to some of the results only."""
    return lambda *topics, **options: Feed(graph, topics, **options)


@pytest.fixture
def graph(domain):
    graph = Graph()
    yield graph
    graph.close()


@pytest.fixture
def other_feed(make_domain):
    """A feed in a graph on another domain."""
    graph = Graph(make_domain())
    yield Feed(graph)
    graph.close()


@pytest.fixture
def disc_message():
    """Make the message of a 320x240 image with one disc."""

    def make(stamp_ns=1_000_000_007, **changes):
        image = disc_image(320, 240, **DISC)
        colour = np.repeat(image[:, :, None], 3, axis=2)
        message = to_message(image_record(colour, stamp_ns, "camera"))
        for name, value in changes.items():
            setattr(message, name, value)
        return message

    return make


@pytest.fixture
def disc():
    return DISC
