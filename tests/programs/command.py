# SPDX-License-Identifier: BSD-2-Clause
"""The command ricochet: help, mistyped words, the programs that it runs, and the table of modes compared with the kernel."""

import csv
import os
import unittest
import unittest.mock

import h5py
import numpy as np

from programs import BIN, MESHES, Command, Forked, ProgramTest, Run

VERBS = "run modes kernel impact plot report sweep tradeoff surfaces materials example import export batch".split()
# A free bar of 300 x 50 x 20 mm without contact and time.
BAR = """[bodies.bar]
mesh = "bar.geo"
order = 2
material = { density = 2700, young = 70e9, poisson = 0.33 }
damping = { ratio = 0.01 }
[modes]
count = 12
[output]
view = true
"""
GEO = """SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 0.3, 0.05, 0.02};
Mesh.MeshSizeMax = 0.02;
Mesh.MeshSizeMin = 0.02;
"""


class Words(ProgramTest):
    def test_help_has_a_line_for_each_verb(self):
        done = self.succeed(Command("--help"))
        listed = [line.split() for line in done.out.splitlines() if line.startswith("    ")]
        self.assertEqual([words[0] for words in listed if len(words) > 1], VERBS)

    def test_each_verb_describes_itself_and_knows_the_version(self):
        version = self.succeed(Run([BIN / "ricochet", "--version"])).out.split()[1]
        for verb in VERBS:
            done = self.succeed(Command(verb, "--help"))
            self.assertTrue(done.out.startswith(f"usage: ricochet {verb} "), done.out)
            self.assertEqual(self.succeed(Command(verb, "--version")).out, f"ricochet {verb} {version}\n")

    def test_a_verb_of_control_characters_is_refused_in_one_line(self):
        self.refused(Command("\x1bxyzzy\n"))

    def test_the_programs_get_all_words_that_are_not_the_command_s_own(self):
        scene = MESHES / "two-rods/two-rods.toml"
        sets = ["--set", "modes.count=5", "--set", "bodies.moving.velocity=[-1,0,0]"]
        for verb, program in (("impact", "ricochet-contact"), ("kernel", "ricochet-kernel")):
            direct = self.succeed(Run([BIN / program, scene, "--dry-run", *sets]))
            for ranks in ([], ["-n", "1"], ["--ranks=2"]) if verb == "kernel" else ([],):
                self.assertEqual(
                    self.succeed(Forked(verb, *ranks, scene, "--dry-run", *sets)).out, direct.out
                )
        self.assertEqual(Forked("impact", scene, "--out", self.folder / "none").status, 2)

    def test_kernels_are_computed_on_as_many_ranks_as_asked_for(self):
        launcher = self.folder / "launcher"
        launcher.write_text(f'#!/bin/sh\necho "$1" > {self.folder}/ranks\nshift\nexec "$@"\n')
        launcher.chmod(0o755)
        scene = MESHES / "two-rods/two-rods.toml"
        command = [
            "env",
            f"RICOCHET_LAUNCHER={launcher} {{ranks}}",
            BIN / "ricochet",
            "kernel",
            "-n",
            "3",
            scene,
        ]
        self.succeed(Run([*command, "--out", self.folder, "--set", "modes.count=5", "--quiet"]))
        self.assertEqual((self.folder / "ranks").read_text(), "3\n")
        self.assertEqual(len(list(self.folder.glob("*.kernel.h5"))), 2)

    def test_one_rank_makes_no_folder_of_open_mpi_which_others_could_remove_meanwhile(self):
        occupied = self.folder / "file"
        occupied.touch()  # Open MPI would make its folder below $TMPDIR
        command = ["env", f"TMPDIR={occupied}", BIN / "ricochet-kernel", MESHES / "two-rods/two-rods.toml"]
        self.succeed(Run([*command, "--out", self.folder, "--set", "modes.count=5", "--quiet"]))


class Modes(ProgramTest):
    """The table of modes compared with the data of the kernel, by another formula for each column."""

    def rows(self, path):
        with open(path, newline="") as file:
            return list(csv.DictReader(file))

    def column(self, rows, name):
        return np.array([float(row[name] or "nan") for row in rows])

    def test_a_scene_without_contact_and_time_has_modes_and_pictures_of_them(self):
        self.write("bar.geo", GEO)
        scene = self.write("bar.toml", BAR)
        done = self.succeed(
            Forked("modes", scene, "-n", "1", "--csv", self.folder / "bar.csv", "--plot", "--first", "4")
        )
        self.assertIn("bar: 12 modes, mass 0.81 kg", done.out)
        self.assertIn("and 8 more", done.out)
        self.assertTrue((self.folder / "out/bar-modes.png").is_file())
        rows = self.rows(self.folder / "bar.csv")
        frequency = self.column(rows, "frequency_hz")
        self.assertEqual(list(frequency[:6]), [0] * 6)
        # Rigid motion has the entire mass along each axis; elastic modes of a free body have none.
        for axis in "xyz":
            mass = self.column(rows, f"effective_mass_{axis}_kg")
            self.assertAlmostEqual(mass[:6].sum() / (2700 * 0.3 * 0.05 * 0.02), 1, delta=1e-9)
            self.assertLess(mass[6:].max(), 1e-9)
        np.testing.assert_allclose(self.column(rows, "damping_ratio")[6:], 0.01, rtol=1e-12)
        self.assertTrue(np.isnan(self.column(rows, "contact_share")).all())  # there are no candidates
        again = self.succeed(Forked("modes", scene, "-n", "1"))
        self.assertIn("bar: 12 modes", again.out)
        self.assertEqual(len(list((self.folder / "out").glob("*.kernel.h5"))), 1)  # the kernel is reused
        self.refused(Forked("impact", scene))

    def modes_of_rods(self, *words):
        scene = MESHES / "two-rods/two-rods.toml"
        return Forked("modes", scene, "-n", "1", "--out", self.folder, "--set", "modes.count=40", *words)

    def test_stored_modes_are_counted_again(self):
        self.refused(self.modes_of_rods("--verify"))
        self.succeed(self.modes_of_rods())
        self.assertIn("moving: 10 counts agree", self.succeed(self.modes_of_rods("--verify")).out)
        # A wrong frequency, and a mode that the file lost, though its certificate agrees with what is left.
        (kernel,) = self.folder.glob("moving-*.kernel.h5")
        with h5py.File(kernel, "r+") as file:
            file["modes/angular_frequency"][1:] *= 1.05
            file["modes/certificate/shift"][:] *= 1.05**2
        done = self.modes_of_rods("--verify")
        self.assertEqual(done.status, 1)
        self.assertRegex(
            done.err, r"warning: moving: \d+ modes lie below \d\.\d+ Hz, but the kernel has \d+\n"
        )

    def test_options_of_mumps_that_would_change_a_count_are_refused(self):
        for option in ("-mat_mumps_icntl_24 1", "-mat_mumps_cntl_4 1e-6", "-mat_mumps_icntl_35 2"):
            with unittest.mock.patch.dict(os.environ, {"PETSC_OPTIONS": option}):
                done = self.modes_of_rods()
            self.assertEqual(
                (done.status, done.err.strip().splitlines()[-1]),
                (
                    2,
                    f"ricochet-kernel: PETSC_OPTIONS: {option.split()[0]}: would change the inertia counts "
                    "that prove the modes: leave it out",
                ),
            )

    def test_a_breakdown_on_all_ranks_is_reported_in_one_line(self):
        self.write("bar.geo", GEO)
        scene = self.write("bar.toml", BAR)
        with unittest.mock.patch.dict(os.environ, {"PETSC_OPTIONS": "-mat_mumps_icntl_23 1"}):  # 1 MB
            # So many modes need a slice on each rank.
            done = Forked("kernel", scene, "-n", "2", "--quiet", "--set", "modes.count=120")
        self.refused(done, status=1)
        self.assertRegex(done.err, "^ricochet-kernel: MUMPS could not factor .*: not enough memory")

    def test_memory_decides_before_matrices_are_assembled(self):
        self.write("bar.geo", GEO)
        scene = self.write("bar.toml", BAR)

        def run_with(mib, ranks=2):
            """A run on so many ranks of a machine with this memory."""
            meminfo = self.write("meminfo", f"MemAvailable: {mib * 1024} kB\n")
            with unittest.mock.patch.dict(os.environ, {"RICOCHET_TEST_MEMINFO": str(meminfo)}):
                words = ["--out", self.folder / str(mib), "--set", "bodies.bar.size_factor=0.5"]
                return Forked("kernel", scene, "-n", str(ranks), *words)

        # 10 530 unknowns: 24 MiB of matrices; on one team of two ranks, 29 MiB a rank for factors and modes.
        done = run_with(26)
        self.assertEqual(done.status, 2, done.err)
        self.assertRegex(
            done.err,
            r"ricochet-kernel: bar.geo: its matrices would need \d+ MiB a rank, 11 of 13 free ones may be used",
        )
        self.assertNotIn("assembly", done.out + done.err)
        done = run_with(50)
        self.assertEqual(done.status, 2, done.err)
        self.assertRegex(done.err, "its factorisation would need")
        done = self.succeed(run_with(72))
        self.assertNotIn("at a time", done.out + done.err)  # one team, because two would not fit
        done = self.succeed(run_with(4000))
        self.assertIn("2 at a time", done.out + done.err)

        # Neither four nor two teams of four ranks fit: the number of nodes shows it, or the matrices of four.
        for mib, times in ((10, 0), (25, 1)):
            done = run_with(mib, ranks=4)
            self.assertEqual(done.status, 2, done.err)
            self.assertEqual((done.out + done.err).count("mesh, for fewer teams"), times, done.err)

    def test_a_body_without_a_free_node_is_refused(self):
        self.write("bar.geo", GEO + 'Physical Surface("skin") = Surface{:};\n')
        scene = self.write("bar.toml", BAR.replace("[modes]", 'support = { skin = "xyz" }\n[modes]'))
        done = Forked("kernel", scene, "-n", "2", "--quiet", "--set", "bodies.bar.order=1")
        self.refused(done, "the supports hold every node of the mesh")

    def test_scenes_without_bodies_are_refused(self):
        scene = self.write(
            "table.toml", '[contact]\nkernel = "table"\ntable = "k.h5"\n[time]\nduration = 1.0\n'
        )
        self.refused(Forked("modes", scene, "-n", "1"), "there are no bodies with modes")


if __name__ == "__main__":
    os.environ.pop("RICOCHET_LAUNCHER", None)
    unittest.main()
