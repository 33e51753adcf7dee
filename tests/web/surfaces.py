# SPDX-License-Identifier: BSD-2-Clause
"""The page of `ricochet surfaces` in Chromium without network: numbers only where a surface is seen, picking by mouse, keys and
table, edges, measures in metres; and the browser that opens it. `surfaces.py --keep FOLDER` also keeps the page and pictures of it."""

import math
import os
import shutil
import unittest
from unittest import mock

import numpy as np

from programs import Command, ProgramTest
from report_test import KEEP, data_of, shared_browser, unpacked

from ricochet.cli.options import open_page

# A block with a hole from top to bottom. Its front has a group of its own; its sides share one.
PART = """SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 40, 30, 20};
Cylinder(2) = {20, 15, -1, 0, 0, 22, 5};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
front() = Surface In BoundingBox{-1, -1, -1, 41, 1, 21};
left() = Surface In BoundingBox{-1, -1, -1, 1, 31, 21};
right() = Surface In BoundingBox{39, -1, -1, 41, 31, 21};
Physical Surface("front") = {front()};
Physical Surface("sides") = {left(), right()};
"""
LABELS = """[...document.querySelectorAll(".labels text")].map(text => [Number(text.dataset.surface), text.textContent])"""
PICKED = "document.querySelector('#picked pre')?.textContent ?? null"
SHIFT = 8  # in the protocol of the browser


class Page(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        (cls.made / "part.geo").write_text(PART)
        cls.done = Command("surfaces", cls.made / "part.geo", "--scale", "1e-3")
        cls.path = cls.made / "part.geo-surfaces.html"
        cls.data = data_of(cls.path)

    def setUp(self):
        super().setUp()
        self.assertTrue(shutil.which("chromium"), "no chromium: scripts/setup --tests installs it")
        self.browser = shared_browser()
        if self.path.resolve().as_uri() not in self.browser.requests:
            self.browser.open(self.path)
        self.browser.evaluate("surfaces.motion.home(); surfaces.reveal()")

    def tearDown(self):
        self.assertEqual(self.browser.messages, [])
        self.assertEqual(set(self.browser.requests), {self.path.resolve().as_uri()})

    def index(self, axis, place):
        """The index of the plane at a place of an axis [m]."""
        (found,) = [
            k
            for k, face in enumerate(self.data["faces"])
            if np.allclose([face["low"][axis], face["high"][axis]], place, atol=1e-8)
        ]
        return found

    def number(self, axis, place):
        return self.data["faces"][self.index(axis, place)]["number"]

    def look(self, azimuth, elevation):
        self.browser.evaluate(f"surfaces.motion.look({azimuth}, {elevation}); surfaces.show()")

    def place(self, right=0.0, up=0.0):
        """A place of the window, from the middle of the drawing, whose planes y = const and z = const face the eye [mm]."""
        return self.browser.evaluate(
            f"""(() => {{ const {{canvas, motion}} = surfaces; canvas.scrollIntoView({{block: "center"}});
              const box = canvas.getBoundingClientRect(), mm = 1e-3 * motion.scale * box.width / canvas.width;
              return [box.x + box.width / 2 + {right} * mm, box.y + box.height / 2 - {up} * mm]; }})()"""
        )

    def click(self, x, y, modifiers=0):
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.call(
                "Input.dispatchMouseEvent",
                type=kind,
                x=x,
                y=y,
                button="left",
                clickCount=1,
                modifiers=modifiers,
            )

    def picked(self):
        return self.browser.evaluate(PICKED)

    def test_lies_beside_the_drawing_and_is_named_below_the_table(self):
        self.assertEqual(self.done.status, 0, self.done.err)
        *table, unit, picture, page = self.done.out.splitlines()
        self.assertEqual(page, str(self.path))
        self.assertTrue(picture.endswith("part.geo-surfaces.png"))
        self.assertIn("scale = 0.001 ", unit)
        numbers = [int(line.split()[0]) for line in table[1:]]
        self.assertEqual(numbers, [face["number"] for face in self.data["faces"]])
        shown = self.browser.evaluate(
            "[...document.querySelectorAll('#surfaces tbody button')].map(one => Number(one.textContent))"
        )
        self.assertEqual(shown, numbers)
        self.assertIn(
            "40 × 30 × 20 mm", self.browser.evaluate("document.getElementById('verdict').textContent")
        )

    # The eye is four times the size of the drawing away, so that from the front no side is seen, and from above a ring of the hole.
    def test_numbers_the_surfaces_that_are_seen_and_no_other(self):
        front, top = self.number(1, 0), self.number(2, 0.02)
        self.look(0, 0)
        self.assertEqual(self.browser.evaluate(LABELS), [[front, f"{front} front"]])
        self.look(0, math.pi / 2)
        self.assertEqual([number for number, _ in self.browser.evaluate(LABELS)], [top])
        self.look(0.6, 0.5)
        found = {number for number, _ in self.browser.evaluate(LABELS)}
        hidden = {self.number(0, 0.04), self.number(1, 0.03), self.number(2, 0)}
        self.assertLess({front, top}, found)
        self.assertFalse(found & hidden)
        if KEEP:
            KEEP.mkdir(parents=True, exist_ok=True)
            shutil.copy(self.path, KEEP)
            self.browser.screenshot(KEEP / "surfaces.png")

    def test_is_picked_by_mouse_and_gives_the_line_of_the_scene(self):
        self.look(0, 0)
        x, y = self.place(12)
        self.browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        tip = self.browser.evaluate("[surfaces.tip.textContent, getComputedStyle(surfaces.tip).visibility]")
        front = self.number(1, 0)
        self.assertEqual(tip, [f"surface {front}, front: plane, 800 mm²", "visible"])
        self.click(x, y)
        self.assertEqual(self.picked(), 'contact = "front"')
        rows = dict(
            self.browser.evaluate(
                "[...document.querySelectorAll('#picked tr')].map(row => [...row.cells].map(cell => cell.textContent))"
            )
        )
        self.assertEqual((rows["from"], rows["to"]), ("(0, 0, 0) mm", "(40, 0, 20) mm"))
        self.assertEqual((rows["centre of area"], rows["outward normal"]), ("(20, 0, 10) mm", "(0, −1, 0)"))
        self.assertEqual(rows["also"], f'"surface {front}"')
        self.line_is_copied()
        # Without the front, the back is seen from inside, beside the hole.
        back = self.number(1, 0.03)
        self.pressed("Hide")
        self.click(*self.place(12))
        self.assertEqual(self.picked(), f'contact = "surface {back}"')
        self.pressed("Show all (1 hidden)")
        self.click(*self.place(12))
        # A side shares its group with the other one, so it goes by its number.
        self.look(math.pi / 2, 0)
        self.click(*self.place(), modifiers=SHIFT)
        side = max(
            self.number(0, place)
            for place in (0, 0.04)
            if f"surface {self.number(0, place)}" in self.picked()
        )
        self.assertEqual(self.picked(), f'contact = ["front", "surface {side}"]')
        self.click(*self.place(), modifiers=SHIFT)
        self.assertEqual(self.picked(), 'contact = "front"')

    def line_is_copied(self):
        """Pastes what the button Copy has copied into a field of the page."""
        x, y = self.browser.evaluate(
            """(() => { const one = [...document.querySelectorAll("#picked button")].find(one => one.textContent === "Copy");
              const {x, y, width, height} = one.getBoundingClientRect(); return [x + width / 2, y + height / 2]; })()"""
        )
        self.click(x, y)
        self.browser.wait_for("document.querySelector('#picked button').textContent === 'Copied'")
        self.browser.evaluate(
            "(() => { const field = document.createElement('textarea'); field.id = 'pasted'; document.body.append(field); field.focus(); })()"
        )
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key="v", commands=["paste"])
        pasted = self.browser.evaluate("document.getElementById('pasted').value")
        self.browser.evaluate("document.getElementById('pasted').remove()")
        self.assertEqual(pasted.strip(), 'contact = "front"')

    def pressed(self, text):
        found = self.browser.evaluate(
            f"(() => {{ const one = [...document.querySelectorAll('button')].find(one => one.textContent === '{text}'); one?.click(); return Boolean(one); }})()"
        )
        self.assertTrue(found, text)

    def test_is_picked_by_keys_and_table_and_turns_to_a_surface_that_is_not_seen(self):
        numbers = [face["number"] for face in self.data["faces"]]
        names = [face["names"][0] for face in self.data["faces"]]
        self.browser.evaluate("surfaces.canvas.focus()")
        for key, k in (("n", 0), ("n", 1), ("p", 0), ("p", len(numbers) - 1)):
            self.browser.press(key, key)
            self.assertEqual(self.picked(), f'contact = "{names[k]}"')
        self.browser.press("Escape")
        self.assertIsNone(self.picked())
        self.look(0, math.pi / 2)
        below = self.index(2, 0)
        self.pressed(str(numbers[below]))
        self.assertEqual(self.picked(), f'contact = "surface {numbers[below]}"')
        self.assertLess(self.browser.evaluate("surfaces.motion.turn()[2][2]"), -0.3)  # the eye is below
        self.assertIn(numbers[below], [number for number, _ in self.browser.evaluate(LABELS)])

    def test_draws_the_edges_of_the_drawing(self):
        lengths = []
        for body in self.data["motion"]["bodies"]:
            ends = unpacked(body["node"])[unpacked(body["outline"]).astype(int).reshape(-1, 2)]
            lengths.append(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())
        self.assertAlmostEqual(lengths[self.index(1, 0)], 0.12, delta=1e-7)  # single precision
        # A circle is drawn with at least 24 sides, which are 0.3 % shorter.
        whole = 0.14 + 2 * math.pi * 0.005
        self.assertTrue(0.999 * whole < lengths[self.index(2, 0.02)] <= whole * (1 + 1e-6))
        drawn = "(surfaces.show(), surfaces.canvas.toDataURL())"
        lined = self.browser.evaluate(drawn)
        bare = self.browser.evaluate(
            f"(surfaces.motion.bodies.forEach(body => {{ body.rim = undefined; }}), {drawn})"
        )
        self.assertNotEqual(lined, bare)
        self.browser.open(self.path)

    def test_fits_a_narrow_screen(self):
        self.browser.open(self.path, 390, 844)
        self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), 390)
        self.assertGreater(len(self.browser.evaluate(LABELS)), 2)
        self.browser.open(self.path)


class Opened(ProgramTest):
    """The page opens in the browser of the desktop, for which a script stands here."""

    def setUp(self):
        super().setUp()
        (self.folder / "sheet.geo").write_text(
            'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 1, 1};\n'
        )
        self.told = self.folder / "told"
        os.mkfifo(self.told)
        opener = self.folder / "xdg-open"
        opener.write_text(f'#!/bin/sh\necho "$1" > {self.told}\n')
        opener.chmod(0o755)

    def run_it(self, *words, **variables):
        clean = {name: value for name, value in os.environ.items() if "DISPLAY" not in name}
        path = f"{self.folder}:{os.environ['PATH']}"
        with mock.patch.dict(os.environ, clean | {"PATH": path} | variables, clear=True):
            return self.succeed(Command("surfaces", self.folder / "sheet.geo", *words))

    def test_on_request_and_the_command_does_not_wait(self):
        done = self.run_it("--open", DISPLAY=":7")  # the script waits for a reader
        self.assertEqual(self.told.read_text(), f"{self.folder / 'sheet.geo-surfaces.html'}\n")
        self.assertEqual(done.err, "")

    def test_in_a_terminal_with_a_display(self):
        page = self.folder / "sheet.geo-surfaces.html"
        with mock.patch("ricochet.cli.options.sys") as system, mock.patch(
            "ricochet.cli.options.subprocess"
        ) as processes:
            system.stdout.isatty.return_value = True
            path = f"{self.folder}:{os.environ['PATH']}"
            with mock.patch.dict(os.environ, {"PATH": path, "WAYLAND_DISPLAY": "wayland-0"}):
                open_page(page, None)
        self.assertEqual(processes.Popen.call_args.args[0], [str(self.folder / "xdg-open"), str(page)])

    def test_never_in_a_script_or_without_a_display(self):
        with mock.patch("ricochet.cli.options.subprocess") as processes:
            self.assertEqual(self.run_it(DISPLAY=":7").err, "")  # the output is no terminal
            self.assertEqual(self.run_it("--no-open", DISPLAY=":7").err, "")
            done = self.run_it("--open")
        processes.Popen.assert_not_called()
        page = self.folder / "sheet.geo-surfaces.html"
        self.assertEqual(done.err, f"warning: {page} is not opened: there is no display\n")


if __name__ == "__main__":
    unittest.main()
