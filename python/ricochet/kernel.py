# SPDX-License-Identifier: BSD-2-Clause
"""Kernels as NumPy arrays: the modes of a body and the flexibility of its contact surface."""

from __future__ import annotations

import html
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ricochet import _core

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Certificate:
    """The proof that no mode is missing; of a basis fitted to contact, the error that it met
    (kernels/FORMAT.md)."""

    below: int  #: modes below the interval that was searched
    upto_hz: float  #: upper end of the interval [Hz]
    count_by_inertia: int  #: modes in it by the Sturm-sequence count
    count_found: int  #: modes found in it
    left_out: int  #: of these, modes that the kernel leaves to the residual flexibility
    complete: bool  #: counts agree and all errors are within their bounds
    orthonormality: float  #: max |Φᵀ M Φ − I|
    flexibility_error: float  #: relative, of the contact surface over the band; 0 if no bound was set
    approximate: int  #: block iterations in place of the certified search; 0: none


@dataclass(frozen=True)
class Skin:
    """The visible surface of a body in its own axes. V nodes, E elements of k corners, N modes."""

    node: Array  #: (V,3) [m]
    element: NDArray[np.int64]  #: (E,k), k = 3 triangles or 2 segments
    shape: NDArray[np.float32]  #: (V,3,N) [kg^-1/2]


@dataclass(frozen=True)
class KernelReceiver:
    """A point whose motion is recorded, in the body's own axes."""

    point: Array  #: (3) [m]
    shape: Array  #: (3,N) [kg^-1/2]


class Kernel:
    """The kernel of one body. Arrays are read-only views of the kernel's memory.

    N modes, M candidate points, c components (3, or 1 where the scene fixes the direction of contact). SI
    units; axes are the body's own: the mesh after `scale`, before rotation and translation. A mode is
    normalised by mass, φᵀ M φ = 1, so that shapes have the unit kg^-1/2.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Reads a kernel file. Raises InputError, one line, for a missing, damaged or foreign file."""
        self.path = Path(path)
        self._core = _core.read_kernel(self.path)

    @property
    def body(self) -> str:
        """The scene's name for the body."""
        return self._core.body

    @property
    def hash(self) -> str:
        """SHA-256 of all that the kernel depends on: equal hash, equal kernel."""
        return self._core.hash

    @property
    def basis(self) -> str:
        """`modes` (certified), `approximate modes`, `contact` (fitted to contact), or `imported`."""
        return self._core.basis

    @property
    def certificate(self) -> Certificate:
        return Certificate(**self._core.certificate)  # type: ignore[arg-type]

    # ---- Body ----

    @property
    def mass(self) -> float:
        """[kg]"""
        return self._core.mass

    @property
    def centre(self) -> Array:
        """(3) centre of mass [m]"""
        return self._core.centre

    @property
    def inertia(self) -> Array:
        """(3,3) about the centre of mass [kg m²]"""
        return self._core.inertia

    @property
    def is_supported(self) -> bool:
        """Whether a support holds some displacement."""
        return self._core.supported

    @property
    def dofs(self) -> int:
        """Unknowns of the finite-element model."""
        return self._core.dofs

    @property
    def elements(self) -> int:
        """Elements of the finite-element model."""
        return self._core.elements

    @property
    def order(self) -> int:
        """Order of the elements."""
        return self._core.order

    # ---- Modes ----

    @property
    def angular_frequency(self) -> Array:
        """(N) ω [rad/s], ascending; rigid modes first, exactly 0"""
        return self._core.angular_frequency

    @property
    def frequency(self) -> Array:
        """(N) ω/2π [Hz]"""
        return self.angular_frequency / (2 * np.pi)

    @property
    def decay_rate(self) -> Array:
        """(N) δ = ζω [1/s]"""
        return self._core.decay_rate

    @property
    def residual(self) -> Array:
        """(N) ‖Kφ − ω²Mφ‖ / ‖Kφ‖ [1]"""
        return self._core.residual

    @property
    def body_force(self) -> Array:
        """(3,N) φᵀ M e_i, the modal force of a uniform acceleration along each axis [kg^1/2]"""
        return self._core.body_force

    @property
    def rotation(self) -> Array:
        """(3,N) φᵀ M (e_i × x), the angular momentum about the origin [kg^1/2 m]"""
        return self._core.rotation

    @property
    def modes(self) -> ModeTable:
        """A table of the modes, which a notebook shows as one."""
        return ModeTable(self)

    # ---- Contact surface ----

    @property
    def node(self) -> Array:
        """(M,3) candidate points [m]"""
        return self._core.node

    @property
    def centroid(self) -> Array:
        """(M,3) means of the candidates' patches, from which gaps are measured [m]"""
        return self._core.centroid

    @property
    def normal(self) -> Array:
        """(M,3) outward unit normals"""
        return self._core.normal

    @property
    def area(self) -> Array:
        """(M) areas of the patches [m²]"""
        return self._core.area

    @property
    def group(self) -> list[str]:
        """The physical surface that each candidate belongs to, M names."""
        return self._core.group

    @property
    def element(self) -> NDArray[np.int64]:
        """(T,k) elements of the surface by index of candidate: k = 3 triangles, 2 segments, 1 points"""
        return self._core.element

    @property
    def direction(self) -> Array | None:
        """(3) the one direction along which c = 1 components are kept; None where c = 3"""
        return self._core.direction

    @property
    def shape(self) -> Array:
        """(M,c,N) means of the modes over the patches [kg^-1/2]"""
        return self._core.shape

    @property
    def residual_flexibility(self) -> Array | None:
        """(cM,cM) R, the static flexibility of all that the modes leave out [m/N], index c·i + component;
        None where the scene does without"""
        return self._core.residual_flexibility

    @property
    def normal_shape(self) -> Array:
        """(M,N) modes along the normals, or along `direction` [kg^-1/2]"""
        if self.direction is not None:
            return self.shape[:, 0, :]
        return np.asarray(np.einsum("mc,mcn->mn", self.normal, self.shape))

    # ---- Others ----

    @property
    def receivers(self) -> dict[str, KernelReceiver]:
        return {name: KernelReceiver(*values) for name, values in self._core.receivers.items()}

    @property
    def skin(self) -> Skin | None:
        """The visible surface; None unless the scene has `output.view = true`."""
        return Skin(*self._core.skin) if self._core.skin else None

    def __repr__(self) -> str:
        content = f"{len(self.angular_frequency)} {self.basis}, {len(self.area)} candidates"
        return f"<Kernel of {self.body!r}: {content}; {self.path}>"

    def _repr_html_(self) -> str:
        facts = {
            "mass": f"{self.mass:.4g} kg",
            "model": f"{self.elements} elements of order {self.order}, {self.dofs} unknowns",
            "basis": f"{len(self.angular_frequency)} {self.basis}, up to {self.frequency[-1]:.6g} Hz",
            "candidates": str(len(self.area)),
        }
        rows = "".join(
            f"<tr><th>{name}</th><td>{html.escape(text)}</td></tr>" for name, text in facts.items()
        )
        return f"<b>{html.escape(self.body)}</b><table>{rows}</table>"


class ModeTable:
    """A row for each mode of a kernel. N modes."""

    #: rows that a notebook shows
    SHOWN = 30

    def __init__(self, kernel: Kernel) -> None:
        omega = kernel.angular_frequency
        elastic = np.where(omega > 0, omega, np.inf)
        square = (kernel.normal_shape**2).mean(axis=0)
        #: (N) [Hz]
        self.frequency: Array = kernel.frequency
        #: (N) ζ; 0 for rigid modes
        self.damping_ratio: Array = kernel.decay_rate / elastic
        #: (N,3) (φᵀ M e_i)² [kg]; for a free body the sum over all modes is the mass, along each axis
        self.effective_mass: Array = kernel.body_force.T**2
        #: (N) static compliance of the contact surface, mean over the candidates of (n·φ)²/ω² [m/N];
        #: 0 for rigid modes
        self.contact_compliance: Array = square / elastic**2
        self._mass = kernel.mass

    def __len__(self) -> int:
        return len(self.frequency)

    def table(self) -> Array:
        """(N,6): frequency [Hz], damping ratio, effective mass along x, y, z [kg], compliance [m/N]"""
        columns = [self.frequency, self.damping_ratio, *self.effective_mass.T, self.contact_compliance]
        return np.stack(columns, axis=1)

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes all rows, with the number of each mode from 1 on. Raises OSError where it cannot."""
        head = "mode,frequency_hz,damping_ratio," + "".join(f"effective_mass_{axis}_kg," for axis in "xyz")
        rows = [",".join([str(n), *map(repr, row)]) for n, row in enumerate(self.table().tolist(), 1)]
        text = "\n".join([head + "contact_compliance_m_per_n", *rows, ""])
        Path(path).write_text(text, "utf-8")

    def _cells(self) -> list[list[str]]:
        """Texts for people: a mass that round-off explains is 0."""
        out = []
        for n, (frequency, damping, *masses, compliance) in enumerate(self.table().tolist(), 1):
            shown = [mass if mass > 1e-12 * self._mass else 0.0 for mass in masses]
            out.append([str(n), f"{frequency:.6g}", *(f"{x:.3g}" for x in [damping, *shown, compliance])])
        return out

    def __repr__(self) -> str:
        head = ["mode", "Hz", "damping", "mass x [kg]", "mass y [kg]", "mass z [kg]", "compliance [m/N]"]
        widths = [max(10, len(name)) for name in head]
        return "\n".join(
            "  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in [head, *self._cells()]
        )

    def _repr_html_(self) -> str:
        names = ["mode", "frequency [Hz]", "damping ratio", "compliance at the contact [m/N]"]
        cells = [f"<th>{name}</th>" for name in names]
        cells.insert(3, '<th colspan="3">effective mass along x, y, z [kg]</th>')
        body = "".join(
            "<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>"
            for row in self._cells()[: self.SHOWN]
        )
        more = f"<p>{len(self) - self.SHOWN} more</p>" if len(self) > self.SHOWN else ""
        return f"<table><thead><tr>{''.join(cells)}</tr></thead><tbody>{body}</tbody></table>{more}"
