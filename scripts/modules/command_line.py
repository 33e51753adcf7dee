"""Command lines of the scripts: --help under the name that they are called by, --version of the programs."""
import argparse
import os
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
    except OSError as error:
        print(f"{Path(sys.argv[0]).name}: standard output can't be written ({error.strerror})", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # for what is still to be flushed
        status = 1
    sys.exit(status)
