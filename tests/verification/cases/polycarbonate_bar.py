# SPDX-License-Identifier: BSD-2-Clause
"""In the laboratory of Ganzenmüller, a bar of aluminium 7075, ⌀16 × 2415 mm, was shot end on at a free bar of polycarbonate, ⌀16.7 × 1027 mm.
Strain gauges 118 mm (near) and 489 mm (far) from the struck face recorded the force. A wave crosses the aluminium and returns in 944 µs, the
polycarbonate in 1460 µs. The aluminium has 7.8 times the impedance, so its first echo only lessens the force; the bars part when the
tensile echo of the polycarbonate arrives.

Bars as built: quarters of both, in contact with their whole faces, with modes up to 60 kHz. The speeds of waves are those that the authors
found from the round trips in this record, 5115.6 and 1406.45 m/s. Density and Poisson's ratio are the usual ones: 2810 kg/m³ and 0.33, 1200
kg/m³ and 0.37. The loss factor of polycarbonate, 0.041, follows from the attenuation 9.2·10⁻⁵ m⁻¹ Hz⁻¹ · f that the authors found from
the spectra of the front at the two gauges; the front at the far gauge is thus not independent. The speed of the impact was not recorded.
It does not matter, because all forces are divided by the plateau of the same gauge, the mean from 600 to 770 µs, nor does the calibration of
the gauges. Times are aligned at the half rise at the near gauge. Nothing else is adjusted. The length of a gauge is not stated; 3 mm is taken.

The record has a sample each microsecond; the points that show its shape are used. On the plateau, the gauges differ by 3.4 %, where
the computed difference is 1 %: this is taken as the scatter. Maxima after the second rise above the plateau by less and are not compared.
After the echo of the free end, ours swings deeper at the near gauge than the record, which the root mean square contains: a constant loss
factor describes the polymer only in part."""
import numpy as np

from case import BLUE, ORANGE

TITLE = "Measured: an aluminium bar hits a polycarbonate bar"
SOURCE = (
    "Ganzenmüller, University of Freiburg, 2026: `3wave/README.md` and `3wave/cases/identifications/pc_bar/PC_bar_calibration.txt` in the "
    "repository ggalu/WaveSeparation."
)
RESTS_ON = "experiment"
LONG = False
SPEED, DENSITY, POISSON, RADIUS = 1406.45, 1200.0, 0.37, 8.35e-3
LOSS = 9.2e-5 * SPEED / np.pi  # 2 α c/ω
GAUGES, GAUGE_LENGTH = {"near": 0.118, "far": 0.489}, 3e-3
SCATTER = 0.034
PLATEAU = 600, 770  # µs


def record(text):
    return np.array(text.split(), float).reshape(-1, 2)


# Time [µs] and force [kN]
RECORDS = {
    "near": record(
        """-20 0.006 -15 0.015 -10 0.043 -5 0.117 0 0.268 3 0.402 6 0.567 9 0.754 12 0.946 15 1.113 18 1.241 21 1.315 24 1.335
        27 1.305 30 1.250 33 1.198 38 1.165 43 1.201 48 1.271 52 1.288 58 1.275 65 1.244 73 1.294 80 1.269 85 1.261 90 1.262
        98 1.247 105 1.248 112 1.228 120 1.238 127 1.269 134 1.255 143 1.295 152 1.278 229 1.345 240 1.330 250 1.309 260 1.290
        270 1.280 280 1.274 290 1.285 300 1.294 310 1.300 320 1.297 330 1.300 340 1.309 350 1.316 360 1.317 370 1.317 380 1.313
        388 1.315 607 1.271 620 1.254 630 1.247 640 1.257 650 1.274 660 1.283 670 1.286 680 1.290 690 1.303 700 1.314 710 1.321
        720 1.321 730 1.317 740 1.309 750 1.301 760 1.297 766 1.293 924 1.266 930 1.260 936 1.248 940 1.235 944 1.214 948 1.186
        951 1.162 954 1.134 957 1.109 960 1.085 964 1.063 970 1.050 976 1.045 980 1.036 984 1.018 988 0.991 992 0.963 996 0.946
        1000 0.940 1005 0.947 1010 0.957 1016 0.963 1022 0.972 1028 0.981 1034 0.989 1040 0.984 1046 0.974 1052 0.961 1060 0.944
        1066 0.933 1073 0.930 1083 0.937 1239 0.882 1244 0.863 1248 0.840 1252 0.815 1256 0.785 1260 0.748 1264 0.705 1268 0.655
        1272 0.601 1276 0.541 1280 0.477 1284 0.410 1288 0.342 1292 0.277 1296 0.215 1300 0.158 1304 0.107 1308 0.066 1312 0.033
        1316 0.007 1320 -0.010 1326 -0.025 1332 -0.032 1340 -0.043 1348 -0.061 1356 -0.088 1364 -0.107 1372 -0.120 1380 -0.126
        1388 -0.132 1394 -0.146 1400 -0.164 1406 -0.190 1412 -0.219 1418 -0.249 1424 -0.283 1430 -0.320 1436 -0.363 1442 -0.403
        1448 -0.430 1452 -0.436 1456 -0.427 1460 -0.406 1464 -0.375 1470 -0.323 1476 -0.282 1484 -0.261 1492 -0.260 1500 -0.260
        1510 -0.247 1520 -0.216 1530 -0.180 1540 -0.161 1550 -0.160"""
    ),
    "far": record(
        """-20 -0.002 100 0 152 0 229 0.004 235 0.011 240 0.023 245 0.045 248 0.066 251 0.094 254 0.135 257 0.184 260 0.249 263 0.326
        266 0.415 269 0.516 272 0.625 275 0.738 278 0.849 281 0.952 284 1.040 287 1.108 290 1.153 294 1.176 298 1.165 302 1.133
        306 1.098 312 1.072 316 1.089 322 1.136 328 1.199 332 1.212 336 1.202 342 1.166 350 1.151 356 1.164 364 1.180 374 1.177
        382 1.203 388 1.231 607 1.264 620 1.267 640 1.264 660 1.260 680 1.242 700 1.236 720 1.231 740 1.226 760 1.224 924 1.199
        940 1.201 960 1.198 970 1.194 976 1.187 984 1.165 990 1.136 996 1.092 1000 1.053 1005 0.993 1010 0.922 1015 0.836 1020 0.742
        1025 0.642 1030 0.545 1035 0.453 1040 0.375 1045 0.318 1050 0.279 1055 0.262 1060 0.258 1066 0.264 1073 0.268 1078 0.263
        1083 0.251 1239 -0.152 1250 -0.189 1260 -0.222 1270 -0.248 1275 -0.250 1282 -0.240 1290 -0.233 1296 -0.229 1304 -0.249
        1312 -0.273 1320 -0.296 1330 -0.326 1340 -0.348 1350 -0.350 1360 -0.358 1370 -0.371 1380 -0.383 1390 -0.399 1400 -0.411
        1410 -0.410 1420 -0.411 1430 -0.408 1440 -0.408 1450 -0.405 1460 -0.401 1470 -0.398 1480 -0.393 1490 -0.388 1500 -0.380
        1520 -0.371 1550 -0.357"""
    ),
}

GEO = """// A quarter of a round bar along z, x ≥ 0 and y ≥ 0: three hexahedra across.
DefineConstant[radius = 1, length = 1, layers = 1];
b = 0.5 * radius; d = 0.46 * radius; e = radius * Sqrt(0.5);
Point(1) = {0, 0, 0}; Point(2) = {b, 0, 0}; Point(3) = {d, d, 0}; Point(4) = {0, b, 0};
Point(5) = {radius, 0, 0}; Point(6) = {e, e, 0}; Point(7) = {0, radius, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Line(5) = {2, 5}; Circle(6) = {5, 1, 6}; Line(7) = {6, 3}; Circle(8) = {6, 1, 7}; Line(9) = {7, 4};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Curve Loop(2) = {5, 6, 7, -2}; Plane Surface(2) = {2};
Curve Loop(3) = {-7, 8, 9, -3}; Plane Surface(3) = {3};
Transfinite Curve{1:9} = 2; Transfinite Surface{1:3}; Recombine Surface{1:3};
u[] = Extrude {0, 0, length} { Surface{1}; Layers{layers}; Recombine; };
v[] = Extrude {0, 0, length} { Surface{2}; Layers{layers}; Recombine; };
w[] = Extrude {0, 0, length} { Surface{3}; Layers{layers}; Recombine; };
Physical Volume("bar") = {u[1], v[1], w[1]};
Physical Surface("start") = {1:3};
Physical Surface("end") = {u[0], v[0], w[0]};
Physical Surface("y plane") = {u[2], v[2]};
Physical Surface("x plane") = {u[5], w[4]};
"""
SCENE = f"""[bodies.striker]
mesh = "bar.geo"
geometry = {{ radius = 8e-3, length = 2.415, layers = 48 }}
order = 3
translate = [0, 0, -2.415]
material = {{ density = 2810, young = {2810 * 5115.6**2:.5g}, poisson = 0.33 }}
velocity = [0, 0, 4]
contact = "end"
support = {{ "x plane" = "x", "y plane" = "y" }}
[bodies.bar]
mesh = "bar.geo"
geometry = {{ radius = {RADIUS}, length = 1.027, layers = 80 }}
order = 3
material = {{ density = {DENSITY}, young = {DENSITY * SPEED**2:.5g}, poisson = {POISSON} }}
damping = {{ loss_factor = {LOSS:.3g} }}
contact = "start"
support = {{ "x plane" = "x", "y plane" = "y" }}
[modes]
up_to_hz = 60e3
[contact]
between = ["striker", "bar"]
direction = [0, 0, 1]
[time]
rate_hz = 1e6
duration = 1.7e-3
""" + "".join(
    f"""[[output.receiver]]
name = "{gauge}-{end}"
body = "bar"
at = [{0.999 * RADIUS}, 0, {place + side * GAUGE_LENGTH / 2}]
"""
    for gauge, place in GAUGES.items()
    for end, side in (("start", -1), ("end", 1))
)


def part(curve, window):
    return curve[(curve[:, 0] >= window[0]) & (curve[:, 0] <= window[1])]


def mean(curve, window):
    """Mean force over the time from the first to the last sample in the window."""
    time, force = part(curve, window).T
    return np.trapz(force, time) / np.ptp(time)


def scaled(curve):
    """The curve (n, 2) with its force divided by the plateau."""
    return curve / [1, mean(curve, PLATEAU)]


def front(curve, *levels):
    """Times [µs] at which the first rise passes the levels."""
    end = np.argmax(curve[:, 1] > 0.9) + 1
    return np.interp(levels, curve[:end, 1], curve[:end, 0])


def maxima(curve, *windows):
    """Times [µs] and heights of the highest point in each window."""
    return np.array([max(part(curve, window), key=lambda row: row[1]) for window in windows])


def impact(bench, scene):
    """The records of both gauges by name, (n, 2): time [µs] from the arrival as measured, and force over the plateau."""
    result = bench.impact(scene)
    time = 1e6 * result.receiver_time

    def axial(name):
        return result.receivers[name].displacement[:, 2]

    raw = {gauge: scaled(np.c_[time, axial(f"{gauge}-start") - axial(f"{gauge}-end")]) for gauge in GAUGES}
    shift = front(raw["near"], 0.5) - front(scaled(RECORDS["near"]), 0.5)
    return {gauge: scaled(curve - [shift[0], 0]) for gauge, curve in raw.items()}


def numbers(near, far):
    """What is compared: name, value, absolute bound, its reason."""
    first, second = maxima(near, (15, 35), (40, 62))
    rise = np.diff(front(near, 0.1, 0.9))[0]
    travel = (front(far, 0.5) - front(near, 0.5))[0]
    later, latest = maxima(far, (285, 305), (322, 345))
    read = "each is read to 1 µs"
    return [
        ("near: rise from 10 to 90 % (µs)", rise, 2.0, "3 mm more of a gauge smear the front by 2 µs"),
        ("near: first to second maximum (µs)", second[0] - first[0], 2.0, read),
        ("near: first maximum", first[1], 2 * SCATTER, "twice the scatter"),
        ("near: force after the first echo of the aluminium", mean(near, (1000, 1090)), SCATTER, "scatter"),
        (
            "near to far: travel of the front (µs)",
            travel,
            2.0,
            "gauges are placed to 2 mm, which take 1.4 µs",
        ),
        ("far: first to second maximum (µs)", latest[0] - later[0], 2.0, read),
        ("far: first maximum", later[1], 2 * SCATTER, "twice the scatter"),
        ("far: force after the echo of the free end", mean(far, (1050, 1090)), SCATTER, "scatter"),
    ]


def run(bench):
    bench.write("bar.geo", GEO)
    scene = bench.write("bars.toml", SCENE)
    ours = impact(bench, scene)
    measured = {gauge: scaled(curve) for gauge, curve in RECORDS.items()}
    for (what, reference, bound, reason), (_, value, _, _) in zip(numbers(**measured), numbers(**ours)):
        bench.compare(what, value, reference, bound, reason, absolute=True)
    for gauge, (time, force) in ((gauge, curve.T) for gauge, curve in measured.items()):
        bench.below(
            f"{gauge}: root mean square of ours − measured",
            np.sqrt(np.mean((np.interp(time, *ours[gauge].T) - force) ** 2)),
            2 * SCATTER,
            "twice the scatter; the steep fronts weigh most",
        )

    figure, axes = bench.figure(2)
    for ax, (gauge, place) in zip(axes, GAUGES.items()):
        ax.plot(*ours[gauge].T, color=BLUE, label="ours")
        ax.errorbar(
            *measured[gauge].T,
            yerr=SCATTER,
            fmt=".",
            color=ORANGE,
            markersize=4,
            linewidth=0.6,
            label="measured",
        )
        ax.set(
            xlabel="time (µs)",
            ylabel="force over its plateau",
            title=f"{1e3 * place:.0f} mm from the struck face",
            xlim=(-50, 1600),
        )
        ax.legend(loc="lower left")
    bench.save(figure, "Force at two gauges on a bar of polycarbonate, struck by a bar of aluminium")
