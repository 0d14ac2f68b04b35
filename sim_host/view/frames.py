"""Frames of the bus: as records on a socket (sim_host/loop/frame_stream.h) and as lines of a candump log."""
import re

import numpy as np

RECORD = np.dtype([("time_us", "<u8"), ("id", "<u4"), ("length", "u1"), ("reserved", "u1", 3), ("data", "u1", 8)])
ID_EXTENDED, ID_REMOTE, ID_ERROR = 1 << 31, 1 << 30, 1 << 29
LOST, BEGIN, SNAPSHOT, RESTART = 0x70000001, 0x70000002, 0x70000003, 0x70000004
SYNC = 0x080
IDENTITY = ID_EXTENDED | 0x1AB00000
# (0000000012.000345) vcan0 181#37160000E803, with an optional direction behind it
LINE = re.compile(rb"\(\s*(\d+)\.(\d{1,6})\) (\S+) ([0-9A-Fa-f]{3}|[0-9A-Fa-f]{8})#(R\d?|(?:[0-9A-Fa-f]{2}){0,8})(?: [RT])?\s*$")


class BadLine(ValueError):
    """A line that is none of a candump log; says which."""


def parse_log(stream, path="the log", progress=None, tolerate_cut=False):
    """All frames of an open binary candump log as an array of RECORD, and the interface's name. tolerate_cut: the last
    line may be cut short, as a killed recorder leaves it."""
    times, ids, lengths, data = [], [], [], []
    interface = None
    for number, line in enumerate(stream, 1):
        match = LINE.match(line)
        if match is None:
            if tolerate_cut and not line.endswith(b"\n"):
                break
            if line.strip():
                raise BadLine(f"{path}, line {number}: no line of a candump log: {line[:60]!r}")
            continue
        seconds, fraction, name, identifier, payload = match.groups()
        interface = interface or name
        if name != interface:
            continue  # the log of several buses: the first one's
        value = int(identifier, 16)
        if len(identifier) == 8:
            value = value if value & ID_ERROR else value | ID_EXTENDED
        if payload[:1] == b"R":
            value |= ID_REMOTE
            payload = b""
        times.append(int(seconds) * 1000000 + int(fraction.ljust(6, b"0")))
        ids.append(value)
        lengths.append(len(payload) // 2)
        data.append(payload)
        if progress and number % 500000 == 0:
            progress(number)
    records = np.zeros(len(times), RECORD)
    records["time_us"], records["id"], records["length"] = times, ids, lengths
    packed = b"".join(bytes.fromhex(one.decode()).ljust(8, b"\0") for one in data)
    records["data"] = np.frombuffer(packed, "u1").reshape(-1, 8)
    return records, (interface or b"can0").decode()


def log_lines(records, interface="can0"):
    """Records as text of a candump log; notes of the stream, which are no frames, are left out."""
    lines = []
    for time_us, identifier, length, data in zip(records["time_us"].tolist(), records["id"].tolist(),
                                                 records["length"].tolist(), _hex_of(records["data"])):
        if is_note(identifier):
            continue
        if identifier & ID_EXTENDED:
            name = f"{identifier & 0x1FFFFFFF:08X}"
        elif identifier & ID_ERROR:
            name = f"{identifier:08X}"
        else:
            name = f"{identifier & 0x7FF:03X}"
        payload = "R" if identifier & ID_REMOTE else data[:2 * length]
        lines.append(f"({time_us // 1000000:010d}.{time_us % 1000000:06d}) {interface} {name}#{payload}\n")
    return "".join(lines)


def _hex_of(data):
    text = data.tobytes().hex().upper()
    return [text[i:i + 16] for i in range(0, len(text), 16)]


def is_note(identifier):
    return 0x70000000 < identifier < 0x70000010


def record(identifier, data=b"", time_us=0):
    """One record, as bytes for the socket."""
    one = np.zeros(1, RECORD)
    one["time_us"], one["id"], one["length"] = time_us, identifier, len(data)
    one["data"][0, :len(data)] = np.frombuffer(data, "u1")
    return one.tobytes()
