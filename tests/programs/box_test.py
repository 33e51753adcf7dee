# SPDX-License-Identifier: BSD-2-Clause
"""The box of boxes.py, from its own mesh and from its matrices: the common base of the tests of imported bodies and of exports
to other programs."""

from boxes import MATERIAL, Box, listed, matrix_market
from programs import Command, ProgramTest, kernel

SCENE = """
title = "Box"
[bodies.box]
mesh = "{mesh}"
{material}
damping = {{ loss_factor = 0.01 }}
contact = "foot"
velocity = [0, 0, -0.1]
[obstacles.floor]
normal = [0, 0, 1]
[modes]
count = 40
[contact]
between = ["box", "floor"]
gap = 0.01
[time]
rate_hz = 40
duration = 1.5
"""


class BoxTest(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.all = cls.shared_folder()
        cls.box = Box()
        cls.stiffness, cls.mass = cls.box.matrices()
        texts = {
            "box.msh": cls.box.gmsh(),
            "K.mtx": matrix_market(cls.stiffness),
            "M.mtx": matrix_market(cls.mass, False),
            "nodes.txt": listed(cls.box.node),
            "foot.txt": listed(cls.box.foot + 1),
            "top.txt": listed(cls.box.top + 1),
        }
        material = "material = {" + ", ".join(f"{key} = {value}" for key, value in MATERIAL.items()) + "}"
        texts |= {
            "own.toml": SCENE.format(mesh="box.msh", material=material),
            "imported.toml": SCENE.format(mesh="box.h5", material=""),
        }
        for name, text in texts.items():
            (cls.all / name).write_text(text)
        cls.matrices = [cls.all / name for name in ("K.mtx", "M.mtx", "nodes.txt")]
        surfaces = [
            word for name in ("foot", "top") for word in ("--surface", f"{name}={cls.all / name}.txt")
        ]
        run = Command("import", "matrices", *cls.matrices, *surfaces, "--out", cls.all / "box.h5")
        assert run.status == 0, run.err
        for name in ("own", "imported"):
            run = kernel(cls.all / f"{name}.toml", cls.all / name)
            assert run.status == 0, run.err
