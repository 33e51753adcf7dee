#!/usr/bin/python3
# SPDX-License-Identifier: BSD-2-Clause
"""Draws phone.step with the OpenCASCADE kernel of gmsh: the back shell of a phone, a tray with rounded corners and edges, a
raised frame for the camera, and a rim that is higher at its corners. Lengths in millimetres; the back is at z = 0, the open side above.

    /usr/bin/python3 drawing.py        # needs python3-gmsh
"""
import argparse
import math

import gmsh

LENGTH, WIDTH, HEIGHT = 150, 75, 8
WALL = 1.6
CORNER = 10  # radius of the corners seen from above
EDGE = 3  # radius of the edge around the back
CAMERA, BUMP = 26, 1.4  # side of the frame and its height over the back
MARGIN = 7  # from the sides of the shell to the frame
LIP = 0.4  # by which the corners of the rim stand over its sides


def block(x, y, z, dx, dy, dz, corner, edge=0):
    """A box whose vertical edges, and then those of its lower face, are rounded."""
    occ = gmsh.model.occ
    body = occ.addRectangle(x, y, z, dx, dy, roundedRadius=corner)
    ((_, volume),) = (part for part in occ.extrude([(2, body)], 0, 0, dz) if part[0] == 3)
    if edge:
        occ.synchronize()
        lower = [tag for dim, tag in gmsh.model.getBoundary([(2, body)], oriented=False)]
        ((_, volume),) = occ.fillet([volume], lower, [edge])
    return volume


def main():
    argparse.ArgumentParser(description=__doc__, usage=argparse.SUPPRESS).parse_args()
    gmsh.initialize()
    occ = gmsh.model.occ
    inner = [LENGTH - 2 * WALL, WIDTH - 2 * WALL, HEIGHT]
    outside = block(0, 0, 0, LENGTH, WIDTH, HEIGHT, CORNER, EDGE)
    inside = block(WALL, WALL, WALL, *inner, CORNER - WALL, EDGE - WALL)
    frame = block(MARGIN, MARGIN, -BUMP, CAMERA, CAMERA, BUMP + WALL / 2, 0)
    along = occ.addBox(CORNER, -1, HEIGHT - LIP, LENGTH - 2 * CORNER, WIDTH + 2, 1)
    across = occ.addBox(-1, CORNER, HEIGHT - LIP, LENGTH + 2, WIDTH - 2 * CORNER, 1)
    shell, _ = occ.cut([(3, outside)], [(3, inside), (3, along), (3, across)])
    occ.fuse(shell, [(3, frame)])
    occ.synchronize()
    gmsh.write("phone.step")
    gmsh.finalize()


if __name__ == "__main__":
    main()
