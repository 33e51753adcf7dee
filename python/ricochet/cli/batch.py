# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study on a SLURM cluster: one job for the kernels, an array for the impacts, one that collects the results.

    ricochet batch study.toml --ranks 64 --parts 20
    ricochet batch study.toml --ranks 64 --parts 20 --kernel-options "--partition=long --time=12:00:00" --dry-run

The scripts of the jobs, their logs and the results are in out/ beside the study. A job that was killed resumes its work when
it is requeued, and the same command submits again what is missing.
"""
import argparse
from pathlib import Path

from ricochet.cli.options import count, ranks, say, writing
from ricochet.studies import slurm
from ricochet.studies.study import Study

TAKES_OPTIONS = ("--kernel-options", "--impact-options")


def joined(words: list[str]) -> list[str]:
    """Joins options for sbatch to their own option: argparse takes a lone "--time=1:00" for another option."""
    rest, found = iter(words), []
    for word in rest:
        found.append(f"{word}={next(rest, '')}" if word in TAKES_OPTIONS else word)
    return found


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("study", type=Path, metavar="STUDY.toml", help="as for ricochet sweep")
    parser.add_argument(
        "-n",
        "--ranks",
        type=ranks,
        default=2,
        metavar="N",
        help="MPI ranks of the job for kernels (default: 2)",
    )
    parser.add_argument(
        "--parts", type=count, default=10, metavar="N", help="jobs in the array of impacts (default: 10)"
    )
    parser.add_argument(
        "--cores", type=count, default=1, metavar="N", help="cores of each of these (default: 1)"
    )
    parser.add_argument(
        "--kernel-options", default="", metavar="TEXT", help="more options of sbatch for the kernels"
    )
    parser.add_argument(
        "--impact-options",
        default="",
        metavar="TEXT",
        help="more options of sbatch for impacts and collecting",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder of kernels and results (default: out/ beside the study)",
    )
    parser.add_argument("--dry-run", action="store_true", help="write the scripts, submit nothing")


def run(options: argparse.Namespace) -> None:
    study = Study(options.study)
    folder = (options.out or options.study.parent / "out").resolve()
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        jobs = slurm.Jobs(study, folder, options.ranks, options.parts, options.cores)
        scripts = jobs.write(options.kernel_options, options.impact_options)
        if options.dry_run:
            say("\n".join(str(script) for script in scripts))
            return
        kernels, impacts, collect = slurm.submit(study, scripts)
        say(
            f"kernels {kernels}, impacts {impacts} ({options.parts} parts), collect {collect}\n"
            f"results: {folder / study.slug}.sweep.h5 and .csv when {collect} has ended; "
            f"logs: {folder / study.slug}.*.log"
        )
