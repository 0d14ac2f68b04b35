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
    FRAME, STAMP = struct.Struct("=IB3x8s"), struct.Struct("=qq")
    # CAN_RAW_ERR_FILTER, SO_TIMESTAMP, SO_RCVBUFFORCE, SO_RXQ_OVFL: Python has no names for them
    ERROR_FILTER, TIMESTAMP, BUFFER, LOST = 2, 29, 33, 40
    BUFFER_BYTES = 64 << 20  # a frame takes nearly a kilobyte there
    ERRORS_ALL = 0x1FFFFFFF

    def __init__(self, interface):
        self.name = f"the bus {interface}"
        self.interface = interface
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.socket.setsockopt(socket.SOL_CAN_RAW, self.ERROR_FILTER, self.ERRORS_ALL)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_RECV_OWN_MSGS, 1)
        self._enlarge()
        self.socket.setsockopt(socket.SOL_SOCKET, self.LOST, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, self.TIMESTAMP, 1)
        self.socket.bind((interface,))
        self.socket.setblocking(False)

    def _enlarge(self):
        """As far as this user may."""
        try:
            self.socket.setsockopt(socket.SOL_SOCKET, self.BUFFER, self.BUFFER_BYTES)
        except PermissionError:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, self.BUFFER_BYTES)

    def start(self, hub):
        self.hub, self.lost = hub, 0
        self.task = asyncio.get_running_loop().create_task(self._poll())

    async def _poll(self):
        while True:
            await asyncio.sleep(0.008)
            self._read()

    def _read(self):
        rows, lost = [], self.lost
        receive, unpack = self.socket.recvmsg, self.FRAME.unpack
        try:
            while len(rows) < 20000:
                data, ancillary, _, _ = receive(16, 128)
                identifier, length, payload = unpack(data)
                time_us = None
                for _, kind, value in ancillary:
                    if kind == self.TIMESTAMP:
                        seconds, micro = self.STAMP.unpack(value)
                        time_us = seconds * 1000000 + micro
                    elif kind == self.LOST:
                        lost = int.from_bytes(value, "little")
                rows.append((time_us or time.time_ns() // 1000, identifier, length, (0, 0, 0), tuple(payload)))
        except BlockingIOError:
            pass
        except OSError as error:
            self.hub.trouble(f"{self.interface}: {error.strerror}")
        if rows:
            self.hub.take(np.array(rows, frames.RECORD))
        if lost != self.lost:
            self.hub.lost(lost - self.lost)
            self.lost = lost

    def send(self, identifier, data):
        self.socket.send(self.FRAME.pack(identifier, len(data), data.ljust(8, b"\0")))
