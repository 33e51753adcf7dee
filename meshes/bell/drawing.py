#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Draws bell.step with the OpenCASCADE kernel of gmsh: a church bell of 400 mm diameter, its profile turned about the z axis.
Lengths in millimetres.

    /usr/bin/python3 drawing.py        # needs python3-gmsh
"""
import argparse
import math

import gmsh

# From the lip up to the flat crown: radius and height. The wall is 28 mm thick at the sound bow, where the clapper strikes,
# and 10 mm at the waist.
OUTSIDE = [
    (200, 0),
    (195.9, 16.5),
    (181.8, 40.1),
    (157.7, 77.9),
    (135.2, 125.1),
    (118.4, 177),
    (106.4, 231.3),
    (97.7, 283.2),
    (93.4, 313.9),
    (88.6, 331.9),
    (74.2, 344.3),
    (53.4, 347.9),
]
INSIDE = [
    (188, 0.8),
    (170.6, 21.2),
    (148.9, 40.1),
    (133.1, 77.9),
    (119.4, 125.1),
    (106.6, 177),
    (95.8, 231.3),
    (87.2, 283.2),
    (82.9, 313.9),
    (77.7, 324.7),
    (68.5, 330.7),
    (53.4, 331.9),
]
HOLE = 24  # radius of the hole in the crown, by which the bell hangs


def main():
    argparse.ArgumentParser(description=__doc__, usage=argparse.SUPPRESS).parse_args()
    gmsh.initialize()
    occ = gmsh.model.occ
    outside, inside = ([occ.addPoint(r, 0, z) for r, z in profile] for profile in (OUTSIDE, INSIDE))
    top, bottom = (occ.addPoint(HOLE, 0, profile[-1][1]) for profile in (OUTSIDE, INSIDE))
    section = occ.addPlaneSurface(
        [
            occ.addCurveLoop(
                [
                    occ.addSpline(outside),
                    occ.addLine(outside[-1], top),
                    occ.addLine(top, bottom),
                    occ.addLine(bottom, inside[-1]),
                    occ.addSpline(inside),
                    occ.addLine(inside[0], outside[0]),
                ]
            )
        ]
    )
    occ.revolve([(2, section)], 0, 0, 0, 0, 0, 1, 2 * math.pi)
    occ.remove([(2, section)], recursive=True)
    occ.synchronize()
    gmsh.write("bell.step")
    gmsh.finalize()


if __name__ == "__main__":
    main()
