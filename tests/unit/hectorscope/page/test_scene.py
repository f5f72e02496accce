"""Display settings and layers."""

import pytest
import viser

from hectorscope.page.scene import Display, Stage


@pytest.fixture
def stage(server: viser.ViserServer) -> Stage:
    return Stage(server, lambda command: None)


def test_settings_are_clamped() -> None:
    """Nothing that a browser sends leaves its range."""
    wild = Display(layout="spiral", points="x", gap=1e9, level=-3, ellipse_scale=0.0)  # type: ignore[arg-type]
    assert wild == Display(layout="stacked", points="residual", gap=2.0, level=0, ellipse_scale=1.0)


def test_an_unknown_setting_is_an_error(stage: Stage) -> None:
    """A misspelt name is a mistake in the code that calls."""
    with pytest.raises(KeyError, match="gab"):
        stage.show(gab=3.0)


def test_layers_are_switched(stage: Stage) -> None:
    """Hiding a layer hides the node that everything of it hangs below."""
    layer = stage.layer("thing", "Thing")
    stage.show_layer("thing", False)
    assert not layer.root.visible
    stage.show_layer("thing", True)
    assert layer.root.visible


def test_a_layer_may_begin_hidden(stage: Stage) -> None:
    """A layer that is not shown at first is known as hidden, and only that one."""
    stage.layer("here", "Here")
    layer = stage.layer("secret", "Secret", shown=False)
    assert not layer.root.visible
    assert stage.display.hidden == {"secret"}


def test_the_theme_follows_the_setting(stage: Stage) -> None:
    """Dark and light have palettes of their own."""
    stage.show(dark=False)
    assert not stage.theme.dark
    stage.show(dark=True)
    assert stage.theme.dark
