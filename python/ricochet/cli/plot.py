# SPDX-License-Identifier: BSD-2-Clause
"""Draws a result of ricochet-contact: the contact, friction, snapshots of the bodies, and the energy ledger.

    ricochet plot out/two-disks.result.h5

Writes <slug>-contact.png, <slug>-energy.png, if a pair has friction <slug>-friction.png, if the scene requests
snapshots and views <slug>-snapshots.png, and with [output] stress <slug>-stress.png, and prints their paths.

--low-pass HZ draws the forces without vibration from this frequency on: the mean under a Hann window that is
2/HZ long. Give the end of the band, modes.up_to_hz, if a warning reports a ripple above it.

--compare draws the force law of rigid bodies beside the contact force, for the masses and the approach of the impact: hertz, or
hunt-crossley with its restitution. Its stiffness [N/m^1.5] follows from the peak force, or is given, as in hertz=2e9.
"""
import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from ricochet.cli.options import add_low_pass, add_out, add_result
from ricochet.errors import InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_result(parser)
    add_out(parser, "folder of the pictures", "beside the result")
    add_low_pass(parser)
    parser.add_argument(
        "--compare",
        nargs="+",
        default=[],
        metavar="LAW[=K]",
        help="draw the force of hertz or hunt-crossley beside that of the contact",
    )


def draw(
    result: Path,
    folder: Path | None = None,
    kernels: Path | None = None,
    low_pass: float | None = None,
    compare: Sequence[str] = (),
) -> None:
    from ricochet import pictures  # takes a second, and refusals of a wrong file come before
    from ricochet.pictures.comparison import law_of

    try:
        laws = list(map(law_of, compare))
    except ValueError as error:
        raise InputError(f"--compare {error}") from None

    def note(text: str) -> None:
        print(f"ricochet plot: {text}", file=sys.stderr)

    for path in pictures.draw(result, folder, kernels, note, low_pass, laws):
        print(path)


def run(options: argparse.Namespace) -> None:
    draw(options.result, options.out, options.kernels, options.low_pass, options.compare)
