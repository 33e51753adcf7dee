# SPDX-License-Identifier: BSD-2-Clause
"""Command lines of the scripts: --help under the name that they are called by, --version of the programs."""
import argparse
import os
import re
import sys
from pathlib import Path

from ricochet import programs

MOST_RANKS = 4096
if sys.stderr is None:  # closed: it takes that number, lest a file does
    sys.stderr = open(os.devnull, "w")


class Unprinted(Exception):
    """Standard output can't be written. `run` tells; its text says why."""


def say(text):
    """Prints, at once, in a main that takes other OSErrors for something else."""
    try:
        print(text, flush=True)
    except OSError as error:
        raise Unprinted(error.strerror) from None


def told(problem):
    """What the user did wrong, in one line."""
    return re.sub(r"[\x00-\x1f\x7f]", " ", str(problem))


def ranks(text):
    """Of ricochet-kernel, as a type of options."""
    if not text.isdecimal() or not 1 <= int(text[:9]) <= MOST_RANKS:
        raise argparse.ArgumentTypeError(f"give a number from 1 to {MOST_RANKS}")
    return int(text)


class Version(argparse.Action):
    def __call__(self, parser, *_):
        try:
            print(parser.prog, programs.version())
        except programs.Failed as failure:
            parser.exit(failure.status)
        parser.exit()


class Parser(argparse.ArgumentParser):
    """Whose description is the script's docstring, for options and one file, `argument`."""

    def __init__(self, doc, argument):
        super().__init__(usage=f"%(prog)s [OPTIONS] {argument}", description=doc,
                         formatter_class=argparse.RawDescriptionHelpFormatter)
        self.add_argument("--version", action=Version, nargs=0, help="show the version of Ricochet and exit")

    def format_help(self):
        return super().format_help().replace("usage:", "Usage:", 1)  # as help2man reads it


def run(main):
    """Ends the script with the status that `main` returns, or with 1 and one line where standard output can't be written: main
    itself takes care of all other OSErrors."""
    if sys.stdout:
        sys.stdout.reconfigure(errors="surrogateescape")  # names of files may be any bytes
    try:
        try:
            status = main()
        finally:
            print(end="", flush=True)
    except (OSError, Unprinted) as error:
        why = error.strerror if isinstance(error, OSError) else error
        print(f"{Path(sys.argv[0]).name}: standard output can't be written ({why})", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for what is still to be flushed
        status = 1
    sys.exit(status)
