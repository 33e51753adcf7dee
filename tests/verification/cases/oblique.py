# SPDX-License-Identifier: BSD-2-Clause
"""Two equal balls meet obliquely at 0.01 m/s, with friction (`meshes/oblique`). The reference is the problem of Maw, Barber and Fawcett,
which `oblique_impact.py` solves anew, by independent Coulomb springs and again on annuli: half-spaces in Hertzian contact, of which an annulus sticks
and the rest slips. Two like bodies have no coupling of normal and tangential motion, which the theory neglects; a ball on a
rigid plane has it (`plane.toml`), and the figure shows what it changes. With ψ = κ v_t/(μ v_n) and
κ = 2(1 − ν)/(2 − ν), a ball that arrives at ψ₁ leaves at ψ₂; where ψ₂ < 0, the contact springs back against the slip. The figure also
shows rigid balls with Coulomb friction, which cannot spring back."""
import numpy as np

import oblique_impact
from case import BLUE, GREY, ORANGE
from rebound import spin
from ricochet.programs import ROOT

TITLE = "Oblique impact: Maw, Barber and Fawcett"
SOURCE = "Maw, Barber & Fawcett 1976, Wear 38, 101; Johnson 1985, *Contact Mechanics*, section 11.6."
RESTS_ON = "theory"
LONG = True
RADIUS, FRICTION, NORMAL = 0.01, 0.3, 0.01
PSI = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0)
FINE_BELOW = 1.0  # ψ₁ below which most of the contact sticks, so that the patches need smaller elements:
FINE = 8.8e-6  # m; with the 12.8 µm of the scene, the restitution is up to 0.027 off


def after(bench, scene, poisson, psi, bodies, size=None):
    """ψ₂ and Rω of the impact at ψ₁, of both balls together. `size` of the elements [m]: that of the scene by default."""
    kappa = oblique_impact.stiffness_ratio(poisson)
    tangential = psi * FRICTION * NORMAL / kappa
    sets = [f"title=nu {poisson:g} psi {psi:g}"]
    for body, (sign, _) in bodies.items():
        sets.append(f"bodies.{body}.material.poisson={poisson}")
        if size:
            sets.append(f"bodies.{body}.geometry.size={size}")
        share = sign / len(bodies)
        sets.append(f"bodies.{body}.velocity=[{share * tangential!r},0,{-share * NORMAL!r}]")
    result = bench.impact(scene, *sets)
    velocity = sum(sign * result.bodies[body].velocity[-1][0] for body, (sign, _) in bodies.items())
    rolling = sum(RADIUS * spin(result, body, height, RADIUS) for body, (_, height) in bodies.items())
    return kappa * (velocity - rolling) / (FRICTION * NORMAL), rolling


def run(bench):
    scene = ROOT / "meshes" / "oblique" / "oblique.toml"
    pair = {"upper": (1, RADIUS), "lower": (-1, -RADIUS)}
    figure, axes = bench.figure(columns=2)
    for poisson, colour in ((0.23, ORANGE), (0.3, BLUE), (0.49, GREY)):
        exact = oblique_impact.impact(poisson, FRICTION, np.array(PSI))
        ours = [after(bench, scene, poisson, psi, pair, FINE if psi < FINE_BELOW else None) for psi in PSI]
        for k, psi in enumerate(PSI):
            bench.compare(
                f"ν = {poisson:g}, ψ₁ = {psi:g}: tangential restitution −ψ₂/ψ₁",
                -ours[k][0] / psi,
                -float(exact.psi2[k]) / psi,
                0.02,
                "a/R = 0.005, six points or more across the contact radius, and the slip across the motion that the theory leaves out",
                absolute=True,
            )
            bench.compare(
                f"ν = {poisson:g}, ψ₁ = {psi:g}: spin Rω/v_n",
                ours[k][1] / NORMAL,
                float(exact.spin[k]),
                0.02,
                "as above",
            )
        fine = np.linspace(0.02, 6, 60)
        axes[0].plot(fine, oblique_impact.impact(poisson, FRICTION, fine, cells=50).psi2, color=colour)
        axes[0].plot(PSI, [psi2 for psi2, _ in ours], "o", color=colour, label=f"two balls, ν = {poisson:g}")
        axes[1].plot(fine, oblique_impact.impact(poisson, FRICTION, fine, cells=50).spin, color=colour)
        axes[1].plot(PSI, [rolling / NORMAL for _, rolling in ours], "o", color=colour)
    alone = [after(bench, scene.with_name("plane.toml"), 0.3, psi, {"ball": (1, RADIUS)}) for psi in PSI]
    for axis, values in zip(axes, ([psi2 for psi2, _ in alone], [rolling / NORMAL for _, rolling in alone])):
        axis.plot(PSI, values, "x", color="black", label="ball on a rigid plane, ν = 0.3")
    rigid = oblique_impact.rigid_coulomb(fine, oblique_impact.chi(0.3))
    axes[0].plot(fine, rigid, color="black", linestyle="--", linewidth=1, label="rigid balls, ν = 0.3")
    axes[0].set(xlabel="ψ₁", ylabel="ψ₂")
    axes[1].set(xlabel="ψ₁", ylabel="Rω / v_n, all balls")
    axes[0].legend(fontsize=7)
    bench.save(
        figure,
        "Tangential velocity and spin after an oblique impact: lines of the theory, circles ours; crosses: ours on a rigid plane; dashed: rigid balls",
    )
