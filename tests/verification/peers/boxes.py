# SPDX-License-Identifier: BSD-2-Clause
"""Five steel boxes that turn, fall on a floor and on each other without friction. MuJoCo's boxes are rigid; Ricochet's have rigid modes
and the residual flexibility of one element, but no vibration. Every impact is lossless: of a corner on a face, or of two edges."""
import contextlib
import dataclasses
import json
import statistics
import time
import warnings
from pathlib import Path

import numpy as np

import ricochet
from benchmarks import launch, tables
from ricochet import errors, programs

TITLE = "Five boxes"

DENSITY, YOUNG, GRAVITY = 7800.0, 2e11, 9.81
DURATION = 0.08  # s, with thirteen touches
FIRST = 5  # touches: each body has then been hit
SPEED, ARM = 2.5, 0.05  # m/s and m, the units of velocities and, times the speed over the arm, of spins
ROUNDS = 5


@dataclasses.dataclass
class Box:
    size: tuple  # m
    turn: tuple  # degrees about x, then y, then z
    place: tuple  # m
    velocity: tuple  # m/s
    spin: tuple  # rad/s


BOXES = {
    "a": Box((0.08, 0.06, 0.05), (25, -35, 10), (0, 0, 0.062), (0, 0, -1.5), (3, -2, 4)),
    "b": Box((0.06, 0.06, 0.04), (-30, 20, 40), (0.02, 0.015, 0.16), (0, 0, -2.5), (-5, 4, 2)),
    "c": Box((0.05, 0.08, 0.05), (15, 50, -20), (0.19, 0.01, 0.11), (-2.5, 0, 0), (2, 6, -3)),
    "d": Box((0.07, 0.05, 0.05), (40, 30, 5), (-0.15, 0.02, 0.12), (0.2, 0, -1.2), (-3, -4, 1)),
    "e": Box((0.05, 0.05, 0.06), (-20, -40, 25), (-0.13, 0, 0.25), (0, 0.1, -2.2), (4, 1, -6)),
}
# Ricochet: Young's modulus, as a multiple of that of steel, and contact steps [µs]. MuJoCo: length of a contact and step [µs].
# A contact has about 64 steps in both codes, because MuJoCo's error of a rebound varies with the phase of the step. The last
# row is the stiffest.
STIFFNESS = ((0.01, 2.5, 160, 2.5), (0.1, 0.8, 50, 0.8), (1, 0.25, 16, 0.25), (10, 0.08, 5, 0.08))
# Runs whose times are compared: Ricochet's contact steps [µs]; MuJoCo's contacts and steps [µs].
OURS = (2, 1, 0.25)
THEIRS = ((160, 10), (50, 3.2), (16, 1))

GEOMETRY = """SetFactory("OpenCASCADE");
Box(1) = {{{corner}, {size}}};
Transfinite Curve{{:}} = 2;
Transfinite Surface{{:}};
Recombine Surface{{:}};
Transfinite Volume{{:}};
Physical Volume("box") = {{1}};
"""
BODY = """[bodies.{name}]
mesh = "{name}.geo"
order = 1
contact = "all"
material = {{ density = {density}, young = {young}, poisson = 0.3 }}
rotate_deg = {turn}
translate = {place}
velocity = {velocity}
angular_velocity = {spin}
"""
SCENE = """[obstacles.floor]
normal = [0, 0, 1]
[contact]
between = "all"
[modes]
count = 6
[motion]
rotation = "finite"
[loads]
gravity = [0, 0, {fall}]
[time]
contact_rate_hz = {rate!r}
duration = {duration}
"""
# A contact is a spring without damping, whose stiffness per mass gives its length: MuJoCo's "direct" solref.
PEER = """<mujoco>
<option timestep="{step!r}" gravity="0 0 {fall}" tolerance="1e-14" iterations="200"/>
<default><geom solref="{stiffness!r} 0" solimp="0.9999 0.9999 0.001 0.5 2" condim="1" density="{density}"/></default>
<worldbody><geom type="plane" size="1 1 1"/>
{bodies}
</worldbody>
<keyframe><key qpos="{place}" qvel="{velocity}"/></keyframe>
</mujoco>
"""


def need():
    """Raises InputError if MuJoCo is missing."""
    if not Path("/usr/include/mujoco/mujoco.h").is_file():
        raise errors.InputError("libmujoco-dev: not installed: scripts/setup --peers installs MuJoCo")


# ---- Attitudes ----


def product(p, q):
    """Product of quaternions w, x, y, z."""
    return np.array([p[0] * q[0] - p[1:] @ q[1:], *(p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:]))])


def quaternion(turn):
    """Of rotations [degrees] about the fixed axes x, then y, then z."""
    out = np.array([1.0, 0, 0, 0])
    for axis, angle in enumerate(np.radians(turn)):
        out = product(np.array([np.cos(angle / 2), *(np.sin(angle / 2) * np.eye(3)[axis])]), out)
    return out


def rotated(q, vectors):
    """Vectors (n,3) in world axes, from those of the body."""
    return vectors + 2 * np.cross(q[1:], np.cross(q[1:], vectors) + q[0] * vectors)


# ---- Both codes ----


@dataclasses.dataclass
class Run:
    """Touches, each with start [s], end [s], names, impulse [N s], and velocity and spin of both bodies (2,3) after it; and poses."""

    touches: list
    time: np.ndarray  # (k) s
    position: dict  # (k,3) m by body
    attitude: dict  # (k,4) by body


@dataclasses.dataclass
class Touch:
    start: float
    end: float
    bodies: tuple
    impulse: float
    motion: dict  # velocity (3) [m/s] and spin (3) [rad/s] by body, after it


@contextlib.contextmanager
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def our_scene(folder, stiffness, step):
    """The scene with steel of a multiple of its stiffness and contact steps [µs], and its kernels."""
    text = 'title = "Boxes"\n'
    for name, box in BOXES.items():
        corner, size = (", ".join(map(repr, values)) for values in ([-s / 2 for s in box.size], box.size))
        (folder / f"{name}.geo").write_text(GEOMETRY.format(corner=corner, size=size))
        values = {key: list(value) for key, value in vars(box).items()}
        text += BODY.format(name=name, density=DENSITY, young=stiffness * YOUNG, **values)
    path = folder / "boxes.toml"
    path.write_text(text + SCENE.format(fall=-GRAVITY, rate=1e6 / step, duration=DURATION))
    scene = ricochet.Scene(path)
    with quiet():  # about waves faster than in any solid
        return scene, ricochet.kernels(scene, 1, folder / "out")


def ours(folder, stiffness, step):
    """A Run of Ricochet."""
    scene, _ = our_scene(folder, stiffness, step)
    with quiet():  # about few candidates in a touch, and modes that are left out
        result = ricochet.impact(scene, folder / "out")
    touches = []
    for touch in result.summary["touches"]:
        row = np.searchsorted(result.time, touch["end_s"])
        names = [name for name in touch["bodies"] if name in BOXES]
        motion = {name: (result.bodies[name].velocity[row], result.bodies[name].spin[row]) for name in names}
        touches.append(
            Touch(touch["start_s"], touch["end_s"], tuple(touch["bodies"]), touch["impulse_ns"], motion)
        )
    poses = {
        kind: {name: getattr(result.bodies[name], kind) for name in BOXES}
        for kind in ("position", "attitude")
    }
    return Run(touches, result.time, **poses)


def our_seconds(folder, step):
    """Processor time [s] of the steps."""
    simulation = ricochet.Simulation(*our_scene(folder, 1, step))
    started = time.process_time()
    simulation.step_block(round(DURATION * 44100))
    return time.process_time() - started


def theirs(folder, contact, step):
    """A Run of MuJoCo with contacts of a length [µs] and steps [µs], and the processor time [s] of its steps."""
    bodies, place, velocity = "", [], []
    for name, box in BOXES.items():
        half = " ".join(repr(s / 2) for s in box.size)
        bodies += f'<body name="{name}"><freejoint/><geom type="box" size="{half}"/></body>\n'
        turn = quaternion(box.turn)
        own = rotated(turn * [1, -1, -1, -1], np.array([box.spin]))[0]  # in axes of the body
        place += [*box.place, *turn]
        velocity += [*box.velocity, *own]
    path = folder / "boxes.xml"
    path.write_text(
        PEER.format(
            step=1e-6 * step,
            fall=-GRAVITY,
            stiffness=-((np.pi / (1e-6 * contact)) ** 2),
            density=DENSITY,
            bodies=bodies.strip(),
            place=" ".join(f"{x!r}" for x in map(float, place)),
            velocity=" ".join(f"{x!r}" for x in map(float, velocity)),
        )
    )
    found = json.loads(programs.call([programs.BIN / "bench_mujoco", path, DURATION, 1e-4], capture=True))
    touches = []
    for touch in found["touches"]:
        after = {name: np.array(row) for name, row in zip(touch["bodies"], touch["after"]) if name in BOXES}
        motion = {name: (row[7:10], row[10:]) for name, row in after.items()}
        touches.append(
            Touch(touch["start_s"], touch["end_s"], tuple(touch["bodies"]), touch["impulse_ns"], motion)
        )
    of_time = np.array([row[0] for row in found["rows"]])
    poses = np.array([row[1] for row in found["rows"]])
    position = {name: poses[:, k, :3] for k, name in enumerate(BOXES)}
    return (
        Run(touches, of_time, position, {name: poses[:, k, 3:7] for k, name in enumerate(BOXES)}),
        found["seconds"],
    )


# ---- Comparison ----


def same(one, other, count):
    """Whether the first touches are of the same bodies in the same order."""
    pairs = ([set(touch.bodies) for touch in run.touches[:count]] for run in (one, other))
    return next(pairs) == next(pairs)


def difference(one, other, count=FIRST):
    """Largest difference of the velocities and spins after the first touches, in the units SPEED and SPEED/ARM."""
    if not same(one, other, count):
        return float("nan")
    largest = 0.0
    for a, b in zip(one.touches[:count], other.touches[:count]):
        for name, (velocity, spin) in a.motion.items():
            of_velocity = np.linalg.norm(velocity - b.motion[name][0]) / SPEED
            of_spin = np.linalg.norm(spin - b.motion[name][1]) * ARM / SPEED
            largest = max(largest, of_velocity, of_spin)
    return largest


def vector(values):
    return " ".join(f"{x:.3f}" for x in values)


def side_by_side(one, other):
    """Prints the first touches of both codes."""
    rows = [
        (a, b, name)
        for a, b in zip(one.touches[:FIRST], other.touches[:FIRST])
        for name in BOXES
        if name in a.motion
    ]
    table = tables.Table(
        [
            ("touch", lambda row: " on ".join(name for name in row[1].bodies[::-1]), ""),
            ("begins (ms)", lambda row: f"{1e3 * row[0].start:.4f} / {1e3 * row[1].start:.4f}", ""),
            ("impulse (N s)", lambda row: f"{row[0].impulse:.4f} / {row[1].impulse:.4f}", ""),
            ("body", lambda row: row[2], ""),
            (
                "velocity after (m/s)",
                lambda row: " / ".join(vector(t.motion[row[2]][0]) for t in row[:2]),
                "",
            ),
            ("spin after (rad/s)", lambda row: " / ".join(vector(t.motion[row[2]][1]) for t in row[:2]), ""),
        ]
    )
    for row in rows:
        table.row(row)


def apart(one, other, end):
    """Largest distance [m] of the centres of a body in both codes up to a time [s]."""
    times = np.linspace(0, end, 400)
    return max(
        np.linalg.norm(
            [
                np.interp(times, one.time, one.position[name][:, k])
                - np.interp(times, other.time, other.position[name][:, k])
                for k in range(3)
            ],
            axis=0,
        ).max()
        for name in BOXES
    )


def stiffer(folder):
    """Prints how both codes approach each other as their contacts become stiffer. Returns the runs by row of STIFFNESS."""
    table = tables.Table(
        [
            ("stiffness / steel", "stiffness", "g"),
            ("contact (µs), Ricochet / MuJoCo", "length", ""),
            (f"difference after {FIRST} touches", "first", ".1e"),
            ("of the impulses of all touches", "impulse", ".1e"),
            ("of the centres up to the end (mm)", "centre", ".2g"),
        ]
    )
    runs = {}
    for stiffness, our_step, contact, step in STIFFNESS:
        one, other = ours(folder, stiffness, our_step), theirs(folder, contact, step)[0]
        runs[stiffness] = one, other
        count = min(len(one.touches), len(other.touches))
        alike = len(one.touches) == len(other.touches) and same(one, other, count)
        lengths = [1e6 * statistics.median(t.end - t.start for t in run.touches) for run in (one, other)]
        apart_by = (
            max(abs(a.impulse / b.impulse - 1) for a, b in zip(one.touches, other.touches)) if alike else None
        )
        table.row(
            {
                "stiffness": stiffness,
                "length": " / ".join(f"{value:.3g}" for value in lengths),
                "first": difference(one, other),
                "impulse": apart_by,
                "centre": 1e3 * apart(one, other, DURATION),
            }
        )
    return runs


def cost(folder, reference):
    """Prints the processor times of both codes, which run in turns.

    @param reference  the stiffest run of each code, from which the first impacts differ
    """
    settings = [("Ricochet", f"steel, {step:g} µs", lambda step=step: our_seconds(folder, step),
                 difference(ours(folder, 1, step), reference[0])) for step in OURS]  # fmt: skip
    settings += [("MuJoCo", f"contacts of {contact:g} µs, {step:g} µs",
                  lambda contact=contact, step=step: theirs(folder, contact, step)[1],
                  difference(theirs(folder, contact, step)[0], reference[1])) for contact, step in THEIRS]  # fmt: skip
    seconds = [[] for _ in settings]
    for _ in range(ROUNDS):
        for measured, setting in zip(seconds, settings):
            measured.append(setting[2]() / DURATION)
    table = tables.Table(
        [
            ("code", "code", ""),
            ("setting", "setting", ""),
            ("first impacts differ from its stiffest run by", "error", ".1e"),
            ("processor time per simulated second (s)", "seconds", ".2f"),
            ("times the first line", "ratio", ".2f"),
        ]
    )
    first = statistics.median(seconds[0])
    for (code, setting, _, error), measured in zip(settings, seconds):
        median = statistics.median(measured)
        table.row(
            {"code": code, "setting": setting, "error": error, "seconds": median, "ratio": median / first}
        )


# ---- Picture ----

FACES = np.array([[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]])
COLOURS = dict(zip(BOXES, ("#2b6cb0", "#d2691e", "#3a8f5c", "#8a4fa3", "#b0a030")))
INSTANTS = (0.0, 0.010, 0.046, 0.056, 0.075)  # s


def draw(runs, path):
    """Draws both codes at some instants."""
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = Figure(figsize=(2.5 * len(INSTANTS), 4.6), layout="constrained")
    axes = figure.subplots(
        2,
        len(INSTANTS),
        subplot_kw={"projection": "3d", "proj_type": "ortho", "computed_zorder": False},
    )
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1], indexing="ij")).reshape(3, -1).T / 2
    view = np.array([np.sin(np.radians(-10)), -np.cos(np.radians(-10)), 0.2])  # towards the viewer
    for row, (code, run) in zip(axes, runs.items()):
        for ax, instant in zip(row, INSTANTS):
            floor = np.array(
                [[x, y, 0] for x, y in ((-0.24, -0.12), (0.24, -0.12), (0.24, 0.12), (-0.24, 0.12))]
            )
            ax.add_collection3d(Poly3DCollection([floor], facecolor="#eeeeee", edgecolor="#bbbbbb"))
            frame = np.argmin(abs(run.time - instant))
            for name in sorted(
                BOXES, key=lambda name: run.position[name][frame] @ view
            ):  # the farthest first
                place = run.position[name][frame] + rotated(
                    run.attitude[name][frame], corners * BOXES[name].size
                )
                ax.add_collection3d(
                    Poly3DCollection(place[FACES], facecolor=COLOURS[name], edgecolor="black", linewidth=0.5)
                )
            ax.set(xlim=(-0.24, 0.24), ylim=(-0.12, 0.12), zlim=(0, 0.3))
            ax.set_box_aspect((0.48, 0.24, 0.3), zoom=1.2)
            ax.set_axis_off()
            ax.view_init(elev=12, azim=-80)
            ax.set_title(f"{code}, {1e3 * instant:g} ms", fontsize=9)
    tables.save(figure, path)


def run(folder, cache, figure):
    """Computes all runs, and prints and draws the comparison. Nothing is kept in `cache`."""
    launch.build("bench_mujoco")
    runs = stiffer(folder)
    print("\nThe stiffest runs, Ricochet / MuJoCo:\n")
    stiffest = runs[STIFFNESS[-1][0]]
    side_by_side(*stiffest)
    print()
    cost(folder, stiffest)
    if figure:
        print()
        draw(dict(zip(("Ricochet", "MuJoCo"), runs[1])), figure)
