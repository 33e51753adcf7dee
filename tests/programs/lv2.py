# SPDX-License-Identifier: BSD-2-Clause
"""The plug-in that ricochet export --lv2 writes, checked and played by programs of others: sord, lilv, and jalv on JACK without
a sound card."""

import contextlib
import os
import pathlib
import re
import shutil
import subprocess
import time
import unittest
from unittest import mock

import h5py
import numpy as np

from programs import DEADLOCK_S, MESHES, Command, ProgramTest, Run, settings
from ricochet import instruments, programs
from ricochet.interchange.lv2 import _range
from ricochet.pages import instrument

# Finding the places that the clapper reaches takes most of the time: they are 10 cm apart, and a coarse clapper has few points.
COARSE = [
    "bodies.bell.order=1",
    "bodies.clapper.order=1",
    "bodies.clapper.size_factor=3",
    "modes.up_to_hz=3000",
]
NAME = "small-bell"
STOPS_S = 20  # for the end of a program that was asked to end
STATE = """
@prefix lv2: <http://lv2plug.in/ns/lv2core#> .
@prefix pset: <http://lv2plug.in/ns/ext/presets#> .
<>
  a pset:Preset ;
  lv2:appliesTo <urn:ricochet:{name}> ;
  lv2:port [ lv2:symbol "place" ; pset:value 3.0 ] , [ lv2:symbol "damping" ; pset:value 5.0 ] .
"""


class Lv2(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.all, found = cls.shared_folder(), []
        shutil.copytree(MESHES / "bell", cls.all / "bell", ignore=shutil.ignore_patterns("out"))
        cls.scene = cls.all / "bell" / "bell.toml"
        cls.bundle = cls.all / "plugins" / f"{NAME}.lv2"
        of_scene = instruments.of_scene
        with mock.patch.object(
            instruments, "of_scene", lambda *a, **b: found.append(of_scene(*a, **b)) or found[0]
        ):
            run = cls.export(cls.bundle)
        assert run.status == 0, run.err
        cls.found = found[0]
        os.environ["LV2_PATH"] = f"{cls.bundle.parent}:/usr/lib/lv2"

    @classmethod
    def export(cls, out):
        return Command("export", "--lv2", cls.scene, "-o", out, "-n", 1, "--spacing", 0.1, *settings(COARSE))

    def setUp(self):
        super().setUp()
        self.running = {}  # programs in the background by the file of their output

    def test_description_is_valid_turtle_of_the_vocabularies_of_lv2(self):
        run = self.succeed(Run(["lv2_validate", *self.bundle.glob("*.ttl")]))
        self.assertIn("Found 0 errors", run.out + run.err)

    def test_host_finds_its_ports(self):
        info = self.succeed(Run(["lv2info", f"urn:ricochet:{NAME}"])).out
        self.assertRegex(info, r"Name: +Bell\n")
        self.assertRegex(info, r"Class: +Instrument Plugin\n")
        symbols = ["left", "right", "events", "place", "mallet", "speed", "damping", "level", "force"]
        self.assertEqual(re.findall(r"Symbol: +(\w+)", info), symbols)
        self.assertIn('0 = "clapper"', re.sub(r"\s+", " ", info))

    def test_numbers_are_valid_and_a_speed_of_1_is_0_dB(self):
        text = (self.bundle / "instrument.ttl").read_text()
        self.assertNotIn("-0.0", text)
        self.assertEqual(_range(-0.0, -60, 60)[0], "lv2:default 0.0")

    def test_player_that_is_missing_is_refused_before_any_work(self):
        nowhere = self.folder / "nowhere"
        self.enterContext(mock.patch.object(instruments, "of_scene", side_effect=AssertionError("work")))
        self.enterContext(mock.patch.object(programs, "BIN", nowhere / "bin"))
        self.enterContext(mock.patch.object(instrument, "FOLDER", nowhere))
        for form, name in (("--lv2", "ricochet-lv2.so"), ("--web", "player.wasm")):
            self.refused(Command("export", form, self.scene), name)

    def test_bundle_is_replaced_but_nothing_else_is(self):
        self.enterContext(mock.patch.object(instruments, "of_scene", return_value=self.found))
        copy = self.folder / "copy.lv2"
        shutil.copytree(self.bundle, copy)
        self.assertEqual(self.succeed(self.export(copy)).out.strip(), str(copy))
        self.assertEqual((copy / "uri").read_text(), "urn:ricochet:copy")
        self.assertEqual(os.listdir(self.folder), ["copy.lv2"])
        other = self.folder / "other.lv2"
        other.mkdir()
        (other / "precious").touch()
        for place, words in ((other, "is no bundle"), (self.folder / "bell.vst", "is named NAME.lv2")):
            self.refused(self.export(place), words)
        self.assertEqual(os.listdir(other), ["precious"])

    @contextlib.contextmanager
    def background(self, *words):
        """A program that runs until the end of the scope, and whose output is in a file with its name."""
        log = self.folder / pathlib.Path(words[0]).name
        with open(log, "wb") as out:
            process = subprocess.Popen(
                [str(word) for word in words], stdin=subprocess.PIPE, stdout=out, stderr=subprocess.STDOUT
            )
            self.running[log] = process
            try:
                yield process
            finally:
                del self.running[log]
                process.terminate()  # a killed jackd stays in the list of servers, which ends at eight
                try:
                    process.wait(STOPS_S)
                finally:
                    process.kill()
                    process.wait()
                    process.stdin.close()

    def wait_for(self, what, condition):
        limit = time.monotonic() + DEADLOCK_S
        while not condition():
            for log, process in self.running.items():
                self.assertIsNone(process.poll(), f"{log.name} ended: {log.read_text(errors='replace')}")
            self.assertLess(time.monotonic(), limit, f"no {what}")
            time.sleep(0.1)

    def ports(self):
        return Run(["jack_lsp"]).out.split()

    @contextlib.contextmanager
    def host(self, *more):
        """jalv with the plug-in, on a JACK server of its own."""
        server = f"ricochet-{os.getpid()}"
        names = {"JACK_DEFAULT_SERVER": server, "JACK_NO_AUDIO_RESERVATION": "1", "JACK_NO_START_SERVER": "1"}
        os.environ |= names
        with self.background("jackd", "-n", server, "-r", "-d", "dummy", "-r", 48000, "-p", 1024):
            self.wait_for("jackd", lambda: "system:playback_1" in self.ports())
            with self.background(
                "stdbuf", "-oL", "jalv", "-i", "-n", "bell", *more, f"urn:ricochet:{NAME}"
            ) as process:
                self.wait_for("jalv", lambda: "bell:events" in self.ports())
                yield process

    def test_state_is_kept_by_the_host(self):
        (self.folder / "state").mkdir()
        (self.folder / "state" / "state.ttl").write_text(STATE.format(name=NAME))
        said = self.folder / "stdbuf"
        with self.host("-l", self.folder / "state") as jalv:
            jalv.stdin.write(b"controls\n")
            jalv.stdin.flush()
            self.wait_for("controls", lambda: "level =" in said.read_text())
        self.assertRegex(said.read_text(), r"place = 3\.0+\n")
        self.assertRegex(said.read_text(), r"damping = 5\.0+\n")

    def test_note_sounds_with_the_partials_of_the_bell(self):
        record = self.folder / "sound.wav"
        with self.host():
            with self.background("jack_midiseq", "notes", 240000, 0, 60, 4800):
                self.wait_for("notes", lambda: "notes:out" in self.ports())
                self.succeed(Run(["jack_connect", "notes:out", "bell:events"]))
                # One blow every 5 s; the record of 6 s contains one or two.
                self.succeed(Run(["jack_rec", "-f", record, "-d", 6, "-b", 32, "bell:left"]))
        sound = np.frombuffer(record.read_bytes()[-4 * 6 * 48000 :], "<i4") / 2**31
        self.assertGreater(np.abs(sound).max(), 0.05)
        self.assertLess(np.abs(sound).max(), 1)
        frequency = np.fft.rfftfreq(len(sound), 1 / 48000)
        level = np.abs(np.fft.rfft(sound * np.hanning(len(sound))))
        loudest = frequency[np.argmax(np.where(frequency > 100, level, 0))]
        kernels = (self.all / "bell" / "out").glob("bell-*.kernel.h5")
        with h5py.File(next(kernels)) as file:
            partials = file["modes/angular_frequency"][:] / (2 * np.pi)
        # Blocks that are late on a busy machine shift parts of the record in time, which broadens the peak.
        self.assertLess(np.abs(partials / loudest - 1).min(), 1e-3)


if __name__ == "__main__":
    unittest.main()
