"""Marks and trials, as browsers and UDP packets ask for them."""
import asyncio
import datetime
import pathlib

from aiohttp import web

import trial
from refusal import Refusal

EXPORTS = {"csv": "text/csv", "parquet": "application/vnd.apache.parquet", "mcap": "application/octet-stream"}


class Keeping:
    def __init__(self, site):
        self.site, self.hub = site, site.hub
        self.root = pathlib.Path(site.options.trials)
        self.marks = 0
        site.deeds.update({"mark": self.do_mark, "record": self.do_record})
        site.hello_parts.append(self.hello)
        site.routes += [("GET", "/report", self.get_report), ("GET", "/compare", self.get_compare),
                        ("GET", "/export", self.get_export)]

    def hello(self):
        return {"trials": trial.listing(self.root), "recorder": self.recorder_state()}

    def recorder_state(self):
        return {"folder": str(self.hub.recorder.folder)} if self.hub.recorder else None

    # ---- marks -------------------------------------------------------------------------

    def do_mark(self, client, asked):
        text = str(asked.get("text", ""))[:trial.MARK_TEXT_MAX]
        self.mark(text)

    def mark(self, text):
        if self.site.is_replay:
            raise Refusal("A log takes no marks.")
        self.marks += 1
        if self.hub.recorder:
            self.hub.recorder.mark(self.marks, text, self.hub.newest_us or 0)
        self.hub.event({"kind": "mark", "tick": self.hub.decoder.tick, "number": self.marks, "text": text})

    # ---- trials -------------------------------------------------------------------------

    def do_record(self, client, asked):
        if asked["on"]:
            self.begin(str(asked.get("subject", "")), str(asked.get("note", ""))[:500])
        else:
            self.end()

    def begin(self, code, note=""):
        if self.site.is_replay:
            raise Refusal("A log is a record already.")
        if self.hub.recorder:
            raise Refusal("A recording is under way.")
        source = self.site.source
        try:
            self.hub.recorder = trial.Recorder(self.root, self.description(code, note), self.trouble,
                                               getattr(source, "can_snapshot", False))
        except trial.TrialError as error:
            raise Refusal(str(error)) from error
        if source.can_snapshot:
            source.snapshot()
        self.tell()

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
        loop = self.site.loop
        loop.call_soon_threadsafe(self._failed, text)

    def _failed(self, text):
        self.hub.recorder = None
        self.hub.trouble(text)
        self.tell()

    def end(self):
        recorder, self.hub.recorder = self.hub.recorder, None
        if recorder is None:
            raise Refusal("No recording is under way.")
        asyncio.ensure_future(self._close(recorder))

    async def _close(self, recorder):
        lacks = await asyncio.get_running_loop().run_in_executor(None, recorder.close)
        if lacks:
            self.hub.trouble(lacks)
        self.tell()

    def tell(self):
        self.hub.tell({"type": "recorder", "recorder": self.recorder_state()})
        self.hub.tell({"type": "trials", "trials": trial.listing(self.root)})

    # ---- what is made of them ------------------------------------------------------------

    def folder(self, request, key):
        """A trial by its name: one of the list, and no path."""
        name = request.query.get(key, "")
        if name not in {one["name"] for one in trial.listing(self.root)}:
            raise web.HTTPNotFound(text="There is no trial by that name.\n")
        return self.root / name

    async def make(self, tool, *arguments):
        """In a process of its own: it takes seconds, and the walk's rows go on meanwhile."""
        import sys
        here = pathlib.Path(__file__).resolve().parent
        process = await asyncio.create_subprocess_exec(
            "nice", sys.executable, str(here / tool), "--afo", self.site.options.afo, *map(str, arguments),
            stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE)
        said, complaint = await process.communicate()
        if process.returncode != 0:
            raise web.HTTPUnprocessableEntity(text=complaint.decode("utf-8", "replace")[-2000:])
        return said

    async def get_report(self, request):
        self.site.guard.check_token(request)
        html = await self.make("report.py", "--out", "-", self.folder(request, "trial"))
        return web.Response(body=html, content_type="text/html", charset="utf-8")

    async def get_compare(self, request):
        self.site.guard.check_token(request)
        html = await self.make("report.py", "--out", "-", self.folder(request, "a"), self.folder(request, "b"))
        return web.Response(body=html, content_type="text/html", charset="utf-8")

    async def get_export(self, request):
        self.site.guard.check_token(request)
        kind = request.query.get("kind", "")
        if kind not in EXPORTS:
            raise web.HTTPNotFound(text="Exports are csv, parquet and mcap.\n")
        data = await self.make("export.py", "--kind", kind, "--out", "-", self.folder(request, "trial"))
        return web.Response(body=data, content_type=EXPORTS[kind])


class Telegrams(asyncio.DatagramProtocol):
    """UDP packets "TOKEN start [CODE]", "TOKEN stop", "TOKEN mark [TEXT]" begin and end a recording, and mark."""

    def __init__(self, site, keeping):
        self.site, self.keeping = site, keeping

    def connection_made(self, transport):
        self.transport = transport

    def datagram_received(self, data, address):
        words = data[:400].decode("utf-8", "replace").split(maxsplit=2)
        if len(words) < 2 or not self.site.guard.knows(words[0]):
            return  # who does not know the token gets no answer
        rest = words[2].strip() if len(words) > 2 else ""
        deeds = {"start": lambda: self.keeping.begin(rest), "stop": self.keeping.end,
                 "mark": lambda: self.keeping.mark(rest)}
        try:
            deeds[words[1]]()
            answer = "done"
        except KeyError:
            answer = "refused: start, stop or mark"
        except Refusal as refusal:
            answer = f"refused: {refusal}"
        self.transport.sendto(answer.encode(), address)
