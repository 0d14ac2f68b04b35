"""Marks and trials, as browsers and UDP packets ask for them."""
import asyncio
import datetime
import pathlib

from aiohttp import web

import trial
from refusal import Refusal

EXPORTS = {"csv": "text/csv", "json": "application/json", "parquet": "application/vnd.apache.parquet", "mcap": "application/octet-stream"}
LATE = ("The controller was running before this page watched: this trial replays from the controller's next start on. Start afo "
        "view first, or restart the controller, to replay all of it.")


class Keeping:
    def __init__(self, site):
        self.site, self.hub = site, site.hub
        self.root = pathlib.Path(site.options.trials)
        self.marks, self.is_beginning, self.late = 0, False, ""
        self.trials = trial.listing(self.root)
        self.makers = asyncio.Semaphore(2)  # reports at once
        site.deeds.update({"mark": self.do_mark, "record": self.do_record})
        site.hello_parts.append(self.hello)
        site.routes += [("GET", "/report", self.get_report), ("GET", "/compare", self.get_compare),
                        ("GET", "/export", self.get_export)]

    def hello(self):
        return {"trials": self.trials, "recorder": self.recorder_state()}

    def recorder_state(self):
        if not self.hub.recorder:
            return None
        return {"folder": str(self.hub.recorder.folder), "note": self.late}

    # ---- marks -------------------------------------------------------------------------

    def do_mark(self, client, asked):
        text = str(asked.get("text", ""))[:trial.MARK_TEXT_MAX]
        self.mark(text, client)

    def mark(self, text, client=None):
        """With --control the controller is told of it, too, and gives a pulse at its pin (firmware/README.md)."""
        if self.site.is_replay:
            raise Refusal("A log takes no marks.")
        self.marks += 1
        if self.hub.recorder:
            self.hub.recorder.mark(self.marks, text, self.hub.newest_us or 0)
        self.hub.event({"kind": "mark", "tick": self.hub.decoder.tick, "number": self.marks, "text": text})
        if self.site.control:
            self.site.control.mark(client, self.marks)

    # ---- trials -------------------------------------------------------------------------

    async def do_record(self, client, asked):
        if asked["on"]:
            await self.begin(str(asked.get("subject", "")), str(asked.get("note", ""))[:500])
        else:
            await self.end()

    async def begin(self, code, note=""):
        """The disk is waited for in a thread: the walk's rows go on meanwhile."""
        hub, source = self.hub, self.site.source
        if self.site.is_replay:
            raise Refusal("A log is a record already.")
        if hub.recorder or self.is_beginning:
            raise Refusal("A recording is under way.")
        self.is_beginning = True
        told = {**self.description(code, note), "replay_from": self._replay_from()}
        try:
            recorder = await self._run(trial.Recorder, self.root, told, self.trouble, source.can_snapshot)
            before = hub.before.copy() if hub.before else None
            if source.can_snapshot:
                source.snapshot()
        except trial.TrialError as error:
            raise Refusal(str(error)) from error
        except OSError as error:
            raise Refusal(f"The walk takes no request now ({error.strerror}): try again.") from error
        finally:
            self.is_beginning = False
        self.late = LATE if told["replay_from"] == trial.NEXT_BOOT else ""
        hub.recorder = recorder
        recorder.start(before)
        await self.tell()

    def _replay_from(self):
        if self.site.source.can_snapshot:
            return trial.SNAPSHOT
        if self.hub.before and self.hub.before.packer:
            return trial.BEFORE_IT
        return trial.OWN_BOOT if self.hub.decoder.tick == 0 else trial.NEXT_BOOT

    @staticmethod
    async def _run(deed, *arguments):
        return await asyncio.get_running_loop().run_in_executor(None, deed, *arguments)

    def description(self, code, note):
        hub = self.hub
        parameters = dict(hub.subject["parameters"])
        control = getattr(self.site, "control", None)
        if control:
            parameters.update({name.split(".")[1]: value for name, value in control.values.items()
                               if name.startswith("parameters.")})
        return {"subject_code": code, "note": note, "begun_utc": datetime.datetime.now(datetime.timezone.utc).isoformat(),
                "source": self.site.name, "tick": hub.decoder.tick, "tick_s": hub.subject["tick_s"],
                "state": hub.state_words()["state"], "version": hub.subject["version"],
                "build_id": f"{hub.subject['build_id']:08x}", "parameters": parameters,
                "subject": {key: value for key, value in hub.subject.items() if key != "parameters"}}

    def trouble(self, text):
        """From the recorder's thread: the disk took no more."""
        asyncio.run_coroutine_threadsafe(self._failed(text), self.site.loop)

    async def _failed(self, text):
        self.hub.recorder = None
        self.hub.trouble(text)
        await self.tell()

    async def end(self):
        recorder, self.hub.recorder = self.hub.recorder, None
        if recorder is None:
            raise Refusal("No recording is under way.")
        lacks = await self._run(recorder.close)
        if lacks:
            self.hub.trouble(lacks)
        await self.tell()

    async def tell(self):
        self.trials = await self._run(trial.listing, self.root)
        self.hub.tell({"type": "recorder", "recorder": self.recorder_state()})
        self.hub.tell({"type": "trials", "trials": self.trials})

    # ---- what is made of them ------------------------------------------------------------

    async def folder(self, request, key):
        """A trial by its name: one of the list, and no path."""
        name = request.query.get(key, "")
        if name not in {one["name"] for one in await self._run(trial.listing, self.root)}:
            raise web.HTTPNotFound(text="There is no trial by that name.\n")
        return self.root / name

    async def make(self, tool, *arguments):
        """In a process of its own: it takes seconds, and the walk's rows go on meanwhile."""
        import sys
        here = pathlib.Path(__file__).resolve().parent
        async with self.makers:
            process = await asyncio.create_subprocess_exec(
                "nice", sys.executable, str(here / tool), "--afo", self.site.options.afo, *map(str, arguments),
                stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE)
            said, complaint = await process.communicate()
        if process.returncode != 0:
            raise web.HTTPUnprocessableEntity(text=complaint.decode("utf-8", "replace")[-2000:])
        return said

    async def get_report(self, request):
        self.site.guard.check_token(request)
        html = await self.make("report.py", "--out", "-", await self.folder(request, "trial"))
        return web.Response(body=html, content_type="text/html", charset="utf-8")

    async def get_compare(self, request):
        self.site.guard.check_token(request)
        html = await self.make("report.py", "--out", "-", await self.folder(request, "a"), await self.folder(request, "b"))
        return web.Response(body=html, content_type="text/html", charset="utf-8")

    async def get_export(self, request):
        self.site.guard.check_token(request)
        kind = request.query.get("kind", "")
        if kind not in EXPORTS:
            raise web.HTTPNotFound(text="Exports are csv, json, parquet and mcap.\n")
        data = await self.make("export.py", "--kind", kind, "--out", "-", await self.folder(request, "trial"))
        return web.Response(body=data, content_type=EXPORTS[kind])


class Telegrams(asyncio.DatagramProtocol):
    """UDP packets "TOKEN start [CODE]", "TOKEN stop", "TOKEN mark [TEXT]" begin and end a recording, and mark."""

    def __init__(self, site, keeping):
        self.site, self.keeping, self.turn, self.tasks = site, keeping, asyncio.Lock(), set()

    def connection_made(self, transport):
        self.transport = transport

    def datagram_received(self, data, address):
        words = data[:400].decode("utf-8", "replace").split(maxsplit=2)
        if len(words) < 2 or not self.site.guard.knows(words[0]):
            return  # who does not know the token gets no answer
        task = asyncio.ensure_future(self._obey(words[1], words[2].strip() if len(words) > 2 else "", address))
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    async def _obey(self, word, rest, address):
        """One packet after the other."""
        async with self.turn:
            try:
                if word == "start":
                    await self.keeping.begin(rest)
                elif word == "stop":
                    await self.keeping.end()
                elif word == "mark":
                    self.keeping.mark(rest)
                else:
                    raise Refusal("start, stop or mark")
                answer = "done"
            except Refusal as refusal:
                answer = f"refused: {refusal}"
        self.transport.sendto(answer.encode(), address)
