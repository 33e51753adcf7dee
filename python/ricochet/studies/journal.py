# SPDX-License-Identifier: BSD-2-Clause
"""The journal of a sweep: the answers of all impacts that were run."""
import glob
import json
import math
from pathlib import Path
from typing import Any

from ricochet.studies.records import Records, Row, whole_lines

Part = tuple[int, int]  # the K-th of N


class Journal:
    """A line of JSON for each impact, {"key", "status", "summary" or "error"}, in <stem>.sweep.jsonl.

    A part of a sweep appends to its own <stem>.sweep.K-of-N.jsonl, and every part reads all files. Impacts
    with status 0 are finished. Refused and failed impacts are run again, because the reason may no longer
    exist. Lines that were written are kept, however the sweep ends. Damaged lines are ignored.
    """

    def __init__(self, stem: Path, part: Part | None = None, reads_only: bool = False) -> None:
        stem.parent.mkdir(parents=True, exist_ok=True)
        own = Path(f"{stem}.sweep.{part[0]}-of-{part[1]}.jsonl" if part else f"{stem}.sweep.jsonl")
        self.rows: dict[str, Row] = {}
        # If the journal is only read, another process may be writing it.
        self.records = None if reads_only else Records(own)
        for path in sorted(stem.parent.glob(f"{glob.escape(stem.name)}.sweep*.jsonl")):
            for row in filter(None, map(row_of, whole_lines(path).split(b"\n"))):
                self._keep(row)

    def add(self, key: str, answer: bytes) -> None:
        """Adds an answer, a line of JSON. The answer of a process that died is not written, because it is
        valid for this run only."""
        line = b'{"key": "%s", %s' % (key.encode(), answer[1:])
        row = json.loads(line)
        if "died" not in row and row != self.rows.get(key):
            assert self.records, "the journal was opened to read"
            self.records.append(line)
        self._keep(row)

    def _keep(self, row: Row) -> None:
        if not self.finished(row["key"]):
            self.rows[row["key"]] = row

    def finished(self, key: str) -> bool:
        return key in self.rows and self.rows[key]["status"] == 0

    def sync(self) -> None:
        if self.records:
            self.records.sync()

    def close(self) -> None:
        """Closes the file, which unlocks it for other processes."""
        if self.records:
            self.records.file.close()


def row_of(line: bytes | str) -> Row | None:
    """The row of a line; None if no sweep wrote it or tables cannot contain it."""
    try:
        row: Row = json.loads(line)
        found = outputs(row["summary"]) if row["status"] == 0 else {}
        [float(value) for value in found.values() if value is not None]
        texts = [row["key"], row.get("error", ""), *found]
        whole = (
            type(row["status"]) is int
            and row["status"] in (0, 1, 2)
            and all(map(storable, texts))
            and not any(name in ("", ".") or "/" in name for name in found)
        )
        return row if whole else None
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return None


def storable(text: Any) -> bool:
    """Whether HDF5 can store the text. Raises UnicodeEncodeError for an unpaired surrogate."""
    return isinstance(text, str) and b"\0" not in text.encode()


def outputs(summary: dict[str, Any]) -> dict[str, float]:
    """The numbers of a summary by name: "restitution", "exit_velocity.upper.y", "episodes" (number of
    episodes)."""
    found: dict[str, Any] = {}
    for name, value in summary.items():
        if name in ("episodes", "warnings"):
            found[name] = len(value)
        elif name == "pairs":
            found |= {f"pairs.{k}.{key}": item for k, pair in enumerate(value) for key, item in pair.items()}
        elif isinstance(value, dict):
            for key, item in value.items():
                if isinstance(item, list):
                    found |= {f"{name}.{key}.{axis}": v for axis, v in zip("xyz", item)}
                elif isinstance(item, (int, float)):
                    found[f"{name}.{key}"] = item
        elif value is None or isinstance(value, (int, float)):
            found[name] = math.nan if value is None else value
    return found
