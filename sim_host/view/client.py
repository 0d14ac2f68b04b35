"""One browser: what waits for it, and how fast it may ask."""
import asyncio
import collections
import json
import math
import time

WAITING_MAX_BYTES = 8 << 20   # a stalled browser misses what is beyond, and is told
LATE_MAX_BYTES = 2 << 20      # twelve seconds of rows: what is older than that is not live
SEND_LIMIT_S, LOADING_S = 20.0, 10.0
REQUESTS_A_SECOND, REQUESTS_AT_ONCE = 50, 200


class Client:
    def __init__(self, socket, may_control):
        self.socket, self.may_control = socket, may_control
        self.words, self.rows, self.there = collections.deque(), collections.deque(), asyncio.Event()
        self.bytes = self.row_bytes = self.skipped = 0
        self.loading_until = 0.0
        self.allowance, self.allowed_at = REQUESTS_AT_ONCE, time.monotonic()

    def put(self, message):
        """Queues rows (bytes) or an event (dict); never waits. Words overtake rows; what is beyond is left out, and told."""
        is_rows = isinstance(message, bytes)
        data = message if is_rows else json.dumps(clean(message), allow_nan=False, default=str)
        if self.bytes + len(data) > WAITING_MAX_BYTES:
            self.skipped += 1
            return
        if self.skipped and not is_rows:
            self._queue(self.words, json.dumps({"type": "skipped", "messages": self.skipped}))
            self.skipped = 0
        self._queue(self.rows if is_rows else self.words, data)

    def put_live(self, data):
        """Rows that are worth something now only: a browser that is behind by more misses them."""
        if self.row_bytes + len(data) > LATE_MAX_BYTES and not self.is_loading():
            self.skipped += 1
            return
        self.put(data)

    def is_loading(self):
        """It asked for the past, and has not taken it yet."""
        return time.monotonic() < self.loading_until

    def expects_past(self):
        self.loading_until = time.monotonic() + LOADING_S

    def _queue(self, queue, data):
        queue.append(data)
        self.bytes += len(data)
        self.row_bytes += len(data) if queue is self.rows else 0
        self.there.set()

    async def write(self):
        """Sends what waits, until the browser is gone or takes nothing for too long."""
        try:
            while True:
                while not self.words and not self.rows:
                    self.there.clear()
                    await self.there.wait()
                is_rows = not self.words
                data = (self.rows if is_rows else self.words).popleft()
                send = self.socket.send_bytes if is_rows else self.socket.send_str
                await asyncio.wait_for(send(data), SEND_LIMIT_S)
                self.bytes -= len(data)
                self.row_bytes -= len(data) if is_rows else 0
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
