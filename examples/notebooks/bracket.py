#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Makes bracket.step with the OpenCASCADE kernel of gmsh: an angle bracket with a hole, 80 x 40 x 50 mm, 6 mm
thick. Lengths are in millimetres.

    /usr/bin/python3 bracket.py        # needs python3-gmsh
"""
import argparse

import gmsh


def main() -> None:
    argparse.ArgumentParser(description=__doc__, usage=argparse.SUPPRESS).parse_args()
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    foot, wall = occ.addBox(0, 0, 0, 80, 40, 6), occ.addBox(0, 0, 0, 6, 40, 50)
    hole = occ.addCylinder(55, 20, -1, 0, 0, 8, 8)
    angle, _ = occ.fuse([(3, foot)], [(3, wall)])
    occ.cut(angle, [(3, hole)])
    occ.synchronize()
    gmsh.write("bracket.step")
    gmsh.finalize()


if __name__ == "__main__":
    main()
