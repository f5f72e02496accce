"""Display settings and layers."""

import pytest
import viser

from hectorscope.page.scene import Display, Scene


@pytest.fixture
def scene(server: viser.ViserServer) -> Scene:
    return Scene(server, lambda command: None)


def test_settings_are_clamped() -> None:
    """Nothing that a browser sends leaves its range."""
    wild = Display(points="x", ellipse_scale=0.0)  # type: ignore[arg-type]
    assert wild == Display(points="residual", ellipse_scale=1.0)


def test_an_unknown_setting_is_an_error(scene: Scene) -> None:
    """A misspelt name is a mistake in the code that calls."""
    with pytest.raises(KeyError, match="scael"):
        scene.show(scael=3.0)


def test_a_layer_on_demand_is_asked_for(scene: Scene) -> None:
    """Nothing of it has to be sent before; that it is hidden elsewhere is no concern of the server's."""
    layer = scene.layer("much", "Much", on_demand=True)
    assert layer.key not in scene.display.asked
    scene.ask(layer)
    assert scene.display.asked == {"much"}
    assert layer.root.visible
