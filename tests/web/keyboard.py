# SPDX-License-Identifier: BSD-2-Clause
"""Keyboards of one bar: each key has the pitch of its note, its contact is that of the rescaled bar, and the page is played by letters.
The bar is the one of the package, so that nothing is computed but its rescaled kernels."""

import base64
import json
import shutil
import unittest
from dataclasses import replace
from unittest import mock

import numpy as np

import ricochet
from instrument import run_of
from programs import BIN, SOURCE, Command, ProgramTest, Run
from report_test import shared_browser
from ricochet import instruments
from ricochet.interchange.keyboard import name_of, note_of, notes_of, pitch_of
from ricochet.pages.page import FOLDER

RATE = 44100
KEYS = "A5:G#6"  # an octave around the pitch of the bar of the scene, 1300 Hz
NODE = """
const {readFileSync} = require("fs"), [script, wasm, block, rate, place, speed, samples] = process.argv.slice(1);
const Engine = new Function(`${readFileSync(script, "utf8")}\\nreturn Engine;`)();
const engine = new Engine(readFileSync(wasm), readFileSync(block), Number(rate));
if (!engine.strike({place: Number(place), speed: Number(speed)})) throw new Error("no strike");
const [left] = engine.process(Number(samples));
console.log(JSON.stringify({forces: Array.from(engine.forces()), sound: Array.from(left)}));
"""


class Names(unittest.TestCase):
    def test_are_those_of_scientific_pitch_notation(self):
        for text, note in (
            ("C4", 60),
            ("A4", 69),
            ("f#5", 78),
            ("Gb5", 78),
            ("C-1", 0),
            ("B#3", 60),
            ("69", 69),
        ):
            self.assertEqual(note_of(text), note)
        self.assertEqual([name_of(note) for note in (0, 60, 70, 127)], ["C-1", "C4", "A#4", "G9"])
        for text in ("H4", "C", "128", "C10", "A4:C4", "C4", ""):
            with self.assertRaises(ValueError):
                notes_of(text)

    def test_pitch_is_the_lowest_partial_that_is_not_20_dB_weaker(self):
        frequency = np.array([0.0, 100.0, 200.0, 300.0])
        self.assertEqual(pitch_of(frequency, np.array([0, 0.009, 0.011, 1])), 200)
        self.assertEqual(pitch_of(frequency, np.array([0, 0.011, 0.011, 1])), 100)


class Keyboard(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.made = cls.shared_folder()
        shutil.copytree(SOURCE / "python/ricochet/examples/bar", cls.made / "bar")
        cls.scene = cls.made / "bar/bar.toml"
        cls.page = cls.made / "keys.html"
        found = []
        made = instruments.keyboard_of
        with mock.patch.object(instruments, "keyboard_of", lambda *a: found.append(made(*a)) or found[0]):
            done = Command("export", "--web", cls.scene, "--keyboard", KEYS, "-o", cls.page)
        assert done.status == 0, done.err
        cls.found = found[0]
        cls.instrument = run_of(cls.page.read_text())["instrument"]
        for name in ("wasm", "block"):
            (cls.made / name).write_bytes(base64.b64decode(cls.instrument[name]))

    def played(self, key, speed, samples):
        """Forces [N] at eight times RATE, and the left channel [m/s]."""
        files = (FOLDER / "engine.js", self.made / "wasm", self.made / "block")
        done = Run(["node", "-e", NODE, *files, RATE, key, speed, samples])
        self.assertEqual(done.status, 0, done.err)
        found = json.loads(done.out)
        return np.array(found["forces"]), np.array(found["sound"])

    # The spectrum of 0.37 s is sharp enough for 1 cent with a parabola through its peak; semitones are 100 cents apart.
    def test_every_key_sounds_its_note_of_equal_temperament(self):
        names = ["A5", "A#5", "B5", "C6", "C#6", "D6", "D#6", "E6", "F6", "F#6", "G6", "G#6"]
        self.assertEqual(self.instrument["keys"], names)
        for key in (0, 5, 11):
            sound = self.played(key, 0.25, 1 << 14)[1]
            level = np.log(np.abs(np.fft.rfft(sound * np.hanning(len(sound)))))
            low = int(2000 * len(sound) / RATE)  # the first partial is below, the second above
            k = int(np.argmax(level[:low]))
            a, b, c = level[k - 1 : k + 2]
            heard = (k + 0.5 * (a - c) / (a - 2 * b + c)) * RATE / len(sound)
            self.assertLess(abs(1200 * np.log2(heard / (880 * 2 ** (key / 12)))), 1, names[key])

    # 1e-9 of the peak: round-off of other modes, which do not move, and of a mallet that is placed by angles.
    def test_the_contact_of_a_key_is_that_of_the_rescaled_bar(self):
        scene = ricochet.Scene(self.scene)
        scene["contact.gap"] = 0.0
        mallet = ricochet.Kernel(self.one(self.made / "bar/out", "mallet-*.kernel.h5"))
        (bar,) = (self.made / "bar/out").glob("bar-*.kernel.h5")

        def simulation(scene, bar):
            return ricochet._core.Simulation(scene._for_impact(), [bar._core, mallet._core], [])

        # The mallet strikes each bar at the same place, relative to the size of the bar.
        start = simulation(scene, ricochet.Kernel(bar))
        place = start.point_b[np.argmin(start.initial_gap)]
        for key in (0, 11):
            # The bar of E6 has lengths of 1.0 times 1299.8 Hz / 1318.5 Hz.
            pitch = ricochet.Kernel(bar).frequency[6]
            scale = pitch / (880 * 2 ** (key / 12))
            folder = self.folder / str(key)
            said = Run(
                [BIN / "ricochet-recast", bar, "--scale-factor", scale, "--up-to-hz", 20e3, "--out", folder]
            )
            if (
                "up-to-hz" in said.err or said.status
            ):  # a large bar has fewer modes below 20 kHz than its kernel states
                said = Run([BIN / "ricochet-recast", bar, "--scale-factor", scale, "--out", folder])
            aside = (scale - 1) * place[:2]
            alone = scene.changed(
                {"bodies.mallet.translate": [*aside, 0.005 * scale + 0.001]}
            )  # 1 mm above the bar
            native = np.empty(8 * 64)
            rescaled = ricochet.Kernel(said.out.split()[-1])
            simulation(alone, rescaled).step_block(len(native), None, native, None, None, None)
            forces = self.played(key, 0.25, 64)[0]
            self.assertGreater(np.count_nonzero(forces), 20)
            self.assertLess(np.abs(forces - native[: len(forces)]).max(), 1e-9 * native.max())
            self.assertEqual(np.abs(native[len(forces) :]).max(initial=0), 0)

    def test_the_page_is_played_by_letters(self):
        browser = shared_browser()
        browser.messages.clear()
        browser.open(self.page)
        for letter, name in (("a", "C6"), ("w", "C#6"), ("y", "G#6"), ("h", "G#6")):  # there is no A6
            browser.press(letter, letter)
            self.assertEqual(browser.evaluate("document.querySelector('#play output').textContent"), name)
        browser.wait_for(
            "document.querySelector('.status').textContent.startsWith('Struck: G#6 with mallet')"
        )
        self.assertEqual(browser.messages, [])

    def test_sizes_follow_the_first_bar(self):
        page = self.folder / "large.html"
        words = ("--keyboard", "C4:D4", "--scale-factor", 2, "-o", page)
        self.succeed(Command("export", "--web", self.scene, *words))
        frequency = np.frombuffer(
            base64.b64decode(run_of(page.read_text())["instrument"]["frequency"]["data"]), "<f4"
        )
        (bar,) = (self.made / "bar/out").glob("bar-*.kernel.h5")
        own = ricochet.Kernel(bar).frequency
        lowest = np.sort(frequency[frequency > 1])[:3]
        self.assertLess(
            np.abs(lowest / (own[6] / 2 * 2 ** (np.arange(3) / 12)) - 1).max(), 1e-6
        )  # single precision

    def test_plug_ins_have_whole_octaves_and_middle_c_first(self):
        bundle = self.folder / "keys.lv2"
        words = ("export", "--lv2", self.scene, "-o", bundle)
        self.refused(Command(*words, "--keyboard", "C6:C7"), "has 13 keys", "C6:B7")
        with mock.patch.object(instruments, "keyboard_of", return_value=self.found):
            self.succeed(Command(*words, "--keyboard", KEYS))
        # Middle C, an octave below C6 or more, strikes the place of C6; A5, three semitones below it, the one that is third to last.
        instrument, keyboard = self.found
        turned = replace(instrument, places=instrument.places[3:] + instrument.places[:3])
        self.assertEqual([keyboard.names[3], keyboard.names[0]], ["C6", "A5"])
        self.assertEqual((bundle / "instrument").read_bytes(), turned.block())
        text = (bundle / "instrument.ttl").read_text()
        self.assertIn('lv2:name "Transposition"', text)
        self.assertIn("in 12 sizes for the keys A5 to G#6", text)

    def test_options_without_a_keyboard_are_refused(self):
        self.refused(Command("export", "--web", self.scene, "--scale-factor", 2), "Add --keyboard")
        self.refused(
            Command("export", "--web", self.scene, "--keyboard", "C4:C5", "--spacing", 0.1), "Leave it out"
        )
        self.refused(Command("export", "--web", self.scene, "--keyboard", "C4:H5"), "H5: is no key")


if __name__ == "__main__":
    unittest.main()
