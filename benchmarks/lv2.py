# SPDX-License-Identifier: BSD-2-Clause
"""Speed of the LV2 plug-in, and its dropouts in a host.

    scripts/bench lv2                       # the bell of the tutorial
    scripts/bench lv2 SCENE.toml --seconds 10

lv2bench runs the plug-in without notes, and bench_player plays the same notes as fast as it can and finds the
block that takes longest. Then jalv plays the plug-in on JACK's dummy driver at 48 kHz in blocks of 64
samples, with eight notes a second that go first to nothing and then to the plug-in. JACK counts its xruns: blocks that the host with
the plug-in did not finish in time, and wake-ups of the driver, a timer without a sound card, that the machine
delayed. Run scripts/setup --tests and scripts/build first. JACK needs the right to real-time priorities.
"""
import contextlib
import os
import pathlib
import subprocess
import tempfile
import time

from benchmarks import launch
from ricochet import programs
from ricochet.errors import InputError
from ricochet.instruments import write_instrument

BELL = programs.ROOT / "meshes" / "bell" / "bell.toml"
RATE, BLOCK = 48000, 64
FRAMES = 10 * RATE
PERIOD = RATE // 2  # of the sequence of notes, in frames
NOTES = (60, 62, 64, 67)
HOST = "bench"
STARTS_S = 60  # a server or a client is there after this time, or something is wrong


def add_arguments(parser):
    parser.add_argument("scene", nargs="?", type=pathlib.Path, default=BELL, metavar="SCENE.toml")
    parser.add_argument("--seconds", type=float, default=60, help="of notes (default: 60)")


def run(options):
    launch.build("ricochet_lv2", "bench_player")
    with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
        bundle = write_instrument(options.scene, pathlib.Path(folder) / "benchmark.lv2", form="lv2")
        os.environ["LV2_PATH"] = f"{folder}:/usr/lib/lv2"
        uri = f"urn:ricochet:{bundle.stem}"
        words = ["lv2bench", "-b", BLOCK, "-n", FRAMES, uri]
        seconds = float(programs.call(words, capture=True).split()[0])
        print(
            f"lv2bench: {FRAMES} frames without notes in {seconds:.4f} s, {FRAMES / RATE / seconds:.0f} x real time"
        )
        block = bundle / "instrument"
        words = [programs.BIN / "bench_player", block, RATE, options.seconds, 1 / 8, BLOCK]
        total, longest = map(float, programs.call(words, capture=True).split())
        print(
            f"bench_player: {options.seconds:g} s with notes in {total:.3f} s; longest block {1e3 * longest:.3f} ms "
            f"of {1e3 * BLOCK / RATE:.3f}"
        )
        print(f"jalv, {options.seconds:g} s in blocks of {BLOCK} at {RATE} Hz:")
        for what, (late, delayed) in dropouts(uri, options.seconds, pathlib.Path(folder)).items():
            print(f"  {what}: {late} blocks not finished in time, {delayed} delayed wake-ups of the driver")


@contextlib.contextmanager
def background(words, log):
    """A program that runs until the end of the scope."""
    with open(log, "wb") as out:
        process = subprocess.Popen(
            [str(word) for word in words], stdin=subprocess.PIPE, stdout=out, stderr=subprocess.STDOUT
        )
        try:
            yield process
        finally:
            process.terminate()
            process.wait()


def wait_for(what, client):
    """Waits until JACK has a port of this name."""
    limit = time.monotonic() + STARTS_S
    while (
        client not in subprocess.run(["jack_lsp"], capture_output=True, text=True, check=False).stdout.split()
    ):
        if time.monotonic() > limit:
            raise InputError(f"{what}: JACK has no port {client} after {STARTS_S} s.")
        time.sleep(0.2)


def dropouts(uri, seconds, folder):
    """Xruns while notes go to nothing and to the plug-in, each for this duration."""
    server = f"ricochet-{os.getpid()}"
    os.environ |= {
        "JACK_DEFAULT_SERVER": server,
        "JACK_NO_AUDIO_RESERVATION": "1",
        "JACK_NO_START_SERVER": "1",
    }
    log = folder / "jackd.log"
    jackd = ["jackd", "-n", server, "-R", "-P", 70, "-d", "dummy", "-r", RATE, "-p", BLOCK]
    step = PERIOD // len(NOTES)
    notes = [word for k, note in enumerate(NOTES) for word in (k * step, note, step // 2)]
    with background(jackd, log):
        wait_for("jackd", "system:playback_1")
        with background(["jalv", "-i", "-n", HOST, uri], folder / "jalv.log"):
            wait_for("jalv", f"{HOST}:events")
            subprocess.run(["jack_connect", f"{HOST}:left", "system:playback_1"], check=True)
            with background(["jack_midiseq", "notes", PERIOD, *notes], folder / "notes.log"):
                wait_for("jack_midiseq", "notes:out")
                unheard = counted(log, seconds)
                subprocess.run(["jack_connect", "notes:out", f"{HOST}:events"], check=True)
                return {"notes to nothing": unheard, "notes to the plug-in": counted(log, seconds)}


def counted(log, seconds):
    """Xruns within this time: blocks that the host did not finish, and delayed wake-ups of the driver."""
    start = log.stat().st_size
    time.sleep(seconds)
    said = log.read_bytes()[start:]
    return said.count(f"client = {HOST} was not finished".encode()), said.count(b"Process XRun")
