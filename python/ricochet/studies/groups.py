# SPDX-License-Identifier: BSD-2-Clause
"""The settings of a study with accuracy, chosen for groups of neighbouring rows.

Settings are chosen for a row in the middle of those that none serves so far. Estimates then show which
others they serve: at the corners and in the middle of a box of rows, which is halved until all of these rows are
served, or none is, or few are left. A box that is served has at most `MOST` rows. The errors of its other rows
are interpolated.
"""
from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ricochet import programs
from ricochet.errors import InputError
from ricochet.programs import Answer
from ricochet.progress import Progress
from ricochet.studies.journal import Journal
from ricochet.studies.kernels import Kernels
from ricochet.studies.study import Study, numbers

MOST = 50  # rows of a box with estimates at its corners and in its middle
FEW = 4  # rows of a box that is not halved: the settings serve those of its rows that have shown it
WIDE = 3  # steps between rows: a gap where rows are served
SLACK = 1.2  # settings that miss the accuracy serve rows with errors up to this multiple
FEWEST = 4  # pressed points at a time: with fewer, results depend on their places


@dataclass
class Served:
    """Settings for a row, as overrides, and the error that belongs to them."""

    chosen: list[str]
    estimate: dict[str, Any] | None
    warning: str | None = None

    def complete(self, answer: Answer) -> Answer:
        """Adds the error to the answer of an impact with these settings."""
        if answer["status"] == 0:
            summary = answer["summary"]
            summary["error_estimate"] = self.estimate
            summary["warnings"] += [self.warning] if self.warning else []
        return answer


class Groups:
    """Chooses the settings of the rows of a study.

    @param keys   identify the rows in the journal
    @param reads  whether all settings were chosen before
    """

    def __init__(
        self, study: Study, kernels: Kernels, journal: Journal, keys: Sequence[str], reads: bool
    ) -> None:
        self.study, self.kernels, self.journal, self.keys, self.reads = study, kernels, journal, keys, reads
        self.served: dict[int, Served] = {}
        self.refused: dict[int, Answer] = {}
        self.names: list[str] = []  # files of the settings
        self.estimated = 0  # rows with an estimate of their own
        self.kept = 0  # of these, those that run again

    def settle(self, family: str, rows: Sequence[int]) -> None:
        """Chooses the settings of the rows that share a file of settings, named `family`, if nothing else is
        said. Afterwards, each row is served, refused or finished. The same rows make the same groups."""
        bar = Progress(len(rows))
        for alike in by_text([self.study.settings[row] for row in rows], rows):
            places = places_of([self.study.settings[row] for row in alike])
            left = dict(zip(alike, places))
            while left:
                first = middle_of(largest_part(left), left)
                bar.advance("choosing settings", 0)
                done = self._choose(family, first, left)
                left = {row: place for row, place in left.items() if row not in done}
                bar.advance("choosing settings", len(done))

    def _choose(self, family: str, first: int, left: dict[int, NDArray[Any]]) -> set[int]:
        """Chooses settings for a row, and returns all rows that they serve, or that are refused with it."""
        name = f"{family.removesuffix('.settings.toml')}-{self.keys[first][:8]}.settings.toml"
        tests = Tests(self, name)
        if answer := tests.refusal(first):
            alike = [row for row in left if answer["status"] == 2 and not self._differs(row, first)]
            for row in {first, *alike}:
                self.refused[row] = answer
                self.journal.add(self.keys[row], json.dumps(answer).encode())
            return {first, *alike}
        self.names.append(name)
        done: set[int] = set()
        boxes = [list(left)]
        while boxes:
            corners = [corners_of(box, left) for box in boxes]
            tests.run(itertools.chain([first], *corners))
            served = [all(map(tests.serves, of_box)) for of_box in corners]
            middles = [middle_of(box, left) for box in boxes]
            tests.run(itertools.compress(middles, served))
            halves = []
            for box, of_box, middle, good in zip(boxes, corners, middles, served):
                spots = list(dict.fromkeys([*of_box, *([middle] if good else []), *({first} & set(box))]))
                good_spots = list(filter(tests.serves, spots))
                if len(good_spots) == len(spots) and len(box) <= MOST:
                    done |= self._serve(box, spots, left, tests)
                elif len(box) > FEW and good_spots:
                    halves += halves_of(box, left)
                elif good_spots:
                    done |= self._serve(good_spots, good_spots, left, tests)
            boxes = halves
        return done

    def _differs(self, row: int, other: int) -> bool:
        return self.kernels.meshes(row) != self.kernels.meshes(other)

    def _serve(
        self, box: Sequence[int], spots: Sequence[int], places: dict[int, NDArray[Any]], tests: Tests
    ) -> set[int]:
        """Gives the settings to the rows of a box for which kernels are there, and returns these rows."""
        done = tests.with_kernels(box)
        fastest = max(spots, key=lambda row: rate_of(tests.chosen(row)))
        for row in done:
            answer = tests.answers.get(row)
            if answer and not self.study.keep:
                self.journal.add(self.keys[row], json.dumps(answer).encode())
                self.estimated += 1
            elif answer:  # it runs again, for its records
                self.served[row] = Served(tests.chosen(row), answer["summary"]["error_estimate"])
                self.estimated += 1
                self.kept += 1
            else:
                self.served[row] = between(row, spots, places, tests, fastest)
        return done


class Tests:
    """Impacts with estimates, with one file of settings."""

    def __init__(self, groups: Groups, name: str) -> None:
        self.groups, self.name = groups, name
        self.files: list[str] = []
        self.answers: dict[int, Answer] = {}
        self.first = -1

    def _request(self, row: int, **words: Any) -> Answer:
        settings = self.groups.study.settings[row]
        return {"set": [*programs.settings(settings), f"settings={self.name}"], **words}

    def refusal(self, first: int) -> Answer | None:
        """Chooses the settings for a row, unless this was done before. Returns the error if this fails."""
        groups, self.first = self.groups, first
        study, kernels = groups.study, groups.kernels
        if groups.journal.refused(groups.keys[first]):
            return groups.journal.rows[groups.keys[first]]
        if not (kernels.folder / self.name).exists():
            if groups.reads:
                raise InputError(
                    f"{kernels.folder}: {self.name} is missing, the settings of "
                    f"{len(study.settings)} impacts: run ricochet sweep --kernels"
                )
            changes = programs.settings(study.fixed | study.settings[first])
            words = ["--quiet", *programs.with_set([*changes, f"settings={self.name}"], kernels.folder)]
            command = programs.kernel_command(study.scene, words, kernels.ranks)
            if answer := programs.refusal(programs.start(command)):
                return answer
        answer = self._ask([self._request(first, kernels=True)])[0]
        if answer["status"] == 0:
            self.files = [kernel["file"] for kernel in answer["kernels"]]
            kernels.names.update(self.files)
            self.run([first])
            answer = self.answers[first]
        return answer if answer["status"] else None

    def run(self, rows: Iterable[int]) -> None:
        """Runs the impacts of rows that were not run yet."""
        journal, keys = self.groups.journal, self.groups.keys
        new = []
        for row in dict.fromkeys(rows):
            if row in self.answers:
                continue
            if known := journal.rows.get(f"{keys[row]}/{self.name}"):
                self.answers[row] = known
            else:
                new.append(row)
        there = sorted(self.with_kernels(new))
        for row in set(new) - set(there):
            self.answers[row] = {"status": 2, "error": "its kernels are missing"}
        for row, answer in zip(there, self._ask([self._request(row) for row in there])):
            self.answers[row] = answer
            journal.add(f"{keys[row]}/{self.name}", json.dumps(answer).encode())

    def with_kernels(self, rows: Iterable[int]) -> set[int]:
        """The rows whose kernels are there, or are derived from those of the first row."""
        rows = list(rows)
        known = {row for row in rows if row in self.answers and self.answers[row]["status"] == 0}
        new = [row for row in rows if row not in known]
        lacking = dict(zip(new, map(lacks, self._ask([self._request(row, kernels=True) for row in new]))))
        # Rows that lack the same files get them by one derivation.
        one_of = {files: row for row, files in lacking.items() if files}
        derived = self._ask([self._request(row, kernels=True, derive=self.files) for row in one_of.values()])
        there = {files for files, answer in zip(one_of, derived) if not lacks(answer)}
        return known | {row for row, files in lacking.items() if not files or files in there}

    def chosen(self, row: int) -> list[str]:
        """The settings of a row, as overrides; their file where its keys exclude them."""
        return self.answers[row].get("chosen", [f"settings={self.name}"])

    def serves(self, row: int) -> bool:
        """Whether the settings meet the accuracy for a row, or come as close to it as for the first one."""
        answer, first = self.answers[row], self.answers[self.first]
        if row == self.first:
            return True
        if answer["status"] != 0 or "chosen" not in answer:
            return False
        points, most = (one["summary"].get("max_active", FEWEST) for one in (answer, first))
        if 0 < points < min(FEWEST, most):
            return False
        return answer["meets"] or (not first["meets"] and total_of(answer) <= SLACK * total_of(first))

    def _ask(self, requests: list[Answer]) -> list[Answer]:
        answers: list[Answer] = [{} for _ in requests]
        for index, line, _ in self.groups.kernels.ask(requests):
            answers[index] = json.loads(line)
        return answers


def lacks(answer: Answer) -> tuple[str, ...]:
    """The kernels that are missing, by an answer that lists them; its error if it has none."""
    if answer["status"] != 0:
        return (answer["error"],)
    return tuple(kernel["file"] for kernel in answer["kernels"] if not kernel["there"])


def total_of(answer: Answer) -> float:
    """The error of an impact; 0 if nothing touches, infinite if it is unknown."""
    estimate = answer["summary"]["error_estimate"]
    total = estimate["total"] if estimate else 0.0
    return math.inf if total is None else total


def rate_of(chosen: Sequence[str]) -> float:
    """The rate of steps among overrides [Hz]; 0 at rest."""
    return max((float(word.partition("=")[2]) for word in chosen if "rate_hz=" in word), default=0.0)


def by_text(settings: Sequence[dict[str, Any]], rows: Sequence[int]) -> list[list[int]]:
    """The rows with the same values of all keys that are not numbers or lists of numbers."""
    found: dict[str, list[int]] = {}
    for row, setting in zip(rows, settings):
        texts = {key: value for key, value in setting.items() if not numbers(*leaves(value))}
        shape = {key: len(leaves(value)) for key, value in setting.items()}
        found.setdefault(json.dumps([texts, shape], default=str), []).append(row)
    return list(found.values())


def leaves(value: Any) -> list[Any]:
    return [leaf for item in value for leaf in leaves(item)] if isinstance(value, list) else [value]


def places_of(settings: Sequence[dict[str, Any]]) -> list[NDArray[Any]]:
    """Numbers from 0 to 1 by row: logarithms of values of one sign, and other values as they are."""
    columns = []
    for values in zip(*([v for value in s.values() for v in leaves(value) if numbers(v)] for s in settings)):
        x = np.array(values, dtype=float)
        if x.min() > 0 or x.max() < 0:
            x = np.log(np.abs(x))
        if x.max() > x.min():
            columns.append((x - x.min()) / (x.max() - x.min()))
    return list(np.array(columns).T) if columns else [np.zeros(1)] * len(settings)


def middle_of(rows: Iterable[int], places: dict[int, NDArray[Any]]) -> int:
    """The row nearest to the mean of rows."""
    rows = list(rows)
    at = np.array([places[row] for row in rows])
    return rows[int(((at - at.mean(0)) ** 2).sum(1).argmin())]


def largest_part(places: dict[int, NDArray[Any]]) -> list[int]:
    """The rows on the larger side of a gap that is wide, compared with the others along the longest axis."""
    rows = np.array(list(places))
    at = np.array(list(places.values()))
    along = at[:, int(np.ptp(at, axis=0).argmax())]
    order = np.argsort(along, kind="stable")
    gaps = np.diff(along[order])
    steps = gaps[gaps > 0]
    if len(steps) == 0 or gaps.max() < WIDE * np.median(steps):
        return list(places)
    cut = int(gaps.argmax()) + 1
    parts = [order[:cut], order[cut:]]
    return [int(row) for row in rows[max(parts, key=len)]]


def corners_of(box: Sequence[int], places: dict[int, NDArray[Any]]) -> list[int]:
    """The rows of a box nearest to its corners; with more than three axes, nearest to the ends of each."""
    at = np.array([places[row] for row in box])
    low, high = at.min(0), at.max(0)
    wide = np.flatnonzero(high > low)
    corners = []
    if len(wide) <= 3:
        for ends in itertools.product((0, 1), repeat=len(wide)):
            corner = low.copy()
            corner[wide] = np.where(ends, high[wide], low[wide])
            corners.append(corner)
    else:
        for axis, end in itertools.product(wide, (low, high)):
            corner = 0.5 * (low + high)
            corner[axis] = end[axis]
            corners.append(corner)
    return list(dict.fromkeys(box[int(np.abs(at - corner).sum(1).argmin())] for corner in corners))


def halves_of(box: Sequence[int], places: dict[int, NDArray[Any]]) -> list[list[int]]:
    """The box, halved along its longest axis."""
    at = np.array([places[row] for row in box])
    axis = int(np.ptp(at, axis=0).argmax())
    order = np.argsort(at[:, axis], kind="stable")
    half = len(box) // 2
    # Rows with the same value stay together.
    values = at[order, axis]
    cut = int(np.searchsorted(values, values[half])) or int(np.searchsorted(values, values[half], "right"))
    cut = cut if 0 < cut < len(box) else half
    return [[box[k] for k in part] for part in (sorted(order[:cut]), sorted(order[cut:]))]


def between(
    row: int, spots: Sequence[int], places: dict[int, NDArray[Any]], tests: Tests, fastest: int
) -> Served:
    """Settings and error of a row between others: the logarithm of the error is the mean of theirs, with
    weights of one over the square of the distance."""
    answers = [tests.answers[spot] for spot in spots]
    totals = np.array([max(total_of(answer), 1e-300) for answer in answers])
    square = np.array([((places[row] - places[spot]) ** 2).sum() for spot in spots])
    weight = 1 / np.maximum(square, 1e-12)
    total = float(np.exp((weight * np.log(totals)).sum() / weight.sum()))
    nearest = answers[int(square.argmin())]
    estimate = nearest["summary"]["error_estimate"]
    if estimate is not None:
        estimate = {"quantity": estimate["quantity"], "total": total, "interpolated": True}
    warning = None
    if not nearest["meets"]:
        warning = f"the error is about {total:.2g}, interpolated between impacts that miss the accuracy"
    return Served(tests.chosen(fastest), estimate, warning)
