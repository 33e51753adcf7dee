# SPDX-License-Identifier: BSD-2-Clause
"""Runs a scene over its settings that trade accuracy for speed, and says what each costs and errs.

    ricochet tradeoff meshes/two-disks/two-disks.toml
    ricochet tradeoff scene.toml --error 1e-3 --impacts 1000 --counts 50 100 --orders 2 3 4

Kernels: modes (with and without residual flexibility) or vectors fitted to contact, of several sizes, element orders,
eigensolver tolerances and spacings of candidates. Impacts: schemes, steps, precisions. The first product, vectors × scheme ×
step, is run in full; orders, tolerances, spacings and precisions beside the largest of each basis, or with --full in full too.

The error is the largest of those of the exit velocities and of the impulse, against a reference that it computes itself: an
order higher, half the spacing, twice the highest rate, vectors for twice the band (where there is no band, the most modes).
The same with half of that rate tells how far the reference can be trusted. Interrupted and called again it goes on: no finished run is repeated.
"""
import sys
from pathlib import Path

from ricochet import programs
from ricochet.tradeoffs import report
from ricochet.tradeoffs import runs
from ricochet.cli.command_line import Parser
from ricochet.progress import Progress


def arguments():
    parser = Parser(__doc__, "SCENE.toml")
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    axes = parser.add_argument_group("what is varied")
    axes.add_argument("--counts", type=int, nargs="+", help="modes (default: modes.count and down to 1/16 of it, or 25 to 400)")
    axes.add_argument("--fitted", type=float, nargs="*", default=[3e-1, 1e-1, 3e-2, 1e-2, 1e-3],
                      help="flexibility errors of vectors fitted to contact (default: 3e-1 to 1e-3)")
    axes.add_argument("--residual", type=lambda word: word == "with", nargs="+", default=[True, False],
                      metavar="with|without", help="residual flexibility of modes (default: both)")
    axes.add_argument("--schemes", nargs="+", choices=runs.SCHEMES, default=list(runs.SCHEMES), help="(default: all)")
    axes.add_argument("--rates", type=float, nargs="+", default=[1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8],
                      help="factors of time.rate_hz (default: 1/16 to 8)")
    axes.add_argument("--orders", type=int, nargs="+", help="of elements (default: the scene's, one less, one more)")
    axes.add_argument("--tolerances", type=float, nargs="+", default=[1e-8, 1e-4],
                      help="bounds of the eigensolver's residuals (default: 1e-8 1e-4)")
    axes.add_argument("--spacings", type=float, nargs="+", default=[1.0, 0.5, 2.0],
                      help="factors of contact.spacing, if the scene has one (default: 1 1/2 2)")
    axes.add_argument("--precisions", nargs="+", choices=["double", "single"], default=["double", "single"],
                      help="of compliant (default: both)")
    axes.add_argument("--full", action="store_true", help="the whole product")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of the scene")
    parser.add_argument("--band", type=float, help="[Hz] of fitted vectors (default: modes.up_to_hz)")
    parser.add_argument("--measure", nargs="+", choices=["rebound", "impulse", "peak_force"], default=["rebound", "impulse"],
                        help="what the error is of, the largest counts (default: rebound impulse)")
    parser.add_argument("--error", type=float, default=1e-2, help="wanted (default: 1e-2)")
    parser.add_argument("--impacts", type=int, default=1, help="that share the kernels in the total cost (default: 1)")
    parser.add_argument("--ranks", type=int, default=2, help="(default: 2)")
    parser.add_argument("--repeats", type=int, default=3, help="runs of each impact, the fastest counts (default: 3)")
    parser.add_argument("--out", type=Path, help="folder (default: out/tradeoff beside the scene)")
    return parser.parse_args()


def compute(runner, scene, options, bar):
    """The reference's outcome, its own error, and a Point for each setting."""
    vectors = ("contact", 1e-3, True) if scene.band else ("modes", max(options.counts), True)
    finest = runs.Kernel(*vectors, scene.order and scene.order + 1, 1e-8, scene.spacing and scene.spacing / 2,
                         scene.band and 2 * scene.band)
    rate = 2 * max(options.rates) * scene.rate_hz
    bar.advance("kernels of the reference", 0)
    if "refused" in (told := runner.kernel(finest)):
        print(f"tradeoff: the reference is refused: {told['refused']}", file=sys.stderr)
        raise programs.Failed(2)
    reference, coarser = [runner.impact(finest, runs.Impact("compliant", r)) for r in (rate, rate / 2)]
    measured = [f"{measure}_error" for measure in options.measure]
    if not reference["ended"]:
        print("tradeoff: the contact of the reference has not ended: give the scene a longer time.duration", file=sys.stderr)
        raise programs.Failed(2)
    floor = max(report.errors(coarser, reference)[name] for name in measured)
    bar.advance("reference")
    points = []
    for kernel, impacts in runs.study(scene, options):
        known = len(runner.store.rows)
        bar.advance(f"kernels of {kernel.name()}", 0)
        kernel_row = runner.kernel(kernel)
        bar.advance(kernel.name(), already=len(runner.store.rows) == known)
        for impact in impacts:
            known = len(runner.store.rows)
            row = kernel_row if "refused" in kernel_row else runner.impact(kernel, impact)
            points.append(report.Point(kernel, impact, kernel_row, row, reference, options.measure))
            bar.advance(kernel.name(), already=len(runner.store.rows) == known)
    return floor, points


def tell(floor, points, scene, options, folder):
    total = lambda point: point.cost(options.impacts)
    print(f"{len(points)} settings, {sum(bool(point.refused) for point in points)} refused; the reference itself is right "
          f"to about {floor:.1e}")
    print(f"Nothing beats these in error and time, kernels and {options.impacts} impact(s):\n")
    front = report.pareto(points, total, floor)
    for point in front:
        point.row["pareto"] = True
    report.print_front(front, options.impacts)
    best = report.cheapest(points, options.error, total)
    print(f"\nCheapest for an error of {options.error:g}: " +
          (f"{best.name()}: {total(best):.2f} s, error {best.error:.1e}" if best else "none of these"))
    report.print_schemes(points, options.error)
    report.write_csv(points, folder / "tradeoff.csv")
    report.draw(points, floor, options.error, options.impacts, scene.table["title"], folder / "tradeoff.png")
    print(f"\n{folder / 'tradeoff.csv'}\n{folder / 'tradeoff.png'}")


def main():
    options = arguments()
    try:
        scene = runs.Scene(options.scene, options.set, options.band)
        folder = options.out or programs.out_folder(options.scene) / "tradeoff"
        runner = runs.Runner(scene, folder, options.ranks, options.repeats)
        if not options.counts:
            options.counts = [max(1, (scene.table["modes"].get("count") or 400) // part) for part in (16, 8, 4, 2, 1)]
        if not options.orders and scene.order:
            options.orders = [scene.order, max(1, scene.order - 1), scene.order + 1]
        settings = runs.study(scene, options)
        bar = Progress(1 + sum(1 + len(impacts) for _, impacts in settings))
        floor, points = compute(runner, scene, options, bar)
        tell(floor, points, scene, options, folder)
    except programs.Failed as failure:
        return failure.status
    return 0
