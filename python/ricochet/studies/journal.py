# SPDX-License-Identifier: BSD-2-Clause
"""The journal of a sweep: the answers of all impacts that were run."""
import glob
import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ricochet.studies import figures
from ricochet.studies.histories import Archive, Kept
from ricochet.studies.records import Records, Row, whole_lines

Part = tuple[int, int]  # the K-th of N
ARCHIVE = ".histories"
# Errors of the folder of results, of kernels in it and of memory: they may be gone in the next run.
PASSING = re.compile(r"--out|\.kernel\.h5|bad_alloc")


class Journal:
    """A line of JSON for each impact, {"key", "status", "summary" or "error"}, in <stem>.sweep.jsonl. Lines of
    impacts whose records are in <stem>.sweep.histories have "kept", their place.

    A part of a sweep appends to its own <stem>.sweep.K-of-N.jsonl, and every part reads all files. Impacts
    with status 0 are finished if all records of `keep` are there. Refused and failed impacts are not run
    again unless `retry` is set: their keys change with whatever they depend on. An error of the folder of
    results is valid for this run only, like the answer of a process that died. Lines that were written are
    kept, however the sweep ends. Damaged lines are ignored.
    """

    def __init__(
        self,
        stem: Path,
        part: Part | None = None,
        reads_only: bool = False,
        keep: Sequence[str] = (),
        retry: bool = False,
    ) -> None:
        stem.parent.mkdir(parents=True, exist_ok=True)
        own = Path(f"{stem}.sweep.{part[0]}-of-{part[1]}.jsonl" if part else f"{stem}.sweep.jsonl")
        self.keep, self.retry = keep, retry
        self.rows: dict[str, Row] = {}
        self.kept: dict[str, tuple[Kept, Archive]] = {}
        # If the journal is only read, another process may be writing it.
        self.records = None if reads_only else Records(own)
        self.archive = Archive(own.with_suffix(ARCHIVE))
        for path in sorted(stem.parent.glob(f"{glob.escape(stem.name)}.sweep*.jsonl")):
            self._read(path)

    def _read(self, path: Path) -> None:
        rows = list(filter(None, map(row_of, whole_lines(path).split(b"\n"))))
        places = [Kept.of(row.pop("kept", None)) for row in rows]
        archive = Archive(path.with_suffix(ARCHIVE))
        there = archive.holding({row["key"]: place for row, place in zip(rows, places) if place})
        for row, place in zip(rows, places):
            self._keep(row, (place, archive) if place and row["key"] in there else None)

    def add(self, key: str, answer: bytes, image: bytes = b"") -> None:
        """Adds an answer, a line of JSON, and the file of its records."""
        place = self.archive.append(key, self.keep, image) if image else None
        kept = b' "kept": %s,' % json.dumps(place._asdict()).encode() if place else b""
        line = b'{"key": "%s",%s %s' % (key.encode(), kept, answer[1:])
        row = json.loads(line)
        row.pop("kept", None)
        if not self.is_passing(row) and (place or row != self.rows.get(key)):
            assert self.records, "the journal was opened to read"
            self.records.append(line)
        self._keep(row, (place, self.archive) if place else None)

    def _keep(self, row: Row, place: tuple[Kept, Archive] | None) -> None:
        key = row["key"]
        if not self.finished(key):
            self.rows[key] = row
            if place:
                self.kept[key] = place

    @staticmethod
    def is_passing(row: Row) -> bool:
        """Whether the next run may end differently, although nothing in the study changes."""
        return "died" in row or PASSING.search(row.get("error", "")) is not None

    def finished(self, key: str) -> bool:
        found = key in self.rows and self.rows[key]["status"] == 0
        return found and set(self.keep) <= set(self.kept[key][0].words if key in self.kept else ())

    def refused(self, key: str) -> bool:
        """Whether the impact was refused or has failed, and is not to be run again."""
        return key in self.rows and self.rows[key]["status"] != 0 and not self.retry

    def sync(self) -> None:
        """Puts the lines on the disk, after the records that they name."""
        if self.records:
            self.archive.sync()
            self.records.sync()

    def close(self) -> None:
        """Closes the files, which unlocks them for other processes."""
        self.archive.close()
        if self.records:
            self.records.file.close()


def row_of(line: bytes | str) -> Row | None:
    """The row of a line; None if no sweep wrote it or tables cannot contain it."""
    try:
        row: Row = json.loads(line)
        found = outputs(row["summary"]) if row["status"] == 0 else {}
        [float(value) for value in found.values() if value is not None]
        texts = [row["key"], row.get("error", ""), *found, *warnings_of(row)]
        whole = (
            type(row["status"]) is int
            and row["status"] in (0, 1, 2)
            and all(map(storable, texts))
            and not any(name in ("", ".") or "/" in name for name in found)
        )
        return row if whole else None
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError):
        return None


def warnings_of(row: Row | None) -> list[str]:
    """The texts of the warnings of an impact."""
    return list(row["summary"].get("warnings", ())) if row and row["status"] == 0 else []


def storable(text: Any) -> bool:
    """Whether HDF5 can store the text. Raises UnicodeEncodeError for an unpaired surrogate."""
    return isinstance(text, str) and b"\0" not in text.encode()


def outputs(summary: dict[str, Any]) -> dict[str, float]:
    """The numbers of a summary by name: "restitution", "exit_velocity.upper.y", "acceleration.mic.cfc_1000" (the
    filtered peak), "stress.case.von_mises_pa", "gauges.foil.strain_peak", "episodes" (number of episodes),
    "finite_rotation" and "touched" (1 or 0).
    """
    found: dict[str, Any] = {}
    for name, value in summary.items():
        if name in ("episodes", "warnings"):
            found[name] = len(value)
        elif name == "rotation":  # a run may have decided it
            found["finite_rotation"] = int(value == "finite")
        elif name == "acceleration":
            for receiver, peaks in value.items():
                filtered = {f"cfc_{of}": peak for of, peak in peaks["cfc_peak_m_per_s2"].items()}
                for key, item in (
                    {"peak": peaks["peak_m_per_s2"], "time_s": peaks["time_s"]} | filtered
                ).items():
                    found[f"{name}.{receiver}.{key}"] = math.nan if item is None else item
        elif name == "error_estimate" and value:
            for quantity, shares in value.get("quantities", {}).items():
                found[f"{name}.quantities.{quantity}.total"] = shares["total"]
            found |= {f"{name}.{key}": item for key, item in value.items() if isinstance(item, (int, float))}
        elif name in ("stress", "gauges"):
            for part, peaks in value.items():
                for key in figures.LABELS[name]:
                    found[f"{name}.{part}.{key}"] = math.nan if peaks[key] is None else peaks[key]
        elif name == "pairs":
            found |= {f"pairs.{k}.{key}": item for k, pair in enumerate(value) for key, item in pair.items()}
        elif isinstance(value, dict):
            for key, item in value.items():
                if isinstance(item, list):
                    found |= {f"{name}.{key}.{axis}": v for axis, v in zip("xyz", item)}
                elif isinstance(item, (int, float)):
                    found[f"{name}.{key}"] = item
        elif value is None or isinstance(value, (int, float)) and not isinstance(value, bool):
            found[name] = math.nan if value is None else value
    if (steps := found.get("contact_steps")) is not None:
        found["touched"] = int(steps > 0)
    elif "pairs" in summary:  # at rest
        found["touched"] = int(any(pair.get("contact_points", 0) > 0 for pair in summary["pairs"]))
    return found
