"""Line numbers of keys, in every way TOML writes them."""

from rainwind.io.lines import key_lines

TEXT = '''\
schema = 1
[wind] # comment
speed_m_s = 9 # speed = 8
"yaw_deg" = 0
note = """
height = 3
"""
section.mass_kg_m = 5
[ rivulet ]
  mass_kg_m=1
[a.b]
c = {d = 1, e = 2}
'''


def test_lines_of_keys():
    assert key_lines(TEXT) == {
        ("schema",): 1,
        ("wind",): 2,
        ("wind", "speed_m_s"): 3,
        ("wind", "yaw_deg"): 4,
        ("wind", "note"): 5,
        ("wind", "section"): 8,
        ("wind", "section", "mass_kg_m"): 8,
        ("rivulet",): 9,
        ("rivulet", "mass_kg_m"): 10,
        ("a", "b"): 11,
        ("a", "b", "c"): 12,
        ("a", "b", "c", "d"): 12,
        ("a", "b", "c", "e"): 12,
    }


ARRAYS = """\
[[cable]]
length_m = 1
[[cable.damper]]
position_m = 2
[[cable.damper]]
position_m = 3
[[cable]]
length_m = 4
[[cable.damper]]
position_m = 5
[cable.note]
text = 6
[[damper]]
position_m = 7
"""


def test_tables_of_an_array_are_numbered():
    assert key_lines(ARRAYS) == {
        ("cable",): 1,
        ("cable", "0"): 1,
        ("cable", "0", "length_m"): 2,
        ("cable", "0", "damper"): 3,
        ("cable", "0", "damper", "0"): 3,
        ("cable", "0", "damper", "0", "position_m"): 4,
        ("cable", "0", "damper", "1"): 5,
        ("cable", "0", "damper", "1", "position_m"): 6,
        ("cable", "1"): 7,
        ("cable", "1", "length_m"): 8,
        ("cable", "1", "damper"): 9,
        ("cable", "1", "damper", "0"): 9,
        ("cable", "1", "damper", "0", "position_m"): 10,
        ("cable", "1", "note"): 11,
        ("cable", "1", "note", "text"): 12,
        ("damper",): 13,
        ("damper", "0"): 13,
        ("damper", "0", "position_m"): 14,
    }
