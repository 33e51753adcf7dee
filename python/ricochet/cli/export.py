# SPDX-License-Identifier: BSD-2-Clause
"""Writes a body or a run in the format of another program. --faust writes a modal model for the Faust language to standard
output; --web writes a page on which the body is struck and heard, and --lv2 a plug-in that plays it. --gltf writes a film of a run.

  ricochet export --faust out/bell-0123456789ab.kernel.h5 --excite 17 --receive mic:x > bell.dsp
  faust2jaqt bell.dsp
  ricochet export --web meshes/bell/bell.toml -o bell.html
  ricochet export --lv2 meshes/bell/bell.toml -o bell.lv2
  ricochet export --web bar.toml --keyboard C6:B7 -o keyboard.html
  ricochet export out/two-disks.result.h5 --gltf disks.glb --colour stress

The Faust model turns the force at one place into the velocity of others. A place is the name of a receiver, the number of a
contact point, from 0, or x,y,z [m] in the axes of the body for the nearest contact point. It may be followed by a colon and a
direction: x, y, z or three numbers. The default direction at a contact point is its normal. docs/interchange.md describes the
model.

The page is one file that opens in any browser, without a network (docs/web.md). The plug-in is an LV2 bundle, a folder to be
copied to ~/.lv2 (docs/lv2.md). From a scene, the body can be struck all over
its contact surface; missing kernels are computed. From a result, it can be struck where its kernels have contact points. With
--keyboard, the body becomes a bar for each key, whose size gives it the pitch of the key, struck at the place of the scene.

The film is a binary glTF file, for viewers of 3D models and for Blender: bodies move and deform as in the snapshots of the run,
contact forces are arrows, and stress, speed or motion (the displacement without the rigid motion) can be their colour. A few shapes
replace all modes; their error is printed (docs/results.md).
"""
import argparse
import signal
import sys
from pathlib import Path

from ricochet import file_kinds
from ricochet.cli.options import add_count, add_ranks, add_set, positive
from ricochet.errors import InputError
from ricochet.instruments import write_instrument
from ricochet.interchange import faust

BESIDE = Path()  # --gltf without a name


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "source",
        type=Path,
        metavar="FILE",
        nargs="?",
        help="KERNEL.h5; --web, --lv2: SCENE.toml or RESULT.h5; --gltf: RESULT.h5",
    )
    formats = parser.add_mutually_exclusive_group(required=True)
    formats.add_argument("--faust", action="store_true", help="a Faust modal model")
    formats.add_argument("--web", action="store_true", help="a page to play")
    formats.add_argument("--lv2", action="store_true", help="an LV2 plug-in")
    formats.add_argument(
        "--gltf",
        type=Path,
        nargs="?",
        const=BESIDE,
        metavar="FILE.glb",
        help="a film as binary glTF (default: beside the result)",
    )
    model = parser.add_argument_group("options of --faust")
    model.add_argument("--excite", metavar="PLACE", help="where a force acts")
    model.add_argument(
        "--receive",
        action="append",
        metavar="PLACE",
        help="whose velocity is put out; repeatable",
    )
    model.add_argument(
        "--rate",
        type=positive,
        default=44100,
        metavar="HZ",
        help="lowest sample rate to play at (default: 44100)",
    )
    model.add_argument(
        "--t60", type=positive, metavar="S", help="decay time by 60 dB of modes without damping"
    )
    model.add_argument("--button", action="store_true", help="a button strikes, instead of a force signal")
    page = parser.add_argument_group("options of --web and --lv2")
    page.add_argument(
        "-o", "--out", type=Path, metavar="PATH", help="NAME.html or NAME.lv2 (default: beside the file)"
    )
    page.add_argument("--body", metavar="NAME", help="that sounds (default: the one with receivers)")
    page.add_argument(
        "--spacing", type=positive, metavar="M", help="between places (default: half the size of the mallet)"
    )
    page.add_argument(
        "--keyboard",
        type=keys,
        default=(),
        metavar="FIRST:LAST",
        help="a bar for each key, in tune: the body of the scene in as many sizes, such as C4:B5",
    )
    page.add_argument(
        "--scale-factor",
        type=positive,
        metavar="X",
        help="on all lengths, for the bar of the first key of --keyboard (default: in tune with A4 = 440 Hz)",
    )
    add_set(page)
    page.add_argument(
        "--kernels", type=Path, metavar="DIR", help="folder of kernels (default: out/, or beside the result)"
    )
    add_ranks(page)
    add_film(parser.add_argument_group("options of --gltf, which also takes --kernels"))


def keys(text: str) -> list[int]:
    from ricochet.interchange.keyboard import notes_of

    try:
        return notes_of(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def share(text: str) -> float:
    value = float(text)
    if not 0 < value <= 1:
        raise argparse.ArgumentTypeError(f"{text}: must be above 0 and at most 1")
    return value


def add_film(film: argparse._ArgumentGroup) -> None:
    film.add_argument(
        "--magnify",
        type=positive,
        metavar="X",
        help="factor on the deformation (default: as on pages; 1: true to scale)",
    )
    film.add_argument(
        "--colour",
        choices=("stress", "speed", "motion"),
        help="field that colours the bodies (default: none)",
    )
    film.add_argument(
        "--slow",
        type=positive,
        metavar="X",
        help="seconds of the film for each second of the run (default: a round number, up to 10 s in all)",
    )
    film.add_argument(
        "--opacity",
        type=share,
        metavar="X",
        help="of the bodies; below 1, arrows inside of them are seen (default: 1, or 0.6 if two bodies touch)",
    )
    add_count(film, "--targets", 16, "morph targets of each body, which bound its shapes and colours")


def export_film(options: argparse.Namespace) -> None:
    """Writes the film. Refuses other files than results."""
    source = file_kinds.result(str(options.source))
    from ricochet.films.film import Choice, write_film  # takes a second, so refusals come before

    choice = Choice(options.magnify, options.colour, options.slow, options.targets, options.opacity)
    out = None if options.gltf == BESIDE else options.gltf
    path, film = write_film(source, options.out or out, options.kernels, choice)
    print(path, *film.lines, sep="\n")
    for warning in film.warnings:
        print(f"warning: {warning}", file=sys.stderr)


def run(options: argparse.Namespace) -> None:
    if options.source is None and options.gltf not in (None, BESIDE):  # the option took the file
        options.source, options.gltf = options.gltf, BESIDE
    if options.source is None:
        raise InputError("names no FILE: give a kernel, a scene or a result")
    if options.gltf is not None:
        export_film(options)
        return
    if options.web or options.lv2:
        path = write_instrument(
            options.source,
            options.out,
            form="lv2" if options.lv2 else "web",
            body=options.body,
            spacing=options.spacing,
            keys=options.keyboard,
            factor=options.scale_factor,
            settings=options.set,
            kernels=options.kernels,
            ranks=options.ranks,
        )
        print(path)
        return
    if not options.excite or not options.receive:
        raise InputError("--faust: needs a place to excite and one to receive: add --excite and --receive")
    model = faust.model_of(options.source, options.excite, options.receive, options.rate, options.t60)
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    print(model.text(options.button), end="")
