# SPDX-License-Identifier: BSD-2-Clause
"""Scenes: TOML files or dictionaries that describe an impact. The reader of the programs checks them."""

from __future__ import annotations

import copy
import os
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ricochet import _core, files
from ricochet.programs import settings, toml

PathLike = str | os.PathLike[str]

_PART = re.compile(r'(?:"(?P<quoted>[^"]*)"|(?P<bare>[^."\[\]]+))(?P<indices>(?:\[\d+\])*)(?:\.(?!$)|$)')


class Scene:
    """A scene that is always valid: an invalid file or setting raises InputError and changes nothing.

    >>> scene = Scene("meshes/two-disks/two-disks.toml")
    >>> scene["bodies.upper.velocity"] = [0, -6, 0]
    >>> scene["time.rate_hz"]
    44100.0

    For `kernels`, a scene needs no [contact] and no [time]. docs/keys.md lists the keys. They are written as
    for the option --set: `"loads.point[0].vector"`, `'bodies.ball.support."x plane"'`. All quantities are in
    SI units.
    """

    def __init__(self, source: PathLike | Mapping[str, Any], folder: PathLike = ".") -> None:
        """Reads a scene.

        source: a TOML file, or a dictionary with the same tables.
        folder: for a dictionary, the folder to which its paths are relative, and which contains `out`.

        Raises InputError, one line, for a file or a key that the programs refuse.
        """
        if isinstance(source, Mapping):
            self._file = Path(folder).absolute() / "scene.toml"
            self._text = "\n".join(settings(plain(source)))
            self._is_stored = False
        else:
            self._file = Path(source).absolute()
            _core.Scene.read(self._file)  # raises InputError for a file that is not a scene
            self._text = self._file.read_text("utf-8")
            self._is_stored = True
        self._settings: list[str] = []
        self._load([])

    def _load(self, changes: list[str]) -> None:
        everything = [*self._settings, *changes]
        core = _core.Scene(self._text, self._file, everything, _core.Purpose.kernels)
        self._resolved = tomllib.loads(core.toml())
        self._given = tomllib.loads(_core.overridden(self._text, self._file, everything))
        self._core, self._settings = core, everything

    # ---- Keys ----

    def __getitem__(self, key: str) -> Any:
        """The value of a key: as given, otherwise the default. A table is returned as a dictionary. Raises
        KeyError for a key that has neither."""
        path = _split(key)
        for table in (self._given, self._resolved):
            try:
                value: Any = table
                for part in path:
                    value = value[part]
                return value
            except (KeyError, IndexError, TypeError):
                continue
        raise KeyError(key)

    def __contains__(self, key: object) -> bool:
        try:
            self[str(key)]
        except KeyError:
            return False
        return True

    def __setitem__(self, key: str, value: Any) -> None:
        """Sets one key. Raises InputError, and changes nothing, if the scene would become invalid."""
        self.set({key: value})

    def set(self, changes: Mapping[str, Any]) -> None:
        """Sets several keys at once, which may be valid only together. Raises InputError as above."""
        self._load(settings(plain(changes)))

    def changed(self, changes: Mapping[str, Any]) -> Scene:
        """A copy with these keys set. This scene does not change. Raises InputError as `set` does."""
        other = object.__new__(Scene)
        other.__dict__.update(self.__dict__)
        other._settings = list(self._settings)
        other.set(changes)
        return other

    # ---- The whole ----

    @property
    def title(self) -> str:
        return self._core.title

    @property
    def slug(self) -> str:
        """The start of the names of its result files."""
        return self._core.slug

    @property
    def bodies(self) -> list[str]:
        """Names of the elastic bodies, sorted."""
        return self._core.bodies

    @property
    def file(self) -> Path:
        """The file from which the scene was read. For a dictionary, a file `scene.toml` that need not
        exist."""
        return self._file

    @property
    def out(self) -> Path:
        """The default folder of its kernels and results: `out` beside the file."""
        return self._file.parent / "out"

    @property
    def resolved(self) -> dict[str, Any]:
        """All keys with their values or defaults, as the programs read them."""
        return tomllib.loads(self.to_toml())

    def to_toml(self) -> str:
        """The resolved scene as TOML. Read from the same folder, it gives the same scene."""
        return self._core.toml()

    def write(self, path: PathLike) -> Path:
        """Writes the scene as given, with relative paths adapted to the new folder, and returns its path.
        Raises InputError if the file cannot be written."""
        target = Path(path).absolute()
        with files.writing(target, "place"):
            target.parent.mkdir(parents=True, exist_ok=True)
            files.write(target, self._text_for(target.parent).encode())
        return target

    def __repr__(self) -> str:
        return f"<Scene {self.title!r}: {', '.join(self.bodies) or 'a table'}; {self._file}>"

    def _text_for(self, folder: Path) -> str:
        """The scene as given, as TOML for a file in this folder."""
        table: dict[str, Any] = {"title": self.title} | copy.deepcopy(self._given)
        loads = [
            load for group in table.get("loads", {}).values() if isinstance(group, list) for load in group
        ]
        for owners, key in (
            (table.get("bodies", {}).values(), "mesh"),
            ([table.get("contact", {})], "table"),
            ([load for load in loads if isinstance(load, dict)], "history"),
        ):
            for owner in owners:
                if key in owner and not os.path.isabs(owner[key]):
                    owner[key] = os.path.relpath(self._file.parent / owner[key], folder)
        return _as_toml(table)

    # ---- For the functions that run it ----

    def _for_impact(self) -> _core.Scene:
        """The scene for an impact. Raises InputError if something is missing that impacts need."""
        return _core.Scene(self._text, self._file, self._settings, _core.Purpose.impact)

    def _command(self, out: Path) -> tuple[Path, list[str]]:
        """A scene file, and the values of --set that turn it into this scene."""
        if self._is_stored:
            return self._file, self._settings
        return self.write(out / f"{self.slug}.toml"), []


def scene_of(source: Scene | PathLike | Mapping[str, Any]) -> Scene:
    return source if isinstance(source, Scene) else Scene(source)


def _split(key: str) -> list[str | int]:
    """The parts of a dotted key: names, and indices of lists. Raises KeyError for anything else."""
    parts: list[str | int] = []
    at = 0
    while at < len(key):
        found = _PART.match(key, at)
        if not found:
            raise KeyError(key)
        parts.append(found["quoted"] if found["quoted"] is not None else found["bare"])
        parts += [int(index) for index in re.findall(r"\d+", found["indices"])]
        at = found.end()
    if not parts:
        raise KeyError(key)
    return parts


def _as_toml(scene: Mapping[str, Any]) -> str:
    """The tables of a scene in the usual form: one section for each table, body and obstacle."""
    lines = _lines({name: value for name, value in scene.items() if not isinstance(value, Mapping)})
    for name, table in scene.items():
        if isinstance(table, Mapping):
            by_name = all(isinstance(value, Mapping) for value in table.values())
            sections = {f"{name}.{_quoted(key)}": table[key] for key in table} if by_name else {name: table}
            for title, section in sections.items():
                lines += ["", f"[{title}]", *_lines(section)]
    return "\n".join(lines) + "\n"


def _quoted(key: str) -> str:
    return key if re.fullmatch("[A-Za-z0-9_-]+", key) else toml(key)


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [line.replace("=", " = ", 1) for line in settings(table)]


def plain(value: Any) -> Any:
    """Converts a value to TOML types. NumPy arrays and numbers, tuples and paths are converted."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value
