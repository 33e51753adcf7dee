# SPDX-License-Identifier: BSD-2-Clause
"""The sound of receivers for a page: one channel of 16 bits, limited in length."""
import base64
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.result_file import is_there

SAMPLES = 700_000  # maximum number of samples of all receivers together: 1.9 MB in the page


def channels(path: Path, most: int, run: str | None) -> tuple[Array, int, int]:
    """The first samples (n,3) of a WAV file of ricochet-contact, the sample rate, and the total number of
    samples. Raises InputError if its comment names another run than `run`."""
    refusal = InputError(f"{path}: is not a sound that ricochet-contact wrote. Run it again.")
    with open(path, "rb") as file:
        riff = file.read(12)
        if riff[:4] != b"RIFF" or riff[8:] != b"WAVE":
            raise refusal
        shape = None
        while len(head := file.read(8)) == 8:
            name, size = head[:4], struct.unpack("<I", head[4:])[0]
            if name == b"data" and shape:
                total = min(size, path.stat().st_size - file.tell()) // 12
                return np.fromfile(file, "<f4", 3 * min(total, most)).reshape(-1, 3), shape[2], total
            if name == b"fmt " and size >= 16:
                shape = struct.unpack("<HHIIHH", file.read(16).ljust(16, b"\0"))
                if shape[0] not in (3, 0xFFFE) or shape[1] != 3 or shape[5] != 32 or shape[2] == 0:
                    raise refusal
                size -= 16
            if name == b"LIST":  # contains the comment
                theirs = re.search(rb"; run ([0-9a-f]{16})", file.read(min(size, 4096)))
                if run and theirs and theirs[1].decode() != run:
                    raise InputError(
                        f"{path}: is of the run {theirs[1].decode()}, and the result of the run {run}. Repeat the run."
                    )
                size -= min(size, 4096)
            file.seek(size + size % 2, 1)
    raise refusal


def sound_of(path: Path, most: int, run: str | None = None) -> dict[str, Any]:
    """The channel with the largest motion, as a WAV file in base64."""
    samples, rate, total = channels(path, most, run)
    if not np.isfinite(samples).all():
        raise InputError(f"{path}: holds samples that are not finite. Run ricochet-contact again.")
    axis = int(np.argmax(np.ptp(samples, axis=0))) if len(samples) else 0
    data = np.rint(32767 * np.clip(samples[:, axis], -1, 1)).astype("<i2").tobytes()
    form = struct.pack("<HHIIHH", 1, 1, rate, 2 * rate, 2, 16)
    head = struct.pack("<4sI4s4sI", b"RIFF", 36 + len(data), b"WAVE", b"fmt ", len(form)) + form
    head += struct.pack("<4sI", b"data", len(data))
    return {
        "axis": "xyz"[axis],
        "rate_hz": rate,
        "seconds": len(samples) / rate,
        "of_seconds": total / rate,
        "wav": base64.b64encode(head + data).decode(),
    }


def sounds_of(summary: dict[str, Any], folder: Path, run: str | None) -> dict[str, Any]:
    """The sound of each receiver for which the summary names a file, or {"missing": reason} if that file does
    not exist. Raises InputError if a file is of another run than `run`."""
    out = {}
    named = summary.get("sounds") or {}
    for name, sound in named.items():
        path = folder / Path(sound["file"]).name
        out[name] = {"missing": f"there is no file {path.name}"}
        if is_there(path):
            out[name] = sound_of(path, SAMPLES // len(named), run)
    return out
