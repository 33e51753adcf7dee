# SPDX-License-Identifier: BSD-2-Clause
"""Computes the impact of a scene from the kernels of its bodies: runs ricochet-contact with all its options."""
import argparse

from ricochet import programs
from ricochet.cli.options import Parser, options_of

PASSES_ON = True


def add_arguments(parser: Parser) -> None:
    parser.usage = "%(prog)s [OPTIONS] SCENE.toml"
    parser.more_help = lambda: options_of("ricochet-contact")


def run(options: argparse.Namespace) -> None:
    programs.replace_this_process([programs.BIN / "ricochet-contact", *options.words])
