"""Command lines of the scripts: --help under the name that they are called by, --version of the programs."""
import argparse
import re
import sys
from pathlib import Path

import programs

INSTALLED = Path(sys.argv[0]).name.startswith("ricochet-")


def named(text):
    """`scripts/sweep` as it is called where Ricochet is installed: ricochet-sweep."""
    return re.sub(r"\bscripts/([a-z]+)", r"ricochet-\1", text) if INSTALLED else text


class Version(argparse.Action):
    def __call__(self, parser, *_):
        print(parser.prog, programs.version())
        parser.exit()


class Parser(argparse.ArgumentParser):
    """Whose description is the script's docstring, for options and one file, `argument`."""

    def __init__(self, doc, argument):
        super().__init__(usage=f"%(prog)s [OPTIONS] {argument}", description=doc,
                         formatter_class=argparse.RawDescriptionHelpFormatter)
        self.add_argument("--version", action=Version, nargs=0, help="show the version of Ricochet and exit")

    def format_help(self):
        return named(super().format_help().replace("usage:", "Usage:", 1))  # as help2man reads it
