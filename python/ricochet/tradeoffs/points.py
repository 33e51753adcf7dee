# SPDX-License-Identifier: BSD-2-Clause
"""Points of a trade-off study: settings with their cost and error, and the best of them."""
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict

from ricochet import quantities
from ricochet.studies.records import Row
from ricochet.tradeoffs.settings import Impact, Kernel

COLUMNS = [
    "basis",
    "size",
    "residual_flexibility",
    "order",
    "relative_residual",
    "spacing_m",
    "scheme",
    "rate_hz",
    "precision",
    "vectors",
    "candidates",
    "kernel_s",
    "kernel_mib",
    "impact_s",
    "impact_mib",
    "rebound_error",
    "impulse_error",
    "peak_force_error",
    "error",
    "pareto",
    "refused",
]


def errors(row: Row, reference: Row) -> dict[str, float]:
    """Relative errors of rebound, impulse and peak force. That of the rebound is infinite if the contact has
    not ended."""
    found = quantities.errors(row, reference)
    if not row["ended"]:
        found["rebound"] = math.inf
    return {f"{name}_error": found[name] for name in ("rebound", "impulse", "peak_force")}


class Point:
    """A setting with its cost and error."""

    def __init__(
        self,
        kernel: Kernel,
        impact: Impact,
        kernel_row: Row,
        impact_row: Row,
        reference: Row,
        measures: Iterable[str],
    ) -> None:
        self.kernel, self.impact, self.refused = kernel, impact, "refused" in impact_row
        self.row = asdict(kernel) | asdict(impact) | kernel_row | impact_row | {"pareto": False}
        self.error = math.inf
        if not self.refused:
            found = errors(impact_row, reference)
            self.row |= found
            self.error = max(found[f"{measure}_error"] for measure in measures)
        self.row["error"] = self.error

    def cost(self, impacts: int) -> float:
        """Time of the kernels and of `impacts` impacts [s]."""
        return self.row["kernel_s"] + impacts * self.row["impact_s"]

    def name(self) -> str:
        if self.impact.rate_hz is None:
            return self.kernel.name()
        return f"{self.kernel.name()}, {self.impact.scheme} at {self.impact.rate_hz:g} Hz" + (
            ", single" if self.impact.precision == "single" else ""
        )


Cost = Callable[[Point], float]


def pareto(points: Sequence[Point], cost: Cost, floor: float) -> list[Point]:
    """Points for which no other point has both a lower cost and a lower error, by rising cost. Errors below
    `floor` count as equal."""
    front: list[Point] = []
    least = math.inf
    for point in sorted((p for p in points if math.isfinite(p.error)), key=lambda p: (cost(p), p.error)):
        if max(point.error, floor) < least:
            front.append(point)
            least = max(point.error, floor)
    return front


def cheapest(points: Sequence[Point], error: float, cost: Cost) -> Point | None:
    fit = [point for point in points if point.error <= error]
    return min(fit, key=cost) if fit else None
