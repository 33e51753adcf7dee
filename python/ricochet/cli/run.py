# SPDX-License-Identifier: BSD-2-Clause
"""Takes a scene from mesh to pictures: kernels, impact, figures, page. Skips files that are up to date.

    ricochet run meshes/two-disks/two-disks.toml
    ricochet run -n 4 meshes/two-disks/two-disks.toml --set title=fast --set 'bodies.upper.velocity=[0,-6,0]'

The options --set, --accuracy and --out are those of ricochet-kernel and ricochet-contact. If the scene gives neither
output.view nor output.snapshot_every, pictures and page show the motion nevertheless: surfaces of up to 64 MiB a body
are kept, and up to 400 snapshots.
"""
import argparse
import contextlib
import json
import tomllib
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.cli import plot
from ricochet.cli.modes import stored
from ricochet.cli.options import add_low_pass, add_run, words_for_programs
from ricochet.errors import InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_run(parser, "kernels, results and pictures")
    add_low_pass(parser)
    text = "write the scene with the settings that were chosen for its accuracy"
    parser.add_argument("--write-scene", type=Path, metavar="FILE.toml", help=text)


VIEW_MIB = 64  # largest visualisation surface of a body that is kept although the scene does not ask for it
SNAPSHOTS_MB = 8  # size of the modal coordinates of snapshots that are kept in the same way


def asked_output(options: argparse.Namespace) -> dict[str, Any]:
    """The keys of [output] that the scene file or --set gives."""
    with contextlib.suppress(OSError, UnicodeError, tomllib.TOMLDecodeError):  # the programs report these
        output = tomllib.loads(options.scene.read_text()).get("output", {})
        given = dict(output) if isinstance(output, dict) else {}
        for key, value in programs.changes(options.set).items():
            if key == "output" and isinstance(value, dict):
                given = value
            elif key.startswith("output."):
                given[key.removeprefix("output.")] = value
        return given
    return {}


def words_for_surfaces(output: dict[str, Any]) -> list[programs.Word]:
    """Words that let ricochet-kernel keep surfaces, unless the scene decides this by view or snapshots."""
    decides = "view" in output or output.get("snapshot_every", 1) == 0
    return [] if decides else ["--view-up-to", str(VIEW_MIB)]


def words_for_snapshots(options: argparse.Namespace, output: dict[str, Any]) -> list[programs.Word]:
    """Words that let ricochet-contact keep snapshots, if all kernels have surfaces and the scene does not decide this."""
    if "snapshot_every" in output or output.get("view") is False:
        return []
    kernels = stored(options)
    seen = kernels and all(map(has_surface, kernels.values()))
    return ["--snapshots-up-to", str(SNAPSHOTS_MB)] if seen else []


def newer(target: Path, *sources: Path) -> bool:
    """Whether `target` and all sources exist, and no source has changed since it was written."""
    files = [target, *sources]
    return (
        all(map(Path.exists, files)) and max(file.stat().st_mtime for file in files) == target.stat().st_mtime
    )


def summary_of(result: Path) -> Path:
    return Path(str(result).removesuffix(".result.h5") + ".summary.json")


def lacks_kernels(result: Path) -> bool:
    """Whether a body turned although the kernels do not serve this."""
    return bool(json.loads(summary_of(result).read_text()).get("needs_turning_kernels"))


def has_surface(kernel: Path) -> bool:
    import h5py

    with h5py.File(kernel) as file:
        return "view" in file


def same(made: dict[str, Any], asked: dict[str, Any]) -> bool:
    """Whether a result is of the resolved scene that is asked for, which may have left its rotation to the run, and rate
    and precision to its accuracy."""
    motion, time = made.get("motion", {}), made.get("time", {})
    if "rotation" not in asked.get("motion", {}) and motion.get("rotation") == "finite":
        del motion["rotation"]
    if "accuracy" in asked:
        for key in {"rate_hz", "contact_rate_hz", "precision"} - set(asked.get("time", {})):
            time.pop(key, None)
    return made | {"motion": motion} == asked | {"motion": asked.get("motion", {})}


def current(result: Path, scene: dict[str, Any], folder: Path, snapshots: bool) -> bool:
    """Whether the result file is complete and belongs to this resolved scene, the surfaces of its obstacles, which are named from
    `folder`, these kernels and this program. With `snapshots` it also has some.
    """
    import h5py

    if not result.exists() or not summary_of(result).exists():
        return False
    try:
        with h5py.File(result) as file:
            kernels = [result.parent / group.attrs["kernel"].decode() for group in file["bodies"].values()]
            made = tomllib.loads(file.attrs["scene"].decode())
        if lacks_kernels(result):
            return False
        if snapshots:
            if not made["output"]["snapshot_every"]:
                return False
            made["output"]["snapshot_every"] = scene["output"]["snapshot_every"]
    except (OSError, KeyError, AttributeError, TypeError, ValueError):  # not a result of ricochet-contact
        return False
    surfaces = [folder / one["surface"] for one in scene.get("obstacles", {}).values() if "surface" in one]
    return same(made, scene) and newer(result, programs.BIN / "ricochet-contact", *kernels, *surfaces)


def run(options: argparse.Namespace) -> None:
    words = words_for_programs(options)
    out = programs.out_folder(options.scene, options.out)
    table = tomllib.loads(programs.resolved(options.scene, words))
    slug = programs.slug(table["title"])
    from ricochet import pages, pictures  # takes a second, and refusals of the scene come before

    output = asked_output(options)
    surfaces = words_for_surfaces(output)
    # Installed by pip, there is no ricochet-kernel: then kernels that are there must do.
    if programs.kernel_program().is_file() or not stored(options):
        programs.kernel(options.scene, [*words, *surfaces], options.ranks)
    result = out / f"{slug}.result.h5"
    table = tomllib.loads(programs.resolved(options.scene, words))  # with settings chosen for its accuracy
    snapshots = words_for_snapshots(options, output)
    wanted = [*snapshots, *(["--write-scene", options.write_scene] if options.write_scene else [])]
    if not options.write_scene and current(result, table, options.scene.parent, bool(snapshots)):
        print(f"{result}: up to date")
    else:
        programs.contact(options.scene, [*words, *wanted])
        if lacks_kernels(result):
            with contextlib.suppress(InputError):  # the program has said why: the result stays as it is
                finite = [*words, *surfaces, "--set", "motion.rotation=finite"]
                programs.kernel(options.scene, finite, options.ranks)
                programs.contact(options.scene, [*words, *wanted])
    if table["contact"]["scheme"] != "static":  # bodies at rest have no motion to draw
        last = out / f"{slug}-energy.png"
        if options.low_pass is None and newer(last, result, Path(pictures.__file__)):
            print(f"{last}: up to date")
        else:
            plot.draw(result, low_pass=options.low_pass)
    page = out / f"{slug}.report.html"
    if newer(page, result, Path(pages.__file__)):
        print(f"{page}: up to date")
    else:
        print(pages.write_page(result))
