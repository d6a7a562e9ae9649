"""Whether springs and tension hold the cable in one place only, under any force."""

from math import inf

from rainwind.errors import InputError


def least_slope(k: float, k2: float, k3: float) -> float:
    """The smallest slope k + 2 k2 q + 3 k3 q² that a spring k q + k2 q² + k3 q³ has, N/m²; -inf where it has none."""
    if k3 > 0:
        return k - k2 / 3 * (k2 / k3)
    return k if k2 == 0 and k3 == 0 else -inf


def need_one_rest_position(k3: float, sag_offset: float, slope_y: float, slope_z: float) -> None:
    """InputError unless y and z have one rest position under any force: k3 >= 0 and k3 s² < both least slopes.

    Then the potential is strictly convex: the Hessian of k3 e² is 2 k3 (grad e grad e^T + e I), and e >= -s²/2.
    With equal springs the bound is sharp: beyond it the section snaps through.
    """
    if not k3 >= 0:
        raise InputError(f"section.k3 = {k3:g} is not allowed: it must be 0 or more; a string stiffens")
    least = min(slope_y, slope_z)
    if least <= 0:
        way = "y" if slope_y <= slope_z else "z"
        slope = "gets ever softer" if least == -inf else f"has the slope {least:g} N/m² somewhere"
        raise InputError(
            f"section.k3 needs springs that stay stiff, and the one in {way} {slope}; "
            f"set section.k2_{way} = 0 and section.k3_{way} to 0 or more, or leave section.k3 out"
        )
    softening = k3 * sag_offset * sag_offset
    if not softening < least:
        raise InputError(
            f"section.sag_offset = {sag_offset:g} m with section.k3 = {k3:g} N/m⁴: the cable would snap through, as "
            f"k3 sag_offset² = {softening:g} N/m² must stay below {least:g} N/m², the least stiffness of y and z; "
            "take a smaller sag_offset or k3"
        )
