# SPDX-License-Identifier: BSD-2-Clause
"""The solver for the K and M of other programs: the example with files of PETSc, and options in place of calls."""
import unittest

import eps_matrices
from eps_matrices import exact
from programs import ProgramTest, Run
from ricochet import programs


class Example(ProgramTest):
    def eigenvalues(self, ranks, *options, program=programs.BIN / "eigenpairs"):
        """Eigenvalues that the example, or another program, prints"""
        eps_matrices.write(self.folder)
        files = ("-k", self.folder / "K.petsc", "-m", self.folder / "M.petsc")
        done = self.succeed(Run([*programs.mpirun(ranks), program, *files, *options]))
        return [float(line) for line in done.out.splitlines() if line.strip().replace(".", "").isdigit()]

    def check(self, found, numbers):
        self.assertEqual(len(found), len(numbers))
        for value, number in zip(found, numbers):
            self.assertAlmostEqual(value, exact(number), delta=1e-5)  # five decimals are printed

    def test_prints_the_lowest(self):
        for ranks in (1, 2):
            self.check(self.eigenvalues(ranks, "-eps_nev", "12"), range(1, 13))

    def test_prints_those_in_an_interval(self):
        ends = f"{(exact(30) + exact(31)) / 2},{(exact(75) + exact(76)) / 2}"
        self.check(self.eigenvalues(2, "-eps_interval", ends, "-eps_all"), range(31, 76))

    def test_answers_and_refuses_options_in_one_line(self):
        for word, status, part in (
            ("--help", 0, "eigenpairs -k K.petsc -m M.petsc"),
            ("--version", 0, "eigenpairs, with "),
            ("--loud", 2, "eigenpairs: --loud: is not an option: --help shows them\n"),
        ):
            for ranks in (1, 2):
                command = [*programs.mpirun(ranks), programs.BIN / "eigenpairs", word]
                run = Run(command)
                self.assertEqual(run.status, status)
                said = run.err if status else run.out
                self.assertEqual(said.count(part), 1, said)

    def test_is_an_option_of_programs_that_are_linked_with_slepc_alone(self):
        source = (programs.ROOT / "examples/eps/eigenpairs.c").read_text()
        alone = "\n".join(
            line for line in source.splitlines() if "EPSRicochet" not in line and "EPSSetType" not in line
        )
        flags = Run(["pkg-config", "--cflags", "--libs", "slepc", "petsc", "mpi-c"]).out.split()
        path = self.write("alone.c", alone.replace("<ricochet/eps.h>", "<slepceps.h>"))
        self.succeed(Run(["cc", path, *flags, "-o", self.folder / "alone"]))
        library = programs.BIN.parent / "src/libricochet-eps.so"
        options = ("-dll_append", library, "-eps_type", "ricochet", "-eps_nev", "5")
        self.check(self.eigenvalues(2, *options, program=self.folder / "alone"), range(1, 6))


if __name__ == "__main__":
    unittest.main()
