# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study on a SLURM cluster: one job for the kernels, an array for the impacts, one that collects the results.

    ricochet batch study.toml --ranks 64 --parts 20
    ricochet batch study.toml --ranks 64 --parts 20 --kernel-options "--partition=long --time=12:00:00" --dry-run

The scripts of the jobs, their logs and the results are in out/ beside the study. A job that is requeued after it was killed
resumes its work. The same command again submits the missing work. The last job has the exit status of ricochet sweep
--collect: 0 if all impacts are finished.
"""
import argparse

from ricochet.cli.options import add_count, add_study, ranks, say, writing
from ricochet.studies import slurm
from ricochet.studies.study import Study

TAKES_OPTIONS = ("--kernel-options", "--impact-options")


def joined(words: list[str]) -> list[str]:
    """Joins each option for sbatch to --kernel-options or --impact-options before it, because argparse takes
    a separate "--time=1:00" for another option."""
    rest, found = iter(words), []
    for word in rest:
        found.append(f"{word}={next(rest, '')}" if word in TAKES_OPTIONS else word)
    return found


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_study(parser, ranks)  # which run elsewhere
    add_count(parser, "--parts", 10, "jobs in the array of impacts")
    add_count(parser, "--cores", 1, "cores of each of these")
    for option, jobs in zip(TAKES_OPTIONS, ("the kernels", "impacts and collecting")):
        parser.add_argument(option, default="", metavar="TEXT", help=f"more options of sbatch for {jobs}")
    parser.add_argument(
        "--retry", action="store_true", help="run impacts again that were refused or have failed"
    )
    parser.add_argument("--dry-run", action="store_true", help="write the scripts, submit nothing")


def run(options: argparse.Namespace) -> None:
    study = Study(options.study)
    folder = (options.out or options.study.parent / "out").resolve()
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        jobs = slurm.Jobs(study, folder, options.ranks, options.parts, options.cores, options.retry)
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
