"""Where frames come from: the walk in the process that started us, a bus, or a log."""
import asyncio
import socket
import struct
import time

import numpy as np

import frames

CHUNK = 1 << 18


class WalkSource:
    """The walker in the parent process, over the socket that it gave us."""

    name = "the walker in this process"
    can_snapshot = True

    def __init__(self, fd):
        self.socket = socket.socket(fileno=fd)
        self.socket.setblocking(False)
        self.part = b""

    def start(self, hub):
        self.hub = hub
        asyncio.get_running_loop().add_reader(self.socket, self._read)

    def _read(self):
        try:
            got = self.socket.recv(CHUNK)
        except BlockingIOError:
            return
        if not got:
            asyncio.get_running_loop().remove_reader(self.socket)
            self.hub.ended()
            return
        got = self.part + got
        whole = len(got) // frames.RECORD.itemsize * frames.RECORD.itemsize
        self.part = got[whole:]
        records = np.frombuffer(got[:whole], frames.RECORD)
        notes = np.flatnonzero((records["id"] == frames.BEGIN) | (records["id"] == frames.LOST))
        start = 0
        for at in notes.tolist():
            self.hub.take(records[start:at])
            start = at + 1
            if records["id"][at] == frames.BEGIN:
                self.hub.begin()
            else:
                self.hub.lost(int.from_bytes(records["data"][at].tobytes()[:4], "little"))
        self.hub.take(records[start:])

    def send(self, identifier, data):
        self.socket.send(frames.record(identifier, data))

    def snapshot(self):
        self.send(frames.SNAPSHOT, b"")

    def restart(self):
        self.send(frames.RESTART, b"")


class CanSource:
    """A CAN interface of Linux. Sends only when asked to; the own frames come back at their place."""

    can_snapshot = False
    FRAME = struct.Struct("=IB3x8s")
    ERRORS_ALL = 0x1FFFFFFF

    def __init__(self, interface):
        self.name = f"the bus {interface}"
        self.interface = interface
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_ERR_FILTER, self.ERRORS_ALL)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_RECV_OWN_MSGS, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, getattr(socket, "SO_RCVBUFFORCE", 33), 8 << 20)
        self.socket.setsockopt(socket.SOL_SOCKET, 29, 1)  # SO_TIMESTAMP
        self.socket.bind((interface,))
        self.socket.setblocking(False)

    def start(self, hub):
        self.hub = hub
        asyncio.get_running_loop().create_task(self._poll())

    async def _poll(self):
        while True:
            await asyncio.sleep(0.008)
            self._read()

    def _read(self):
        rows = []
        receive, unpack = self.socket.recvmsg, self.FRAME.unpack
        try:
            while len(rows) < 20000:
                data, ancillary, _, _ = receive(16, 64)
                identifier, length, payload = unpack(data)
                stamp = ancillary[0][2] if ancillary else b""
                seconds, micro = struct.unpack("=qq", stamp) if len(stamp) == 16 else divmod(time.time_ns() // 1000, 10**6)
                rows.append((seconds * 1000000 + micro, identifier, length, (0, 0, 0), tuple(payload)))
        except BlockingIOError:
            pass
        except OSError as error:
            self.hub.trouble(f"{self.interface}: {error.strerror}")
            return
        if rows:
            self.hub.take(np.array(rows, frames.RECORD))

    def send(self, identifier, data):
        self.socket.send(self.FRAME.pack(identifier, len(data), data.ljust(8, b"\0")))
