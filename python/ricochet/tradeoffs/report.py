# SPDX-License-Identifier: BSD-2-Clause
"""What ricochet tradeoff tells: errors, the settings that nothing beats, the cheapest for an error, table and picture."""
import csv
import io
import math

import numpy as np

from ricochet import files

COLUMNS = ["basis", "size", "residual_flexibility", "order", "relative_residual", "spacing_m", "scheme", "rate_hz", "precision",
           "vectors", "candidates", "kernel_s", "kernel_mib", "impact_s", "impact_mib", "rebound_error", "impulse_error",
           "peak_force_error", "error", "pareto", "refused"]


def errors(row, reference):
    """Of the exit velocities (against the largest one of the reference), the impulse and the peak force. Infinite where the
    contact has not ended."""
    speed = max(math.hypot(*v) for v in reference["exit_velocity"].values())
    worst = math.inf
    if row["ended"] and set(row["exit_velocity"]) == set(reference["exit_velocity"]):
        worst = max(math.dist(v, reference["exit_velocity"][body]) for body, v in row["exit_velocity"].items()) / speed
    return {"rebound_error": worst, "impulse_error": abs(row["impulse_ns"] / reference["impulse_ns"] - 1),
            "peak_force_error": abs(row["peak_force_n"] / reference["peak_force_n"] - 1)}


class Point:
    """One setting with its cost and error."""

    def __init__(self, kernel, impact, kernel_row, impact_row, reference, measures):
        self.kernel, self.impact, self.refused = kernel, impact, impact_row.get("refused")
        self.row = {"basis": kernel.basis, "size": kernel.size, "residual_flexibility": kernel.residual,
                    "order": kernel.order, "relative_residual": kernel.tolerance, "spacing_m": kernel.spacing,
                    "scheme": impact.scheme, "rate_hz": impact.rate_hz, "precision": impact.precision,
                    "kernel_s": kernel_row["kernel_s"], "kernel_mib": kernel_row.get("kernel_mib"),
                    "refused": self.refused or "", "pareto": False}
        self.error = math.inf
        if not self.refused:
            found = errors(impact_row, reference)
            self.row |= found | {name: impact_row[name] for name in ["vectors", "candidates", "impact_s", "impact_mib"]}
            self.error = max(found[f"{measure}_error"] for measure in measures)
        self.row["error"] = self.error

    def cost(self, impacts):
        return self.row["kernel_s"] + impacts * self.row["impact_s"]

    def name(self):
        return f"{self.kernel.name()}, {self.impact.scheme} at {self.impact.rate_hz:g} Hz" + \
            (", single" if self.impact.precision == "single" else "")


def pareto(points, cost, floor):
    """Those that no other one beats in both cost and error, by rising cost. Errors below `floor` can't be told apart."""
    front, least = [], math.inf
    for point in sorted((p for p in points if math.isfinite(p.error)), key=lambda p: (cost(p), p.error)):
        if max(point.error, floor) < least:
            front.append(point)
            least = max(point.error, floor)
    return front


def cheapest(points, error, cost):
    fit = [point for point in points if point.error <= error]
    return min(fit, key=cost) if fit else None


def write_csv(points, path):
    file = io.StringIO(newline="")
    table = csv.DictWriter(file, COLUMNS)
    table.writeheader()
    for point in sorted(points, key=lambda p: p.error):
        table.writerow(point.row)
    files.write(path, file.getvalue().encode())


def print_front(front, impacts):
    print("| setting | error | kernels (s) | memory (MiB) | steps of an impact (ms) | all (s) |\n|---|---|---|---|---|---|")
    for point in front:
        row = point.row
        print(f"| {point.name()} | {point.error:.1e} | {row['kernel_s']:.1f} | {row['kernel_mib'] or '–'} | "
              f"{1e3 * row['impact_s']:.1f} | {point.cost(impacts):.2f} |")


def print_schemes(points, error):
    """The least impact time of each scheme for the error, kernels left aside."""
    best = {}
    for scheme in dict.fromkeys(point.impact.scheme for point in points):
        own = [point for point in points if point.impact.scheme == scheme]
        best[scheme] = cheapest(own, error, lambda p: p.row["impact_s"])
        if best[scheme]:
            print(f"{scheme}: {1e3 * best[scheme].row['impact_s']:.2f} ms for all steps ({best[scheme].name()}, error "
                  f"{best[scheme].error:.1e})")
        else:
            least = min(own, key=lambda p: p.error)
            print(f"{scheme}: does not come to {error:g}; the least error is {least.error:.1e} ({least.name()})" if
                  math.isfinite(least.error) else f"{scheme}: no setting lets the contact end")
    own = best.get("compliant")
    for scheme, point in best.items():
        if own and scheme != "compliant" and point:
            print(f"compliant is {point.row['impact_s'] / own.row['impact_s']:.0f} times cheaper than {scheme}")


def draw(points, floor, error, impacts, title, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(1, 2, figsize=(11, 4.6), sharey=True, constrained_layout=True)
    shown = [point for point in points if math.isfinite(point.error) and point.error > 0]
    families = {"modes and R": lambda p: p.kernel.basis == "modes" and p.kernel.residual,
                "modes alone": lambda p: p.kernel.basis == "modes" and not p.kernel.residual,
                "fitted to contact": lambda p: p.kernel.basis == "contact"}
    colours = {"compliant": "C0", "jump": "C3", "difference": "C1"}
    panels = [(axes[0], "time of the kernels (s)", lambda p: p.row["kernel_s"]),
              (axes[1], "time of all steps of an impact (s)", lambda p: p.row["impact_s"])]
    for ax, label, cost in panels:
        for (family, belongs), marker in zip(families.items(), "os^"):
            for scheme, colour in colours.items():
                own = [p for p in shown if belongs(p) and p.impact.scheme == scheme]
                if own:
                    ax.plot([cost(p) for p in own], [p.error for p in own], marker, color=colour, ms=4, alpha=0.6,
                            mew=0, label=f"{scheme}, {family}")
        front = pareto(points, cost, floor)
        ax.step([cost(p) for p in front], [p.error for p in front], "k-", where="post", lw=1, label="Pareto front")
        ax.axhline(error, color="0.5", lw=0.8, ls="--")
        ax.axhspan(1e-12, floor, color="0.9", lw=0)
        ax.set(xscale="log", yscale="log", xlabel=label)
        ax.grid(True, which="major", lw=0.3)
    errors_shown = np.array([p.error for p in shown])
    axes[0].set(ylabel="relative error", ylim=(min(errors_shown.min(), floor) * 0.7, min(errors_shown.max(), 10) * 1.4))
    best = cheapest(points, error, lambda p: p.cost(impacts))
    if best:
        for ax, _, cost in panels:
            ax.plot(cost(best), best.error, "*", color="k", ms=11, mew=0, label=f"cheapest for {error:g}")
    handles, labels = axes[1].get_legend_handles_labels()
    fig.legend(handles, labels, loc="upper center", ncol=4, fontsize=8, bbox_to_anchor=(0.5, 0.0))
    fig.suptitle(f"{title}: error against cost", fontsize=11)
    files.save_picture(fig, path, dpi=110, bbox_inches="tight")
