# SPDX-License-Identifier: BSD-2-Clause
"""Olson and Lindberg measured the natural frequencies of a fan blade, a steel plate bent to a cylinder and clamped along one
curved edge. It is 304.8 mm wide along the arc and long, 3.048 mm thick, with a radius of 609.6 mm. The report was not at
hand; the test `Shell_Eigenanalysis_Cylinder` of Elmer lists the seven measured frequencies, the dimensions and the
material, 206.84 GPa, ν = 0.3 and 7747.73 kg/m³, and the frequencies that its own shell elements give.

Body as built: a solid plate, one element thick, held in all directions on the clamped edge. Nothing is adjusted. The source
states neither an error of the measurement nor how the plate was clamped."""
import numpy as np

from case import BLUE, GREY, ORANGE

TITLE = "Measured: frequencies of a curved fan blade"
SOURCE = (
    "Olson & Lindberg 1968, *Vibration analysis of cantilevered curved plates using a new cylindrical shell finite element*, "
    "AFFDL-TR-68-150; its values as in `fem/tests/Shell_Eigenanalysis_Cylinder` (`Readme.txt`, `eigenanalysis.sif`, `mesh.nodes`) of "
    "the repository ElmerCSC/elmerfem."
)
RESTS_ON = "experiment"
LONG = False
MEASURED = np.array([86.6, 135.5, 258.9, 350.6, 395.2, 531.1, 743.2])  # Hz
ELMER = np.array([95.3, 145.3, 251.6, 362.5, 404.6, 535.3, 748.0])

GEO = """// A sector of a cylindrical plate about the y axis, 0.5 rad about z, clamped at y = 0.
DefineConstant[radius = 0.6096, thickness = 3.048e-3, length = 0.3048, across = 8];
a = 0.25; inner = radius - thickness / 2; outer = radius + thickness / 2;
Point(1) = {0, 0, 0};
Point(2) = {-inner * Sin(a), 0, inner * Cos(a)}; Point(3) = {inner * Sin(a), 0, inner * Cos(a)};
Point(4) = {outer * Sin(a), 0, outer * Cos(a)}; Point(5) = {-outer * Sin(a), 0, outer * Cos(a)};
Circle(1) = {2, 1, 3}; Line(2) = {3, 4}; Circle(3) = {4, 1, 5}; Line(4) = {5, 2};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = across + 1; Transfinite Curve{2, 4} = 2; Transfinite Surface{1}; Recombine Surface{1};
plate[] = Extrude {0, length, 0} { Surface{1}; Layers{across}; Recombine; };
Physical Volume("blade") = {plate[1]};
Physical Surface("root") = {1};
"""
SCENE = f"""[bodies.blade]
mesh = "blade.geo"
order = 4
material = {{ density = 7747.73, young = 206.84e9, poisson = 0.3 }}
support = {{ root = "xyz" }}
[modes]
count = {len(MEASURED)}
residual_flexibility = false
"""


REASON = (
    "the source states no error; frequencies of bending follow the thickness, which a sheet of 3 mm has within a few per cent, and a clamp "
    "that yields lowers them"
)


def frequencies(bench, across):
    with bench.kernel(
        bench.folder / "blade.toml", f"bodies.blade.geometry={{across={across}}}", body="blade"
    ) as kernel:
        return kernel["modes/angular_frequency"][:] / (2 * np.pi)


def run(bench):
    bench.write("blade.geo", GEO)
    bench.write("blade.toml", SCENE)
    ours, finer = frequencies(bench, 8), frequencies(bench, 12)
    deviation = 100 * (ours / MEASURED - 1)
    for k, (found, measured) in enumerate(zip(ours, MEASURED), 1):
        bench.compare(f"frequency {k} (Hz)", found, measured, 0.05, REASON)
    bench.compare(
        "mean of ours / measured", (ours / MEASURED).mean(), 1.0, 0.03, "the same, without its sign"
    )
    bench.below(
        "largest relative change with 12 instead of 8 elements along each side",
        np.abs(finer / ours - 1).max(),
        2e-3,
        "a tenth of the differences from the measurement",
        rests_on="ourselves",
    )
    bench.table(
        ["mode", "measured (Hz)", "ours", "deviation (%)", "shells of Elmer", "deviation (%)"],
        [
            [str(k), f"{m:.1f}", f"{o:.1f}", f"{d:+.1f}", f"{e:.1f}", f"{100 * (e / m - 1):+.1f}"]
            for k, (m, o, d, e) in enumerate(zip(MEASURED, ours, deviation, ELMER), 1)
        ],
    )
    figure, ax = bench.figure()
    modes = np.arange(1, 1 + len(ours))
    ax.axhline(0, color=GREY, linewidth=0.8)
    ax.plot(modes, deviation, "o", color=BLUE, label="ours")
    ax.plot(modes, 100 * (ELMER / MEASURED - 1), "x", color=ORANGE, label="shells of Elmer")
    ax.set(xlabel="mode", ylabel="computed / measured − 1 (%)", title="Curved fan blade of 305 mm")
    ax.legend()
    bench.save(figure, "Frequencies of a clamped curved plate beside the measured ones")
