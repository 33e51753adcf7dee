# SPDX-License-Identifier: BSD-2-Clause
"""gmsh cannot take the program down: whatever ends it is one line with its last message, without files, on any number of ranks."""

import os
import re
import unittest
from unittest import mock

from programs import Command, ProgramTest, kernel, kernel_server

kernel_server()
os.environ.pop("RICOCHET_FORK_MESH", None)  # a fork of that server shares memory with it

SCENE = """
title = "Box"
[bodies.box]
mesh = "box.geo"
material = "steel"
order = 1
[modes]
count = 1
"""
BOX = 'SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 1, 1, 1};\n'
UNEQUAL = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1 : 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 2, 4} = 5; Transfinite Curve {3} = 7; Transfinite Surface {1};
Extrude {0, 0, 1} { Surface{1}; }
"""


class Mesher(ProgramTest):
    def setUp(self):
        super().setUp()
        self.scene = self.write("box.toml", SCENE)
        self.out = self.folder / "out"

    def refuse(self, geo, *parts, ranks=1, sets=()):
        self.write("box.geo", geo)
        before = sorted(os.listdir("/tmp"))
        self.refused(kernel(self.scene, self.out, *sets, ranks=ranks), "ricochet-kernel: box.geo: ", *parts)
        self.assertFalse(self.out.exists() and list(self.out.iterdir()))
        left = [name for name in os.listdir("/tmp") if name not in before and name.endswith(".geo")]
        left = [name for name in left if not re.fullmatch(r"ricochet-\d+-\d+\.geo", name)]  # of unit tests
        self.assertEqual(left, [])

    def test_states_what_gmsh_throws_through_openmp(self):
        self.refuse(UNEQUAL, "gmsh: Surface 1 cannot be meshed", "divisions 6 != 4", ranks=3)
        size = BOX + "DefineConstant[ size = 1 ];\nMesh.MeshSizeMax = size;\n"
        self.refuse(size, "Wrong mesh element size", sets=["bodies.box.geometry.size=0"])

    def test_survives_each_signal(self):
        for name, ranks in (("SEGV", 1), ("ABRT", 2)):
            self.refuse(
                f'{BOX}SystemCall "kill -{name} $PPID";', "gmsh: crashed", "last message", ranks=ranks
            )
        self.refuse(f'{BOX}SystemCall "kill -KILL $PPID";', "gmsh: was ended with")

    def test_does_not_take_exit_for_success(self):
        self.refuse(BOX + "Exit;", "ended before there was a mesh", "Exit", ranks=2)

    def test_ends_gmsh_at_the_limits(self):
        endless = "For i In {0 : 1e12}\n a = i;\nEndFor\n"
        with mock.patch.dict(os.environ, RICOCHET_MESH_SECONDS="1"):
            self.refuse(endless, "was ended after 1 s of processor time", "RICOCHET_MESH_SECONDS")
        many = BOX + "Mesh.MeshSizeMax = 0.004;"
        with mock.patch.dict(os.environ, RICOCHET_MESH_MIB="100"):
            self.refuse(many, "memory")
        with mock.patch.dict(os.environ, RICOCHET_MESH_MIB="plenty"):
            self.write("box.geo", BOX)
            self.refused(
                kernel(self.scene, self.out), 'RICOCHET_MESH_MIB = "plenty": must be a positive number'
            )

    def test_also_serves_surfaces(self):
        path = self.write("box.geo", f'{BOX}SystemCall "kill -SEGV $PPID";')
        self.refused(Command("surfaces", path), "box.geo: gmsh crashed (SIGSEGV)")
        self.refused(Command("surfaces", self.write("box.geo", BOX + "Exit;")), "box.geo: gmsh ended")
        self.refused(
            Command("surfaces", self.write("box.geo", BOX + "Mesh.MeshSizeMax = 0;")), "box.geo: gmsh"
        )


if __name__ == "__main__":
    unittest.main()
