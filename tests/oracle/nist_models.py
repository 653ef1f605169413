# SPDX-License-Identifier: BSD-3-Clause
"""The models of NIST's 27 nonlinear regression sets as y = A(x, xi2) xi1 + b(x, xi2).

Statistical Reference Datasets, https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml. Parameters
keep NIST's names b1, b2, ...; those in which a model is affine are linear. Chwirut's has none.
"""

import numpy as np

from oracle.model import Array
from oracle.nist_model import Columns, NistModel

ONE = np.ones(1)
ZERO = np.zeros(1)


def _without_offset(columns: Columns, slopes: list[Columns]) -> tuple[Columns, list[Columns]]:
    return [*columns, ZERO], [*slopes, [ZERO] * len(slopes[0])]


def _bennett5(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 (b2 + x)^(-1 / b3)."""
    (x,), (b2, b3) = u, xi2
    power = (b2 + x) ** (-1 / b3)
    return _without_offset([power], [[-power / (b3 * (b2 + x)), power * np.log(b2 + x) / b3**2]])


def _saturation(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 (1 - exp(-b2 x)), BoxBOD and Misra1a."""
    (x,), (b2,) = u, xi2
    return _without_offset([-np.expm1(-b2 * x)], [[x * np.exp(-b2 * x)]])


def _misra1b(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 (1 - (1 + b2 x / 2)^-2)."""
    (x,), (b2,) = u, xi2
    base = 1 + b2 * x / 2
    return _without_offset([1 - base**-2], [[x * base**-3]])


def _misra1c(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 (1 - (1 + 2 b2 x)^-1/2)."""
    (x,), (b2,) = u, xi2
    base = 1 + 2 * b2 * x
    return _without_offset([1 - base**-0.5], [[x * base**-1.5]])


def _misra1d(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 b2 x / (1 + b2 x)."""
    (x,), (b2,) = u, xi2
    base = 1 + b2 * x
    return _without_offset([b2 * x / base], [[x / base**2]])


def _chwirut(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """exp(-b1 x) / (b2 + b3 x), with an empty linear part."""
    (x,), (b1, b2, b3) = u, xi2
    y = np.exp(-b1 * x) / (b2 + b3 * x)
    return [y], [[-x * y, -y / (b2 + b3 * x), -x * y / (b2 + b3 * x)]]


def _danwood(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 x^b2."""
    (x,), (b2,) = u, xi2
    return _without_offset([x**b2], [[x**b2 * np.log(x)]])


def _enso(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """Waves of a year and of the periods b4 and b7, about b1."""
    (x,), (b4, b7) = u, xi2
    columns, slopes = [ONE], [[ZERO, ZERO]]
    for period, own in ((12.0, (0, 0)), (b4, (1, 0)), (b7, (0, 1))):
        phase = 2 * np.pi * x / period
        columns += [np.cos(phase), np.sin(phase)]
        rate = phase / period
        for slope in (np.sin(phase) * rate, -np.cos(phase) * rate):
            slopes.append([share * slope for share in own])
    return _without_offset(columns, slopes)


def _eckerle4(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """(b1 / b2) exp(-((x - b3) / b2)^2 / 2)."""
    (x,), (b2, b3) = u, xi2
    t = (x - b3) / b2
    bell = np.exp(-0.5 * t**2) / b2
    return _without_offset([bell], [[bell * (t**2 - 1) / b2, bell * t / b2]])


def _gauss(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 exp(-b2 x) and two bells, b3 exp(-((x - b4) / b5)^2) and b6 exp(-((x - b7) / b8)^2)."""
    (x,), (b2, b4, b5, b7, b8) = u, xi2
    decay = np.exp(-b2 * x)
    columns, slopes = [decay], [[-x * decay, *[ZERO] * 4]]
    for centre, width, place in ((b4, b5, 1), (b7, b8, 3)):
        t = (x - centre) / width
        bell = np.exp(-(t**2))
        own = [ZERO] * 5
        own[place : place + 2] = [bell * 2 * t / width, bell * 2 * t**2 / width]
        columns.append(bell)
        slopes.append(own)
    return _without_offset(columns, slopes)


def _rational(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """(b1 + b2 x + ...) / (1 + b_k x + ...), numerator and denominator of the degree of xi2."""
    (x,) = u
    powers = [x**i for i in range(xi2.size + 1)]
    base = 1 + sum(b * power for b, power in zip(xi2, powers[1:], strict=True))
    columns = [power / base for power in powers]
    return _without_offset(columns, [[-c * power / base for power in powers[1:]] for c in columns])


def _lanczos(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 exp(-b2 x) + b3 exp(-b4 x) + b5 exp(-b6 x)."""
    (x,) = u
    columns = [np.exp(-b * x) for b in xi2]
    slopes = [[-x * c if i == k else ZERO for i in range(3)] for k, c in enumerate(columns)]
    return _without_offset(columns, slopes)


def _mgh09(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 (x^2 + x b2) / (x^2 + x b3 + b4)."""
    (x,), (b2, b3, b4) = u, xi2
    base = x**2 + x * b3 + b4
    y = (x**2 + x * b2) / base
    return _without_offset([y], [[x / base, -y * x / base, -y / base]])


def _mgh10(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 exp(b2 / (x + b3))."""
    (x,), (b2, b3) = u, xi2
    y = np.exp(b2 / (x + b3))
    return _without_offset([y], [[y / (x + b3), -y * b2 / (x + b3) ** 2]])


def _mgh17(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 + b2 exp(-x b4) + b3 exp(-x b5)."""
    (x,) = u
    first, second = (np.exp(-x * b) for b in xi2)
    return _without_offset(
        [ONE, first, second], [[ZERO, ZERO], [-x * first, ZERO], [ZERO, -x * second]]
    )


def _nelson(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 - b2 x1 exp(-b3 x2), the response being log y."""
    (x1, x2), (b3,) = u, xi2
    decay = x1 * np.exp(-b3 * x2)
    return _without_offset([ONE, -decay], [[ZERO], [x2 * decay]])


def _rat42(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 / (1 + exp(b2 - b3 x))."""
    (x,), (b2, b3) = u, xi2
    growth = np.exp(b2 - b3 * x)
    y = 1 / (1 + growth)
    return _without_offset([y], [[-growth * y**2, x * growth * y**2]])


def _rat43(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 / (1 + exp(b2 - b3 x))^(1 / b4)."""
    (x,), (b2, b3, b4) = u, xi2
    growth = np.exp(b2 - b3 * x)
    y = (1 + growth) ** (-1 / b4)
    slope = y * growth / (1 + growth) / b4
    return _without_offset([y], [[-slope, x * slope, y * np.log1p(growth) / b4**2]])


def _roszman1(u: tuple[Array, ...], xi2: Array) -> tuple[Columns, list[Columns]]:
    """b1 - b2 x - arctan(b3 / (x - b4)) / pi."""
    (x,), (b3, b4) = u, xi2
    square = np.pi * ((x - b4) ** 2 + b3**2)
    return [ONE, -x, -np.arctan(b3 / (x - b4)) / np.pi], [
        [ZERO, ZERO],
        [ZERO, ZERO],
        [-(x - b4) / square, -b3 / square],
    ]


_saturating = NistModel(_saturation, "b1", "b2")
_bells = NistModel(
    _gauss,
    "b1 b3 b6",
    "b2 b4 b5 b7 b8",
    terms=("b3 b4 b5", "b6 b7 b8"),
    signs=("b5", "b8"),
)
_decays = NistModel(_lanczos, "b1 b3 b5", "b2 b4 b6", terms=("b1 b2", "b3 b4", "b5 b6"))
_cubics = NistModel(_rational, "b1 b2 b3 b4", "b5 b6 b7")
_ultrasonic = NistModel(_chwirut, "", "b1 b2 b3")

MODELS = {
    "Bennett5": NistModel(_bennett5, "b1", "b2 b3"),
    "BoxBOD": _saturating,
    "Chwirut1": _ultrasonic,
    "Chwirut2": _ultrasonic,
    "DanWood": NistModel(_danwood, "b1", "b2"),
    "ENSO": NistModel(
        _enso,
        "b1 b2 b3 b5 b6 b8 b9",
        "b4 b7",
        terms=("b4 b5 b6", "b7 b8 b9"),
        signs=("b4 b6", "b7 b9"),
    ),
    "Eckerle4": NistModel(_eckerle4, "b1", "b2 b3", signs=("b1 b2",)),
    "Gauss1": _bells,
    "Gauss2": _bells,
    "Gauss3": _bells,
    "Hahn1": _cubics,
    "Kirby2": NistModel(_rational, "b1 b2 b3", "b4 b5"),
    "Lanczos1": _decays,
    "Lanczos2": _decays,
    "Lanczos3": _decays,
    "MGH09": NistModel(_mgh09, "b1", "b2 b3 b4"),
    "MGH10": NistModel(_mgh10, "b1", "b2 b3"),
    "MGH17": NistModel(_mgh17, "b1 b2 b3", "b4 b5", terms=("b2 b4", "b3 b5")),
    "Misra1a": _saturating,
    "Misra1b": NistModel(_misra1b, "b1", "b2"),
    "Misra1c": NistModel(_misra1c, "b1", "b2"),
    "Misra1d": NistModel(_misra1d, "b1", "b2"),
    "Nelson": NistModel(_nelson, "b1 b2", "b3", "x1 x2"),
    "Rat42": NistModel(_rat42, "b1", "b2 b3"),
    "Rat43": NistModel(_rat43, "b1", "b2 b3 b4"),
    "Roszman1": NistModel(_roszman1, "b1 b2", "b3 b4"),
    "Thurber": _cubics,
}
