"""How the tests start `afo view`, speak with it, and look at its page."""
import collections
import contextlib
import json
import os
import re
import signal
import subprocess
import time

import websocket

from afo import AFO, ROOT

PATIENCE_S = float(os.environ.get("AFO_PATIENCE_S", "300"))


class View:
    """A running `afo view`; its address and token."""

    def __init__(self, *arguments, errors=subprocess.PIPE, **more):
        self.process = subprocess.Popen([AFO, "view", "--port", "0", *map(str, arguments)], cwd=ROOT, text=True,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors, **more)
        line = self.process.stdout.readline()
        found = re.search(r"http://([^/]+)/#(\S+)", line)
        assert found, (line, self.process.communicate(timeout=20))
        self.host, self.token = found.groups()
        self.port = int(self.host.rsplit(":", 1)[1])
        self.url = f"http://{self.host}/#{self.token}"

    def end(self):
        """Ctrl-C, and the exit status."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            self.process.communicate(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        return self.process.returncode

    def server_pid(self):
        said = subprocess.run(["pgrep", "-P", str(self.process.pid)], capture_output=True, text=True, check=True)
        return int(said.stdout.split()[0])

    def connect(self, token=None, **more):
        return websocket.create_connection(f"ws://{self.host}/live", timeout=PATIENCE_S,
                                           subprotocols=["afo.v1", f"token.{token or self.token}"],
                                           origin=more.pop("origin", f"http://{self.host}"), **more)


@contextlib.contextmanager
def viewing(*arguments, **more):
    view = View(*arguments, **more)
    try:
        yield view
    finally:
        view.end()


class Talk:
    """A web socket of a view; keeps what it was told."""

    def __init__(self, view):
        self.socket = view.connect()
        self.told, self.rows, self.next, self.lost = [], 0, None, 0
        self.past = collections.deque()  # events from before it connected

    def ask(self, **what):
        while not self.told:
            self.hear()
        self.past.clear()  # what is waited for from now on is new
        self.socket.send(json.dumps(what))

    def hear(self):
        """The next message: a dict, or None for rows."""
        data = self.socket.recv()
        if isinstance(data, bytes):
            first = int.from_bytes(data[4:8], "little")
            count = int.from_bytes(data[8:10], "little")
            self.lost += first - self.next if self.next is not None and first > self.next else 0
            self.next, self.rows = max(first + count, self.next or 0), self.rows + count
            return None
        self.told.append(json.loads(data))
        self.past.extend(self.told[-1].get("events", ()))
        return self.told[-1]

    def until(self, condition, what):
        """Hears until a message meets the condition, and returns it."""
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            message = self.hear()
            if message is not None and condition(message):
                return message
        raise AssertionError(f"did not come: {what}")

    def event(self, kind, **fields):
        """The next event of a kind; those from before this browser came count until it asks for something."""
        def fits(message):
            return message.get("kind") == kind and all(message.get(k) == v for k, v in fields.items())
        while not self.told:
            self.hear()
        while self.past:
            event = self.past.popleft()
            if fits(event):
                return event
        return self.until(fits, (kind, fields))

    def close(self):
        self.socket.close()


def wait_until(condition, what, seconds=PATIENCE_S):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        found = condition()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(f"did not happen: {what}")
