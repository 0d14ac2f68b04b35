"""Who may come in: hosts, origins, the token, and how many connections there may be."""
import asyncio
import hmac
import resource
import secrets
import time

from aiohttp import web

CONNECTIONS_MAX, CLIENTS_MAX, SILENT_S = 128, 32, 10.0
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
                               "img-src 'self' data: blob:; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; "
                               "form-action 'none'",
    "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin", "Cross-Origin-Resource-Policy": "same-origin"}


class Guard:
    def __init__(self, listen, names):
        self.token = secrets.token_urlsafe(18)
        self.names = {"127.0.0.1", "localhost", "[::1]", *(name for name in names.split(",") if name)}
        if listen not in ("0.0.0.0", "::"):
            self.names.add(f"[{listen}]" if ":" in listen else listen)
        self.hosts, self.asked = set(), set()

    def is_at(self, port):
        self.hosts = {f"{name}:{port}" for name in self.names} | (self.names if port == 80 else set())

    def knows(self, token):
        return hmac.compare_digest(token.encode("utf-8", "replace"), self.token.encode())

    def check(self, request):
        """Another host name or origin is a page of somebody else that reaches for this server."""
        if request.headers.getall("Host", []) not in [[host] for host in self.hosts]:
            raise web.HTTPForbidden(text="This server is not called by that name (see --names).\n")
        origin = request.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in self.hosts}:
            raise web.HTTPForbidden(text="Pages of other origins are not served.\n")

    def check_token(self, request):
        words = request.headers.get("Authorization", "").split()
        if len(words) != 2 or words[0] != "Bearer" or not self.knows(words[1]):
            raise web.HTTPForbidden(text="The token is missing or wrong: use the address that afo view printed.\n")

    @web.middleware
    async def middleware(self, request, handler):
        self.asked.add(request.protocol)
        try:
            self.check(request)
            response = await handler(request)
        except web.HTTPException as refusal:
            refusal.headers.update(HEADERS)
            raise
        if not response.prepared:
            response.headers.update(HEADERS)
        return response


class Refused(asyncio.Protocol):
    def connection_made(self, transport):
        transport.abort()


class Door:
    """Accepts connections, a bounded number; closes those that say nothing."""

    def __init__(self, server, guard):
        self.server, self.guard, self.made = server, guard, {}
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (hard if hard < 65536 else max(soft, 4096), hard))

    def __call__(self):
        if len(self.server.connections) >= CONNECTIONS_MAX:
            return Refused()
        protocol = self.server()
        self.made[protocol] = time.monotonic()
        return protocol

    async def watch(self):
        while True:
            await asyncio.sleep(1.0)
            for protocol, since in list(self.made.items()):
                if protocol in self.guard.asked or protocol not in self.server.connections:
                    del self.made[protocol]
                elif time.monotonic() - since > SILENT_S:
                    protocol.transport.abort()
            self.guard.asked.intersection_update(self.server.connections)
