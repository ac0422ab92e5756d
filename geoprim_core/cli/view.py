"""`geoprim view`: watch a bag, images or a live graph in Foxglove."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from itertools import count
from pathlib import Path

from geoprim_core.applications import SortingParams
from geoprim_core.cli.detector import (
    add_detector_arguments,
    add_overlay_arguments,
    detector_params,
    overlay_params,
)
from geoprim_core.cli.values import positive, whole
from geoprim_core.ecc import DetectorParams
from geoprim_core.errors import FileError, GeoprimError, InputError
from geoprim_core.io.bags import BagReader
from geoprim_core.io.config import Config, load_config
from geoprim_core.io.foxglove_view import IMAGE_FORMATS, View
from geoprim_core.io.images import SUFFIXES, list_images
from geoprim_core.io.process import Chain
from geoprim_core.io.view_frames import BagFrames, Detector, Due, Replay, Rhythm, image_frames

NODE = "geoprim_ros.nodes.view_node"
_POLL_S = 0.05

Frames = Callable[[], Iterable[Due]]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.epilog = "Open the address that is printed in Foxglove with the layout that is named."
    parser.add_argument(
        "source", nargs="*", type=Path, metavar="SOURCE", help="a bag, or images and folders"
    )
    parser.add_argument(
        "--live",
        nargs=argparse.REMAINDER,
        metavar="--ros-args ...",
        help="watch ROS topics instead; what follows goes to the node view_node",
    )
    parser.add_argument(
        "--results", type=Path, metavar="BAG", help="show the results of this bag, detect nothing"
    )
    parser.add_argument("--topic", default="image", help="the image topic (default image)")
    parser.add_argument("--rate", type=positive, default=1.0, help="times the speed (default 1)")
    parser.add_argument(
        "--fps", type=positive, default=2.0, help="image files a second (default 2)"
    )
    parser.add_argument("--once", action="store_true", help="end after one round")
    parser.add_argument("--wait", action="store_true", help="start when somebody looks")
    parser.add_argument("--host", default="127.0.0.1", help="where to serve (default 127.0.0.1)")
    parser.add_argument(
        "--port", type=whole(0, 65535), default=8765, help="where to; 0: a free one (default 8765)"
    )
    parser.add_argument(
        "--image-format",
        choices=IMAGE_FORMATS,
        default="jpeg",
        help="how images are sent; png loses nothing (default jpeg)",
    )
    parser.add_argument(
        "--save", type=Path, metavar="MCAP", help="write a file for Foxglove, serve nothing"
    )
    parser.add_argument(
        "--config", type=Path, metavar="YAML", help="a scenario file as the nodes take it"
    )
    add_detector_arguments(parser)
    add_overlay_arguments(parser)


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl-C, or until the end of the one round; exit code 1 for frames not usable."""
    if arguments.live is not None:
        return _live(arguments)
    if not arguments.source:
        raise FileError("nothing to view: name a bag, images, or --live")
    given = arguments.config is not None
    config = load_config(arguments.config) if given else Config(DetectorParams(), SortingParams())
    style = overlay_params(arguments, config.overlay)
    chain = Chain(
        detector_params(arguments, config.detector), config.sorting, config.plane_distance
    )
    detector = Detector(chain, style)
    frames = _frames(arguments, detector)
    with View(arguments.image_format, style) as view:
        replay = Replay(view)
        if arguments.save is not None:
            view.write_to(arguments.save)
            replay.play(frames())
        else:
            with _signals_end_it():
                detector.warm_up()  # whoever connects does not wait for the kernels
                _serve(arguments, view, replay, frames)
    if arguments.save is not None:
        print(f"{replay.shown} frames: {arguments.save}")
    if replay.bad:
        print(
            f"geoprim view: {replay.bad} frames not usable; the last: {replay.last_reason}",
            file=sys.stderr,
        )
    return 1 if replay.bad else 0


def layout_file() -> Path | None:
    """Return the layout for Foxglove that is shipped, from the source tree or as installed."""
    name = "foxglove_layout.json"
    places = (Path(__file__).parents[2] / "config", Path(sys.prefix, "share/geoprim_ros/config"))
    return next((place / name for place in places if (place / name).is_file()), None)


def _serve(arguments: argparse.Namespace, view: View, replay: Replay, frames: Frames) -> None:
    port = view.serve(arguments.host, arguments.port)
    print(f"ws://{arguments.host}:{port} (Foxglove: open connection, Foxglove WebSocket)")
    print(f"layout: {layout_file() or 'not installed'}", flush=True)
    while arguments.wait and not view.watched():
        time.sleep(_POLL_S)
    rhythm = Rhythm(arguments.rate)
    for _ in range(1) if arguments.once else count():
        start = time.monotonic()
        replay.play(frames(), rhythm)
        rhythm = Rhythm(arguments.rate)
        # A source of one picture shall not be sent as fast as the machine can.
        pause = 1.0 / arguments.fps if not arguments.once else 0.0
        time.sleep(max(0.0, pause - (time.monotonic() - start), _POLL_S))


@contextmanager
def _signals_end_it() -> Iterator[None]:
    """Let Ctrl-C and SIGTERM end the block, which is how a view ends."""

    def interrupt(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    except KeyboardInterrupt:
        print(file=sys.stderr)
    finally:
        signal.signal(signal.SIGTERM, before)


def _frames(arguments: argparse.Namespace, detector: Detector) -> Frames:
    first = arguments.source[0]
    images = first.suffix.lower() in SUFFIXES or (first.is_dir() and list_images(first))
    if not images:
        if len(arguments.source) > 1:
            raise FileError(f"{first} is a bag, and only one bag can be viewed")
        results = None if arguments.results is None else BagReader(arguments.results)
        return BagFrames(BagReader(first), arguments.topic, detector, results)
    if arguments.results is not None:
        raise InputError("--results", "a bag to show them with", f"{first}, images")
    paths = [path for place in arguments.source for path in list_images(place)]
    return lambda: image_frames(paths, detector, arguments.fps * arguments.rate)


def _live(arguments: argparse.Namespace) -> int:
    """Become the node that watches ROS topics."""
    if find_spec("rclpy") is None or find_spec("geoprim_ros") is None:
        raise GeoprimError("--live needs ROS 2 (rclpy) and geoprim_ros, which are not here")
    words = [word for word in arguments.live if word != "--ros-args"]
    own = {"host": arguments.host, "port": arguments.port, "image_format": arguments.image_format}
    given = [w for name, value in own.items() for w in ("-p", f"{name}:={value}")]
    sys.stdout.flush()
    os.execv(sys.executable, [sys.executable, "-m", NODE, "--ros-args", *given, *words])
    raise AssertionError  # the process is the node now
