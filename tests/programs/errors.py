# SPDX-License-Identifier: BSD-2-Clause
"""Bad input: one line that states the place, the fault and the remedy; status 2; nothing is lost; no rank hangs."""

import unittest

import h5py

import scenes
from programs import ProgramTest, contact, kernel

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
    def setUp(self):
        super().setUp()
        self.write("rod.geo", ROD)
        self.scene = self.write("scene.toml", SCENE)
        self.out = self.folder / "out"

    def refused(self, run, *fragments):
        """Checks for status 2 and one line on stderr that contains each fragment."""
        self.assertEqual(run.status, 2, run.err)
        # mpirun adds its own remark on the status after a line of dashes.
        lines = [line for line in run.err.split("-----")[0].splitlines() if line.strip()]
        self.assertEqual(len(lines), 1, run.err)
        for fragment in fragments:
            self.assertIn(fragment, lines[0])

    def refused_by_kernel(self, sets, *fragments):
        for ranks in (1, 3):
            with self.subTest(sets=sets, ranks=ranks):
                self.refused(kernel(self.scene, self.out, *sets, ranks=ranks), *fragments)

    def test_unknown_key(self):
        self.refused_by_kernel(["bodies.a.yuong=3"], "scene.toml", "bodies.a.yuong", "unknown")

    def test_poisson_of_an_incompressible_body(self):
        self.refused_by_kernel(
            ["bodies.a.material.poisson=0.5"], "scene.toml", "bodies.a.material.poisson", "0.5", "0.49"
        )

    def test_missing_group(self):
        self.refused_by_kernel(["bodies.a.contact=edge"], "rod.geo", "edge", '"left", "right"')

    def test_missing_mesh(self):
        self.refused_by_kernel(["bodies.a.mesh=no.geo"], "scene.toml", "bodies.a.mesh", "no.geo")

    def test_inverted_element(self):
        self.write("inverted.msh", INVERTED)
        self.refused_by_kernel(
            ["bodies.b.mesh=inverted.msh", "bodies.b.material={density=1,young=1}"],
            "inverted.msh",
            "element 3",
        )

    def test_impossible_count(self):
        self.refused_by_kernel(["modes.count=100"], "modes.count", "100", "11")

    def test_no_kernel_yet(self):
        self.refused(contact(self.scene, self.out), "no kernel", "Run ricochet-kernel")

    def test_kernel_of_another_scene(self):
        self.succeed(kernel(self.scene, self.out))
        (path,) = self.out.glob("a-*.kernel.h5")
        with h5py.File(path, "r+") as file:
            file.attrs.modify("hash", b"0" * 64)
        self.refused(contact(self.scene, self.out), path.name, "another scene", "Run ricochet-kernel")

    def test_truncated_kernel(self):
        self.succeed(kernel(self.scene, self.out))
        (path,) = self.out.glob("b-*.kernel.h5")
        whole = path.read_bytes()
        for part in (0, 100, len(whole) // 2, len(whole) - 1):
            path.write_bytes(whole[:part])
            with self.subTest(bytes=part):
                self.refused(contact(self.scene, self.out), path.name)
        # ricochet-kernel replaces a file that it cannot read.
        self.succeed(kernel(self.scene, self.out))
        self.succeed(contact(self.scene, self.out))

    def test_a_refused_run_leaves_earlier_results(self):
        self.succeed(kernel(self.scene, self.out))
        self.succeed(contact(self.scene, self.out))
        before = {path.name: path.read_bytes() for path in self.out.iterdir()}
        self.refused(contact(self.scene, self.out, "time.rate_hz=-1"), "time.rate_hz")
        self.refused(kernel(self.scene, self.out, "modes.count=0"), "modes.count")
        self.assertEqual(before, {path.name: path.read_bytes() for path in self.out.iterdir()})

    def test_equilibrium_that_nothing_holds(self):
        self.succeed(kernel(self.scene, self.out))
        at_rest = ["contact.scheme=static", "loads.gravity=[1,0,0]"]
        self.refused(
            contact(self.scene, self.out, *at_rest),
            "scene.toml: bodies.",
            "no contact forces hold it",
            "support",
        )
        self.assertEqual(list(self.out.glob("errors.*")), [])

    def test_touches_of_few_steps_are_warned_of(self):
        self.succeed(kernel(self.scene, self.out, ranks=1))
        for rate, few in ((5, True), (100, False)):  # a contact lasts 2 s
            self.succeed(contact(self.scene, self.out, "time.duration=5", f"time.rate_hz={rate}"))
            warned = [w for w in self.summary(self.out)["warnings"] if "steps: peak force, rebound" in w]
            self.assertEqual(bool(warned), few)

    def test_overlapping_bodies(self):
        self.succeed(kernel(self.scene, self.out))
        self.refused(contact(self.scene, self.out, "bodies.a.translate=[-0.5,0,0]"), "scene.toml")


if __name__ == "__main__":
    unittest.main()
