# SPDX-License-Identifier: BSD-2-Clause
"""The content of the page of a run, as one object of plain values."""
import hashlib
import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.pages import charts
from ricochet.pages.checks import checks_of, peak_of
from ricochet.pages.instrument import of_run
from ricochet.pages.modes import modes_of
from ricochet.pages.motion import motion_of
from ricochet.pictures.simplified import materials
from ricochet.pages.sound import sounds_of
from ricochet.errors import InputError
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.result_file import File, expected, is_there


def summary_of(path: Path, result: LoadedResult) -> dict[str, Any]:
    """Reads the summary beside the result and checks that it belongs to the same run. Raises InputError."""
    if not is_there(path):
        raise InputError(
            f"{path}: there is no such file. Run ricochet-contact again: it writes one beside the result."
        )
    try:
        summary = json.loads(path.read_text(), parse_constant=lambda word: None)
        # This refuses 1e999 and unpaired surrogates.
        json.dumps(summary, ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, RecursionError):
        raise InputError(f"{path}: is damaged. Run ricochet-contact again.") from None
    kind: dict[str, type] = {"pairs": list} if result.static else {"episodes": list, "sounds": dict}
    kind["warnings"] = list
    same = isinstance(summary, dict) and all(isinstance(summary.get(key), of) for key, of in kind.items())
    if not same or summary.get("candidates") != len(result.initial_gap):
        raise InputError(f"{path}: is not of the run of {result.path.name}. Run ricochet-contact again.")
    return summary


def plain(file: File, where: str, name: str) -> Any:
    """An attribute of a file, if it is text or a finite number."""
    text, value = file.text(where, name), file.attribute(where, name)
    if text is not None:
        return text
    if np.ndim(value) == 0 and isinstance(value, np.number) and np.isfinite(value):
        return value.item()
    raise InputError(f'{file.path}: attribute "{name}" of {where} is missing or damaged. Compute it again.')


def kernel_of(path: Path) -> dict[str, Any] | None:
    """The attributes of a kernel file that the page shows; None if the file does not exist."""
    if not is_there(path):
        return None
    file = File(path, "ricochet-kernel")
    out = {
        name: plain(file, "/", name)
        for name in ["hash", "mesh_sha256", "created_by", "dofs", "elements", "order", "supported"]
    }
    out["basis"] = plain(file, "/modes", "basis")
    return out | {
        name: plain(file, "/modes/certificate", name)
        for name in ["complete", "upto_hz", "count_found", "left_out", "flexibility_error"]
    }


def bodies_of(result: LoadedResult, folder: Path, scene: dict[str, Any]) -> list[dict[str, Any]]:
    out = []
    for name in result.bodies:
        where, asked = f"/bodies/{name}", scene.get("bodies", {}).get(name, {})
        file = Path(result.file.text(where, "kernel") or "").name
        out.append(
            {
                "name": name,
                "mass": plain(result.file, where, "mass"),
                "file": file,
                "kernel": kernel_of(folder / file) if file else None,
                "mesh": asked.get("mesh"),
                "velocity": asked.get("velocity"),
                "materials": materials(asked),
            }
        )
    return out


def commands_of(
    result: LoadedResult, scene: dict[str, Any], bodies: list[dict[str, Any]]
) -> list[tuple[str, str]]:
    """The commands that repeat the run, as pairs (command, its effect)."""
    text, out = shlex.quote(f"{result.slug}.toml"), []
    if any(body["file"] for body in bodies):
        names = ", ".join(body["file"] for body in bodies)
        effect = f"Any number of ranks. It makes, or finds, out/: {names}. An equal name is an equal kernel."
        out.append((f"mpirun -n 2 ricochet-kernel {text}", effect))
    elif table := scene.get("contact", {}).get("table"):
        out.append(("", f"The kernels are in {table}, which no command of Ricochet makes."))
    out.append((f"ricochet-contact {text}", "The impact."))
    out.append((f"ricochet report {shlex.quote(f'out/{result.slug}.result.h5')}", "This page."))
    return out


def charts_of(result: LoadedResult, by_table: bool) -> dict[str, list[dict[str, Any]]]:
    """The charts by section of the page."""
    i = result.strongest
    still = len(result.time) == 1
    out: dict[str, list[dict[str, Any]]] = {"contact": [], "energy": []}
    if not still:
        out["contact"].append(charts.force_chart(result, i))
        motion = charts.table_charts if by_table else charts.along_normal_charts
        out["contact"] += motion(result, i)
        if rubs(result):
            out["contact"][1:1] = charts.friction_charts(result)
    if several(result, by_table):
        out["contact"].append(charts.pressure_chart(result))
    if not still and result.episodes:
        out["contact"].append(charts.spectrum_chart(result))
    if not still and not by_table:
        out["energy"] = charts.energy_charts(result)
    return out


def several(result: LoadedResult, by_table: bool) -> bool:
    """Whether forces are known by place and more than one point has one."""
    return not by_table and np.count_nonzero(result.impulse()) > 1


def rubs(result: LoadedResult) -> bool:
    """Whether a point with friction has touched."""
    return result.has_friction and bool(result.rubbing.any())


def digest(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def run_of(path: Path, kernels: Path | None = None) -> dict[str, Any]:
    """The content of the page for a result file. Raises InputError."""
    result = LoadedResult(path)
    folder = kernels or path.parent
    beside = path.with_name(f"{result.slug}.summary.json")
    summary = summary_of(beside, result)
    with expected(beside):
        sounds = sounds_of(summary, path.parent, result.run)
    scene = result.scene
    by_table = not result.energy
    still = len(result.time) == 1
    bodies = bodies_of(result, folder, scene)
    motion = (
        {"missing": "runs with sampled responses know no bodies"}
        if by_table
        else motion_of(result, folder, scene)
    )
    steps = {
        "rows": len(result.time),
        "every": scene.get("output", {}).get("every", 1),
        "duration_s": None if still else summary.get("duration_s", float(result.time[-1])),
        "rate_hz": scene.get("time", {}).get("rate_hz"),
    }
    ends = {} if by_table else {name: [values[0], values[-1]] for name, values in result.energy.items()}
    return {
        "title": result.title,
        "slug": result.slug,
        "run": result.run,
        "summary": summary,
        "scene": result.file.text("/", "scene") or "",
        "asked": {name: scene.get(name) for name in ["accuracy", "modes", "contact", "time", "loads"]},
        "static": result.static,
        "by_table": by_table,
        "bodies": bodies,
        "steps": steps,
        "labels": LoadedResult.LABELS,
        "energy": ends,
        "charts": charts_of(result, by_table),
        "map": charts.force_map(result) if several(result, by_table) and not still else None,
        "states": charts.state_map(result) if rubs(result) and not still else None,
        "friction": result.has_friction,
        "motion": motion,
        "modes": modes_of(result, folder),
        "peak": None if still else peak_of(result),
        "checks": [] if still else checks_of(result, summary),
        "instrument": (
            {"missing": "bodies at rest, and those of sampled responses, cannot be struck"}
            if still or by_table
            else of_run(path, folder)
        ),
        "episodes": result.spans()[:2000],
        "sounds": sounds,
        "receivers": charts.receiver_charts(result),
        "accelerations": charts.acceleration_charts(result) if result.receivers else {},
        "points": len(result.initial_gap),
        "commands": commands_of(result, scene, bodies),
        "file": {
            "name": path.name,
            "bytes": path.stat().st_size,
            "sha256": digest(path),
            "created_by": result.file.text("/", "created_by"),
        },
    }
