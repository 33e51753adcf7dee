# SPDX-License-Identifier: BSD-2-Clause
"""Parts that verbs share: the parser, types of arguments, output."""
import argparse
import contextlib
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

from ricochet import file_kinds, programs
from ricochet.errors import InputError, RicochetError, one_line

MOST_RANKS = 4096
Group = argparse._ActionsContainer  # a parser or a group of its arguments


class Version(argparse.Action):
    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[Any] | None,
        option_string: str | None = None,
    ) -> None:
        try:
            print(parser.prog, programs.version())
        except RicochetError as problem:
            parser.exit(problem.status, f"{parser.prog}: {problem}\n" if str(problem) else None)
        parser.exit()


class Help(argparse.RawDescriptionHelpFormatter):
    """Keeps the lines of descriptions, and leaves room for the indent of verbs, which argparse does not count."""

    def add_argument(self, action: argparse.Action) -> None:
        super().add_argument(action)
        if isinstance(action, argparse._SubParsersAction):
            self._action_max_length += self._indent_increment


class Parser(argparse.ArgumentParser):
    """A parser that keeps the lines of its description and has the option --version. `more_help` is appended
    to its help."""

    def __init__(self, **more: Any) -> None:
        super().__init__(formatter_class=Help, **more)
        self.more_help: Callable[[], str] = str
        self.add_argument("--version", action=Version, nargs=0, help="show the version of Ricochet and exit")

    def format_help(self) -> str:
        return super().format_help() + self.more_help()

    def input(self) -> str:
        """The name of the file that the verb reads, as in its help."""
        named = [str(action.metavar or action.dest) for action in self._actions if not action.option_strings]
        return named[0] if named else "SCENE.toml"

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {one_line(message)}; {self.prog} --help describes the options\n")


def options_of(program: str) -> str:
    """The options in the help of a program."""
    text = programs.call([programs.BIN / program, "--help"], capture=True)
    return f"\noptions of {program}:\n" + text.partition("\nOptions:\n")[2]


# ---- Types of arguments ----


def ranks(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text[:9]) <= MOST_RANKS:
        raise argparse.ArgumentTypeError(f"{text}: give a number from 1 to {MOST_RANKS}")
    return int(text)


def ranks_here(text: str) -> int:
    """Ranks that start at once. Warns if they share the cores of this machine, unless a launcher or a batch
    system places them on others."""
    number, cores = ranks(text), len(os.sched_getaffinity(0))
    if number > cores and not {"RICOCHET_LAUNCHER", "SLURM_JOB_ID", "PBS_JOBID", "LSB_JOBID"} & set(
        os.environ
    ):
        what = f"{cores} cores" if cores > 1 else "one core"
        print(f"warning: {number} ranks share {what}: -n {cores} is faster", file=sys.stderr)
    return number


def count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text[:9]):
        raise argparse.ArgumentTypeError(f"{text}: give a number from 1 on")
    return int(text[:9])


def positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: must be positive")
    return value


# ---- Arguments of several verbs ----


def add_out(parser: Group, what: str, default: str, metavar: str = "DIR") -> None:
    parser.add_argument("--out", type=Path, metavar=metavar, help=f"{what} (default: {default})")


def add_count(parser: Group, option: str, default: int, what: str) -> None:
    parser.add_argument(option, type=count, default=default, metavar="N", help=f"{what} (default: {default})")


def add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    add_set(parser)


def add_set(parser: Group) -> None:
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="override a scene key, in quotes if the value has brackets or blanks; repeatable",
    )


def add_ranks(parser: Group, kind: Callable[[str], int] = ranks_here) -> None:
    parser.add_argument(
        "-n", "--ranks", type=kind, default=2, metavar="N", help="MPI ranks of ricochet-kernel (default: 2)"
    )


def add_study(parser: argparse.ArgumentParser, kind: Callable[[str], int] = ranks_here) -> None:
    parser.add_argument("study", type=Path, metavar="STUDY.toml")
    add_out(parser, "folder of kernels and results", "out/ beside the study")
    add_ranks(parser, kind)


def add_run(parser: argparse.ArgumentParser, content: str) -> None:
    """Adds the arguments of a verb that runs the programs on a scene. `content` names the files that it
    writes."""
    add_scene(parser)
    add_ranks(parser)
    parser.add_argument("--accuracy", metavar="X", help="relative error that the main results may have")
    add_out(parser, f"folder of {content}", "out/ beside the scene")


def words_for_programs(options: argparse.Namespace) -> list[programs.Word]:
    """Converts the options of `add_run` to arguments of ricochet-kernel and ricochet-contact."""
    accuracy = ["--accuracy", options.accuracy] if options.accuracy else []
    return [*programs.with_set(options.set, options.out), *accuracy]


def add_result(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("result", type=file_kinds.result, metavar="RESULT.h5")
    parser.add_argument(
        "--kernels", type=Path, metavar="DIR", help="folder of the kernels (default: beside the result)"
    )


def add_low_pass(parser: Group) -> None:
    text = "draw the forces without vibration from this frequency on"
    parser.add_argument("--low-pass", type=positive, metavar="HZ", help=text)


def add_open(parser: argparse.ArgumentParser) -> None:
    either = parser.add_mutually_exclusive_group()
    either.add_argument(
        "--open",
        action="store_true",
        default=None,
        help="open the page in a browser (default: if the output is a terminal and there is a display)",
    )
    either.add_argument("--no-open", action="store_false", dest="open", help="only write the page")


# ---- Output ----


def open_page(page: Path, wanted: bool | None) -> None:
    """Opens a page in the browser of the desktop and does not wait for it. `wanted` is the option --open: None opens it
    only for someone who sees it. Prints a warning if it is wanted and cannot be opened."""
    display = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    opener = shutil.which("xdg-open")
    if wanted is False or (wanted is None and not (display and opener and sys.stdout.isatty())):
        return
    if not (display and opener):
        missing = "there is no display" if not display else "the Debian package xdg-utils is missing"
        print(f"warning: {page} is not opened: {missing}", file=sys.stderr)
        return
    subprocess.Popen(
        [opener, str(page.resolve())],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,  # otherwise Ctrl-C in the shell would end the browser
    )


class Unprinted(Exception):
    """Standard output cannot be written. The text gives the reason."""


def say(text: object) -> None:
    """Prints at once. A failure raises Unprinted, because an OSError would be attributed to a file being
    written."""
    try:
        print(text, flush=True)
    except OSError as error:
        raise Unprinted(error.strerror) from None


@contextlib.contextmanager
def writing(folder: Path) -> Iterator[None]:
    """Converts an OSError for files in `folder` to an InputError."""
    try:
        yield
    except OSError as problem:
        raise InputError(
            f"{problem.filename or folder}: {problem.strerror or problem}: is the disk full, or the folder "
            "read-only? Choose another --out"
        ) from None
