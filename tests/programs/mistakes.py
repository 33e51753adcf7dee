# SPDX-License-Identifier: BSD-2-Clause
"""Every mistake in mistakes.toml gets one line with place, value and remedy, and no file is lost.

    mistakes.py --manual    # writes the mistakes and answers in docs/messages.md
"""

import concurrent.futures
import os
import re
import shlex
import sys
import unittest

import ricochet
from mistakes_table import BYTES, FILES, SCENE, TABLE, sections
from programs import BIN, SOURCE, Command, Forked, ProgramTest, Run, settings

PAGE = SOURCE / "docs" / "messages.md"
SCENES = SOURCE / "tests" / "scene" / "scenes"
LONGEST = 250  # characters
# Words of languages and libraries that a user need not know.
INTERNAL = re.compile(r"Traceback|Errno|std::|terminate|exception|\.cpp|\.py\b|0x[0-9a-f]{6}|MPI_|errno")
PROGRESS = re.compile(r" \d[\d.]* s +\d+ MiB")  # the end of a phase
ENVIRONMENT = {
    name: value for name, value in os.environ.items() if not name.startswith(("RICOCHET", "OMPI", "PYTHON"))
} | {"PATH": f"{BIN}:/usr/bin:/bin", "LC_ALL": "C.UTF-8"}
TITLE = "## Mistakes and answers\n"
HEAD = f"""{TITLE}
`tests/programs/mistakes.py` makes each of these mistakes, checks the answer, and writes this part of the page. In the tables,
`wrong.toml` is a scene of two rods in which the example replaces the right text.

Some answers come from other programs. In zsh, brackets without quotes give `no matches found`: quote values with brackets,
as in `--set 'bodies.ball.velocity=[0,0,-1]'`. If you start `mpirun` yourself, Open MPI refuses to work as root, or with more
ranks than cores, and prints a paragraph; `ricochet kernel -n 4` starts it with the options that it needs. Errors of a
launcher that `RICOCHET_LAUNCHER` names are printed unchanged.
"""


def write_files(folder):
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    for name, content in BYTES.items():
        (folder / name).write_bytes(content)


def run(command, folder, variables=()):
    return Run(["sh", "-c", command], cwd=folder, env=ENVIRONMENT | dict(variables))


def made(mistake, folder, number):
    """Makes the mistake and returns what the command printed. The shell runs only what forked(mistake) does not."""
    command = mistake.command
    if mistake.change:
        if mistake.change[0] not in SCENE:
            raise ValueError(f"{mistake.change[0]} is not in the scene")
        name = f"wrong{number}.toml"
        (folder / name).write_text(SCENE.replace(*mistake.change, 1))
        command = command.replace("wrong.toml", name)
    if forked(mistake):
        done = Forked(*shlex.split(command)[1:], folder=folder)
    else:
        done = run(command, folder, mistake.env)
    lines = re.sub(r"wrong\d+\.toml", "wrong.toml", done.err).splitlines()
    done.err = "\n".join(line for line in lines if not PROGRESS.search(line))
    return done


def forked(mistake):
    """Whether the mistake needs no shell and no environment of its own, so that a fork of this process makes it."""
    return (
        mistake.command.startswith("ricochet ") and not mistake.env and not re.search("[*>]", mistake.command)
    )


def read(mistake, folder, number):
    """What the reader of the package says about the scene of a mistake; empty if it accepts the scene."""
    try:
        ricochet.Scene(folder / f"wrong{number}.toml")
    except ricochet.InputError as refusal:
        return re.sub(r"wrong\d+\.toml", "wrong.toml", str(refusal))
    return ""


class Mistakes(ProgramTest):
    def setUp(self):
        pass  # all tests look into the folder of the class

    @classmethod
    def setUpClass(cls):
        cls.folder = cls.shared_folder()
        write_files(cls.folder)
        first = run(
            "ricochet kernel -n 1 --quiet scene.toml && ricochet impact --quiet scene.toml", cls.folder
        )
        if first.status:
            raise AssertionError(first.err)
        before = {path: path.read_bytes() for path in cls.folder.rglob("*") if path.is_file()}
        mistakes = [mistake for section in sections().values() for mistake in section]
        numbers = range(len(mistakes))
        answers = {k: made(mistakes[k], cls.folder, k) for k in numbers if forked(mistakes[k])}
        others = [k for k in numbers if k not in answers]
        with concurrent.futures.ThreadPoolExecutor(3) as pool:
            answers |= zip(others, pool.map(lambda k: made(mistakes[k], cls.folder, k), others))
        cls.answers = [(mistakes[k], answers[k]) for k in numbers]
        cls.lost = [path.name for path, content in before.items() if path.read_bytes() != content]
        cls.left = [path.name for path in cls.folder.rglob("*.partial")]

    def test_each_is_answered_in_one_line_with_place_value_and_remedy(self):
        for mistake, done in self.answers:
            with self.subTest(mistake.what, command=mistake.command, change=mistake.change):
                self.assertEqual(done.status, mistake.status, done.err)
                lines = done.err.splitlines()
                self.assertEqual(len(lines), 1, done.err)
                self.assertRegex(lines[0], mistake.answer)
                self.assertLessEqual(len(lines[0]), LONGEST, lines[0])
                self.assertNotRegex(lines[0], INTERNAL)

    def test_the_reader_says_what_the_command_says(self):
        compared = 0
        for number, (mistake, done) in enumerate(self.answers):
            if mistake.reader and mistake.change and mistake.command.startswith("ricochet impact wrong.toml"):
                with self.subTest(mistake.what, change=mistake.change):
                    line = read(mistake, self.folder, number).replace(f"{self.folder}/", "")
                    self.assertEqual(f"ricochet-contact: {line}", done.err)
                    compared += 1
        self.assertGreater(compared, 30)

    def test_the_command_says_what_the_reader_says(self):
        (self.folder / "push.csv").write_text("0, 1\n")
        for group in TABLE["refusals"]:
            old, new, line, *sets = group["lines"][0]
            text = (SCENES / f"{group['of']}.toml").read_text() if group["of"] != "nothing" else ""
            (self.folder / "refused.toml").write_text(text.replace(old, new, 1) if old else text + new)
            done = Forked("impact", "refused.toml", *settings(sets), folder=self.folder)
            line = line.replace("scene.toml", "refused.toml")
            place = "" if line.startswith(("refused.toml:", "--set")) else "refused.toml: "
            with self.subTest(group["what"]):
                self.assertEqual((done.status, done.err), (2, f"ricochet-contact: {place}{line}\n"))

    def test_each_study_is_refused_in_one_line(self):
        for text, part in TABLE["studies"]:
            study = self.folder / "wrong.study.toml"
            study.write_text(f'scene = "scene.toml"\ntitle = "Rods"\n{text}')
            with self.subTest(text):
                self.refused(Command("sweep", study, "--ranks", "1", "--out", self.folder / "none"), part)
        self.assertEqual([path.name for path in self.folder.glob("none/*.kernel.h5")], [])

    def test_nothing_is_lost_and_nothing_is_left(self):
        self.assertEqual((self.lost, self.left), ([], []))

    def test_there_are_many(self):
        self.assertGreaterEqual(len(self.answers), 55)

    def test_the_page_shows_the_present_answers(self):
        _, title, shown_now = PAGE.read_text().partition(TITLE)
        self.assertEqual(written(self.answers), title + shown_now, "write it again: mistakes.py --manual")

    def test_what_other_editors_and_systems_write_is_no_mistake(self):
        spaced = self.folder / "mit Körper & co"
        spaced.mkdir()
        expected = run("ricochet impact --quiet scene.toml", self.folder)
        texts = {
            "bom.toml": "\ufeff" + SCENE,
            "windows.toml": SCENE.replace("\n", "\r\n"),
            "tabs.toml": SCENE.replace(" = ", "\t=\t"),
        }
        for name, text in texts.items():
            with self.subTest(name):
                (spaced / name).write_bytes(text.encode().replace(b'"rod.geo"', b'"../rod.geo"'))
                done = run(f"ricochet impact --quiet --out out '{spaced}/{name}'", self.folder)
                self.assertEqual((done.status, done.err), (0, expected.err))


def shown(text):
    """A cell of the page. Hashes and numbers of cores differ between machines."""
    text = re.sub(r"-[0-9a-f]{12}\.kernel", "-0123456789ab.kernel", text.strip())
    text = re.sub(r"share .*: -n \d+ is", "share 2 cores: -n 2 is", text)
    return text.replace("|", "\\|").replace("`", "'")


def asked(mistake):
    """What the page shows as the mistake."""
    if mistake.change:
        old, new = (text.replace("\n", " ↵ ") for text in mistake.change)
        return f"`{shown(new)}`" if new else f"no `{shown(old)}`"
    variables = "".join(f"{name}={value} " for name, value in mistake.env.items() if value)
    return f"`{shown(variables + mistake.command)}`"


def written(answers):
    """The last part of the page."""
    text, number = [HEAD], 0
    for title, mistakes in sections().items():
        text.append(f"\n### {title}\n\n| mistake | example | answer |\n|---|---|---|\n")
        for mistake, done in answers[number : number + len(mistakes)]:
            text.append(f"| {mistake.what} | {asked(mistake)} | `{shown(done.err)}` |\n")
        number += len(mistakes)
    return "".join(text)


if __name__ == "__main__":
    if sys.argv[1:] == ["--manual"]:
        Mistakes.setUpClass()
        explained = PAGE.read_text().partition(TITLE)[0]
        PAGE.write_text(explained + written(Mistakes.answers))
        Mistakes.doClassCleanups()
    else:
        unittest.main()
