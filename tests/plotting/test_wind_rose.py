"""The wind rose shows the hours that it was given, north up and clockwise."""

import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from rainwind.engineering.climate import WindRose
from rainwind.errors import InputError
from rainwind.plotting import style, wind_rose

DIRECTIONS = 2 * np.pi * np.arange(4) / 4
HOURS = np.array([[10.0, 20, 5], [0, 0, 0], [100, 40, 8], [30, 2, 1]])
ROSE = WindRose(DIRECTIONS, np.array([0.0, 5, 10, 15]), HOURS, calm=12.4)


def polar():
    return Figure().subplots(subplot_kw={"projection": "polar"})


def test_bars_are_the_hours_stacked():
    axes = wind_rose.draw(ROSE, polar())
    assert len(axes.containers) == 3
    inner = np.zeros(4)
    for k, bars in enumerate(axes.containers):
        assert [bar.get_height() for bar in bars] == pytest.approx(HOURS[:, k])
        assert [bar.get_y() for bar in bars] == pytest.approx(inner)
        assert [bar.get_x() + bar.get_width() / 2 for bar in bars] == pytest.approx(DIRECTIONS)
        inner += HOURS[:, k]
    assert axes.get_ylim()[1] > inner.max()
    assert (axes.get_theta_offset(), axes.get_theta_direction()) == (pytest.approx(np.pi / 2), -1)
    texts = [text.get_text() for text in axes.get_legend().get_texts()]
    assert sorted(texts) == ["0 to 5", "10 and more", "5 to 10", "calm: 12 h"]


def test_faster_is_darker_also_in_grey():
    axes = wind_rose.draw(ROSE, polar())
    grey = [np.dot(to_rgb(bars[0].get_facecolor()), (0.3, 0.59, 0.11)) for bars in axes.containers]
    assert np.all(np.diff(grey) < -0.1)


def test_hours_in_the_range_are_hatched_and_its_directions_marked_at_the_rim():
    low, high = np.array([2.5, 3.0, np.nan, 20.0]), np.array([7.5, 12.0, 9.0, 30.0])
    axes = wind_rose.draw(ROSE, polar(), low=low, high=high, what="mode 1")
    (hatched,) = (bars for bars in axes.containers if bars.get_label() == "mode 1")
    (bar,) = hatched
    assert bar.get_x() + bar.get_width() / 2 == pytest.approx(0)
    assert (bar.get_y(), bar.get_height()) == (pytest.approx(5), pytest.approx(5 + 10))
    rim = next(b for b in axes.containers if to_hex(b[0].get_facecolor()).upper() == style.VERMILION)
    assert [bar.get_x() + bar.get_width() / 2 for bar in rim] == pytest.approx(DIRECTIONS[[0, 1, 3]])
    assert rim[0].get_y() >= HOURS.sum(axis=1).max()
    assert "mode 1" in [text.get_text() for text in axes.get_legend().get_texts()]


def test_wind_faster_than_the_last_edge_is_hatched_with_its_bin():
    axes = wind_rose.draw(ROSE, polar(), low=np.full(4, 10.0), high=np.full(4, 99.0))
    hatched = [bars[0] for bars in axes.containers if bars.get_label() == "range of vibration"]
    assert [bar.get_height() for bar in hatched] == pytest.approx([5, 8, 1])


def test_labels_of_the_circles_stand_where_little_blows():
    assert wind_rose.draw(ROSE, polar()).get_rlabel_position() in (67.5, 112.5)


def test_a_rose_without_hours():
    empty = WindRose(DIRECTIONS, np.array([3.0, 5.0]), np.zeros((4, 1)), calm=8760.0)
    axes = wind_rose.draw(empty, polar())
    assert "below 3: 8760 h" in [text.get_text() for text in axes.get_legend().get_texts()]


def test_what_does_not_fit_is_refused():
    with pytest.raises(InputError, match="polar axes"):
        wind_rose.draw(ROSE, Figure().subplots())
    for low, high in ((np.zeros(4), None), (None, np.ones(4)), (np.zeros(3), np.ones(3))):
        with pytest.raises(InputError, match="4 directions"):
            wind_rose.draw(ROSE, polar(), low=low, high=high)
