# SPDX-License-Identifier: BSD-2-Clause
"""Uses the shared library through ctypes: python3 shared.py PREFIX KERNEL. KERNEL is that of a bob of 4 kg."""

import ctypes
import pathlib
import subprocess
import sys

prefix, kernel_file = pathlib.Path(sys.argv[1]), sys.argv[2]
library = next(prefix.glob("lib/**/libricochet.so"))
ricochet = ctypes.CDLL(str(library))
for name in ("kernel_load", "scene_new", "simulation_new", "simulation_force"):
    getattr(ricochet, f"ricochet_{name}").restype = ctypes.c_void_p
ricochet.ricochet_error.restype = ctypes.c_char_p
ricochet.ricochet_simulation_pickup_velocity.restype = ctypes.c_double


class Block(ctypes.Structure):
    _fields_ = [
        (name, ctypes.POINTER(ctypes.c_double))
        for name in ("velocity", "total_force", "force", "displacement", "tangential_force")
    ]


def vector(*values):
    return (ctypes.c_double * len(values))(*values)


def refused(status):
    assert not status, ricochet.ricochet_error().decode()


assert ricochet.ricochet_version() == 100
assert ricochet.ricochet_kernel_load(b"nowhere.h5") is None
assert b"nowhere.h5" in ricochet.ricochet_error()

kernel = ctypes.c_void_p(ricochet.ricochet_kernel_load(kernel_file.encode()))
scene = ctypes.c_void_p(ricochet.ricochet_scene_new(ctypes.c_double(1000)))
refused(ricochet.ricochet_scene_body(scene, b"bob", kernel, None, None, vector(0, 0, -2)))
refused(ricochet.ricochet_scene_half_space(scene, b"floor", vector(0, 0, 0), vector(0, 0, 1)))
refused(ricochet.ricochet_scene_pair(scene, b"bob", b"floor", None, vector(1e-3), None))
refused(ricochet.ricochet_scene_pickup(scene, b"bob", None, ctypes.c_size_t(0), vector(0, 0, 1)))
refused(ricochet.ricochet_scene_impulse(scene, 0, ctypes.c_double(0.5)))
simulation = ctypes.c_void_p(ricochet.ricochet_simulation_new(scene))
ricochet.ricochet_kernel_free(kernel)
ricochet.ricochet_scene_free(scene)

force = vector(*[0] * 10)
block = Block(total_force=force)
refused(ricochet.ricochet_simulation_step_block(simulation, ctypes.c_int64(10), ctypes.byref(block)))
velocity = ricochet.ricochet_simulation_pickup_velocity(simulation, ctypes.c_size_t(0))
assert abs(velocity - 1) < 1e-9, velocity  # restitution 0.5 at 2 m/s
assert abs(sum(force) / 1000 - 4 * 3) < 1e-8, list(force)  # the change of momentum
ricochet.ricochet_simulation_free(simulation)

exported = subprocess.run(
    ["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True
).stdout
names = [line.split()[-1] for line in exported.splitlines()]
assert names and all(name.startswith("ricochet_") for name in names), names
