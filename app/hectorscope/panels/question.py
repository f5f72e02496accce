"""Asks before something is lost, on every page: the map belongs to everybody. The safe answer comes first."""

from collections.abc import Callable

from hectorscope.page.scene import Scene
from hectorscope.panels import _workspace
from hectorscope.panels._format import text
from hectorscope.session.commands import Agree, Decline
from hectorscope.session.snapshot import Question, Snapshot


class QuestionPanel:
    """A dialogue as long as the engine has a question. The safe button has the focus."""

    title = "Question"
    order = 15
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._shown: Question | None = None
        self._close: Callable[[], None] = lambda: None

    def draw(self, snapshot: Snapshot) -> None:
        """Open and close it as the engine asks and no longer asks."""
        if snapshot.question == self._shown:
            return
        self._shown = snapshot.question
        self._close()
        self._close = (lambda: None) if self._shown is None else self._open(self._shown)

    def _open(self, question: Question) -> Callable[[], None]:
        """Show it; what closes it again."""
        gui, number = self._scene.server.gui, question.number
        modal = gui.add_modal(f"{question.agree}?")
        with modal:
            _workspace.mark(self._scene, "question")
            gui.add_html(f'<p class="hs-asked">{text(question.text)}</p>')
            decline = gui.add_button(f"{question.decline} · Enter")
            agree = gui.add_button(question.agree)
        decline.on_click(lambda _: self._scene.send(Decline(number)))
        agree.on_click(lambda _: self._scene.send(Agree(number)))
        return modal.close


PANEL = QuestionPanel
