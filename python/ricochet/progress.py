# SPDX-License-Identifier: BSD-2-Clause
"""A progress bar on standard error, with the remaining time, for terminals and notebooks."""
import sys
import time
from typing import TextIO


def duration(seconds: float) -> str:
    """A duration as text: 45 s, 3 min 20 s, 2 h 5 min."""
    seconds = round(seconds)
    if seconds < 60:
        return f"{seconds} s"
    if seconds < 3600:
        return f"{seconds // 60} min {seconds % 60} s"
    return f"{seconds // 3600} h {seconds % 3600 // 60} min"


class Progress:
    """Counts units of work of similar length. Units that an earlier run finished do not count for the
    remaining time."""

    WIDTH = 30

    def __init__(self, total: int, stream: TextIO | None = None) -> None:
        self.total, self.done, self.worked = total, 0, 0
        self.stream, self.started, self.drawn = stream or sys.stderr, time.monotonic(), 0.0
        self.visible = self.stream.isatty() or type(self.stream).__module__.startswith("ipykernel")

    def advance(self, what: str, pieces: int = 1, already: bool = False) -> None:
        self.done += pieces
        self.worked += 0 if already else pieces
        now = time.monotonic()
        if not self.visible or (now - self.drawn < 0.1 and 0 < self.done < self.total):
            return
        self.drawn = now
        filled = self.WIDTH * self.done // max(self.total, 1)
        left = ""
        if self.worked and self.done < self.total:
            pace = (now - self.started) / self.worked
            left = f", {duration(pace * (self.total - self.done))} left"
        self.stream.write(
            f"\r\033[K[{'#' * filled}{'.' * (self.WIDTH - filled)}] {self.done}/{self.total}{left}  {what}"[
                :140
            ]
        )
        self.stream.write("\n" if self.done >= self.total else "")
        self.stream.flush()
