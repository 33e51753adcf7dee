# SPDX-License-Identifier: BSD-2-Clause
"""Runs a scene over the settings that trade accuracy for speed and reports cost and error of each.

    ricochet tradeoff meshes/two-disks/two-disks.toml
    ricochet tradeoff scene.toml --error 1e-3 --impacts 1000 --counts 50 100 --orders 2 3 4

Kernels vary in their basis (modes, with and without residual flexibility, or a contact-adapted basis), its size, element order,
tolerance of the eigensolver and spacing of candidates; impacts vary in scheme, time step and precision. Basis × scheme × step is
run in full; orders, tolerances, spacings and precisions only with the largest kernel of each basis, or with --full in full too.

The error is the largest relative error of the exit velocities and the impulse. The reference is computed as well: an order
higher, half the spacing, twice the highest rate, and a contact-adapted basis for twice the band (without a band: the most
modes). The same with half of that rate shows the error of the reference itself. After an interruption the same command resumes
the work.
"""
import argparse
from pathlib import Path

from ricochet import programs
from ricochet.cli.options import add_ranks, add_scene, count, say, writing
from ricochet.progress import Progress
from ricochet.tradeoffs import report
from ricochet.tradeoffs.points import Point, cheapest, pareto
from ricochet.tradeoffs.runs import Outcome, Runner
from ricochet.tradeoffs.settings import SCHEMES, Axes, Scene


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_scene(parser)
    parser.add_argument("--out", type=Path, metavar="DIR", help="default: out/tradeoff beside the scene")
    add_ranks(parser)
    parser.add_argument(
        "--repeats",
        type=count,
        default=3,
        metavar="N",
        help="runs of each impact; the fastest counts (default: 3)",
    )
    goal = parser.add_argument_group("goal")
    goal.add_argument(
        "--error", type=float, default=1e-2, metavar="X", help="wanted relative error (default: 1e-2)"
    )
    goal.add_argument(
        "--impacts",
        type=count,
        default=1,
        metavar="N",
        help="impacts that share the cost of the kernels (default: 1)",
    )
    goal.add_argument(
        "--measure",
        nargs="+",
        choices=["rebound", "impulse", "peak_force"],
        default=["rebound", "impulse"],
        metavar="NAME",
        help="quantities of interest, of rebound, impulse, peak_force; the largest error counts (default: rebound impulse)",
    )
    axes = parser.add_argument_group("settings that are varied")
    axes.add_argument(
        "--counts",
        type=count,
        nargs="+",
        metavar="N",
        help="modes (default: modes.count down to 1/16 of it, or 400 to 25)",
    )
    axes.add_argument(
        "--fitted",
        type=float,
        nargs="*",
        default=[3e-1, 1e-1, 3e-2, 1e-2, 1e-3],
        metavar="X",
        help="flexibility errors of contact-adapted bases (default: 3e-1 to 1e-3)",
    )
    axes.add_argument(
        "--band", type=float, metavar="HZ", help="band of contact-adapted bases (default: modes.up_to_hz)"
    )
    axes.add_argument(
        "--residual",
        choices=["with", "without"],
        nargs="+",
        default=["with", "without"],
        metavar="with|without",
        help="residual flexibility of modes (default: both)",
    )
    axes.add_argument(
        "--orders", type=count, nargs="+", metavar="N", help="element orders (default: that of the scene ± 1)"
    )
    axes.add_argument(
        "--tolerances",
        type=float,
        nargs="+",
        default=[1e-8, 1e-4],
        metavar="X",
        help="bounds of the eigensolver's residuals (default: 1e-8 1e-4)",
    )
    axes.add_argument(
        "--spacings",
        type=float,
        nargs="+",
        default=[1.0, 0.5, 2.0],
        metavar="X",
        help="factors of contact.spacing, if the scene has one (default: 1 1/2 2)",
    )
    axes.add_argument(
        "--schemes",
        nargs="+",
        choices=SCHEMES,
        default=list(SCHEMES),
        metavar="NAME",
        help=f"of {', '.join(SCHEMES)} (default: all)",
    )
    axes.add_argument(
        "--rates",
        type=float,
        nargs="+",
        default=[1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8],
        metavar="X",
        help="factors of time.rate_hz (default: 1/16 to 8)",
    )
    axes.add_argument(
        "--precisions",
        nargs="+",
        choices=["double", "single"],
        default=["double", "single"],
        metavar="double|single",
        help="of the compliant scheme (default: both)",
    )
    axes.add_argument("--full", action="store_true", help="run the whole product")


def tell(outcome: Outcome, options: argparse.Namespace, title: str, folder: Path) -> None:
    def total(point: Point) -> float:
        return point.cost(options.impacts)

    points, floor = outcome.points, outcome.floor
    refused = sum(bool(point.refused) for point in points)
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
        axes = Axes.of(options, scene)
        bar = Progress(1 + sum(1 + len(impacts) for _, impacts in axes.settings(scene)))
        tell(runner.compare(axes, options.measure, bar), options, scene.table["title"], folder)
