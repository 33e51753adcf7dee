# SPDX-License-Identifier: BSD-2-Clause
"""Time and memory of a program, including all processes that it starts."""
import os
import re
import subprocess
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ricochet.programs import ONE_THREAD, Word


@dataclass
class Done:
    """A program that has ended."""

    status: int
    text: str  # its output
    seconds: float  # wall time
    cpu_seconds: float  # processor time
    peak_mib: float  # memory of the process that used most

    def rank_mib(self) -> int | None:
        """Memory of the rank that used most, from the line with the total [MiB]."""
        found = re.search(r"^total .* (\d+) MiB", self.text, re.MULTILINE)
        return int(found[1]) if found else None


def timed(
    command: Sequence[Word], folder: Path | None = None, variables: dict[str, str] = ONE_THREAD
) -> Done:
    """Runs a program to its end, in a folder and with additional environment variables."""
    with tempfile.TemporaryFile("w+", errors="replace") as output:
        started = time.monotonic()
        process = subprocess.Popen(
            list(map(str, command)), cwd=folder, env=os.environ | variables, stdout=output, stderr=output
        )
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - started
        process.returncode = os.waitstatus_to_exitcode(status)  # otherwise Popen would wait for it again
        output.seek(0)
        cpu_seconds, peak_mib = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
        return Done(process.returncode, output.read(), seconds, cpu_seconds, peak_mib)
