"""The elementary operations a tape may hold.

Operations from FIRST_WITH_TWO on fill two slots: the function, and beside it what its derivatives need.
"""

ADD = 0
SUB = 1
MUL = 2
DIV = 3
POWER = 4  # to a constant real exponent
NEG = 5
SQRT = 6
EXP = 7
LOG = 8
FIRST_WITH_TWO = 10
SINCOS = 10  # sin a, cos a
SINHCOSH = 11  # sinh a, cosh a
TAN = 12  # tan a, 1 + tan^2 a
TANH = 13  # tanh a, 1 - tanh^2 a
ATAN = 14  # atan a, 1 + a^2
ASIN = 15  # asin a, sqrt(1 - a^2)
ACOS = 16  # acos a, sqrt(1 - a^2)
ERF = 17  # erf a, 2/sqrt(pi) exp(-a^2)
ATAN2 = 18  # atan2(a, b), a^2 + b^2

BINARY = frozenset((ADD, SUB, MUL, DIV, POWER, ATAN2))
