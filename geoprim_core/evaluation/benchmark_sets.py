"""The named sets of rendered images that detectors are compared on, in one table.

A row yields as many images as asked for, with exact truth, the same for the same seed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from geoprim_core._check import AnyArray, describe
from geoprim_core.errors import InputError
from geoprim_core.evaluation.ground_truth import GroundTruth
from geoprim_core.synthetic import (
    ALPHAS,
    ARRANGEMENTS,
    TARGETS,
    Scene,
    circles_image,
    degraded,
    disc_scene,
    thesis_image,
)
from geoprim_core.types import Ellipses

Backgrounds = Mapping[str, AnyArray]
_Scenes = Callable[[int, int, Backgrounds], Iterator[tuple[str, int | None, Scene]]]

_STRICT, _BOTH = (0.95,), (0.8, 0.95)


@dataclass(frozen=True, slots=True, eq=False)
class BenchmarkImage:
    """One image and its truth.

    Attributes
    ----------
    image : (H, W), (H, W, 3) or (H, W, 4)
    truth : GroundTruth
        Its group is the name of the set.
    alpha : int or None
        Number of ellipses that the image was asked to have, in the thesis' sets.
    """

    image: AnyArray
    truth: GroundTruth
    alpha: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class BenchmarkSet:
    """One row of `BENCHMARK_SETS`.

    Attributes
    ----------
    name, family, text : str
        `family` names several sets at once: "thesis", "variants", "discs", "circles", "noise".
    overlaps : floats
        The least overlap ratios that this set is judged at.
    scenes : callable(count, seed, backgrounds)
        Yields name, alpha or None, and scene.
    """

    name: str
    family: str
    text: str
    overlaps: tuple[float, ...]
    scenes: _Scenes

    def images(
        self, count: int, *, seed: int = 0, backgrounds: Backgrounds | None = None
    ) -> Iterator[BenchmarkImage]:
        """Yield the images of the set, `count` of them.

        Parameters
        ----------
        count : int
            The thesis' sets go round the numbers of ellipses: take a multiple of 6.
        seed : int, at least 0
        backgrounds : mapping name -> image, or None
            Photographs for the sets that need some; None: smooth random ground.

        Raises
        ------
        InputError
            The count or the seed is out of range.

        Examples
        --------
        >>> image = next(BENCHMARK_SETS["circles_clean"].images(1, seed=3))
        >>> image.truth.group, image.image.shape
        ('circles_clean', (480, 640))
        """
        if count < 1 or seed < 0:
            got = f"{count}, {seed}"
            raise InputError("count, seed", "a count of 1 and a seed of 0 at least", got)
        for name, alpha, scene in self.scenes(count, seed, backgrounds or {}):
            uncertain = ~scene.required
            yield BenchmarkImage(
                scene.image, GroundTruth(name, scene.ellipses, uncertain, group=self.name), alpha
            )


def select_sets(names: Sequence[str]) -> tuple[BenchmarkSet, ...]:
    """Return the sets of the given names and families, each once; "all" names every one.

    Raises
    ------
    InputError
        A name is unknown; the known ones are listed.

    Examples
    --------
    >>> [s.name for s in select_sets(["noise", "circles_clean"])]
    ['noise', 'circles_clean']
    """
    chosen: dict[str, BenchmarkSet] = {}
    families = {row.family for row in BENCHMARK_SETS.values()}
    for name in names:
        if name not in families | set(BENCHMARK_SETS) | {"all"}:
            known = ", ".join(["all", *sorted(families), *BENCHMARK_SETS])
            raise InputError("sets", f"names of sets or families: {known}", describe(name))
        rows = BENCHMARK_SETS.values()
        chosen.update({r.name: r for r in rows if name in ("all", r.name, r.family)})
    return tuple(chosen.values())


def smooth_ground(seed: int, size: tuple[int, int] = (640, 480)) -> AnyArray:
    """Return a gray image (H, W) uint8 of a few random waves, without any edge.

    Examples
    --------
    >>> smooth_ground(1).shape
    (480, 640)
    """
    random = np.random.default_rng([seed, *size])
    y, x = np.mgrid[: size[1], : size[0]] / max(size)
    values = np.full(x.shape, 128.0)
    for _ in range(4):
        wave = 2 * np.pi * random.uniform(-1.5, 1.5, 2)
        phase, height = random.uniform(0, 2 * np.pi), random.uniform(5, 20)
        values += height * np.sin(wave[0] * x + wave[1] * y + phase)
    return (np.clip(values, 0, 255) + 0.5).astype(np.uint8)


def _thesis(
    kind: str, drawing: str, change: str, count: int, seed: int, _: Backgrounds
) -> Iterator[tuple[str, int | None, Scene]]:
    for k in range(count):
        alpha, number = ALPHAS[k % len(ALPHAS)], seed + k // len(ALPHAS)
        random = np.random.default_rng([seed, k])
        overhang = 60 if change == "out_of_frame" else 0
        turn = float(random.uniform(0.1, np.pi)) if change == "rotated" else 0.0
        scene = thesis_image(
            alpha, number, kind=kind, drawing=drawing, overhang=overhang, turn=turn,
            inks=change == "inks",
        )  # fmt: skip
        if change in _DEGRADED:
            scene = degraded(scene, **_DEGRADED[change], seed=number)
        yield f"{alpha:02d}_{number}", alpha, scene


_DEGRADED: Mapping[str, dict[str, float]] = {
    "noisy": {"noise": 10.0},
    "blurred": {"blur": 1.5},
    "faint": {"contrast": 0.25, "noise": 1.0},
}
_VARIANTS = {
    "noisy": "noise of 10 grey levels",
    "blurred": "blur of 1.5 pixels",
    "faint": "a quarter of the contrast, noise of 1 grey level",
    "rotated": "turned by any angle",
    "out_of_frame": "ellipses up to 60 pixels out of the frame",
    "inks": "lines darker and lines brighter than the ground",
}


def _discs(
    count: int, seed: int, backgrounds: Backgrounds
) -> Iterator[tuple[str, int | None, Scene]]:
    # Where the backgrounds are a multiple of the targets, each round begins with another target.
    step = max(len(backgrounds), 1) if len(backgrounds) % len(TARGETS) == 0 else count
    for k in range(count):
        random = np.random.default_rng([seed, k, 17])
        ground = list(backgrounds)[k % len(backgrounds)] if backgrounds else "smooth"
        image = backgrounds[ground] if backgrounds else smooth_ground(seed + k)
        target = TARGETS[(k + (k // step if backgrounds else 0)) % len(TARGETS)]
        noise, blur, shading = random.uniform((0, 0, 0), (8, 1.2, 0.5))
        scene = disc_scene(image, seed + k, target=target, noise=noise, blur=blur, shading=shading)
        yield f"{target}_{ground}_{seed + k}", None, scene


def _circles(
    noisy: bool, hard: bool, count: int, seed: int, _: Backgrounds
) -> Iterator[tuple[str, int | None, Scene]]:
    for k in range(count):
        random = np.random.default_rng([seed, k, 23])
        arrangement = ARRANGEMENTS[k % len(ARRANGEMENTS)]
        drawing = ("filled", "outlines")[k // len(ARRANGEMENTS) % 2]
        noise = float(random.uniform(5, 30)) if noisy else 0.0
        wanted = int(random.integers(4, 13))
        stroke = float(random.integers(1, 6)) if hard else 2.0
        scene = circles_image(
            wanted, seed + k, drawing=drawing, arrangement=arrangement, noise=noise, stroke=stroke,
            hard=hard,
        )  # fmt: skip
        yield f"{drawing}_{arrangement}_{seed + k}", None, scene


def _noise(count: int, seed: int, _: Backgrounds) -> Iterator[tuple[str, int | None, Scene]]:
    """Yield pure noise: uniform, weak Gaussian, strong Gaussian, smoothed."""
    for k in range(count):
        random = np.random.default_rng([seed, k, 31])
        shape = (480, 640)
        kind = ("uniform", "weak", "strong", "smooth")[k % 4]
        values = random.uniform(0, 255, shape)
        if kind != "uniform":
            values = random.normal(128, 5 if kind == "weak" else 40, shape)
        image = (np.clip(values, 0, 255) + 0.5).astype(np.uint8)
        scene = Scene(image, Ellipses.from_array([]), np.zeros(0), (), np.zeros(0, bool))
        if kind == "smooth":
            scene = degraded(scene, blur=1.5)
        yield f"{kind}_{seed + k}", None, scene


def _rows() -> Iterator[BenchmarkSet]:
    for kind in ("occluded", "overlapping"):
        for drawing in ("filled", "outlines"):
            name = f"{kind}_{drawing}"
            text = f"{kind} ellipses, {drawing}"
            yield BenchmarkSet(name, "thesis", text, _STRICT, partial(_thesis, kind, drawing, ""))
    for kind in ("occluded", "overlapping"):
        for drawing in ("filled", "outlines"):
            for change, what in _VARIANTS.items():
                if change == "inks" and drawing == "filled":
                    continue  # discs have random grey levels anyway
                name = f"{kind}_{drawing}_{change}"
                text = f"{kind} ellipses, {drawing}: {what}"
                scenes = partial(_thesis, kind, drawing, change)
                yield BenchmarkSet(name, "variants", text, _STRICT, scenes)
    text = "calibration targets of 20 to 200 pixels, tilted, on photographs"
    yield BenchmarkSet("discs", "discs", text, _BOTH, _discs)
    text = "circles of 5 to 120 pixels radius: apart, touching, concentric"
    yield BenchmarkSet("circles_clean", "circles", text, _BOTH, partial(_circles, False, False))
    hard = text + "; drawn without grey levels in between, lines of 1 to 5 pixels"
    yield BenchmarkSet("circles_hard", "circles", hard, _BOTH, partial(_circles, False, True))
    text += "; noise of 5 to 30 grey levels"
    yield BenchmarkSet("circles_noisy", "circles", text, _BOTH, partial(_circles, True, False))
    yield BenchmarkSet("noise", "noise", "noise and nothing else", (0.8,), _noise)


BENCHMARK_SETS: Mapping[str, BenchmarkSet] = {row.name: row for row in _rows()}
"""Name -> set, in the order of a report."""
