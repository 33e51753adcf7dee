# SPDX-License-Identifier: BSD-2-Clause
"""The entries of bulk data of Nastran: free, small and large fields, with continuation lines.

Source: MSC Nastran, "Quick reference guide", "Format of bulk data entries".
"""
import re
from collections.abc import Iterator
from pathlib import Path

from ricochet.errors import InputError
from ricochet.interchange.numbers import LONGEST_RANGE

# 1.5+3 and 1.5D+3 are 1.5e3.
EXPONENT = re.compile(r"(?<=[0-9.])[Dd]?([+-][0-9]+)$|[Dd]([+-]?[0-9]+)$")
WHOLE = re.compile("[+-]?[0-9]{1,15}")
INCLUDE = re.compile(r"\s*INCLUDE\s+['\"]?(.*?)['\"]?", re.IGNORECASE)
FIELDS = 8  # of a line, between its name and its mark of continuation


class Entry(list[str]):
    """The fields of an entry after its name, empty ones included."""

    def __init__(self, name: str, where: str) -> None:
        super().__init__()
        self.name, self.where = name, where

    def field(self, k: int) -> str:
        return self[k] if k < len(self) else ""

    def whole(self, k: int, otherwise: int | None = None) -> int:
        """Field k as a whole number. Raises InputError."""
        word = self.field(k)
        if not word and otherwise is not None:
            return otherwise
        if not WHOLE.fullmatch(word):
            raise InputError(
                f'{self.where}: field {k + 2} of {self.name} is "{word}": must be a whole number'
            )
        return int(word)

    def real(self, k: int, otherwise: float | None = None) -> float | None:
        """Field k as a number. Raises InputError."""
        word = self.field(k)
        if not word:
            return otherwise
        try:
            return float(EXPONENT.sub(lambda found: f"e{found[1] or found[2]}", word))
        except ValueError:
            raise InputError(
                f'{self.where}: field {k + 2} of {self.name} is "{word}": must be a number'
            ) from None

    def wholes(self, start: int) -> list[int]:
        """The whole numbers from field `start` on, without empty fields; "a THRU b" is a range."""
        words = [k for k in range(start, len(self)) if self[k]]
        if len(words) == 3 and self[words[1]].upper() == "THRU":
            first, last = self.whole(words[0]), self.whole(words[2])
            if last - first > LONGEST_RANGE:
                raise InputError(f"{self.where}: a range of more than {LONGEST_RANGE} numbers")
            return list(range(first, last + 1))
        return [self.whole(k) for k in words]


def fields_of(line: str) -> tuple[str, list[str], bool]:
    """The name of a line, its fields, and whether they are large."""
    if "," in line:
        words = [word.strip() for word in line.split(",")]
        large = words[0].endswith("*")
        wanted = FIELDS // 2 if large else FIELDS
        return words[0].rstrip("*"), (words[1:] + [""] * wanted)[:wanted], large
    line = line.expandtabs(8).ljust(72)
    large = "*" in line[:8]
    width = 16 if large else 8
    name = line[:8].strip()
    return (
        name if name == "*" else name.rstrip("*"),
        [line[k : k + width].strip() for k in range(8, 72, width)],
        large,
    )


def lines_of(path: Path, outer: tuple[Path, ...] = ()) -> Iterator[tuple[str, str]]:
    """Yields place and text of the lines of a file and its includes, without comments."""
    outer = (*outer, path.resolve())
    for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
        line = line.partition("$")[0].rstrip()
        where = f"{path}: line {number}"
        if found := INCLUDE.fullmatch(line):
            inner = path.parent / found[1]
            if not inner.is_file():
                raise InputError(f"{where}: includes {inner}: no such file")
            if inner.resolve() in outer:
                raise InputError(f"{where}: includes {inner}, which is being read already")
            yield from lines_of(inner, outer)
        elif line:
            yield where, line


def control_and_bulk(path: Path) -> tuple[list[str], list[tuple[str, str]]]:
    """The lines of the case control, and those of the bulk data. A file without BEGIN BULK is bulk data alone."""
    lines = list(lines_of(path))
    begin = [k for k, (_, line) in enumerate(lines) if re.match(r"\s*BEGIN\s*(BULK)?\b", line, re.IGNORECASE)]
    end = [k for k, (_, line) in enumerate(lines) if re.match(r"ENDDATA\b", line, re.IGNORECASE)]
    if begin and not end:
        raise InputError(f"{path}: has no ENDDATA: it is cut off, export it again")
    start = begin[0] + 1 if begin else 0
    return [line for _, line in lines[: max(start - 1, 0)]], lines[start : end[-1] if end else None]


def entries(lines: list[tuple[str, str]]) -> Iterator[Entry]:
    """Yields the entries of bulk data. The lines of an entry follow each other."""
    entry: Entry | None = None
    for where, line in lines:
        name, fields, _ = fields_of(line)
        if name == "" or name[0] in "+*":
            if entry is None:
                raise InputError(f"{where}: continues no entry: keep the lines of an entry together")
            entry.extend(fields)
            continue
        if entry is not None:
            yield entry
        entry = Entry(name.upper().rstrip("_"), where)  # meshio writes CTETRA_
        entry.extend(fields)
    if entry is not None:
        yield entry
