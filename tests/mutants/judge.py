# SPDX-License-Identifier: BSD-2-Clause
"""Builds a copy of the tree with one mutant after another, and runs the tests that reach it."""
import ast
import os
import re
import signal
import subprocess
import threading
import time
from typing import NamedTuple

from folders import FOLDERS, targets

KILLED, SURVIVED, UNCOMPILED = "killed", "survived", "uncompiled"
# A test of googletest fails. The run ends here, because ranks of a collective test may now wait for each other.
FAILURE = re.compile(r"^(?:\d+: )?(?:\S+:\d+|unknown file): Failure$")
COMPILER = re.compile(r": (?:fatal )?error: |undefined reference to|FAILED: \S+\.o$", re.MULTILINE)
SLOWER, GRACE_S = 4, 30  # a test may take SLOWER times its usual duration, and GRACE_S more
UNKNOWN_S = 150  # the usual duration of a test that has not yet been measured


class Run(NamedTuple):
    """How a command ended."""

    passed: bool
    late: bool
    output: str
    seconds: float


def _end(process):
    """Ends a process and what it started. mpirun ends its ranks if it is asked to."""
    for number, wait_s in ((signal.SIGTERM, 5), (signal.SIGKILL, None)):
        try:
            os.killpg(process.pid, number)
            process.wait(wait_s)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            pass


def run(command, folder, limit_s=None, stop=None):
    """Runs a command until it ends, prints a line that `stop` matches, or takes too long."""
    started, lines, late, stopped = time.monotonic(), [], threading.Event(), False
    process = subprocess.Popen(
        [str(word) for word in command],
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    timer = threading.Timer(limit_s or threading.TIMEOUT_MAX, lambda: (late.set(), _end(process)))
    timer.daemon = True
    timer.start()
    try:
        for line in process.stdout:
            lines.append(line)
            if stopped := bool(stop and stop.search(line)):
                break
        else:
            process.wait()
    finally:
        timer.cancel()
        if process.poll() is None:
            _end(process)
        process.stdout.close()
    passed = process.returncode == 0 and not stopped and not late.is_set()
    return Run(passed, late.is_set(), "".join(lines), time.monotonic() - started)


class Verdict(NamedTuple):
    """What became of a mutant, and the test and its words that killed it."""

    kind: str
    by: str = ""


class Judge:
    """Judges mutants in a copy of the tree.

    @param tree  the copy, whose files are mutated and restored
    @param build  its build folder
    @param usual_s  duration of each test [s] that is known to pass without a mutant; judging adds to it"""

    def __init__(self, tree, build, jobs, usual_s):
        self.tree, self.build, self.jobs, self.usual_s = tree, build, jobs, usual_s

    def compile(self, names):
        return run(["ninja", "-C", self.build, "-j", self.jobs, *names], self.tree)

    def test(self, name):
        limit_s = GRACE_S + SLOWER * self.usual_s.get(name, UNKNOWN_S)
        if name.startswith("test_"):
            return run([self.build / "bin" / name, "--gtest_brief=1"], self.build, limit_s, FAILURE)
        command = ["ctest", "-V", "--no-tests=error", "-R", f"^{re.escape(name)}$"]
        return run(command, self.build, limit_s, FAILURE)

    def check(self, name):
        """Ends the program if a test fails without a mutant."""
        built = self.compile(targets(name))
        result = self.test(name) if built.passed else built
        if not result.passed:
            raise SystemExit(f"mutants: {name} fails without a mutant:\n{result.output[-3000:]}")
        self.usual_s[name] = result.seconds

    def judge(self, mutant):
        """The verdict about a mutant. The tests of its folder run until one fails. A test that has not yet failed
        before must then pass without the mutant, if it is named."""
        source, text = self.tree / mutant.site.file, mutant.site.mutated
        if source.suffix == ".py" and (mistake := syntax_error(text)):
            return Verdict(UNCOMPILED, mistake)
        source.write_text(text)
        try:
            verdict, name = self._tested(mutant)
        finally:
            source.write_text(mutant.site.text)
        if verdict.kind == KILLED and name and name not in self.usual_s:
            self.check(name)
        return verdict

    def _tested(self, mutant):
        for name in FOLDERS[mutant.folder].order(mutant.site.file):
            # A module is not compiled, but its tests run programs, which may not be there yet.
            if not mutant.site.file.endswith(".py") or name not in self.usual_s:
                built = self.compile(targets(name))
                if not built.passed and COMPILER.search(built.output):
                    return Verdict(UNCOMPILED, last_words(built.output)), name
                if not built.passed:  # it crashes when it is asked for its tests
                    return Verdict(KILLED, f"{name} cannot start"), name
            done = self.test(name)
            if not done.passed:
                what = "takes too long" if done.late else last_words(done.output)
                return Verdict(KILLED, f"{name}: {what}"), name
        return Verdict(SURVIVED), None


def syntax_error(text):
    """What is wrong with a Python source, or None."""
    try:
        ast.parse(text)
    except SyntaxError as error:
        return str(error)
    return None


def last_words(output):
    """The line of an output that says what failed, or the last one."""
    for line in output.splitlines():
        if FAILURE.search(line) or re.search(
            r"(^|: )(FAIL|ERROR): |: error: |\*\*\*(Exception|Failed|Timeout)|signal \d+", line
        ):
            return line.strip()[:200]
    return next((line.strip()[:200] for line in reversed(output.splitlines()) if line.strip()), "no output")
