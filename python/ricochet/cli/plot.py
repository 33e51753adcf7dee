# SPDX-License-Identifier: BSD-2-Clause
"""Draws a result of ricochet-contact: the contact, friction, snapshots of the bodies, and the energy ledger.

    ricochet plot out/two-disks.result.h5

Writes <slug>-contact.png, <slug>-energy.png, if a pair has friction <slug>-friction.png and, if the scene
requests snapshots and views, <slug>-snapshots.png, and prints their paths.

--low-pass HZ draws the forces without vibration from this frequency on: the mean under a Hann window that is
2/HZ long. Give the end of the band, modes.up_to_hz, if a warning reports a ripple above it.
"""
import argparse
import sys
from pathlib import Path

from ricochet.cli.options import add_low_pass, add_out, add_result


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_result(parser)
    add_out(parser, "folder of the pictures", "beside the result")
    add_low_pass(parser)


def draw(
    result: Path,
    folder: Path | None = None,
    kernels: Path | None = None,
    low_pass: float | None = None,
) -> None:
    from ricochet import pictures  # takes a second, and refusals of a wrong file come before

    def note(text: str) -> None:
        print(f"ricochet plot: {text}", file=sys.stderr)

    for path in pictures.draw(result, folder, kernels, note, low_pass):
        print(path)


def run(options: argparse.Namespace) -> None:
    draw(options.result, options.out, options.kernels, options.low_pass)
