# SPDX-License-Identifier: BSD-2-Clause
"""Takes a scene from mesh to pictures: kernels, impact, figures, page. Skips files that are up to date.

    ricochet run meshes/two-disks/two-disks.toml
    ricochet run -n 4 meshes/two-disks/two-disks.toml --set title=fast --set 'bodies.upper.velocity=[0,-6,0]'

The options --set, --accuracy and --out are those of ricochet-kernel and ricochet-contact.
"""
import argparse
import tomllib
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.cli import plot
from ricochet.cli.options import add_low_pass, add_run, words_for_programs


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_run(parser, "kernels, results and pictures")
    add_low_pass(parser)
    text = "write the scene with the settings that were chosen for its accuracy"
    parser.add_argument("--write-scene", type=Path, metavar="FILE.toml", help=text)


def newer(target: Path, *sources: Path) -> bool:
    """Whether `target` exists and no source has changed since it was written."""
    return target.exists() and all(source.stat().st_mtime <= target.stat().st_mtime for source in sources)


def alike(stored: str, scene: dict[str, Any]) -> bool:
    """Whether the scene of a result is this one, with the rate and precision that may be chosen for its accuracy."""
    known = tomllib.loads(stored)
    if "accuracy" in scene:
        time = known.get("time", {})
        for key in {"rate_hz", "contact_rate_hz", "precision"} - set(scene.get("time", {})):
            time.pop(key, None)
    return known == scene


def current(result: Path, scene: dict[str, Any]) -> bool:
    """Whether the result file is complete and belongs to this resolved scene, these kernels and this program."""
    import h5py

    if not result.exists() or not Path(str(result).removesuffix(".result.h5") + ".summary.json").exists():
        return False
    try:
        with h5py.File(result) as file:
            kernels = [result.parent / group.attrs["kernel"].decode() for group in file["bodies"].values()]
            same = alike(file.attrs["scene"].decode(), scene)
    except (OSError, KeyError, AttributeError, TypeError, ValueError):  # not a result of ricochet-contact
        return False
    return same and newer(result, programs.BIN / "ricochet-contact", *kernels)


def run(options: argparse.Namespace) -> None:
    words = words_for_programs(options)
    out = programs.out_folder(options.scene, options.out)
    table = tomllib.loads(programs.resolved(options.scene, words))
    slug = programs.slug(table["title"])
    from ricochet import pages, pictures  # takes a second, and refusals of the scene come before

    programs.kernel(options.scene, words, options.ranks)
    result = out / f"{slug}.result.h5"
    table = tomllib.loads(programs.resolved(options.scene, words))  # with settings chosen for its accuracy
    wanted = ["--write-scene", options.write_scene] if options.write_scene else []
    if not wanted and current(result, table):
        print(f"{result}: up to date")
    else:
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
