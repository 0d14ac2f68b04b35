"""What hostile neighbours do to a running `afo view`, drawn by a seed; and a walk's commands, to be compared."""
import contextlib
import json
import os
import random
import signal
import socket
import threading
import time

import websocket

from afo import run
from viewer import PATIENCE_S, Talk, View

SPEED = "0.8"
COMMANDS = (b" 000#", b" 080#", b" 201#", b" 202#", b" 301#", b" 302#", b" 401#", b" 402#")
GONE = (OSError, websocket.WebSocketException, ValueError)
EARLIEST_TICK = 1100  # the nodes speak, and the walker is let go
PAUSE_S = 0.02  # between two deeds: the machine has others to serve


def commands(path):
    """Frames that command, in their order, without their times: a tool's own frames may delay them by microseconds."""
    with open(path, "rb") as stream:
        return [line[line.index(b")"):] for line in stream if any(kind in line for kind in COMMANDS)]


class Hostile(threading.Thread):
    """Does its worst from some tick on: so many deeds, and so many seconds at least. deeds: how many it were."""

    LEAST, ALONE = 20, False

    def __init__(self, view, seed, seconds):
        super().__init__(daemon=True)
        self.view, self.random, self.deeds, self.failed = view, random.Random(seed), 0, None
        self.seconds = seconds
        self.open = []
        self.at_tick = self.random.randrange(EARLIEST_TICK, 3000)

    def run(self):
        try:
            self.walked_to(self.at_tick)
            self.prepare()
            until = time.monotonic() + self.seconds
            while self.deeds < self.LEAST or time.monotonic() < until:
                self.deed()
                self.deeds += 1
                time.sleep(PAUSE_S)
        except Exception as error:  # pylint: disable=broad-except
            self.failed = error
        finally:
            for one in self.open:
                one.close()

    def walked_to(self, tick):
        talk = Talk(self.view)
        while (talk.next or 0) < tick:
            talk.hear()
        self.open.append(talk)

    def talk(self):
        talk = Talk(self.view)
        self.open.append(talk)
        return talk

    def plain(self):
        one = socket.create_connection(("127.0.0.1", self.view.port), timeout=5)
        self.open.append(one)
        return one

    def prepare(self):
        pass

    def deed(self):
        raise NotImplementedError


class Killed(Hostile):
    """The server is killed."""

    LEAST, ALONE = 1, True

    def deed(self):
        if self.deeds == 0:
            os.kill(self.view.server_pid(), signal.SIGKILL)


class Stopped(Hostile):
    """The server is stopped and goes on, again and again."""

    LEAST, ALONE = 3, True

    def prepare(self):
        self.pid = self.view.server_pid()

    def deed(self):
        os.kill(self.pid, signal.SIGSTOP)
        time.sleep(self.random.uniform(0.1, 1.0))
        os.kill(self.pid, signal.SIGCONT)
        time.sleep(self.random.uniform(0.0, 0.2))


class Flooded(Hostile):
    """Packets, connections that say nothing, endless heads, and requests without a pause."""

    def prepare(self):
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.open.append(self.udp)

    def deed(self):
        for _ in range(100):
            self.udp.sendto(self.random.randbytes(self.random.randrange(1, 1400)), ("127.0.0.1", self.view.port))
        self.plain()
        try:
            self.plain().sendall(b"GET / HTTP/1.1\r\nX: " + b"y" * self.random.randrange(20000))
            if self.deeds % 10 == 0:
                talk = self.talk()
                for _ in range(300):
                    talk.ask(do="range", first=0, last=100000)
        except GONE:
            pass
        while len(self.open) > 100:
            self.open.pop(2).close()  # behind the browser that looked on, and the packets' socket


class Twenty(Hostile):
    """Twenty browsers that want all of the past, and mark."""

    def prepare(self):
        self.many = [self.talk() for _ in range(20)]

    def deed(self):
        place = self.random.randrange(20)
        try:
            self.many[place].ask(do="range", first=0, last=100000)
            self.many[place].ask(do="mark", text="x" * self.random.randrange(200))
            for _ in range(self.random.randrange(20)):
                self.many[place].hear()
        except GONE:  # sent away: it comes again
            self.many[place].close()
            self.many[place] = self.talk()


class Stalled(Hostile):
    """Browsers that ask for everything and never read."""

    def prepare(self):
        self.many = [self.talk() for _ in range(5)]

    def deed(self):
        with contextlib.suppress(*GONE):  # sent away, or its own buffer is full
            one = self.random.choice(self.many)
            one.socket.settimeout(0.05)
            one.ask(do="range", first=0, last=100000)


class Rubbish(Hostile):
    """What is no request, no text, no web socket frame."""

    WORDS = ("do", "write", "request", "range", "name", "value", "parameters.kp_m_s_rad", "record", "on", "first", "commission", "deed")

    def garbage(self):
        kind, word = self.random.randrange(5), self.random.choice
        if kind == 0:
            return json.dumps({word(self.WORDS): word((None, [], {}, "nan", -1e308, True))})
        if kind == 1:
            return json.dumps({"do": word(("range", "mark", "nothing", "__init__")), "first": word(("x", -5, 1e99, None)), "text": [1]})
        if kind == 2:
            return json.dumps({"do": "write", "name": word(self.WORDS), "value": word(("", "x", 9e99, None, -1e9))})
        if kind == 3:
            return "[" * self.random.randrange(5000)
        return self.random.randbytes(self.random.randrange(3000)).decode("latin-1")

    def deed(self):
        talk = self.talk()
        try:
            for _ in range(self.random.randrange(30)):
                talk.socket.send(self.garbage())
            kind = self.random.randrange(3)
            if kind == 0:
                talk.socket.send_binary(self.random.randbytes(2000))
            elif kind == 1:
                talk.socket.sock.sendall(self.random.randbytes(500))  # frames that are none
            else:
                talk.socket.send("x" * 70000)
            self.plain().sendall(self.random.randbytes(self.random.randrange(5000)))
        except GONE:
            pass
        while len(self.open) > 10:
            self.open.pop(1).close()


CLASSES = {one.__name__.lower(): one for one in (Flooded, Twenty, Stalled, Rubbish, Stopped, Killed)}


def campaign(kinds, seed, folder, seconds, expected):
    """A walk with control, and these neighbours. None, or why the walk was not the undisturbed one."""
    return neighbours(kinds, seed, folder, seconds, "--control") or difference(commands(folder / "v.log"), expected)


def neighbours(kinds, seed, folder, seconds, *options):
    """A walk whose log is v.log, and these neighbours. None, or which of them did too little, or what the server said."""
    errors = folder / "errors.txt"
    with open(errors, "w", encoding="utf-8") as stream:
        view = View("--speed", SPEED, *options, "--trials", folder / "trials", "--log", folder / "v.log", errors=stream)
    chosen = [CLASSES[kind](view, f"{kind} {seed}", seconds) for kind in kinds]
    together = [one for one in chosen if not one.ALONE]
    for one in together:
        one.start()
    for one in together:
        one.join(PATIENCE_S)
    for one in chosen:
        if one.ALONE:
            one.start()
            one.join(PATIENCE_S)
    status = view.end()
    lazy = [(type(one).__name__, one.deeds, one.failed) for one in chosen if one.failed or one.deeds < one.LEAST]
    said = errors.read_text(encoding="utf-8")
    if status != 0 or lazy or "Traceback" in said or len(said.splitlines()) > 60:
        return f"status {status}, {lazy}, {said[-2000:]}"
    return None


def difference(found, expected):
    """None, or the first command that is another one. At its end each walk stops: the last ones are left out."""
    if found.count(b") can0 080#\n") <= EARLIEST_TICK:  # nobody had begun
        return f"only {len(found)} commands"
    last = min(len(found), len(expected)) - 10
    where = next((i for i in range(last) if found[i] != expected[i]), None)
    return None if where is None else f"command {where}: {found[where]!r} where {expected[where]!r} was expected"


def undisturbed(folder, steps):
    path = folder / "undisturbed.log"
    assert run("--speed", SPEED, "--steps", steps, "--log", path, "--quiet").returncode == 0
    return commands(path)
