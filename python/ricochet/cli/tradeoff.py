# SPDX-License-Identifier: BSD-2-Clause
"""Runs a scene with settings that trade accuracy for speed, and reports the cost and error of each.

    ricochet tradeoff meshes/two-disks/two-disks.toml
    ricochet tradeoff scene.toml --error 1e-3 --impacts 1000 --counts 50 100 --orders 2 3 4

Kernels vary in their basis (modes, with and without residual flexibility, or a contact-adapted basis), its size, element order,
tolerance of the eigensolver and spacing of candidates. Impacts vary in scheme, time step and precision. All combinations of basis,
scheme, step and precision are run. Unless --full is given, orders and spacings vary only with two bases, the largest number of
modes and the first of --fitted, and tolerances only with the former. Beside them, the scene is run without its settings of modes
and steps, which `accuracy` then chooses; its time includes the pilot, all rounds and the estimates.

The error is the largest relative error of the exit velocities and the impulse. The reference is computed too, with elements of the
next higher order, half the spacing, twice the highest rate, and a contact-adapted basis for twice the band (without a band: the
largest number of modes). A second run at half of that rate shows the error of the reference itself. After an interruption, the same
command resumes the work.
"""
import argparse
from collections.abc import Callable
from pathlib import Path

from ricochet import programs
from ricochet.cli.options import add_count, add_out, add_ranks, add_scene, count, say, writing
from ricochet.tradeoffs import report
from ricochet.tradeoffs.points import Point, cheapest, pareto
from ricochet.tradeoffs.runs import Outcome, Runner
from ricochet.tradeoffs.settings import SCHEMES, Scene


# Option, type of its values, default (text if it depends on the scene) and meaning.
NUMBERS: list[tuple[str, Callable[[str], float], list[float] | str, str]] = [
    ("--counts", count, "modes.count down to 1/16 of it, or 400 to 25", "modes"),
    ("--fitted", float, [0.3, 0.1, 0.03, 0.01, 0.001], "flexibility errors of contact-adapted bases"),
    ("--orders", count, "that of the scene ± 1", "element orders"),
    ("--tolerances", float, [1e-8, 1e-4], "bounds of the eigensolver's residuals"),
    ("--accuracies", float, [1e-1, 1e-2, 1e-3], "values of accuracy, which then chooses what is open"),
    ("--spacings", float, [1.0, 0.5, 2.0], "factors of contact.spacing, if the scene has one"),
    ("--rates", float, [1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8], "factors of time.rate_hz"),
]
NAMES = [
    ("--residual", ["with", "without"], "residual flexibility of modes"),
    ("--schemes", list(SCHEMES), "schemes"),
    ("--precisions", ["double", "single"], "precisions of the compliant scheme"),
]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    add_out(parser, "folder of kernels, table and picture", "out/tradeoff beside the scene")
    add_ranks(parser)
    add_count(parser, "--repeats", 3, "runs of each impact, of which the fastest counts")
    goal = parser.add_argument_group("goal")
    goal.add_argument(
        "--error", type=float, default=1e-2, metavar="X", help="wanted relative error (default: 1e-2)"
    )
    add_count(goal, "--impacts", 1, "impacts that share the cost of the kernels")
    goal.add_argument(
        "--measure",
        nargs="+",
        choices=["rebound", "impulse", "peak_force"],
        default=["rebound", "impulse"],
        metavar="NAME",
        help="quantities of interest, of rebound, impulse, peak_force; the largest error counts "
        "(default: rebound impulse)",
    )
    axes = parser.add_argument_group("settings that are varied")
    axes.add_argument(
        "--band", type=float, metavar="HZ", help="band of contact-adapted bases (default: modes.up_to_hz)"
    )
    for option, kind, default, text in NUMBERS:
        values = None if isinstance(default, str) else default
        shown = default if values is None else " ".join(map(str, values))
        many, metavar = "*" if option in ("--fitted", "--accuracies") else "+", "N" if kind is count else "X"
        text = f"{text} (default: {shown})"
        axes.add_argument(option, type=kind, nargs=many, default=values, metavar=metavar, help=text)
    for option, names, text in NAMES:
        text = f"{text}: {', '.join(names)} (default: all)"
        axes.add_argument(option, choices=names, nargs="+", default=names, metavar="NAME", help=text)
    axes.add_argument("--full", action="store_true", help="run the whole product")


def print_outcome(outcome: Outcome, options: argparse.Namespace, title: str, folder: Path) -> None:
    def total(point: Point) -> float:
        return point.cost(options.impacts)

    points, floor = outcome.points, outcome.floor
    refused = sum(point.refused for point in points)
    say(f"{len(points)} settings, {refused} refused; the error of the reference itself is about {floor:.1e}")
    say(
        f"No other setting has both a smaller error and a shorter time for kernels and {options.impacts} impact(s):\n"
    )
    front = pareto(points, total, floor)
    for point in front:
        point.row["pareto"] = True
    say(report.front_table(front, options.impacts))
    best = cheapest(points, options.error, total)
    found = f"{best.name()}: {total(best):.2f} s, error {best.error:.1e}" if best else "none of these"
    say(f"\nCheapest for an error of {options.error:g}: {found}")
    say(report.scheme_lines(points, options.error))
    report.write_csv(points, folder / "tradeoff.csv")
    report.draw(points, floor, options.error, options.impacts, title, folder / "tradeoff.png")
    say(f"\n{folder / 'tradeoff.csv'}\n{folder / 'tradeoff.png'}")


def run(options: argparse.Namespace) -> None:
    scene = Scene(options.scene, options.set, options.band)
    folder = options.out or programs.out_folder(options.scene) / "tradeoff"
    with writing(folder):
        runner = Runner(scene, folder, options.ranks, options.repeats)
        print_outcome(runner.compare(options), options, scene.table["title"], folder)
