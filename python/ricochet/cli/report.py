# SPDX-License-Identifier: BSD-2-Clause
"""Writes a result as one web page that opens in any browser, without a network: the impact and the modes of the bodies in
motion, charts, sound, energy, errors, the scene, and the commands that repeat the run.

    ricochet report out/two-disks.result.h5

Writes <slug>.report.html beside the result and prints its path.
"""
import argparse

from ricochet.cli.options import add_out, add_result


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_result(parser)
    add_out(parser, "the page", "beside the result", "PAGE.html")


def run(options: argparse.Namespace) -> None:
    from ricochet import pages  # takes a second, and refusals of a wrong file come before

    print(pages.write_page(options.result, options.out, options.kernels))
