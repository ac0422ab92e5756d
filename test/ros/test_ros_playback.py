"""The schedule of a player, on a clock of its own: order, once each, never early."""

import math
from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geoprim_core.errors import InputError
from geoprim_ros.playback import Playback

MS = 1_000_000


@dataclass(frozen=True)
class Item:
    log_time_ns: int
    number: int


class Tape:
    """A recording in memory, with the last item before a time as its state on demand."""

    def __init__(self, times, start=None, end=None, state=False):
        self.items = [Item(t, i) for i, t in enumerate(times)]
        self.start_ns = min(times, default=0) if start is None else start
        self.end_ns = max(times, default=0) if end is None else end
        self._state = state

    def range(self):
        return [i for i in self.items if self.start_ns <= i.log_time_ns <= self.end_ns]

    def messages(self, since_ns):
        return (i for i in self.items if since_ns <= i.log_time_ns <= self.end_ns)

    def state_before(self, since_ns):
        return [i for i in self.items if i.log_time_ns < since_ns][-1:] if self._state else []


class Clock:
    now = 10**15

    def __call__(self):
        return self.now


def made(tape, **options):
    clock = Clock()
    return Playback(tape, clock=clock, **options), clock


def drain(playback, clock, jitter_ns=0):
    """Play to the end, waking up a little late, and return (bag time of sending, item)."""
    sent = []
    while not playback.finished:
        item = playback.take()
        if item is not None:
            sent.append((playback.position(), item))
        else:
            clock.now += math.ceil(playback.wait_s() * 1e9) + jitter_ns
    return sent


times = st.lists(st.integers(0, 3000 * MS), min_size=1, max_size=25).map(sorted)
actions = st.one_of(
    st.tuples(st.just("wait"), st.integers(0, 1500 * MS)),
    st.tuples(st.just("rate"), st.sampled_from([0.1, 0.5, 1.0, 3.0, 50.0])),
    st.tuples(st.sampled_from(["pause", "resume", "step", "take"]), st.none()),
)
seeks = st.tuples(st.just("seek"), st.integers(-100 * MS, 3100 * MS))


def act(playback, clock, action):
    """Do one thing and return the item it sends, if any."""
    name, value = action
    if name == "wait":
        clock.now += value
    elif name == "rate":
        playback.set_rate(value)
    elif name == "seek":
        playback.seek(value)
    else:
        return getattr(playback, name)()
    return None


@given(times, st.lists(actions, max_size=30), st.booleans())
def test_every_message_comes_once_and_in_order_whatever_is_pressed(times, script, paused):
    tape = Tape(times)
    playback, clock = made(tape, paused=paused)
    sent = [item for a in script if (item := act(playback, clock, a)) is not None]
    playback.resume()
    sent += [item for _, item in drain(playback, clock)]
    assert sent == tape.items
    assert playback.sent == len(sent)


@given(times, st.lists(actions, max_size=15), seeks, st.lists(actions, max_size=15))
def test_after_a_seek_everything_from_there_on_comes(times, before, seek, after):
    tape = Tape(times)
    playback, clock = made(tape)
    for action in before:
        act(playback, clock, action)
    act(playback, clock, seek)
    point = min(max(seek[1], tape.start_ns), tape.end_ns)
    assert playback.position() == point
    sent = [item for a in after if (item := act(playback, clock, a)) is not None]
    playback.resume()
    sent += [item for _, item in drain(playback, clock)]
    assert sent == [item for item in tape.items if item.log_time_ns >= point]


@given(times, st.lists(st.one_of(actions, seeks), max_size=40))
def test_the_time_runs_back_in_seeks_only_and_nothing_is_early(times, script):
    tape = Tape(times, state=True)
    playback, clock = made(tape)
    before, state = playback.position(), []
    for action in script:
        if action[0] == "seek":
            point = min(max(action[1], tape.start_ns), tape.end_ns)
            state, before = list(tape.state_before(point)), point
        else:
            assert playback.position() >= before
            before = playback.position()
        item = act(playback, clock, action)
        if item is not None and state:
            assert item == state.pop(0)  # what held before comes first, paused or not
        elif item is not None and action[0] == "take":
            assert item.log_time_ns == before  # the time waited for it, and was there
        elif item is not None:
            assert item.log_time_ns >= before  # a step goes ahead
        assert playback.position() >= before
        before = playback.position()


@given(times, st.integers(0, 400 * MS), st.sampled_from([0.25, 1.0, 7.0]))
def test_lateness_is_made_up_for_and_does_not_add_up(times, jitter, rate):
    tape = Tape(times)
    playback, clock = made(tape, rate=rate)
    begin = clock.now
    drain(playback, clock, jitter)
    ideal = (tape.end_ns - tape.start_ns) / rate
    assert ideal - 2 <= clock.now - begin <= ideal + jitter + 2 * len(times)


@given(times, st.integers(1, 4))
def test_a_loop_repeats_the_range_in_its_rhythm(times, rounds):
    tape = Tape(times, end=max(times) + 50 * MS, state=True)
    playback, clock = made(tape, loop=True)
    begin, sent = clock.now, []
    while len(sent) < rounds * len(times):
        item = playback.take()
        if item is None:
            clock.now += math.ceil(playback.wait_s() * 1e9)
        else:
            sent.append(item)
    assert sent == tape.items * rounds
    length = max(tape.end_ns - tape.start_ns, 1)
    last = tape.items[-1].log_time_ns - tape.start_ns
    late = clock.now - begin - ((rounds - 1) * length + last)
    assert -2 <= late <= 2 * len(sent) + 2 * rounds
    assert not playback.finished


def test_a_loop_over_one_message_leaves_time_for_others():
    playback, _ = made(Tape([5]), loop=True)
    assert playback.take() is not None
    assert playback.take() is None
    assert playback.wait_s() >= 0.009


@given(times, st.integers(0, 3000 * MS), st.integers(0, 3000 * MS))
def test_the_range_holds_both_its_ends(times, one, other):
    tape = Tape(times, start=min(one, other), end=max(one, other))
    playback, clock = made(tape)
    begin = clock.now
    sent = [item for _, item in drain(playback, clock)]
    assert sent == tape.range()
    if sent:  # the silence before the first message belongs to the range
        silence = sent[-1].log_time_ns - tape.start_ns
        assert silence <= clock.now - begin <= silence + 2 * len(sent)


def test_messages_out_of_order_come_as_they_are_and_the_time_does_not_go_back():
    tape = Tape([100 * MS, 300 * MS, 200 * MS, 400 * MS])
    playback, clock = made(tape)
    sent = drain(playback, clock)
    assert [item for _, item in sent] == tape.items
    assert [position for position, _ in sent] == [100 * MS, 300 * MS, 300 * MS, 400 * MS]


def test_steps_move_the_time_from_message_to_message():
    playback, clock = made(Tape([0, 70 * MS, 90 * MS]), paused=True)
    assert playback.wait_s() == math.inf
    clock.now += 10**12
    assert playback.take() is None and playback.position() == 0
    assert [playback.step().number for _ in range(2)] == [0, 1]
    assert playback.position() == 70 * MS
    playback.resume()
    assert playback.step() is None  # only while paused
    assert playback.take() is None
    clock.now += 20 * MS
    assert playback.take().number == 2
    assert playback.finished


def test_the_end_of_a_paused_recording_waits_for_a_seek():
    playback, _ = made(Tape([0, MS]), paused=True)
    assert [playback.step().number, playback.step().number, playback.step()] == [0, 1, None]
    assert not playback.finished
    playback.seek(0)
    assert playback.step().number == 0


def test_a_pause_gives_no_burst_afterwards():
    """Messages that were late when the pause came keep their distance when it ends."""
    playback, clock = made(Tape([0, 100 * MS, 200 * MS]))
    playback.take()
    clock.now += 10_000 * MS  # something held the program up
    playback.pause()
    assert playback.position() == 100 * MS
    playback.resume()
    assert playback.take().number == 1
    assert playback.take() is None
    assert playback.wait_s() == pytest.approx(0.1)


@pytest.mark.parametrize("rate", [0, -1.0, math.nan, math.inf, True, "2", None])
def test_a_rate_that_is_none_is_refused(rate):
    playback, _ = made(Tape([0]))
    with pytest.raises(InputError, match="rate"):
        playback.set_rate(rate)
    with pytest.raises(InputError, match="rate"):
        made(Tape([0]), rate=rate)
    assert playback.rate == 1.0


def test_an_empty_range_is_finished_at_once():
    playback, _ = made(Tape([]))
    assert playback.finished and playback.take() is None and playback.position() == 0
