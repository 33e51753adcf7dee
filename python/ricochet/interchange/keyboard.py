# SPDX-License-Identifier: BSD-2-Clause
"""Keyboards: one bar as many keys. The key n semitones above another is the same bar with all lengths times 2^(−n/12), and
one and the same mallet strikes them all.

A body whose lengths are multiplied by s has its frequencies divided by s, its mass multiplied by s³ and its flexibility divided
by s (docs/theory/bodies.md, Similar bodies); ricochet-recast computes its kernel. Its contact with the mallet, which keeps its
size, is no copy of another key's. To the player, all keys are one body: it has the modes of all bars, and each place is a bar,
which moves its own modes only.
"""
from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ricochet import programs
from ricochet.arrays import Array
from ricochet.interchange.instrument import (
    OWN_POINTS,
    Blow,
    Instrument,
    Place,
    Striking,
    Tip,
    channels_of,
    loudest,
    mallets_of,
    placed,
)
from ricochet.kernel import Kernel
from ricochet.progress import Progress
from ricochet.scene import Scene

A4, A4_HZ = 69, 440.0  # the key of MIDI that is tuned, and its frequency
NAMES = ("C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B")
OCTAVE = 12  # semitones
NOTES = range(128)
HEARD_TO_HZ = 20e3
PITCH_SHARE = (
    0.01  # least power of the partial that gives the pitch, relative to the strongest: 20 dB below it
)
APART = 0.2  # gap between bars, relative to their width


@dataclass(frozen=True)
class Keyboard:
    """The keys of an instrument, one for each place."""

    notes: list[int]  #: number of MIDI of each key, ascending
    scale: list[float]  #: factor on all lengths of the bar
    offset: Array  #: (K,3) by which each bar is moved aside to be seen [m]
    partial_hz: float  #: of the bar of the scene, which gives the pitch

    @property
    def names(self) -> list[str]:
        return [name_of(note) for note in self.notes]


def name_of(note: int) -> str:
    """C4 for 60."""
    return f"{NAMES[note % 12]}{note // 12 - 1}"


def note_of(text: str) -> int:
    """60 for C4 and for 60. Raises ValueError."""
    found = re.fullmatch(r"([A-Ga-g])([#b]?)(-?\d)", text)
    note = int(text) if text.isdecimal() else -1
    if found:
        note = NAMES.index(found[1].upper()) + {"#": 1, "b": -1, "": 0}[found[2]] + 12 * (int(found[3]) + 1)
    if note not in NOTES:
        raise ValueError(
            f"{text}: is no key. Give a name such as C4 or F#5, or a number of MIDI from 0 to 127"
        )
    return note


def notes_of(text: str) -> list[int]:
    """The keys FIRST:LAST. Raises ValueError."""
    first, colon, last = text.partition(":")
    if not colon or note_of(last) < note_of(first):
        raise ValueError(f"{text}: must be the lowest and the highest key, such as C4:B5")
    return list(range(note_of(first), note_of(last) + 1))


def keyboard_of(
    scene: Scene,
    kernels: Mapping[str, Kernel],
    notes: Sequence[int],
    factor: float | None = None,
    body: str | None = None,
) -> tuple[Instrument, Keyboard]:
    """The instrument of a scene with a bar for each key, struck at the place of the scene.

    notes: of the keys, ascending and without gaps.
    factor: on all lengths, for the bar of the first key; default: such that its lowest strong partial has the frequency
        of the note.
    body: which body of the scene is the bar; default: as for instruments.

    Raises InputError, one line, as instrument_of does, and for kernels whose bodies have no size of their own.
    """
    blow = Blow(scene, body)
    striking = Striking(blow, kernels)
    bar = kernels[blow.body]
    velocity = [
        np.array(blow.bodies[name].get("velocity", [0, 0, 0]), float) for name in (blow.mallet, blow.body)
    ]
    flight = velocity[0] - velocity[1]
    channels = channels_of(blow, bar)
    pickups = [pickup for channel in channels for _, pickup in channel]
    system = striking.system({"velocity": flight}, None, pickups)
    tip = Tip(striking, system)
    speed = float(np.linalg.norm(flight)) or 1.0
    flight = flight if flight.any() else tip.out
    own = slice(striking.modes[blow.body].start, striking.modes[blow.body].stop)
    power = striking.power({"velocity": flight}, system)
    names, sound = loudest(channels, system["pickups"][:, own], power)
    partial = pitch_of(bar.frequency, power * (sound**2).sum(axis=0))
    first = factor or partial / frequency_of(notes[0])
    scales = [first * 2 ** (-n / 12) for n in range(len(notes))]

    chosen = [pickups[[name for channel in channels for name, _ in channel].index(name)] for name in names]
    keys, progress = [], Progress(len(notes))
    with tempfile.TemporaryDirectory(prefix="ricochet-keys-") as folder:
        for scale in scales:
            progress.advance("keys")
            keys.append(key_of(blow, tip, kernels, recast(bar, scale, Path(folder)), scale, chosen))
    places = joined([key.place for key in keys], [len(key.kernel.angular_frequency) for key in keys])
    offset = apart([key.kernel for key in keys], blow, tip)
    order = np.argsort(np.concatenate([key.kernel.angular_frequency for key in keys]), kind="stable")
    hammer, time = kernels[blow.mallet], scene.resolved["time"]
    modes = len(order)
    instrument = Instrument(
        body=blow.body,
        channels=names,
        contact_rate_hz=float(time.get("contact_rate_hz") or time["rate_hz"]),
        omega=np.concatenate([key.kernel.angular_frequency for key in keys])[order],
        decay=np.concatenate([key.kernel.decay_rate for key in keys])[order],
        sound=np.hstack([key.sound for key in keys])[:, order],
        mallet_omega=hammer.angular_frequency,
        mallet_decay=hammer.decay_rate,
        mallets=mallets_of(blow.mallet, hammer.mass, float(places[0].area.mean())),
        places=[
            replace(
                place,
                point=place.point + moved,
                rows=place.rows[:, [*order, *range(modes, place.rows.shape[1])]],
            )
            for place, moved in zip(places, offset)
        ],
        speed=speed,
    )
    return instrument, Keyboard(list(notes), scales, offset, partial)


def frequency_of(note: int) -> float:
    """In equal temperament [Hz]."""
    return float(A4_HZ * 2 ** ((note - A4) / 12))


def pitch_of(frequency: Array, power: Array) -> float:
    """The frequency of the lowest partial that is at most 20 dB weaker than the strongest [Hz]."""
    return float(frequency[np.flatnonzero(power >= PITCH_SHARE * power.max())[0]])


def recast(kernel: Kernel, scale: float, folder: Path) -> Kernel:
    """The kernel of the body with all lengths multiplied by `scale`, without modes that nobody hears."""
    words: list[programs.Word] = ["--scale-factor", repr(scale), "--out", folder]
    if kernel.basis == "modes" and kernel.certificate.upto_hz / scale > HEARD_TO_HZ:
        words += ["--up-to-hz", repr(HEARD_TO_HZ)]
    said = programs.call([programs.BIN / "ricochet-recast", kernel.path, *words], capture=True)
    return Kernel(said.rstrip("\n").rpartition(": ")[2])


@dataclass(frozen=True)
class Key:
    kernel: Kernel
    place: Place
    sound: Array  #: (2,N)


def key_of(
    blow: Blow,
    tip: Tip,
    kernels: Mapping[str, Kernel],
    kernel: Kernel,
    scale: float,
    pickups: Sequence[object],
) -> Key:
    """The mallet in front of a bar, at the place of the scene on the bar."""
    striking = Striking(blow, {**kernels, blow.body: kernel})
    origin = np.array(blow.bodies[blow.body].get("translate", [0, 0, 0]), float)
    point, normal = origin + scale * (tip.point - origin), -tip.out
    system = striking.system(tip.keys_in_front(point, normal), 0.0, list(pickups))  # type: ignore[arg-type]
    place = striking.place(system, point, normal, OWN_POINTS)
    return Key(kernel, place, system["pickups"][:, striking.modes[blow.body]])


def joined(places: Sequence[Place], counts: Sequence[int]) -> list[Place]:
    """Places of a body that has the modes of all bars: `counts` modes each, one bar after the other."""
    out, start = [], 0
    for place, count in zip(places, counts):
        rows = np.zeros((len(place.rows), sum(counts) + place.rows.shape[1] - count))
        rows[:, start : start + count] = place.rows[:, :count]
        rows[:, sum(counts) :] = place.rows[:, count:]
        out.append(replace(place, rows=rows))
        start += count
    return out


def apart(kernels: Sequence[Kernel], blow: Blow, tip: Tip) -> Array:
    """(K,3) Offsets that put bars side by side: across the blow, and across the length of a bar if it has one."""
    extents = []
    for kernel in kernels:
        surface = kernel.visualisation_surface
        extents.append(placed(blow, surface.node if surface else kernel.node))
    spread = np.linalg.svd(extents[0] - extents[0].mean(axis=0))[2]
    aside = np.cross(tip.out, spread[0])  # across the longest direction
    aside = aside / np.linalg.norm(aside) if np.linalg.norm(aside) > 0.1 else spread[1]
    aside *= np.sign(aside[np.argmax(np.abs(aside))])  # from left to right, as on a keyboard
    offset, at = [], 0.0
    for nodes in extents:
        low, high = np.min(nodes @ aside), np.max(nodes @ aside)
        offset.append((at - low) * aside)
        at += (1 + APART) * float(high - low)
    return np.array(offset)
