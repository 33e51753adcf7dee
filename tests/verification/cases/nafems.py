# SPDX-License-Identifier: BSD-2-Clause
"""Three standard benchmarks of NAFEMS for frequencies, with bricks. Test 21 is a thick square plate with hard simple supports; its
published values are those of a plate theory with shear. Such a plate of a solid material vibrates as the antisymmetric Lamb waves with
half waves between the sides do, which gives exact frequencies as well (`rayleigh_lamb`). The half of the plate above its middle plane is
meshed, since the middle plane moves across only.

FV52 is the same plate on the lines of its four lower edges. The support of a line yields the more the finer the mesh is, so
frequencies of bending have no limit: 44.7, 43.7 and 43.3 Hz with orders 2, 3 and 4. The published solution has 4 × 4 × 1 quadratic bricks, and
ours has the same. Frequencies of motion in the plane are hardly affected.

FV32 is a tapered membrane in plane stress. Here it is the half of a thin solid on one side of its middle plane."""
import numpy as np

from case import BLUE, GREY, ORANGE

TITLE = "Benchmarks of NAFEMS: plates and a membrane"
SOURCE = (
    "NAFEMS, *The Standard NAFEMS Benchmarks*, TNSB rev. 3, 1990, and *Selected Benchmarks for Forced Vibration*, R0016, 1993, as "
    "quoted in the manuals of OptiStruct (OS-V: 0440, 0455, 0470), of Code_Aster (V2.03.502, solution with bricks of 20 nodes) and "
    "of Ansys (VMC5). The Rayleigh–Lamb equation: Graff 1975, *Wave Motion in Elastic Solids*, section 8.1."
)
RESTS_ON = "published"
LONG = False
DENSITY, YOUNG, POISSON = 8000.0, 200e9, 0.3
SIDE, THICKNESS = 10.0, 1.0

# Frequencies [Hz]; multiple ones are given once for each mode.
TEST_21 = (45.897, 109.44, 109.44, 167.89, 204.51, 204.51, 256.50, 256.50)
FV52_BRICKS = (44.762, 110.52, 110.52, 169.08, 193.93, 206.64, 206.64)
FV52_PLANE = (193.59, 206.19, 206.19)
FV32 = (44.623, 130.03, 162.70, 246.05, 379.90, 391.44)
HALF_WAVES = ((1, 1), (1, 2), (2, 1), (2, 2), (1, 3), (3, 1), (2, 3), (3, 2))  # of TEST_21

GEO = """// A plate above z = 0 between x = 0 and `length`, symmetric about y = 0, `left` wide at x = 0 and `right` at the other end.
DefineConstant[length = 10, left = 10, right = 10, thickness = 1, along = 4, across = 4];
Point(1) = {0, -left / 2, 0}; Point(2) = {length, -right / 2, 0};
Point(3) = {length, right / 2, 0}; Point(4) = {0, left / 2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = along + 1; Transfinite Curve{2, 4} = across + 1; Transfinite Surface{1}; Recombine Surface{1};
plate[] = Extrude {0, 0, thickness} { Surface{1}; Layers{1}; Recombine; };
Physical Volume("plate") = {plate[1]};
Physical Surface("bottom") = {1};
Physical Surface("root") = {plate[5]};
Physical Surface("x sides") = {plate[3], plate[5]};
Physical Surface("y sides") = {plate[2], plate[4]};
Physical Curve("edges") = {1:4};
"""
SCENE = f"""[bodies.plate]
mesh = "plate.geo"
material = {{ density = {DENSITY}, young = {YOUNG}, poisson = {POISSON} }}
[modes]
count = 14
residual_flexibility = false
"""


def rayleigh_lamb(half_waves, side=SIDE, thickness=THICKNESS):
    """Lowest frequency [Hz] of an antisymmetric Lamb wave with these numbers of half waves along the sides, by bisection.

    With p² = k² − ω²/c_L² and q² = k² − ω²/c_T², both positive below the shear wave:
    (k² + q²)² tanh(p h/2) = 4 k² p q tanh(q h/2).
    """
    shear = YOUNG / (2 * (1 + POISSON))
    transverse = np.sqrt(shear / DENSITY)
    longitudinal = transverse * np.sqrt(2 * (1 - POISSON) / (1 - 2 * POISSON))
    k, half = np.pi / side * np.hypot(*half_waves), thickness / 2

    def residual(omega):
        p, q = np.sqrt(k**2 - (omega / longitudinal) ** 2), np.sqrt(k**2 - (omega / transverse) ** 2)
        return (k**2 + q**2) ** 2 * np.tanh(p * half) - 4 * k**2 * p * q * np.tanh(q * half)

    low, high = 1e-3 * k * transverse, 0.999 * k * transverse
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if residual(low) * residual(middle) > 0 else (low, middle)
    return low / (2 * np.pi)


def frequencies(bench, support, order, **geometry):
    scene = bench.folder / "plate.toml"
    words = [f"{name}={value}" for name, value in geometry.items()]
    kernel = bench.kernel(
        scene,
        f"bodies.plate.support={support}",
        f"bodies.plate.order={order}",
        f"bodies.plate.geometry={{{','.join(words)}}}",
        body="plate",
    )
    return kernel["modes/angular_frequency"][:] / (2 * np.pi)


def compare(bench, name, ours, published, bound, reason):
    for k, (found, known) in enumerate(zip(ours, published), 1):
        bench.compare(f"{name}: frequency {k} (Hz)", found, known, bound, reason)


def run(bench):
    bench.write("plate.geo", GEO)
    bench.write("plate.toml", SCENE)

    hard = frequencies(bench, '{bottom="xy","x sides"="yz","y sides"="xz"}', 4, thickness=THICKNESS / 2)
    exact = np.array([rayleigh_lamb(waves) for waves in HALF_WAVES])
    compare(bench, "Test 21", hard, TEST_21, 0.01, "the published theory of plates has one shear coefficient")
    bench.below(
        f"Test 21: largest relative error of {len(exact)} frequencies, from Rayleigh and Lamb",
        np.abs(hard[: len(exact)] / exact - 1).max(),
        5e-4,
        "order 4, half a wavelength per element",
        rests_on="theory",
    )

    edges = '{edges="z"}'
    coarse = frequencies(bench, edges, 2)
    bench.compare("FV52: rigid modes", np.count_nonzero(coarse == 0), 3, 0, "a count")
    compare(
        bench,
        "FV52",
        coarse[3:],
        FV52_BRICKS,
        0.02,
        "stated for the published mesh; its bricks have 20 nodes, ours 27",
    )
    # Frequencies in the plane are found among those of bending.
    fine = frequencies(bench, edges, 4)
    plane = [fine[np.abs(fine - FV52_PLANE[0]).argmin()], *fine[np.argsort(np.abs(fine - FV52_PLANE[1]))[:2]]]
    compare(bench, "FV52, order 4, in the plane", plane, FV52_PLANE, 1e-3, "published without its mesh")

    tapered = frequencies(
        bench, '{root="xyz",bottom="z"}', 4, left=5, right=1, thickness=0.025, along=8, across=4
    )
    compare(bench, "FV32", tapered, FV32, 2e-3, "stress is singular at the ends of the root")

    figure, ax = bench.figure()
    for name, ours, published, colour in (
        ("Test 21", hard, TEST_21, BLUE),
        ("FV52", coarse[3:], FV52_BRICKS, ORANGE),
        ("FV32", tapered, FV32, GREY),
    ):
        change = ours[: len(published)] / np.array(published) - 1
        ax.plot(np.arange(1, 1 + len(change)), 100 * change, "o-", color=colour, markersize=4, label=name)
    change = 100 * (exact / TEST_21 - 1)
    ax.plot(np.arange(1, 1 + len(change)), change, "x", color=BLUE, label="Test 21: Rayleigh and Lamb")
    ax.axhline(0, color=GREY, linewidth=0.6)
    ax.set(xlabel="mode", ylabel="difference from the published value (%)", title="Benchmarks of NAFEMS")
    ax.legend()
    bench.save(figure, "Frequencies of three benchmarks beside the published ones")
