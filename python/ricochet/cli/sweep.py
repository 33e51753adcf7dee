# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study: a scene over values of its keys. Settings share kernels, and impacts run side by side.

    ricochet sweep study.toml
    ricochet sweep study.toml --plot restitution --against 'bodies.upper.velocity[1]'
    ricochet sweep study.toml --plot restitution --against 'abs(bodies.upper.velocity[1])'
    ricochet sweep study.toml --plot force

study.toml:

    scene = "two-disks.toml"
    keep = ["force"]                                    # records: also "receivers", "acceleration", "gauges", "bodies",
                                                        # "energy"
    [grid]                                              # every combination
    "bodies.upper.velocity[1]" = [-1.0, -2.0, -4.0]
    "contact.spacing" = { from = 5e-3, to = 2e-2, steps = 3 }
    [random]                                            # and each of them with these draws
    count = 20
    "bodies.upper.translate[0]" = { uniform = [-0.01, 0.01] }

All settings are checked before anything is computed. After an interruption, the same command resumes the work.
Results: <title>.sweep.h5 and <title>.sweep.csv in out/ beside the study. ricochet batch runs a study on a cluster.

Exit status: 0 if all impacts are finished, 3 if some were refused or, with --collect, have not run yet, and 1 if some
failed: their rows state why. 2 if the study is refused. --kernels and --part end with 0 when they have done their work.
"""
import argparse
import contextlib
import math
import os
import re
from pathlib import Path

from ricochet import scene_keys
from ricochet.cli.options import add_study, count, say, writing
from ricochet.errors import InputError, RicochetError, SolverError
from ricochet.studies import stage_log
from ricochet.studies.figures import is_record
from ricochet.studies.histories import not_kept
from ricochet.studies.journal import outputs
from ricochet.studies.labels import of_magnitude
from ricochet.studies.records import Row
from ricochet.studies.study import Study, meant
from ricochet.studies.sweep import Sweep
from ricochet.studies.table import Table

TOUCHING = "the bodies still touch at the end"  # in the warning of such an impact
LONGEST = "time.longest"  # likewise, if it was to end when they have parted
FAILED, INCOMPLETE = 1, 3  # exit status if impacts failed, and if others were refused or have not run


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
    parser.add_argument(
        "--retry", action="store_true", help="run impacts again that were refused or have failed"
    )
    parser.add_argument(
        "--plot", metavar="OUTPUT", help="draw this column, or this record of all impacts, such as force"
    )
    parser.add_argument(
        "--against",
        nargs="+",
        metavar="INPUT",
        help="over one or two columns, or the colours of records (default: the first one that is varied); abs(INPUT): its "
        "absolute value, or the length of a vector, such as the speed of a velocity",
    )


def check_options(options: argparse.Namespace) -> None:
    if options.against and len(options.against) > 2:
        raise InputError("--against takes one or two columns")
    if options.plot == "" or (options.plot is None and options.against):
        raise InputError("--plot takes the name of a column, and --against goes with --plot")
    if options.plot and (options.kernels or options.part):
        raise InputError("--plot goes with a whole sweep or --collect")
    if options.retry and options.collect:
        raise InputError("--retry runs impacts, and --collect runs none: leave one of them out")


class Drawn:
    """The requested picture: a column over others, or a record. An unknown column is reported after the first
    impact."""

    def __init__(self, study: Study, options: argparse.Namespace) -> None:
        self.inputs = study.keys
        self.names = [options.plot, *(options.against or study.keys[:1])] if options.plot else []
        word = str(options.plot).partition(".")[0]
        self.record = is_record(str(options.plot)) and options.plot not in study.keys
        if self.record:
            self._check_record(study, word)
        self.unknown = set(map(of_magnitude, self.names[self.record :])) - set(self.inputs)
        # If one of these keys is varied, the columns of the summaries differ.
        self.alike = not {"accuracy", "contact.scheme", "contact.kernel"} & set(study.keys)

    def _check_record(self, study: Study, word: str) -> None:
        name, *against = self.names
        if word not in study.keep:
            raise not_kept(study.path, name)
        for key in against:
            if of_magnitude(key) not in study.keys:
                raise InputError(
                    f'--against {key}: is not varied{meant(key, study.keys, "the study varies")}'
                )
        if len(against) > 1:
            raise InputError(f"--plot {name} takes one key --against, for the colours of its lines")

    def check(self, row: Row) -> None:
        if self.unknown and self.alike and row["status"] == 0:
            found = outputs(row["summary"])
            if wrong := sorted(self.unknown - set(found)):
                known = ", ".join([*self.inputs, *found])
                raise InputError(f'"{wrong[0]}" is not a column of this sweep, which has {known}')
            self.unknown = set()

    def draw(self, sweep: Sweep, table: Table) -> Path:
        """Draws the picture and returns its path."""
        name, *against = self.names
        picture = Path(f"{sweep.stem}.{name.replace('/', '_')}.png")
        units = scene_keys.all_units()
        from ricochet.studies import chart, history_chart

        if self.record:
            history_chart.draw(table, sweep.results, name, against[0], picture, units)
        else:
            chart.draw(table.with_values(self.names), name, against, picture, units)
        return picture


def number(amount: int, what: str) -> str:
    return f"{amount} {what}" + "s" * (amount != 1)


def say_groups(sweep: Sweep) -> None:
    groups = sweep.groups
    if groups.names:
        say(
            f"settings for {number(len(groups.names), 'group')} of impacts: errors of {groups.estimated} are "
            f"estimated, of {len(groups.served) - groups.kept} interpolated"
        )


def report_kernels(sweep: Sweep) -> None:
    text = f"{number(len(sweep.kernels.names), 'kernel')}, all computed"
    if refused := sweep.refused:
        text += f"; {len(refused)} of {number(len(sweep.keys), 'impact')} are refused: {refused[min(refused)]['error']}"
    if any("died" in row for row in refused.values()):
        raise SolverError(f"{text}. Some kernels ended without a reason; the same command tries them again.")
    say(text)
    say_groups(sweep)


def report_part(sweep: Sweep, ran: int) -> None:
    keys = [sweep.keys[index] for index in sweep.own()]
    failed = sum(sweep.journal.rows[key]["status"] != 0 for key in keys)
    k, n = sweep.part or (1, 1)
    earlier = " before" if not ran else ""
    say(
        f"part {k}/{n}: {number(len(keys), 'impact')}, all done{earlier}"
        + f", {failed} failed" * bool(failed)
    )


def say_touching(table: Table) -> None:
    """Warns of impacts that end while their bodies touch, and names the duration that suffices for those of
    which it is known."""
    number_of = sum(any(TOUCHING in text for text in texts) for texts in table.warnings)
    if not number_of:
        return
    times = [time for time in table.outputs.get("parted_s", ()) if time > 0]
    key = LONGEST if any(LONGEST in text for texts in table.warnings for text in texts) else "time.duration"
    enough = f"{key} = {rounded_up(max(times)):g} lets {len(times)} of them part" if times else ""
    say(
        f"warning: {number_of} of {number(len(table.status), 'impact')} end while the bodies touch, so their rows have no "
        + "restitution and no exit velocity"
        + f": {enough}" * bool(enough)
    )


def rounded_up(value: float) -> float:
    """Two digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit) * unit


def report(sweep: Sweep, table: Table, drawn: Drawn, ran: int) -> None:
    failed, waiting = table.count(1), table.count(-1)
    without = table.count(2) + failed
    text = total = number(len(table.status), "impact")
    text += f", {waiting} not run yet" if waiting else ""
    text += ", all done before" if ran == 0 and not sweep.collects else ""
    text += f', {without} refused or failed (column "error"; --retry runs them again)' if without else ""
    say(text)
    say_groups(sweep)
    if untouched := sum(value == 0 for value in table.outputs.get("touched", ())):
        say(f'{untouched} of {total} touched nothing (column "touched")')
    say_touching(table)
    say(f"{sweep.results}\n{sweep.stem}.sweep.csv")
    if drawn.names:
        say(drawn.draw(sweep, table))
    if without or waiting:
        raise RicochetError(status=FAILED if failed else INCOMPLETE)


def logged(options: argparse.Namespace) -> contextlib.AbstractContextManager[None]:
    """States time and memory of one of the stages that jobs of a cluster run."""
    jobs = options.jobs or os.cpu_count() or 1
    if options.kernels:
        return stage_log.stage("kernels", max(jobs, options.ranks))
    if options.part:
        return stage_log.stage("impacts {}/{}".format(*options.part), jobs)
    return stage_log.stage("collect", jobs) if options.collect else contextlib.nullcontext()


def run(options: argparse.Namespace) -> None:
    check_options(options)
    study = Study(options.study)
    drawn = Drawn(study, options)
    folder = options.out or options.study.parent / "out"
    with writing(folder), logged(options):
        sweep = Sweep(
            study,
            folder,
            options.jobs,
            options.ranks,
            options.part,
            options.collect,
            options.retry,
            stage_log.phases() if options.kernels else None,
        )
        sweep.prepare()
        if options.kernels:
            report_kernels(sweep)
            return
        if options.part:
            report_part(sweep, sweep.run())
            return
        ran = 0
        try:
            ran = 0 if options.collect else sweep.run(drawn.check)
        finally:
            table = sweep.write()
        report(sweep, table, drawn, ran)
