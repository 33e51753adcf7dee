# SPDX-License-Identifier: BSD-2-Clause
"""The settings of a trade-off study: kernels, impacts, and all combinations of the varied keys."""
import argparse
import itertools
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ricochet import programs

SCHEMES = {
    "compliant": {"contact.scheme": "compliant"},
    "jump": {"contact.scheme": "impulse", "contact.admittance": "jump"},
    "difference": {"contact.scheme": "impulse", "contact.admittance": "difference"},
}


class Scene:
    """A scene with all defaults, from which the settings are derived."""

    def __init__(self, path: Path, settings: list[str], band_hz: float | None) -> None:
        self.path, self.settings = path, settings
        self.text = programs.resolved(path, programs.with_set(settings))
        self.table = table = tomllib.loads(self.text)
        self.meshed = [
            name
            for name, body in table["bodies"].items()
            if not str(body["mesh"]).endswith(".msh") and "area" not in body["material"]
        ]
        self.count = table["modes"].get("count") or 400
        self.order = max((table["bodies"][name].get("order", 3) for name in self.meshed), default=None)
        self.spacing = table["contact"].get("spacing")
        self.rate_hz = table["time"].get("rate_hz", 44100.0)
        self.end = {key: table["time"][key] for key in ("duration", "longest") if key in table["time"]}
        self.band_hz = band_hz or table["modes"].get("up_to_hz")


@dataclass(frozen=True)
class Kernel:
    """The settings of a kernel, with the names of their columns."""

    basis: str  # modes, contact, or accuracy: chosen for it
    size: float  # number of modes, flexibility error of a contact-adapted basis, or accuracy
    residual_flexibility: bool
    order: int | None
    relative_residual: float
    spacing_m: float | None
    band_hz: float | None

    def changes(self, scene: Scene) -> dict[str, Any]:
        found: dict[str, Any] = {"output.view": False, "output.snapshot_every": 0, "output.every": 1000}
        modes: dict[str, Any]
        if self.basis == "accuracy":
            # Without these tables, modes, steps and precision are open.
            return found | {"accuracy": self.size, "modes": {}, "time": scene.end}
        if self.basis == "modes":
            modes = {
                "basis": "modes",
                "count": int(self.size),
                "residual_flexibility": self.residual_flexibility,
                "relative_residual": self.relative_residual,
            }
        else:
            modes = {"basis": "contact", "up_to_hz": self.band_hz, "flexibility_error": self.size}
        found |= {"accuracy": "off", "modes": modes}
        if self.order is not None:
            found |= {f"bodies.{body}.order": self.order for body in scene.meshed}
        if self.spacing_m is not None:
            found["contact.spacing"] = self.spacing_m
        return found

    def name(self) -> str:
        if self.basis == "accuracy":
            return f"chosen for accuracy {self.size:g}"
        if self.basis == "modes":
            size = f"{self.size:g} modes{'' if self.residual_flexibility else ' without R'}"
        else:
            size = f"contact-adapted to {self.size:g}"
        return size + (f", order {self.order}" if self.order is not None else "")


@dataclass(frozen=True)
class Impact:
    """The settings of an impact."""

    scheme: str
    rate_hz: float | None  # None: step and precision are chosen for the accuracy
    precision: str = "double"

    def changes(self) -> dict[str, Any]:
        if self.rate_hz is None:
            return {}
        found: dict[str, Any] = SCHEMES[self.scheme] | {"time.rate_hz": self.rate_hz}
        return found | ({"time.precision": self.precision} if self.precision != "double" else {})


def settings(options: argparse.Namespace, scene: Scene) -> list[tuple[Kernel, list[Impact]]]:
    """All combinations of basis, R, scheme, step and precision. Unless `options.full` is set, order and
    spacing vary only with two bases: the largest number of modes and the first contact-adapted basis. The
    tolerance varies only with the former. Settings that `accuracy` chooses come last. `options`: those of
    ricochet tradeoff."""
    counts = options.counts or [max(1, scene.count // part) for part in (16, 8, 4, 2, 1)]
    bases: list[tuple[str, float, bool]]
    bases = [("modes", count, word == "with") for count in counts for word in options.residual]
    bases += [("contact", error, True) for error in options.fitted if scene.band_hz]
    order, tolerance, spacing, band = scene.order, options.tolerances[0], scene.spacing, scene.band_hz
    orders: list[int | None] = [None]
    if order is not None:
        orders = options.orders or [order, max(1, order - 1), order + 1]
    spacings = [factor * spacing for factor in options.spacings] if spacing else [None]
    kernels: list[Kernel]
    if options.full:
        rest = itertools.product(orders, options.tolerances, spacings)
        kernels = [Kernel(*basis, o, t, s, band) for basis, (o, t, s) in itertools.product(bases, rest)]
    else:
        beside: list[tuple[str, float, bool]] = [("modes", max(counts), True)]
        beside += [basis for basis in bases if basis[0] == "contact"][:1]
        kernels = [Kernel(*basis, order, tolerance, spacing, band) for basis in bases]
        kernels += [Kernel(*basis, o, tolerance, spacing, band) for basis in beside for o in orders]
        kernels += [Kernel(*beside[0], order, t, spacing, band) for t in options.tolerances]
        kernels += [Kernel(*basis, order, tolerance, s, band) for basis in beside for s in spacings]
    impacts = [
        Impact(scheme, scene.rate_hz * factor, precision)
        for scheme in options.schemes
        for factor in options.rates
        for precision in (options.precisions if scheme == "compliant" else ["double"])
    ]
    chosen = [
        (Kernel("accuracy", accuracy, True, None, tolerance, None, None), [Impact("compliant", None)])
        for accuracy in options.accuracies
    ]
    return [(kernel, impacts) for kernel in dict.fromkeys(kernels)] + chosen
