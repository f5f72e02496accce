"""Display settings and layers."""

import pytest
import viser

from hectorscope.page.scene import Display, Scene


@pytest.fixture
def scene(server: viser.ViserServer) -> Scene:
    return Scene(server, lambda command: None)


def test_settings_are_clamped() -> None:
    """Nothing that a browser sends leaves its range."""
    wild = Display(layout="spiral", points="x", gap=1e9, level=-3, ellipse_scale=0.0)  # type: ignore[arg-type]
    assert wild == Display(layout="stacked", points="residual", gap=2.0, level=0, ellipse_scale=1.0)


def test_an_unknown_setting_is_an_error(scene: Scene) -> None:
    """A misspelt name is a mistake in the code that calls."""
    with pytest.raises(KeyError, match="gab"):
        scene.show(gab=3.0)


def test_layers_are_switched(scene: Scene) -> None:
    """Hiding a layer hides the node that everything of it hangs below."""
    layer = scene.layer("thing", "Thing")
    scene.show_layer("thing", False)
    assert not layer.root.visible
    scene.show_layer("thing", True)
    assert layer.root.visible


def test_a_layer_may_begin_hidden(scene: Scene) -> None:
    """A layer that is not shown at first is known as hidden, and only that one."""
    scene.layer("here", "Here")
    layer = scene.layer("secret", "Secret", shown=False)
    assert not layer.root.visible
    assert scene.display.hidden == {"secret"}


def test_the_theme_follows_the_setting(scene: Scene) -> None:
    """Dark and light have palettes of their own."""
    scene.show(dark=False)
    assert not scene.theme.dark
    scene.show(dark=True)
    assert scene.theme.dark
