# SPDX-License-Identifier: BSD-2-Clause
"""Tables of the modes in a kernel file: frequency, damping, effective mass and contribution at the contact."""
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ricochet import files
from ricochet.arrays import Floats
from ricochet.result_file import File, expected

DISPLAYED = 30  # rows shown in a notebook
COLUMNS = [
    "body",
    "mode",
    "frequency_hz",
    "damping_ratio",
    *(f"participation_{axis}" for axis in "xyz"),  # √kg
    *(f"effective_mass_{axis}_kg" for axis in "xyz"),
    "contact_share",
]


@dataclass(repr=False)
class ModalTable:
    """The N modes of a body. Rigid modes come first.

    With mass-normalised shapes φ, the participation factor of mode n along axis e is Γ = φᵀ M e, and its
    effective mass is Γ². The effective masses of all modes of a free body add up to its mass. `contact_share`
    is the share of the mode in the static flexibility of the contact, tr(B_n B_nᵀ / ω²) / tr F, with the
    normal displacement B_n of the candidates and F = Σ B_n B_nᵀ / ω² + R. It is NaN for rigid modes and if
    there are no candidates.
    """

    body: str
    basis: str  # "modes", or "contact" for a contact-adapted basis, whose vectors are not modes of the body
    mass: float  # [kg]
    frequency_hz: Floats  # (N)
    damping: Floats  # (N) damping ratio; NaN for rigid modes
    participation: Floats  # (N,3) [√kg]
    contact_share: Floats  # (N)
    residual_share: float  # share of the residual flexibility R in the contact flexibility

    @property
    def effective_mass(self) -> Floats:
        """(N,3) [kg]"""
        return self.participation**2

    @property
    def elastic_share(self) -> float:
        """The share of all modes in the contact flexibility; NaN if there are no candidates."""
        known = self.contact_share[np.isfinite(self.contact_share)]
        return float(known.sum()) if known.size else float("nan")

    @classmethod
    def read(cls, path: Path) -> "ModalTable":
        """Reads a kernel file. Raises InputError."""
        with expected(path, "ricochet-kernel"):
            file = File(path, "ricochet-kernel")
            omega = file.array("/modes/angular_frequency", None)
            count = len(omega)
            elastic = omega > 0
            decay = file.array("/modes/decay_rate", count)
            shares, residual = contact_shares(file, omega)
            return cls(
                body=file.text("/", "body") or "body",
                basis=file.text("/modes", "basis") or "modes",
                mass=float(file.attribute("/", "mass")),
                frequency_hz=omega / (2 * np.pi),
                damping=np.divide(decay, omega, out=np.full(count, np.nan), where=elastic),
                participation=file.array("/loads/body_force", 3, count).T,
                contact_share=shares,
                residual_share=residual,
            )

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes all modes, one row each. Raises InputError."""
        write_csv([self], Path(path))

    def __repr__(self) -> str:
        return self.text(len(self.frequency_hz))

    def _repr_html_(self) -> str:
        head = (
            "<th>mode</th><th>frequency [Hz]</th><th>damping [%]</th>"
            '<th colspan="3">effective mass along x, y, z [% of the mass]</th><th>contact flexibility [%]</th>'
        )
        share = self.effective_mass / self.mass
        rows = ""
        for n, frequency in enumerate(self.frequency_hz[:DISPLAYED]):
            shares = [self.damping[n], *share[n], self.contact_share[n]]
            cells = [str(n + 1), f"{frequency:.6g}", *(cell(value, 0) for value in shares)]
            rows += "<tr>" + "".join(f"<td>{text}</td>" for text in cells) + "</tr>"
        more = len(self.frequency_hz) - DISPLAYED
        note = f"<p>and {more} more</p>" if more > 0 else ""
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{note}"

    def rows(self) -> Iterator[list[Any]]:
        """The rows of the CSV file: the values of COLUMNS for each mode."""
        for n, frequency in enumerate(self.frequency_hz):
            axes = [*self.participation[n], *self.effective_mass[n]]
            numbers = [frequency, self.damping[n], *axes, self.contact_share[n]]
            yield [self.body, n + 1, *(float(value) if np.isfinite(value) else "" for value in numbers)]

    def text(self, first: int) -> str:
        """The table of the first modes, for a terminal."""
        what = "modes" if self.basis == "modes" else "vectors of a contact-adapted basis"
        lines = [f"{self.body}: {len(self.frequency_hz)} {what}, mass {self.mass:.4g} kg"]
        lines.append("mode   frequency   damping  effective mass (% of the mass)   contact flexibility")
        lines.append("              Hz         %         x         y         z                     %")
        share = 100 * self.effective_mass / self.mass
        for n, frequency in enumerate(self.frequency_hz[:first]):
            masses = "".join(f"{value:10.3f}" for value in share[n])
            damping, contact = cell(self.damping[n], 10), cell(self.contact_share[n], 22)
            lines.append(f"{n + 1:4d}{frequency:12.6g}{damping}{masses}{contact}")
        if len(self.frequency_hz) > first:
            lines.append(f"      and {len(self.frequency_hz) - first} more: --first, --csv")
        total = "".join(f"{value:10.3f}" for value in share.sum(axis=0))
        lines.append(f"{'sum of all':26}{total}{cell(self.elastic_share, 22)}")
        if self.residual_share > 0:
            lines.append(f"{'residual flexibility':56}{cell(self.residual_share, 22)}")
        return "\n".join(lines)


def cell(share: float, width: int) -> str:
    """A share as text, in per cent."""
    return f"{100 * share:{width}.3f}" if np.isfinite(share) else "–".rjust(width)


def contact_shares(file: File, omega: Floats) -> tuple[Floats, float]:
    """The shares of each mode and of R in the trace of the contact flexibility."""
    normal = file.array("/surface/normal", None, 3)
    points, count = len(normal), len(omega)
    direction = file.attribute("/surface/shape", "direction")
    if direction is None:
        shape = np.einsum("mc,mcn->mn", normal, file.array("/surface/shape", points, 3, count))
    else:
        shape = file.array("/surface/shape", points, count) * np.sign(normal @ direction)[:, None]
    elastic = omega > 0
    own = np.divide((shape**2).sum(axis=0), omega**2, out=np.zeros(count), where=elastic)
    rest, compressed = 0.0, "/surface/compressed_flexibility"
    if file.has("/surface/residual_flexibility"):
        normal_only = file.attribute("/surface/residual_flexibility", "components") is not None
        three = direction is None and not normal_only
        name = "/surface/residual_flexibility"
        if three:
            rest = float(np.einsum("ma,mab,mb->", normal, file.diagonal(name, points, 3), normal))
        else:
            rest = float(file.diagonal(name, points, 1).sum())
    elif file.has(f"{compressed}/global"):
        pressed = file.array(f"{compressed}/global", 3 * points, None).reshape(points, 3, -1)
        first = file.array(f"{compressed}/near_first", points + 1)
        # The first block of a candidate is its own.
        some = np.flatnonzero(np.diff(first) > 0)
        blocks = file.array(f"{compressed}/near_block", None, 3, 3)[first[some]]
        rest = float((np.einsum("mak,ma->mk", pressed, normal) ** 2).sum())
        rest += float(np.einsum("ma,mab,mb->", normal[some], blocks, normal[some]))
    total = own.sum() + rest
    if not points or total <= 0:
        return np.full(count, np.nan), 0.0
    return np.where(elastic, own / total, np.nan), rest / total


def write_csv(tables: list[ModalTable], path: Path) -> None:
    """Writes the modes of all bodies. Raises InputError."""
    with files.writing(path, "--csv"):
        files.write_csv(path, COLUMNS, [row for table in tables for row in table.rows()])
