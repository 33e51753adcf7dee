# SPDX-License-Identifier: BSD-2-Clause
"""Writes K and M of a clamped bar of unit length, stiffness and density as files of PETSc: eps_matrices.py FOLDER"""
import math
import struct
import sys
from pathlib import Path

N = 200  # unknowns of linear elements


def write_matrix(path, below, diagonal):
    """Writes a tridiagonal matrix in PETSc's binary format."""
    rows, columns, values = [], [], []
    for i in range(N):
        here = [k for k in (i - 1, i, i + 1) if 0 <= k < N]
        rows.append(len(here))
        columns += here
        values += [diagonal if k == i else below for k in here]
    head = [1211216, N, N, len(values), *rows, *columns]
    path.write_bytes(struct.pack(f">{len(head)}i{len(values)}d", *head, *values))


def write(folder):
    """Writes K.petsc and M.petsc."""
    h = 1 / (N + 1)
    write_matrix(folder / "K.petsc", -1 / h, 2 / h)
    write_matrix(folder / "M.petsc", h / 6, 4 * h / 6)


def exact(number):
    """Eigenvalue `number`, from 1: 6/h² (1 − cos θ)/(2 + cos θ)"""
    angle = math.pi * number / (N + 1)
    return 6 * (N + 1) ** 2 * (1 - math.cos(angle)) / (2 + math.cos(angle))


if __name__ == "__main__":
    write(Path(sys.argv[1]))
