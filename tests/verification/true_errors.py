# SPDX-License-Identifier: BSD-2-Clause
"""Error estimates of impacts with `accuracy`, compared with true errors from closed forms or finer runs.

    scripts/verify --estimates [--out DIR] [--ranks N] [--only TEXT …] [--check]

Closed forms exist for rods; for other scenes the reference is a run with finer settings. Kernels and
references are kept in DIR (default out/estimates) and are not computed again. With --check the status is 1 unless
the true error is at most 3 estimates in 9 of 10 cases and the estimate at most 10 true errors in 7 of 10.
Prints Markdown.
"""
import json
from pathlib import Path

from ricochet import programs, quantities
from ricochet.programs import ROOT
from cases import bouncing_bar

ROD = """
title = "{title}"
[bodies.moving]
mesh = "{mesh}"
order = {order}
geometry = {{ elements = {elements}, length = {length} }}
translate = [-{length}, 0, 0]
material = {{ density = 1.0, young = 1.0, area = 1.0 }}
velocity = [1, 0, 0]
contact = "right"
[contact]
between = ["moving", "{other}"]
direction = [1, 0, 0]
[time]
duration = 30.0
"""
RESTING = """
[bodies.resting]
mesh = "{mesh}"
order = {order}
geometry = {{ elements = {elements}, length = 10 }}
material = {{ density = 1.0, young = 1.0, area = 1.0 }}
contact = "left"
"""
WALL = """
[obstacles.wall]
normal = [-1, 0, 0]
"""
DISKS = ROOT / "meshes/two-disks/two-disks.toml"
BALLS = ROOT / "meshes/hertz/two-balls.toml"
BALL = ROOT / "meshes/hertz/resting-ball.toml"


def rod_scene(folder, name, other, length=10, order=1, elements=100):
    values = {
        "title": name,
        "mesh": ROOT / "meshes/two-rods/rod.geo",
        "order": order,
        "elements": elements,
        "length": length,
        "other": other,
    }
    path = folder / f"{name}.toml"
    path.write_text(ROD.format(**values) + (WALL if other == "wall" else RESTING.format(**values)))
    return path


def bar(folder):
    """The bouncing bar, and its exact state after a number of touches: it leaves each touch at its arrival
    speed."""
    (folder / "bar.geo").write_text(bouncing_bar.GEO)
    scene = folder / "bouncing-bar.toml"
    scene.write_text(bouncing_bar.SCENE)
    touch, speed = bouncing_bar.TOUCH, bouncing_bar.ARRIVAL
    impulse = bouncing_bar.LENGTH * (2 * speed + bouncing_bar.GRAVITY * touch)

    def after(touches):
        duration = bouncing_bar.FALL + touches * touch + (touches - 0.5) * bouncing_bar.FLIGHT
        return duration, {"impulse": touches * impulse, "speed": speed, "velocity": {"bar": {0: speed}}}

    return scene, after


def disks(speed, size, order, *more):
    sets = [
        f"bodies.{body}.{key}"
        for body in ("upper", "lower")
        for key in (f"geometry={{size={size}}}", f"order={order}")
    ]
    return [
        f"bodies.upper.velocity=[0,-{speed},0]",
        "output.view=false",
        "output.snapshot_every=0",
        *sets,
        *more,
    ]


def balls(size, order, *more):
    return [
        f"bodies.{body}.{key}"
        for body in ("upper", "lower")
        for key in (f"geometry={{size={size}}}", f"order={order}")
    ] + list(more)


def cases(folder):
    """(name, scene, settings, accuracy, truth): truth is {"impulse": …, "velocity": {body: (axis, …)},
    "speed": …} or the settings of a reference."""

    def exchange(impulse, speed=1, **velocity):
        return {
            "impulse": impulse,
            "speed": speed,
            "velocity": {body: {0: v} for body, v in velocity.items()},
        }

    equal = rod_scene(folder, "equal-rods", "resting")
    third = rod_scene(folder, "equal-rods-order-3", "resting", order=3)
    short = rod_scene(folder, "short-on-long-rod", "resting", length=5, order=2)
    wall = rod_scene(folder, "rod-on-wall", "wall", order=2, elements=50)
    swap, stop, bounce = (
        exchange(10, moving=0, resting=1),
        exchange(5, moving=0, resting=0.5),
        exchange(20, moving=-1),
    )
    yield "equal rods, chosen settings", equal, [], 1e-2, swap
    yield "equal rods, order 3, chosen settings", third, [], 3e-3, swap
    yield "equal rods, 10 modes, 5 Hz", third, ["modes.count=10", "time.rate_hz=5"], 1e-2, swap
    yield "equal rods, 40 modes, jump", third, [
        "modes.count=40",
        "time.rate_hz=40",
        "contact.scheme=impulse",
    ], 1e-2, swap
    yield "equal rods, no residual flexibility", third, [
        "modes.count=30",
        "time.rate_hz=200",
        "modes.residual_flexibility=false",
    ], 1e-2, swap
    yield "short on long rod, chosen settings", short, [], 1e-2, stop
    yield "rod on wall, chosen settings", wall, [], 1e-2, bounce
    yield "equal rods, contact-adapted basis", third, [
        "modes={basis='contact', up_to_hz=2}",
        "time.rate_hz=100",
    ], 1e-2, swap
    yield "equal rods, 25 modes, 25 Hz", equal, ["modes.count=25", "time.rate_hz=25"], 1e-2, swap
    yield "short on long rod, 40 modes, 15 Hz", short, ["modes.count=40", "time.rate_hz=15"], 1e-2, stop
    yield "rod on wall, 15 modes", wall, ["modes.count=15", "time.rate_hz=200"], 1e-2, bounce
    yield "rod on wall, difference", wall, [
        "modes.count=40",
        "time.rate_hz=50",
        "contact.scheme=impulse",
        "contact.admittance=difference",
    ], 1e-2, bounce
    # Elements without an error. The shortest period of N modes is 20/N seconds.
    fine = rod_scene(folder, "rod-on-wall-fine", "wall", order=5, elements=160)
    for steps in (8, 64):
        for modes in (20, 40, 80, 160):
            sets = [f"modes.count={modes + 1}", f"time.rate_hz={modes * steps / 20}"]
            yield f"rod on wall, {modes} modes, {steps} steps per period", fine, sets, 1e-2, bounce
    scene, after = bar(folder)
    for touches in (1, 2):
        duration, truth = after(touches)
        dial = ["bodies.bar.geometry={elements=60}", "modes={}", f"time={{duration={duration}}}"]
        yield f"bouncing bar, touches: {touches}, chosen settings", scene, dial, 1e-2, truth
    yield (
        "bouncing bar, touches: 2, 40 modes, 1200 Hz",
        scene,
        ["modes.count=40", "time.rate_hz=1200", f"time.duration={duration}"],
        1e-2,
        truth,
    )
    fine = [
        "modes.up_to_hz=1000",
        "modes.basis=contact",
        "modes.flexibility_error=1e-4",
        "contact.spacing=4.9e-3",
        "time.rate_hz=1e6",
    ]
    free = ["modes={}"]
    yield (
        "disks, 3 m/s, 800 Hz, 20 kHz",
        DISKS,
        disks(3, 8e-3, 3, "modes.up_to_hz=800", "time.rate_hz=2e4", "contact.spacing=1.4e-2"),
        1e-2,
        disks(3, 1e-2, 4, *fine),
    )
    for speed in (1, 6):
        truth = disks(speed, 1e-2, 4, *fine)
        yield f"disks, {speed} m/s, chosen settings", DISKS, disks(
            speed, 1e-2, 3, *free, "time={duration=0.04}"
        ), 1e-2, truth
        yield (
            f"disks, {speed} m/s, order 2, 200 Hz, 3 kHz",
            DISKS,
            disks(speed, 1e-2, 2, "modes.up_to_hz=200", "time.rate_hz=3e3"),
            1e-2,
            truth,
        )
        yield (
            f"disks, {speed} m/s, 9 positions",
            DISKS,
            disks(speed, 1e-2, 3, "contact.spacing=19.6e-3", "modes.up_to_hz=600"),
            1e-2,
            truth,
        )
    fine = ["modes.up_to_hz=5e5", "modes.flexibility_error=1e-3", "time.rate_hz=4e7"]
    yield "balls, coarse", BALLS, balls(1e-4, 2), 1e-2, balls(4e-5, 2, *fine)
    yield "balls, 1 MHz", BALLS, balls(1e-4, 2, "time.rate_hz=1e6", "modes.up_to_hz=6e4"), 1e-2, balls(
        4e-5, 2, *fine
    )
    for size, order in ((1e-4, 2), (7e-5, 2), (1e-4, 3)):
        yield (
            f"resting ball, size {size:g}, order {order}",
            BALL,
            [f"bodies.ball.geometry={{size={size}}}", f"bodies.ball.order={order}"],
            1e-2,
            ["bodies.ball.geometry={size=2.5e-5}"],
        )


def summary_of(scene, sets, out, title, ranks, accuracy=None):
    """Summary of the scene with these settings. It is computed only once."""
    path = out / f"{title}.summary.json"
    if not path.exists():
        arguments = ["--out", out, "--quiet"] + [a for s in [f"title={title}", *sets] for a in ("--set", s)]
        if accuracy:
            arguments += ["--accuracy", accuracy]
        programs.kernel(scene, arguments, ranks)
        programs.contact(scene, arguments)
    return json.loads(path.read_text())


def knows_shares(estimate):
    """Whether all shares of an error estimate are known. `until_s`, the end of what it serves, is null if that is the whole run."""
    return all(value is not None for key, value in estimate.items() if key != "until_s")


def true_error(found, truth):
    """The larger error of impulse and rebound, or at rest of force and approach.

    truth: a summary, or a closed form as in `cases`."""
    if "quantities" in truth:
        errors = quantities.errors(found, truth)
        return max(errors[name] for name in ("impulse", "rebound", "force", "approach") if name in errors)
    known = [(body, k, v) for body, components in truth["velocity"].items() for k, v in components.items()]
    velocity = [found["exit_velocity"][body][k] for body, k, _ in known]
    return max(
        quantities.relative_error([found["impulse_ns"]], [truth["impulse"]], truth["impulse"]),
        quantities.relative_error(velocity, [v for _, _, v in known], truth["speed"]),
    )


def add_arguments(parser):
    parser.add_argument(
        "--out", type=Path, default=ROOT / "out" / "estimates", help="(default: out/estimates)"
    )
    parser.add_argument("--ranks", type=int, default=2, help="ranks of ricochet-kernel (default: 2)")
    parser.add_argument(
        "--only", nargs="+", default=[""], metavar="TEXT", help="cases whose name contains one of these"
    )
    parser.add_argument("--check", action="store_true", help="fail unless estimates hold")


def run(given):
    given.out.mkdir(parents=True, exist_ok=True)
    causes = ("mesh", "modes", "step", "eigensolver", "precision", "spacing")
    print("| case | true error | estimate | true / estimate |", " | ".join(causes), "|")
    print("|---|" + "---|" * (3 + len(causes)))
    ratios = []
    for name, scene, sets, accuracy, truth in cases(given.out):
        if not any(text in name for text in given.only):
            continue
        title = "".join(c if c.isalnum() else "-" for c in name.lower())
        title = "-".join(filter(None, title.split("-")))
        found = summary_of(scene, sets, given.out, title, given.ranks, accuracy)
        if isinstance(truth, list):
            # Cases with the same reference settings share one reference.
            named = f"reference-{scene.stem}" + (f"-{name.split()[1]}" if scene == DISKS else "")
            truth = summary_of(scene, truth, given.out, named, given.ranks)
        error, estimate = true_error(found, truth), found["error_estimate"]
        ratios.append(error / estimate["total"])
        shares = ["–" if estimate[cause] is None else f"{estimate[cause]:.1e}" for cause in causes]
        print(
            f"| {name} | {error:.1e} | {estimate['total']:.1e} | {ratios[-1]:.2f} |",
            " | ".join(shares),
            "|",
            flush=True,
        )
    bounded, close = sum(r <= 3 for r in ratios), sum(r >= 0.1 for r in ratios)
    print(f"\nTrue error at most 3 estimates: {bounded} of {len(ratios)}; ", end="")
    print(f"estimate at most 10 true errors: {close} of {len(ratios)}.")
    return given.check and not (bounded >= 0.9 * len(ratios) and close >= 0.7 * len(ratios))
