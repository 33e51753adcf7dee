# SPDX-License-Identifier: BSD-2-Clause
"""Bundles of the LV2 plug-in that plays an instrument (lv2/plugin.hpp)."""
from __future__ import annotations

import json
import re
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from ricochet import programs
from ricochet.errors import InputError
from ricochet.interchange.instrument import Instrument
from ricochet.interchange.keyboard import Keyboard

MIDDLE_C = 60  # of MIDI, which strikes the first place (lv2/plugin.cpp)
INPUT = "a lv2:ControlPort , lv2:InputPort"

# Hosts keep settings by the symbols of the ports and by the URI; a new version must not change them.
MANIFEST = """\
@prefix lv2:  <http://lv2plug.in/ns/lv2core#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .

<{uri}>
  a lv2:Plugin , lv2:InstrumentPlugin ;
  lv2:binary <instrument.so> ;
  rdfs:seeAlso <instrument.ttl> .
"""
PLUGIN = """\
@prefix atom:   <http://lv2plug.in/ns/ext/atom#> .
@prefix doap:   <http://usefulinc.com/ns/doap#> .
@prefix lv2:    <http://lv2plug.in/ns/lv2core#> .
@prefix midi:   <http://lv2plug.in/ns/ext/midi#> .
@prefix pprops: <http://lv2plug.in/ns/ext/port-props#> .
@prefix rdf:    <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .
@prefix rdfs:   <http://www.w3.org/2000/01/rdf-schema#> .
@prefix units:  <http://lv2plug.in/ns/extensions/units#> .
@prefix urid:   <http://lv2plug.in/ns/ext/urid#> .

<{uri}>
  a lv2:Plugin , lv2:InstrumentPlugin , doap:Project ;
  doap:name {title} ;
  rdfs:comment {comment} ;
  lv2:minorVersion 0 ;
  lv2:microVersion 1 ;
  lv2:requiredFeature urid:map ;
  lv2:optionalFeature lv2:hardRTCapable ;
  lv2:port {ports} .
"""


def write_bundle(instrument: Instrument, title: str, bundle: Path, keyboard: Keyboard | None = None) -> None:
    """Writes the bundle of an instrument, a folder with the plug-in, its instrument and its description. An
    earlier bundle of this name is replaced. The places of a keyboard, whole octaves, are put into the order in which the
    plug-in finds them: middle C first.

    Raises InputError, one line, if the name is not NAME.lv2, if something else is there, or if the place
    cannot be written.
    """
    if bundle.suffix != ".lv2" or not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9._-]*", bundle.stem):
        raise InputError(
            f"{bundle}: a bundle is named NAME.lv2, with letters, digits, '-', '_' and '.' only."
        )
    if bundle.exists() and not (bundle / "uri").is_file():
        raise InputError(f"{bundle}: is there and is no bundle of ricochet export. Choose another name.")
    uri = f"urn:ricochet:{bundle.stem}"
    if keyboard:
        middle = (MIDDLE_C - keyboard.notes[0]) % len(keyboard.notes)
        instrument = replace(instrument, places=instrument.places[middle:] + instrument.places[:middle])
    try:
        bundle.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{bundle.stem}.", dir=bundle.parent) as folder:
            new = Path(folder) / "new"
            new.mkdir()
            shutil.copy(library(), new / "instrument.so")
            (new / "instrument").write_bytes(instrument.block())
            (new / "uri").write_text(uri)
            (new / "manifest.ttl").write_text(MANIFEST.format(uri=uri))
            (new / "instrument.ttl").write_text(described(instrument, title, uri, keyboard), encoding="utf-8")
            if bundle.exists():
                bundle.rename(Path(folder) / "old")
            new.rename(bundle)
    except OSError as error:
        raise InputError(f"{error.filename or bundle}: {error.strerror}. Choose another place.") from None


def library() -> Path:
    """The library of the plug-in, beside this module or in the build. Raises InputError."""
    name = "ricochet-lv2.so"
    paths = (Path(__file__).with_name(name), programs.BIN.parent / "lv2" / name)
    for path in paths:
        if path.is_file():
            return path
    raise InputError(f"{paths[1]}: there is no such file, which plug-ins need. Run scripts/build.")


def described(instrument: Instrument, title: str, uri: str, keyboard: Keyboard | None = None) -> str:
    """The description of the plug-in, in Turtle. The default level lets a blow at the speed of the scene peak at
    a quarter of full scale, as one at 1 m/s does at 0 dB."""
    level = float(np.clip(-20 * np.log10(instrument.speed), -60, 60))
    last, top = len(instrument.places) - 1, instrument.speed
    names = [mallet.name for mallet in instrument.mallets]
    points = ", ".join(f"[ rdfs:label {_text(name)} ; rdf:value {k} ]" for k, name in enumerate(names))
    whole, log = "lv2:portProperty lv2:integer", "lv2:portProperty pprops:logarithmic"
    choice = [whole, "lv2:portProperty lv2:enumeration", f"lv2:scalePoint {points}"]
    ports = [
        ["a lv2:AudioPort , lv2:OutputPort", *_named("left", "Left")],
        ["a lv2:AudioPort , lv2:OutputPort", *_named("right", "Right")],
        [
            "a atom:AtomPort , lv2:InputPort",
            *_named("events", "Notes"),
            "atom:bufferType atom:Sequence",
            "atom:supports midi:MidiEvent",
            "lv2:designation lv2:control",
        ],
        [INPUT, *_named("place", "Transposition" if keyboard else "Place"), *_range(0, 0, last), whole],
        [INPUT, *_named("mallet", "Mallet"), *_range(0, 0, len(names) - 1), *choice],
        [
            INPUT,
            *_named("speed", "Speed of velocity 127"),
            *_range(top, top / 100, 10 * top),
            log,
            _unit("m/s"),
        ],
        [INPUT, *_named("damping", "Damping"), *_range(1, 0.1, 100), log, "units:unit units:coef"],
        [INPUT, *_named("level", "Level"), *_range(level, -60, 60), "units:unit units:db"],
        [
            "a lv2:ControlPort , lv2:OutputPort",
            *_named("force", "Contact force"),
            *_range(0, 0, 1e6),
            _unit("N"),
        ],
    ]
    described = (
        "[\n    " + " ;\n    ".join([f"lv2:index {index}", *port]) + "\n  ]"
        for index, port in enumerate(ports)
    )
    played = (
        f"{instrument.body}, in {last + 1} sizes for the keys {keyboard.names[0]} to {keyboard.names[-1]}; the contact is computed "
        "as it happens. Notes beyond sound in an octave that is there. "
        if keyboard
        else f"{instrument.body}, struck at {last + 1} places; the contact is computed as it happens. Middle C strikes "
        "the chosen place, other notes those beside it. "
    )
    comment = f"{played}Left: velocity of {instrument.channels[0]}, right: of {instrument.channels[1]}."
    return PLUGIN.format(uri=uri, title=_text(title), comment=_text(comment), ports=" , ".join(described))


def _named(symbol: str, name: str) -> list[str]:
    return [f'lv2:symbol "{symbol}"', f'lv2:name "{name}"']


def _range(default: float, least: float, most: float) -> list[str]:
    values = {"default": default, "minimum": least, "maximum": most}
    return [f"lv2:{key} {float(value) + 0.0!r}" for key, value in values.items()]


def _unit(symbol: str) -> str:
    return f'units:unit [ a units:Unit ; rdfs:label "{symbol}" ; units:symbol "{symbol}" ; units:render "%f {symbol}" ]'


def _text(value: str) -> str:
    """A string of Turtle, whose escapes include those of JSON."""
    return json.dumps(value, ensure_ascii=False)
