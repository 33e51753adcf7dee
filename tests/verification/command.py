# SPDX-License-Identifier: BSD-2-Clause
"""The command scripts/verify: runs the cases of the validation manual, or another check selected by the first
option."""
import argparse
import importlib
import sys

from ricochet import errors

OTHERS = {
    "--extremes": "extremes_table",
    "--balls": "hertz_balls",
    "--bodies": "random_bodies",
    "--bracket": "explicit_bracket",
    "--estimates": "true_errors",
    "--flips": "flips",
    "--foreign": "foreign_files",
    "--friction": "friction_energy",
    "--random": "random_scenes",
    "--readings": "readings",
    "--rods": "random_rods",
    "--kills": "kills",
    "--meetings": "random_meetings",
    "--peers": "peers_table",
    "--tutorials": "walk",
}


def parser_of(name, module):
    parser = argparse.ArgumentParser(
        prog=name, description=module.__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    module.add_arguments(parser)
    return parser


def main(words):
    flag = words[0] if words and words[0] in OTHERS else None
    module = importlib.import_module(OTHERS[flag] if flag else "manual_cases")
    parser = parser_of(f"verify {flag}" if flag else "verify", module)
    if not flag:
        others = parser.add_argument_group("other checks", "as the first option; each has its own --help")
        for name, other in OTHERS.items():
            summary = importlib.import_module(other).__doc__.split("\n\n")[0].replace("\n", " ")
            others.add_argument(name, action="store_true", help=summary)
    options = parser.parse_args(words[1:] if flag else words)
    misplaced = [name for name in OTHERS if not flag and getattr(options, name[2:])]
    if misplaced:
        parser.error(f"{misplaced[0]} must be the first option")
    try:
        return module.run(options)
    except errors.RicochetError as failure:
        return failure.report("verify")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
