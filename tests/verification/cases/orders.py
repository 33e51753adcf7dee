# SPDX-License-Identifier: BSD-2-Clause
"""How errors decrease with the size h and the order p of elements, with the step Δ and with the number N of modes.

*Elements*: a box between smooth walls at x and y, whose top and foot move along z only. Its modes are products of sines and cosines with
ω = c_s|k| and c_p|k|, k = π(l/a, m/b, n/c), so the elements are the only cause of error. The error of a Ritz frequency is of order h^2p.

*Steps and modes*: a bar stands on a rigid floor, and a smooth pulse F sin²(πt/T) presses its top. Until the wave returns, the reaction is
2 F sin²(π(t − L/c)/T) in closed form. The causes of error are the step, with its constant force, and modal truncation. Truncation with R
leaves ripples of Σ 1/n⁴, hence of N⁻³, which open the contact before the wave arrives. Under the wave, the foot moves as t³ and closes this
gap at a velocity of N⁻². From then on the force rings with the highest mode of the bar in contact, at an amplitude Zv of N⁻², because
nothing dissipates. The same truncated bar, integrated by Runge and Kutta's method with small steps, rings as much."""
import numpy as np

import scenes
from block import GEO
from case import BLUE, GREEN, GREY, RED, slopes

TITLE = "Orders of convergence in h, p, Δ and N"
SOURCE = (
    "Separation of variables for the box, d'Alembert's solution for the bar; h^2p: Strang & Fix 1973, *An Analysis of the "
    "Finite Element Method*."
)
RESTS_ON = "theory"
LONG = True
SIDES = (0.1, 0.13, 0.17)
DENSITY, YOUNG, POISSON = 2700.0, 70e9, 0.33
MESHES = {1: (4, 6, 8), 2: (2, 3, 4), 3: (1, 2, 3)}
LOWEST = 6  # number of frequencies compared

BOX = scenes.scene(
    {
        "box": f"""
mesh = "box.geo"
material = {{ density = {DENSITY}, young = {YOUNG}, poisson = {POISSON} }}
contact = "top"
support = {{ foot = "xy", top = "xy", "x sides" = "x", "y sides" = "y" }}
"""
    },
    modes=f"count = {LOWEST + 3}\nresidual_flexibility = false",
    contact="direction = [0, 0, 1]\nspacing = 0.05",
    time="duration = 1.0",
    obstacles={"ceiling": "point = [0, 0, 2]\nnormal = [0, 0, -1]"},
)
# L = c = ρ = E = A = 1. The pulse lasts T = 1.2, and its wave returns to the foot after 3.
LASTS, FORCE = 1.2, 1.0
PRESSED = scenes.scene(
    {
        "bar": """
mesh = "rod.geo"
order = 3
material = { density = 1.0, young = 1.0, area = 1.0 }
contact = "foot"
"""
    },
    modes="count = 320",
    contact="direction = [-1, 0, 0]",
    time="duration = 2.0",
    obstacles={"floor": "normal = [1, 0, 0]"},
    more="""
[[loads.traction]]
body = "bar"
group = "top"
vector = [-1.0, 0, 0]
history = "pulse.csv"
""",
)


def pulse(time):
    """Force on the top."""
    return np.where((time > 0) & (time < LASTS), FORCE * np.sin(np.pi * time / LASTS) ** 2, 0)


def reaction(time):
    """Reaction on the foot: twice the pulse, when its wave arrives."""
    return 2 * pulse(time - 1)


def force_error(result, upto=1.95):
    """Root mean square of the difference between the force and the reaction in the middle of each step, divided by 2F. It
    excludes the tail of the pulse, during which contact may already have ended."""
    time, force = result.time, result.total_force
    inside = (time > 0) & (time < upto)
    return np.sqrt(((force - reaction(time - (time[1] - time[0]) / 2))[inside] ** 2).mean()) / (2 * FORCE)


def truncated_error(count):
    """The same error of a bar of `count` modes whose foot stands on the floor through the flexibility of the other modes, integrated by
    the classical method of Runge and Kutta. Modes of the bar: ω = nπ, φ = √2 cos(nπx), and 1 for the rigid one.
    """
    n = np.arange(count)
    stiffness, foot = (n * np.pi) ** 2, np.where(n == 0, 1, np.sqrt(2))
    top = foot * (-1.0) ** n
    beyond = np.arange(count, 400_000)  # the sum beyond this is an integral, 2 / (π² · 400 000)
    flexibility = 2 * ((beyond * np.pi) ** -2.0).sum() + 2 / (np.pi**2 * beyond[-1])
    lift = 2 * ((-1.0) ** beyond * (beyond * np.pi) ** -2.0).sum()  # of the foot, by a unit force on the top

    def force(q, time):
        return max(0.0, (lift * pulse(time) - foot @ q) / flexibility)

    def rate(state, time):
        q, v = state
        return np.array([v, foot * force(q, time) - top * pulse(time) - stiffness * q])

    step = 1 / (40 * count)  # 80 per period of the highest mode
    times = step * np.arange(1, round(1.95 / step))
    state, forces = np.zeros((2, count)), []
    for time in times - step:
        a = rate(state, time)
        b = rate(state + step / 2 * a, time + step / 2)
        c = rate(state + step / 2 * b, time + step / 2)
        d = rate(state + step * c, time + step)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        forces.append(force(state[0], time + step))
    return np.sqrt(((forces - reaction(times)) ** 2).mean()) / (2 * FORCE)


def separated():
    """The lowest elastic frequencies [Hz] of the box between its walls."""
    shear = YOUNG / (2 * (1 + POISSON))
    pressure = shear * (2 - 2 * POISSON) / (1 - 2 * POISSON)
    found = []
    for index in np.ndindex(6, 6, 6):
        l, m, n = index
        k = np.linalg.norm(np.array(index) / SIDES) / 2
        # u_x ~ sin lx · cos my · sin nz, u_y ~ cos lx · sin my · sin nz, u_z ~ cos lx · cos my · cos nz
        motions = int(l > 0 and n > 0) + int(m > 0 and n > 0) + 1
        if not any(index):
            continue
        # One of the motions is along k, unless that motion vanishes because of a
        # sine of 0. All motions are then transverse.
        along = 1 if n > 0 else 0
        found += [np.sqrt(pressure / DENSITY) * k] * along + [np.sqrt(shear / DENSITY) * k] * (
            motions - along
        )
    return np.sort(found)[:LOWEST]


def elements(bench, ax):
    bench.write("box.geo", GEO)
    scene = bench.write("box.toml", BOX)
    exact = separated()
    a, b, c = SIDES
    for (order, meshes), colour in zip(MESHES.items(), (RED, BLUE, GREEN)):
        errors = []
        for n in meshes:
            kernel = bench.kernel(
                scene,
                f"bodies.box.order={order}",
                f"bodies.box.geometry={{a={a},b={b},c={c},n={n}}}",
                body="box",
            )
            ours = kernel["modes/angular_frequency"][:]
            errors.append(np.abs(ours[ours > 0][:LOWEST] / (2 * np.pi) / exact - 1).max())
        sizes = 1 / np.array(meshes)
        bench.order(
            f"largest error of {LOWEST} frequencies over h, p = {order}",
            sizes,
            errors,
            2 * order,
            0.5,
            "2p, which such coarse meshes only approach",
        )
        slopes(ax, sizes, errors, f"p = {order}", colour)
    ax.set(xlabel="h / side", ylabel="relative error", title="Lowest frequencies of a box between walls")
    ax.legend()


def run(bench):
    figure, axes = bench.figure(2, 2, height=3.0)
    elements(bench, axes[0, 0])
    bench.write("rod.geo", scenes.rod(1, 160, "bar", ("foot", "top")))
    knots = np.linspace(0, LASTS, 1201)
    bench.write("pulse.csv", "".join(f"{t:.9f}, {force:.15f}\n" for t, force in zip(knots, pulse(knots))))
    scene = bench.write("pressed.toml", PRESSED)

    rates, errors = np.array([20, 40, 80, 160]), []
    bench.kernel(scene)
    for rate in rates:
        errors.append(force_error(bench.contact(scene, f"time.rate_hz={rate}")))
    slopes(axes[0, 1], 1 / rates, errors, "force", BLUE)
    bench.order(
        "force over Δ, 320 modes with R",
        1 / rates,
        errors,
        2.0,
        0.5,
        "a force constant over the step, compared at the middle of the step",
    )
    axes[0, 1].set(xlabel="Δ c/L", ylabel="mean square error / 2F", title="Step, 320 modes with R")
    axes[0, 1].legend()

    counts = np.array([20, 40, 80])
    for residual, colour, expected in ((True, BLUE, -2.0), (False, RED, -1.0)):
        errors, name = [], "with R" if residual else "without R"
        for count in counts:
            modes = f"modes={{count={count},residual_flexibility={str(residual).lower()}}}"
            result = bench.impact(scene, modes, "time.rate_hz=1600")
            errors.append(force_error(result))
        slopes(axes[1, 0], counts, errors, name, colour)
        bench.order(
            f"force over N, {name}",
            counts,
            errors,
            expected,
            0.5,
            "the force rings at the velocity with which the wave closes a gap of N⁻³"
            if residual
            else "flexibility of the truncated modes, Σ 1/n²",
        )
        if residual:
            bench.compare(
                f"mean square error / 2F, {counts[0]} modes with R",
                errors[0],
                truncated_error(counts[0]),
                0.02,
                "Runge and Kutta's method for the same truncated bar; 160 steps per period of its highest mode in ours",
            )
    axes[1, 0].set(xlabel="modes", ylabel="mean square error / 2F", title="Modes, Δ = L/(1600 c)")
    axes[1, 0].legend()
    time, force = result.time, result.total_force
    axes[1, 1].plot(time, force, color=BLUE, label=f"{counts[-1]} modes without R")
    axes[1, 1].plot(time, reaction(time), color=GREY, linestyle="--", linewidth=0.9, label="closed form")
    axes[1, 1].set(xlabel="time (L/c)", ylabel="force / F", title="Reaction of the floor")
    axes[1, 1].legend()
    bench.save(figure, "Errors over h and p, Δ and N, and the reaction from which the last two are measured")
