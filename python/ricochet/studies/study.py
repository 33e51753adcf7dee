# SPDX-License-Identifier: BSD-2-Clause
"""Study files: the values of scene keys in a sweep."""
from collections.abc import Iterable, Iterator
import difflib
import itertools
import math
import os
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.errors import InputError
from ricochet.programs import slug

KNOWN = ("scene", "title", "keep", "set", "grid", "list", "random")
#: words of `keep`, and the members of a file of records that belong to each
WORDS = {
    "force": ("contact",),
    "receivers": ("receivers",),
    "acceleration": ("receivers",),
    "gauges": ("gauges",),
    "bodies": ("time", "bodies"),
    "energy": ("time", "energy"),
}
DRAWS = {"uniform", "log_uniform", "normal"}
RANGE = {"from", "to", "steps"}
MOST = 10**7  # maximum number of settings, which are kept in memory
DEEPEST = 50


class Study:
    """A study, the text of its scene and all its settings: dictionaries from scene keys to values, in a fixed
    order."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(
                f"{path}: {error.strerror}. Name a study, a TOML file that names a scene."
            ) from None
        except RecursionError:
            raise InputError(f"{path}: has lists or tables nested too deep: {DEEPEST} are the most") from None
        except ValueError as error:
            raise InputError(f"{path}: is not TOML: {error}") from None
        if "bodies" in table:
            raise InputError(
                f"{path}: is a scene: ricochet run {path} runs it, and a study names it as scene"
            )
        for key in table:
            if key not in KNOWN:
                raise InputError(f'{path}: unknown key "{key}"{meant(key, KNOWN, "a study has")}')
            if wrong := unfit(table[key]):
                raise InputError(f"{path}: {key}: {wrong}")
        if not isinstance(table.get("scene"), str):
            raise InputError(f"{path}: scene is missing: give the path of a scene, relative to the study")
        self.scene = path.parent / table["scene"]
        try:
            self.text = self.scene.read_bytes().decode(errors="replace")
        except OSError as error:
            raise InputError(
                f"{path}: scene: {self.scene}: {error.strerror}. Give the path of a scene, relative to the study."
            ) from None
        self.title = table.get("title", utf8(Path(path.stem)))
        if not isinstance(self.title, str):
            raise InputError(f"{path}: title = {self.title}: give a text, in quotes")
        self.slug = slug(self.title)
        self.keep = self._records(table.get("keep", []))
        self.fixed = self._keys(table, "set")
        grid = {key: self._values("grid", key, value) for key, value in self._keys(table, "grid").items()}
        rows = self._rows(self._keys(table, "list"))
        draws = self._draws(self._keys(table, "random"))
        self.keys = [*grid, *(rows[0] if rows[0] else ()), *(draws[0] if draws[0] else ())]
        twice = {key for key in self.keys if self.keys.count(key) > 1}
        if twice:
            raise InputError(f"{path}: {', '.join(sorted(twice))} is varied twice: name a key once")
        if math.prod(map(len, grid.values())) * len(rows) * len(draws) > MOST:
            raise InputError(
                f"{path}: has more than {MOST} settings: take fewer values, or draw some by [random]"
            )
        self.settings = [
            dict(zip(grid, values)) | row | draw
            for values in itertools.product(*grid.values())
            for row in rows
            for draw in draws
        ]
        if not self.keys:
            raise InputError(
                f"{path}: varies nothing: give [grid], [list] or [random] some keys of the scene"
            )

    def _records(self, words: Any) -> list[str]:
        """The records to keep, each once."""
        if not isinstance(words, list):
            raise InputError(f'{self.path}: keep = {shown(words)}: give a list, as in keep = ["force"]')
        for word in words:
            if word not in list(WORDS):  # it may be a list, which has no hash
                raise InputError(
                    f'{self.path}: keep: there is no record "{shown(word)}"{meant(str(word), WORDS, "there are")}'
                )
        return list(dict.fromkeys(words))

    def _keys(self, table: dict[str, Any], name: str) -> dict[str, Any]:
        found = table.get(name, {})
        if not isinstance(found, dict):
            raise InputError(f"{self.path}: {name} must be a table of scene keys")
        if "keep" in found:
            raise InputError(f"{self.path}: {name}.keep: belongs to the top of the file, before all tables")
        if name == "random":
            return found
        return {key: value for outer, item in found.items() for key, value in flat(outer, item)}

    def _values(self, where: str, key: str, value: Any) -> list[Any]:
        if isinstance(value, list) and value:
            return value
        if isinstance(value, dict) and RANGE <= set(value) <= RANGE | {"scale"}:
            low, high, steps = value["from"], value["to"], value["steps"]
            if isinstance(steps, int) and 2 <= steps <= MOST and numbers(low, high):
                if value.get("scale", "linear") == "linear" and math.isfinite(high - low):
                    return np.linspace(low, high, steps).tolist()
                if value.get("scale") == "log" and same_sign(low, high):
                    return (math.copysign(1, low) * np.geomspace(abs(low), abs(high), steps)).tolist()
        raise InputError(
            f'{self.path}: {where}."{key}" = {shown(value)}: give a list of values, or {{from, to, steps}} with 2 to '
            f'{MOST} steps and, where both ends have the same sign, scale = "log"'
        )

    def _rows(self, table: dict[str, Any]) -> list[dict[str, Any]]:
        columns = {key: self._values("list", key, value) for key, value in table.items()}
        if len({len(column) for column in columns.values()}) > 1:
            lengths = ", ".join(f"{key}: {len(column)}" for key, column in columns.items())
            raise InputError(f"{self.path}: list: all keys need the same number of values, got {lengths}")
        return [dict(zip(columns, row)) for row in zip(*columns.values())] if columns else [{}]

    def _draws(self, table: dict[str, Any]) -> list[dict[str, Any]]:
        if not table:
            return [{}]
        count, seed = table.pop("count", None), table.pop("seed", 1)
        if not isinstance(count, int) or not 1 <= count <= MOST or not isinstance(seed, int) or seed < 0:
            near = "".join(difflib.get_close_matches("count", table, 1)) if count is None else ""
            raise InputError(
                f"{self.path}: random: give count = 1 … {MOST} and, if you like, a seed ≥ 0"
                + f'. Is "{near}" meant as count?' * bool(near)
            )
        random, columns = np.random.default_rng(seed), {}
        for outer, item in table.items():
            for key, value in flat(outer, item, DRAWS):
                columns[key] = self._draw(random, key, value, count)
        if not columns:
            raise InputError(f"{self.path}: random: draws nothing: give it keys of the scene")
        return [dict(zip(columns, row)) for row in zip(*columns.values())]

    def _draw(self, random: np.random.Generator, key: str, value: Any, count: int) -> list[Any]:
        if isinstance(value, dict) and len(value) == 1:
            ((kind, given),) = value.items()
            if kind == "choice" and isinstance(given, list) and given:
                return [given[k] for k in random.integers(len(given), size=count)]
            if kind in DRAWS and isinstance(given, list) and len(given) == 2 and numbers(*given):
                low, high = given
                if kind == "normal" and 0 <= high < 1e300 and abs(low) < 1e300:  # so that draws are finite
                    return random.normal(low, high, count).tolist()
                if kind == "uniform" and low <= high and math.isfinite(high - low):
                    return random.uniform(low, high, count).tolist()
                if kind == "log_uniform" and same_sign(low, high):
                    least, most = sorted((math.log(abs(low)), math.log(abs(high))))
                    return (math.copysign(1, low) * np.exp(random.uniform(least, most, count))).tolist()
        raise InputError(
            f'{self.path}: random."{key}" = {shown(value)}: give {{uniform = [low, high]}}, {{log_uniform = [low, high]}} '
            "of one sign, {normal = [mean, deviation]} or {choice = [values]}"
        )


def meant(word: str, known: Iterable[str], otherwise: str) -> str:
    """Ends a complaint about a word that does not exist: the word that is most similar, or all of them."""
    near = difflib.get_close_matches(word, known, 1)
    return f'. Did you mean "{near[0]}"?' if near else f": {otherwise} {', '.join(sorted(known))}"


def numbers(*values: Any) -> bool:
    return all(isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v) for v in values)


def same_sign(low: float, high: float) -> bool:
    return min(low, high) > 0 or max(low, high) < 0


def shown(value: Any) -> str:
    """A value as it appears in messages."""
    text = str(value)
    return text if len(text) < 200 else text[:200] + "…"


def utf8(path: Path) -> str:
    """A path as UTF-8 text. Other bytes are replaced."""
    return os.fsencode(path).decode(errors="replace")


def unfit(value: Any, depth: int = 1) -> str:
    """The reason why no scene can contain a value; empty if it can."""
    if depth > DEEPEST:
        return f"lists or tables are nested too deep: {DEEPEST} are the most"
    if isinstance(value, dict):
        value = [*value, *value.values()]
    if isinstance(value, list):
        return next(filter(None, (unfit(item, depth + 1) for item in value)), "")
    if isinstance(value, str):
        return "a text has a NUL character: take it out" if "\0" in value else ""
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        return "a whole number has more than 64 bits: write it with a point"
    if not isinstance(value, (int, float)):
        return f"{value} is a date or a time, which no key of a scene takes: give a number, a text or a list"
    return ""


def flat(key: str, value: Any, leaves: Iterable[str] = ()) -> Iterator[tuple[str, Any]]:
    """Yields pairs (dotted key, value) of a nested TOML table: [grid.bodies.upper] young = [1, 2] is the same
    as [grid] "bodies.upper.young" = [1, 2]. A table with from, to and steps, or with a distribution, is a
    value.
    """
    if isinstance(value, dict) and not {*RANGE, *leaves, "choice"} & set(value):
        for name, item in value.items():
            yield from flat(f"{key}.{name}", item, leaves)
    else:
        yield key, value
