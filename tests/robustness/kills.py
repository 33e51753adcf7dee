# SPDX-License-Identifier: BSD-2-Clause
"""Kills programs at random moments by SIGKILL, SIGTERM or SIGINT, and checks the files that they leave.

    scripts/verify --kills --count 1000 --lanes 4
    scripts/verify --kills --seed 17.42     # repeats one life, to investigate a failure

No partial file may have a final name, no finished work may be lost or done twice, no program may hang, and
the next run must end as if nothing had happened. A life is a folder in which a program runs and is killed one
to four times, and then runs undisturbed. The status is 1 if a check fails.
"""
import argparse
import collections
import os
import queue
import random
import shutil
import signal
import statistics
import subprocess
import tempfile
import threading
import time
from pathlib import Path

from ricochet import programs
from kill_subjects import Contact, Kernel, Ranks, Sweep, leftovers, write_scenes

HANG_S = 60
WEIGHTS = {"ricochet-kernel": 3, "mpirun -n 2 ricochet-kernel": 2, "ricochet-contact": 6, "sweep": 2}
SIGNALS = (signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
AMISS = ("lost", "partial", "left", "status", "hung", "unfinished")


def members(session):
    """Running processes of a session; its first process comes first."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, its = entry.read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        if int(its) == session and state != "Z":
            found.append(int(entry.parent.name))
    return sorted(found, key=lambda one: (one != session, one))


def send(number, process):
    try:
        os.kill(process, number)
    except ProcessLookupError:
        pass


class Paces:
    """Duration of a run of each program: the median of the last undisturbed runs."""

    def __init__(self):
        self.seconds = collections.defaultdict(lambda: collections.deque(maxlen=7))

    def add(self, name, seconds):
        self.seconds[name].append(seconds)

    def of(self, name):
        return statistics.median(self.seconds[name])


class Life:
    def __init__(self, subject, seed, folder, paces):
        self.subject, self.seed, self.paces = subject, seed, paces
        self.random = random.Random(seed)
        self.out = folder / "out"
        self.said = folder / "said"
        self.kills = []  # (phase, signal, faults)

    def start(self):
        with open(self.said, "w") as said:
            return subprocess.Popen(
                [str(word) for word in self.subject.command(self.out)],
                env=self.subject.environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=said,
                start_new_session=True,
            )

    def ends(self, process):
        """Waits for all processes of a run. Returns whether they end by themselves."""
        try:
            process.wait(timeout=HANG_S)
        except subprocess.TimeoutExpired:
            pass
        limit = time.monotonic() + HANG_S
        while (alive := members(process.pid)) and time.monotonic() < limit:
            time.sleep(0.02)
        for one in alive:
            send(signal.SIGKILL, one)
        process.wait()
        return not alive

    def amiss(self, before):
        """Faults after any run: lost and partial files."""
        return {"lost": self.subject.lost(before, self.out), "partial": self.subject.spoilt(self.out)}

    def run_and_kill(self):
        """Runs and kills the program. Returns whether it was killed: it may have ended before."""
        before, remains = self.subject.finished(self.out), set(leftovers(self.out))
        moment = self.random.random() * self.paces.of(self.subject.name)
        number, victim = self.random.choice(SIGNALS), self.random.choice(self.subject.victims)
        process = self.start()
        try:
            process.wait(timeout=moment)
            return False
        except subprocess.TimeoutExpired:
            pass
        running = members(process.pid)
        if victim == "one":
            running = [self.random.choice(running[1:])] if len(running) > 1 else running
        elif victim == "first":
            running = [process.pid]
        phase = self.subject.phase(self.out, self.said.read_text())
        for one in running:
            send(number, one)
        found = {"hung": [] if self.ends(process) else [f"for {HANG_S} s"]}
        found |= self.amiss(before)
        if (
            number != signal.SIGKILL and victim != "one"
        ):  # a file left by an earlier run is removed when its target is written again
            found["left"] = self.subject.outlived(remains, self.out)
        # A process that dies may be replaced, and the run may end at this
        # moment. mpirun has its own statuses.
        usual = {0, -number, 128 + number}
        if number == signal.SIGINT and "KeyboardInterrupt" in self.said.read_text():
            usual.add(1)  # from Python itself if it has not read the script yet
        if victim != "one" and process.returncode not in usual and self.subject.name[:6] != "mpirun":
            found["status"] = [f"{process.returncode}: {self.said.read_text()[-300:]}"]
        self.kills.append((phase, f"{number.name} to {victim}", found))
        return True

    def finish(self):
        """Runs the program undisturbed and checks its result."""
        before = self.subject.finished(self.out)
        started = time.monotonic()
        process = self.start()
        found = {"hung": [] if self.ends(process) else [f"for {HANG_S} s"]} | self.amiss(before)
        found["unfinished"] = [f"status {process.returncode}: {self.said.read_text()[-300:]}"] * (
            process.returncode != 0
        )
        if process.returncode == 0:
            found["unfinished"] = self.subject.complete(self.out)
            found["left"] = leftovers(self.out)
            if not before:
                self.paces.add(self.subject.name, time.monotonic() - started)
        self.kills.append(("left alone", "", found))

    def live(self, kills):
        self.subject.prepare(self.out, self.random)
        for _ in range(kills):
            if not self.run_and_kill():
                break
        self.finish()


def undisturbed(subject, out, paces, times=1):
    for _ in range(times):
        shutil.rmtree(out, ignore_errors=True)
        subject.prepare(out, random.Random(1))
        started = time.monotonic()
        subprocess.run(
            [str(word) for word in subject.command(out)],
            env=subject.environment,
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        paces.add(subject.name, time.monotonic() - started)


def references(folder, names, paces):
    """The subjects of these names, each with the files of an undisturbed run."""
    write_scenes(folder)
    kernel = Kernel(folder, folder / "kernels")
    undisturbed(kernel, kernel.whole, paces)
    subjects = [kernel]
    if Ranks.name in names:
        subjects.append(Ranks(folder, kernel.whole))
        undisturbed(subjects[-1], folder / "ranks", paces)
    if Contact.name in names:
        subjects.append(contact_of(folder, kernel))
        undisturbed(subjects[-1], folder / "impacts", paces, 3)
    if Sweep.name in names:
        subjects.append(Sweep(folder, folder / "sweep"))
        undisturbed(subjects[-1], subjects[-1].whole, paces)
    return [subject for subject in subjects if subject.name in names]


def contact_of(folder, kernel):
    earlier, impact = folder / "earlier", folder / "impact"
    for out, setting in ((earlier, "bodies.moving.velocity=[0.02,0,0]"), (impact, "title=Kills")):
        shutil.copytree(kernel.whole, out)
        subprocess.run(
            [
                programs.BIN / "ricochet-contact",
                folder / "kills.toml",
                "--out",
                out,
                "--quiet",
                "--set",
                setting,
            ],
            check=True,
            stderr=subprocess.DEVNULL,
        )
    return Contact(folder, impact, earlier)


def life_of(seed, subjects, folder, paces):
    """@param seed  N.K: the K-th life of a run with seed N"""
    chance = random.Random(f"choice {seed}")
    subject = chance.choices(subjects, [WEIGHTS[subject.name] for subject in subjects])[0]
    place = folder / f"life-{seed}"
    place.mkdir()
    life = Life(subject, seed, place, paces)
    life.live(chance.randint(1, 4))
    if not any(any(found.values()) for _, _, found in life.kills):
        shutil.rmtree(place)
    return life


class Tally:
    def __init__(self):
        self.rows = collections.defaultdict(collections.Counter)
        self.kills = self.failures = 0

    def add(self, life):
        for phase, how, found in life.kills:
            row = self.rows[life.subject.name, phase]
            row["runs"] += 1
            self.kills += bool(how)
            for what, where in found.items():
                if where:
                    row[what] += 1
                    self.failures += 1
                    print(
                        f"life {life.seed}: {life.subject.name}, {phase} {how}: {what}: {', '.join(where)}",
                        flush=True,
                    )

    def table(self):
        head = ["program", "phase", "runs", *AMISS]
        yield "| " + " | ".join(head) + " |"
        yield "|" + "---|" * len(head)
        for name, phase in sorted(self.rows):
            row = self.rows[name, phase]
            yield f"| {name} | {phase} | {row['runs']} | " + " | ".join(
                str(row[what]) for what in AMISS
            ) + " |"


def positive(text):
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError("give a number from 1")
    return int(text)


def add_arguments(parser):
    parser.add_argument("--count", type=positive, default=100, help="kills (default: 100)")
    parser.add_argument("--seed", default="1", help="seed of a run, or N.K of one life of it (default: 1)")
    parser.add_argument("--lanes", type=positive, default=1, help="lives side by side (default: 1)")
    parser.add_argument("--only", choices=WEIGHTS, action="append", help="this program; repeatable")


def run(options):
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # if SIGINT were ignored here, the programs would ignore it too
    folder = Path(tempfile.mkdtemp(prefix="ricochet-kills-"))
    paces, tally, lives, started = Paces(), Tally(), queue.Queue(), time.monotonic()
    subjects = references(folder, options.only or list(WEIGHTS), paces)
    print(
        ", ".join(f"{subject.name} {paces.of(subject.name):.2f} s" for subject in subjects) + " undisturbed",
        flush=True,
    )
    single = "." in options.seed
    enough, numbers = threading.Event(), iter(range(1 if single else 10**9))

    def lane():
        try:
            while not enough.is_set() and (number := next(numbers, None)) is not None:
                lives.put(
                    life_of(options.seed if single else f"{options.seed}.{number}", subjects, folder, paces)
                )
        finally:
            lives.put(None)

    for _ in range(1 if single else options.lanes):
        threading.Thread(target=lane, daemon=True).start()
    running = 1 if single else options.lanes
    while running:
        life = lives.get()
        if life is None:
            running -= 1
            continue
        before = tally.kills
        tally.add(life)
        if tally.kills >= options.count:
            enough.set()
        if tally.kills // 100 > before // 100:
            print(
                f"{tally.kills} kills in {time.monotonic() - started:.0f} s, {tally.failures} amiss",
                flush=True,
            )
    print("\n".join(tally.table()))
    seconds = time.monotonic() - started
    print(f"{tally.kills} kills, {tally.failures} amiss, {seconds:.0f} s, seed {options.seed}")
    if tally.failures:
        print(f"what they left is in {folder}")
    else:
        shutil.rmtree(folder)
    return 1 if tally.failures else 0
