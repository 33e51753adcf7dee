# SPDX-License-Identifier: BSD-2-Clause
"""Small scenes for scripts/verify --extremes, and functions that run them."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import programs
import scenes

BLOCK_GEO = """
DefineConstant[a = 1, b = 1, c = 1, x = 0, y = 0, z = 0, nx = 2, ny = 2, nz = 2, copies = 1];
SetFactory("Built-in");
For k In {1 : copies}
  p = newp; l = newl; s = news;
  left = x + 3 * (k - 1) * a;
  Point(p) = {left, y, z}; Point(p + 1) = {left + a, y, z};
  Point(p + 2) = {left + a, y + b, z}; Point(p + 3) = {left, y + b, z};
  Line(l) = {p, p + 1}; Line(l + 1) = {p + 1, p + 2}; Line(l + 2) = {p + 2, p + 3}; Line(l + 3) = {p + 3, p};
  Transfinite Curve{l, l + 2} = nx + 1; Transfinite Curve{l + 1, l + 3} = ny + 1;
  Curve Loop(1000 + k) = {l : l + 3}; Plane Surface(s) = {1000 + k};
  Transfinite Surface{s}; Recombine Surface{s};
  block[] = Extrude {0, 0, c} { Surface{s}; Layers{nz}; Recombine; };
  foot[k] = s; top[k] = block[0]; volume[k] = block[1];
EndFor
Physical Volume("block") = {volume[]};
Physical Surface("foot") = {foot[]};
Physical Surface("top") = {top[]};
"""

# A cube of side 1 with √(E/ρ) = 1 that hits the floor at a hundredth of this speed.
BLOCK = scenes.block_on_floor(
    "Block",
    "count = 30",
    "",
    "rate_hz = 100.0\nduration = 10.0",
    "material = { density = 1.0, young = 1.0, poisson = 0.3 }\nvelocity = [0, 0, -0.01]",
)

# Rods of length 10 with c = 1 and Z = ρcA = 1: contact lasts 2L/c = 20.
RODS = scenes.two_rods("Rods", "count = 100", "rate_hz = 100.0\nduration = 30.0", length=10)


@dataclass
class Row:
    case: str
    oracle: str
    bound: float
    found: float


class Unexpected(Exception):
    """A program ended in an unexpected way."""


class Bench:
    """Runs scenes in a separate folder."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.number = 0
        for name, text in (
            ("block.geo", BLOCK_GEO),
            ("block.toml", BLOCK),
            ("rod.geo", scenes.rod(10, 100)),
            ("rods.toml", RODS),
        ):
            (self.folder / name).write_text(text)

    def fresh(self):
        """A new folder without kernels, so that no kernel is derived from another."""
        self.number += 1
        return self.folder / f"out-{self.number}"

    def kernel(self, scene, out, *sets, ranks=1):
        return self.ended(programs.kernel, scene, out, *sets, ranks=ranks)

    def contact(self, scene, out, *sets):
        return self.ended(programs.contact, scene, out, *sets)

    def ended(self, program, scene, out, *sets, **more):
        """The end of a program, which may not hang. A crash must not end the other cases, so it has a process of its own."""
        try:
            return program(self.folder / scene, out, *sets, **more)
        except subprocess.TimeoutExpired:
            raise Unexpected("hangs") from None

    def impact(self, scene, *sets, out=None, ranks=1):
        """The summary of the impact. Kernels in `out` are reused if they fit."""
        out = out or self.fresh()
        run = self.contact(scene, out, *sets) if out.exists() else None
        if run is None or "no kernel for body" in run.err:
            run = self.kernel(scene, out, *sets, ranks=ranks)
            if run.status == 0:
                run = self.contact(scene, out, *sets)
        if run.status != 0:
            raise Unexpected(f"status {run.status}: {run.err.strip()}")
        (path,) = out.glob("*.summary.json")
        return json.loads(path.read_text())

    def body(self, scene, *sets, out=None, ranks=1):
        """Computes the kernel of a scene and returns its path."""
        out = out or self.fresh()
        run = self.kernel(scene, out, *sets, ranks=ranks)
        if run.status != 0:
            raise Unexpected(f"status {run.status}: {run.err.strip()}")
        return max(out.glob("*.kernel.h5"), key=lambda path: path.stat().st_mtime_ns)

    def refusal(self, scene, *sets, out=None, ranks=1):
        """The error line of the first program that refuses the input. Raises Unexpected unless there is one line
        and status 2."""
        out = out or self.fresh()
        for run in (self.kernel(scene, out, *sets, ranks=ranks), self.contact(scene, out, *sets)):
            if run.status == 0:
                continue
            lines = [line for line in run.err.split("-----")[0].splitlines() if line.strip()]
            if run.status != 2 or len(lines) != 1:
                raise Unexpected(f"status {run.status}, {len(lines)} lines: {run.err.strip()}")
            return lines[0]
        raise Unexpected("is not refused")


# ---- Comparisons ----

SAME = {"contact_end_s": 1, "peak_force_n": 1, "impulse_ns": 1, "restitution": 1}


def relative(found, expected):
    return abs(found / expected - 1)


def departure(summary, reference, units):
    """Largest relative difference between the figures of two impacts that are in different units."""
    return max(relative(summary[key] / unit, reference[key]) for key, unit in units.items())


def balance(summary, mass=1.0, speed=0.01):
    """Errors of an impact on the floor in its ledger and its momentum, whichever is larger."""
    away = summary["exit_velocity"]["block"][2]
    return max(relative(summary["impulse_ns"], mass * (speed + away)), summary["energy_drift"])


def velocity(value):
    return f"bodies.block.velocity=[0,0,{-value!r}]"
