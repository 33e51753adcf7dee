# SPDX-License-Identifier: BSD-2-Clause
"""Recognises a file that is given in the place of another, by its name, and names the one to give. `os.path` raises no
PermissionError."""
import os
import tomllib
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.errors import InputError

DRAWINGS = (".step", ".stp", ".brep", ".geo", ".msh")
RESULT, KERNEL, SUMMARY = ".result.h5", ".kernel.h5", ".summary.json"


def such_as(folder: Path, endings: tuple[str, ...]) -> str:
    """The first file with one of these endings in a folder, as advice."""
    try:
        found = sorted(path for path in folder.iterdir() if path.name.endswith(endings))
    except OSError:  # it may not be read
        found = []
    return f", such as {found[0]}" if found else f", a file that ends in {' or '.join(endings)}"


def tables_of(scene: Path) -> dict[str, Any]:
    """The tables of a scene or study; empty if it cannot be read."""
    try:
        return tomllib.loads(scene.read_text())
    except (OSError, ValueError):
        return {}


def result_of(scene: Path) -> Path:
    """The result file of a scene without overrides."""
    title = tables_of(scene).get("title", scene.stem)
    return programs.out_folder(scene) / f"{programs.slug(str(title))}{RESULT}"


def mesh_of(scene: Path) -> str:
    """The mesh of the first body of a scene that names one, as advice."""
    bodies = tables_of(scene).get("bodies", {})
    meshes = [str(body["mesh"]) for body in bodies.values() if isinstance(body, dict) and "mesh" in body]
    return f", such as {scene.parent / meshes[0]}" if meshes else ""


def result(text: str) -> Path:
    """The path of a result. Raises InputError if the name is that of another file."""
    path = Path(text)
    if os.path.isdir(path):
        raise InputError(f"{path}: is a folder: name a result in it{such_as(path, (RESULT,))}")
    tables = tables_of(path) if path.suffix == ".toml" else {}
    if "scene" in tables and "bodies" not in tables:
        raise InputError(f"{path}: is a study: name the result of one of its runs, *{RESULT}")
    if path.suffix == ".toml":
        own = result_of(path)
        first = "" if os.path.exists(own) else f"run ricochet run {path} first, then "
        raise InputError(f"{path}: is a scene: {first}name its result, {own}")
    if path.name.endswith(SUMMARY):
        own = path.with_name(path.name.removesuffix(SUMMARY) + RESULT)
        raise InputError(f"{path}: is the summary of a result: name {own}")
    if path.name.endswith(KERNEL):
        raise InputError(
            f"{path}: is a kernel: name a result, *{RESULT}; ricochet modes --plot SCENE.toml draws modes"
        )
    if path.suffix in DRAWINGS:
        raise InputError(f"{path}: is a drawing or mesh: name a result, *{RESULT}")
    return path


def drawing(text: str) -> Path:
    """The path of a drawing or mesh. Raises InputError if the name is that of another file."""
    path = Path(text)
    if os.path.isdir(path):
        raise InputError(f"{path}: is a folder: name a drawing in it{such_as(path, DRAWINGS)}")
    if path.suffix == ".toml":
        raise InputError(f"{path}: is a scene: name a drawing or mesh{mesh_of(path)}")
    if path.name.endswith((RESULT, KERNEL)):
        raise InputError(f"{path}: is a result or kernel: name a drawing or mesh, *{' or *'.join(DRAWINGS)}")
    return path
