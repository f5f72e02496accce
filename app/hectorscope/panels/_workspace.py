"""Where panels live on the page: a bar at the top, a bar at the bottom, tabs docked at the right.

The bars are plain folders that static/hectorscope.css lifts out of the docked panel; without the style sheet they
are the first things in it.
"""

from weakref import WeakKeyDictionary

from viser import GuiFolderHandle, GuiTabGroupHandle, GuiTabHandle, IconName, ViserServer

from hectorscope.page.scene import Scene

WIDTH = 372  # pixels of the docked panels

_tabs: WeakKeyDictionary[ViserServer, dict[str, GuiTabHandle]] = WeakKeyDictionary()
_groups: WeakKeyDictionary[ViserServer, GuiTabGroupHandle] = WeakKeyDictionary()


def bar(scene: Scene, name: str) -> GuiFolderHandle:
    """A folder that the style sheet shows as the bar `name`."""
    folder = scene.server.gui.add_folder(name.capitalize())
    with folder:
        mark(scene, f"bar hs-bar-{name}")
    return folder


def over_scene(scene: Scene, name: str) -> GuiFolderHandle:
    """A folder that the style sheet shows in the middle of the scene; in a narrow window it comes first."""
    folder = scene.server.gui.add_folder(name.capitalize(), order=-1.0)
    with folder:
        mark(scene, f"over hs-over-{name}")
    return folder


def tab(scene: Scene, title: str, icon: IconName) -> GuiTabHandle:
    """The tab `title` of the main panel, made on first use, for panels that share it too."""
    tabs = _tabs.setdefault(scene.server, {})
    if title not in tabs:
        tabs[title] = _tab_group(scene).add_tab(title, icon)
    return tabs[title]


def _tab_group(scene: Scene) -> GuiTabGroupHandle:
    """The group of tabs; the main panel that holds it is docked at the right on first use."""
    group = _groups.get(scene.server)
    if group is None:
        group = _groups[scene.server] = scene.server.gui.add_tab_group()
        scene.server.gui.set_panel_label(None)  # the header then shows the state of the connection
        scene.server.gui.main_panel.dock_right()
        scene.server.gui.main_panel.set_width(WIDTH)
    return group


def mark(scene: Scene, name: str) -> None:
    """An invisible element that marks the container around it for the style sheet."""
    scene.server.gui.add_html(f'<i class="hs-mark hs-{name}"></i>')
