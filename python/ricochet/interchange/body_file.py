# SPDX-License-Identifier: BSD-2-Clause
"""Writes body files, the layout of docs/interchange.md, from matrices in coordinates; reads MatrixMarket."""

import io
import warnings

import h5py
import numpy as np

from ricochet import files


class Refused(Exception):
    """An input that is not what it should be; its text is one line."""


def numbers(path, text):
    """Of a text that has nothing else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # numpy's, of a text that goes on behind the numbers
        try:
            return np.fromstring(text, sep=" ")
        except DeprecationWarning:
            raise Refused(f"{path}: holds something that is no number where numbers are due") from None


def is_number(word):
    """Of a node or an element, or a count of them: int() takes more than digits, and not too many."""
    return word.isdecimal() and len(word) < 16


def is_name(text):
    """Whether a surface or support may be called so, in a body file and in a scene."""
    return text not in ("", ".", "..") and "/" not in text and text.isprintable()


def entries_of(path, values, rows, columns):
    """Rows and columns from 0, and values, of `values` that has the three of each entry in turn, numbered from 1."""
    table = values.reshape(-1, 3)
    wrong = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if wrong.size:
        raise Refused(f"{path}: entry {wrong[0] + 1} is {' '.join(f'{x:g}' for x in table[wrong[0]])}: must be finite numbers")
    wrong = np.flatnonzero(((table[:, :2] < 1) | (table[:, :2] > [rows, columns]) | (table[:, :2] % 1 != 0)).any(axis=1))
    if wrong.size:
        raise Refused(f"{path}: entry {wrong[0] + 1} is {' '.join(f'{x:.17g}' for x in table[wrong[0]])}: must be a row from 1 to "
                      f"{rows}, a column from 1 to {columns} and a value")
    return table[:, 0].astype(np.int64) - 1, table[:, 1].astype(np.int64) - 1, table[:, 2]


def read_matrix_market(path):
    """Rows, columns (from 0), values and shape of a real matrix in coordinates; of a symmetric one both triangles."""
    with open(path, "rb") as file:
        words = file.readline().decode("latin-1").lower().split()
        if words[:3] != ["%%matrixmarket", "matrix", "coordinate"] or words[3:4] not in (["real"], ["integer"]) or \
                words[4:5] not in (["general"], ["symmetric"]):
            raise Refused(f"{path}: begins with \"{' '.join(words[:6])[:60]}\": must be \"%%MatrixMarket matrix coordinate real\" "
                          "general or symmetric")
        line = file.readline()
        while line.startswith(b"%") or line.strip() == b"":
            if not line:
                raise Refused(f"{path}: ends before its sizes")
            line = file.readline()
        sizes = line.decode("latin-1").split()
        if len(sizes) != 3 or not all(is_number(size) for size in sizes):
            raise Refused(f"{path}: has sizes \"{' '.join(sizes)[:60]}\": must be rows, columns and entries")
        rows, columns, entries = (int(size) for size in sizes)
        values = numbers(path, file.read())
    if values.size != 3 * entries:
        raise Refused(f"{path}: has {values.size} numbers behind its sizes, expected {entries} entries of 3")
    found = entries_of(path, values, rows, columns)
    return (*(both_triangles(path, *found) if words[4] == "symmetric" else found), (rows, columns))


def both_triangles(path, i, j, value):
    """Of one triangle."""
    if (i < j).any() and (i > j).any():
        raise Refused(f"{path}: has entries of both triangles of a symmetric matrix: give one of them")
    off = i != j
    return np.concatenate([i, j[off]]), np.concatenate([j, i[off]]), np.concatenate([value, value[off]])


def rows_of(i, j, value, size):
    """Compressed rows, columns ascending; entries of one place add up."""
    order = np.lexsort((j, i))
    i, j, value = i[order], j[order], value[order]
    first = np.ones(i.size, bool)
    first[1:] = (i[1:] != i[:-1]) | (j[1:] != j[:-1])
    if i.size:
        value = np.add.reduceat(value, np.flatnonzero(first))
    start = np.zeros(size + 1, np.int64)
    np.cumsum(np.bincount(i[first], minlength=size), out=start[1:])
    return start, j[first].astype(np.int64), value


def clockwise(node, facets, i, j):
    """How many of `facets`, (T,k) node numbers from 0, run clockwise seen from outside, judged by the stiffness at rows i and
    columns j: the nodes that are coupled with all corners of a facet are those of its element, so they lie behind it."""
    corners = facets[:, :3 if np.shape(facets)[1] in (3, 6, 10) else 4]
    here = np.isin(i // 3, corners)
    pairs = np.unique((i[here] // 3) * len(node) + j[here] // 3)
    nodes, start = np.unique(pairs // len(node), return_index=True)
    coupled = {of: set(others.tolist()) for of, others in zip(nodes.tolist(), np.split(pairs % len(node), start[1:]))}
    count = 0
    for facet, corner in zip(facets.tolist(), corners.tolist()):
        behind = list(set.intersection(*(coupled.get(k, set()) for k in corner)).difference(facet))
        if behind:
            place = node[corner]
            inward = np.cross(place[2] - place[0], place[1] - place[-1])
            away = node[behind].mean(axis=0) - place.mean(axis=0)
            count += bool(inward @ away < -1e-6 * np.linalg.norm(inward) * np.linalg.norm(away))  # not where all is in one plane
    return count


def write_body(path, node, surfaces, matrices, supports=(), skin=None):
    """node (n,3) [m]; surfaces: name → list of facets, (T,k) node numbers from 0; matrices: "stiffness" and "mass" → rows,
    columns, values; supports: name → node numbers. The file has its name only when it is whole. Throws OSError."""
    image = io.BytesIO()  # HDF5 itself crashes on a full disk
    with h5py.File(image, "w") as file:
        file.attrs["format"] = np.bytes_("ricochet-body")
        file.attrs["version"] = 1
        file["node"] = np.asarray(node, float)
        for name, blocks in surfaces.items():
            for facets in blocks:
                file[f"surface/{name}/{np.shape(facets)[1]}"] = np.asarray(facets, np.int64)
        for name, nodes in dict(supports).items():
            file[f"nodes/{name}"] = np.asarray(nodes, np.int64)
        if skin is not None:
            file["skin"] = np.asarray(skin, np.int64)
        for name, (i, j, value) in matrices.items():
            for part, numbers in zip(("start", "column", "value"), rows_of(i, j, value, 3 * len(node))):
                file[f"{name}/{part}"] = numbers
    files.write(path, image.getbuffer())
