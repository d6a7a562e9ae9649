"""Every refusal at the door, one by one: what was given, what is allowed, what to do."""

from dataclasses import replace
from math import inf, nan, pi

import numpy as np
import pytest

from rainwind.errors import CaseError, InputError
from rainwind.physics import (
    Blend,
    CableSection,
    CoefficientSet,
    Polynomial,
    Rivulet,
    Table,
    Wind,
    load_coefficients,
    paper_model,
)

RADIANS = "does not look like an angle in radians"


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (
            lambda: Wind(0.0),
            r"wind\.speed = 0 is not allowed: it must be above 0; for still air set wind\.density = 0",
        ),
        (lambda: Wind(-3.0), r"wind\.speed = -3"),
        (lambda: Wind("9"), r"wind\.speed = '9' is not a number"),
        (lambda: Wind(True), r"wind\.speed = True is not a number"),
        (lambda: Wind(None), r"wind\.speed = None is not a number"),
        (lambda: Wind(nan), r"wind\.speed = nan is not finite"),
        (lambda: Wind(inf), r"wind\.speed = inf is not finite"),
        (lambda: Wind(9.0, yaw=45.0), f"wind.yaw = 45 {RADIANS}"),
        (lambda: Wind(9.0, yaw=-3.2), f"wind.yaw = -3.2 {RADIANS}"),
        (lambda: Wind(9.0, density=-1.0), r"wind\.density = -1 .*0 or more"),
        (lambda: CableSection(diameter=0.0), r"section\.diameter"),
        (lambda: CableSection(mass=-50.0), r"section\.mass = -50"),
        (lambda: CableSection(frequency_y=0), r"section\.frequency_y"),
        (lambda: CableSection(frequency_z=nan), r"section\.frequency_z"),
        (lambda: CableSection(damping_ratio=-0.1), r"section\.damping_ratio = -0\.1.*1 means critical"),
        (lambda: CableSection(damping_ratio=None), r"section\.damping_ratio = None"),
        (lambda: CableSection(damping_ratio_y="x"), r"section\.damping_ratio_y"),
        (lambda: CableSection(damping_ratio_z=-1), r"section\.damping_ratio_z"),
        (lambda: CableSection(inclination=45.0), f"section.inclination = 45 {RADIANS}"),
        (lambda: CableSection(inclination=-0.1), f"section.inclination = -0.1 {RADIANS}"),
        (lambda: CableSection(k2_y=inf), r"section\.k2_y"),
        (lambda: CableSection(k3_z=[1]), r"section\.k3_z"),
        (lambda: Rivulet(mass=0.0), r"rivulet\.mass = 0"),
        (lambda: Rivulet(height=-0.01), r"rivulet\.height"),
        (lambda: Rivulet(friction=-1), r"rivulet\.friction"),
        (lambda: Rivulet(friction=False), r"rivulet\.friction = False"),
    ],
)
def test_wind_section_and_rivulet(build, message):
    with pytest.raises(InputError, match=message):
        build()


def test_limits_are_allowed_and_numpy_numbers_become_floats():
    assert type(Wind(np.float64(9), yaw=pi, density=0).speed) is float
    assert CableSection(inclination=pi / 2, damping_ratio=0).inclination == pi / 2
    assert CableSection(mass=np.int64(40)).mass == 40.0
    Rivulet(height=0, friction=0)


def test_derived_letters_of_the_section():
    section = CableSection(mass=40.0, frequency_y=2.0, damping_ratio=0.01, damping_ratio_z=0.02)
    assert section.stiffness_y == pytest.approx(40 * 16 * pi**2)
    assert section.stiffness_z == pytest.approx(40 * 4 * pi**2)
    assert section.damping_y == pytest.approx(2 * 0.01 * 40 * 4 * pi)
    assert section.damping_z == pytest.approx(2 * 0.02 * 40 * 2 * pi)


def a_set(**changes):
    given = {
        "name": "a",
        "source": "test",
        "status": "artificial",
        "valid": (-1.0, 0.0),
        "lift": 0.1,
        "drag": 1.0,
        "moment": 0.0,
    }
    return CoefficientSet(**{**given, **changes})


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: a_set(name=""), "name = ''"),
        (lambda: a_set(source=3), "source = 3"),
        (lambda: a_set(status=None), "status = None"),
        (lambda: a_set(status="meassured"), "status = 'meassured' .*did you mean 'measured'.*read off"),
        (lambda: a_set(status="good"), "status = 'good' is not known; choose one of measured"),
        (lambda: a_set(lift=Table((-0.9, 0.0), (1.0, 2.0), degree=1)), "-51.57 to 0 deg.* -57.3 to 0 deg"),
        (lambda: a_set(drag=Table((-1.0, -0.1), (1.0, 2.0), degree=1)), "drag of 'a' is a table from"),
        (lambda: a_set(drag="1/(alpha + 0.50001)"), r"drag of 'a' is not finite, .* -0\.5 rad"),
        (lambda: a_set(drag="tan(3*alpha)"), r"drag of 'a' is not finite"),
        (lambda: a_set(drag="log((alpha + 0.50001)**2)"), r"not finite, .* -0\.5 rad"),
        (lambda: paper_model(a_set(drag="1/(alpha - 0.50001)")), "outside='blend' is not finite"),
        (lambda: a_set(valid=(0.0, -1.0)), "reversed or empty"),
        (lambda: a_set(valid=(0.0, 0.0)), "reversed or empty"),
        (lambda: a_set(valid=(-90.0, 0.0)), "does not look like radians"),
        (lambda: a_set(valid=(-1.0,)), "must be two angles"),
        (lambda: a_set(valid="-1, 0"), "must be two angles"),
        (lambda: a_set(valid=(nan, 0.0)), "valid range = nan"),
        (lambda: a_set(lift=[]), "lift: a polynomial needs a list"),
        (lambda: a_set(lift=["1"]), "lift: polynomial coefficient c0 = '1'"),
        (lambda: a_set(drag=[1.0, nan]), "drag: polynomial coefficient c1 = nan"),
        (lambda: a_set(drag=None), "drag: constant = None"),
        (lambda: a_set(moment="alfa"), "moment: the expression 'alfa'"),
        (lambda: a_set(moment="1/(alpha + 0.5)"), "moment of 'a' is not finite"),
        (lambda: a_set(moment="log(alpha)"), "moment of 'a' is not finite"),
        (lambda: a_set(moment="1/0"), "moment of 'a' divides by zero"),
        (lambda: a_set(blend=0.03), "must be a Blend"),
        (lambda: a_set(rivulet_height=-1.0), "rivulet_height"),
        (lambda: a_set(reading_error="small"), "reading_error"),
        (lambda: Blend(0.0, 3.2, 0.03), "does not reach the bare"),
        (lambda: Blend(0.0, 1.0, 0.3), "does not reach the bare"),
        (lambda: Blend(0.0, 1.0, 0.0), "blend width = 0"),
        (lambda: Blend(0.0, -1.0, 0.1), "blend half width = -1"),
        (lambda: Blend(nan, 1.0, 0.1), "blend centre = nan"),
        (lambda: Blend(0.0, 1.0, 0.03, bare_lift="x"), "blend bare_lift: the expression 'x'"),
        (lambda: Polynomial("12"), "needs a list of numbers"),
        (lambda: Table((0.0, 1.0), (1.0,)), "2 angles and 1 values"),
        (lambda: Table((0.0,), (1.0,)), "at least 2"),
        (lambda: Table("ab", (1.0,)), "table alpha must be a list"),
        (lambda: Table((0.0, 1.0, 1.0), (1.0, 2.0, 3.0), degree=1), "angles must rise"),
        (lambda: Table((0.0, 1.0), (1.0, nan), degree=1), r"table value\[1\] = nan"),
        (lambda: Table((0.0, 1.0), (1.0, 2.0), degree=2), "needs at least 3 rows"),
        (lambda: Table((0.0, 1.0), (1.0, 2.0), degree=1.0), "degree = 1.0 must be a whole number"),
        (lambda: Table((0.0, 1.0), (1.0, 2.0), degree=1, allowed_error=-1.0), "allowed_error = -1"),
        (lambda: a_set().with_moment_of(a_set(valid=(0.5, 1.0))), "do not overlap"),
        (lambda: a_set().with_moment_of(a_set(moment=None)), "no moment curve"),
        (lambda: a_set(moment=None).at(0.0), "no moment curve"),
    ],
)  # fmt: skip
def test_coefficient_sets(build, message):
    with pytest.raises(InputError, match=message):
        build()


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: paper_model(outside="clip"), r"outside = 'clip' .* one of 'blend', 'extend', 'refuse'"),
        (lambda: paper_model(degrees_of_freedom=4), "degrees_of_freedom = 4"),
        (lambda: paper_model(degrees_of_freedom=True), "degrees_of_freedom = True"),
        (lambda: replace(paper_model(), angle="exact"), "angle = 'exact'"),
        (lambda: replace(paper_model(), relative_speed="U"), "relative_speed = 'U'"),
        (lambda: replace(paper_model(), wind=9.0), "wind = 9.0 must be a Wind"),
        (lambda: replace(paper_model(), coefficients="reconstructed"), "must be a CoefficientSet"),
        (lambda: paper_model(a_set(valid=(-pi, pi))), "leave no room for a blend.*choose outside='extend'"),
        (lambda: paper_model(a_set(moment="log(0.1 - alpha)")), "of 'a' with outside='blend' is not finite"),
        (lambda: paper_model(a_set(moment="log(0.1 - alpha)"), "extend"), "outside='extend' is not finite"),
        (lambda: paper_model().with_parameters({"wind.yaw": pi / 2, "section.inclination": 0}), "blows"),
        (lambda: paper_model().with_parameters({"wind.sped": 9.0}), "Did you mean 'wind.speed'"),
        (lambda: paper_model().with_parameters({"wind.speed": -9.0}), r"wind\.speed = -9"),
        (lambda: paper_model().with_parameters({"outside": 1.0}), "no parameter 'outside'"),
        (lambda: paper_model().with_parameters({"coefficients.rivulet_height": 1.0}), "no parameter 'coeff"),
    ],
)  # fmt: skip
def test_models(build, message):
    with pytest.raises(InputError, match=message):
        build()


def test_curves_that_are_finite_are_taken():
    a_set(lift="sqrt(alpha + 1)", drag="1/(alpha + 1.001)", moment="sqrt((alpha + 0.5)**2)")
    a_set(lift=Table((-1.0, 0.0), (1.0, 2.0), degree=1))
    a_set().with_moment_of(a_set(status="measured")).with_moment_of(a_set(status="read off"))


def test_refuse_needs_no_values_outside_the_valid_range():
    paper_model(a_set(moment="log(-alpha + 0.1)"), "refuse")


GOOD = """
name = "mine"
source = "my tunnel"
status = "measured"
valid_deg = [-60, 0]
lift = [0.1, 0.2]
drag = "1 + 0.1*alpha"
moment = {alpha_deg = [-60, -45, -30, -15, 0], value = [0.0, 0.1, 0.2, 0.3, 0.4], degree = 1}
rivulet_height_m = 0.01
reading_error = 0.02
[blend]
centre_deg = -30
half_width_deg = 42
width = 0.02
bare_drag = 1.1
[missed]
nothing = { paper = 1 }
"""


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "mine.toml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def test_a_good_file(file):
    mine = load_coefficients(file(GOOD))
    assert mine.valid == pytest.approx((-pi / 3, 0))
    assert mine.at(-pi / 6, "extend") == pytest.approx((0.1 - 0.2 * pi / 6, 1 - 0.1 * pi / 6, 0.2))
    assert mine.blend == Blend(-pi / 6, 42 * pi / 180, 0.02, bare_drag=1.1)
    assert mine.notes["missed"] == {"nothing": {"paper": 1}}
    assert load_coefficients(str(file(GOOD))) == mine


def replaced(old, new):
    assert old in GOOD
    return GOOD.replace(old, new)


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (replaced('name = "mine"\n', ""), ["'name' is missing"]),
        (replaced('source = "my tunnel"', "source = 3"), ["source = 3"]),
        (replaced("lift = [0.1, 0.2]", "lft = [0.1, 0.2]"), ["no key 'lft'", "'lift' is missing"]),
        (replaced("[0.1, 0.2]", "[nan, 0.2]"), ["lift: polynomial coefficient c0 = nan"]),
        (replaced("[0.1, 0.2]", '[0.1, "a"]'), ["coefficient c1 = 'a' is not a number"]),
        (replaced("[0.1, 0.2]", "true"), ["lift: constant = True"]),
        (replaced("[-60, 0]", "[0, -60]"), [r"valid_deg = \[0, -60\] is reversed"]),
        (replaced("[-60, 0]", "[-60]"), ["valid_deg = .* must be two angles"]),
        (replaced("[-60, 0]", "[-1.57, 0]"), [r"valid_deg = .*looks like radians; write \[-89.95, 0\]"]),
        (replaced('status = "measured"', 'status = "meassured"'), ["did you mean 'measured'"]),
        (replaced("valid_deg = [-60, 0]", "valid_deg = [-90, 0]"), ["table from -60 to 0 deg.*-90 to 0 deg"]),
        (
            replaced("[-60, -45, -30, -15, 0]", "[-1, -0.8, -0.5, -0.2, 0]"),
            ["-1 to 0 deg.*look like radians"],
        ),
        (replaced("[-60, 0]", '[-60, "zero"]'), ["valid_deg = 'zero'"]),
        (replaced("[-60, 0]", "[-600, 0]"), ["radians on one circle"]),
        (replaced("1 + 0.1*alpha", "1 + beta"), ["drag: the expression"]),
        (replaced("degree = 1}", "degre = 1}"), ["no key 'moment.degre'"]),
        (replaced("value = [0.0, 0.1, 0.2, 0.3, 0.4], ", ""), ["'moment.value' is missing"]),
        (
            replaced("value = [0.0, 0.1, 0.2, 0.3, 0.4]", "value = 1.0"),
            ["'moment.value' = 1.0 must be a list"],
        ),
        (replaced("0.1, 0.2, 0.3", "9.0, 0.2, 0.3"), ["moment: a polynomial of degree 1 misses"]),
        (replaced("alpha_deg = [-60,", 'alpha_deg = ["-60",'), ["moment.alpha_deg = '-60'"]),
        (replaced("rivulet_height_m = 0.01", "rivulet_height_m = -1"), ["rivulet_height"]),
        (replaced("width = 0.02", "widht = 0.02"), ["no key 'blend.widht'", "'blend.width' is missing"]),
        (replaced("width = 0.02", "width = 2.0"), ["does not reach"]),
        (replaced("centre_deg = -30", 'centre_deg = "left"'), ["blend.centre_deg = 'left'"]),
        (GOOD.split("[blend]")[0] + "blend = 3\n", ["blend = 3 must be a table"]),
        (replaced("name =", "name"), ["not a TOML file"]),
        (b"\xff\xfe\x00", ["not a TOML file in UTF-8"]),
        ("", ["'name' is missing", "'source' is missing", "'valid_deg' is missing", "'drag' is missing"]),
    ],
)
def test_every_fault_of_a_file_is_reported(file, text, messages):
    with pytest.raises(CaseError) as caught:
        load_coefficients(file(text))
    for message in messages:
        assert caught.match(message)
    assert caught.match("mine.toml")


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(CaseError, match="cannot be read"):
        load_coefficients(tmp_path / "none.toml")
    with pytest.raises(CaseError, match="cannot be read"):
        load_coefficients(tmp_path)


def test_a_misspelt_name_gets_the_nearest_one():
    with pytest.raises(CaseError, match=r"no coefficient set 'reconstucted'.*Did you mean 'reconstructed'"):
        load_coefficients("reconstucted")
