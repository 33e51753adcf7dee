# SPDX-License-Identifier: BSD-2-Clause
"""The laboratory of Ramshaw measured 84 resonances of a crystal of Mn₃Ge, 0.911 × 1.02 × 1.305 mm, of 8.9 mg, by resonant ultrasound
spectroscopy, and fitted the five constants of a hexagonal law to them. Their report lists measured frequencies and those that they computed
with polynomials of degree 16. The first 40 lines are compared. Axis 3, the sixfold axis, is along the longest edge.

The report does not state with which digits of the constants its frequencies were computed: ours differ most, by 5e-4, in lines that depend
on C₄₄ alone, and by up to 1.3e-4 in lines that hardly depend on it."""
import numpy as np

import spectra
from block import GEO, SCENE

TITLE = "Measured: resonances of a hexagonal crystal"
SOURCE = "rus_fitting of the Ramshaw laboratory (github.com/CHiLL-Ramshaw/rus_fitting), fit_report.txt; examples/rus_mn3ge_2001B.py names the sample."
RESTS_ON = "experiment"
LONG = False
SIDES, MASS = (0.911e-3, 1.02e-3, 1.305e-3), 8.9e-6
C11, C12, C13, C33, C44 = 138.441e9, 42.271e9, 14.394e9, 194.341e9, 45.052e9

# Number of the mode, frequency measured, and computed by the authors [kHz]
RESONANCES = np.array(
    [
        (1, 863.29, 859.139),
        (2, 1315.918, 1312.529),
        (3, 1337.735, 1336.326),
        (4, 1359.745, 1360.486),
        (5, 1380.895, 1380.331),
        (6, 1451.318, 1453.126),
        (7, 1627.631, 1624.861),
        (8, 1652.097, 1659.767),
        (9, 1667.51, 1663.649),
        (10, 1706.839, 1707.044),
        (11, 1819.579, 1814.755),
        (12, 1858.302, 1858.682),
        (13, 1876.659, 1872.367),
        (14, 1905.238, 1902.791),
        (15, 1914.726, 1914.24),
        (16, 1950.258, 1950.092),
        (17, 2043.762, 2038.791),
        (18, 2056.432, 2052.098),
        (19, 2073.754, 2078.406),
        (20, 2154.024, 2148.248),
        (21, 2259.128, 2251.647),
        (22, 2267.891, 2264.346),
        (23, 2282.1, 2274.874),
        (24, 2286.72, 2280.166),
        (25, 2331.612, 2324.216),
        (26, 2353.409, 2356.402),
        (27, 2397.702, 2396.191),
        (28, 2405.233, 2406.137),
        (29, 2452.348, 2451.473),
        (30, 2481.088, 2481.566),
        (31, 2495.769, 2489.574),
        (32, 2510.943, 2519.139),
        (33, 2573.004, 2577.965),
        (34, 2587.117, 2583.407),
        (35, 2645.635, 2648.471),
        (36, 2660.829, 2662.291),
        (37, 2707.036, 2714.379),
        (38, 2718.903, 2720.887),
        (39, 2787.169, 2787.052),
        (40, 2819.064, 2820.202),
    ]
)


def run(bench):
    bench.write("box.geo", GEO)
    a, b, c = SIDES
    density, c66 = MASS / np.prod(SIDES), (C11 - C12) / 2
    text = SCENE.format(density=density, young=1e11, poisson=0.2, count=6 + len(RESONANCES))
    scene = bench.write(
        "crystal.toml",
        text.replace("order = 5", f"order = 4\ngeometry = {{ a = {a}, b = {b}, c = {c}, n = 3 }}"),
    )
    law = [C11, C12, C13, 0, 0, 0, C11, C13, 0, 0, 0, C33, 0, 0, 0, C44, 0, 0, C44, 0, c66]
    material = f"{{density={density:.7g},stiffness={law}}}"
    ours = spectra.frequencies(bench, scene, "box", material, len(RESONANCES))
    figure = spectra.compare(
        bench,
        ours,
        None,
        RESONANCES,
        (1e-3, "digits of the constants that the report does not state, above all of C₄₄"),
        "A crystal of Mn₃Ge",
    )
    bench.save(figure, "Measured and computed resonances of a crystal of Mn₃Ge")
