"""What the processing of a bag did."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from geoprim_core.io.losses import Losses


@dataclass(frozen=True)
class BadFrame:
    """A frame that could not be used, and why."""

    sequence: str
    stamp_ns: int
    reason: str


@dataclass
class SequenceReport:
    """Counts of one sequence of frames, told apart by their `frame_id`.

    Attributes
    ----------
    name : str
    frames : int
        Frames processed.
    bad : int
        Frames that could not be used; not among `frames`.
    unsorted : int
        Frames whose objects could not be sorted, as the camera is not known.
    cut_short : int
        Frames of which a bound on the work left something out.
    contours, ellipses : int
        Sums over the frames.
    objects : Counter
        Label -> number of objects.
    seconds : float
        Time in the chain, from image to objects.
    """

    name: str
    frames: int = 0
    bad: int = 0
    unsorted: int = 0
    cut_short: int = 0
    contours: int = 0
    ellipses: int = 0
    objects: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0


@dataclass(frozen=True)
class ProcessReport:
    """What the processing of a bag did.

    Attributes
    ----------
    output : Path
        The result bag.
    sequences : tuple of SequenceReport
        In the order of their first frames.
    bad_frames : tuple of BadFrame
    losses : Losses
        What could not be read of the input.
    overlays : tuple of Path
        The pictures written.
    seconds : float
        Time in all, reading and writing included.
    """

    output: Path
    sequences: tuple[SequenceReport, ...]
    bad_frames: tuple[BadFrame, ...]
    losses: Losses
    overlays: tuple[Path, ...]
    seconds: float

    @property
    def frames(self) -> int:
        """The number of frames processed."""
        return sum(s.frames for s in self.sequences)

    def table(self) -> str:
        """Return the counts of all sequences as a text table, with faults below it."""
        width = max([8, *(len(s.name) for s in self.sequences)])
        lines = [f"{'sequence':{width}}  frames  bad  contours  ellipses  ms/frame  objects"]
        for s in self.sequences:
            objects = ", ".join(f"{label} {n}" for label, n in sorted(s.objects.items()))
            pace = f"{1000 * s.seconds / s.frames:8.1f}" if s.frames else " " * 8
            lines.append(
                f"{s.name:{width}}  {s.frames:6d}  {s.bad:3d}  {s.contours:8d}  {s.ellipses:8d}"
                f"  {pace}  {objects}"
            )
        return "\n".join([*lines, *self._faults()])

    def _faults(self) -> list[str]:
        lines = []
        unsorted = sum(s.unsorted for s in self.sequences)
        if unsorted:
            lines.append(f"{unsorted} frames have no objects: a class is in mm, the camera unknown")
        cut_short = sum(s.cut_short for s in self.sequences)
        if cut_short:
            noun = "frame is" if cut_short == 1 else "frames are"
            lines.append(f"{cut_short} {noun} incomplete: a bound on the work was reached")
        reasons = Counter(bad.reason for bad in self.bad_frames)
        lines += [f"{count} bad frames: {reason}" for reason, count in reasons.most_common()]
        if self.losses:
            lines.append(f"input: {self.losses}")
        return lines
