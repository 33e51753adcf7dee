"""Study files of scripts/sweep: which keys of a scene take which values."""
import itertools
import math
import tomllib

import numpy as np

from result_file import BadInput
from titles import slug

DRAWS = {"uniform": 2, "log_uniform": 2, "normal": 2}


class Study:
    """A study with all its settings: dictionaries from scene keys to values, in an order that does not change."""

    def __init__(self, path):
        self.path = path
        try:
            table = tomllib.loads(path.read_text())
        except OSError as error:
            raise BadInput(f"{path}: {error.strerror}. Name a study, a TOML file that names a scene.") from None
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise BadInput(f"{path}: is not TOML: {error}") from None
        known = {"scene", "title", "set", "grid", "list", "random"}
        for key in table:
            if key not in known:
                raise BadInput(f"{path}: unknown key \"{key}\": a study has {', '.join(sorted(known))}")
        if not isinstance(table.get("scene"), str):
            raise BadInput(f"{path}: scene is missing: give the path of a scene, relative to the study")
        self.scene = path.parent / table["scene"]
        self.title = table.get("title", path.stem)
        self.slug = slug(self.title)
        self.fixed = self._keys(table, "set")
        grid = {key: self._values("grid", key, value) for key, value in self._keys(table, "grid").items()}
        rows = self._rows(self._keys(table, "list"))
        draws = self._draws(self._keys(table, "random"))
        self.keys = [*grid, *(rows[0] if rows[0] else ()), *(draws[0] if draws[0] else ())]
        twice = {key for key in self.keys if self.keys.count(key) > 1}
        if twice:
            raise BadInput(f"{path}: {', '.join(sorted(twice))} is varied twice: name a key once")
        self.settings = [dict(zip(grid, values)) | row | draw
                         for values in itertools.product(*grid.values()) for row in rows for draw in draws]
        if not self.keys:
            raise BadInput(f"{path}: varies nothing: give [grid], [list] or [random] some keys of the scene")

    def _keys(self, table, name):
        found = table.get(name, {})
        if not isinstance(found, dict):
            raise BadInput(f"{self.path}: {name} must be a table of scene keys")
        return {key: value for outer, item in found.items() for key, value in flat(outer, item)} if name != "random" else found

    def _values(self, where, key, value):
        if isinstance(value, list) and value:
            return value
        if isinstance(value, dict) and {"from", "to", "steps"} <= set(value) <= {"from", "to", "steps", "scale"}:
            low, high, steps = value["from"], value["to"], value["steps"]
            if isinstance(steps, int) and steps >= 2 and numbers(low, high):
                if value.get("scale", "linear") == "linear":
                    return [float(v) for v in np.linspace(low, high, steps)]
                if value["scale"] == "log" and low * high > 0:
                    return [float(v) for v in math.copysign(1, low) * np.geomspace(abs(low), abs(high), steps)]
        raise BadInput(f"{self.path}: {where}.\"{key}\" = {value}: give a list of values, or {{from, to, steps}} with 2 or "
                       "more steps and, where both ends have the same sign, scale = \"log\"")

    def _rows(self, table):
        columns = {key: self._values("list", key, value) for key, value in table.items()}
        if len({len(column) for column in columns.values()}) > 1:
            lengths = ", ".join(f"{key}: {len(column)}" for key, column in columns.items())
            raise BadInput(f"{self.path}: list: the keys are walked through together and need as many values each, got {lengths}")
        return [dict(zip(columns, row)) for row in zip(*columns.values())] if columns else [{}]

    def _draws(self, table):
        if not table:
            return [{}]
        count, seed = table.pop("count", None), table.pop("seed", 1)
        if not isinstance(count, int) or not 1 <= count <= 10**7 or not isinstance(seed, int) or seed < 0:
            raise BadInput(f"{self.path}: random: give count = 1 … 10000000 and, if you like, a seed ≥ 0")
        random, columns = np.random.default_rng(seed), {}
        for outer, item in table.items():
            for key, value in flat(outer, item, DRAWS):
                columns[key] = self._draw(random, key, value, count)
        return [dict(zip(columns, row)) for row in zip(*columns.values())]

    def _draw(self, random, key, value, count):
        if isinstance(value, dict) and len(value) == 1:
            (kind, given), = value.items()
            if kind == "choice" and isinstance(given, list) and given:
                return [given[k] for k in random.integers(len(given), size=count)]
            if kind in DRAWS and isinstance(given, list) and len(given) == 2 and numbers(*given):
                low, high = given
                if kind == "normal" and high >= 0:
                    return [float(v) for v in random.normal(low, high, count)]
                if kind == "uniform":
                    return [float(v) for v in random.uniform(low, high, count)]
                if kind == "log_uniform" and low * high > 0:
                    return [float(v) for v in math.copysign(1, low) * np.exp(random.uniform(
                        math.log(abs(low)), math.log(abs(high)), count))]
        raise BadInput(f"{self.path}: random.\"{key}\" = {value}: give {{uniform = [low, high]}}, {{log_uniform = [low, high]}} "
                       "of one sign, {normal = [mean, deviation]} or {choice = [values]}")


def numbers(*values):
    return all(isinstance(v, (int, float)) and not isinstance(v, bool) and math.isfinite(v) for v in values)


def flat(key, value, leaves=()):
    """Pairs (dotted key, value) of a nested TOML table: [grid.bodies.upper] young = [1, 2] and
    [grid] "bodies.upper.young" = [1, 2] say the same. A table of from, to, steps or of a draw is a value."""
    if isinstance(value, dict) and not {"from", "to", "steps"} & set(value) and not set(value) & {*leaves, "choice"}:
        for name, item in value.items():
            yield from flat(f"{key}.{name}", item, leaves)
    else:
        yield key, value
