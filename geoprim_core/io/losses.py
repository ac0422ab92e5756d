"""What could not be read of a bag, in numbers and in a sentence."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import accumulate
from typing import Self

_SHOWN = 3


@dataclass
class Loss:
    """A part of a file that cannot be read, or not with certainty.

    Attributes
    ----------
    offset, bytes : int
        Where the part lies in the file.
    reason : str
    messages : int
        How many messages are known to be lost with it; there may be more.
    kept : int
        How many messages of it are read all the same, marked as doubtful.
    start_ns, end_ns : int or None
        Log times between which its messages lie; None where nothing tells.
    after_ns, before_ns : int or None
        Log times that were read before and behind it, where its own are not known.
    """

    offset: int
    bytes: int
    reason: str
    messages: int = 0
    kept: int = 0
    start_ns: int | None = None
    end_ns: int | None = None
    after_ns: int | None = None
    before_ns: int | None = None

    def span(self, start_ns: int, end_ns: int) -> None:
        """Widen the range of log times."""
        self.start_ns = start_ns if self.start_ns is None else min(self.start_ns, start_ns)
        self.end_ns = end_ns if self.end_ns is None else max(self.end_ns, end_ns)

    def __str__(self) -> str:
        place = f"at byte {self.offset}"
        if self.bytes > 1:
            place = f"at bytes {self.offset} to {self.offset + self.bytes}"
        counts = f", {_messages(self.messages)} lost" if self.messages else ""
        kept = f", {_messages(self.kept)} kept but doubtful" if self.kept else ""
        return f"{self.reason} {place}{self._times()}{counts}{kept}"

    def _times(self) -> str:
        if self.start_ns is not None and self.end_ns is not None:
            return f", {self.start_ns / 1e9:.3f} s to {self.end_ns / 1e9:.3f} s"
        after = "" if self.after_ns is None else f", after {self.after_ns / 1e9:.3f} s"
        return after + ("" if self.before_ns is None else f", before {self.before_ns / 1e9:.3f} s")


def tell_times(losses: Iterable[Loss], read: Iterable[tuple[int, int, int]]) -> None:
    """Give losses without times of their own those that were read around them.

    `read` has offset, first and last log time of every part that was read.
    """
    parts = sorted(read)
    offsets = [offset for offset, _, _ in parts]
    newest = list(accumulate((end for _, _, end in parts), max))
    oldest = list(accumulate((start for _, start, _ in reversed(parts)), min))[::-1]
    for loss in losses:
        if loss.start_ns is None and loss.offset:
            before, behind = bisect_left(offsets, loss.offset), bisect_right(offsets, loss.offset)
            loss.after_ns = newest[before - 1] if before else None
            loss.before_ns = oldest[behind] if behind < len(oldest) else None
            if loss.after_ns and loss.before_ns and loss.before_ns < loss.after_ns:
                loss.before_ns = None


@dataclass(frozen=True)
class Losses:
    """What could not be read of a bag, as far as noticed yet.

    Attributes
    ----------
    parts : int
        Number of parts that are damaged or missing.
    bytes : int
        Their length in the file; 0 for what is missing altogether.
    messages : int
        How many messages are known to be lost; there may be more unless `exact`.
    reasons : tuple of str
        One a part.
    doubtful : int
        How many messages are read though their bytes or their topic cannot be proved right.
    exact : bool
        True where the bag tells how many messages it had, so that `messages` is all of them.
    notes : tuple of str
        What is odd about the bag but costs nothing.
    details : tuple of Loss
        The parts themselves.

    Examples
    --------
    >>> print(Losses.of([Loss(5000, 300, "the file is cut off", kept=2)]))
    300 bytes are damaged or lost, 2 messages are doubtful: the file is cut off at bytes 5000 to \
5300, 2 messages kept but doubtful
    """

    parts: int
    bytes: int
    messages: int
    reasons: tuple[str, ...]
    doubtful: int = 0
    exact: bool = False
    notes: tuple[str, ...] = ()
    details: tuple[Loss, ...] = ()

    @classmethod
    def of(
        cls,
        parts: Iterable[Loss],
        *,
        missing: int | None = None,
        doubtful: int | None = None,
        notes: Iterable[str] = (),
    ) -> Self:
        """Return the sum of some parts; `missing` is the number of lost messages if known."""
        parts = tuple(parts)
        known = sum(p.messages for p in parts) if missing is None else missing
        kept = sum(p.kept for p in parts) if doubtful is None else doubtful
        length, reasons = sum(p.bytes for p in parts), tuple(str(p) for p in parts)
        exact = missing is not None
        return cls(len(parts), length, known, reasons, kept, exact, tuple(notes), parts)

    def __bool__(self) -> bool:
        """Return True when anything is lost or doubtful."""
        return self.parts > 0

    def __str__(self) -> str:
        if not self:
            return "nothing is lost"
        more = self.parts - _SHOWN
        first = "; ".join(self.reasons[:_SHOWN]) + (f"; and {more} more" if more > 0 else "")
        facts = [f"{self.bytes} bytes are damaged or lost", self._count()]
        if self.doubtful:
            verb = "is" if self.doubtful == 1 else "are"
            facts.append(f"{_messages(self.doubtful)} {verb} doubtful")
        return f"{', '.join(fact for fact in facts if fact)}: {first}"

    def _count(self) -> str:
        if self.exact:
            return f"{_messages(self.messages)} of them" if self.messages else "but no message"
        return f"at least {_messages(self.messages)}" if self.messages else ""


def _messages(count: int) -> str:
    return f"{count} message" + ("" if count == 1 else "s")
