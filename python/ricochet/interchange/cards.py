# SPDX-License-Identifier: BSD-2-Clause
"""The cards of input files of Abaqus and CalculiX: a keyword with parameters and lines of data."""
from collections.abc import Iterable, Iterator
from pathlib import Path

from ricochet.errors import InputError
from ricochet.interchange.numbers import LONGEST_RANGE, is_number

Card = tuple[str, str, dict[str, str], list["Line"]]  # place, keyword, parameters, lines of data


class Line(list[str]):
    """The words of a line and its position in the file."""

    def __init__(self, words: Iterable[str], where: str) -> None:
        super().__init__(words)
        self.where = where


def line_of(text: str, path: Path, number: int) -> Line:
    words = text.rstrip().rstrip(",").split(",")
    return Line([word.strip().strip('"') for word in words], f"{path}: line {number}")


def lines_of(path: Path) -> list[tuple[int, str]]:
    """The lines of a file with their numbers, without comments and blank lines."""
    text = Path(path).read_text(errors="replace")
    return [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.startswith("**")
    ]


def joined(lines: list[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Yields the lines, each keyword with the parameters that follow on further lines: it ends in a comma then."""
    start: tuple[int, str] | None = None
    for number, line in lines:
        if start and not line.startswith("*"):
            start = start[0], start[1] + line.strip()
        elif start:
            yield start
            start = None
        if start is None and line.startswith("*"):
            start = number, line.rstrip()
        elif start is None:
            yield number, line
        if start and not start[1].endswith(","):
            yield start
            start = None
    if start:
        yield start


def cards(path: Path, outer: tuple[Path, ...] = ()) -> Iterator[Card]:
    """Yields the cards of an input file and its includes: place, keyword, parameters and lines of data of
    each."""
    card: Card | None = None
    outer = (*outer, Path(path).resolve())
    for number, line in joined(lines_of(path)):
        if not line.startswith("*"):
            if card:
                card[3].append(line_of(line, path, number))
            continue
        if card:
            yield card
        words = [word.strip() for word in line[1:].split(",")]
        parameters = {}
        for word in words[1:]:
            key, _, value = word.partition("=")
            parameters[key.strip().upper()] = value.strip().strip('"')
        card = (f"{path}: line {number}", " ".join(words[0].upper().split()), parameters, [])
        if "INPUT" in parameters:
            inner = Path(path).parent / parameters["INPUT"]
            if not inner.is_file():
                raise InputError(f"{card[0]}: includes {inner}: no such file")
            if card[1] == "INCLUDE":
                if inner.resolve() in outer:
                    raise InputError(f"{card[0]}: includes {inner}, which is being read already")
                card = None
                yield from cards(inner, outer)
            else:
                card[3].extend(line_of(text, inner, k) for k, text in lines_of(inner))
    if card:
        yield card


def members(lines: Iterable[Line], parameters: dict[str, str], sets: dict[str, list[int]]) -> Iterator[int]:
    """Yields the members of a set. Its lines may contain names of other sets or define a range."""
    if "GENERATE" in parameters:
        for line in lines:
            first, last, step = [int(word) for word in line[:2]] + [int(line[2]) if len(line) > 2 else 1]
            if (last - first) / step > LONGEST_RANGE:
                raise InputError(f"{line.where}: a range of more than {LONGEST_RANGE} numbers")
            yield from range(first, last + 1, step)
        return
    for line in lines:
        for word in filter(None, line):
            yield from [int(word)] if is_number(word.lstrip("-")) else set_of(sets, word, line)


def set_of(sets: dict[str, list[int]], name: str, line: Line) -> list[int]:
    if name.upper() not in sets:
        raise InputError(f"{line.where}: names the set {name}, which is not there")
    return sets[name.upper()]
