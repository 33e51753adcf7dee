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
from ricochet.arrays import Floats
from ricochet.forwarding import of_core
from ricochet.modal_table import ModalTable


@dataclass(frozen=True)
class Certificate:
    """The proof that no mode is missing, or the error estimate of a contact-adapted basis
    (docs/formats/kernel.md)."""

    below: int  #: number of modes below the interval that was searched
    upto_hz: float  #: upper end of the interval [Hz]
    count_by_inertia: int  #: number of modes in the interval by the Sturm-sequence count
    count_found: int  #: number of modes found in the interval
    left_out: int  #: number of modes found but left to the residual flexibility
    complete: bool  #: the counts agree and all errors are within their bounds
    orthonormality: float  #: max |Φᵀ M Φ − I|
    flexibility_error: float  #: relative error of the contact flexibility over the band; 0 if there is no bound


@dataclass(frozen=True)
class VisualisationSurface:
    """The outer surface of a body, in its own axes. V nodes, E elements of k corners, N modes."""

    node: Floats  #: (V,3) [m]
    element: NDArray[np.int64]  #: (E,k); k = 3: triangles, k = 2: segments
    shape: NDArray[np.float32]  #: (V,3,N) [kg^-1/2]


@dataclass(frozen=True)
class KernelReceiver:
    """A point whose motion is recorded, in the axes of the body."""

    point: Floats  #: (3) [m]
    shape: Floats  #: (3,N) [kg^-1/2]


class Kernel:
    """The kernel of one body. Arrays are read-only views of the kernel's memory.

    N modes, M candidates, c components (3, or 1 if the scene fixes the direction of contact). SI units. The
    axes are those of the body: of the mesh after `scale`, before rotation and translation. Modes are
    normalised by mass, φᵀ M φ = 1, so that shapes have the unit kg^-1/2.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Reads a kernel file. Raises InputError, one line, for a file that is missing, damaged or not a
        kernel."""
        self.path = Path(path)
        self._core = _core.read_kernel(self.path)

    body: str = of_core("body", "The scene's name for the body.")
    hash: str = of_core("hash", "SHA-256 of all that the kernel depends on: equal hash, equal kernel.")
    basis: str = of_core("basis", "`modes` (certified), `contact` (fitted to contact), or `imported`.")

    @property
    def certificate(self) -> Certificate:
        return Certificate(**self._core.certificate)  # type: ignore[arg-type]

    # ---- Body ----

    mass: float = of_core("mass", "[kg]")
    centre: Floats = of_core("centre", "(3) centre of mass [m]")
    inertia: Floats = of_core("inertia", "(3,3) about the centre of mass [kg m²]")
    is_supported: bool = of_core("supported", "Whether a support holds some displacement.")
    dofs: int = of_core("dofs", "Unknowns of the finite-element model.")
    elements: int = of_core("elements", "Elements of the finite-element model.")
    order: int = of_core("order", "Order of the elements.")

    # ---- Modes ----

    angular_frequency: Floats = of_core(
        "angular_frequency", "(N) ω [rad/s], ascending; rigid modes first, exactly 0"
    )

    @property
    def frequency(self) -> Floats:
        """(N) ω/2π [Hz]"""
        return self.angular_frequency / (2 * np.pi)

    decay_rate: Floats = of_core("decay_rate", "(N) δ = ζω [1/s]")
    residual: Floats = of_core("residual", "(N) ‖Kφ − ω²Mφ‖ / ‖Kφ‖ [1]")
    body_force: Floats = of_core(
        "body_force", "(3,N) φᵀ M e_i, the modal force of a uniform acceleration along each axis [kg^1/2]"
    )
    rotation: Floats = of_core(
        "rotation", "(3,N) φᵀ M (e_i × x), the angular momentum about the origin [kg^1/2 m]"
    )

    @property
    def modes(self) -> ModalTable:
        """A table of the modes, which a notebook displays. Raises InputError if the file is gone."""
        return ModalTable.read(self.path)

    # ---- Contact surface ----

    node: Floats = of_core("node", "(M,3) candidate points [m]")
    centroid: Floats = of_core(
        "centroid", "(M,3) points of the candidates' patches from which gaps are measured [m]"
    )
    normal: Floats = of_core("normal", "(M,3) outward unit normals")
    area: Floats = of_core("area", "(M) areas of the patches [m²]")
    group: list[str] = of_core("group", "The physical surface that each candidate belongs to, M names.")
    element: NDArray[np.int64] = of_core(
        "element",
        "(T,k) elements of the surface by index of candidate: k = 3 triangles, 2 segments, 1 points",
    )
    direction: Floats | None = of_core(
        "direction", "(3) the one direction along which c = 1 components are kept; None where c = 3"
    )
    shape: Floats = of_core("shape", "(M,c,N) means of the modes over the patches [kg^-1/2]")
    residual_flexibility: Floats | None = of_core(
        "residual_flexibility",
        "(cM,cM) R, the static flexibility of all that the modes leave out [m/N], index c·i + component; "
        "(M,M) if it is stored along the normals, in single precision for bodies that turn; "
        "None where the scene does without, or compressed",
    )

    @property
    def normal_shape(self) -> Floats:
        """(M,N) modes along the normals, or along `direction` [kg^-1/2]"""
        if self.direction is not None:
            return self.shape[:, 0, :]
        return np.asarray(np.einsum("mc,mcn->mn", self.normal, self.shape))

    # ---- Others ----

    @property
    def receivers(self) -> dict[str, KernelReceiver]:
        return {name: KernelReceiver(*values) for name, values in self._core.receivers.items()}

    @property
    def visualisation_surface(self) -> VisualisationSurface | None:
        """The outer surface with its modes; None unless the scene has `output.view = true`."""
        surface = self._core.visualisation_surface
        return VisualisationSurface(*surface) if surface else None

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
