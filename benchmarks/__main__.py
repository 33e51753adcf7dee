# SPDX-License-Identifier: BSD-2-Clause
"""Measures speed: times against other solvers, cost and error of settings, and overheads. Each subcommand
measures one of them.

Times depend on the machine and on other work on it. Compare runs of one call, which alternate, by the printed
ratios. Each subcommand has its own --help.
"""
import argparse
import importlib
import sys

from ricochet import errors

SUBCOMMANDS = (
    "modes",
    "basis",
    "settings",
    "contact",
    "friction",
    "sweep",
    "scale",
    "memory",
    "fountain",
    "web",
    "lv2",
    "stress",
)


def main():
    parser = argparse.ArgumentParser(
        prog="bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parsers = parser.add_subparsers(metavar="SUBCOMMAND", required=True)
    for name in SUBCOMMANDS:
        module = importlib.import_module(f"benchmarks.{name}")
        own = parsers.add_parser(
            name,
            help=module.__doc__.split("\n\n")[0].replace("\n", " "),
            description=module.__doc__,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        module.add_arguments(own)
        own.set_defaults(run=module.run, parser=own)
    options = parser.parse_args()
    try:
        options.run(options)
    except errors.RicochetError as failure:
        return failure.report("bench")
    return 0


if __name__ == "__main__":
    sys.exit(main())
