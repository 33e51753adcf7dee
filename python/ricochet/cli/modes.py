# SPDX-License-Identifier: BSD-2-Clause
"""Lists the modes of the bodies of a scene and computes missing kernels. The scene needs no [contact] and no [time].

    ricochet modes meshes/two-disks/two-disks.toml
    ricochet modes bell.toml --set modes.up_to_hz=5000 --csv bell.csv --plot
    ricochet modes bell.toml --page
    ricochet modes bell.toml --verify

Columns: frequency, damping ratio, effective mass along each axis as a share of the mass of the body, and the share of the mode in
the static flexibility of the contact. Effective masses of all modes of a free body add up to its mass. The CSV file also
contains participation factors and effective masses in SI units.
"""
import argparse
import sys
import tomllib
from collections.abc import Container
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.cli.options import add_count, add_run, words_for_programs
from ricochet.errors import InputError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_run(parser, "kernels and pictures")
    add_count(parser, "--first", 20, "modes that are printed")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write all modes of all bodies")
    parser.add_argument(
        "--plot",
        action="store_true",
        help="draw the first elastic modes as <body>-modes.png; sets output.view = true",
    )
    parser.add_argument(
        "--page",
        action="store_true",
        help="write <slug>.modes.html, on which the first 20 modes of each body are seen in motion; sets output.view = true",
    )
    parser.add_argument(
        "--verify",
        action="store_true",
        help="count the modes of the stored kernels again, with matrices assembled from the mesh, and stop",
    )


def verify(options: argparse.Namespace) -> None:
    """Counts the modes of the stored kernels again. Raises SolverError if a count differs."""
    launcher = programs.mpirun(options.ranks) if options.ranks > 1 else []
    words = words_for_programs(options)
    print(
        programs.call(
            [*launcher, programs.kernel_program(), options.scene, "--verify", *words], capture=True
        ),
        end="",
    )


def stored(options: argparse.Namespace) -> dict[str, Path]:
    """The kernels of all bodies that are stored, by body; empty if one is missing, or if the accuracy of the scene
    asks for settings that nothing has chosen yet."""
    from ricochet.scene import Scene

    scene = Scene(options.scene)
    accuracy = [f"accuracy={options.accuracy}"] if options.accuracy else []
    if changes := [*options.set, *accuracy]:
        scene._load(changes)
    found = scene._core.kernel_files(programs.out_folder(options.scene, options.out))
    return {body: path for body, path, _ in found} if all(there for *_, there in found) else {}


def computed(
    options: argparse.Namespace, words: list[programs.Word], bodies: Container[str]
) -> dict[str, Path]:
    """The kernels that ricochet-kernel leaves, by body."""
    launcher = programs.mpirun(options.ranks) if options.ranks > 1 else []
    report = programs.call([*launcher, programs.kernel_program(), options.scene, *words], capture=True)
    out = programs.out_folder(options.scene, options.out)
    found: dict[str, Path] = {}
    for line in report.splitlines():
        body, _, rest = line.partition(": ")
        path = out / rest.rpartition("/")[2]
        # With an accuracy, lines of several rounds: the last kernel that was kept is the one of the settings.
        if body in bodies and path.name.endswith(".kernel.h5") and path.is_file():
            found[body] = path
    return found


def kernels(options: argparse.Namespace) -> tuple[list[Path], dict[str, Any]]:
    """Computes missing kernels. Returns the kernel files of all bodies, in the order of the scene, and the resolved
    scene."""
    options.set = [*options.set, *(["output.view=true"] if options.plot or options.page else [])]
    words = words_for_programs(options)
    scene = tomllib.loads(programs.resolved(options.scene, words, programs.kernel_program()))
    bodies = scene.get("bodies", {})
    if not bodies:
        raise InputError(
            f"{options.scene}: takes its responses from contact.table: there are no bodies with modes"
        )
    found = stored(options) or computed(options, words, bodies)
    return [found[body] for body in bodies if body in found], scene


def run(options: argparse.Namespace) -> None:
    if options.verify:
        verify(options)
        return
    found, scene = kernels(options)
    from ricochet.modal_table import ModalTable, write_csv  # slow to import: refusals come before

    tables = [ModalTable.read(kernel) for kernel in found]
    print("\n\n".join(table.text(options.first) for table in tables))
    if options.csv:
        write_csv(tables, options.csv)
        print(options.csv)
    if options.plot:
        from ricochet.pictures import draw_modes

        for table, kernel in zip(tables, found):
            if path := draw_modes(kernel, kernel.parent):
                print(path)
            else:
                print(f"ricochet modes: no picture of {table.body}: it has no elastic modes", file=sys.stderr)
    if options.page:
        from ricochet.pages.modes import write_modes_page

        title = scene.get("title") or options.scene.stem
        path = found[0].parent / f"{programs.slug(title)}.modes.html"
        print(write_modes_page(title, found, scene, path))
