# SPDX-License-Identifier: BSD-2-Clause
"""Lists the materials that a scene can name, or all about some of them: range of their values, and source.

    ricochet materials
    ricochet materials steel "stainless steel"

A scene names one as material = "steel", and changes values of it as material = { like = "steel", young = 200e9 }. The loss
factor is information only: damping = { loss_factor = 2e-4 } uses it.
"""
import argparse

from ricochet import named_materials


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("names", nargs="*", metavar="NAME", help="a material, with its ranges and sources")


def run(options: argparse.Namespace) -> None:
    texts = [named_materials.details(name) for name in options.names] or [named_materials.table()]
    print("\n\n".join(texts))
