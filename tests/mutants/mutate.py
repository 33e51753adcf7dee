# SPDX-License-Identifier: BSD-2-Clause
"""Changes one place of the source at a time, at random or as written by hand, and finds whether a test fails.

    scripts/mutants                              # 15 mutants of each folder
    scripts/mutants contact modes --count 30     # of these folders
    scripts/mutants kernels --list               # only lists what would be drawn
    scripts/mutants --file src/reduction/lift.cpp    # only from this file
    scripts/mutants --errors                     # deliberate errors in each contact law and scheme
    scripts/mutants --errors friction blocks     # in these laws and schemes
    scripts/mutants --errors --manual            # all; also writes docs/validation/errors.md

A mutant is killed if a test fails, crashes or takes too long. One that does not compile is replaced by the next of
the draw. Mutants are built and tested in a copy of the tree in build-mutants/. A run that was stopped goes on where
it was. Survivors are listed with their reasons in tests/mutants/survivors.toml; one without an entry is shown with
its surroundings, and needs a test or an entry. The status is 1 if there is such a survivor.

Deliberate errors are sites written by hand in tests/mutants/deliberate_errors.toml. Cases of the validation manual judge them; each must
have a line that fails, and the report shows these lines (scripts/build first).
"""
import argparse
import itertools
import os
import signal
import subprocess
import sys
from pathlib import Path

from copy_tree import fingerprint, synchronise
from folders import FOLDERS
from judge import KILLED, SURVIVED, UNCOMPILED, Judge
from mutant import draw
from record import Reasons, Record
from ricochet.progress import Progress
import written_sites

ROOT = Path(__file__).resolve().parents[2]
REASONS = ROOT / "tests" / "mutants" / "survivors.toml"
PAGE = ROOT / "docs" / "validation" / "errors.md"


def configure(tree, build, options):
    # Libraries compile each file by itself; tests do not (apart.cmake).
    apart = tree / "tests" / "mutants" / "apart.cmake"
    fixed = [f"-DCMAKE_PROJECT_Ricochet_INCLUDE={apart}", "-DRICOCHET_TESTS=ON", "-DRICOCHET_EXAMPLES=OFF"]
    command = ["cmake", "-S", tree, "-B", build, "-G", "Ninja", *fixed, *options]
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL)


def drawn(folder, seed, files):
    """The mutants of a folder in the order of the draw."""
    sources = (path for path in FOLDERS[folder].sources(ROOT) if not files or path in files)
    sites = (
        site
        for path in sources
        for site in FOLDERS[folder].find(str(path.relative_to(ROOT)), path.read_text())
    )
    return draw(folder, sites, seed)


class Session:
    """Finds verdicts: recorded ones, and new ones by a judge, up to `new` of them (None: all)."""

    def __init__(self, record, judge, new):
        self.record, self.judge, self.new = record, judge, new

    def verdict(self, mutant):
        """The verdict about a mutant, or None if no more may be judged."""
        if (known := self.record.find(mutant)) or self.new == 0:
            return known
        self.new = self.new and self.new - 1
        verdict = self.judge.judge(mutant)
        self.record.add(mutant, verdict)
        return verdict

    def results(self, mutants, count, progress):
        """Pairs of mutant and verdict for the first `count` mutants that compile."""
        found = []
        for mutant in mutants:
            if len(found) == count:
                break
            already = self.record.find(mutant) is not None
            verdict = self.verdict(mutant)
            if verdict is None:
                continue
            if verdict.kind != UNCOMPILED:
                found.append((mutant, verdict))
                progress.advance(f"{mutant.name} {verdict.kind}", already=already)
        return found


def table(results, reasons):
    """The results of each folder as lines of a table in Markdown."""
    yield "| folder | drawn | killed | equivalent | other survivors | killed of those not equivalent |"
    yield "|---|---|---|---|---|---|"
    for folder, found in results.items():
        killed = sum(verdict.kind == KILLED for _, verdict in found)
        known = [reasons.find(mutant) for mutant, verdict in found if verdict.kind == SURVIVED]
        equal = sum(bool(reason and reason["equivalent"]) for reason in known)
        share = f"{100 * killed / (len(found) - equal):.0f} %" if len(found) > equal else "–"
        yield f"| {folder} | {len(found)} | {killed} | {equal} | {len(known) - equal} | {share} |"


def surviving(results):
    return [mutant for found in results.values() for mutant, verdict in found if verdict.kind == SURVIVED]


def report(results, reasons):
    """Prints the table and the survivors. Returns the number of those without a reason."""
    print(*table(results, reasons), "", sep="\n")
    unknown = []
    for mutant in surviving(results):
        site = mutant.site
        if reason := reasons.find(mutant):
            kind = "equivalent: " if reason["equivalent"] else ""
            print(f"- `{site.file}`: `{site.before}` → `{site.after}`: {kind}{reason['reason']}")
        else:
            unknown.append(mutant)
    for mutant in unknown:
        print(f"\nSurvives without a reason: {mutant}\n{mutant.site.context()}")
    return len(unknown)


def parse(written):
    parser = argparse.ArgumentParser(
        prog="mutants", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("names", nargs="*", metavar="FOLDER", help=f"of {', '.join(FOLDERS)}; all if none is given")
    add("--errors", action="store_true", help=f"deliberate errors in schemes: {', '.join(written.schemes)}")
    add("--manual", action="store_true", help="write docs/validation/errors.md; needs --errors and no names")
    add("--count", type=int, default=15, help="mutants of each folder (default 15)")
    add("--seed", type=int, default=1, help="another seed draws other mutants (default 1)")
    add("--file", action="append", default=[], help="draw only from this file; may be repeated")
    add("--list", action="store_true", help="list what would be drawn; build nothing")
    add("--report", action="store_true", help="print the results so far; build nothing")
    add("--new", type=int, metavar="N", help="stop after N mutants that had no verdict")
    add("--jobs", type=int, default=os.cpu_count(), help="jobs of the build (default: all cores)")
    add("--build", type=Path, default=ROOT / "build-mutants", help="folder (default build-mutants)")
    add("--cmake", action="append", default=[], metavar="OPTION", help="option of CMake: --cmake=-DX=Y")
    arguments = parser.parse_args()
    known = written.schemes if arguments.errors else FOLDERS
    for name in arguments.names:
        if name not in known:
            parser.error(
                f"{name}: no such {'scheme' if arguments.errors else 'folder'}: give {', '.join(known)}"
            )
    if arguments.manual and (arguments.names or not arguments.errors):
        parser.error("--manual: the page contains every error. Give --errors and no names.")
    return arguments


def main():
    written = written_sites.read(ROOT)
    arguments = parse(written)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # else tests inherit that a shell ignores it
    if arguments.errors:
        chosen = arguments.names or written.schemes
        mutants = {name: [error for error in written.errors if error.folder == name] for name in chosen}
        count = len(written.errors)
    else:
        files, count = [Path(name).resolve() for name in arguments.file], arguments.count
        mutants = {name: drawn(name, arguments.seed, files) for name in arguments.names or FOLDERS}
    if arguments.list:
        print(*itertools.chain.from_iterable(found[:count] for found in mutants.values()), sep="\n")
        return 0
    folder = arguments.build.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    tree, build = folder / "tree", folder / "build"
    if not arguments.report:
        synchronise(ROOT, tree)
        configure(tree, build, arguments.cmake)
    if arguments.errors:
        import manual_judge  # needs the package with its programs

        judge = record = manual_judge.ManualJudge(folder, arguments.jobs)
    else:
        record = Record(folder / "record.json", fingerprint(ROOT, ["tests/"]))
        judge = Judge(tree, build, arguments.jobs, record.usual_s)
    session = Session(record, judge, 0 if arguments.report else arguments.new)
    progress = Progress(sum(min(count, len(found)) for found in mutants.values()))
    results = {name: session.results(found, count, progress) for name, found in mutants.items()}
    if arguments.errors:
        for _, verdict in itertools.chain.from_iterable(results.values()):
            print(verdict.by)
        if arguments.manual:
            judge.write_page(PAGE, written)
    return min(1, report(results, Reasons(REASONS)))


if __name__ == "__main__":
    sys.exit(main())
