# SPDX-License-Identifier: BSD-2-Clause
"""Writes a kernel in the format of another program to standard output. --faust writes a modal model for the Faust language.

  ricochet export --faust out/bell-0123456789ab.kernel.h5 --excite 17 --receive mic:x > bell.dsp
  faust2jaqt bell.dsp

The model turns the force at one place into the velocity of others. A place is the name of a receiver, the number of a contact
point, from 0, or x,y,z [m] in the axes of the body for the nearest contact point. It may be followed by a colon and a direction:
x, y, z or three numbers. The default direction at a contact point is its normal. docs/interchange.md describes the model.
"""
import argparse
import signal
from pathlib import Path

from ricochet.cli.options import positive
from ricochet.interchange import faust


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("kernel", type=Path, metavar="KERNEL.h5")
    formats = parser.add_mutually_exclusive_group(required=True)
    formats.add_argument("--faust", action="store_true", help="a Faust modal model")
    parser.add_argument("--excite", required=True, metavar="PLACE", help="where a force acts")
    parser.add_argument(
        "--receive",
        required=True,
        action="append",
        metavar="PLACE",
        help="whose velocity is put out; repeatable",
    )
    parser.add_argument(
        "--rate",
        type=positive,
        default=44100,
        metavar="HZ",
        help="lowest sample rate to play at (default: 44100)",
    )
    parser.add_argument(
        "--t60", type=positive, metavar="S", help="decay time by 60 dB of modes without damping"
    )
    parser.add_argument("--button", action="store_true", help="a button strikes, instead of a force signal")


def run(options: argparse.Namespace) -> None:
    model = faust.model_of(options.kernel, options.excite, options.receive, options.rate, options.t60)
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    print(model.text(options.button), end="")
