# SPDX-License-Identifier: BSD-2-Clause
"""Writes a Faust modal model of a body: what force at one place of a kernel makes the velocity of others.

  ricochet export --faust out/bell-0123456789ab.kernel.h5 --excite 17 --receive mic:x > bell.dsp
  faust2jaqt bell.dsp

A place is a receiver's name, the number of a contact point from 0, or x,y,z [m] in the body's axes, which means the nearest
contact point; then, behind a colon, a direction: x, y, z or three numbers. A contact point has its normal without one.
The model is in docs/interchange.md.
"""

import argparse
import math
import re
import signal
import sys
from pathlib import Path

import numpy as np

from ricochet.cli.command_line import Parser
from ricochet.result_file import BadInput, File, are_finite, expected

AXES = dict(zip("xyz", np.eye(3)))


def numbers(text):
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        return []


def direction_of(text, what):
    direction = np.array(AXES[text] if text in AXES else numbers(text))
    length = np.linalg.norm(direction)
    if direction.shape != (3,) or not 0 < length < np.inf:
        raise BadInput(f"{what}: \"{text}\" is no direction: give x, y, z or three numbers")
    return direction / length


def point_of(place, file, what):
    """Number of a contact point, or None."""
    node = file.array("/surface/node", None, 3)
    if re.fullmatch("[0-9]{1,15}", place):
        if int(place) >= len(node):
            raise BadInput(f"{what}: {file.path} has contact points 0 to {len(node) - 1}")
        return int(place)
    if are_finite(at := numbers(place), 3):
        return int(np.argmin(np.linalg.norm(node - at, axis=1)))
    return None


def shape_at(text, file, modes, what):
    """Modes at a place along a direction (N)."""
    place, _, towards = text.partition(":")
    if place in file.names("/receivers"):
        if not towards:
            raise BadInput(f"{what}: a receiver moves in three directions: name one, as in {place}:x")
        return direction_of(towards, what) @ file.array(f"/receivers/{place}", 3, modes)
    point = point_of(place, file, what)
    if point is None:
        known = ", ".join(file.names("/receivers")) or "none"
        raise BadInput(f"{what}: \"{place}\" is no receiver of {file.path} (it has {known}), no number and no x,y,z")
    normals = file.array("/surface/normal", None, 3)
    direction = direction_of(towards, what) if towards else normals[point]
    stored = file.attribute("/surface/shape", "direction")
    if stored is None:
        return direction @ file.array("/surface/shape", len(normals), 3, modes)[point]
    if towards and abs(abs(direction @ stored) - 1) > 1e-9:
        raise BadInput(f"{what}: {file.path} holds the motion along {stored.tolist()} alone")
    return math.copysign(1, direction @ stored) * file.array("/surface/shape", len(normals), modes)[point]


def model(given):
    with expected(given.kernel, "ricochet-kernel"):
        file = File(given.kernel, "ricochet-kernel")
        omega = file.array("/modes/angular_frequency", None)
        decay = file.array("/modes/decay_rate", len(omega))
        struck = shape_at(given.excite, file, len(omega), "--excite")
        heard = [shape_at(text, file, len(omega), "--receive") for text in given.receive]
        body = file.text("/", "body") or "body"
    if given.t60 is not None:
        decay = np.where(decay > 0, decay, math.log(1000) / given.t60)
    elastic = omega > 0
    if (elastic & (decay == 0)).any():
        raise BadInput(f"{given.kernel}: {(elastic & (decay == 0)).sum()} modes never fade: give the body damping, or --t60 [s]")
    ringing = elastic & (decay < omega)
    frequency = np.sqrt(np.where(ringing, omega**2 - decay**2, 0)) / (2 * np.pi)
    kept = ringing & (frequency < given.rate / 2)
    if not kept.any():
        raise BadInput(f"{given.kernel}: no mode rings below {given.rate / 2:g} Hz, half of --rate")
    notes = [f"{kept.sum()} modes; left out: {(~elastic).sum()} rigid, {(elastic & ~ringing).sum()} that do not ring, "
             f"{(ringing & ~kept).sum()} above {given.rate / 2:g} Hz"]
    return body, frequency[kept], math.log(1000) / decay[kept], [(struck * one)[kept] for one in heard], notes


def plain(text):
    """For a string or a comment of Faust, which would end with a quote or a line."""
    return "".join(letter if letter.isprintable() and letter not in '"\\' else "_" for letter in text)


def text_of(given, body, frequency, t60, gains, notes):
    lines = [f'declare name "{plain(body)}";', 'import("stdfaust.lib");', "",
             plain(f"// {given.excite} struck, {', '.join(given.receive)} heard. {'; '.join(notes)}."),
             f"// Force [N] in, velocity [m/s] out, at sample rates from {given.rate:g} Hz on. Each mode: frequency [Hz], time of decay by",
             "// 60 dB [s], gain [1/kg]. An input of 1 for a sample is an impulse of 1/SR, and pm.modeFilter answers to it with 2 cos",
             "// instead of cos; pm.modalModel, which is the same, takes minutes to compile with hundreds of modes."]
    for k, gain in enumerate(gains):
        modes = (f"  pm.modeFilter({f:.9g}, {t:.9g}, {g:.9g})" for f, t, g in zip(frequency, t60, gain))
        lines += [f"modes{k} = _ <:", ",\n".join(modes), "  :> /(2*ma.SR);"]
    lines += ["body = _ <: " + ", ".join(f"modes{k}" for k in range(len(gains))) + ";",
              "strike = button(\"strike\") : ba.impulsify : *(ma.SR*hslider(\"impulse [unit:N s]\", 1, 0, 10, 0.001));",
              "process = " + ("strike : body;" if given.button else "body;")]
    return "\n".join(lines) + "\n"


def positive(text):
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("must be positive")
    return value


def main():
    parser = Parser(__doc__, "--faust --excite PLACE --receive PLACE KERNEL.h5")
    parser.add_argument("--faust", action="store_true", required=True, help="write a Faust modal model")
    parser.add_argument("kernel", type=Path, metavar="KERNEL.h5")
    parser.add_argument("--excite", required=True, metavar="PLACE", help="where a force acts")
    parser.add_argument("--receive", required=True, action="append", metavar="PLACE", help="whose velocity is heard; repeatable")
    parser.add_argument("--rate", type=positive, default=44100, metavar="HZ", help="lowest sample rate to play at (44100)")
    parser.add_argument("--t60", type=positive, metavar="S", help="decay by 60 dB of modes without damping")
    parser.add_argument("--button", action="store_true", help="a button strikes, instead of a signal of force")
    given = parser.parse_args()
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        print(text_of(given, *model(given)), end="")
    except BadInput as refusal:
        print(f"faust: {refusal}", file=sys.stderr)
        return 2
    return 0
