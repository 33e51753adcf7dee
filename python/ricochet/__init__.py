# SPDX-License-Identifier: BSD-2-Clause
"""Impact of elastic bodies, from Python: scenes, kernels, impacts, studies and pictures.

    import ricochet

    scene = ricochet.Scene("meshes/two-disks/two-disks.toml")
    ricochet.kernels(scene)
    result = ricochet.impact(scene)
    result.total_force

docs/python.md describes the interface. Names are loaded on first use, because the command needs few of them.
"""

import importlib
import pkgutil
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ricochet._core import __version__
    from ricochet.errors import InputError, RicochetError, SolverError
    from ricochet.kernel import Kernel
    from ricochet.named_materials import materials
    from ricochet.result import Result
    from ricochet.runs import impact, kernels, plot, report, sweep
    from ricochet.scene import Scene
    from ricochet.shock import ShockResponse, cfc_filter, shock_response_spectrum
    from ricochet.simulation import Pickup, Simulation, State
    from ricochet.stress import StressEnvelope, principal_stresses, von_mises
    from ricochet.sweep_result import SweepResult

__all__ = [
    "InputError",
    "Kernel",
    "Pickup",
    "Result",
    "RicochetError",
    "Scene",
    "ShockResponse",
    "Simulation",
    "State",
    "SolverError",
    "StressEnvelope",
    "SweepResult",
    "__version__",
    "cfc_filter",
    "impact",
    "kernels",
    "materials",
    "plot",
    "principal_stresses",
    "report",
    "shock_response_spectrum",
    "sweep",
    "von_mises",
]

_PLACES = {
    "_core": ["__version__"],
    "errors": ["InputError", "RicochetError", "SolverError"],
    "kernel": ["Kernel"],
    "named_materials": ["materials"],
    "result": ["Result"],
    "runs": ["impact", "kernels", "plot", "report", "sweep"],
    "scene": ["Scene"],
    "shock": ["ShockResponse", "cfc_filter", "shock_response_spectrum"],
    "simulation": ["Pickup", "Simulation", "State"],
    "stress": ["StressEnvelope", "principal_stresses", "von_mises"],
    "sweep_result": ["SweepResult"],
}
_PLACE = {name: place for place, names in _PLACES.items() for name in names}

__path__ = pkgutil.extend_path(__path__, __name__)  # in a checkout, the module is in the build folder

_complaint = importlib.import_module("ricochet.interpreter").complaint(__path__)
if _complaint:
    if sys.argv[:1] == ["-m"]:  # python -m ricochet: a traceback would hide the line
        print(f"ricochet: {_complaint}", file=sys.stderr)
        raise SystemExit(2)
    raise ImportError(_complaint)


def __getattr__(name: str) -> Any:
    if name not in _PLACE:
        raise AttributeError(f"module 'ricochet' has no attribute {name!r}")
    return getattr(importlib.import_module(f"ricochet.{_PLACE[name]}"), name)


def __dir__() -> list[str]:
    return __all__
