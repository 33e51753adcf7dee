# SPDX-License-Identifier: BSD-2-Clause
"""Time and memory of a program, including all processes that it starts."""
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ricochet.programs import ONE_THREAD, Word

# The largest memory that the system reports of a process includes that of the process from which it was started. A small
# process therefore starts the program and writes the figures of its end: status, wall and processor time [s], memory [KiB].
LAUNCHER = """
import os, sys, time
figures, started = int(sys.argv[1]), time.monotonic()
os.set_inheritable(figures, False)
process = os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ)
_, status, usage = os.wait4(process, 0)
row = os.waitstatus_to_exitcode(status), time.monotonic() - started, usage.ru_utime + usage.ru_stime, usage.ru_maxrss
os.write(figures, " ".join(map(str, row)).encode())
"""


@dataclass
class Done:
    """A program that has ended."""

    status: int
    text: str  # its output
    seconds: float  # wall time
    cpu_seconds: float  # processor time
    peak_mib: float  # memory of the process that used most, at least the 10 MiB of LAUNCHER

    def rank_mib(self) -> int | None:
        """Memory of the rank that used most, from the line with the total [MiB]."""
        found = re.search(r"^total .* (\d+) MiB", self.text, re.MULTILINE)
        return int(found[1]) if found else None


def timed(
    command: Sequence[Word], folder: Path | None = None, variables: dict[str, str] = ONE_THREAD
) -> Done:
    """Runs a program to its end, in a folder and with additional environment variables."""
    reading, writing = os.pipe()
    launcher = [sys.executable, "-I", "-S", "-c", LAUNCHER, str(writing)]
    with tempfile.TemporaryFile("w+", errors="replace") as output, os.fdopen(reading) as figures:
        process = subprocess.Popen(
            [*launcher, *map(str, command)],
            cwd=folder,
            env=os.environ | variables,
            stdout=output,
            stderr=output,
            pass_fds=[writing],
        )
        os.close(writing)
        row = figures.read().split()
        process.wait()
        output.seek(0)
        if not row:
            raise FileNotFoundError(f"{command[0]}: cannot be started")
        status, seconds, cpu_seconds, peak_kib = map(float, row)
        return Done(int(status), output.read(), seconds, cpu_seconds, peak_kib / 1024)
