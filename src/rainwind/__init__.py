"""rainwind: rain-wind induced vibration of stay cables, and a bifurcation toolkit for smooth ODEs.

Everything a user needs is here: `import rainwind as rw`. Names are loaded when first used, so that the
import itself costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from rainwind.dynamics.attractors import Attractor as Attractor
    from rainwind.dynamics.attractors import attractor as attractor
    from rainwind.dynamics.attractors import attractors as attractors
    from rainwind.dynamics.collocation import Mesh as Mesh
    from rainwind.dynamics.curves import continue_fold as continue_fold
    from rainwind.dynamics.curves import continue_hopf as continue_hopf
    from rainwind.dynamics.diagram import diagram as diagram
    from rainwind.dynamics.diagram_results import Diagram as Diagram
    from rainwind.dynamics.energy import EnergyBalance as EnergyBalance
    from rainwind.dynamics.energy import energy_balance as energy_balance
    from rainwind.dynamics.ensemble_results import Ensemble as Ensemble
    from rainwind.dynamics.ensembles import ensemble as ensemble
    from rainwind.dynamics.equilibria import continue_equilibria as continue_equilibria
    from rainwind.dynamics.equilibria import find_equilibria as find_equilibria
    from rainwind.dynamics.equilibria import find_equilibrium as find_equilibrium
    from rainwind.dynamics.equilibria import walk_equilibria as walk_equilibria
    from rainwind.dynamics.events import Crossings as Crossings
    from rainwind.dynamics.events import Event as Event
    from rainwind.dynamics.find_orbit import find_orbit as find_orbit
    from rainwind.dynamics.lyapunov import lyapunov as lyapunov
    from rainwind.dynamics.monitors import Monitor as Monitor
    from rainwind.dynamics.orbit_certificates import certified as certified
    from rainwind.dynamics.orbit_curves import continue_lpc as continue_lpc
    from rainwind.dynamics.orbit_curves import continue_ns as continue_ns
    from rainwind.dynamics.orbit_curves import continue_pd as continue_pd
    from rainwind.dynamics.orbit_results import Orbit as Orbit
    from rainwind.dynamics.orbit_results import OrbitBranch as OrbitBranch
    from rainwind.dynamics.orbit_results import OrbitPoint as OrbitPoint
    from rainwind.dynamics.orbits import continue_orbits as continue_orbits
    from rainwind.dynamics.records import record as record
    from rainwind.dynamics.reductions import SETTLED as SETTLED
    from rainwind.dynamics.reductions import Extremes as Extremes
    from rainwind.dynamics.reductions import Lyapunov as Lyapunov
    from rainwind.dynamics.reductions import Mean as Mean
    from rainwind.dynamics.reductions import Returns as Returns
    from rainwind.dynamics.reductions import Settled as Settled
    from rainwind.dynamics.reductions import TimeTo as TimeTo
    from rainwind.dynamics.results import Branch as Branch
    from rainwind.dynamics.results import Ended as Ended
    from rainwind.dynamics.results import SpecialPoint as SpecialPoint
    from rainwind.dynamics.sampling import Sample as Sample
    from rainwind.dynamics.sampling import grid as grid
    from rainwind.dynamics.sampling import latin_hypercube as latin_hypercube
    from rainwind.dynamics.sampling import lognormal as lognormal
    from rainwind.dynamics.sampling import normal as normal
    from rainwind.dynamics.sampling import sobol as sobol
    from rainwind.dynamics.sampling import uniform as uniform
    from rainwind.dynamics.shooting import shoot as shoot
    from rainwind.dynamics.signals import Signal as Signal
    from rainwind.dynamics.signals import ramp as ramp
    from rainwind.dynamics.simulate import simulate as simulate
    from rainwind.dynamics.system import System as System
    from rainwind.dynamics.trajectory import RunEnded as RunEnded
    from rainwind.dynamics.trajectory import Trajectory as Trajectory
    from rainwind.dynamics.workers import Cluster as Cluster
    from rainwind.dynamics.workers import Processes as Processes
    from rainwind.elementary import acos as acos
    from rainwind.elementary import asin as asin
    from rainwind.elementary import atan as atan
    from rainwind.elementary import atan2 as atan2
    from rainwind.elementary import cos as cos
    from rainwind.elementary import cosh as cosh
    from rainwind.elementary import erf as erf
    from rainwind.elementary import exp as exp
    from rainwind.elementary import log as log
    from rainwind.elementary import sin as sin
    from rainwind.elementary import sinh as sinh
    from rainwind.elementary import sqrt as sqrt
    from rainwind.elementary import tan as tan
    from rainwind.elementary import tanh as tanh
    from rainwind.engineering.answers import Band as Band
    from rainwind.engineering.answers import BridgeAnswer as BridgeAnswer
    from rainwind.engineering.answers import ModeAnswer as ModeAnswer
    from rainwind.engineering.answers import StayAnswer as StayAnswer
    from rainwind.engineering.assessment import assess as assess
    from rainwind.engineering.bridge import Bridge as Bridge
    from rainwind.engineering.bridge import ClimateSource as ClimateSource
    from rainwind.engineering.bridge import Limits as Limits
    from rainwind.engineering.bridge import Question as Question
    from rainwind.engineering.bridge import Site as Site
    from rainwind.engineering.cable import Cable as Cable
    from rainwind.engineering.cable import Damper as Damper
    from rainwind.engineering.dampers import damped_modes as damped_modes
    from rainwind.engineering.modes import cable_modes as cable_modes
    from rainwind.engineering.turbulent_wind import TurbulentWind as TurbulentWind
    from rainwind.engineering.turbulent_wind import turbulent_wind as turbulent_wind
    from rainwind.errors import RainwindError as RainwindError
    from rainwind.io.auto_export import export_to_auto as export_to_auto
    from rainwind.io.bridge_cases import read_bridge as read_bridge
    from rainwind.io.cases import read_case as read_case
    from rainwind.io.climate_files import read_climate as read_climate
    from rainwind.io.saved import load as load
    from rainwind.io.saved import save as save
    from rainwind.io.wind_records import read_wind as read_wind
    from rainwind.physics.coefficient_files import load_coefficients as load_coefficients
    from rainwind.physics.model import RivuletModel as RivuletModel
    from rainwind.physics.model import paper_model as paper_model
    from rainwind.physics.rivulet import Rivulet as Rivulet
    from rainwind.physics.section import CableSection as CableSection
    from rainwind.physics.wind import Wind as Wind
    from rainwind.reporting.report import write_report as write_report

_HOME = {
    **dict.fromkeys(("Attractor", "attractor", "attractors"), "dynamics.attractors"),
    "lyapunov": "dynamics.lyapunov",
    "Mesh": "dynamics.collocation",
    "continue_fold": "dynamics.curves",
    "continue_hopf": "dynamics.curves",
    "diagram": "dynamics.diagram",
    "Diagram": "dynamics.diagram_results",
    **dict.fromkeys(("EnergyBalance", "energy_balance"), "dynamics.energy"),
    "Ensemble": "dynamics.ensemble_results",
    "ensemble": "dynamics.ensembles",
    **dict.fromkeys(
        ("SETTLED", "Extremes", "Lyapunov", "Mean", "Returns", "Settled", "TimeTo"), "dynamics.reductions"
    ),
    **dict.fromkeys(
        ("Sample", "grid", "latin_hypercube", "lognormal", "normal", "sobol", "uniform"), "dynamics.sampling"
    ),
    **dict.fromkeys(("Cluster", "Processes"), "dynamics.workers"),
    "continue_equilibria": "dynamics.equilibria",
    "find_equilibria": "dynamics.equilibria",
    "find_equilibrium": "dynamics.equilibria",
    "walk_equilibria": "dynamics.equilibria",
    **dict.fromkeys(("continue_lpc", "continue_ns", "continue_pd"), "dynamics.orbit_curves"),
    "Monitor": "dynamics.monitors",
    "certified": "dynamics.orbit_certificates",
    "Orbit": "dynamics.orbit_results",
    "OrbitBranch": "dynamics.orbit_results",
    "OrbitPoint": "dynamics.orbit_results",
    "continue_orbits": "dynamics.orbits",
    "Branch": "dynamics.results",
    "Ended": "dynamics.results",
    "SpecialPoint": "dynamics.results",
    "find_orbit": "dynamics.find_orbit",
    **dict.fromkeys(("Event", "Crossings"), "dynamics.events"),
    "simulate": "dynamics.simulate",
    **dict.fromkeys(("RunEnded", "Trajectory"), "dynamics.trajectory"),
    "shoot": "dynamics.shooting",
    "record": "dynamics.records",
    **dict.fromkeys(("Signal", "ramp"), "dynamics.signals"),
    "save": "io.saved",
    "load": "io.saved",
    "export_to_auto": "io.auto_export",
    "System": "dynamics.system",
    **dict.fromkeys(("acos", "asin", "atan", "atan2", "cos", "cosh", "erf", "exp", "log"), "elementary"),
    **dict.fromkeys(("sin", "sinh", "sqrt", "tan", "tanh"), "elementary"),
    **dict.fromkeys(("TurbulentWind", "turbulent_wind"), "engineering.turbulent_wind"),
    **dict.fromkeys(("Band", "BridgeAnswer", "ModeAnswer", "StayAnswer"), "engineering.answers"),
    "assess": "engineering.assessment",
    **dict.fromkeys(("Bridge", "ClimateSource", "Limits", "Question", "Site"), "engineering.bridge"),
    **dict.fromkeys(("Cable", "Damper"), "engineering.cable"),
    "damped_modes": "engineering.dampers",
    "cable_modes": "engineering.modes",
    "read_bridge": "io.bridge_cases",
    "read_climate": "io.climate_files",
    "write_report": "reporting.report",
    "RainwindError": "errors",
    "read_case": "io.cases",
    "read_wind": "io.wind_records",
    "load_coefficients": "physics.coefficient_files",
    "RivuletModel": "physics.model",
    "paper_model": "physics.model",
    "Rivulet": "physics.rivulet",
    "CableSection": "physics.section",
    "Wind": "physics.wind",
}
__all__ = [*_HOME, "__version__"]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'rainwind' has no attribute '{name}'")
    value = getattr(import_module(f"rainwind.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
