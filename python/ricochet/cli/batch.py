# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study on a SLURM cluster: one job for the kernels, an array for the impacts, one that collects.

    ricochet batch study.toml --ranks 64 --parts 20
    ricochet batch study.toml --ranks 64 --parts 20 --kernel-options "--partition=long --time=12:00:00" --dry-run

The scripts of the jobs and their logs are in out/ beside the study, where results appear too. A job that is killed goes on
when it is requeued, and `ricochet batch` with the same arguments submits again what is missing.
"""
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from ricochet import programs
from ricochet import files
from ricochet.cli.command_line import Parser, ranks, say, told
from ricochet.result_file import BadInput
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

UNREACHED = ("contact slurm controller", "configuration source", "Socket timed out")  # in what sbatch says then


def directive(word):
    """An option as sbatch takes it from a script's comment, where a blank would end it and quotes would go."""
    return '"{}"'.format(re.sub(r'["\\]', r"\\\g<0>", word)) if re.search(r"""[\s\\"'#]""", word) else word


def directives(option, text):
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise BadInput(f"{option}: {text}: {error}. Give options of sbatch, quotes closed.") from None
    if re.search(r"[\r\n]", text):
        raise BadInput(f"{option}: {text}: has a line break: give options of sbatch in one line")
    return words


class Jobs:
    def __init__(self, study, options, folder):
        if re.search(r"[\r\n]", str(folder)):
            raise BadInput(f"{folder}: has a line break, which sbatch does not take: choose another --out")
        self.study, self.options, self.folder = study, options, folder
        self.sweep = [programs.BIN / "ricochet", "sweep", options.study.resolve(), "--out", folder]

    def write(self, stage, words, own, more, log="%j"):
        """The script of a stage; what the user says for sbatch comes last, and wins."""
        stem = f"{self.folder / self.study.slug}.{stage}"
        launcher = os.environ.get("RICOCHET_LAUNCHER")
        command = " ".join(word if word.startswith('"$') else shlex.quote(word) for word in map(str, [*self.sweep, *words]))
        path = Path(f"{stem}.sh")
        text = JOB.format(
            name=f"{self.study.slug}-{stage}", log=directive(f"--output={stem.replace('%', '%%')}.{log}.log"),
            directives="\n".join(f"#SBATCH {directive(word)}" for word in [*own, *more]),
            bin=shlex.quote(str(programs.BIN)), launcher=f" RICOCHET_LAUNCHER={shlex.quote(launcher)}" if launcher else "",
            command=command)
        files.write(path, os.fsencode(text))
        return path

    def scripts(self):
        o = self.options
        kernels = directives("--kernel-options", o.kernel_options)
        impacts = directives("--impact-options", o.impact_options)
        return {
            "kernels": self.write("kernels", ["--kernels", "--ranks", o.ranks, "--jobs", o.ranks], [f"--ntasks={o.ranks}"], kernels),
            "impacts": self.write("impacts", ["--part", f'"$SLURM_ARRAY_TASK_ID"/{o.parts}', "--jobs", o.cores],
                                  ["--ntasks=1", f"--cpus-per-task={o.cores}", f"--array=1-{o.parts}"], impacts, log="%A.%a"),
            "collect": self.write("collect", ["--collect", "--jobs", 1], ["--ntasks=1"], impacts)}


def submit(script, *words):
    """The job's number."""
    done = subprocess.run(["sbatch", "--parsable", *words, str(script)], capture_output=True, text=True)
    if done.returncode != 0:
        said = [line.removeprefix("sbatch: ").removeprefix("error: ") for line in done.stderr.splitlines() if line.strip()]
        if any(text in line for line in said for text in UNREACHED):
            raise BadInput(f"sbatch reaches no SLURM controller ({said[0]}): look with --dry-run, or run ricochet sweep here")
        raise BadInput(f"sbatch refused {script}: {'; '.join(said)}")
    return done.stdout.strip().split(";")[0]


def words():
    """The command's words, with what sbatch is to be told joined to its option: argparse takes a lone "--time=1:00" for another."""
    given, found = iter(sys.argv[1:]), []
    for word in given:
        found.append(f"{word}={next(given, '')}" if word in ("--kernel-options", "--impact-options") else word)
    return found


def arguments():
    parser = Parser(__doc__, "STUDY.toml")
    parser.add_argument("study", type=Path, metavar="STUDY.toml", help="as of ricochet sweep")
    parser.add_argument("--ranks", type=ranks, default=2, help="MPI ranks of the job for kernels (default: 2)")
    parser.add_argument("--parts", type=int, default=10, help="jobs in the array of impacts (default: 10)")
    parser.add_argument("--cores", type=int, default=1, help="of each of these (default: 1)")
    parser.add_argument("--kernel-options", default="", metavar="TEXT", help="more options of sbatch for the kernels")
    parser.add_argument("--impact-options", default="", metavar="TEXT", help="likewise, for impacts and collecting")
    parser.add_argument("--out", type=Path, help="folder of kernels and results (default: out/ beside the study)")
    parser.add_argument("--dry-run", action="store_true", help="write the scripts, submit nothing")
    options = parser.parse_args(words())
    if min(options.parts, options.cores) < 1:
        parser.error("--parts and --cores must be 1 or more")
    return options


def main():
    options = arguments()
    try:
        study = Study(options.study)
        folder = (options.out or options.study.parent / "out").resolve()
        folder.mkdir(parents=True, exist_ok=True)
        scripts = Jobs(study, options, folder).scripts()
        if options.dry_run:
            say("\n".join(str(script) for script in scripts.values()))
            return 0
        if not shutil.which("sbatch"):
            raise BadInput(f"there is no sbatch here: submit {folder}/{study.slug}.*.sh where SLURM is, in the order kernels, "
                           "impacts, collect")
        kernels = submit(scripts["kernels"])
        impacts = submit(scripts["impacts"], f"--dependency=afterok:{kernels}", "--kill-on-invalid-dep=yes")
        collect = submit(scripts["collect"], f"--dependency=afterany:{impacts}", "--kill-on-invalid-dep=yes")
        say(f"kernels {kernels}, impacts {impacts} ({options.parts} parts), collect {collect}\n"
            f"results: {folder / study.slug}.sweep.h5 and .csv when {collect} has ended; logs: {folder / study.slug}.*.log")
    except BadInput as problem:
        print(f"batch: {told(problem)}", file=sys.stderr)
        return 2
    except OSError as problem:
        print(f"batch: {told(problem.filename or folder)}: {problem.strerror or problem}: is the disk full, or the folder read-only? "
              "Choose another --out", file=sys.stderr)
        return 2
    return 0
