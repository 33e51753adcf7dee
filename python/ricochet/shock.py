# SPDX-License-Identifier: BSD-2-Clause
"""What drop testers make of an acceleration: the channel filters of SAE J211-1, and the shock response spectrum."""
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ricochet import _core
from ricochet.arrays import Floats
from ricochet.errors import InputError

#: channel frequency classes of SAE J211-1
CHANNEL_CLASSES: tuple[int, ...] = _core.channel_classes
PER_OCTAVE = 12  # natural frequencies of a spectrum


class ShockResponse(NamedTuple):
    """A shock response spectrum."""

    #: (F) natural frequencies [Hz]
    frequency_hz: Floats
    #: (F) or (F,…) largest absolute acceleration of the oscillators, during and after the shock
    acceleration: Floats


def cfc_filter(acceleration: ArrayLike, rate_hz: float, cfc: float, rest: ArrayLike | None = None) -> Floats:
    """Filters an acceleration by the low-pass of a channel frequency class: a Butterworth filter of second order,
    forwards and backwards, so that it delays nothing (SAE J211-1). Its gain is 1/√2 at 5/3 of the class.

    acceleration: (S) or (S,…) at equal intervals, in any unit.
    rate_hz: samples per second, at least 10 times the class.
    cfc: 60, 180, 600, 1000, or another class.
    rest: the acceleration before the first sample and after the last one; default: the first sample, which suits
        records that begin before the shock. Of a receiver of a run, `acceleration[0]`.

    Returns an array of the same shape. Raises InputError.
    """
    samples, steady = checked(acceleration, rate_hz, rest)
    if not cfc > 0 or rate_hz < 10 * cfc:
        raise InputError(
            f"rate_hz = {rate_hz:g}: CFC {cfc:g} needs at least {10 * cfc:g} samples per second: give a lower class"
        )
    columns = samples.reshape(len(samples), -1)
    filtered = [
        _core.filter_channel(column, rate_hz, cfc, start) for column, start in zip(columns.T, steady.ravel())
    ]
    return np.stack(filtered, axis=1).reshape(samples.shape)


def shock_response_spectrum(
    acceleration: ArrayLike,
    rate_hz: float,
    frequency_hz: ArrayLike | None = None,
    q: float = 10,
    rest: ArrayLike | None = None,
) -> ShockResponse:
    """The shock response spectrum: the largest absolute acceleration, during the shock and afterwards (maximax), of
    damped oscillators on a base that moves with the acceleration. Recursive filters of ISO 18431-4, which are exact for
    straight lines between samples.

    acceleration: (S) or (S,…) at equal intervals, in any unit; each component has its own spectrum.
    rate_hz: samples per second. The spectrum is accurate up to a tenth of it.
    frequency_hz: (F) natural frequencies; default: 12 for each octave from 10 Hz to a tenth of the rate.
    q: quality of the oscillators, 1/2ζ.
    rest: the acceleration before the first sample and after the last one; default: the first sample, which suits
        records that begin before the shock. Of a receiver of a run, `acceleration[0]`.

    Raises InputError.
    """
    samples, steady = checked(acceleration, rate_hz, rest)
    if frequency_hz is None:
        octaves = max(0.0, np.log2(rate_hz / 100))
        frequency_hz = 10 * 2 ** (np.arange(int(PER_OCTAVE * octaves) + 1) / PER_OCTAVE)
    frequency = np.atleast_1d(np.asarray(frequency_hz, dtype=np.float64))
    if not (np.all(frequency > 0) and np.all(frequency <= rate_hz / 2)):
        raise InputError(f"frequency_hz: must be above 0, and at most half of rate_hz = {rate_hz:g}")
    if not q > 0.5:
        raise InputError(f"q = {q:g}: must be above 0.5, the critical damping")
    columns = samples.reshape(len(samples), -1)
    found = [
        _core.shock_response(column, rate_hz, frequency, q, start)
        for column, start in zip(columns.T, steady.ravel())
    ]
    return ShockResponse(frequency, np.stack(found, axis=1).reshape(len(frequency), *samples.shape[1:]))


def checked(acceleration: ArrayLike, rate_hz: float, rest: ArrayLike | None) -> tuple[Floats, Floats]:
    """The samples, and the values around them, one for each component. Raises InputError."""
    samples = np.asarray(acceleration, dtype=np.float64)
    if samples.ndim == 0 or len(samples) == 0 or not np.isfinite(samples).all():
        raise InputError("acceleration: must be an array of at least one sample, and finite")
    if not (np.isfinite(rate_hz) and rate_hz > 0):
        raise InputError(f"rate_hz = {rate_hz:g}: must be above 0")
    steady = np.broadcast_to(
        samples[0] if rest is None else np.asarray(rest, dtype=np.float64), samples.shape[1:]
    )
    return samples, steady
