# SPDX-License-Identifier: BSD-2-Clause
"""ricochet import mesh: sets, surfaces, parts, materials and supports of decks, drafts of scenes, and refused files."""

import shutil
import tomllib
import unittest

import gmsh
import h5py
import numpy as np

from foreign_meshes import SIZE, Sample
from programs import Command, ProgramTest, Run, kernel

from ricochet import surfaces
from ricochet.interchange import foreign

# Two cubes of edge 1 on top of each other; node 10 z + 1 to 4, corner by corner.
CUBES = """*HEADING
Two cubes
*NODE, NSET=every
{nodes}
*ELEMENT, TYPE=C3D8, ELSET=lower
1, 1, 2, 3, 4, 11, 12, 13, 14
*ELEMENT, TYPE=C3D8,
 ELSET=upper
2, 11, 12, 13, 14, 21, 22, 23, 24
*NSET, NSET=foot, GENERATE
1, 4, 1
*NSET, NSET=edge
1, 11, 21
*NSET, NSET=held
edge, 2
*ELSET, ELSET=both
lower, upper
*SURFACE, NAME=head
upper, S2
*SURFACE, NAME=skin
both,
*MATERIAL, NAME=Steel
*ELASTIC
2.1E5, 0.3
*DENSITY
7.8E-9,
*MATERIAL, NAME=Brass
*ELASTIC
1E5, 0.35
*DENSITY
8.4E-9,
*SOLID SECTION, ELSET=lower, MATERIAL=STEEL
*SOLID SECTION, ELSET=upper, MATERIAL=Brass
*BOUNDARY
foot, 3
held, 1, 2
24, ENCASTRE
*STEP
*FREQUENCY
7
*END STEP
"""
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
NODES = [f"{10 * z + k}, {x}, {y}, {z}" for z in range(3) for k, (x, y) in enumerate(SQUARE, 1)]
CUBES = CUBES.format(nodes="\n".join(NODES))
# The same as an assembly of two instances of one part.
ASSEMBLY = """*PART, NAME=Cube
*NODE
{nodes}
*ELEMENT, TYPE=C3D8, ELSET=all
7, 1, 2, 3, 4, 11, 12, 13, 14
*NSET, NSET=foot, GENERATE
1, 4, 1
*SURFACE, NAME=lid
all, S2
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=Low, PART=Cube
*END INSTANCE
*INSTANCE, NAME=High, PART=Cube
0, 0, 5
0, 0, 5, 1, 0, 5, 90
*END INSTANCE
*NSET, NSET=corner, INSTANCE=High
1,
*END ASSEMBLY
*BOUNDARY
Low.foot, 1, 3
corner, PINNED
""".format(
    nodes="\n".join(NODES[:8])
)
BULK = """SOL 103
SPC = 5
METHOD = 3
BEGIN BULK
EIGRL,3,,,6
{nodes}
CHEXA,1,31,1,2,3,4,11,12
+,13,14
CHEXA   2       32      11      12      13      14      21      22      +
+       23      24
PSOLID,31,9
PSOLID,32,9
MAT1*   9               2.1+11                          .3
*       7800.
SPC1,5,123,1,THRU,4
SPC,5,21,12,0.,22,3
SPC1,6,1,24
CQUAD4,8,40,1,2,3,4
ENDDATA
""".format(
    nodes="\n".join("GRID," + line.replace(", ", ",").replace(",", ",,", 1) for line in NODES)
)


class ImportDeck(ProgramTest):
    def imported(self, name, text, *units):
        return foreign.read(self.write(name, text), *(units or (1.0, 1.0)))

    def places(self, found, kind, name):
        """The places of the nodes of a group, in halves of the edge."""
        mesh, members = found.mesh, getattr(found.groups, kind)[name]
        if kind == "solids":
            nodes = mesh.nodes_of(members)
        elif kind == "faces":
            nodes = np.concatenate([rows.ravel() for _, rows in found.faces.nodes(members)])
        else:
            nodes = members
        return {tuple(place) for place in np.round(mesh.node[nodes], 9).tolist()}

    def draft(self, name, *more):
        path = self.folder / name
        run = self.succeed(Command("import", "mesh", path, *more))
        return tomllib.loads(path.with_suffix(".toml").read_text()), run

    def test_sets_and_surfaces_of_a_deck_are_groups(self):
        found = self.imported("cubes.inp", CUBES)
        layer = [{(x, y, z) for x, y in SQUARE} for z in (0.0, 1.0, 2.0)]
        self.assertEqual(set(found.groups.solids), {"lower", "upper", "both"})
        self.assertEqual(self.places(found, "solids", "lower"), layer[0] | layer[1])
        self.assertEqual(set(found.groups.faces), {"head", "skin", "foot", "every"})
        self.assertEqual(self.places(found, "faces", "head"), layer[2])
        self.assertEqual(self.places(found, "faces", "foot"), layer[0])
        self.assertEqual(len(found.groups.faces["skin"]), 10)  # without the common face of both cubes
        self.assertEqual(self.places(found, "points", "edge"), {(0, 0, 0), (0, 0, 1), (0, 0, 2)})
        self.assertEqual(found.mesh.solid_number.tolist(), [1, 2])
        self.assertEqual(found.mesh.warnings, [])

    def test_surfaces_of_an_imported_mesh_are_listed(self):
        path = self.write("cubes.inp", CUBES)
        self.succeed(Command("import", "mesh", path))
        run = self.succeed(Command("surfaces", path.with_suffix(".msh"), "--out", self.folder))
        found = surfaces.read(path.with_suffix(".msh")).surfaces
        # The head of the upper cube is in the skin too, and in the set of all nodes.
        (head,) = (surface for surface in found if "head" in surface.groups)
        self.assertAlmostEqual(head.area, 1, delta=1e-12)
        self.assertIn("head", run.out)

    def test_a_set_may_have_the_nodes_of_elements(self):
        found = self.imported(
            "cubes.inp", CUBES.replace("*ELSET, ELSET=both", "*NSET, NSET=n, ELSET=upper\n*ELSET, ELSET=both")
        )
        self.assertEqual(self.places(found, "faces", "n"), self.places(found, "solids", "upper"))

    def test_a_set_may_be_extended_by_itself(self):
        found = self.imported(
            "cubes.inp", CUBES.replace("*ELSET, ELSET=both", "*NSET, NSET=edge\nedge, 2\n*ELSET, ELSET=both")
        )
        self.assertEqual(len(found.groups.points["edge"]), 4)

    def test_a_draft_has_materials_and_supports_in_si_units(self):
        self.write("cubes.inp", CUBES)
        scene, run = self.draft("cubes.inp", "--length-unit", "0.001", "--mass-unit", "1000")
        body = scene["bodies"]["cubes"]
        self.assertEqual(set(body["material"]), {"lower", "upper"})
        for group, wanted in (("lower", (7800, 2.1e11, 0.3)), ("upper", (8400, 1e11, 0.35))):
            values = [body["material"][group][key] for key in ("density", "young", "poisson")]
            self.assertEqual(values, list(wanted))
        self.assertEqual(body["support"], {"foot": "z", "held": "xy", "held in xyz": "xyz"})
        self.assertEqual(scene["modes"], {"count": 7})
        self.succeed(kernel(self.folder / "cubes.toml", self.folder, more=["--check"]))
        # A draft that was edited is kept.
        (self.folder / "cubes.toml").write_text("# mine\n")
        run = self.succeed(Command("import", "mesh", self.folder / "cubes.inp"))
        self.assertIn("cubes.toml: exists and is left as it is", run.out)
        self.assertEqual((self.folder / "cubes.toml").read_text(), "# mine\n")
        other = self.folder / "other.toml"
        self.succeed(Command("import", "mesh", self.folder / "cubes.inp", "--scene", other))
        self.assertEqual(tomllib.loads(other.read_text())["bodies"]["cubes"]["mesh"], "cubes.msh")

    def test_instances_of_a_part_are_moved_copies(self):
        found = self.imported("two.inp", ASSEMBLY)
        self.assertEqual(set(found.groups.faces), {"Low.lid", "Low.foot", "High.lid", "High.foot"})
        # Shifted by 5 along z, then turned about the line through (0, 0, 5) along x, which takes y to z and z to −y.
        turned = {(x, -(z - 5.0) + 0.0, 5.0 + y) for x, y in SQUARE for z in (6.0,)}
        self.assertEqual(self.places(found, "faces", "High.lid"), turned)
        self.assertEqual(self.places(found, "points", "corner"), {(0.0, 0.0, 5.0)})
        self.assertEqual(found.offer.supports, {"Low.foot": "xyz", "corner": "xyz"})
        alone = ASSEMBLY.replace(
            "*INSTANCE, NAME=High, PART=Cube\n0, 0, 5\n0, 0, 5, 1, 0, 5, 90\n*END INSTANCE\n", ""
        )
        found = self.imported("one.inp", alone.replace("INSTANCE=High", "INSTANCE=Low"))
        self.assertEqual(set(found.groups.faces), {"lid", "foot"})
        self.assertEqual(found.offer.supports, {"foot": "xyz", "corner": "xyz"})

    def test_bulk_data_have_properties_supports_and_materials(self):
        self.write("bulk.bdf", BULK)
        scene, run = self.draft("bulk.bdf")
        body = scene["bodies"]["bulk"]
        self.assertEqual(set(body["material"]), {"31", "32"})
        self.assertEqual(body["material"]["31"], {"density": 7800.0, "young": 2.1e11, "poisson": 0.3})
        self.assertEqual(body["support"], {"SPC 5 xyz": "xyz", "SPC 5 xy": "xy", "SPC 5 z": "z"})
        self.assertEqual(scene["modes"], {"count": 6})
        self.assertEqual(run.err, "")
        found = self.imported("bulk.bdf", BULK)
        self.assertEqual(self.places(found, "points", "SPC 6"), {(0.0, 1.0, 2.0)})
        self.assertEqual(self.places(found, "faces", "40"), {(x, y, 0.0) for x, y in SQUARE})

    def test_includes_are_read_and_what_is_not_read_is_named(self):
        self.write("nodes.inc", CUBES.partition("*ELEMENT")[0])
        deck = "*INCLUDE, INPUT=nodes.inc\n*ELEMENT" + CUBES.partition("*ELEMENT")[2]
        found = self.imported("deck.inp", deck + "*EQUATION\n1\n1, 1, 1\n*ELEMENT, TYPE=T3D2\n90, 1, 2\n")
        self.assertEqual(len(found.mesh.node), 12)
        said = "\n".join(found.mesh.warnings)
        self.assertRegex(said, r"deck.inp: line 39: \*EQUATION is not read")
        self.assertRegex(said, r"deck.inp: line 42: elements of type T3D2 are not read")
        nodes = CUBES.replace(
            "*NSET, NSET=foot, GENERATE", "*NODE, NSET=away\n99, 9, 9, 9\n*NSET, NSET=foot, GENERATE"
        )
        found = self.imported("deck.inp", nodes.replace("foot, 3", "away, 3"))
        self.assertRegex("\n".join(found.mesh.warnings), 'the support of "away" holds no node of a solid')
        bulk = BULK.replace("ENDDATA", "MAT9,4,1.\nCBAR,50,1,1,2\nCONM2,60,1,,2.5\nRBE2,7,1,123,2\nENDDATA")
        said = "\n".join(self.imported("more.bdf", bulk).mesh.warnings)
        for name in ("CBAR", "CONM2", "RBE2", "MAT9"):
            self.assertRegex(said, rf"more.bdf: line \d+: {name} is not read")

    def test_files_that_are_wrong_are_refused_in_one_line(self):
        deck = {
            "line 4: can't be read as *NODE": ("1, 0, 0, 0", "1, 0, x, 0"),
            "line 16: has elements of type C3D5": (
                "TYPE=C3D8, ELSET=lower\n1, 1, 2, 3, 4, 11, 12, 13, 14",
                "TYPE=C3D5, ELSET=lower\n1, 1, 2, 3, 4, 11",
            ),
            "line 17: element 1 names node 99": ("3, 4, 11", "3, 99, 11"),
            "line 17: element 1 lacks nodes": (", 13, 14\n*ELEMENT, TYPE=C3D8,", "\n*ELEMENT, TYPE=C3D8,"),
            "element 1 names a node twice": ("1, 1, 2, 3, 4, 11", "1, 1, 2, 3, 3, 11"),
            "names the set none": ("edge, 2\n", "none, 2\n"),
            'surface head has "S7"': ("upper, S2", "upper, S7"),
            "names the set feet, which": ("foot, 3\n", "feet, 3\n"),
            "names node 77, which": ("24, ENCASTRE", "77, ENCASTRE"),
            "a range of more than 10000000 numbers": ("1, 4, 1", "1, 999999999, 1"),
            "belongs to no *MATERIAL": ("*MATERIAL, NAME=Steel\n", ""),
            "coordinates must be below 1e+30": ("1, 0, 0, 0", "1, 0, 0, 1e40"),
            "*NFILL is not read": ("*NSET, NSET=edge", "*NFILL, NSET=x\n1, 2\n*NSET, NSET=edge"),
            "includes": ("*STEP", "*INCLUDE, INPUT=none.inc\n*STEP"),
            "holds no tetrahedra": (CUBES.partition("*ELEMENT")[2], ", TYPE=CPS4\n1, 1, 2, 3, 4\n"),
        }
        for words, (old, new) in deck.items():
            with self.subTest(words):
                self.assertIn(old, CUBES)
                self.refused_file("bad.inp", CUBES.replace(old, new, 1), words)
        parts = {
            "two parts are called Cube": (
                "*ASSEMBLY, NAME=A",
                "*PART, NAME=Cube\n*END PART\n*ASSEMBLY, NAME=A",
            ),
            "two instances are called Low": ("NAME=High", "NAME=Low"),
            "of the part Ball, which is not there": ("NAME=High, PART=Cube", "NAME=High, PART=Ball"),
            "ends inside a part": ("*END PART" + ASSEMBLY.partition("*END PART")[2], ""),
        }
        for words, (old, new) in parts.items():
            with self.subTest(words):
                self.refused_file("bad.inp", ASSEMBLY.replace(old, new, 1), words)

    def test_bulk_data_that_are_wrong_are_refused_in_one_line(self):
        bulk = {
            "has no ENDDATA: it is cut off": ("ENDDATA\n", ""),
            "line 18: CHEXA 1 has 7 nodes: must be 8 or 20": ("+,13,14", "+,13"),
            "names node 99, which is not there": ("+,13,14", "+,13,99"),
            'field 3 of GRID is "x": must be a whole number': ("GRID,1,,", "GRID,1,x,"),
            "GRID 1 is given in coordinate system 3": ("GRID,1,,", "GRID,1,3,"),
            'field 4 of GRID is "q": must be a number': ("GRID,1,,0", "GRID,1,,q"),
            "has pyramids": ("CQUAD4,8,40,1,2,3,4", "CPYRAM,8,40,1,2,3,4,11"),
            "a range of more than 10000000 numbers": ("1,THRU,4", "1,THRU,999999999"),
            "continues no entry": ("EIGRL,3", "+,3"),
            "GRID 1 is there twice": ("GRID,2,", "GRID,1,"),
        }
        for words, (old, new) in bulk.items():
            with self.subTest(words):
                self.assertIn(old, BULK)
                self.refused_file("bad.bdf", BULK.replace(old, new, 1), words)

    def refused_file(self, name, content, *words):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        self.refused(Command("import", "mesh", path), name, *words)
        self.assertFalse(path.with_suffix(".msh").exists() or path.with_suffix(".toml").exists())

    def test_files_that_are_cut_short_are_refused(self):
        sample = self.sample("wedge", 2)
        sample.write_med(self.folder / "a.med")
        for form in ("ascii", "binary", "raw", "compressed"):
            sample.write_vtu(self.folder / f"a-{form}.vtu", form)
        sample.write_vtk(self.folder / "a-ascii.vtk"), sample.write_vtk(self.folder / "a-binary.vtk", True)
        sample.write_unv(self.folder / "a.unv"), sample.write_cgns(self.folder / "a.cgns")
        for path in sorted(self.folder.glob("a*")):
            whole = path.read_bytes()
            for part in (0, 100, len(whole) // 3, len(whole) // 2, len(whole) - 60):
                with self.subTest(f"{path.name}: {part}"):
                    self.refused_file(f"cut{path.suffix}", whole[:part], "save it again")

    def sample(self, *kind):
        gmsh.initialize()
        try:
            return Sample(*kind)
        finally:
            gmsh.finalize()

    def test_kinds_that_are_not_read_are_refused_with_advice(self):
        for name, words in (
            ("a.step", 'a.step: is a drawing: name it in a scene as it is, mesh = "a.step"'),
            ("a.msh", "is a mesh of gmsh"),
            ("a.zip", '".zip" is no kind of mesh'),
            ("a.inp", "a.inp: there is no such file"),
            ("a.bdf", "a.bdf: there is no such file"),
            ("a.med", "a.med: there is no such file"),
            ("a.vtu", "a.vtu: there is no such file"),
            ("a.xdmf", "a.xdmf: "),
        ):
            self.refused(Command("import", "mesh", self.folder / name), words)
        path = self.write("cubes.inp", CUBES)
        self.refused(Command("import", "mesh", path, "--out", self.folder / "x.h5"), "must end in .msh")
        out = self.folder / "none" / "x.msh"
        self.refused(Command("import", "mesh", path, "--out", out), f"{out}: cannot be written")

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed: scripts/setup --tests")
    def test_a_deck_has_the_frequencies_that_calculix_computes(self):
        """Bricks of eight nodes, whose matrices ccx integrates like Ricochet. It gives the mass of tetrahedra and wedges
        fewer points than exact integration needs."""
        sample = self.sample("brick", 1, lambda place: place * SIZE * [3, 1, 1])
        rows = 1 + sample.solid
        lines = [
            "*NODE",
            *(f"{k}, {x!r}, {y!r}, {z!r}" for k, (x, y, z) in enumerate(sample.node.tolist(), 1)),
        ]
        lines += [
            "*ELEMENT, TYPE=C3D8, ELSET=beam",
            *(f"{k}, " + ", ".join(map(str, row)) for k, row in enumerate(rows, 1)),
        ]
        clamped = 1 + np.flatnonzero(sample.node[:, 0] == 0)
        lines += ["*NSET, NSET=wall", *(f"{k}," for k in clamped)]
        lines += [
            "*MATERIAL, NAME=m",
            "*ELASTIC",
            "2.1E11, 0.3",
            "*DENSITY",
            "7800",
            "*SOLID SECTION, ELSET=beam, MATERIAL=m",
        ]
        lines += ["*BOUNDARY", "wall, 1, 3", "*STEP", "*FREQUENCY", "10", "*END STEP", ""]
        deck = self.write("beam.inp", "\n".join(lines))
        self.succeed(Run(["ccx", "beam"], cwd=self.folder))
        self.succeed(Command("import", "mesh", deck))
        self.succeed(kernel(self.folder / "beam.toml", self.folder / "out"))
        with h5py.File(self.one(self.folder / "out")) as file:
            omega = file["modes/angular_frequency"][:]
        table = [line.split() for line in (self.folder / "beam.dat").read_text().splitlines()[7:17]]
        # The table has seven digits, of which the last is rounded.
        np.testing.assert_allclose(omega, [float(words[2]) for words in table], rtol=5e-7)


if __name__ == "__main__":
    unittest.main()
