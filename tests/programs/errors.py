# SPDX-License-Identifier: BSD-2-Clause
"""Bad input: one line that states the place, the fault and the remedy; status 2; nothing is lost; no rank hangs."""

import shutil
import unittest

import h5py

import scenes
from programs import ProgramTest, contact, impact, kernel

ROD = scenes.rod()
SCENE = scenes.two_rods("Errors", "count = 8", "rate_hz = 100\nduration = 1", ("a", "b"), speed=1)

# The first two nodes of the second tetrahedron are exchanged, so its volume is negative.
INVERTED = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 2 "left"
3 1 "body"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 1 1
$EndNodes
$Elements
3
1 2 2 2 1 1 3 2
2 4 2 1 1 1 2 3 4
3 4 2 1 1 3 2 4 5
$EndElements
"""


class Errors(ProgramTest):
    """Wrong input that no table of mistakes.py shows: files that were changed, and what several ranks find at once."""

    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        (cls.made / "rod.geo").write_text(ROD)
        (cls.made / "scene.toml").write_text(SCENE)
        run = kernel(cls.made / "scene.toml", cls.made / "out")
        assert run.status == 0, run.err

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made, self.folder, dirs_exist_ok=True)
        self.scene, self.out = self.folder / "scene.toml", self.folder / "out"

    def test_what_ranks_find_is_said_once(self):
        self.write("inverted.msh", INVERTED)
        inverted = ["bodies.b.mesh=inverted.msh", "bodies.b.material={density=1,young=1}"]
        for sets, *parts in (
            (["bodies.a.yuong=3"], "scene.toml", "bodies.a.yuong", "unknown"),
            (inverted, "inverted.msh", "element 3"),
            (["modes.count=100"], "modes.count", "100", "11"),
        ):
            with self.subTest(sets=sets):
                self.refused(kernel(self.scene, self.out, *sets, ranks=3), *parts)

    def test_kernel_of_another_scene(self):
        path = self.one(self.out, "a-*.kernel.h5")
        with h5py.File(path, "r+") as file:
            file.attrs.modify("hash", b"0" * 64)
        self.refused(contact(self.scene, self.out), path.name, "another scene", "Run ricochet-kernel")

    def test_truncated_kernel(self):
        path = self.one(self.out, "b-*.kernel.h5")
        whole = path.read_bytes()
        for part in (0, 100, len(whole) // 2, len(whole) - 1):
            path.write_bytes(whole[:part])
            with self.subTest(bytes=part):
                self.refused(contact(self.scene, self.out), path.name)
        # ricochet-kernel replaces a file that it cannot read.
        self.succeed(kernel(self.scene, self.out))
        self.succeed(contact(self.scene, self.out))

    def test_a_refused_run_leaves_earlier_results(self):
        self.succeed(contact(self.scene, self.out))
        before = {path.name: path.read_bytes() for path in self.out.iterdir()}
        self.refused(contact(self.scene, self.out, "time.rate_hz=-1"), "time.rate_hz")
        self.refused(kernel(self.scene, self.out, "modes.count=0"), "modes.count")
        self.assertEqual(before, {path.name: path.read_bytes() for path in self.out.iterdir()})

    def test_equilibrium_that_nothing_holds(self):
        run = contact(self.scene, self.out, "contact.scheme=static", "loads.gravity=[1,0,0]")
        self.refused(run, "scene.toml: bodies.", "no contact forces hold it", "support")
        self.assertEqual(list(self.out.glob("errors.*")), [])

    def test_touches_of_few_steps_are_warned_of(self):
        for rate, few in ((5, True), (100, False)):  # a contact lasts 2 s
            warnings = impact(self.scene, self.out, "time.duration=5", f"time.rate_hz={rate}").warnings
            self.assertEqual(any("steps: peak force, rebound" in w for w in warnings), few)


if __name__ == "__main__":
    unittest.main()
