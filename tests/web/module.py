# SPDX-License-Identifier: BSD-2-Clause
"""The committed player in WebAssembly comes from the code of the repository; a clone without emscripten makes pages to play."""

import importlib.machinery
import importlib.util
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]


def tool():
    """scripts/player as a module."""
    loader = importlib.machinery.SourceFileLoader("player", str(ROOT / "scripts/player"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("player", loader))
    loader.exec_module(module)
    return module


class Module(unittest.TestCase):
    def setUp(self):
        self.tool = tool()

    def test_comes_from_the_code_of_the_repository(self):
        self.tool.check()

    def test_other_code_and_another_file_are_refused(self):
        read = Path.read_text
        for name, before, after in (
            ("player/player.cpp", "{", "{ int more;"),
            ("contact/law/slip.hpp", "#pragma once", "#pragma once\nint more;"),
        ):

            def changed(path, *words):
                text = read(path, *words)
                return text.replace(before, after, 1) if path == ROOT / name else text

            with mock.patch.object(Path, "read_text", changed):
                self.assertRaisesRegex(self.tool.Refused, "comes from other code", self.tool.check)
        with mock.patch.object(self.tool, "MODULE", ROOT / "LICENSE"):
            self.assertRaisesRegex(self.tool.Refused, "is not the file", self.tool.check)

    def test_comments_and_spaces_are_not_code(self):
        code = self.tool.code_of
        self.assertEqual(code("int a  = b ;  // why\n/* or\n how */ f(\n  a);"), code("int a=b; f(a);"))
        for other in ("int a = c; f(a);", "int a = b; f(b);", "inta = b; f(a);"):
            self.assertNotEqual(code(other), code("int a = b; f(a);"))
        self.assertNotEqual(code('s = "//a";'), code('s = "//b";'))

    def test_is_a_module_that_pages_find(self):
        from ricochet.pages.instrument import module

        self.assertEqual(module()[:8], b"\0asm\1\0\0\0")  # magic and version of the standard


if __name__ == "__main__":
    unittest.main()
