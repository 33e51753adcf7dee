# SPDX-License-Identifier: BSD-2-Clause
"""The demonstration of RUScal contains the measured resonances of a free cylinder of steel 4140, 19.00 mm in diameter, 13.38 mm high and of
29.70 g. The authors fitted two numbers, C₁₁ = 275.48 GPa and C₄₄ = 82.437 GPa, to the lines compared here. Most modes are pairs, which the
real cylinder splits by up to 0.06 %.

A second run takes the usual constants of steel 4140, 205 GPa and 0.29. It contains no fitted number."""
import numpy as np

import spectra

TITLE = "Measured: resonances of a steel cylinder"
SOURCE = (
    "Torres, Flores-Betancourt & Hermann 2022, *RUScal: software for the analysis of resonant ultrasound spectroscopy measurements*, "
    "J. Acoust. Soc. Am. 151, 3547; `rusin_4140_fit.dat` and `rusout_4140_fit.dat` in the repository RUS-ORNL/RUScal."
)
RESTS_ON = "experiment"
LONG = False
DIAMETER, HEIGHT, MASS, C11, C44 = 19.00094e-3, 13.38456e-3, 29.7024e-3, 275.48e9, 82.437e9
USUAL = 205e9, 0.29
COUNT = 71

# Number of the mode, frequency measured, and computed by the authors [kHz]. Pairs that were measured as one line stand once.
RESONANCES = np.array(
    [
        (1, 98.459, 98.2496),
        (3, 121.200, 121.2419),
        (4, 127.501, 127.4423),
        (6, 139.657, 139.7319),
        (8, 142.065, 142.2107),
        (10, 144.279, 144.0507),
        (11, 157.426, 157.6010),
        (12, 165.157, 165.0574),
        (14, 171.241, 171.1782),
        (16, 177.821, 177.7728),
        (18, 187.752, 187.6735),
        (21, 193.281, 193.2030),
        (23, 194.933, 194.9696),
        (25, 206.137, 206.1877),
        (27, 218.600, 218.6748),
        (29, 226.000, 225.6944),
        (31, 226.121, 226.3402),
        (32, 236.321, 236.4309),
        (34, 241.064, 240.9142),
        (35, 242.240, 242.4838),
        (36, 242.750, 242.5144),
        (38, 244.526, 244.3986),
        (39, 244.680, 244.3986),
        (40, 246.612, 246.7010),
        (42, 251.981, 252.2184),
        (43, 252.090, 252.2184),
        (44, 259.740, 259.8948),
        (46, 266.129, 266.2142),
        (48, 279.080, 279.2254),
        (49, 281.280, 281.4714),
        (50, 281.440, 281.4714),
        (51, 282.900, 282.6001),
        (53, 291.622, 291.3330),
        (55, 294.917, 295.1311),
        (57, 296.902, 297.0854),
        (59, 300.997, 300.7325),
        (61, 301.860, 301.9960),
        (62, 302.362, 302.2391),
        (64, 303.620, 303.7378),
        (65, 304.220, 304.4116),
        (66, 304.495, 304.5038),
        (68, 307.173, 307.3930),
        (70, 315.241, 315.4739),
    ]
)

GEO = f"""SetFactory("OpenCASCADE");
Cylinder(1) = {{0, 0, 0, 0, 0, {HEIGHT}, {DIAMETER / 2}}};
Mesh.MeshSizeMin = 4.2e-3;
Mesh.MeshSizeMax = 4.2e-3;
Physical Volume("cylinder") = {{1}};
"""
SCENE = """[bodies.cylinder]
mesh = "cylinder.geo"
order = 4
material = { density = 7800, young = 210e9, poisson = 0.3 }  # each computation sets its own
[modes]
count = 10                                                   # the same
residual_flexibility = false
"""


def run(bench):
    bench.write("cylinder.geo", GEO)
    scene = bench.write("cylinder.toml", SCENE)
    density = MASS / (np.pi / 4 * DIAMETER**2 * HEIGHT)
    ours, usual = (
        spectra.frequencies(bench, scene, "cylinder", spectra.isotropic(density, *constants), COUNT)
        for constants in (spectra.engineering(C11, C44), USUAL)
    )
    figure = spectra.compare(
        bench,
        ours,
        usual,
        RESONANCES,
        (4e-4, "half the misfit; elements of order 4, two per wavelength of shear waves"),
        "A cylinder of steel 4140",
    )
    bench.save(figure, "Measured and computed resonances of a cylinder of steel")
