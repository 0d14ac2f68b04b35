"""One browser: what waits for it, and how fast it may ask."""
import asyncio
import json
import math
import time

WAITING_MAX_BYTES = 8 << 20   # a stalled browser misses what is beyond, and is told
SEND_LIMIT_S = 20.0
REQUESTS_A_SECOND, REQUESTS_AT_ONCE = 50, 200


class Client:
    def __init__(self, socket, may_control):
        self.socket, self.may_control = socket, may_control
        self.waiting, self.bytes, self.skipped = asyncio.Queue(), 0, 0
        self.allowance, self.allowed_at = REQUESTS_AT_ONCE, time.monotonic()

    def put(self, message):
        """Queues rows (bytes) or an event (dict); never waits."""
        data = message if isinstance(message, bytes) else json.dumps(clean(message), allow_nan=False, default=str)
        if self.bytes + len(data) > WAITING_MAX_BYTES:
            self.skipped += 1
            return
        if self.skipped:
            note = json.dumps({"type": "skipped", "messages": self.skipped})
            self.skipped = 0
            self.bytes += len(note)
            self.waiting.put_nowait(note)
        self.bytes += len(data)
        self.waiting.put_nowait(data)

    async def write(self):
        """Sends what waits, until the browser is gone or takes nothing for too long."""
        try:
            while True:
                data = await self.waiting.get()
                send = self.socket.send_bytes if isinstance(data, bytes) else self.socket.send_str
                await asyncio.wait_for(send(data), SEND_LIMIT_S)
                self.bytes -= len(data)
        except (ConnectionError, asyncio.TimeoutError):
            pass

    async def drained(self):
        """Waits until nothing waits, two seconds at most."""
        for _ in range(100):
            if self.bytes == 0:
                break
            await asyncio.sleep(0.02)

    def has_room(self, length):
        return self.bytes + length <= WAITING_MAX_BYTES

    def may_ask(self):
        """False when it asks faster than a person can."""
        now = time.monotonic()
        self.allowance = min(REQUESTS_AT_ONCE, self.allowance + REQUESTS_A_SECOND * (now - self.allowed_at))
        self.allowed_at = now
        self.allowance -= 1
        return self.allowance >= 0


def clean(value):
    """Numbers that JSON has not become null."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: clean(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [clean(one) for one in value]
    return value
