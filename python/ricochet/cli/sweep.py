# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study: a scene over values of its keys. Settings share kernels, and impacts run side by side.

    ricochet sweep study.toml
    ricochet sweep study.toml --plot restitution --against 'bodies.upper.velocity[1]'

study.toml:

    scene = "two-disks.toml"
    [grid]                                              # every combination
    "bodies.upper.velocity[1]" = [-1.0, -2.0, -4.0]
    "contact.spacing" = { from = 5e-3, to = 2e-2, steps = 3 }
    [random]                                            # and each of them with these draws
    count = 20
    "bodies.upper.translate[0]" = { uniform = [-0.01, 0.01] }

All settings are checked before anything is computed. After an interruption, the same command resumes the work.
Results: <title>.sweep.h5 and <title>.sweep.csv in out/ beside the study. ricochet batch runs a study on a cluster.
"""
import argparse
import os
import re
from pathlib import Path

from ricochet import programs, scene_keys
from ricochet.cli.options import add_study, count, say, writing
from ricochet.errors import InputError
from ricochet.studies.journal import outputs
from ricochet.studies.records import Row
from ricochet.studies.study import Study
from ricochet.studies.sweep import Sweep
from ricochet.studies.table import Table


def part(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise argparse.ArgumentTypeError("give K/N with K from 1 to N")
    return int(found[1]), int(found[2])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_study(parser)
    parser.add_argument(
        "--jobs",
        type=count,
        default=os.cpu_count() or 1,
        metavar="N",
        help="impacts side by side (default: all cores)",
    )
    stage = parser.add_mutually_exclusive_group()
    stage.add_argument("--kernels", action="store_true", help="compute the kernels and stop")
    stage.add_argument(
        "--part",
        type=part,
        metavar="K/N",
        help="run the K-th of N parts of the impacts, with kernels that exist",
    )
    stage.add_argument(
        "--collect", action="store_true", help="write the results of finished impacts and stop"
    )
    parser.add_argument("--plot", metavar="OUTPUT", help="draw this column")
    parser.add_argument(
        "--against",
        nargs="+",
        metavar="INPUT",
        help="over one or two columns (default: the first one that is varied)",
    )


def check_options(options: argparse.Namespace) -> None:
    if options.against and len(options.against) > 2:
        raise InputError("--against takes one or two columns")
    if options.plot == "" or (options.plot is None and options.against):
        raise InputError("--plot takes the name of a column, and --against goes with --plot")
    if options.plot and (options.kernels or options.part):
        raise InputError("--plot goes with a whole sweep or --collect")


class Drawn:
    """The columns of the requested picture. An unknown name is reported after the first impact."""

    def __init__(self, study: Study, options: argparse.Namespace) -> None:
        self.inputs = study.keys
        self.names = [options.plot, *(options.against or study.keys[:1])] if options.plot else []
        self.unknown = set(self.names) - set(self.inputs)
        # If one of these keys is varied, the columns of the summaries differ.
        self.alike = not {"accuracy", "contact.scheme", "contact.kernel"} & set(study.keys)

    def check(self, row: Row) -> None:
        if self.unknown and self.alike and row["status"] == 0:
            found = outputs(row["summary"])
            if wrong := sorted(self.unknown - set(found)):
                known = ", ".join([*self.inputs, *found])
                raise InputError(f'"{wrong[0]}" is not a column of this sweep, which has {known}')
            self.unknown = set()


def number(amount: int, what: str) -> str:
    return f"{amount} {what}" + "s" * (amount != 1)


def report_kernels(sweep: Sweep) -> None:
    text = f"{number(len(sweep.kernels.names), 'kernel')}, all computed"
    if refused := sweep.refused:
        text += f"; {len(refused)} of {number(len(sweep.keys), 'impact')} are refused: {refused[min(refused)]['error']}"
    say(text)


def report_part(sweep: Sweep, ran: int) -> None:
    keys = [sweep.keys[index] for index in sweep.own()]
    failed = sum(sweep.journal.rows[key]["status"] != 0 for key in keys)
    k, n = sweep.part or (1, 1)
    earlier = " before" if not ran else ""
    say(
        f"part {k}/{n}: {number(len(keys), 'impact')}, all done{earlier}"
        + f", {failed} failed" * bool(failed)
    )


def report(sweep: Sweep, table: Table, drawn: Drawn, ran: int) -> None:
    failed = sum(status > 0 for status in table.status)
    waiting = sum(status < 0 for status in table.status)
    text = number(len(table.status), "impact")
    text += f", {waiting} not run yet" if waiting else ""
    text += ", all done before" if ran == 0 and not sweep.collects else ""
    text += f', {failed} refused or failed (column "error")' if failed else ""
    say(f"{text}\n{sweep.stem}.sweep.h5\n{sweep.stem}.sweep.csv")
    if drawn.names:
        output, *against = drawn.names
        picture = Path(f"{sweep.stem}.{output}.png")
        keys = programs.call([programs.BIN / "ricochet-contact", "--keys"], capture=True)
        from ricochet.studies.chart import draw

        draw(table.with_values(drawn.names), output, against, picture, scene_keys.units(keys))
        say(picture)


def run(options: argparse.Namespace) -> None:
    check_options(options)
    study = Study(options.study)
    folder = options.out or options.study.parent / "out"
    with writing(folder):
        sweep = Sweep(study, folder, options.jobs, options.ranks, options.part, options.collect)
        sweep.prepare()
        if options.kernels:
            report_kernels(sweep)
            return
        drawn = Drawn(study, options)
        if options.part:
            report_part(sweep, sweep.run(drawn.check))
            return
        ran = 0
        try:
            ran = 0 if options.collect else sweep.run(drawn.check)
        finally:
            table = sweep.write()
        report(sweep, table, drawn, ran)
