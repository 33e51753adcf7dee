# SPDX-License-Identifier: BSD-2-Clause
"""ricochet import mesh: meshes of other programs have the nodes, groups and kernels of the same mesh of gmsh."""

import contextlib
import io
import unittest
import unittest.mock

import gmsh
import h5py
import numpy as np

from foreign_meshes import VTK, Sample
from programs import Command, ProgramTest, kernel

from ricochet.errors import InputError
from ricochet.interchange import foreign, unstructured

try:
    import meshio
except ImportError:
    meshio = None

# Each file has its coordinates with all digits.
SAME = 1e-12
SCENE = """
[bodies.block]
mesh = "{mesh}"
material = {{ density = 2.0, young = 3.0, poisson = 0.3 }}
contact = "3"
support = {{ "4" = "xyz" }}
[modes]
count = 8
"""


def as_gmsh_reads(path):
    """The nodes (k,3) of each solid by number, in gmsh's order, and the places of the nodes of each group by name."""
    gmsh.open(str(path))
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    place = dict(zip(tags.tolist(), xyz.reshape(-1, 3)))
    solids = {}
    for kind, numbers, nodes in zip(*gmsh.model.mesh.getElements(3)):
        for number, row in zip(numbers.tolist(), nodes.reshape(len(numbers), -1).tolist()):
            solids[number] = np.array([place[tag] for tag in row])
    groups = {}
    for dim, group in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dim, group) or str(group)
        places = set()
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dim, group):
            for nodes in gmsh.model.mesh.getElements(dim, entity)[2]:
                places |= {tuple(np.round(place[tag], 10)) for tag in nodes.tolist()}
        groups[name] = dim, places
    gmsh.model.remove()
    return solids, groups


class ImportMesh(ProgramTest):
    @classmethod
    def setUpClass(cls):
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        cls.addClassCleanup(gmsh.finalize)

    def imported(self, path, *more):
        """The .msh that the import writes, and the run."""
        out = self.folder / f"{path.name}.msh"
        return out, self.succeed(Command("import", "mesh", path, "--out", out, *more))

    def assertSame(self, wanted, path):
        solids, groups = as_gmsh_reads(path)
        for number, nodes in wanted[0].items():
            np.testing.assert_allclose(solids[number], nodes, rtol=0, atol=SAME, err_msg=f"{path}: {number}")
        self.assertEqual(len(solids), len(wanted[0]))
        for name, group in wanted[1].items():
            self.assertEqual(groups[name], group, f"{path}: {name}")
        return groups

    def files(self, sample, name):
        """The sample in each format and each of its forms."""
        written = [
            self.folder / f"{name}{ending}" for ending in (".inp", ".med", ".unv", ".cgns", "-mixed.cgns")
        ]
        for path, write in zip(
            written, (sample.write_inp, sample.write_med, sample.write_unv, sample.write_cgns)
        ):
            write(path)
        sample.write_cgns(written[-1], mixed=True)
        for form in ("free", "small", "large"):
            written.append(self.folder / f"{name}-{form}.bdf")
            sample.write_bdf(written[-1], form)
        for form in ("ascii", "binary", "raw", "compressed"):
            written.append(self.folder / f"{name}-{form}.vtu")
            sample.write_vtu(written[-1], form, full=form != "binary")
        for form in ("ascii", "binary"):
            written.append(self.folder / f"{name}-{form}.vtk")
            sample.write_vtk(written[-1], form == "binary")
        return written

    def test_elements_of_all_formats_are_those_of_gmsh(self):
        for kind in ("tetrahedron", "brick", "wedge"):
            for order in (1, 2):
                sample = Sample(kind, order)
                reference = self.folder / f"{kind}{order}.msh"
                sample.write_msh(reference)
                wanted = as_gmsh_reads(reference)
                held = {tuple(np.round(sample.node[k], 10)) for k in sample.edge}
                for path in self.files(sample, f"{kind}{order}"):
                    with self.subTest(path.name):
                        out, run = self.imported(path)
                        groups = self.assertSame(wanted, out)
                        edge = {".bdf": "SPC 7", ".vtu": "", ".vtk": ""}.get(path.suffix, "edge")
                        if edge:
                            self.assertEqual(groups[edge], (0, held))
                        self.assertNotIn("inverted", run.err)

    @unittest.skipUnless(meshio, "python3-meshio is not installed: scripts/setup --tests")
    def test_files_that_meshio_writes_are_read(self):
        """meshio has orders of its own for each format; it cannot write wedges of order 2."""
        kinds = {("tetrahedron", 1): "tetra", ("tetrahedron", 2): "tetra10", ("wedge", 1): "wedge"}
        kinds |= {("brick", 1): "hexahedron", ("brick", 2): "hexahedron20"}
        for (kind, order), cells in kinds.items():
            sample = Sample(kind, order)
            rows = sample.incomplete()[0]
            rows = rows[:, VTK.get(rows.shape[1], range(rows.shape[1]))]
            mesh = meshio.Mesh(sample.node, [(cells, rows)], cell_data={"cell_tags": [sample.part]})
            mesh.cell_tags = {1: ["one"], 2: ["two"]}
            for ending in (".med", ".vtu", ".vtk", ".xdmf", ".inp"):
                path = self.folder / f"{cells}{ending}"
                with self.subTest(path.name), contextlib.redirect_stdout(io.StringIO()):
                    meshio.write(path, mesh)
                    found = foreign.read(path, 1.0, 1.0)
                    ((_, solids),) = found.mesh.solids.items()
                    np.testing.assert_allclose(found.mesh.node[solids], sample.node[sample.solid], atol=SAME)
                    names = {".med": {"one", "two"}, ".inp": {"whole"}}.get(ending, {"1", "2"})
                    self.assertEqual(set(found.groups.solids), names)

    @unittest.skipUnless(meshio, "python3-meshio is not installed: scripts/setup --tests")
    def test_files_that_meshio_misreads_are_refused_in_one_line(self):
        """Netgen's format states numbers of entries, which meshio looks for behind the end of the file. The refusal states the time."""
        path = self.folder / "damaged.vol"
        names = "materials\n1000000000000\n"
        for text, limit, complaint in (("", 60, "has no nodes"), (names, 0.1, "takes more than 0.1")):
            path.write_text(f"mesh3d\ndimension\n3\n{text}endmesh\n")
            with self.subTest(complaint), unittest.mock.patch.object(unstructured, "LONGEST", limit):
                with self.assertRaisesRegex(InputError, f"{path}: .*{complaint}") as refused:
                    foreign.read(path, 1.0, 1.0)
                self.assertNotIn("\n", str(refused.exception))

    def test_kernels_of_all_formats_in_a_scene_are_those_of_gmsh(self):
        # The import adds nodes to bricks of 20 nodes, the same for all formats.
        for kind, endings in (
            ("tetrahedron", (".inp", ".med", "-free.bdf", "-ascii.vtu")),
            ("brick", (".med",)),
        ):
            sample = Sample(kind, 2)
            own = self.folder / f"{kind}.msh"
            sample.write_msh(own)
            wanted = self.kernel_of(own)
            self.files(sample, kind)
            for ending in endings:
                path = self.folder / f"{kind}{ending}"
                found = self.kernel_of(path)
                for name, values in wanted.items():
                    error = abs(found[name] - values).max()
                    self.assertLess(error, 1e-10 * abs(values).max(), f"{path.name}: {name}")

    def kernel_of(self, mesh):
        """Figures of the kernel that do not depend on the signs of modes."""
        scene = self.write(f"{mesh.name}.toml", SCENE.format(mesh=mesh.name))
        self.succeed(kernel(scene, self.folder / f"{mesh.name}.out"))
        with h5py.File(self.one(self.folder / f"{mesh.name}.out")) as file:
            centroid, omega = file["surface/centroid"][:], file["modes/angular_frequency"][:]
            # Nodes that the import has added come last.
            order = np.lexsort(np.round(centroid, 9).T)
            shape = file["surface/shape"][:].reshape(len(order), -1, omega.size)[order]
            residual = file["surface/residual_flexibility"][:].reshape(2 * shape.shape[:2])
            return {
                "centroid": centroid[order],
                "area": file["surface/area"][:][order],
                "centre": file["body/centre"][:],
                "mass": np.array(file.attrs["mass"]),
                "frequencies": omega,
                # What the surface does under unit forces: the shapes in a form without signs.
                "response": np.einsum("icn,jdn->icjd", shape / omega**2, shape)
                + residual[order][:, :, order],
            }

    def test_a_mesh_in_a_scene_is_converted_once_and_again_when_it_changes(self):
        Sample("tetrahedron", 1).write_inp(self.folder / "deck.inp")
        self.write("block.inp", "*INCLUDE, INPUT=deck.inp\n")
        scene, out = self.write("block.toml", SCENE.format(mesh="block.inp")), self.folder / "out"
        self.succeed(kernel(scene, out, ranks=2))
        (first,) = out.glob("block.inp-*.msh")
        made = first.stat().st_mtime_ns
        self.succeed(kernel(scene, out))
        self.assertEqual(first.stat().st_mtime_ns, made)
        Sample("tetrahedron", 1, lambda place: 1.5 * place).write_inp(self.folder / "deck.inp")
        self.succeed(kernel(scene, out))
        self.assertEqual(len(list(out.glob("block.inp-*.msh"))), 2)
        self.assertEqual(len(list(out.glob("*.kernel.h5"))), 2)

    def test_a_mesh_in_a_scene_is_refused_in_one_line_on_all_ranks(self):
        scene, out = self.write("block.toml", SCENE.format(mesh="block.inp")), self.folder / "out"
        Sample("tetrahedron", 1).write_inp(self.folder / "block.inp")
        text = (self.folder / "block.inp").read_text()
        self.write(
            "block.inp", text.replace("*ELEMENT, TYPE=C3D4", "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 999999", 1)
        )
        self.refused(kernel(scene, out, ranks=2), "ricochet-kernel: ", "block.inp", "999999")
        self.assertFalse(list(out.iterdir()))
        (self.folder / "block.inp").unlink()
        self.refused(kernel(scene, out, ranks=2), "bodies.block.mesh", "no such file")
        steel = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000, 0.3\n*DENSITY\n7.85e-9\n*SOLID SECTION, ELSET=1, MATERIAL=STEEL\n"
        self.write("block.inp", text + steel)
        bare = self.write(
            "bare.toml", "\n".join(line for line in scene.read_text().split("\n") if "material" not in line)
        )
        self.refused(
            kernel(bare, out, ranks=2),
            "bodies.block.material: is missing",
            "STEEL (density 7.85e-09, young 210000, poisson 0.3)",
        )


if __name__ == "__main__":
    unittest.main()
