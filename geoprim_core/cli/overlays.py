"""Pictures of the worst images: truth, hits, misses and false ellipses."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from geoprim_core.cli.benchmark_images import BenchmarkImages, save, write_files
from geoprim_core.evaluation.comparison import Comparison, Measurement
from geoprim_core.evaluation.comparison_tables import worst_images
from geoprim_core.evaluation.score import measure_text
from geoprim_core.plotting import plot_matching


def write_overlays(
    folder: Path, comparison: Comparison, images: BenchmarkImages, count: int
) -> None:
    """Draw the worst images of every detector and set, worst first by name."""
    files: dict[str, Callable[[Path], object]] = {}
    for detector in comparison.detectors:
        own = comparison.of(detector)
        for group in dict.fromkeys(m.truth.group for m in own):
            chosen = [m for m in own if m.truth.group == group]
            overlap = chosen[0].matchings[0][0]
            for k, m in enumerate(worst_images(chosen, overlap, count)):
                files[_file_name(m, k)] = _writer(m, images, overlap)
    write_files(folder, files)


def _file_name(m: Measurement, rank: int) -> str:
    words = (m.detector, m.truth.group or "images", f"{rank + 1:02d}", Path(m.truth.name).stem)
    return "_".join(words).replace("/", "_").replace(" ", "_") + ".png"


def _writer(m: Measurement, images: BenchmarkImages, overlap: float) -> Callable[[Path], object]:
    def write(path: Path) -> None:
        axes = plot_matching(images.image_of(m.truth), m.run.ellipses, m.truth, m.matching(overlap))
        score = m.score(overlap).score
        value = ("recall " if m.truth.recall_only else "F ") + measure_text(score.merit)
        axes.set_title(f"{m.truth.name}: {m.detector}, {value} at {overlap:g}", fontsize=9)
        save(axes.figure, path)

    return write
