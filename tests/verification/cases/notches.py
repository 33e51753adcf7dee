# SPDX-License-Identifier: BSD-2-Clause
"""Stress at rest where it is largest, on the border of bodies. NAFEMS LE10 is a quarter of a thick elliptic plate with an elliptic hole
under a pressure on its upper face; point D is the corner of that face on the rim of the hole, where three free or loaded faces meet, so
that all six components are known: σ_yy is published, σ_zz is the pressure, and the others are 0. Kirsch's plate has a round hole and is pulled;
here it is 40 holes wide, and Poisson's ratio is 0, so that a plate of one layer of bricks is in plane stress. Lamé's cylinder is thick and under a pressure
in its bore, in plane strain. In each of them the stress falls from the border over a length that the coarsest mesh does not resolve."""
import numpy as np

from case import BLUE, GREEN, ORANGE, plain_ticks

TITLE = "Stress at notches and holes"
SOURCE = (
    "NAFEMS, *The Standard NAFEMS Benchmarks*, TNSB rev. 3, 1990, test LE10, as quoted in the manuals of Abaqus (4.2.10) and of "
    "Code_Aster (V3.04.157). Kirsch 1898 and Lamé 1852, as in Timoshenko & Goodier 1970, *Theory of Elasticity*, sections 35 and 28."
)
RESTS_ON = "theory"
LONG = False

LE10 = """// A quarter of an elliptic plate with an elliptic hole.
DefineConstant[size = 0.1];
Point(1) = {2, 0, 0}; Point(2) = {3.25, 0, 0}; Point(3) = {0, 2.75, 0}; Point(4) = {0, 1, 0}; Point(5) = {0, 0, 0};
Ellipse(1) = {1, 5, 1, 4}; Line(2) = {4, 3}; Ellipse(3) = {3, 5, 2, 2}; Line(4) = {2, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
lower[] = Extrude {0, 0, 0.3} { Surface{1}; };
upper[] = Extrude {0, 0, 0.3} { Surface{lower[0]}; };
MeshSize{:} = size;
middle[] = Boundary{ Surface{lower[4]}; };
Physical Volume("body") = {lower[1], upper[1]};
Physical Surface("top") = {upper[0]};
Physical Surface("on x") = {lower[5], upper[5]};
Physical Surface("on y") = {lower[3], upper[3]};
Physical Surface("rim") = {lower[4], upper[4]};
Physical Curve("middle") = {Abs(middle[2])};
"""
BRICKS = """// The same plate in bricks: n through its thickness and, smaller at the hole, from hole to rim, and 2 n along the hole.
DefineConstant[n = 6];
Point(1) = {2, 0, 0}; Point(2) = {3.25, 0, 0}; Point(3) = {0, 2.75, 0}; Point(4) = {0, 1, 0}; Point(5) = {0, 0, 0};
Ellipse(1) = {1, 5, 1, 4}; Line(2) = {4, 3}; Ellipse(3) = {3, 5, 2, 2}; Line(4) = {1, 2};
Curve Loop(1) = {1, 2, 3, -4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 2 * n + 1; Transfinite Curve{2, 4} = n + 1 Using Progression 4 ^ (1 / n);
Transfinite Surface{1}; Recombine Surface{1};
lower[] = Extrude {0, 0, 0.3} { Surface{1}; Layers{n / 2}; Recombine; };
upper[] = Extrude {0, 0, 0.3} { Surface{lower[0]}; Layers{n / 2}; Recombine; };
middle[] = Boundary{ Surface{lower[4]}; };
Physical Volume("body") = {lower[1], upper[1]};
Physical Surface("top") = {upper[0]};
Physical Surface("on x") = {lower[5], upper[5]};
Physical Surface("on y") = {lower[3], upper[3]};
Physical Surface("rim") = {lower[4], upper[4]};
Physical Curve("middle") = {Abs(middle[2])};
"""
KIRSCH = """// A quarter of a square plate with a hole of radius 1, and `n` bricks along an eighth of its rim.
DefineConstant[n = 8, half = 40];
c = Sqrt(0.5);
Point(1) = {1, 0, 0}; Point(2) = {c, c, 0}; Point(3) = {0, 1, 0}; Point(4) = {0, 0, 0};
Point(5) = {half, 0, 0}; Point(6) = {half, half, 0}; Point(7) = {0, half, 0};
Circle(1) = {1, 4, 2}; Circle(2) = {2, 4, 3}; Line(3) = {1, 5}; Line(4) = {2, 6}; Line(5) = {3, 7}; Line(6) = {5, 6}; Line(7) = {6, 7};
Curve Loop(1) = {3, 6, -4, -1}; Plane Surface(1) = {1};
Curve Loop(2) = {4, 7, -5, -2}; Plane Surface(2) = {2};
Transfinite Curve{1, 2, 6, 7} = n + 1; Transfinite Curve{3, 4, 5} = 3 * n + 1 Using Progression half ^ (1 / (3 * n));
Transfinite Surface{1, 2}; Recombine Surface{1, 2};
plate[] = Extrude {0, 0, 0.2} { Surface{1, 2}; Layers{1}; Recombine; };
Physical Volume("body") = {plate[1], plate[7]};
Physical Surface("bottom") = {1, 2};
Physical Surface("on x") = {plate[2]};
Physical Surface("on y") = {plate[10]};
Physical Surface("pulled") = {plate[3]};
"""
LAME = """// A quarter of a thick cylinder with `n` bricks from its bore to its outside.
DefineConstant[n = 4];
Point(1) = {1, 0, 0}; Point(2) = {2, 0, 0}; Point(3) = {0, 2, 0}; Point(4) = {0, 1, 0}; Point(5) = {0, 0, 0};
Line(1) = {1, 2}; Circle(2) = {2, 5, 3}; Line(3) = {3, 4}; Circle(4) = {4, 5, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = n + 1; Transfinite Curve{2, 4} = 2 * n + 1; Transfinite Surface{1}; Recombine Surface{1};
tube[] = Extrude {0, 0, 0.5} { Surface{1}; Layers{n / 2}; Recombine; };
Physical Volume("body") = {tube[1]};
Physical Surface("ends") = {1, tube[0]};
Physical Surface("on x") = {tube[2]};
Physical Surface("on y") = {tube[4]};
Physical Surface("bore") = {tube[5]};
"""
FINE = 0.03  # of the elements at D of LE10 [m]
WALL = np.sqrt(1.125)  # of a point halfway through Lamé's wall, on its diagonal


def scene(name, poisson, support, touching, load, gauges):
    """The body at rest under one load. A static run has a pair: a floor far below, which the body does not reach."""
    points = "".join(
        f'[[output.gauge]]\nname = "{gauge}"\nbody = "body"\nat_body = {list(map(float, at))}\n'
        for gauge, at in gauges.items()
    )
    return f"""[bodies.body]
mesh = "{name}.geo"
order = 2
material = {{ density = 1000.0, young = 210e9, poisson = {poisson} }}
support = {support}
contact = "{touching}"
[obstacles.floor]
point = [0, 0, -10]
normal = [0, 0, 1]
[modes]
count = 3
[[loads.traction]]
body = "body"
{load}
[contact]
between = ["body", "floor"]
spacing = 1.0
scheme = "static"
{points}"""


def stresses(bench, name, geometry):
    """Stress (6) [Pa] by gauge."""
    result = bench.impact(bench.folder / f"{name}.toml", f"bodies.body.geometry={{{geometry}}}")
    return {gauge: found.stress[-1] for gauge, found in result.gauges.items()}


def le10(bench, ax):
    bench.write("le10.geo", LE10)
    support = '{ "on x" = "y", "on y" = "x", rim = "xy", middle = "z" }'
    load = 'group = "top"\nvector = [0, 0, -1e6]'
    place = (2, 0, 0.6)
    text = scene("le10", 0.3, support, "on x", load, {"D": place})
    bench.write("le10.toml", text)
    refine = f"[[bodies.body.refine]]\nat = {list(map(float, place))}\nradius = {FINE}\nsize = {FINE}\n"
    bench.write("le10-refined.toml", text.replace("[obstacles", refine + "[obstacles"))
    exact = np.array([0, -5.38, -1, 0, 0, 0])
    sizes, errors, rows = (0.2, 0.1, 0.2), [], []
    for size, name in zip(sizes, ("le10", "le10", "le10-refined")):
        found = stresses(bench, name, f"size={size}")["D"] / 1e6
        errors.append(np.abs(found - exact).max())
        mesh = f"tetrahedra of {size:g} m" + (f", {FINE:g} m at D" if name != "le10" else "")
        rows.append([mesh] + [f"{value:.3f}" for value in found])
    rows.append(["published, or a condition of the border"] + [f"{value:g}" for value in exact])
    bench.table(["LE10, stress at D (MPa)", "xx", "yy", "zz", "yz", "xz", "xy"], rows)
    bench.compare(
        f"LE10: σ_yy at D (MPa), {FINE:g} m at D",
        found[1],
        -5.38,
        0.01,
        "NAFEMS gives three digits",
        rests_on="published",
    )
    bench.below(
        f"LE10: largest error of a component at D (MPa), {FINE:g} m at D",
        errors[-1],
        0.054,
        "1 % of σ_yy",
        rests_on="published",
    )
    bench.write("le10-bricks.geo", BRICKS)
    bench.write("le10-bricks.toml", text.replace("le10.geo", "le10-bricks.geo"))
    numbers = (6, 8, 12)
    known = [0, 2, 3, 4, 5]  # all but σ_yy, whose published value has three digits
    by_border = [
        np.abs(stresses(bench, "le10-bricks", f"n={n}")["D"] / 1e6 - exact)[known].max() for n in numbers
    ]
    bench.order(
        "LE10: largest error of the components that the border gives, bricks",
        1 / np.array(numbers),
        by_border,
        3,
        0.7,
        "elements of order 2",
    )
    at_d = (0.2, 0.1, FINE)
    ax.loglog(
        at_d, np.array(errors) / 5.38, "o-", color=BLUE, markersize=4, label="LE10, all components at D"
    )


def kirsch(bench, ax):
    bench.write("kirsch.geo", KIRSCH)
    gauges = {"side": (0, 1, 0.2), "front": (1, 0, 0.2), "beside": (0, 1.5, 0.1)}
    support = '{ "on x" = "y", "on y" = "x", bottom = "z" }'
    load = 'group = "pulled"\nvector = [1, 0, 0]'
    bench.write("kirsch.toml", scene("kirsch", 0, support, "pulled", load, gauges))
    numbers, sides = (4, 8, 16), []
    for n in numbers:
        found = stresses(bench, "kirsch", f"n={n}")
        sides.append(found["side"][0])
    why = "the plate has a finite width"
    bench.compare("Kirsch: σ_xx at the side of the hole", sides[-1], 3, 0.01, why)
    bench.compare("Kirsch: σ_yy in front of the hole", found["front"][1], -1, 0.01, why)
    bench.compare(
        "Kirsch: σ_xx half a radius beside the hole",
        found["beside"][0],
        1 + 0.5 / 1.5**2 + 1.5 / 1.5**4,
        0.01,
        why,
    )
    bench.compare(
        "Kirsch: σ_xx at the side, 4 bricks on an eighth of the rim", sides[0], 3, 0.04, "0.2 radii long"
    )
    ax.loglog(
        [np.pi / 4 / n for n in numbers],
        np.abs(np.array(sides) / 3 - 1),
        "o-",
        color=ORANGE,
        markersize=4,
        label="Kirsch, side",
    )


def lame(bench, ax):
    bench.write("lame.geo", LAME)
    gauges = {"bore": (1, 0, 0.25), "wall": (WALL, WALL, 0.25), "outside": (0, 2, 0.5)}
    support = '{ "on x" = "y", "on y" = "x", ends = "z" }'
    bench.write("lame.toml", scene("lame", 0.3, support, "bore", 'group = "bore"\npressure = 1', gauges))
    numbers, errors = (2, 4, 8), []
    for n in numbers:
        found = stresses(bench, "lame", f"n={n}")
        # σ_r and σ_θ are (1 ∓ 4/r²)/3; on the diagonal, σ_xy is half their difference.
        errors.append(np.abs(found["bore"] - [-1, 5 / 3, 0.2, 0, 0, 0]).max())
    bench.compare("Lamé: hoop stress in the bore", found["bore"][1], 5 / 3, 0.01, "8 bricks through the wall")
    bench.compare("Lamé: radial stress in the bore", found["bore"][0], -1, 0.01, "8 bricks through the wall")
    bench.compare("Lamé: hoop stress outside", found["outside"][0], 2 / 3, 0.01, "8 bricks through the wall")
    bench.compare(
        "Lamé: half the difference of hoop and radial stress in the wall",
        -found["wall"][5],
        4 / 3 / 2.25,
        1e-3,
        "inside the wall",
    )
    bench.order(
        "Lamé: largest error of a component in the bore",
        1 / np.array(numbers),
        errors,
        3,
        0.7,
        "elements of order 2",
    )
    ax.loglog(
        1 / np.array(numbers),
        errors,
        "o-",
        color=GREEN,
        markersize=4,
        label="Lamé, all components in the bore",
    )


def run(bench):
    figure, ax = bench.figure()
    le10(bench, ax)
    kirsch(bench, ax)
    lame(bench, ax)
    ax.set(
        xlabel="size of an element (m)",
        ylabel="error of the stress (relative)",
        title="Stress on the border, elements of order 2",
    )
    plain_ticks(ax, (0.05, 0.1, 0.2, 0.5))
    ax.legend()
    bench.save(
        figure,
        "Errors of the largest stress against the size of the elements. Kirsch's plate has a finite width",
    )
