# SPDX-License-Identifier: BSD-2-Clause
"""Measures bodies that come and go in a live loop: a fountain of the marbles of meshes/marbles over a floor.

    scripts/bench fountain
    scripts/bench fountain 8 20 --size 3e-3 --count 1000

A frame is 1 ms: 44 steps, after which the place of each marble is read. Every 50 frames a marble is thrown up and, once there are
as many as stated, the oldest is removed. Times are CPU times of one core.
"""
import math
import tempfile
import time
from pathlib import Path

import numpy as np

import ricochet
from benchmarks.tables import Table

MARBLES = Path(__file__).resolve().parents[1] / "meshes" / "marbles"
FRAME, STEPS = 1e-3, 44


def add_arguments(parser):
    parser.add_argument(
        "bodies",
        nargs="*",
        type=int,
        metavar="N",
        default=[4, 8, 20, 50],
        help="at a time; default: 4 8 20 50",
    )
    parser.add_argument(
        "--size", type=float, default=6e-3, help="of elements [m]; default: 6e-3, 3e-3 is the example's"
    )
    parser.add_argument("--count", type=int, default=40, help="marbles thrown after the first N; default: 40")
    parser.add_argument("--rate", type=float, default=88e3, help="contact steps per second; default: 88e3")


def marble(folder, options):
    """A scene of one marble over a floor, and its kernel."""
    (folder / "marble.geo").write_text(
        (MARBLES / "marble.geo").read_text().replace("3e-3", str(options.size))
    )
    table = ricochet.Scene(MARBLES / "marbles.toml").resolved
    table["bodies"] = {"first": table["bodies"]["first"]}
    table["obstacles"] = {"floor": table["obstacles"]["floor"]}
    table["contact"] = {"between": "all", "friction": 0.2}
    table["time"] |= {"rate_hz": STEPS / FRAME, "contact_rate_hz": options.rate}
    table["output"] = {}
    scene = ricochet.Scene(table, folder)
    return scene, ricochet.kernels(scene, 1)["first"]


def resident_mb():
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096e-6


class Timer:
    def __init__(self):
        self.ms = []

    def __enter__(self):
        self.start = time.process_time()

    def __exit__(self, *_):
        self.ms.append(1e3 * (time.process_time() - self.start))


def fountain(bodies, scene, kernel, count):
    base = resident_mb()
    simulation = ricochet.Simulation(scene, {"first": kernel}, pickups=[])
    make, add, remove, frame = Timer(), Timer(), Timer(), Timer()
    for k in range(bodies - 1):
        with make:
            simulation.add(f"place {k}", kernel, [0.02 * k, 0, 3])
    for name in simulation.bodies:
        simulation.remove(name)
    memory = []
    for thrown in range(bodies + count):
        if len(simulation.bodies) == bodies:
            with remove:
                simulation.remove(simulation.bodies[0])
        velocity = [0.3 * math.cos(50 * thrown), 0.3 * math.sin(50 * thrown), 1.5]
        with add:
            simulation.add(f"marble {thrown}", kernel, [0, 0, 0.1], velocity=velocity, spin=[1, 2, 9])
        for _ in range(50):
            with frame:
                simulation.step_block(STEPS)
                for name in simulation.bodies:
                    simulation.body_motion(name)
        memory.append(resident_mb())
    full = frame.ms[50 * bodies :]
    return {
        "bodies": bodies,
        "points": len(simulation.area),
        "memory": memory[-1] - base,
        "grown": memory[-1] - memory[bodies],
        "make": make.ms[-1],
        "add": np.mean(add.ms),
        "remove": np.mean(remove.ms),
        "frame": np.mean(full),
        "late": np.percentile(full, 99),
    }


def run(options):
    table = Table(
        [
            ("bodies", "bodies", ""),
            ("contact points", "points", ""),
            ("memory (MB)", "memory", ".0f"),
            ("growth (MB)", "grown", ".1f"),
            ("add, last new place (ms)", "make", ".0f"),
            ("add, place left (ms)", "add", ".2f"),
            ("remove (ms)", "remove", ".2f"),
            ("frame of 1 ms: mean (ms)", "frame", ".2f"),
            ("p99 (ms)", "late", ".2f"),
        ]
    )
    with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
        scene, kernel = marble(Path(folder), options)
        for bodies in options.bodies:
            table.row(fountain(bodies, scene, kernel, options.count))
