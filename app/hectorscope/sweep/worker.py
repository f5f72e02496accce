"""The process that does the runs, one after the other: specs come in by lines, summaries go out by lines.

It ends when its input does, whatever it is doing: nothing is left behind by a sweep that is killed.
"""

import gc
import os
import queue
import sys
import threading
from typing import TextIO

from hectorscope.common.kernel_cache import cache_places, keep_compiled
from hectorscope.sweep.spec import RunSpec

READY = "ready"


def serve() -> None:
    """Until the input ends. Kernels are loaded, or compiled, once, before the first run."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a library prints is no answer
    waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(waiting,), name="input", daemon=True).start()
    keep_compiled(*cache_places())
    from hectorscope.run.warmup import load_everything  # noqa: PLC0415  loads the compiler
    from hectorscope.sweep.execute import execute  # noqa: PLC0415

    load_everything()
    _answer(answers, READY)
    while True:
        summary = execute(RunSpec.from_json(waiting.get()))
        gc.collect()
        _answer(answers, summary.as_json())


def _listen(waiting: "queue.SimpleQueue[str]") -> None:
    for line in sys.stdin:
        waiting.put(line)
    os._exit(0)  # whoever asked is gone


def _answer(answers: TextIO, line: str) -> None:
    answers.write(f"{line}\n")
    answers.flush()
