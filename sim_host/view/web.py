"""The page and its web socket."""
import asyncio
import contextlib
import json
import pathlib
import signal

import numpy as np
from aiohttp import WSMsgType, web

import frames
import hub as hubs
import signals
from before import Before
from client import Client
from guard import CLIENTS_MAX, HEADERS, Door, Guard
from keeping import Keeping, Telegrams
from objects import Objects
from places import eds_path
from refusal import Refusal
from source import CanSource, WalkSource

HERE = pathlib.Path(__file__).resolve().parent
TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
MESSAGE_MAX = 16384
PIECE_TICKS, RANGE_TICKS_MAX = 1000, 60000
END_S = 2.0  # a browser that is stopped does not hold the end


def page_files():
    """{path: (type, bytes)}: all that is ever served."""
    root = HERE / "page"
    files = {"/" + str(path.relative_to(root)): (TYPES[path.suffix], path.read_bytes())
             for path in sorted(root.rglob("*")) if path.suffix in TYPES}
    files["/"] = files["/index.html"]
    return files


class Site:
    def __init__(self, options, subject, complain):
        self.options, self.complain = options, complain
        objects = Objects(options.afo, eds_path())
        self.hub = hubs.Hub(subject, objects, events_kept=None if options.replay else hubs.EVENTS_KEPT)
        self.guard = Guard(options.listen, options.names)
        self.files = page_files()
        self.source = None
        self.is_replay = options.replay is not None
        self.name = "nothing"
        self.deeds = {"range": self.do_range}  # further ones: control.py, trials.py
        self.hello_parts = []
        self.routes = []
        self.farewells = []  # called with a browser that has gone
        self.control = self.commissioning = self.loop = None

    def open_source(self):
        options = self.options
        if self.is_replay:
            self.name = f"the log {options.replay}"
            load_log(self.hub, options.replay, self.complain)
        elif options.can:
            self.source = CanSource(options.can)
            self.hub.before = Before()
        else:
            self.source = WalkSource(options.fd)
            if self.hub.subject["recording"]:
                self.source.name = f"the recording {self.hub.subject['recording']}"
        self.name = self.source.name if self.source else self.name

    def open_deeds(self):
        """What browsers may ask for beside looking."""
        self.keeping = Keeping(self)
        if self.options.control and self.source:
            from control import Control  # canopen is needed for this only
            self.control = Control(self)
            from commissioning import Commissioning
            self.commissioning = Commissioning(self)

    # ---- HTTP -------------------------------------------------------------------------

    async def get_file(self, request):
        found = self.files.get(request.path)
        if found is None:
            raise web.HTTPNotFound(text="There is nothing by that name.\n")
        return web.Response(body=found[1], content_type=found[0], charset="utf-8")

    async def get_socket(self, request):
        """The token comes as a subprotocol, the one header that a page can choose."""
        offered = [one.strip() for one in request.headers.get("Sec-WebSocket-Protocol", "").split(",")]
        token = next((one[6:] for one in offered if one.startswith("token.")), "")
        if not self.guard.knows(token):
            raise web.HTTPForbidden(text="The token is missing or wrong.\n")
        if len(self.hub.clients) >= CLIENTS_MAX:
            raise web.HTTPServiceUnavailable(text=f"There are {CLIENTS_MAX} browsers already.\n")
        socket = web.WebSocketResponse(protocols=("afo.v1",), max_msg_size=MESSAGE_MAX, heartbeat=30.0, compress=False)
        socket.headers.update(HEADERS)
        await socket.prepare(request)
        client = Client(socket, self.options.control)
        client.put(self.hello())
        self.hub.clients.add(client)
        writer = asyncio.ensure_future(client.write())
        try:
            await self.listen(socket, client, writer)
        finally:
            self.hub.clients.discard(client)
            for farewell in self.farewells:
                farewell(client)
            writer.cancel()
            await asyncio.gather(writer, return_exceptions=True)
        return socket

    async def listen(self, socket, client, writer):
        while not writer.done():
            reader = asyncio.ensure_future(socket.receive())
            await asyncio.wait({reader, writer}, return_when=asyncio.FIRST_COMPLETED)
            if writer.done():  # it took nothing for too long, or is gone
                reader.cancel()
                break
            message = reader.result()
            if message.type != WSMsgType.TEXT:
                break
            if not client.may_ask():
                await socket.close(code=1008, message=b"too many requests")
                break
            await self.answer(client, message.data)
        if not socket.closed:
            socket._req.transport.abort() if socket._req and socket._req.transport else None

    async def answer(self, client, text):
        try:
            asked = json.loads(text)
            deed = self.deeds[asked["do"]]
        except (ValueError, KeyError, TypeError):
            client.put({"type": "refused", "text": "This is no request that the server knows."})
            return
        try:
            result = deed(client, asked)
            if asyncio.iscoroutine(result):
                await result
        except Refusal as refusal:
            client.put({"type": "refused", "do": asked["do"], "text": str(refusal), "name": asked.get("name")})
        except (KeyError, TypeError, ValueError, OverflowError):
            client.put({"type": "refused", "do": asked["do"], "text": "The request lacks something, or has a wrong type."})

    # ---- what a browser is told ---------------------------------------------------------

    def hello(self):
        hub = self.hub
        told = {"type": "hello", "mode": "replay" if self.is_replay else "live", "source": self.name,
                "control": self.options.control, "signals": signals.descriptions(), "subject": hub.subject,
                "tick": hub.decoder.tick, "walk": hub.walk, "events": list(hub.events), "over": hub.is_over,
                "trouble": hub.trouble_text, **hub.state_words()}
        for part in self.hello_parts:
            told.update(part())
        return told

    def do_range(self, client, asked):
        first, last = int(asked["first"]), int(asked["last"])
        client.expects_past()
        last = min(last, first + RANGE_TICKS_MAX)
        for start in range(first, last, PIECE_TICKS):
            at, rows = self.hub.history.get(start, min(start + PIECE_TICKS, last))
            if not client.has_room(rows.nbytes + hubs.HEADER.size):
                break  # it did not take what it asked for before
            if len(rows):
                client.put(hubs.rows_message(at, rows, self.hub.walk))
        client.put({"type": "range", "first": first, "last": last})

    # ---- the whole ------------------------------------------------------------------------

    async def serve(self):
        application = web.Application(middlewares=[self.guard.middleware], client_max_size=MESSAGE_MAX)
        application.router.add_get("/live", self.get_socket)
        for method, path, handler in self.routes:
            application.router.add_route(method, path, handler)
        application.router.add_get("/{path:.*}", self.get_file)
        runner = web.AppRunner(application, access_log=None, keepalive_timeout=15.0)
        await runner.setup()
        loop = self.loop = asyncio.get_running_loop()
        door = Door(runner.server, self.guard)
        server = await loop.create_server(door, self.options.listen, self.options.port, backlog=64)
        port = server.sockets[0].getsockname()[1]
        self.guard.is_at(port)
        name = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(self.options.listen, self.options.listen)
        print(f"afo view: http://{name}:{port}/#{self.guard.token}", flush=True)
        if self.options.control:
            print("afo view: the page may control. Its stop button is no emergency stop.", flush=True)
        watch = asyncio.ensure_future(door.watch())
        telegrams, _ = await loop.create_datagram_endpoint(lambda: Telegrams(self, self.keeping),
                                                           local_addr=(self.options.listen, port))
        await self.until_over(loop)
        watch.cancel()
        telegrams.close()
        server.close()
        clients = list(self.hub.clients)
        await asyncio.gather(*(client.drained() for client in clients))
        await asyncio.gather(*(asyncio.wait_for(client.socket.close(code=1001), END_S) for client in clients), return_exceptions=True)
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(runner.cleanup(), 2 * END_S)

    async def until_over(self, loop):
        done = asyncio.Event()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            loop.add_signal_handler(number, done.set)
        if isinstance(self.source, WalkSource):
            loop.add_signal_handler(signal.SIGINT, lambda: None)  # a terminal's goes to the walk, too: its end is ours
        if self.source:
            self.source.start(self.hub)
        if self.control:
            self.control.start()
        if isinstance(self.source, WalkSource):
            ended = self.hub.ended

            def end():
                ended()
                done.set()
            self.hub.ended = end
        await done.wait()
        if self.commissioning:
            self.commissioning.interrupt()
        if self.hub.recorder:
            await loop.run_in_executor(None, self.hub.recorder.close)


def load_log(hub, path, complain):
    """The whole log into the hub, once: what a slider goes through."""
    path = pathlib.Path(path)
    log = path / "bus.log" if path.is_dir() else path
    with open(log, "rb") as stream:
        records, _ = frames.parse_log(stream, log, lambda lines: complain(f"{log}: {lines} lines read"),
                                      tolerate_cut=path.is_dir())
    syncs = int(np.count_nonzero(records["id"] == frames.SYNC))
    hub.history = hubs.History(max(syncs, 1))
    for start in range(0, len(records), 200000):
        hub.take(records[start:start + 200000])
    hub.is_over = True


def run(options, subject, complain):
    try:
        site = Site(options, subject, complain)
        site.open_source()
        site.open_deeds()
    except (OSError, frames.BadLine) as error:
        complain(f"{error}")
        return 2
    try:
        asyncio.run(site.serve())
    except OSError as error:
        complain(f"{options.listen}:{options.port}: {error.strerror}; choose another port with --port")
        return 2
    return 0
