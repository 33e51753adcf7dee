# SPDX-License-Identifier: BSD-2-Clause
"""Time and memory of the stages of a study, as lines of the log of a batch job."""
import contextlib
import re
import resource
import sys
import time
from collections.abc import Iterator

from ricochet.programs import Show

PHASE = re.compile(r" \d+ MiB(  |$)")  # a line of src/console/console.cpp for a part of a program


def is_log() -> bool:
    """Whether standard error is no terminal, as in a batch job."""
    return not sys.stderr.isatty()


def phases() -> Show | None:
    """Writes the lines of a program that state the time and memory of its parts, if there is a log."""

    def show(line: str) -> None:
        if PHASE.search(line.rstrip()):
            print(line, end="", file=sys.stderr, flush=True)

    return show if is_log() else None


def peak_mib(whose: int) -> float:
    return resource.getrusage(whose).ru_maxrss / 1024


@contextlib.contextmanager
def stage(name: str, processes: int) -> Iterator[None]:
    """Writes the wall time of a stage that succeeds, if there is a log, and the memory that suffices for this process
    and `processes` others that it starts, each as large as the largest one."""
    started = time.monotonic()
    yield
    if is_log():
        own, other = peak_mib(resource.RUSAGE_SELF), peak_mib(resource.RUSAGE_CHILDREN)
        seconds = f"{time.monotonic() - started:.2f} s"
        print(
            f"{name:<42} {seconds:>10} {own + processes * other:>8.0f} MiB  in total: {own:.0f}, and {processes} x "
            f"{other:.0f} of the largest program",
            file=sys.stderr,
            flush=True,
        )
