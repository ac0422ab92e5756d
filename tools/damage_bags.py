"""Damage bags at random and hold what is read of them against a law.

    python tools/damage_bags.py --count 1000          # the full run; the tests do some dozens

The law, for every damage there is:

1. Every message that comes without a doubt is one of the original ones, with topic, type, times
   and bytes, and comes at most as often as it was written.
2. When a message is missing or comes with a doubt, the losses say so; where the bag tells how many
   messages it had, their number is exact; the number of doubtful ones always is.
3. The log time of every missing message lies in the range of a loss, or the range of one is open.
4. The messages come in the order of their log times, or a note says that they do not; reading again
   or reading one topic gives the same; a repair gives them too, in a bag that is whole.
5. What cannot be read at all is refused with one `BagError`; nothing else is raised.

Prints a table: kind of damage, what was read and lost, and how often which exit code came.
"""

from __future__ import annotations

import argparse
import random
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from geoprim_core.errors import BagError
from geoprim_core.io.bag_check import inspect_bag
from geoprim_core.io.bag_repair import repair_bag
from geoprim_core.io.bags import BagReader
from geoprim_core.io.definitions import schema_text, serialize
from geoprim_core.io.image_message import image_record
from geoprim_core.io.record import header
from geoprim_core.io.wire import to_wire
from geoprim_core.types import Contours

FRAMES = 60
STEP_NS = 66_666_666
LONGEST_S = 60
COMPRESSIONS = (CompressionType.ZSTD, CompressionType.LZ4, CompressionType.NONE)


def build(path, seed, compression, chunk_bytes=6_000, frames=FRAMES):
    """Write a bag of images, contours and stamps; return its messages and where its end starts."""
    numbers = np.random.default_rng(seed)
    with path.open("wb") as file:
        writer = Writer(file, chunk_bytes, compression)
        writer.start(profile="ros2", library="damage_bags")
        channels = {}
        for i in range(frames):
            stamp = i * STEP_NS + int(numbers.integers(0, 1000)) + 10**18
            for topic, record in _records(i, stamp, numbers):
                if topic not in channels:
                    text = schema_text(record.type).encode()
                    schema = writer.register_schema(record.type, "ros2msg", text)
                    channels[topic] = writer.register_channel(topic, "cdr", schema)
                # now and then a message is late by some frames
                late = int(numbers.integers(0, 4)) * STEP_NS if numbers.random() < 0.1 else 0
                writer.add_message(channels[topic], stamp - late, serialize(record), stamp, i)
        writer.add_metadata("scene", {"kind": "noise"})
        writer.add_attachment(1, 2, "note.txt", "text/plain", b"of no weight " * 20)
        writer.finish()
    return messages_of(path)


def _records(i, stamp, numbers):
    pixels = numbers.integers(0, 256, (30, 40)).astype(np.uint8)
    if i % 2:
        pixels[:, 10:] = 7  # a half of the images packs well
    yield "camera/image", image_record(pixels, stamp, "camera")
    points = numbers.uniform(0, 40, (50, 2))
    yield "contours", to_wire(Contours(points, [0, 50], [False], (40, 30)), stamp, "camera")
    yield "stamps", header(stamp, f"frame {i}")


def messages_of(path):
    """Return the messages as the library of MCAP reads them."""
    with path.open("rb") as file:
        return [
            (channel.topic, schema.name, message.log_time, message.data)
            for schema, channel, message in make_reader(file).iter_messages()
        ]


def flip(data, dice, other):
    for _ in range(dice.randint(1, 8)):
        place = dice.randrange(len(data))
        data[place] ^= 1 << dice.randrange(8)


def cut(data, dice, other):
    del data[dice.randrange(1, len(data)) :]


def delete(data, dice, other):
    start, length = _range(data, dice)
    del data[start : start + length]


def zero(data, dice, other):
    start, length = _range(data, dice)
    data[start : start + length] = bytes(min(length, len(data) - start))


def overwrite(data, dice, other):
    start, length = _range(data, dice)
    data[start : start + length] = dice.randbytes(min(length, len(data) - start))


def insert(data, dice, other):
    place = dice.randrange(len(data))
    data[place:place] = dice.randbytes(dice.randint(1, 5000))


def duplicate(data, dice, other):
    start, length = _range(data, dice)
    place = dice.randrange(len(data))
    data[place:place] = data[start : start + length]


def copy_over(data, dice, other):
    start, length = _range(data, dice)
    part = data[start : start + length]
    place = dice.randrange(len(data))
    data[place : place + len(part)] = part


def move(data, dice, other):
    start, length = _range(data, dice)
    part = data[start : start + length]
    del data[start : start + length]
    place = dice.randrange(len(data) or 1)
    data[place:place] = part


def splice(data, dice, other):
    start, length = _range(other, dice)
    place = dice.randrange(len(data))
    data[place : place + dice.choice((0, length))] = other[start : start + length]


def zero_tail(data, dice, other):
    start = dice.randrange(1, len(data))
    data[start:] = bytes(len(data) - start)


def several(data, dice, other):
    for _ in range(dice.randint(2, 3)):
        dice.choice(SINGLE)(data, dice, other)
        if not data:
            return


def _range(data, dice):
    start = dice.randrange(len(data))
    return start, dice.choice((dice.randint(1, 200), dice.randint(1, 30_000), len(data) // 3))


SINGLE = (
    flip, cut, delete, zero, overwrite, insert, duplicate, copy_over, move, splice, zero_tail,
)  # fmt: skip
KINDS = (*SINGLE, several)


@dataclass
class Outcome:
    """What was read of a damaged bag, and where the law is broken."""

    read: int = 0
    doubtful: int = 0
    lost: int = 0
    said: int = 0
    exact: bool = False
    code: int = 2
    broken: list[str] = field(default_factory=list)


def judge(path, originals):
    """Return what was read of a damaged bag and which parts of the law are broken."""
    outcome = Outcome(lost=len(originals))
    try:
        reader = BagReader(path)
        found = list(reader.messages())
    except BagError as error:
        if "\n" in str(error):
            outcome.broken.append("a refusal of several lines")
        return outcome
    sure = Counter(_row(m) for m in found if not m.doubt)
    rest = Counter(originals) - Counter(_row(m) for m in found)
    losses, left = reader.losses, len(originals) - len(found)
    outcome.read, outcome.doubtful = len(found), len(found) - sure.total()
    outcome.lost, outcome.said, outcome.exact = rest.total(), losses.messages, losses.exact
    outcome.code = inspect_bag(path).exit_code
    laws = {
        "a message that was not written comes without a doubt": not sure - Counter(originals),
        "messages are missing without a word": bool(losses) or not (rest or outcome.doubtful),
        "the number of lost messages is wrong": not losses.exact or losses.messages == left,
        "the number of doubtful messages is wrong": losses.doubtful == outcome.doubtful,
        "a missing message is in no range": _in_ranges(rest, losses),
        "out of order without a word": _sorted(found) or bool(losses.notes),
        "the exit code hides a loss": (outcome.code > 0) == bool(losses) or not losses,
        "reading again differs": [_row(m) for m in reader.messages()] == [_row(m) for m in found],
        "reading one topic differs": _one_topic(path, found),
    }
    outcome.broken = [text for text, holds in laws.items() if not holds]
    outcome.broken += _judge_repair(path, found)
    return outcome


def _judge_repair(path, found):
    output = path.with_suffix(".repaired.mcap")
    if not found:
        return []
    before = path.read_bytes()
    report = repair_bag(path, output, replace=True)
    again = BagReader(output)
    laws = {
        "the repair changed its input": path.read_bytes() == before,
        "the repaired bag is not whole": not again.prove(),
        "the repair counts wrong": report.messages == len(found),
        "the repaired bag differs": Counter(_row(m) for m in again.messages())
        == Counter(_row(m) for m in found if m.type),
        "others read the repaired bag otherwise": Counter(messages_of(output))
        == Counter(_row(m) for m in found),
    }
    return [text for text, holds in laws.items() if not holds]


def _row(message):
    return (message.topic, message.type, message.log_time_ns, message.raw)


def _sorted(found):
    times = [m.log_time_ns for m in found]
    return times == sorted(times)


def _in_ranges(rest, losses):
    if any(loss.start_ns is None for loss in losses.details):
        return True
    return all(
        any(loss.start_ns <= row[2] <= loss.end_ns for loss in losses.details) for row in rest
    )


def _one_topic(path, found):
    """Sure messages of one topic are the same whether all are read or these alone."""
    reader = BagReader(path)
    for topic in {m.topic for m in found}:
        kinds = [t for t in reader.topics() if t.name == topic]
        own = [_row(m) for m in found if m.topic.lstrip("/") == topic.lstrip("/")]
        if len(kinds) == 1 and [_row(m) for m in reader.messages([topic])] != own:
            return False
    return True


def run(count, seed, folder, kinds=KINDS):
    """Yield (kind, seed of the bag, outcome) of some damaged bags."""
    sources = {}
    for k, compression in enumerate(COMPRESSIONS):
        for base in (0, 1):
            path = folder / f"source_{k}_{base}.mcap"
            rows = build(path, 100 * seed + 10 * base + k, compression)
            sources[k, base] = rows, path.read_bytes()
    for i in range(count):
        kind = kinds[i % len(kinds)]
        compression = i // len(kinds) % len(COMPRESSIONS)
        rows, content = sources[compression, 0]
        dice = random.Random(f"{seed} {i}")
        data = bytearray(content)
        kind(data, dice, sources[dice.randrange(len(COMPRESSIONS)), 1][1])
        path = folder / "damaged.mcap"
        path.write_bytes(data)
        yield kind.__name__, i, judge(path, rows)


def _too_long(*_):
    raise TimeoutError(f"longer than {LONGEST_S} s")


def table(outcomes):
    """Return the damage matrix as text."""
    lines = ["damage      bags  messages   read  doubtful   lost  exactly said  exit 0/1/2  broken"]
    rows = defaultdict(list)
    for kind, _, outcome in outcomes:
        rows[kind].append(outcome)
    for kind, some in rows.items():
        codes = Counter(o.code for o in some)
        lines.append(
            f"{kind:10}  {len(some):4d}  {3 * FRAMES * len(some):8d} {sum(o.read for o in some):6d}"
            f"  {sum(o.doubtful for o in some):8d} {sum(o.lost for o in some):6d}"
            f"  {sum(o.exact for o in some):6d} bags  {codes[0]:3d}/{codes[1]:3d}/{codes[2]:3d}"
            f"  {sum(bool(o.broken) for o in some):6d}"
        )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=120, help="how many bags (120)")
    parser.add_argument("--seed", type=int, default=0, help="another seed, other damage (0)")
    parser.add_argument("--keep", type=Path, help="keep bags that break the law in this folder")
    options = parser.parse_args()
    signal.signal(signal.SIGALRM, _too_long)
    outcomes, longest = [], 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        start = time.perf_counter()
        signal.alarm(LONGEST_S)
        for kind, i, outcome in run(options.count, options.seed, folder):
            signal.alarm(LONGEST_S)
            longest, start = max(longest, time.perf_counter() - start), time.perf_counter()
            outcomes.append((kind, i, outcome))
            for text in outcome.broken:
                print(f"bag {i} ({kind}): {text}", flush=True)
            if outcome.broken and options.keep:
                options.keep.mkdir(parents=True, exist_ok=True)
                (folder / "damaged.mcap").replace(options.keep / f"{kind}_{i}.mcap")
    print(table(outcomes))
    broken = sum(bool(outcome.broken) for _, _, outcome in outcomes)
    print(f"{len(outcomes)} bags, {broken} break the law; the longest took {longest:.1f} s")
    return 1 if broken else 0


if __name__ == "__main__":
    raise SystemExit(main())
