# SPDX-License-Identifier: BSD-2-Clause
"""Films of runs as binary glTF, which viewers of 3D models and Blender play: the motion, a field as colour, and contact
forces as arrows."""
