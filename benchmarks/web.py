# SPDX-License-Identifier: BSD-2-Clause
"""Speed of the player, compiled to WebAssembly and natively.

    scripts/bench web                              # the bell of the tutorial, medians of 5 rounds
    scripts/bench web SCENE.toml --rounds 9

The scene becomes an instrument as by ricochet export --web. It is played for 10 s at 48 kHz, with a blow every
0.5 s and, in the second row, every 10 ms, so that a mallet is in front of the body most of the time. Native
code and Node run in turn. Run scripts/build first; Node comes with emscripten.
"""
import pathlib
import tempfile

from benchmarks import launch, tables, timing
from ricochet import instruments, programs
from ricochet.pages.instrument import module
from ricochet.pages.page import FOLDER

SECONDS = 10
SAMPLES = 128  # of a block of an AudioWorklet
BELL = programs.ROOT / "meshes" / "bell" / "bell.toml"
COLUMNS = [
    ("a blow every", "every", ""),
    ("native s", "native", ".3f"),
    ("WebAssembly s", "web", ".3f"),
    ("x real time, native", lambda row: SECONDS / row["native"], ".0f"),
    ("x real time, WebAssembly", lambda row: SECONDS / row["web"], ".0f"),
    ("speed of WebAssembly, of native", lambda row: row["native"] / row["web"], ".2f"),
]


def add_arguments(parser):
    parser.add_argument("scene", nargs="?", type=pathlib.Path, default=BELL, metavar="SCENE.toml")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each, alternating (default: 5)")


def run(options):
    launch.build("bench_player")
    instrument, _, _ = instruments.of_scene(options.scene)
    print(f"player.wasm: {len(module())} bytes; block: {len(instrument.block())} bytes")
    with tempfile.TemporaryDirectory(prefix="ricochet-bench-") as folder:
        block, wasm = pathlib.Path(folder) / "block", pathlib.Path(folder) / "wasm"
        block.write_bytes(instrument.block())
        wasm.write_bytes(module())
        script = pathlib.Path(__file__).with_name("player.js")
        table = tables.Table(COLUMNS)
        for every in (0.5, 0.01):
            words = [block, 48000, SECONDS, every, SAMPLES]
            commands = {
                "native": [programs.BIN / "bench_player", *words],
                "web": ["node", script, FOLDER / "engine.js", wasm, *words],
            }
            runs = {name: (lambda command=command: seconds(command)) for name, command in commands.items()}
            found = timing.alternate(options.rounds, runs)
            table.row(
                {"every": f"{every:g} s"} | {name: timing.median(times) for name, times in found.items()}
            )


def seconds(command):
    return {"seconds": float(programs.call(command, capture=True).split()[0])}
