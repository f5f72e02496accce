"""Every use of parts of viser that are no interface. viser is pinned exactly; tests pin each of these uses.

Each function fails soft: without its private part the page still works, only plainer, and says so once in the log.
"""

import logging

import viser
from viser import _messages

log = logging.getLogger(__name__)


def run_script(client: viser.ClientHandle, source: str) -> None:
    """Run JavaScript in one browser, now; nothing stays behind in the buffer that joiners are replayed."""
    try:
        client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=source))
    except AttributeError as error:
        log.warning("this viser cannot run scripts in the page: %s", error)
