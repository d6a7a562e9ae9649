"""The wetted cable section in wind: coefficients and equations of motion; knows nothing of continuation."""

from rainwind.physics.blend import Blend
from rainwind.physics.coefficient_files import load_coefficients, shipped_sets
from rainwind.physics.coefficients import CoefficientSet
from rainwind.physics.curves import Polynomial, Table
from rainwind.physics.expressions import Expression
from rainwind.physics.letters import GRAVITY
from rainwind.physics.model import RivuletModel, paper_model
from rainwind.physics.rivulet import Rivulet
from rainwind.physics.section import CableSection
from rainwind.physics.static_balance import Equilibria
from rainwind.physics.wind import Wind

__all__ = [
    "GRAVITY", "Blend", "CableSection", "CoefficientSet", "Equilibria", "Expression", "Polynomial", "Rivulet",
    "RivuletModel", "Table", "Wind", "load_coefficients", "paper_model", "shipped_sets",
]  # fmt: skip
