# SPDX-License-Identifier: BSD-2-Clause
"""The outcome of a trade-off study as tables, and as a picture of error against cost."""
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ricochet import files
from ricochet.tradeoffs.points import COLUMNS, Cost, Point, cheapest, pareto


def write_csv(points: Sequence[Point], path: Path) -> None:
    ordered = sorted(points, key=lambda point: point.error)
    files.write_csv(path, COLUMNS, [[point.row.get(name, "") for name in COLUMNS] for point in ordered])


def front_table(front: Sequence[Point], impacts: int) -> str:
    """The Pareto front as a table in Markdown."""
    titles = ("setting", "error", "kernels (s)", "memory (MiB)", "steps of an impact (ms)", "all (s)")
    lines = [f"| {' | '.join(titles)} |", "|" + "---|" * len(titles)]
    for point in front:
        row = point.row
        lines.append(
            f"| {point.name()} | {point.error:.1e} | {row['kernel_s']:.1f} | {row['kernel_mib'] or '–'} | "
            f"{1e3 * row['impact_s']:.1f} | {point.cost(impacts):.2f} |"
        )
    return "\n".join(lines)


def scheme_lines(points: Sequence[Point], error: float) -> str:
    """For each scheme, the shortest time of an impact whose error is small enough, without the kernels."""
    best: dict[str, Point | None] = {}
    lines = []
    for scheme in dict.fromkeys(point.impact.scheme for point in points):
        own = [point for point in points if point.impact.scheme == scheme]
        found = best[scheme] = cheapest(own, error, lambda point: point.row["impact_s"])
        least = min(own, key=lambda point: point.error)
        if found:
            time_ms = 1e3 * found.row["impact_s"]
            lines.append(
                f"{scheme}: {time_ms:.2f} ms for all steps ({found.name()}, error {found.error:.1e})"
            )
        elif math.isfinite(least.error):
            lines.append(
                f"{scheme}: does not reach {error:g}; the smallest error is {least.error:.1e} ({least.name()})"
            )
        else:
            lines.append(f"{scheme}: the contact ends with none of the settings")
    cheap = best.get("compliant")
    for scheme, other in best.items():
        if cheap and scheme != "compliant" and other:
            factor = other.row["impact_s"] / cheap.row["impact_s"]
            lines.append(f"compliant is {factor:.0f} times cheaper than {scheme}")
    return "\n".join(lines)


def draw(points: Sequence[Point], floor: float, error: float, impacts: int, title: str, path: Path) -> None:
    from ricochet.pictures.style import in_style  # matplotlib takes long to import

    in_style(_draw)(points, floor, error, impacts, title, path)


def _draw(points: Sequence[Point], floor: float, error: float, impacts: int, title: str, path: Path) -> None:
    from matplotlib.figure import Figure

    fig = Figure(figsize=(11, 4.6), layout="constrained")
    axes = fig.subplots(1, 2, sharey=True)
    shown = [point for point in points if math.isfinite(point.error) and point.error > 0]
    families: dict[str, Callable[[Point], bool]] = {
        "modes and R": lambda p: p.kernel.basis == "modes" and p.kernel.residual_flexibility,
        "modes alone": lambda p: p.kernel.basis == "modes" and not p.kernel.residual_flexibility,
        "contact-adapted": lambda p: p.kernel.basis == "contact",
        "chosen for an accuracy": lambda p: p.kernel.basis == "accuracy",
    }
    colours = {"compliant": "C0", "jump": "C3", "difference": "C1"}
    panels: list[tuple[Any, str, Cost]] = [
        (axes[0], "time of the kernels (s)", lambda p: p.row["kernel_s"]),
        (axes[1], "time of all steps of an impact (s)", lambda p: p.row["impact_s"]),
    ]
    for ax, label, cost in panels:
        for (family, belongs), marker in zip(families.items(), "os^D"):
            for scheme, colour in colours.items():
                own = [p for p in shown if belongs(p) and p.impact.scheme == scheme]
                if own:
                    ax.plot(
                        [cost(p) for p in own],
                        [p.error for p in own],
                        marker,
                        color=colour,
                        ms=7 if marker == "D" else 4,
                        alpha=1 if marker == "D" else 0.6,
                        mec="k",
                        mew=1 if marker == "D" else 0,
                        label=f"{scheme}, {family}",
                    )
        front = pareto(points, cost, floor)
        ax.step(
            [cost(p) for p in front], [p.error for p in front], "k-", where="post", lw=1, label="Pareto front"
        )
        ax.axhline(error, color="0.5", lw=0.8, ls="--")
        ax.axhspan(1e-12, floor, color="0.9", lw=0)
        ax.set(xscale="log", yscale="log", xlabel=label)
    errors_shown = np.array([p.error for p in shown])
    axes[0].set(
        ylabel="relative error",
        ylim=(errors_shown.min() * 0.5, min(errors_shown.max(), 10) * 1.4),
    )
    best = cheapest(points, error, lambda p: p.cost(impacts))
    if best:
        for ax, _, cost in panels:
            ax.plot(cost(best), best.error, "*", color="k", ms=11, mew=0, label=f"cheapest for {error:g}")
    handles, labels = axes[1].get_legend_handles_labels()
    fig.legend(handles, labels, loc="upper center", ncol=4, fontsize=8, bbox_to_anchor=(0.5, 0.0))
    fig.suptitle(f"{title}: error against cost", fontsize=11)
    files.save_picture(fig, path, dpi=110, bbox_inches="tight")
