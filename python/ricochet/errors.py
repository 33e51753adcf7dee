# SPDX-License-Identifier: BSD-2-Clause
"""Errors of the package. Each has an exit status for the command and a text of one line."""
import re
import sys


def one_line(text: object) -> str:
    return re.sub(r"[\x00-\x1f\x7f]", " ", str(text))


class RicochetError(Exception):
    """A failure with an exit `status`. Its text is one line, or empty if a program has already reported the
    reason."""

    def __init__(self, text: str = "", status: int = 1) -> None:
        super().__init__(text)
        self.status = status

    def report(self, command: str) -> int:
        """Prints the text as an error of `command` and returns the exit status."""
        if str(self):
            print(f"{command}: {one_line(self)}", file=sys.stderr)
        return self.status


class InputError(RicochetError):
    """A mistake that the user can correct. The text states where it is, what was found and what to do."""

    def __init__(self, text: str) -> None:
        super().__init__(text, 2)


class SolverError(RicochetError):
    """A computation that fails on valid input."""


def failure(status: int, text: str = "") -> RicochetError:
    """The error of a program that ended with a status other than 0."""
    return InputError(text) if status == 2 else SolverError(text, status)
