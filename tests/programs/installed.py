# SPDX-License-Identifier: BSD-2-Clause
"""The result of `cmake --install`: programs that run from PATH outside the tree, one version, shell completion, pkg-config."""

import os
import re
import shutil
import subprocess
import unittest

import h5py

import eps_matrices
from programs import BIN, MESHES, SOURCE, Command, ProgramTest, Run

BUILD = BIN.parent
VERSION = re.search(r"project\(Ricochet VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
PROGRAMS = ["ricochet", "ricochet-contact", "ricochet-kernel", "ricochet-recast"]
VERBS = [
    "run",
    "modes",
    "kernel",
    "impact",
    "plot",
    "report",
    "sweep",
    "tradeoff",
    "surfaces",
    "materials",
    "example",
    "import",
    "export",
    "batch",
]
COMMANDS = [*PROGRAMS[1:], *(f"ricochet {verb}" for verb in VERBS)]
# The input of commands that do not read a scene or a study.
READS = {name: {"b.result.h5"} for name in ("ricochet plot", "ricochet report", "ricochet-recast")}
READS |= {"ricochet export": {"a.toml", "b.result.h5"}, "ricochet surfaces": {"d.step"}}
READS |= {
    "ricochet import": {"mesh", "calculix", "matrices"},
    "ricochet materials": set(),
    "ricochet example": set(),
}


class Installed(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.prefix = cls.shared_folder()
        for component in ("programs", "python", "library", "eps"):
            subprocess.run(
                ["cmake", "--install", BUILD, "--component", component, "--prefix", cls.prefix],
                check=True,
                capture_output=True,
            )

    def call(self, *command, path="{bin}:/usr/bin:/bin", **more):
        """Runs a command without the environment variables that point to the tree."""
        found = {
            name: value for name, value in os.environ.items() if not name.startswith(("RICOCHET", "PYTHON"))
        }
        found |= {
            "PATH": path.format(bin=self.prefix / "bin"),
            "OMPI_ALLOW_RUN_AS_ROOT": "1",
            "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        }
        return Run(command, env=found | more, cwd=self.folder)

    def options(self, command):
        """The options that start a line of --help, with or without a short form before the long one."""
        program, *verb = command.split()
        # Verbs have the text of the checkout, which needs no start of Python here.
        text = (Command(*verb, "--help") if verb else self.call(program, "--help")).out
        return {
            word
            for line in text.splitlines()
            for word in re.findall(r"^  (-\w)?\S*?(?: \w+)?,? ?(--[a-z][a-z0-9-]*)?", line)[:1]
            for word in word
            if word
        }

    def succeed_in(self, done):
        return self.succeed(done).out

    def test_every_program_is_there_and_says_the_version_of_the_project(self):
        self.assertEqual({path.name for path in (self.prefix / "bin").iterdir()}, set(PROGRAMS))
        for name in (*PROGRAMS, "ricochet run"):  # command.py asks the other verbs
            self.assertEqual(self.succeed_in(self.call(*name.split(), "--version")), f"{name} {VERSION}\n")
        self.assertEqual(
            self.succeed_in(
                self.call(
                    "pkg-config",
                    "--modversion",
                    "ricochet",
                    PKG_CONFIG_PATH=str(self.prefix / "share/pkgconfig"),
                )
            ).strip(),
            VERSION,
        )
        (config,) = self.prefix.glob("lib/**/RicochetConfigVersion.cmake")
        self.assertIn(f'set(PACKAGE_VERSION "{VERSION}")', config.read_text())
        self.assertIn(f'set(CPACK_PACKAGE_VERSION "{VERSION}")', (BUILD / "CPackConfig.cmake").read_text())
        self.assertEqual(re.search(r"^## \[(\S+)\]", (SOURCE / "CHANGELOG.md").read_text(), re.M)[1], VERSION)

    def test_a_program_of_slepc_is_compiled_with_the_eigensolver(self):
        eps_matrices.write(self.folder)
        found = {"PKG_CONFIG_PATH": str(self.prefix / "share/pkgconfig")}
        flags = self.succeed_in(
            self.call("pkg-config", "--cflags", "--libs", "ricochet-eps", **found)
        ).split()
        example = SOURCE / "examples/eps/eigenpairs.c"
        self.succeed_in(self.call("cc", example, *flags, "-o", "eigenpairs"))
        (library,) = self.prefix.glob("lib/**/libricochet-eps.so")
        printed = self.succeed_in(
            self.call(
                *("./eigenpairs", "-k", "K.petsc", "-m", "M.petsc", "-eps_nev", "3", "-eps_view"),
                LD_LIBRARY_PATH=str(library.parent),
            )
        )
        self.assertIn(f"{eps_matrices.exact(2):.5f}", printed)
        self.assertIn("type: ricochet", printed)
        self.assertIn("inertia: ", printed)

    def test_a_scene_goes_from_mesh_to_pictures_and_a_study_to_its_table(self):
        for path in (MESHES / "two-rods").glob("*.*"):
            shutil.copy(path, self.folder)
        words = ["run", "-n", "1", "two-rods.toml", "--out", "found", "--set", "modes.count=5"]
        self.succeed(self.call("ricochet", *words))
        self.assertTrue((self.folder / "found/two-rods-contact.png").is_file())
        for path in (self.folder / "found").glob("*.h5"):
            with h5py.File(path) as file:
                self.assertEqual(file.attrs["created_by"].decode().split()[-1], VERSION, path)
        self.write(
            "study.toml",
            'scene = "two-rods.toml"\n[set]\n"modes.count" = 5\n[grid]\n"contact.gap" = [0.0, 0.1]\n',
        )
        self.succeed_in(self.call("ricochet", "sweep", "study.toml", "--out", "found"))
        self.assertEqual(len((self.folder / "found/study.sweep.csv").read_text().splitlines()), 3)
        refused = self.call("ricochet", "batch", "study.toml", path="{bin}")
        self.refused(refused, "there is no sbatch here")

    def completed(self, command, words):
        """The completions that the shell offers for the last of `words`."""
        program = command.split()[0]
        script = (
            f"source {self.prefix}/share/bash-completion/completions/{program}\n"
            f"COMP_WORDS=({command} {words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n"
            f"_ricochet {program}; printf '%s\\n' \"${{COMPREPLY[@]}}\""
        )
        return set(self.succeed_in(self.call("bash", "-c", script)).split())

    def test_the_shell_completes_values_and_they_are_accepted(self):
        for path in (MESHES / "two-rods").glob("*.*"):
            shutil.copy(path, self.folder)
        schemes = {"compliant", "impulse", "static"}
        # bash takes "=" for a word of its own, except in quotes; other shells do not.
        for words, expected in (
            ("contact.scheme =", schemes),
            ("contact.scheme = ''", schemes),
            ("contact.scheme = im", {"impulse"}),
            ("contact.scheme=im", {"contact.scheme=impulse"}),
            ('"\'contact.scheme=im"', {"contact.scheme=impulse"}),
            ("modes.residual_flexibility = t", {"true"}),
            ("time.duration = ''", set()),
        ):
            self.assertEqual(
                self.completed("ricochet impact", f"two-rods.toml --set {words}"), expected, words
            )
        for key in ("accuracy", "modes.basis", "modes.solver", "contact.admittance", "output.view"):
            offered = self.completed("ricochet impact", f"two-rods.toml --set {key}=")
            self.assertTrue(offered)
            for setting in offered:
                done = self.call("ricochet-contact", "two-rods.toml", "--dry-run", "--set", setting)
                self.assertNotIn("must be", done.err)

    def test_a_checkout_completes_as_well(self):
        self.write("a.toml", "")
        script = "COMP_WORDS=(ricochet plot ''); COMP_CWORD=2; _ricochet ricochet; echo ${COMPREPLY[@]}"
        done = self.call("bash", "-c", f". {SOURCE}/cmake/completion.bash; cd {self.folder}/..; {script}")
        self.assertIn(self.folder.name, self.succeed_in(done))

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish_completes_as_bash_does(self):
        self.write("a.toml", "")
        for file in (
            self.prefix / "share/fish/vendor_completions.d/ricochet-contact.fish",
            SOURCE / "cmake/completion.fish",
        ):
            for words, expected in (
                ("ricochet im", {"impact", "import"}),
                ("ricochet impact a.toml --set contact.scheme=i", {"contact.scheme=impulse"}),
                ("ricochet-contact --dr", {"--dry-run"}),
            ):
                done = self.call(
                    "fish",
                    "--no-config",
                    "-c",
                    f"source {file}; complete -C '{words}'",
                    HOME=str(self.folder),
                )
                self.assertEqual(set(self.succeed_in(done).split()), expected)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_completes_as_bash_does(self):
        self.write("a.toml", "")
        for load in (
            f"source {SOURCE}/cmake/completion.zsh",
            f"fpath=({self.prefix}/share/zsh/vendor-completions $fpath); autoload -Uz _ricochet",
        ):
            for words, expected in (
                ("ricochet im", {"impact", "import"}),
                ("ricochet impact a.toml --set contact.scheme=i", {"contact.scheme=impulse"}),
                ("ricochet impact a.toml --set contact.sch", {"contact.scheme="}),
            ):
                script = (
                    "compdef() { }; compadd() { while [[ $1 != -- ]]; do shift; done; print -l -- ${@:2} }; "
                    f"{load}; words=({words}); CURRENT=$#words; _ricochet"
                )
                done = self.call("zsh", "-f", "-c", script)
                self.assertEqual(set(self.succeed_in(done).split()), expected)

    def test_the_shell_completes_all_options_and_the_files_that_programs_read(self):
        for name in ("a.toml", "b.result.h5", "c.csv", "d.step", "e.inp"):
            self.write(name, "")
        (self.folder / "folder").mkdir()
        for name in COMMANDS:
            options = self.options(name)
            self.assertLessEqual({"--help", "--version"}, options)
            self.assertEqual(self.completed(name, "-"), options)
            folder = (
                set() if name in ("ricochet import", "ricochet materials", "ricochet example") else {"folder"}
            )
            self.assertEqual(self.completed(name, '""'), READS.get(name, {"a.toml"}) | folder)
        for name, option in (("sweep", "--out"), ("plot", "--kernels"), ("report", "--kernels")):
            self.assertEqual(self.completed(f"ricochet {name}", f"{option} ''"), {"folder"})

    def test_the_shell_completes_verbs(self):
        self.assertEqual(self.completed("ricochet", "''"), set(VERBS))
        self.assertEqual(self.completed("ricochet", "im"), {"impact", "import"})
        self.assertEqual(self.completed("ricochet", "--v"), {"--version"})

    def test_the_shell_completes_the_commands_of_import_with_what_each_takes(self):
        for name in ("e.inp", "k.mtx", "n.txt", "a.toml"):
            self.write(name, "")
        self.assertEqual(self.completed("ricochet import", "mat"), {"matrices"})
        self.assertEqual(self.completed("ricochet import", "calculix ''"), {"e.inp"})
        self.assertEqual(self.completed("ricochet import", "mesh ''"), {"e.inp"})
        self.assertEqual(self.completed("ricochet import", "matrices k.mtx ''"), {"k.mtx", "n.txt"})
        self.assertEqual(self.completed("ricochet import", "matrices --s"), {"--surface", "--support"})
        for command in ("mesh", "calculix", "matrices"):
            self.assertEqual(
                self.completed("ricochet import", f"{command} -"), self.options(f"ricochet import {command}")
            )

    def test_the_shell_completes_the_keys_of_a_scene_and_they_are_accepted(self):
        for path in (MESHES / "two-rods").glob("*.*"):
            shutil.copy(path, self.folder)
        keys = self.completed("ricochet impact", "two-rods.toml --set ''")
        self.assertLess(
            {
                "title=",
                "accuracy=",
                "contact.gap=",
                "modes.count=",
                "bodies.moving.material.young=",
                "bodies.resting.mesh=",
            },
            keys,
        )
        self.assertFalse([key for key in keys if "NAME" in key or not re.fullmatch(r"[a-z0-9_.]+=", key)])
        self.assertEqual(self.completed("ricochet run", "two-rods.toml --set modes.co"), {"modes.count="})
        self.assertEqual(self.completed("ricochet impact", "--set bodies."), set())
        # A wrong key would give "unknown key". Errors in values and combinations do not matter here.
        for key in keys:
            refused = self.call("ricochet-contact", "two-rods.toml", "--dry-run", "--set", key + "0")
            self.assertNotIn("unknown key", refused.err, key)


if __name__ == "__main__":
    unittest.main()
