# SPDX-License-Identifier: BSD-2-Clause
"""The solver for the K and M of other programs: the example with files of PETSc, and options in place of calls."""
import subprocess
import tempfile
import unittest
from pathlib import Path

import eps_matrices
from eps_matrices import exact
from ricochet import programs


class Example(unittest.TestCase):
    def eigenvalues(self, ranks, *options, program=programs.BIN / "eigenpairs"):
        """Eigenvalues that the example, or another program, prints"""
        with tempfile.TemporaryDirectory() as folder:
            eps_matrices.write(Path(folder))
            files = ("-k", f"{folder}/K.petsc", "-m", f"{folder}/M.petsc")
            command = [*programs.mpirun(ranks), program, *files, *options]
            done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=True)
        return [float(line) for line in done.stdout.splitlines() if line.strip().replace(".", "").isdigit()]

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
                run = subprocess.run(list(map(str, command)), capture_output=True, text=True)
                self.assertEqual(run.returncode, status)
                said = run.stderr if status else run.stdout
                self.assertEqual(said.count(part), 1, said)

    def test_is_an_option_of_programs_that_are_linked_with_slepc_alone(self):
        source = (programs.ROOT / "examples/eps/eigenpairs.c").read_text()
        alone = "\n".join(
            line for line in source.splitlines() if "EPSRicochet" not in line and "EPSSetType" not in line
        )
        flags = subprocess.run(
            ["pkg-config", "--cflags", "--libs", "slepc", "petsc", "mpi-c"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "alone.c"
            path.write_text(alone.replace("<ricochet/eps.h>", "<slepceps.h>"))
            subprocess.run(["cc", path, *flags, "-o", f"{folder}/alone"], check=True)
            library = programs.BIN.parent / "src/libricochet-eps.so"
            options = ("-dll_append", library, "-eps_type", "ricochet", "-eps_nev", "5")
            self.check(self.eigenvalues(2, *options, program=f"{folder}/alone"), range(1, 6))


if __name__ == "__main__":
    unittest.main()
