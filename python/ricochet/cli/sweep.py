# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study: a scene over values of its keys, kernels shared, impacts side by side.

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

All settings are checked before anything is computed. Killed at any moment and started again, it goes on where it was.
Results: <title>.sweep.h5 and <title>.sweep.csv in out/ beside the study. ricochet batch runs a study on a cluster.
"""
import signal

if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # till all is loaded: numpy makes an error of its own of an interruption

import argparse
import contextlib
import hashlib
import json
import os
import re
import sys
import time
import tomllib
from pathlib import Path

from ricochet import programs
from ricochet import scene_keys
from ricochet.cli.command_line import Parser, ranks, say, told
from ricochet.progress import Progress
from ricochet.result_file import BadInput
from ricochet.studies.kernels import Kernels
from ricochet.studies.pictures import draw
from ricochet.studies.results import Journal, Table, outputs
from ricochet.studies.study import Study

SYNC_S = 2.0


def scene_of(study):
    """What a scene says, but for comments and layout; where it is no TOML, ricochet-contact tells."""
    try:
        return tomllib.loads(study.text)
    except (ValueError, RecursionError):
        return study.text


def check(study, kernels, journal):
    """Asks for the kernels of each setting. Returns refusals by index; what identifies each impact: program, scene, setting
    and kernels; and by index the kernels that an impact still to be run misses (or that hold too few points)."""
    scene, version = [scene_of(study), study.fixed], programs.version()
    refused, keys, missing, bar = {}, [None] * len(study.settings), {}, Progress(len(study.settings))
    requests = ({"set": programs.settings(setting), "kernels": True} for setting in study.settings)
    for index, line in kernels.ask(requests):
        answer = json.loads(line)
        bar.advance("checking")
        if answer["status"] != 0:
            refused[index] = answer
            continue
        files = [kernel["file"] for kernel in answer["kernels"]]
        kernels.names.update(files)
        identity = json.dumps([version, scene, study.settings[index], files, answer["reads"]], sort_keys=True, default=str)
        keys[index] = hashlib.sha256(identity.encode()).hexdigest()[:24]
        lacking = [kernel["file"] for kernel in answer["kernels"] if not kernel["there"]]
        if lacking and not journal.finished(keys[index]):
            missing[index] = lacking
    return refused, keys, missing


def prepare(study, options, kernels, journal):
    """Refusals and keys as of `check`, with all kernels there that this stage needs and that can be computed."""
    folder, before = kernels.folder, None
    while True:
        refused, keys, missing = check(study, kernels, journal)
        if options.part or options.collect:  # what --kernels could not compute
            kernels.refused = {index: journal.rows[keys[index]] for index in missing if keys[index] in journal.rows}
        refused |= kernels.refused
        if len(refused) == len(keys):
            raise programs.Failed(refused[0]["status"], refused[0]["error"])
        missing = {index: files for index, files in missing.items() if index not in refused}
        if not missing or options.collect:
            return refused, keys
        name = min(missing.values())[0]
        if options.part:
            raise BadInput(f"{folder}: {len(missing)} settings miss kernels, {name} for one: run ricochet sweep --kernels")
        if missing == before:
            raise BadInput(f"{folder}: ricochet-kernel does not leave {name} there: compute it by hand")
        kernels.compute(missing)  # one that holds some points may not yet be enough for all settings
        for index, answer in kernels.refused.items():
            journal.add(keys[index], json.dumps(answer).encode())
        before = missing


def part(text):
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not 1 <= int(found[1]) <= int(found[2]):
        raise argparse.ArgumentTypeError("give K/N with K from 1 to N")
    return int(found[1]), int(found[2])


def arguments():
    parser = Parser(__doc__, "STUDY.toml")
    parser.add_argument("study", type=Path, metavar="STUDY.toml")
    parser.add_argument("--out", type=Path, help="folder of kernels and results (default: out/ beside the study)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="impacts side by side (default: all cores)")
    parser.add_argument("--ranks", type=ranks, default=2, help="of ricochet-kernel (default: 2)")
    stage = parser.add_mutually_exclusive_group()
    stage.add_argument("--kernels", action="store_true", help="compute the kernels, and stop")
    stage.add_argument("--part", type=part, metavar="K/N",
                       help="run the K-th of N parts of the impacts, beside other parts, with kernels that are there")
    stage.add_argument("--collect", action="store_true", help="write the results of what is finished, and stop")
    parser.add_argument("--plot", metavar="OUTPUT", help="draw this column")
    parser.add_argument("--against", nargs="+", metavar="INPUT", help="over one or two columns (default: the first one varied)")
    options = parser.parse_args()
    if options.jobs < 1 or (options.against and len(options.against) > 2):
        parser.error("--jobs must be 1 or more, --against takes one or two columns")
    if options.plot == "" or (options.plot is None and options.against) or (options.plot and (options.kernels or options.part)):
        parser.error("--plot takes the name of a column, --against goes with --plot, and both with a whole sweep or --collect")
    return options


class Drawn:
    """The columns of the picture that is asked for, refused as soon as it is known that there is none of that name."""

    def __init__(self, study, options):
        self.inputs, self.names = study.keys, [options.plot, *(options.against or study.keys[:1])] if options.plot else []
        self.unknown = set(self.names) - set(self.inputs)
        self.alike = not {"accuracy", "contact.scheme", "contact.kernel"} & set(study.keys)  # or summaries differ in columns

    def check(self, row):
        """`row`: of an impact."""
        if self.unknown and self.alike and row["status"] == 0:
            found = outputs(row["summary"])
            if wrong := sorted(self.unknown - set(found)):
                raise BadInput(f"\"{wrong[0]}\" is no column of this sweep: it has {', '.join([*self.inputs, *found])}")
            self.unknown = set()


def run(study, kernels, journal, keys, left, drawn):
    """Runs the settings `left`, indices."""
    bar, synced = Progress(len(keys)), time.monotonic()
    bar.advance("impacts", len(keys) - len(left), already=True)
    for key in keys:
        if key in journal.rows:
            drawn.check(journal.rows[key])
    with contextlib.closing(kernels.ask({"set": programs.settings(study.settings[k])} for k in left)) as answers:
        for index, line in answers:
            key = keys[left[index]]
            journal.add(key, line)
            drawn.check(journal.rows[key])
            bar.advance("impacts")
            if time.monotonic() - synced > SYNC_S:
                journal.sync()
                synced = time.monotonic()
    journal.sync()


def write_tables(study, refused, journal, keys, stem):
    table = Table(study, [refused.get(k) or journal.rows.get(key) for k, key in enumerate(keys)])
    table.write_csv(Path(f"{stem}.sweep.csv"))
    table.write_hdf5(Path(f"{stem}.sweep.h5"))
    return table


def number(count, what):
    return f"{count} {what}" + "s" * (count != 1)


def report_kernels(names, refused, settings):
    say(number(len(names), "kernel") + ", all there" +
        (f"; {len(refused)} of {number(settings, 'impact')} are refused, as {refused[min(refused)]['error']}" if refused else ""))


def report_part(part, journal, keys, ran):
    failed = sum(journal.rows[key]["status"] != 0 for key in keys)
    say(f"part {part[0]}/{part[1]}: {number(len(keys), 'impact')}, all done" + " before" * (not ran) + f", {failed} failed" * bool(failed))


def report(options, drawn, table, stem, ran):
    failed = sum(status > 0 for status in table.status)
    waiting = sum(status < 0 for status in table.status)
    say(number(len(table.status), "impact") + (f", {waiting} not run yet" if waiting else "") + ", all done before" * (ran == 0) +
          (f", {failed} refused or failed (column \"error\")" if failed else ""))
    say(f"{stem}.sweep.h5\n{stem}.sweep.csv")
    if options.plot:
        picture = Path(f"{stem}.{options.plot}.png")
        keys = programs.call([programs.BIN / "ricochet-contact", "--keys"], capture=True)
        draw(table.with_values(drawn.names), options.plot, drawn.names[1:], picture, scene_keys.units(keys))
        say(picture)


class Ended(BaseException):
    """Told to by a signal."""


def end(number, _):
    raise Ended(number)


def main():
    options = arguments()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)
    try:
        study = Study(options.study)
        folder = options.out or options.study.parent / "out"
        stem = folder / study.slug
        journal = Journal(stem, options.part, reads_only=options.collect)
        kernels, drawn = Kernels(study, options, folder), Drawn(study, options)
        refused, keys = prepare(study, options, kernels, journal)
        if options.kernels:
            report_kernels(kernels.names, refused, len(keys))
            return 0
        k, n = options.part or (1, 1)
        own = [index for index in range(k - 1, len(keys), n) if index not in refused]
        left = [index for index in own if not journal.finished(keys[index])]
        if options.part:
            run(study, kernels, journal, keys, left, drawn)
            report_part(options.part, journal, [keys[index] for index in own], len(left))
            return 0
        try:
            if not options.collect:
                run(study, kernels, journal, keys, left, drawn)
        finally:
            table = write_tables(study, refused, journal, keys, stem)
        report(options, drawn, table, stem, None if options.collect else len(left))
    except BadInput as problem:
        print(f"sweep: {told(problem)}", file=sys.stderr)
        return 2
    except programs.Failed as failure:
        if failure.error:
            print(f"sweep: {told(failure.error)}", file=sys.stderr)
        return failure.status
    except OSError as problem:
        print(f"sweep: {told(problem.filename or folder)}: {problem.strerror or problem}: is the disk full, or the folder read-only? "
              "Choose another --out", file=sys.stderr)
        return 2
    except Ended as signalled:
        print("sweep: interrupted; the same command goes on from here", file=sys.stderr)
        return 128 + signalled.args[0]
    return 0
