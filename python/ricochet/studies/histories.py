# SPDX-License-Identifier: BSD-2-Clause
"""Records of the impacts of a study: the archive that is written while it runs, and their place in its
HDF5 file.

/histories/NNNN belongs to the impact of row NNNN, counted from 0. Impacts may differ in steps and lengths, so each
has times of its own. Names and units are those of result files (docs/formats/result.md).
"""
import errno
import os
import zlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import h5py
import numpy as np

from ricochet import dimensions
from ricochet.arrays import Floats
from ricochet.errors import InputError
from ricochet.stress import von_mises
from ricochet.studies.study import WORDS, meant

KEY_BYTES = 24  # length of the key of an impact


class Kept(NamedTuple):
    """The place of the records of an impact in an archive."""

    words: list[str]
    at: int
    bytes: int
    crc: int

    @classmethod
    def of(cls, value: Any) -> "Kept | None":
        """The place in a line of the journal; None if no sweep wrote it."""
        if not isinstance(value, dict) or set(value) != set(cls._fields):
            return None
        numbers = [value[name] for name in ("at", "bytes", "crc")]
        words = value["words"]
        if not isinstance(words, list) or not all(type(number) is int and number >= 0 for number in numbers):
            return None
        return cls(**value) if all(word in list(WORDS) for word in words) else None  # lists have no hash


class Archive:
    """A file to which the owner of a journal appends the records of its impacts: for each one its key, and
    an HDF5 file. Bytes that no line of the journal names are those of a process that was killed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: BinaryIO | None = None

    def append(self, key: str, words: Sequence[str], image: bytes) -> Kept:
        """Adds the records of an impact, which the operating system has when this returns."""
        if self._file is None:
            self._file = open(self.path, "ab")
        at = self._file.seek(0, os.SEEK_END) + KEY_BYTES
        self._file.write(key.encode() + image)
        self._file.flush()
        return Kept(list(words), at, len(image), zlib.crc32(image))

    def sync(self) -> None:
        if self._file:
            os.fsync(self._file.fileno())

    def close(self) -> None:
        if self._file:
            self._file.close()

    def holding(self, found: dict[str, Kept]) -> set[str]:
        """Those keys whose records are where the journal has them."""
        try:
            size = self.path.stat().st_size
            with open(self.path, "rb") as file:
                return {
                    key
                    for key, kept in found.items()
                    if kept.at >= KEY_BYTES
                    and kept.at + kept.bytes <= size
                    and os.pread(file.fileno(), KEY_BYTES, kept.at - KEY_BYTES) == key.encode()
                }
        except OSError:
            return set()

    def read(self, kept: Kept) -> h5py.File:
        """The records of an impact. Raises InputError if they are damaged."""
        with open(self.path, "rb") as file:
            image = os.pread(file.fileno(), kept.bytes, kept.at)
        if zlib.crc32(image) != kept.crc:
            raise InputError(
                f"{self.path}: is damaged. Remove it, and the same command runs its impacts again."
            )
        return h5py.File(h5py.h5f.open_file_image(image))


class Source(NamedTuple):
    """The records of a row of the study."""

    row: int
    kept: Kept
    archive: Archive


def room_for(sources: Iterable[Source]) -> int:
    """Bytes that the records take in an HDF5 file, at most."""
    return sum(source.kept.bytes for source in sources)


def reserve(path: Path, size: int) -> None:
    """Reserves space for a file that HDF5 has open, because HDF5 crashes if the disk is full. Raises OSError."""
    with open(path, "rb+") as file:
        try:
            os.posix_fallocate(file.fileno(), 0, size)
        except OSError as error:
            if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
                raise


def copy(file: h5py.File, sources: Sequence[Source], words: Sequence[str], rows: int) -> None:
    """Copies what `words` name into /histories, one impact at a time. Compressed values stay as they are.
    `rows`: number of rows of the study."""
    group = file.create_group("histories")
    group.attrs["digits"] = digits = max(4, len(str(rows - 1)))
    wanted = dict.fromkeys(name for word in words for name in WORDS[word])
    for source in sources:
        target = group.create_group(f"{source.row:0{digits}}")
        with source.archive.read(source.kept) as image:
            for name in wanted:
                if name in image:  # with sampled responses, energies are not known
                    image.copy(name, target)
        name_dimensions(target)


def name_dimensions(impact: h5py.Group) -> None:
    """Names the dimensions of the records of an impact: their times, and the components of vectors and stresses."""
    for place in (place for place in names_in(impact).values() if place.measure is None):
        time, data = impact[place.time], impact[place.values]
        if not h5py.h5ds.is_scale(time.id):
            time.make_scale("time")
            time.attrs["units"] = time.attrs["unit"]
        scales = [time]
        if data.ndim == 2:
            word = {3: "component", 6: "stress_component"}[data.shape[1]]
            scales.append(dimensions.of_length(impact, word, data.shape[1]))
        dimensions.name(data, scales, data.attrs["unit"])


class Record(NamedTuple):
    """A quantity over time."""

    #: (k) [s]
    time: Floats
    #: (k) or (k,3), in world axes; stress of a gauge (k,6), in the axes of its body
    values: Floats
    unit: str


class Place(NamedTuple):
    """Where the file of an impact has a record."""

    values: str
    time: str
    #: makes the record of the values; none: it is the values
    measure: Callable[[Floats], Floats] | None = None


#: names of components by their number: of a vector, and of a stress
COMPONENTS = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "yz", "xz", "xy")}


def names_in(group: h5py.Group) -> dict[str, Place]:
    """The records of an impact by name: "force", "receivers.NAME", "acceleration.NAME", "gauges.NAME.stress",
    "gauges.NAME.von_mises", "gauges.NAME.strain", "bodies.NAME", "energy.TERM"."""
    found = {}
    if "contact" in group:
        found["force"] = Place("contact/total_force", "contact/time")
    for name, place, values, time, measure in (
        ("receivers.{}", "receivers", "velocity", "receivers/time", None),
        ("acceleration.{}", "receivers", "acceleration", "receivers/time", None),
        ("gauges.{}.stress", "gauges", "stress", "gauges/time", None),
        ("gauges.{}.von_mises", "gauges", "stress", "gauges/time", von_mises),
        ("gauges.{}.strain", "gauges", "strain", "gauges/time", None),
        ("bodies.{}", "bodies", "velocity", "time", None),
    ):
        for of, member in group.get(place, {}).items():
            if isinstance(member, h5py.Group) and values in member:
                found[name.format(of)] = Place(f"{place}/{of}/{values}", time, measure)
    for term in group.get("energy", {}):
        found[f"energy.{term}"] = Place(f"energy/{term}", "time")
    return found


def read(file: h5py.File, row: int, name: str) -> Record:
    """The record `name` of a row; with the name of a component at its end, such as .x, this component. Raises
    InputError."""
    histories = file.get("histories")
    if histories is None:
        raise not_kept(file.filename, name)
    group = histories.get(f"{row:0{histories.attrs['digits']}}")
    if group is None:
        raise InputError(f"{file.filename}: impact {row} has no records: it was refused, failed or not run")
    found = names_in(group)
    base, _, component = name.rpartition(".")
    is_component = name not in found and any(component in names for names in COMPONENTS.values())
    place = found.get(base if is_component else name)
    if place is None:
        raise InputError(f'{file.filename}: there is no record "{name}"{meant(name, found, "there are")}')
    data = group[place.values]
    unit = data.attrs["unit"]
    text = unit.decode() if isinstance(unit, bytes) else str(unit)
    values = place.measure(data[:]) if place.measure else data[:]
    if is_component:
        names = components_of(values)
        if not names:
            raise InputError(f'{file.filename}: "{base}" has no components: leave .{component} out')
        if component not in names:
            raise InputError(f'{file.filename}: "{base}" has no .{component}: give .{", .".join(names)}')
        values = values[:, names.index(component)]
    return Record(np.asarray(group[place.time][:]), np.asarray(values), text)


def components_of(values: Floats) -> tuple[str, ...]:
    """The names of the components of a record; none if it has a number for each time."""
    return COMPONENTS[values.shape[1]] if values.ndim == 2 else ()


def not_kept(study: object, name: str) -> InputError:
    """The complaint about a record that the study does not keep."""
    word = name.partition(".")[0]
    return InputError(
        f'{study}: keep has no "{word}": add keep = ["{word}"] to the study, and the same command runs its '
        "impacts once more"
    )
