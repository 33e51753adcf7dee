# SPDX-License-Identifier: BSD-2-Clause
"""Times of single contact problems with friction, solved cold by the library and by Siconos.

    scripts/bench friction           # medians of 5 rounds; python3-siconos comes with scripts/setup --tests
    scripts/bench friction --impact meshes/oblique/oblique.toml   # steps of an impact instead
    scripts/bench friction --slide                                # steps of a box that slides instead

The problems are steps of two plates that rub on each other (benchmarks/plates.hpp), written by --fclib: for each
size the one in which most points slip. Siconos' methods are nonsmooth Gauss-Seidel (NSGS) and the Newton method
of Alart and Curnier (NSN_AC); each is given the largest tolerance, in powers of ten, at which its residual is
not above the library's, or else the smallest one. The residual of all is that of the projection on the cones,
in units of the mean flexibility, over |q|. Run scripts/build first.

With --impact, every 8th contact step of the scene is solved in turn by both Newton methods, from no forces, NSN_AC with the
largest tolerance that leaves forces within 1e-6 of ours. The table shows means over the steps and the largest
difference of forces.

With --slide, a steel box slides on its face, or rests on it, with and without friction in turn. The table shows
processor times: the median step, the mean with the first contact, and the slowest step.
"""
import json
import pathlib
import statistics
import tempfile
import time

import h5py
import numpy as np

from benchmarks import launch, tables, timing
from ricochet import errors, programs

SIDES = (3, 6, 10, 17)
MODES = 200  # of each plate
NEWTON = "NSN_AC"
METHODS = {"NSGS": 100000, NEWTON: 1000}  # most iterations
COLUMNS = [
    ("points", "points", ""),
    ("sticking", "sticking", ""),
    ("slipping", "slipping", ""),
    ("method", "method", ""),
    ("residual", "residual", ".1e"),
    ("ms", lambda row: row["seconds"] and 1e3 * row["seconds"], ".3f"),
    ("x ours", "ratio", ".2f"),
]
IMPACT_COLUMNS = [
    ("points", "points", ""),
    ("steps", "steps", ""),
    ("method", "method", ""),
    ("forces differ, of the peak", "difference", ".1e"),
    ("ms a step", lambda row: 1e3 * row["seconds"] / row["steps"], ".2f"),
    ("x ours", "ratio", ".2f"),
]
SLIDE_COLUMNS = [
    ("motion", "motion", ""),
    ("rate (kHz)", lambda row: row["rate"] / 1e3, ".1f"),
    ("friction", "friction", ".1f"),
    ("touching", "touching", ".0f"),
    ("median (ms)", lambda row: 1e3 * row["median"], ".2f"),
    ("mean", lambda row: 1e3 * row["mean"], ".2f"),
    ("slowest", lambda row: 1e3 * row["slowest"], ".1f"),
    ("x frictionless", "ratio", ".1f"),
    ("factors a step", "renewals", ".2f"),
]
# Points along both sides of the box less one, speed [m/s], rate [Hz].
SLIDES = (
    ("slides", (16, 17), 0.1, 44100.0),
    ("slides", (16, 17), 0.1, 200e3),
    ("rests", (13, 13), 0.0, 44100.0),
    ("rests", (19, 19), 0.0, 44100.0),
)
SLIDE_STEPS = 200


def add_arguments(parser):
    parser.add_argument(
        "--impact", type=pathlib.Path, metavar="SCENE", help="steps of this scene instead of plates"
    )
    parser.add_argument("--slide", action="store_true", help="steps of a box that slides instead of plates")
    parser.add_argument(
        "--mu", type=float, default=0.3, help="coefficient of friction of the plates (default: 0.3)"
    )
    parser.add_argument("--rounds", type=int, default=5, help="runs of each, alternating (default: 5)")


class Problem:
    """A file of FCLIB, in units of the mean flexibility."""

    def __init__(self, path):
        self.path = path
        with h5py.File(path) as file:
            group = file["fclib_local/W"]
            start, column, value = (group[name][:] for name in "pix")
            size = group["m"][0]
            self.q, self.mu = file["fclib_local/vectors/q"][:], file["fclib_local/vectors/mu"][:]
            self.r, self.u = file["solution/r"][:], file["solution/u"][:]
        row = np.repeat(np.arange(size), np.diff(start))
        self.matrix = np.zeros((size, size), order="F")
        self.matrix[row, column] = value
        unit = np.diag(self.matrix).mean()
        self.matrix /= unit
        self.q /= unit

    def counts(self):
        """Numbers of points that stick and slip."""
        push, across = self.r[::3], np.hypot(self.r[1::3], self.r[2::3])
        slips = (push > 0) & (across >= self.mu * push * (1 - 1e-9))
        return int(np.sum((push > 0) & ~slips)), int(np.sum(slips))

    def residual(self, r):
        """|r − P(r − u − μ |u_T| n)| / |q| with the projection P on the cones."""
        move = (self.matrix @ r + self.q).reshape(-1, 3)
        move[:, 0] += self.mu * np.hypot(move[:, 1], move[:, 2])
        push = r.reshape(-1, 3) - move
        across = np.hypot(push[:, 1], push[:, 2])
        normal = (push[:, 0] + self.mu * across) / (1 + self.mu**2)
        outside = (across > self.mu * push[:, 0]) | (push[:, 0] < 0)
        share = self.mu * normal / np.where(across > 0, across, 1)
        on_cone = np.column_stack([normal, share * push[:, 1], share * push[:, 2]])
        found = np.where(outside[:, None], np.where(normal[:, None] > 0, on_cone, 0), push)
        return np.linalg.norm(r - found.ravel()) / np.linalg.norm(self.q)


def write(program, folder, side, mu):
    """Returns the problem of most slipping points among those of 0.1 s, and of most closed ones if that ties."""
    steps, every = 4410, 20
    programs.call([program, "write", folder, side, side, MODES, mu, steps, every])
    problems = [Problem(path) for path in sorted(folder.glob("*.hdf5"))]
    if not problems:
        raise errors.InputError(f"bench friction: no contact of {side * side} points")
    return max(problems, key=lambda problem: problem.counts()[::-1])


def ours(program, problem):
    """Solves in rounds of one solve after one that is not counted."""

    def run():
        found = json.loads(programs.call([program, "solve", problem.path, 2], capture=True))
        return {"seconds": found["seconds"][-1], "r": np.array(found["r"])}

    return run


def theirs(siconos, method, problem, tolerance):
    cones = siconos.FrictionContactProblem(3, problem.matrix, problem.q, problem.mu)

    def run():
        r, u = np.zeros(problem.q.size), np.zeros(problem.q.size)
        options = siconos.SolverOptions(getattr(siconos, f"SICONOS_FRICTION_3D_{method}"))
        options.dparam[0], options.iparam[0] = tolerance, METHODS[method]
        begin = time.perf_counter()
        siconos.fc3d_driver(cones, r, u, options)
        return {"seconds": time.perf_counter() - begin, "r": r}

    return run


def slide(program, options):
    table = tables.Table(SLIDE_COLUMNS)
    scene = pathlib.Path(__file__).parent / "slider.toml"
    for motion, (along, across), speed, rate in SLIDES:
        with tempfile.TemporaryDirectory() as scope:
            size = f"bodies.box.geometry={{along={along},across={across}}}"
            programs.call([programs.BIN / "ricochet-kernel", scene, "--out", scope, "--set", size])
            (kernel,) = pathlib.Path(scope).glob("*.kernel.h5")

            def steps(friction):
                command = [program, "slide", kernel, friction, speed, rate, SLIDE_STEPS]
                return lambda: json.loads(programs.call(command, capture=True))

            found = timing.alternate(options.rounds, {mu: steps(mu) for mu in (0.0, options.mu)})
        plain = None
        for friction, runs in found.items():
            medians = [statistics.median(run["seconds"]) for run in runs]
            best = runs[medians.index(min(medians))]
            plain = plain or min(medians)
            table.row(
                {
                    "motion": motion,
                    "rate": rate,
                    "friction": friction,
                    "touching": best["touching"],
                    "median": min(medians),
                    "mean": statistics.mean(best["seconds"]),
                    "slowest": max(best["seconds"]),
                    "ratio": min(medians) / plain,
                    "renewals": best["renewals"] / SLIDE_STEPS,
                }
            )


def run(options):
    if options.slide:
        launch.build("bench_friction")
        return slide(programs.BIN / "bench_friction", options)
    try:
        import siconos.numerics as siconos
    except ImportError as missing:
        raise errors.InputError("Siconos is not installed: run scripts/setup --tests") from missing
    launch.build("bench_friction")
    program = programs.BIN / "bench_friction"
    if options.impact:
        return impact(siconos, program, options)
    table = tables.Table(COLUMNS)
    for side in SIDES:
        with tempfile.TemporaryDirectory() as scope:
            problem = write(program, pathlib.Path(scope) / "files", side, options.mu)
            compare(siconos, program, problem, options.rounds, table)


def impact(siconos, program, options):
    with tempfile.TemporaryDirectory() as scope:
        folder = pathlib.Path(scope)
        programs.call([programs.BIN / "ricochet-kernel", options.impact, "--out", folder])
        files = ["--fclib", folder / "files", "--fclib-every", "8", "--quiet"]
        programs.call([programs.BIN / "ricochet-contact", options.impact, "--out", folder, *files])
        problems = [Problem(path) for path in sorted((folder / "files").glob("*.hdf5"))]
        if not problems:
            raise errors.InputError(f"bench friction: {options.impact}: nothing touches")
        seconds, difference = {"ours": 0.0, NEWTON: 0.0}, 0.0
        for problem in problems:
            candidates = {"ours": ours(program, problem)}
            exact = candidates["ours"]()["r"]
            for power in range(4, 16, 2):
                candidates[NEWTON] = theirs(siconos, NEWTON, problem, 10.0**-power)
                apart = np.abs(candidates[NEWTON]()["r"] - exact).max() / np.abs(exact).max()
                if apart <= 1e-6:
                    break
            difference = max(difference, apart)
            found = timing.alternate(options.rounds, candidates)
            for method, runs in found.items():
                seconds[method] += timing.median(runs)
    table = tables.Table(IMPACT_COLUMNS)
    for method, sum_of_method in seconds.items():
        row = {"points": problem.mu.size, "steps": len(problems), "method": method, "seconds": sum_of_method}
        table.row(
            row
            | {
                "difference": None if method == "ours" else difference,
                "ratio": sum_of_method / seconds["ours"],
            }
        )


def compare(siconos, program, problem, rounds, table):
    candidates = {"ours": ours(program, problem)}
    goal = problem.residual(candidates["ours"]()["r"])
    for method in METHODS:
        for power in range(6, 16):
            candidate = theirs(siconos, method, problem, 10.0**-power)
            if problem.residual(candidate()["r"]) <= max(goal, 1e-15):
                break
        candidates[method] = candidate
    found = timing.alternate(rounds, candidates)
    sticking, slipping = problem.counts()
    best = timing.median(found["ours"])
    for name, runs in found.items():
        table.row(
            {
                "points": problem.mu.size,
                "sticking": sticking,
                "slipping": slipping,
                "method": name,
                "residual": problem.residual(runs[-1]["r"]),
                "seconds": timing.median(runs),
                "ratio": timing.median(runs) / best,
            }
        )
