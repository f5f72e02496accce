"""Who may act: the browsers with the operator's token, and of these only one at a time where there are viewers."""

from collections.abc import Callable, Container
from dataclasses import dataclass
from typing import Any

from hectorscope.web.access_control import Role

# Of a browser's own camera, and of the handles in its own scene: there are none that browsers share.
OWN = frozenset(
    ("ViewerCameraMessage", *(f"TransformControls{each}Message" for each in ("Update", "DragStart", "DragEnd")))
)


@dataclass(eq=False)
class Browser:
    """A connection of a page. page: the number that its script has chosen, for the page to know itself by."""

    role: Role | None
    address: str = ""
    page: float = 0.0


class Roles:
    """Belongs to the server's event loop. one_operator: a browser acts only while it has control.

    handed_over: hears the address of each browser that gets control. Without one that has it, the next operator
    that acts gets it. open: the controls that who only looks may use too.
    """

    def __init__(self, *, one_operator: bool = False, handed_over: Callable[[str], None] = lambda _: None) -> None:
        self.one_operator, self._handed_over = one_operator, handed_over
        self.in_control: Browser | None = None
        self.open: Container[str] = ()

    def passes(self, browser: Browser, message: Any) -> bool:
        """Whether a message of a browser goes on to the checks of its values; all else is refused.

        A camera is each browser's own, and so are the handle of the X-ray and what an open control does. What the
        page says about itself is taken here.
        """
        match message:
            case {"type": str(kind)} if kind in OWN:
                return browser.role is not None
            case {"type": "GuiUpdateMessage", "uuid": str(uuid)} if uuid in self.open:
                return browser.role is not None
            case {"type": "HectorscopePage", "page": float(page)} if 0.0 <= page <= 1.0:
                browser.page = page
                return False
            case {"type": "HectorscopeTakeControl"}:
                self._take(browser)
                return False
        return self.may_act(browser)

    def may_act(self, browser: Browser) -> bool:
        """Whether it is the operator in control; one that comes first gets it."""
        if browser.role != "operator":
            return False
        if self.one_operator and self.in_control is None:
            self._take(browser)
        return not self.one_operator or self.in_control is browser

    def _take(self, browser: Browser) -> None:
        if browser.role == "operator" and self.one_operator and self.in_control is not browser:
            self.in_control = browser
            self._handed_over(browser.address)

    def leave(self, browser: Browser) -> None:
        """A connection is gone."""
        if self.in_control is browser:
            self.in_control = None

    def script(self) -> str:
        """Tells every page which one has control."""
        page = "null" if self.in_control is None else repr(self.in_control.page)
        return f"window.hectorscope?.inControl?.({page})"
