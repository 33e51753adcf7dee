# SPDX-License-Identifier: BSD-2-Clause
"""A steel ball of 10 mm radius rests on a rigid plane (`meshes/hertz/resting-ball.toml`, `scheme = "static"`) under a weight of 246 N, for
which Hertz's contact radius is 0.2 mm. Each mesh is twice as fine at the contact as the previous one. A quarter of the ball is meshed.

The approach of the centre should not converge to Hertz's value: his ball is a half-space near the contact, and a real ball of ν = 0.3
approaches by about 0.54 a/R less. The reference is therefore an elastic ball in Legendre series, without a mesh and without the
half-space. The contact radius is computed from the second moment of the forces as for Hertz's pressure, a² = 5/2 Σ λ r² / Σ λ. The radius
from the pressed area assumes no form of the pressure, but counts whole elements."""
import numpy as np

import hertz_theory as hertz
from case import BLUE, GREEN, ORANGE, PURPLE, RED, slopes
from elastic_ball import ElasticBall
from ricochet.programs import ROOT

TITLE = "Hertz at rest: a ball on a plane"
SOURCE = (
    "Hertz 1882 as in Johnson 1985, *Contact Mechanics*, section 4.2; an elastic ball in Legendre series after Love 1927, "
    "section 173, computed in `elastic_ball.py`."
)
RESTS_ON = "theory"
LONG = False
GRAVITY = 7485.97


def run(bench, sizes=(1e-4, 5e-5), bounds=None):
    bounds = bounds or {"radius": 0.01, "approach": 0.003, "radius of the area": 0.05, "pressure": 0.15}
    scene = ROOT / "meshes" / "hertz" / "resting-ball.toml"
    errors, rows, contacts = [], [], {}
    for size in sizes:
        result = bench.impact(scene, f"bodies.ball.geometry={{size={size}}}")
        contact = contacts[size] = hertz.Contact(result.path, "ball")
        weight = hertz.QUARTERS * GRAVITY * result.bodies["ball"].mass
        approach, ideal = result.summary["pairs"][0]["approach_m"], hertz.radius(contact.total)
        ball = ElasticBall(hertz.POISSON, 1.5 * ideal / hertz.RADIUS, 30)
        forces, depth = ball.press(contact.total / hertz.YOUNG / hertz.RADIUS**2)
        exact = (
            hertz.RADIUS * np.sqrt(2.5 * (forces * ball.square).sum() / forces.sum()),
            hertz.RADIUS * depth,
        )
        errors.append(
            {
                "radius": abs(contact.radius() / exact[0] - 1),
                "approach": abs(approach / exact[1] - 1),
                "radius of the area": abs(contact.radius_of_area() / ideal - 1),
                "pressure": contact.scatter(),
            }
        )
        rows.append(
            [
                f"{size * 1e6:g} µm",
                result.summary["candidates"],
                result.summary["pairs"][0]["contact_points"],
                f"{1e3 * contact.radius():.4f}",
                f"{1e6 * approach:.3f}",
            ]
            + [f"{100 * e:.2f} %" for e in errors[-1].values()]
        )
    rows.append(["elastic ball", "", "", f"{1e3 * exact[0]:.4f}", f"{1e6 * exact[1]:.3f}"] + [""] * 4)
    rows.append(
        ["Hertz", "", "", f"{1e3 * ideal:.4f}", f"{1e6 * hertz.approach(contact.total):.3f}"] + [""] * 4
    )
    bench.table(
        [
            "elements at the contact",
            "patches",
            "pressing",
            "radius (mm)",
            "approach (µm)",
            "radius: error",
            "approach: error",
            "radius of the pressed area: error",
            "pressure: rms error over the largest",
        ],
        rows,
    )

    bench.compare("force on the whole ball (N)", contact.total, weight, 1e-10, "round-off: equilibrium")
    bench.compare(
        "radius (mm), finest mesh, against the elastic ball",
        1e3 * contact.radius(),
        1e3 * exact[0],
        bounds["radius"],
        "decreases faster than the element size",
    )
    bench.compare(
        "approach (µm), finest mesh, against the elastic ball",
        1e6 * approach,
        1e6 * exact[1],
        bounds["approach"],
        "decreases with the element size",
    )
    bench.compare(
        "radius of the pressed area (mm), finest mesh, against Hertz",
        1e3 * contact.radius_of_area(),
        1e3 * ideal,
        bounds["radius of the area"],
        "half an element at the edge",
    )
    bench.compare(
        "radius (mm), finest mesh, against Hertz",
        1e3 * contact.radius(),
        1e3 * ideal,
        0.02,
        "Hertz neglects a/R = 0.02",
    )
    bench.compare(
        "approach (µm), finest mesh, against Hertz",
        1e6 * approach,
        1e6 * hertz.approach(contact.total),
        0.02,
        "Hertz neglects 0.54 a/R = 0.011",
    )
    bench.below(
        "pressure against Hertz, finest mesh: rms error over the largest",
        errors[-1]["pressure"],
        bounds["pressure"],
        "inaccurate at the edge, where the pressure falls like a square root",
    )
    bench.below(
        "largest penetration over the approach",
        result.summary["max_penetration_m"] / approach,
        1e-10,
        "round-off: equality in (2)",
        rests_on="construction",
    )
    for name in errors[0]:
        rates = [np.log2(coarse[name] / fine[name]) for coarse, fine in zip(errors, errors[1:])]
        bench.at_least(
            f"order: {name} over the size, from the two finest meshes",
            rates[-1],
            0.5,
            "elements that do not follow the edge reduce the order",
        )

    figure, (left, right) = bench.figure(2)
    for (size, shown), marker, colour in zip(contacts.items(), "s^o", (ORANGE, GREEN, BLUE)):
        left.plot(
            shown.distance * 1e3,
            shown.force / shown.area / 1e9,
            marker,
            markersize=3,
            color=colour,
            label=f"elements of {size * 1e6:g} µm",
        )
    r = np.linspace(0, 1.4 * ideal, 300)
    left.plot(r * 1e3, hertz.pressure(r, contact.total) / 1e9, color="black", linewidth=1, label="Hertz")
    left.set(
        xlabel="distance from the axis (mm)",
        ylabel="pressure (GPa)",
        xlim=(0, 1.4e3 * ideal),
        ylim=(0, None),
        title="Pressure",
    )
    left.legend()
    for name, colour in zip(errors[0], (BLUE, GREEN, RED, PURPLE)):
        slopes(right, np.array(sizes) * 1e6, [e[name] for e in errors], name, colour)
    right.set(xlabel="size of elements (µm)", ylabel="relative error", title="Errors")
    right.legend(fontsize=7)
    bench.save(figure, "A ball of 10 mm on a plane under 246 N")
