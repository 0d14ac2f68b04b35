"""The steps of commissioning from the page: `afo commission` does them, with this server's bus in place of an interface.

So each motion is asked for as that program asks for it, by SDO writes that it reads back, and they are on the bus as any
tool's. A step ends when who began it goes away, and the controller then unloads both springs.
"""
import asyncio
import json
import pathlib
import signal
import socket
import subprocess

import numpy as np
from aiohttp import web

import frames
from refusal import Refusal

ANSWERS, HEARTBEATS, REQUESTS, NODES = 0x580, 0x700, 0x600, 127
END_S, TEXT_MAX, LINES_MAX = 10.0, 400, 60


class Commissioning:
    def __init__(self, site):
        self.site, self.hub, self.control = site, site.hub, site.control
        self.device = site.hub.subject["device_file"]
        self.folder = pathlib.Path(site.options.trials) / f"commissioning-{pathlib.Path(self.device or 'none').stem}"
        self.process = self.socket = self.owner = None
        self.step, self.words, self.question, self.lines = None, "", "", []
        self.steps = {"steps": []}
        if self.device:
            self._read()
        site.deeds["commission"] = self.do_commission
        site.hello_parts.append(lambda: {"commissioning": self.told()})
        site.farewells.append(self._gone)
        site.routes.append(("GET", "/commissioning", self.get_page))
        self.hub.listeners.append(self._hear)

    def told(self):
        why = "" if self.device else "Name the device that is set up: start afo view with --device FILE."
        return {"why": why, "running": self.step, "words": self.words, "question": self.question, "lines": self.lines,
                "folder": str(self.folder), "has_page": self._path("html").exists(), **self.steps}

    def tell(self):
        self.hub.tell({"type": "commissioning", **self.told()})

    def _path(self, kind):
        return self.folder / {"record": "commissioning.ini", "out": "commissioned.ini", "html": "commissioning.html"}[kind]

    def _files(self):
        return ["--device", self.device, "--record", str(self._path("record")), "--page", str(self._path("html")),
                "--out", str(self._path("out"))]

    def _read(self):
        """What is recorded so far; a few milliseconds."""
        done = subprocess.run([self.site.options.afo, "commission", *self._files(), "--list"], capture_output=True, text=True,
                              timeout=20, check=False)
        self.steps = json.loads(done.stdout) if done.returncode == 0 else {"steps": [], "trouble": done.stderr.strip()[-TEXT_MAX:]}

    # ---- what is asked -------------------------------------------------------------------

    def do_commission(self, client, asked):
        deed = {"run": self._run, "skip": self._skip, "answer": self._answer, "interrupt": self._interrupt}[asked["deed"]]
        return deed(client, asked)

    def _begin(self, client, asked, option):
        step = str(asked["step"])
        if not self.device:
            raise Refusal(self.told()["why"])
        if step not in {one["name"] for one in self.steps["steps"]}:
            raise Refusal("Commissioning has no such step.")
        if self.step:
            raise Refusal(f"The step {self.step} is under way.")
        self.step, self.owner, self.words, self.question, self.lines = step, client, "", "", []
        self.control.keep(self.control._guarded(client, "commission", self._work(option)))

    def _run(self, client, asked):
        if asked.get("in_stand") is not True:
            raise Refusal("Say first that the device is in a stand, its feet are free, and nobody wears it.")
        self._begin(client, asked, ["--step", str(asked["step"])])

    def _skip(self, client, asked):
        reason = " ".join(str(asked.get("reason", "")).split())[:200]
        if not reason:
            raise Refusal("Write a reason: the page to sign tells why a step was skipped.")
        self._begin(client, asked, ["--skip", f"{asked['step']}={reason}", "--step", str(asked["step"])])

    def _answer(self, _, asked):
        if self.process is None or not self.question:
            raise Refusal("Nothing is asked.")
        self.process.stdin.write(b"y\n" if asked["yes"] is True else b"n\n")
        self.lines.append(f"{self.question} {'yes' if asked['yes'] is True else 'no'}")
        self.question = ""
        self.tell()

    def _interrupt(self, _, asked):
        self.interrupt()

    def interrupt(self):
        """The step ends, and the controller unloads; nothing to do without one."""
        if self.process and self.process.returncode is None:
            self.process.send_signal(signal.SIGINT)
            asyncio.get_running_loop().call_later(END_S, self._kill, self.process)

    @staticmethod
    def _kill(process):
        if process.returncode is None:
            process.kill()

    def _gone(self, client):
        if client is self.owner:
            self.interrupt()

    # ---- the program -----------------------------------------------------------------------

    async def _work(self, option):
        loop = asyncio.get_running_loop()
        mine, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        mine.setblocking(False)
        try:
            self.tell()
            self.folder.mkdir(parents=True, exist_ok=True)
            self.process = await asyncio.create_subprocess_exec(
                self.site.options.afo, "commission", "--frames", str(its.fileno()), *self._files(), *option, pass_fds=(its.fileno(),),
                stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT)
            its.close()
            self.socket = mine
            loop.add_reader(mine, self._relay)
            if self.owner not in self.hub.clients:
                self.interrupt()  # it went away while the program began
            await self._listen(self.process.stdout)
            await self.process.wait()
        except OSError as error:
            raise Refusal(f"{error.filename or self.folder}: {error.strerror}") from error
        finally:
            loop.remove_reader(mine)
            self.socket = None
            mine.close()
            its.close()
            if self.process:
                self._kill(self.process)
            self.process = self.step = self.owner = None
            self.words = self.question = ""
            await loop.run_in_executor(None, self._read)
            self.tell()

    async def _listen(self, stream):
        """Lines, and questions that end without one."""
        rest = ""
        while data := await stream.read(4096):
            *lines, rest = (rest + data.decode("utf-8", "replace")).split("\n")
            for line in lines:
                self._said(line)
            if rest.lstrip().startswith("??") and rest.endswith("(y/n) "):
                self.question, rest = rest.strip()[2:-5].strip(), ""
            self.tell()

    def _said(self, line):
        text = line.strip()[:TEXT_MAX]
        if text.startswith(">>"):
            self.words = text[2:].strip()
        if text:
            self.lines = [*self.lines[-LINES_MAX:], text.removeprefix(">> ")]

    # ---- its bus ------------------------------------------------------------------------------

    def _hear(self, records):
        """Answers and heartbeats of all nodes to the program; one that takes none misses them, as on a bus."""
        if self.socket is None:
            return
        part = records["id"] & ~np.uint32(NODES)
        for place in np.flatnonzero((part == ANSWERS) | (part == HEARTBEATS)).tolist():
            try:
                self.socket.send(records[place].tobytes())
            except OSError:
                return

    def _relay(self):
        """The program's requests to the bus."""
        for _ in range(64):
            try:
                data = self.socket.recv(frames.RECORD.itemsize)
            except BlockingIOError:
                return
            except OSError:
                data = b""
            if not data:
                asyncio.get_running_loop().remove_reader(self.socket)
                return
            record = np.frombuffer(data, frames.RECORD)[0] if len(data) == frames.RECORD.itemsize else None
            if record is None or not REQUESTS < record["id"] <= REQUESTS + NODES:
                continue
            try:
                self.site.source.send(int(record["id"]), record["data"].tobytes()[:int(record["length"])])
            except OSError:
                pass  # a full bus: it asks again

    # ---- the page to sign ------------------------------------------------------------------------

    async def get_page(self, request):
        self.site.guard.check_token(request)
        try:
            html = self._path("html").read_bytes()
        except OSError as error:
            raise web.HTTPNotFound(text="No step was done so far.\n") from error
        return web.Response(body=html, content_type="text/html", charset="utf-8")
