# SPDX-License-Identifier: BSD-2-Clause
"""Computes the kernels of the bodies of a scene: runs ricochet-kernel under mpirun with all its options.

    ricochet kernel -n 4 two-disks.toml --set modes.up_to_hz=3000

RICOCHET_LAUNCHER, such as "srun --mpi=pmix -n {ranks}", replaces mpirun. With one rank, mpirun isn't used.
"""
import argparse

from ricochet import programs
from ricochet.cli.options import Parser, add_ranks, options_of

PASSES_ON = True


def add_arguments(parser: Parser) -> None:
    parser.usage = "%(prog)s [OPTIONS] SCENE.toml"
    add_ranks(parser)
    parser.more_help = lambda: options_of("ricochet-kernel")


def run(options: argparse.Namespace) -> None:
    launcher = programs.mpirun(options.ranks) if options.ranks > 1 else []
    programs.replace_this_process([*launcher, programs.kernel_program(), *options.words])
