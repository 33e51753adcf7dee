"""Writes body files, the layout of docs/interchange.md, from matrices in coordinates; reads MatrixMarket."""

import io
import warnings

import h5py
import numpy as np

import whole_file


class Refused(Exception):
    """An input that is not what it should be; its text is one line."""


def numbers(text):
    """Of a text that has nothing else, up to where it does."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        return np.fromstring(text, sep=" ")


def read_matrix_market(path):
    """Rows, columns (from 0), values and shape of a real matrix in coordinates; of a symmetric one both triangles."""
    with open(path, "rb") as file:
        words = file.readline().decode("latin-1").lower().split()
        if words[:3] != ["%%matrixmarket", "matrix", "coordinate"] or words[3:4] not in (["real"], ["integer"]) or \
                words[4:5] not in (["general"], ["symmetric"]):
            raise Refused(f"{path}: begins with \"{' '.join(words[:6])}\": must be \"%%MatrixMarket matrix coordinate real\" "
                          "general or symmetric")
        line = file.readline()
        while line.startswith(b"%") or line.strip() == b"":
            if not line:
                raise Refused(f"{path}: ends before its sizes")
            line = file.readline()
        sizes = line.split()
        if len(sizes) != 3 or not all(size.isdigit() for size in sizes):
            raise Refused(f"{path}: has sizes \"{line.decode('latin-1').strip()}\": must be rows, columns and entries")
        rows, columns, entries = (int(size) for size in sizes)
        values = numbers(file.read())
    if values.size != 3 * entries:
        raise Refused(f"{path}: has {values.size} numbers behind its sizes, expected {entries} entries of 3")
    i, j = values[0::3].astype(np.int64) - 1, values[1::3].astype(np.int64) - 1
    if entries and (min(i.min(), j.min()) < 0 or i.max() >= rows or j.max() >= columns):
        raise Refused(f"{path}: has an entry outside of its {rows} rows and {columns} columns")
    return (*both_triangles(i, j, values[2::3], words[4] == "symmetric"), (rows, columns))


def both_triangles(i, j, value, one_triangle):
    if not one_triangle:
        return i, j, value
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
    whole_file.write(path, image.getbuffer())
