# SPDX-License-Identifier: BSD-2-Clause
"""Ricochet from Python: scenes, kernels, impacts, studies and pictures of them."""
import pkgutil

__path__ = pkgutil.extend_path(__path__, __name__)  # in a checkout the extension module lies in the build
