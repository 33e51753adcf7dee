# SPDX-License-Identifier: BSD-2-Clause
"""Modal models of a body for Faust: from the force at one place of a kernel to the velocities of others
(docs/interchange.md)."""
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ricochet.errors import InputError
from ricochet.arrays import Array
from ricochet.result_file import File, are_finite, expected

AXES = dict(zip("xyz", np.eye(3)))


def numbers(text: str) -> list[float]:
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        return []


def direction_of(text: str, what: str) -> Array:
    direction = np.array(AXES[text] if text in AXES else numbers(text))
    length = np.linalg.norm(direction)
    if direction.shape != (3,) or not 0 < length < np.inf:
        raise InputError(f'{what}: "{text}" is not a direction: give x, y, z or three numbers')
    return direction / length


def point_of(place: str, file: File, what: str) -> int | None:
    """The number of the contact point that `place` names; None if it names none."""
    node = file.array("/surface/node", None, 3)
    if re.fullmatch("[0-9]{1,15}", place):
        if int(place) >= len(node):
            raise InputError(f"{what}: {file.path} has contact points 0 to {len(node) - 1}")
        return int(place)
    if are_finite(at := numbers(place), 3):
        return int(np.argmin(np.linalg.norm(node - at, axis=1)))
    return None


def shape_at(text: str, file: File, modes: int, what: str) -> Array:
    """(N) mode shapes at `text`, which has the form PLACE:DIRECTION. `what` is the name of the option in
    messages."""
    place, _, towards = text.partition(":")
    if place in file.names("/receivers"):
        if not towards:
            raise InputError(f"{what}: a receiver moves in three directions: add one, as in {place}:x")
        return direction_of(towards, what) @ file.array(f"/receivers/{place}", 3, modes)
    point = point_of(place, file, what)
    if point is None:
        known = ", ".join(file.names("/receivers")) or "none"
        raise InputError(
            f'{what}: "{place}" is not a receiver of {file.path} (it has {known}), a number or x,y,z'
        )
    normals = file.array("/surface/normal", None, 3)
    direction = direction_of(towards, what) if towards else normals[point]
    stored = file.attribute("/surface/shape", "direction")
    if stored is None:
        return direction @ file.array("/surface/shape", len(normals), 3, modes)[point]
    if towards and abs(abs(direction @ stored) - 1) > 1e-9:
        raise InputError(f"{what}: {file.path} has only the motion along {stored.tolist()}")
    return math.copysign(1, direction @ stored) * file.array("/surface/shape", len(normals), modes)[point]


@dataclass
class Model:
    """The modes that ring below half of the sample rate."""

    body: str
    excite: str
    receive: list[str]
    rate_hz: float
    frequency_hz: Array
    t60_s: Array  # decay by 60 dB
    gains: list[Array]  # [1/kg], for each receiver
    note: str

    def text(self, button: bool) -> str:
        """The Faust program. With `button`, its input is a button that strikes, in place of a force."""
        lines = [
            f'declare name "{plain(self.body)}";',
            'import("stdfaust.lib");',
            "",
            plain(f"// Force at {self.excite}, velocity of {', '.join(self.receive)}. {self.note}."),
            f"// Force [N] in, velocity [m/s] out, at sample rates from {self.rate_hz:g} Hz on. Each mode: frequency [Hz],",
            "// time of decay by 60 dB [s], gain [1/kg]. An input of 1 for one sample is an impulse of 1/SR, to which",
            "// pm.modeFilter responds with 2 cos instead of cos. pm.modalModel is equivalent, but takes minutes to compile",
            "// with hundreds of modes.",
        ]
        for k, gain in enumerate(self.gains):
            modes = zip(self.frequency_hz, self.t60_s, gain)
            filters = (f"  pm.modeFilter({f:.9g}, {t:.9g}, {g:.9g})" for f, t, g in modes)
            lines += [f"modes{k} = _ <:", ",\n".join(filters), "  :> /(2*ma.SR);"]
        lines += [
            "body = _ <: " + ", ".join(f"modes{k}" for k in range(len(self.gains))) + ";",
            'strike = button("strike") : ba.impulsify : '
            '*(ma.SR*hslider("impulse [unit:N s]", 1, 0, 10, 0.001));',
            "process = " + ("strike : body;" if button else "body;"),
        ]
        return "\n".join(lines) + "\n"


def model_of(
    kernel: Path, excite: str, receive: list[str], rate_hz: float, t60_s: float | None = None
) -> Model:
    """The model of a kernel file. `t60_s` is the decay time of undamped modes. Raises InputError."""
    with expected(kernel, "ricochet-kernel"):
        file = File(kernel, "ricochet-kernel")
        omega = file.array("/modes/angular_frequency", None)
        decay = file.array("/modes/decay_rate", len(omega))
        struck = shape_at(excite, file, len(omega), "--excite")
        heard = [shape_at(place, file, len(omega), "--receive") for place in receive]
        body = file.text("/", "body") or "body"
    if t60_s is not None:
        decay = np.where(decay > 0, decay, math.log(1000) / t60_s)
    elastic = omega > 0
    if undamped := (elastic & (decay == 0)).sum():
        raise InputError(f"{kernel}: {undamped} modes never fade: give the body damping, or --t60 [s]")
    ringing = elastic & (decay < omega)
    frequency = np.sqrt(np.where(ringing, omega**2 - decay**2, 0)) / (2 * np.pi)
    kept = ringing & (frequency < rate_hz / 2)
    if not kept.any():
        raise InputError(f"{kernel}: no mode rings below {rate_hz / 2:g} Hz, half of --rate")
    note = (
        f"{kept.sum()} modes; left out: {(~elastic).sum()} rigid, {(elastic & ~ringing).sum()} that do not ring, "
        f"{(ringing & ~kept).sum()} above {rate_hz / 2:g} Hz"
    )
    gains = [(struck * one)[kept] for one in heard]
    t60 = math.log(1000) / decay[kept]
    return Model(body, excite, receive, rate_hz, frequency[kept], t60, gains, note)


def plain(text: str) -> str:
    """Replaces characters that would end a string or a comment of Faust."""
    return "".join(letter if letter.isprintable() and letter not in '"\\' else "_" for letter in text)
