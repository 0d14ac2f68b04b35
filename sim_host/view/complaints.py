"""What goes to standard error: a line each, few of a kind, and never a reason to wait.

Whoever sends rubbish makes the libraries below complain, once a request. Nobody may read this program's errors, too: a
full pipe then stops whoever writes to it. So a thread of its own writes, and what it cannot keep up with is left out.
"""
import logging
import queue
import sys
import threading
import time

WAITING_MAX, REPEAT_S, FLUSH_S = 64, 10.0, 1.0


class Complaints(logging.Handler):
    """Also takes the records of every logger below the root."""

    def __init__(self, write):
        super().__init__(logging.WARNING)
        self._write, self._waiting = write, queue.Queue(WAITING_MAX)
        self._last = {}  # kind of a library's complaint -> [when it was told, how many since]
        threading.Thread(target=self._work, daemon=True).start()

    def say(self, text):
        try:
            self._waiting.put_nowait(text)
        except queue.Full:
            pass

    def emit(self, record):
        error = record.exc_info[1] if record.exc_info else None
        kind = (record.name, record.msg if isinstance(record.msg, str) else "", type(error))
        told = self._last.setdefault(kind, [-REPEAT_S, 0])
        now = time.monotonic()
        if now - told[0] < REPEAT_S:
            told[1] += 1
            return
        more = f" ({told[1]} more like it before)" if told[1] else ""
        self._last[kind] = [now, 0]
        cause = f": {type(error).__name__}: {str(error)[:120]}" if error else ""
        self.say(f"{record.name}: {record.getMessage()[:200]}{cause}{more}")

    def end(self):
        """What still waits is written, as far as somebody reads it."""
        deadline = time.monotonic() + FLUSH_S
        while self._waiting.unfinished_tasks and time.monotonic() < deadline:
            time.sleep(0.01)

    def _work(self):
        while True:
            text = self._waiting.get()
            try:
                self._write(text)
            except (OSError, ValueError):
                pass
            self._waiting.task_done()


def write_line(text):
    print(f"afo view: {text}", file=sys.stderr, flush=True)


def gather():
    """All complaints of this process from now on. Returns the one to say() further ones to."""
    complaints = Complaints(write_line)
    root = logging.getLogger()
    root.handlers[:] = [complaints]
    logging.captureWarnings(True)
    return complaints
