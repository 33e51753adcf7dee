# SPDX-License-Identifier: BSD-2-Clause
"""Records of finished runs: files with one line of JSON each. They remain valid if the process is killed at
any moment."""
import fcntl
import json
import os
from pathlib import Path
from typing import Any

from ricochet.errors import InputError

Row = dict[str, Any]


def whole_lines(path: Path) -> bytes:
    """The content up to the last line end. A process that was killed may have written an incomplete line
    after it."""
    content = path.read_bytes()
    return content[: content.rfind(b"\n") + 1]


class Records:
    """A file to which only this process appends. An incomplete last line is removed."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self.path = path
        self.file = open(path, "ab")
        self._lock()
        self.file.truncate(len(whole_lines(path)))

    def _lock(self) -> None:
        """Locks the file until this process ends. A file system without locks cannot report another
        writer."""
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(
                f"{self.path}: another sweep is writing it: wait until it has ended, or give another --out"
            ) from None
        except OSError:
            pass

    def append(self, line: bytes) -> None:
        self.file.write(line + b"\n")
        self.file.flush()

    def sync(self) -> None:
        os.fsync(self.file.fileno())


class Store:
    """Rows by their "key". Each is on the disk before it counts as finished."""

    def __init__(self, path: Path) -> None:
        self.records = Records(path)
        self.rows: dict[str, Row] = {
            row["key"]: row for row in map(json.loads, whole_lines(path).splitlines())
        }

    def add(self, row: Row) -> Row:
        self.rows[row["key"]] = row
        self.records.append(json.dumps(row).encode())
        self.records.sync()
        return row
