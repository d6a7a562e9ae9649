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
