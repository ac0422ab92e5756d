"""What thesis section 2.7 prints in its tables, to set a rerun beside it."""

from __future__ import annotations

from collections.abc import Iterator

METHODS = ("PRO(1.0)", "RDP(mod)", "Masood(mod)", "Carmona(mod)")

# N, MD, ISE of PRO(1.0), RDP(mod), Masood(mod), Carmona(mod) at 1/2 .. 1/5: Tables 2.7-1 .. 2.7-4.
_SCALED = {
    "tinopener": (
        ((17, 1.41, 43.16), (16, 1.67, 22.23), (12, 1.72, 16.60), (13, 1.80, 17.10)),
        ((17, 1.41, 43.16), (17, 1.06, 16.76), (13, 1.46, 17.15), (11, 1.41, 24.22)),
        ((18, 1.09, 28.10), (16, 0.98, 16.92), (14, 0.95, 11.56), (13, 1.00, 12.22)),
        ((16, 2.19, 62.50), (16, 1.37, 26.79), (12, 1.46, 19.67), (11, 1.79, 27.16)),
    ),
    "africa": (
        ((16, 1.74, 42.28), (11, 2.09, 47.29), (10, 1.99, 26.84), (8, 1.54, 13.87)),
        ((17, 1.34, 30.85), (15, 1.18, 17.00), (12, 1.41, 17.13), (9, 1.17, 8.08)),
        ((17, 0.99, 27.31), (15, 1.18, 15.40), (14, 0.81, 8.86), (9, 0.89, 8.00)),
        ((17, 1.74, 44.19), (14, 1.66, 25.27), (12, 1.70, 21.55), (8, 1.54, 14.70)),
    ),
}
# The same of the noisy curves: Table 2.7-5.
_NOISY = {
    "tinopener": ((26, 2.11, 172.22), (31, 1.40, 98.20), (50, 1.20, 60.29), (29, 3.41, 237.69)),
    "africa": ((26, 1.98, 151.84), (37, 1.36, 93.35), (57, 0.99, 65.33), (28, 2.04, 166.37)),
}
FORMULA = {
    "curves 1 to 3, real": ((96, 1.93, 234.65), (70, 1.40, 355.59), (77, 0.88, 212.82),
                            (76, 4.04, 1754.49)),
    "sinc": ((13, 1.64, 60.14), (15, 1.52, 34.21), (14, 1.08, 19.55), (8, 3.38, 160.59)),
}  # fmt: skip
"""N, MD, ISE of the four methods in Tables 2.7-7 (all three curves together) and 2.7-8."""

PARAMETERS = {
    "curve_1": (100, 9, 9, 14, 11, "0", 90, 20),
    "curve_2": (100, 7, 9, 3, 11, "pi", 30, 60),
    "curve_3": (100, 6, 1, 1, 6, "pi/3", -80, 10),
}
"""a, m, n1, n2, n3, theta_0, x_0, y_0: Table 2.7-6."""

RECOMMENDED = {
    "the finest details": ("PRO(0.2)", "PRO(0.4)"),
    "local fit, small changes of curvature": ("PRO(0.4)", "PRO(0.6)", "Masood(mod)"),
    "general purposes": ("RDP(mod)", "Carmona(mod)", "PRO(0.8)", "PRO(1.0)"),
}
"""What 2.7.5 recommends, PRO at the tolerances of Table 2.3-1 in the ranges named."""

DATA_SETS = {
    "PRO(1.0)": (0.41, 0.34, 8.33, 2.39, 139.77, 0.09),
    "RDP(1.0)": (0.26, 0.23, 6.25, 1.00, 57.23, 0.17),
    "RDP(mod)": (0.46, 0.38, 9.17, 1.37, 163.41, 0.13),
    "Masood(0.9)": (1.16, 1.18, 5.88, 2.52, 70.69, 0.15),
    "Masood(mod)": (0.52, 0.71, 7.92, 1.31, 149.37, 0.15),
    "Carmona(0.45)": (1.34, 1.35, 4.76, 3.35, 1084.16, 0.04),
    "Carmona(mod)": (0.60, 0.51, 8.18, 1.42, 197.41, 0.12),
}
"""Precision, reliability, CR, MD, ISE, FOM: the means over ten data sets in Table 2.7-9."""


def printed_rows() -> Iterator[dict[str, str]]:
    """Yield the printed rows of Tables 2.7-1 to 2.7-5 in the form of published rows.

    Columns beyond those of `read_published_rows`: table, divisor, noise (1: a noisy curve).

    Examples
    --------
    >>> next(printed_rows())["table"]
    '2.7-1'
    """
    for shape, groups in _SCALED.items():
        for k, group in enumerate(groups):
            for divisor, values in enumerate(group, 2):
                yield _row(shape, k, values, f"2.7-{k + 1}", divisor=divisor)
    for shape, rows in _NOISY.items():
        for k, values in enumerate(rows):
            yield _row(shape, k, values, "2.7-5", noise=1)


def _row(
    shape: str, k: int, values: tuple[float, ...], table: str, divisor: int = 1, noise: int = 0
) -> dict[str, str]:
    method, param = METHODS[k].rstrip(")").split("(")
    n, deviation, ise = map(str, values)
    found = {"shape": shape, "method": method, "param": param, "N": n, "MD": deviation, "ISE": ise}
    return found | {"table": table, "divisor": str(divisor), "noise": str(noise)}
