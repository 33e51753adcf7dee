# SPDX-License-Identifier: BSD-2-Clause
"""SLURM jobs of a study: one for the kernels, an array for the impacts, one that collects the results."""
import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ricochet import files, programs
from ricochet.errors import InputError
from ricochet.studies.study import Study

JOB = """#!/bin/bash
#SBATCH --job-name={name}
#SBATCH {log}
#SBATCH --requeue
{directives}
set -euo pipefail
export RICOCHET_BIN={bin} OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1{launcher}
exec {command}
"""

# Errors of sbatch if there is no controller.
UNREACHED = ("contact slurm controller", "configuration source", "Socket timed out")


def directive(word: str) -> str:
    """Quotes an option for an #SBATCH line, in which blanks would end it and quotes would be removed."""
    return '"{}"'.format(re.sub(r'["\\]', r"\\\g<0>", word)) if re.search(r"""[\s\\"'#]""", word) else word


def directives(option: str, text: str) -> list[str]:
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise InputError(f"{option}: {text}: {error}. Give options of sbatch and close all quotes.") from None
    if re.search(r"[\r\n]", text):
        raise InputError(f"{option}: {text}: has a line break: give options of sbatch in one line")
    return words


class Jobs:
    """The scripts of the three jobs."""

    def __init__(
        self, study: Study, folder: Path, ranks: int, parts: int, cores: int, retry: bool = False
    ) -> None:
        if re.search(r"[\r\n]", str(folder)):
            raise InputError(f"{folder}: has a line break, which sbatch does not take: choose another --out")
        self.study, self.folder, self.ranks, self.parts, self.cores = study, folder, ranks, parts, cores
        self.again = ["--retry"] * retry
        self.sweep = [programs.BIN / "ricochet", "sweep", study.path.resolve(), "--out", folder]

    def write(self, kernel_options: str, impact_options: str) -> list[Path]:
        """Writes the scripts of kernels, impacts and collecting. Raises OSError."""
        kernels = directives("--kernel-options", kernel_options)
        impacts = directives("--impact-options", impact_options)
        return [
            self._script(
                "kernels",
                ["--kernels", "--ranks", self.ranks, "--jobs", self.ranks, *self.again],
                [f"--ntasks={self.ranks}", *kernels],
            ),
            self._script(
                "impacts",
                ["--part", f'"$SLURM_ARRAY_TASK_ID"/{self.parts}', "--jobs", self.cores, *self.again],
                ["--ntasks=1", f"--cpus-per-task={self.cores}", f"--array=1-{self.parts}", *impacts],
                log="%A.%a",
            ),
            self._script("collect", ["--collect", "--jobs", 1], ["--ntasks=1", *impacts]),
        ]

    def _script(self, stage: str, words: Sequence[Any], options: list[str], log: str = "%j") -> Path:
        """Writes the script of a stage. `options` are options of sbatch; a later option overrides an earlier
        one."""
        stem = f"{self.folder / self.study.slug}.{stage}"
        launcher = os.environ.get("RICOCHET_LAUNCHER")
        command = map(str, [*self.sweep, *words])
        text = JOB.format(
            name=f"{self.study.slug}-{stage}",
            log=directive(f"--output={stem.replace('%', '%%')}.{log}.log"),
            directives="\n".join(f"#SBATCH {directive(word)}" for word in options),
            bin=shlex.quote(str(programs.BIN)),
            launcher=f" RICOCHET_LAUNCHER={shlex.quote(launcher)}" if launcher else "",
            command=" ".join(word if word.startswith('"$') else shlex.quote(word) for word in command),
        )
        path = Path(f"{stem}.sh")
        files.write(path, os.fsencode(text))
        return path


def submit(study: Study, scripts: Sequence[Path]) -> list[str]:
    """Submits the jobs in turn and returns their numbers. The impacts wait for the kernels, and collecting
    waits for all impacts."""
    if not shutil.which("sbatch"):
        raise InputError(
            f"there is no sbatch here: submit {scripts[0].parent}/{study.slug}.*.sh where SLURM is, in the order "
            "kernels, impacts, collect"
        )
    numbers: list[str] = []
    for script, condition in zip(scripts, ("", "afterok", "afterany")):
        after = [f"--dependency={condition}:{numbers[-1]}", "--kill-on-invalid-dep=yes"] if condition else []
        numbers.append(sbatch(script, after))
    return numbers


def sbatch(script: Path, words: list[str]) -> str:
    """Submits a script and returns the number of the job."""
    done = subprocess.run(["sbatch", "--parsable", *words, str(script)], capture_output=True, text=True)
    if done.returncode != 0:
        lines = [line.removeprefix("sbatch: ").removeprefix("error: ") for line in done.stderr.splitlines()]
        errors = [line for line in lines if line.strip()]
        if any(text in line for line in errors for text in UNREACHED):
            raise InputError(
                f"sbatch reaches no SLURM controller ({errors[0]}): inspect the jobs with --dry-run, "
                "or run ricochet sweep here"
            )
        raise InputError(f"sbatch refused {script}: {'; '.join(errors)}")
    return done.stdout.strip().split(";")[0]
