# SPDX-License-Identifier: BSD-2-Clause
"""Every --set in a help text or on a page survives bash and zsh: values with characters of the shell are in quotes."""

import functools
import re
import shutil
import unittest

from programs import BIN, SOURCE, Command, Run

# A setting in quotes, or up to a blank or the end of inline code.
SETTING = re.compile(r"""--set[ =]('[^']*'|"[^"]*"|[^\s`)]+)""")
SPECIAL = re.compile(r"[][{}*?<>|&;()$!~#]")
VERBS = "run modes kernel impact tradeoff".split()
MISTAKES = "## Mistakes and answers\n"  # this part of docs/messages.md shows what happens without quotes


def unquoted(text):
    """The settings that a shell would change, or refuse to pass on. Usage lines have "[--set KEY=VALUE]"."""
    settings = [setting for setting in SETTING.findall(text) if setting != "KEY=VALUE]"]
    return [setting for setting in settings if setting[0] not in "'\"" and SPECIAL.search(setting)]


@functools.cache
def texts():
    """(name, text) of help texts and pages."""
    found = [(f"ricochet {verb}", Command(verb, "--help").out) for verb in VERBS]
    found += [(name, Run([BIN / name, "--help"]).out) for name in ("ricochet-contact", "ricochet-kernel")]
    pages = [*SOURCE.glob("*.md"), *SOURCE.glob("docs/**/*.md"), *SOURCE.glob("benchmarks/*.md")]
    return found + [(path.relative_to(SOURCE), path.read_text().partition(MISTAKES)[0]) for path in pages]


class Quotes(unittest.TestCase):
    def test_no_example_needs_quotes_that_it_lacks(self):
        found = {name: SETTING.findall(text) for name, text in texts()}
        self.assertGreater(sum(map(len, found.values())), 40)  # the examples are found at all
        self.assertIn("'bodies.upper.velocity=[0,-6,0]'", found["ricochet-contact"])
        for name, text in texts():
            self.assertEqual(unquoted(text), [], name)

    def test_an_example_without_quotes_is_found(self):
        self.assertEqual(unquoted("x --set a.b=[0,1] y"), ["a.b=[0,1]"])
        self.assertEqual(unquoted("`--set 'a={ b = 1 }'` `--set a.b=1`"), [])

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_passes_each_example_on(self):
        settings = sorted({setting for _, text in texts() for setting in SETTING.findall(text)})
        script = "\n".join(f"print -r -- {setting} || exit 1" for setting in settings if "KEY" not in setting)
        done = Run(["zsh", "-f", "-c", script])
        self.assertEqual((done.status, done.err), (0, ""))
        self.assertEqual(Run(["zsh", "-f", "-c", "print a.b=[0,1]"]).status, 1)


if __name__ == "__main__":
    unittest.main()
