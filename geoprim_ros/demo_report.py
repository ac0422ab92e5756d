"""What the demo shows at its end: counts, scores, times and pictures."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from geoprim_core._check import AnyArray
from geoprim_core.io.bags import BagReader
from geoprim_core.io.drawing import draw_overlay
from geoprim_core.io.images import write_image
from geoprim_core.io.mosaic import mosaic
from geoprim_core.io.record import stamp_of
from geoprim_core.io.score_bag import score_bag
from geoprim_core.io.wire import from_wire
from geoprim_core.types import Detections

OVERLAY_EVERY = 10


@dataclass
class Scenario:
    """A stretch of the bag that runs with one configuration file, and what was measured on it.

    Attributes
    ----------
    config : str
        The configuration file.
    start_ns, end_ns : int
        Log times of the first and the last frame.
    sequences : list of str
    frames : int
    sent, answered : dict
        Stamp of an image -> when it was sent, when its objects came, in seconds.
    diagnostics : dict
        Node -> its last statistics.
    """

    config: str
    start_ns: int
    end_ns: int
    sequences: list[str] = field(default_factory=list)
    frames: int = 0
    sent: dict[int, float] = field(default_factory=dict)
    answered: dict[int, float] = field(default_factory=dict)
    diagnostics: dict[str, dict[str, str]] = field(default_factory=dict)

    def latencies(self) -> list[float]:
        """Return the seconds from sending an image to receiving its objects, one an answer."""
        return [when - self.sent[stamp] for stamp, when in self.answered.items()]

    def pace(self) -> float:
        """Return the answers a second between the first and the last; NaN for fewer than two."""
        times = list(self.answered.values())
        return (len(times) - 1) / (max(times) - min(times)) if len(times) > 1 else float("nan")


def report(reader: BagReader, scenarios: Sequence[Scenario], results: Path, output: Path) -> int:
    """Print and draw the results; 0 where every frame was answered, else 1."""
    detected = count_results(results)
    print("\nDetected, per sequence")
    for scenario in scenarios:
        for sequence in scenario.sequences:
            print("  " + sequence_line(sequence, detected[sequence]))
    print("\nAgainst the ground truth of the rendered sequences, one to one")
    print(score_bag(results, overlaps=(0.8,)).markdown())
    print_times(scenarios)
    pictures = draw_overlays(reader, results, output / "overlays")
    print(f"\noverlays:   {output / 'overlays'} ({pictures} pictures)")
    print(f"overview:   {output / 'overview.png'}")
    print(f"result bag: {results}")
    missing = sum(len(s.sent) - len(s.answered) for s in scenarios)
    if missing:
        print(f"geoprim: {missing} frames were not answered")
    return 1 if missing else 0


@dataclass
class SequenceCounts:
    """What was found in one sequence."""

    frames: int = 0
    ellipses: int = 0
    labels: Counter[str] = field(default_factory=Counter)


def count_results(results: Path) -> dict[str, SequenceCounts]:
    """Return sequence -> counts of a result bag."""
    counts: dict[str, SequenceCounts] = defaultdict(SequenceCounts)
    reader = BagReader(results)
    for message in reader.messages(["ellipses"]):
        counts[message.decoded.header.frame_id].frames += 1
        counts[message.decoded.header.frame_id].ellipses += len(message.decoded.detections)
    for message in reader.messages(["detections"]):
        labels = (d.label for d in message.decoded.detections)
        counts[message.decoded.header.frame_id].labels.update(labels)
    return counts


def sequence_line(name: str, counts: SequenceCounts) -> str:
    """Return one line of the summary.

    Examples
    --------
    >>> sequence_line("sorting_cans", SequenceCounts(2, 9, Counter(lid=8)))
    'sorting_cans           2 frames   4.5 ellipses a frame   4.0 lid'
    """
    frames = max(counts.frames, 1)
    labels = ", ".join(f"{n / frames:.1f} {label}" for label, n in counts.labels.most_common())
    line = f"{name:20} {counts.frames:3d} frames {counts.ellipses / frames:5.1f} ellipses a frame"
    return f"{line}   {labels}".rstrip()


def print_times(scenarios: Sequence[Scenario]) -> None:
    """Print the pace and the latencies of the live graph, per scenario and node."""
    print("Live graph: times in ms, p50 / p95")
    for scenario in scenarios:
        p50, p95 = percentiles_ms(scenario.latencies())
        name = Path(scenario.config).stem
        print(
            f"  {name:16} {len(scenario.sent)} sent, {len(scenario.answered)} answered, "
            f"{scenario.pace():.1f} frames/s, image sent -> objects received {p50:.1f} / {p95:.1f}"
        )
        for node in ("edges_node", "polygons_node", "ellipses_node"):
            v = scenario.diagnostics.get(node, {})
            print(
                f"    {node:14} hop {v.get('hop latency p50 [ms]', '?')} / "
                f"{v.get('hop latency p95 [ms]', '?')}, stage {v.get('stage time p50 [ms]', '?')}"
                f" / {v.get('stage time p95 [ms]', '?')}, dropped {v.get('dropped', '?')}, "
                f"bad {v.get('bad', '?')}"
            )


def draw_overlays(reader: BagReader, results: Path, folder: Path) -> int:
    """Draw every tenth frame of each sequence, and an overview of one frame each."""
    found = {stamp_of(m.decoded): m.decoded for m in BagReader(results).messages(["ellipses"])}
    objects = {stamp_of(m.decoded): m.decoded for m in BagReader(results).messages(["detections"])}
    seen: Counter[str] = Counter()
    middle: dict[str, AnyArray] = {}
    written = 0
    for stamp, sequence, image in frames_of(reader):
        number = seen[sequence]
        seen[sequence] += 1
        if number % OVERLAY_EVERY or stamp not in found:
            continue
        overlay = overlay_of(image, found[stamp], objects.get(stamp))
        write_image(folder / f"{sequence}_{number:03d}.png", overlay)
        written += 1
        if number <= 3 * OVERLAY_EVERY:
            middle[sequence] = overlay
    write_image(folder.parent / "overview.png", mosaic(list(middle.values())))
    return written


def frames_of(reader: BagReader) -> Iterator[tuple[int, str, AnyArray]]:
    """Yield stamp, sequence and image of every frame that can be decoded."""
    for frame in reader.images("image"):
        if frame.image is not None:
            yield frame.stamp_ns, frame.frame_id, frame.image


def overlay_of(image: AnyArray, ellipses: Any, objects: Any) -> AnyArray:
    """Return the image with its labelled objects drawn, or with its ellipses where none is."""
    sorted_objects = None if objects is None else from_wire(objects)
    if isinstance(sorted_objects, Detections) and len(sorted_objects):
        return draw_overlay(image, detections=sorted_objects)
    found: Any = from_wire(ellipses)
    return draw_overlay(image, ellipses=found)


def percentiles_ms(seconds: Sequence[float]) -> tuple[float, float]:
    """Return the median and the 95th percentile in milliseconds; NaN without any."""
    if not seconds:
        return float("nan"), float("nan")
    p50, p95 = np.percentile(np.asarray(seconds), [50, 95]) * 1e3
    return float(p50), float(p95)
