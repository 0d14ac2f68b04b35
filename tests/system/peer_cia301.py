"""Runs where vcan0 is: asks nodes from outside whether they behave as CiA 301 (version 4.2.0) says, frame by
frame, over python-can alone. Arguments: pairs of node number and kind (drive, sensor, controller).

Every line it prints is one answer: "ok" or "WRONG", the node, the clause, what was asked. The last line is
"done". A check that does not concern a kind of node says why not: the kinds it is for stand beside it.

Machines are loaded, so no check counts on a frame that comes within some time of this computer's clock. A node
works off its frames in order: what it has not sent before it answers a later question, it does not send. Its
own time is told by its heartbeats, the controller's by its SYNCs.
"""
import socket
import struct
import sys
import time

import can

SDO_WAIT_S = 20.0      # a guest on a busy machine
HEARTBEAT_MS = 20      # of nodes that are led: their states are known soon
QUIET_S = 0.12         # so long, by the node's time, nothing may come where nothing is due
SYNC_ID, TICKS_PER_S = 0x080, 1000
GAPS = 24              # between frames that a period is told by
SO_RCVBUFFORCE, RECEIVE_BYTES = 33, 1 << 24   # what the kernel keeps while this process waits for its turn
BOOT, STOPPED, OPERATIONAL, PRE_OPERATIONAL = 0, 4, 5, 127
START, STOP, ENTER_PRE, RESET_NODE, RESET_COMM = 1, 2, 128, 129, 130
TOGGLE, COMMAND = 0x05030000, 0x05040001
ACCESS, READ_ONLY, NO_OBJECT, NOT_MAPPABLE = 0x06010000, 0x06010002, 0x06020000, 0x06040041
PDO_LENGTH, INCOMPATIBLE = 0x06040042, 0x06040043
TOO_LONG, TOO_SHORT, NO_SUB = 0x06070012, 0x06070013, 0x06090011
VALUE, TOO_HIGH, TOO_LOW = 0x06090030, 0x06090031, 0x06090032
NOT_STORED, STATE, NO_DATA = 0x08000020, 0x08000022, 0x08000024
CHECKS = []
SLAVES = ("drive", "sensor")
ALL = SLAVES + ("controller",)


def check(clause, what, kinds=ALL):
    def add(function):
        CHECKS.append((clause, what, kinds, function))
        return function
    return add


class Node:
    """One node, seen from the bus."""

    def __init__(self, bus, number, kind):
        self.bus, self.number, self.kind = bus, number, kind
        self.tpdo = 0x1801 if kind == "controller" else 0x1803   # one that the checks may change
        self.tpdo_id = (0x290 if kind == "controller" else 0x480 + number)
        self.mapped = 0x20010108 if kind == "controller" else 0x10010008

    def drop(self):
        while self.bus.recv(0) is not None:
            pass

    def send(self, identifier, data, **flags):
        self.bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False, **flags))

    def hear(self, identifier, seconds, wanted=lambda data: True):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            frame = self.bus.recv(left)
            if frame is not None and frame.arbitration_id == identifier and not frame.is_remote_frame \
                    and wanted(bytes(frame.data)):
                return bytes(frame.data)
        return None

    def until_asked(self, *identifiers):
        """The frames with these identifiers that the node sends before it has answered a question put now."""
        self.send(0x600 + self.number, bytes([0x40, 0x18, 0x10, 1, 0, 0, 0, 0]))
        found, end = [], time.monotonic() + SDO_WAIT_S
        while (left := end - time.monotonic()) > 0:
            frame = self.bus.recv(left)
            if frame is None or frame.is_remote_frame:
                continue
            if frame.arbitration_id == 0x580 + self.number and bytes(frame.data[:4]) == b"\x43\x18\x10\1":
                return found
            if frame.arbitration_id in identifiers:
                found.append(bytes(frame.data))
        raise AssertionError("no answer to a question")

    def meanwhile(self, identifier, seconds=QUIET_S):
        """The frames with that identifier until so much time of the node's has passed: its heartbeats tell."""
        found, beats = self.until_asked(identifier), 1 + 1000 * seconds / HEARTBEAT_MS
        while beats > 0:
            frame = self.bus.recv(SDO_WAIT_S)
            assert frame is not None, "its time stands still"
            beats -= frame.arbitration_id == 0x700 + self.number
            if frame.arbitration_id == identifier:
                found.append(bytes(frame.data))
        return found

    # SDO
    def ask(self, *data, wait=SDO_WAIT_S):
        data = bytes(data)
        self.drop()
        self.send(0x600 + self.number, data + bytes(8 - len(data)))
        return self.hear(0x580 + self.number, wait)

    def start(self, command, index, sub, value=b""):
        return self.ask(command, index & 0xFF, index >> 8, sub, *value)

    def aborted(self, answer, *codes, of=None):
        assert answer is not None, "no answer"
        assert answer[0] == 0x80, f"no abort but {answer.hex()}"
        found = struct.unpack("<I", answer[4:])[0]
        assert found in codes, f"aborts with {found:08X}, not {' or '.join(f'{code:08X}' for code in codes)}"
        if of:
            assert struct.unpack("<HB", answer[1:4]) == of, f"names another object: {answer.hex()}"

    def read(self, index, sub):
        answer = self.start(0x40, index, sub)
        assert answer is not None and answer[0] >> 5 == 2, f"0x{index:04X}:{sub} is not read: {answer and answer.hex()}"
        if answer[0] & 2:
            assert answer[0] & 1, "expedited without its size"
            return answer[4:8 - (answer[0] >> 2 & 3)]
        length, value, toggle = struct.unpack("<I", answer[4:])[0], b"", 0
        while True:
            part = self.ask(0x60 | toggle)
            assert part is not None and part[0] >> 5 == 0 and part[0] & 0x10 == toggle, part and part.hex()
            value += part[1:8 - (part[0] >> 1 & 7)]
            toggle ^= 0x10
            if part[0] & 1:
                assert len(value) == length, (len(value), length)
                return value

    def number_of(self, index, sub):
        return int.from_bytes(self.read(index, sub), "little")

    def write(self, index, sub, value):
        return self.start(0x23 | (4 - len(value)) << 2, index, sub, value)

    def set(self, index, sub, value):
        answer = self.write(index, sub, value)
        assert answer == bytes([0x60, index & 0xFF, index >> 8, sub, 0, 0, 0, 0]), \
            f"0x{index:04X}:{sub} = {value.hex()}: {answer and answer.hex()}"

    def refuse(self, index, sub, value, *codes):
        self.aborted(self.write(index, sub, value), *codes, of=(index, sub))

    def period_ms(self, identifier):
        """Between two frames in the node's time. The controller's is told by its SYNCs. Of others the kernel
        tells when a frame was sent: a node that waits for its turn is late, never early, so the shortest mean
        over GAPS periods counts, and a machine that is busy gets time to show one."""
        if self.kind == "controller":
            for _ in range(2):       # the first gap after a change may be shorter
                assert self.hear(identifier, SDO_WAIT_S) is not None, "nothing comes"
            ticks, gaps = 0, 0
            while gaps < GAPS // 4:
                frame = self.bus.recv(SDO_WAIT_S)
                assert frame is not None, "nothing comes"
                ticks += frame.arbitration_id == SYNC_ID
                gaps += frame.arbitration_id == identifier
            return 1000 * ticks / TICKS_PER_S / gaps
        sent, shortest, end = [], None, time.monotonic() + SDO_WAIT_S
        while time.monotonic() < end and (shortest is None or shortest > 100):
            frame = self.bus.recv(SDO_WAIT_S)
            assert frame is not None, "nothing comes"
            if frame.arbitration_id == identifier:
                sent.append(1000 * frame.timestamp)
            if len(sent) > GAPS:
                mean = (sent[-1] - sent[-1 - GAPS]) / GAPS
                shortest = mean if shortest is None else min(shortest, mean)
        return shortest

    def come(self):
        """Waits until the node is on the bus: its program may still be starting."""
        end = time.monotonic() + 3 * SDO_WAIT_S
        while self.ask(0x40, 0, 0x10, 0, wait=0.5) is None:
            assert time.monotonic() < end, "not on the bus"
        self.until_asked()       # answers to what it was asked before are behind us

    # network management
    def nmt(self, command, number=None):
        self.drop()
        self.send(0, bytes([command, self.number if number is None else number]))

    def state_is(self, state):
        wanted = bytes([state])
        assert self.hear(0x700 + self.number, SDO_WAIT_S, lambda data: data == wanted), f"not in state {state}"

    def into(self, state):
        self.nmt({OPERATIONAL: START, PRE_OPERATIONAL: ENTER_PRE, STOPPED: STOP}[state])
        self.state_is(state)

    def anew(self):
        self.nmt(RESET_NODE)
        assert self.hear(0x700 + self.number, SDO_WAIT_S, lambda data: data == b"\0") is not None, "no boot-up"

    def map_tpdo(self, kind, entries=None):
        """The spare TPDO, from switched off to switched on (7.5.2.38)."""
        entries = [self.mapped] if entries is None else entries
        base = self.tpdo + 0x200
        self.set(self.tpdo, 1, u32(0xC0000000 | self.tpdo_id))
        self.set(base, 0, b"\0")
        for sub, entry in enumerate(entries, 1):
            self.set(base, sub, u32(entry))
        self.set(base, 0, bytes([len(entries)]))
        self.set(self.tpdo, 2, bytes([kind]))
        self.set(self.tpdo, 1, u32(0x40000000 | self.tpdo_id))

    def sync(self, data=b""):
        self.send(0x080, data)


def u32(value):
    return struct.pack("<I", value)


def u16(value):
    return struct.pack("<H", value)


# ---- SDO: 7.2.4 ---------------------------------------------------------------

@check("7.2.4.3.6", "an expedited upload names its object and its size")
def _(node):
    answer = node.start(0x40, 0x1000, 0)
    assert answer[0] == 0x43 and answer[1:4] == b"\x00\x10\x00", answer.hex()


@check("7.2.4.3.6", "an upload of two bytes says that two are unused")
def _(node):
    answer = node.start(0x40, 0x1017, 0)
    assert answer[0] == 0x4B and answer[6:] == b"\0\0", answer.hex()


@check("7.2.4.3.6", "an upload of one byte says that three are unused")
def _(node):
    answer = node.start(0x40, 0x1018, 0)
    assert answer[0] == 0x4F and answer[4:] == b"\x04\0\0\0", answer.hex()


@check("7.2.4.3.6", "a longer upload begins with its length")
def _(node):
    answer = node.start(0x40, 0x1008, 0)
    assert answer[0] == 0x41 and struct.unpack("<I", answer[4:])[0] > 4, answer.hex()


@check("7.2.4.3.7", "the segments of an upload alternate their toggle bit, and the last one says so")
def _(node):
    assert len(node.read(0x1008, 0)) > 7


@check("7.2.4.3.7", "a wrong toggle bit ends the upload")
def _(node):
    node.start(0x40, 0x1008, 0)
    node.aborted(node.ask(0x70), TOGGLE, of=(0x1008, 0))
    node.aborted(node.ask(0x60), COMMAND)


@check("7.2.4.3.7", "a segment that repeats the last toggle bit ends the upload")
def _(node):
    node.start(0x40, 0x1008, 0)
    assert node.ask(0x60)[0] >> 5 == 0
    node.aborted(node.ask(0x60), TOGGLE)


@check("7.2.4.3.7", "a segment that nobody began is refused")
def _(node):
    node.send(0x600 + node.number, bytes([0x80] + [0] * 7))
    node.aborted(node.ask(0x60), COMMAND)


@check("7.2.4.3.3", "an expedited download of the right length is confirmed")
def _(node):
    before = node.read(0x1015, 0)
    node.set(0x1015, 0, u16(77))
    assert node.read(0x1015, 0) == u16(77)
    node.set(0x1015, 0, before)


@check("7.2.4.3.3", "an expedited download without a size takes what the object holds")
def _(node):
    before = node.read(0x1015, 0)
    answer = node.start(0x22, 0x1015, 0, u16(78))
    assert answer[0] == 0x60, answer.hex()
    assert node.read(0x1015, 0) == u16(78)
    node.set(0x1015, 0, before)


@check("7.2.4.3.3", "a download that is too short is refused, and changes nothing")
def _(node):
    before = node.read(0x1015, 0)
    node.refuse(0x1015, 0, b"\1", TOO_SHORT, 0x06070010)
    assert node.read(0x1015, 0) == before


@check("7.2.4.3.3", "a download that is too long is refused, and changes nothing")
def _(node):
    before = node.read(0x1015, 0)
    node.refuse(0x1015, 0, b"\1\2\3\4", TOO_LONG, 0x06070010)
    assert node.read(0x1015, 0) == before


@check("7.2.4.3.4", "a download in a segment works for a short object, too")
def _(node):
    before = node.read(0x1016, 2)
    assert node.start(0x21, 0x1016, 2, u32(4))[0] == 0x60
    assert node.ask(0x07, *u32(0x00220123))[0] == 0x20
    assert node.number_of(0x1016, 2) == 0x00220123
    node.set(0x1016, 2, before)


@check("7.2.4.3.4", "a wrong toggle bit ends the download, and changes nothing")
def _(node):
    before = node.read(0x1016, 2)
    node.start(0x21, 0x1016, 2, u32(4))
    node.aborted(node.ask(0x17, *u32(0x00220123)), TOGGLE, of=(0x1016, 2))
    assert node.read(0x1016, 2) == before


@check("7.2.4.3.4", "a segment that nobody began is refused")
def _(node):
    node.send(0x600 + node.number, bytes([0x80] + [0] * 7))
    node.aborted(node.ask(0x07, 1, 2, 3, 4), COMMAND)


@check("7.2.4.3.4", "segments that hold more than was announced are refused")
def _(node):
    node.start(0x21, 0x1016, 2, u32(4))
    node.aborted(node.ask(0x01, *range(7)), TOO_LONG)


@check("7.2.4.3.4", "segments that hold less than was announced are refused")
def _(node):
    node.start(0x21, 0x1016, 2, u32(4))
    node.aborted(node.ask(0x09, 1, 2, 3), TOO_SHORT, 0x06070010)


@check("7.2.4.3.4", "segments without end are refused as too long, at the latest after 889 bytes")
def _(node):
    node.start(0x20, 0x1016, 2)
    for i in range(127):
        answer = node.ask(0x10 * (i & 1), *range(7))
        if answer[0] == 0x80:
            node.aborted(answer, TOO_LONG, of=(0x1016, 2))
            return
    raise AssertionError("takes 889 bytes for an object of 4")


@check("7.2.4.3.3", "a length that the object does not hold is refused at the beginning")
def _(node):
    node.aborted(node.start(0x21, 0x1016, 2, u32(1000)), TOO_LONG, of=(0x1016, 2))


@check("7.2.4.3.9", "a block download, which the node does not have, is refused")
def _(node):
    node.aborted(node.start(0xC2, 0x1016, 2, u32(4)), COMMAND, of=(0x1016, 2))


@check("7.2.4.3.13", "a block upload, which the node does not have, is refused")
def _(node):
    node.aborted(node.start(0xA0, 0x1008, 0, b"\x7F\0"), COMMAND, of=(0x1008, 0))


@check("7.2.4.3.17", "an unknown command specifier is refused")
def _(node):
    node.aborted(node.start(0xE0, 0x1000, 0), COMMAND)


@check("7.2.4.3.17", "an abort is not answered, and ends what was under way")
def _(node):
    node.start(0x40, 0x1008, 0)
    node.send(0x600 + node.number, bytes([0x80, 8, 0x10, 0, *u32(0x08000000)]))
    assert not node.until_asked(0x580 + node.number)
    node.start(0x40, 0x1008, 0)
    node.send(0x600 + node.number, bytes([0x80, 8, 0x10, 0, *u32(0x08000000)]))
    node.aborted(node.ask(0x60), COMMAND)


@check("7.2.4.3.17", "a new request ends what was under way")
def _(node):
    node.start(0x40, 0x1008, 0)
    assert len(node.read(0x1000, 0)) == 4
    node.aborted(node.ask(0x60), COMMAND)


@check("7.2.4.3.17", "an object that is not there is refused by name")
def _(node):
    node.aborted(node.start(0x40, 0x5FF0, 0), NO_OBJECT, of=(0x5FF0, 0))
    node.refuse(0x5FF0, 3, u32(1), NO_OBJECT)


@check("7.2.4.3.17", "a sub-index that is not there is refused by name")
def _(node):
    node.aborted(node.start(0x40, 0x1018, 9), NO_SUB, of=(0x1018, 9))
    node.refuse(0x1016, 99, u32(1), NO_SUB)


@check("7.2.4.3.17", "a sub-index of a variable is refused")
def _(node):
    node.aborted(node.start(0x40, 0x1000, 1), NO_SUB, of=(0x1000, 1))


@check("7.2.4.3.17", "what may only be read is not written")
def _(node):
    for index, sub, value in ((0x1000, 0, u32(1)), (0x1001, 0, b"\1"), (0x1018, 1, u32(1)), (0x1008, 0, b"name"),
                              (0x1016, 0, b"\1"), (0x1200, 0, b"\1")):
        node.refuse(index, sub, value, READ_ONLY)


@check("7.2.4.2", "a request that has not eight bytes is no request")
def _(node):
    node.drop()
    node.send(0x600 + node.number, bytes([0x40, 0, 0x10, 0]))
    assert not node.until_asked(0x580 + node.number)


@check("7.2.4.2", "a remote frame is no request")
def _(node):
    node.drop()
    node.send(0x600 + node.number, b"", is_remote_frame=True, dlc=8)
    assert not node.until_asked(0x580 + node.number)


# ---- the objects of the communication profile: 7.5.2 ----------------------------

@check("7.5.2.1", "0x1000 names the profile")
def _(node):
    profile = node.number_of(0x1000, 0) & 0xFFFF
    assert profile == {"drive": 402, "sensor": 406, "controller": 0}[node.kind], profile


@check("7.5.2.2", "0x1001 is one byte, and 0 without an error")
def _(node):
    assert node.read(0x1001, 0) in (b"\0", b"\x01", b"\x11"), node.read(0x1001, 0)


@check("7.5.2.4", "0x1003:0 counts its entries, and 0 empties it")
def _(node):
    node.set(0x1003, 0, b"\0")
    assert node.read(0x1003, 0) == b"\0"


@check("7.5.2.4", "0x1003:0 takes nothing but 0")
def _(node):
    node.refuse(0x1003, 0, b"\1", VALUE)
    node.refuse(0x1003, 0, b"\xFF", VALUE)


@check("7.5.2.4", "an entry of 0x1003 that holds no error is not read")
def _(node):
    for _ in range(10):                           # an error may come just then
        node.set(0x1003, 0, b"\0")
        answer = node.start(0x40, 0x1003, 1)
        if node.read(0x1003, 0) == b"\0":
            break
    node.aborted(answer, NO_DATA, 0x08000000, of=(0x1003, 1))


@check("7.5.2.4", "the entries of 0x1003 are not written")
def _(node):
    node.refuse(0x1003, 1, u32(0), READ_ONLY)


@check("7.5.2.5", "0x1005 names 0x080, and who sends SYNC says so")
def _(node):
    assert node.number_of(0x1005, 0) == (0x40000080 if node.kind == "controller" else 0x80)


@check("7.5.2.5", "0x1005 takes no 29 bits")
def _(node):
    node.refuse(0x1005, 0, u32(node.number_of(0x1005, 0) | 0x20000000), VALUE)


@check("7.5.2.5", "0x1005: a device that cannot send SYNC refuses to", SLAVES)
def _(node):
    node.refuse(0x1005, 0, u32(0x40000080), VALUE)


@check("7.5.2.5", "0x1005: the identifier stays while SYNC is sent", ("controller",))
def _(node):
    node.refuse(0x1005, 0, u32(0x40000081), VALUE)


@check("7.3.5", "0x1005 takes no restricted identifier")
def _(node):
    for identifier in (0, 0x7F, 0x101, 0x180, 0x581, 0x5FF, 0x601, 0x67F, 0x6E0, 0x6FF, 0x701, 0x7FF):
        node.refuse(0x1005, 0, u32(node.number_of(0x1005, 0) & 0x40000000 | identifier), VALUE)


@check("7.5.2.8", "0x1008, 0x1009 and 0x100A are texts")
def _(node):
    for index in (0x1008, 0x1009, 0x100A):
        text = node.read(index, 0)
        assert text and text.isascii() and b"\0" not in text, text


@check("7.5.2.11", "no node guarding: 0x100C is not there, or 0")
def _(node):
    answer = node.start(0x40, 0x100C, 0)
    assert answer[0] == 0x80 or answer[4:6] == b"\0\0", answer.hex()


@check("7.2.8.3.2.1", "no node guarding: a remote frame for the heartbeat is not answered")
def _(node):
    period = node.read(0x1017, 0)
    node.set(0x1017, 0, u16(0))
    node.drop()
    node.send(0x700 + node.number, b"", is_remote_frame=True, dlc=1)
    found = node.until_asked(0x700 + node.number)
    node.set(0x1017, 0, period)
    assert not found, found


@check("7.5.2.13", "0x1010 refuses what is not \"save\"", ("controller",))
def _(node):
    node.refuse(0x1010, 1, b"sive", NOT_STORED, 0x08000000)


@check("7.5.2.14", "0x1011 refuses what is not \"load\"", ("controller",))
def _(node):
    node.refuse(0x1011, 1, b"save", NOT_STORED, 0x08000000)


@check("7.5.2.17", "0x1014 is 0x080 and the node's number")
def _(node):
    assert node.number_of(0x1014, 0) == 0x80 + node.number


@check("7.5.2.19", "0x1016 takes no node number above 127 and no reserved bits")
def _(node):
    node.refuse(0x1016, 2, u32(128 << 16 | 100), VALUE)
    node.refuse(0x1016, 2, u32(0x01010064), VALUE)


@check("7.5.2.19", "0x1016 watches a node once")
def _(node):
    node.set(0x1016, 2, u32(99 << 16 | 5000))
    node.refuse(0x1016, 3, u32(99 << 16 | 6000), INCOMPATIBLE)
    node.set(0x1016, 3, u32(99 << 16))       # without a time it watches nobody
    node.set(0x1016, 3, u32(0))
    node.set(0x1016, 2, u32(0))


@check("7.5.2.20", "0x1017 is rw and is obeyed at once")
def _(node):
    period = node.read(0x1017, 0)
    node.set(0x1017, 0, u16(50))
    found = node.period_ms(0x700 + node.number)
    node.set(0x1017, 0, u16(0))
    time.sleep(QUIET_S)      # it may come late, but it was not sent before the answer
    none = node.until_asked(0x700 + node.number)
    node.set(0x1017, 0, period)
    assert not none and 45 <= found <= 100, (found, none)


@check("7.5.2.21", "0x1018 has four entries, and tells them")
def _(node):
    assert node.read(0x1018, 0) == b"\x04"
    assert [len(node.read(0x1018, sub)) for sub in (1, 2, 3, 4)] == [4] * 4


@check("7.5.2.22", "SYNC without a counter: 0x1019 is not there, or 0")
def _(node):
    answer = node.start(0x40, 0x1019, 0)
    if answer[0] == 0x80:
        node.aborted(answer, NO_OBJECT, of=(0x1019, 0))
    else:
        assert answer[4] == 0, answer.hex()


@check("7.5.2.32", "0x1029:1 takes 0, 1 and 2, and nothing reserved")
def _(node):
    before = node.read(0x1029, 1)
    for value in (0, 1, 2):
        node.set(0x1029, 1, bytes([value]))
    node.set(0x1029, 1, before)
    node.refuse(0x1029, 1, b"\3", VALUE, TOO_HIGH)


@check("7.5.2.33", "0x1200 names the identifiers of its server")
def _(node):
    assert node.read(0x1200, 0) == b"\2"
    assert node.number_of(0x1200, 1) == 0x600 + node.number
    assert node.number_of(0x1200, 2) == 0x580 + node.number


# ---- PDOs: 7.5.2.35 to 7.5.2.38 -----------------------------------------------------

@check("7.5.2.37", "TPDO: sub-index 0 is the highest there is, 4 is reserved")
def _(node):
    assert node.read(node.tpdo, 0) in (b"\5", b"\6")
    node.aborted(node.start(0x40, node.tpdo, 4), NO_SUB, of=(node.tpdo, 4))
    node.refuse(node.tpdo, 4, b"\0", NO_SUB)


@check("7.5.2.37", "TPDO: the identifier of one that lives is not changed")
def _(node):
    node.map_tpdo(254)
    node.refuse(node.tpdo, 1, u32(0x40000000 | 0x1F0), VALUE, STATE, ACCESS)


@check("7.5.2.37", "TPDO: no 29 bits")
def _(node):
    node.refuse(node.tpdo, 1, u32(0x60000000 | node.tpdo_id), VALUE)


@check("7.3.5", "TPDO: no restricted identifier, nor SYNC's")
def _(node):
    node.set(node.tpdo, 1, u32(0xC0000000 | node.tpdo_id))
    for identifier in (0, 0x7F, 0x80, 0x101, 0x180, 0x581, 0x5FF, 0x601, 0x67F, 0x6E0, 0x6FF, 0x701, 0x7FF):
        node.refuse(node.tpdo, 1, u32(0x40000000 | identifier), VALUE)


@check("7.5.2.37", "TPDO: reserved types, and those on remote request, are refused")
def _(node):
    for kind in (241, 251, 252, 253):
        node.refuse(node.tpdo, 2, bytes([kind]), VALUE, TOO_HIGH)


@check("7.5.2.37", "TPDO: types 0, 1, 240, 254 and 255 are taken")
def _(node):
    before = node.read(node.tpdo, 2)
    for kind in (0, 1, 240, 254, 255):
        node.set(node.tpdo, 2, bytes([kind]))
    node.set(node.tpdo, 2, before)


@check("7.5.2.37", "TPDO: the inhibit time of one that lives is not changed")
def _(node):
    node.map_tpdo(254)
    node.refuse(node.tpdo, 3, u16(10), ACCESS, STATE, VALUE)
    node.set(node.tpdo, 1, u32(0xC0000000 | node.tpdo_id))
    node.set(node.tpdo, 3, u16(10))
    node.set(node.tpdo, 3, u16(0))


@check("7.5.2.38", "TPDO: the map of one that lives is not changed")
def _(node):
    node.map_tpdo(254)
    node.refuse(node.tpdo + 0x200, 0, b"\0", ACCESS, STATE)
    node.refuse(node.tpdo + 0x200, 1, u32(node.mapped), ACCESS, STATE)


@check("7.5.2.38", "TPDO: an entry is not changed while the map counts it")
def _(node):
    node.map_tpdo(254)
    node.set(node.tpdo, 1, u32(0xC0000000 | node.tpdo_id))
    node.refuse(node.tpdo + 0x200, 1, u32(node.mapped), ACCESS, STATE)


@check("7.5.2.38", "TPDO: an object that is not there, or may not be mapped, is refused")
def _(node):
    node.set(node.tpdo, 1, u32(0xC0000000 | node.tpdo_id))
    node.set(node.tpdo + 0x200, 0, b"\0")
    node.refuse(node.tpdo + 0x200, 1, u32(0x5FF00020), NO_OBJECT)
    node.refuse(node.tpdo + 0x200, 1, u32(0x10180920), NO_SUB)
    node.refuse(node.tpdo + 0x200, 1, u32(0x10000020), NOT_MAPPABLE)
    node.refuse(node.tpdo + 0x200, 1, u32(0x00050008), NOT_MAPPABLE)   # dummies are for RPDOs


@check("7.5.2.38", "TPDO: a length that is not the object's is refused")
def _(node):
    node.refuse(node.tpdo + 0x200, 1, u32(node.mapped + 8), NOT_MAPPABLE, PDO_LENGTH)


@check("7.5.2.38", "TPDO: more entries than there are, or than fit, are refused")
def _(node):
    node.set(node.tpdo, 1, u32(0xC0000000 | node.tpdo_id))
    node.set(node.tpdo + 0x200, 0, b"\0")
    node.refuse(node.tpdo + 0x200, 0, b"\x41", PDO_LENGTH, VALUE, TOO_HIGH)
    big = {"drive": 0x60640020, "sensor": 0x60040020, "controller": 0x20010320}[node.kind]
    for sub in (1, 2, 3):
        node.set(node.tpdo + 0x200, sub, u32(big))
    node.refuse(node.tpdo + 0x200, 0, b"\3", PDO_LENGTH)
    node.set(node.tpdo + 0x200, 0, b"\2")


@check("7.5.2.37", "TPDO: remote requests are not answered, and its identifier says so")
def _(node):
    node.map_tpdo(1 if node.kind != "controller" else 254)
    assert node.number_of(node.tpdo, 1) & 0x40000000
    if node.kind == "controller":
        return                                    # operational it stays, and sends by itself
    node.into(OPERATIONAL)
    node.drop()
    node.send(node.tpdo_id, b"", is_remote_frame=True, dlc=1)
    found = node.until_asked(node.tpdo_id)
    node.into(PRE_OPERATIONAL)
    assert not found


@check("7.2.2.2", "a TPDO of type 1 comes with every SYNC, and never without", SLAVES)
def _(node):
    node.map_tpdo(1)
    node.into(OPERATIONAL)
    node.drop()
    assert not node.meanwhile(node.tpdo_id)
    for _ in range(5):
        node.sync()
        assert node.hear(node.tpdo_id, SDO_WAIT_S) is not None
    node.into(PRE_OPERATIONAL)


@check("7.2.2.2", "a TPDO of type 3 comes with every third SYNC", SLAVES)
def _(node):
    node.map_tpdo(3)
    node.into(OPERATIONAL)
    found = []
    for _ in range(7):
        node.drop()
        node.sync()
        found.append(len(node.until_asked(node.tpdo_id)))
    node.into(PRE_OPERATIONAL)
    assert found == [0, 0, 1, 0, 0, 1, 0], found


@check("7.2.2.2", "a TPDO of type 255 with an event time comes by the clock, and without SYNC")
def _(node):
    node.map_tpdo(255)
    node.set(node.tpdo, 5, u16(50))
    if node.kind != "controller":
        node.into(OPERATIONAL)
    found = node.period_ms(node.tpdo_id)
    if node.kind != "controller":
        node.into(PRE_OPERATIONAL)
    node.set(node.tpdo, 5, u16(0 if node.kind != "controller" else 100))
    assert 45 <= found <= 100, found


@check("7.2.2.2", "no PDO in PRE-OPERATIONAL", SLAVES)
def _(node):
    node.map_tpdo(1)
    node.sync()
    assert not node.until_asked(node.tpdo_id)
    assert not node.meanwhile(node.tpdo_id)


@check("7.2.5", "a SYNC of one byte, with a counter, is a SYNC", SLAVES)
def _(node):
    node.map_tpdo(1)
    node.into(OPERATIONAL)
    node.drop()
    node.sync(b"\1")
    found = node.hear(node.tpdo_id, SDO_WAIT_S)
    node.into(PRE_OPERATIONAL)
    assert found is not None


@check("7.5.2.35", "RPDO: there are as many as the object dictionary says")
def _(node):
    if node.kind == "controller":
        node.aborted(node.start(0x40, 0x1400, 1), NO_OBJECT, of=(0x1400, 1))
    else:
        for number in range(4):
            assert len(node.read(0x1400 + number, 1)) == 4
        node.aborted(node.start(0x40, 0x1404, 1), NO_OBJECT, of=(0x1404, 1))


@check("7.5.2.35", "RPDO: no 29 bits, no restricted identifier, no reserved type", SLAVES)
def _(node):
    node.refuse(0x1403, 1, u32(0x20000500 | node.number), VALUE)
    for identifier in (0, 0x7F, 0x80, 0x180, 0x600 + node.number, 0x701):
        node.refuse(0x1403, 1, u32(identifier), VALUE)
    for kind in (241, 253):
        node.refuse(0x1403, 2, bytes([kind]), VALUE, TOO_HIGH)


def rpdo(node, entries, kind=255):
    node.set(0x1403, 1, u32(0x80000500 | node.number))
    node.set(0x1603, 0, b"\0")
    for sub, entry in enumerate(entries, 1):
        node.set(0x1603, sub, u32(entry))
    node.set(0x1603, 0, bytes([len(entries)]))
    node.set(0x1403, 2, bytes([kind]))
    node.set(0x1403, 1, u32(0x500 | node.number))


@check("7.5.2.36", "RPDO: dummies fill a map, and what may not be mapped is refused", SLAVES)
def _(node):
    rpdo(node, [0x00050008, 0x00070020])
    node.set(0x1403, 1, u32(0x80000500 | node.number))
    node.set(0x1603, 0, b"\0")
    node.refuse(0x1603, 1, u32(0x10180120), NOT_MAPPABLE)
    node.refuse(0x1603, 1, u32(0x5FF00020), NO_OBJECT)


def emcy(node, code):
    wanted = u16(code)
    return node.hear(0x080 + node.number, SDO_WAIT_S, lambda data: data[:2] == wanted)


@check("7.2.7", "EMCY 0x8210 when a PDO is too short, 0x0000 when it is right again", SLAVES)
def _(node):
    rpdo(node, [0x00070020])
    node.set(0x1003, 0, b"\0")
    node.into(OPERATIONAL)
    node.drop()
    node.send(0x500 + node.number, b"\1\2")
    frame = emcy(node, 0x8210)
    assert frame is not None and len(frame) == 8 and frame[2] & 0x11 == 0x11, frame
    assert node.number_of(0x1001, 0) & 0x11 == 0x11
    node.drop()
    node.send(0x500 + node.number, bytes(4))
    frame = emcy(node, 0)
    node.into(PRE_OPERATIONAL)
    assert frame is not None and frame[2] & 0x10 == 0, frame


@check("7.5.2.4", "an error is the first entry of 0x1003, its code in the lower half", SLAVES)
def _(node):
    assert node.number_of(0x1003, 0) >= 1
    assert node.number_of(0x1003, 1) & 0xFFFF == 0x8210, hex(node.number_of(0x1003, 1))


@check("7.2.7", "EMCY 0x8220 when a PDO is too long; its first bytes are taken", SLAVES)
def _(node):
    rpdo(node, [0x00070020])
    node.into(OPERATIONAL)
    node.drop()
    node.send(0x500 + node.number, bytes(6))
    frame = emcy(node, 0x8220)
    node.send(0x500 + node.number, bytes(4))
    over = emcy(node, 0)
    node.into(PRE_OPERATIONAL)
    assert frame is not None and over is not None


@check("7.2.7", "an error that lasts is told once", SLAVES)
def _(node):
    rpdo(node, [0x00070020])
    node.into(OPERATIONAL)
    node.drop()
    for _ in range(5):
        node.send(0x500 + node.number, b"\1")
    found = [data for data in node.meanwhile(0x080 + node.number, 2 * QUIET_S) if data[:2] == u16(0x8210)]
    node.send(0x500 + node.number, bytes(4))
    node.into(PRE_OPERATIONAL)
    assert len(found) == 1, found


# ---- network management: 7.2.8, 7.3.2 -------------------------------------------------

@check("7.2.8.3.3", "boot-up is one frame of one byte 0, and PRE-OPERATIONAL follows by itself", SLAVES)
def _(node):
    node.until_asked()
    node.nmt(RESET_NODE)
    found = [node.hear(0x700 + node.number, SDO_WAIT_S) for _ in range(4)]
    while found[0] == bytes([PRE_OPERATIONAL]):   # was on its way when it was reset
        found = found[1:] + [node.hear(0x700 + node.number, SDO_WAIT_S)]
    assert found == [b"\0"] + 3 * [bytes([PRE_OPERATIONAL])], found


@check("7.2.8.2.1.1", "the five commands lead to their states", SLAVES)
def _(node):
    for state in (OPERATIONAL, STOPPED, PRE_OPERATIONAL, STOPPED, OPERATIONAL, PRE_OPERATIONAL):
        node.into(state)
    for command in (RESET_COMM, RESET_NODE):
        node.nmt(command)
        node.state_is(BOOT)
        node.state_is(PRE_OPERATIONAL)


@check("7.2.8.2.1.1", "node 0 means all nodes", SLAVES)
def _(node):
    node.nmt(START, 0)
    node.state_is(OPERATIONAL)
    node.nmt(ENTER_PRE, 0)
    node.state_is(PRE_OPERATIONAL)


@check("7.2.8.2.1.1", "another node's command, an unknown one, one of a wrong length change nothing", SLAVES)
def _(node):
    node.into(PRE_OPERATIONAL)
    node.nmt(START, 101)
    node.nmt(77)
    for data in (b"\1", bytes([1, node.number, 0]), b""):
        node.send(0, data)
    node.until_asked()
    found = node.meanwhile(0x700 + node.number, 2 * QUIET_S)
    assert found and set(found) == {bytes([PRE_OPERATIONAL])}, found


@check("7.2.8.2.1.1", "the network's master is led by nobody", ("controller",))
def _(node):
    for command in (STOP, ENTER_PRE, RESET_COMM, RESET_NODE):
        node.nmt(command)
        node.nmt(command, 0)
    for _ in range(2):
        assert node.hear(0x700 + node.number, SDO_WAIT_S) == bytes([OPERATIONAL])


@check("7.3.2.2.4", "a stopped node answers no SDO and sends no PDO, but its heartbeat", SLAVES)
def _(node):
    node.map_tpdo(1)
    node.into(STOPPED)
    node.drop()
    node.sync()
    node.send(0x600 + node.number, bytes([0x40, 0, 0x10, 0, 0, 0, 0, 0]))
    node.send(0, bytes([ENTER_PRE, node.number]))
    found = node.until_asked(node.tpdo_id, 0x580 + node.number)
    assert not found, found
    node.into(STOPPED)
    for _ in range(3):
        assert node.hear(0x700 + node.number, SDO_WAIT_S) == bytes([STOPPED])
    node.into(PRE_OPERATIONAL)


@check("7.3.2.2.4", "an SDO that a stop cut short does not go on afterwards", SLAVES)
def _(node):
    node.start(0x40, 0x1008, 0)
    node.into(STOPPED)
    node.into(PRE_OPERATIONAL)
    node.aborted(node.ask(0x60), COMMAND)


@check("7.3.2.2.1", "reset communication gives the communication objects back what they were", SLAVES)
def _(node):
    period = node.read(0x1015, 0)
    node.set(0x1015, 0, u16(999))
    node.set(0x1016, 4, u32(0x00600064))
    node.nmt(RESET_COMM)
    node.state_is(BOOT)
    assert node.read(0x1015, 0) == period
    assert node.number_of(0x1016, 4) == 0


PROFILE = {"drive": (0x6066, 0), "sensor": (0x6200, 0)}


@check("7.3.2.2.1", "reset communication leaves the profile's objects alone, reset node does not", SLAVES)
def _(node):
    index, sub = PROFILE[node.kind]
    before = node.read(index, sub)
    node.set(index, sub, u16(321))
    node.nmt(RESET_COMM)
    node.state_is(BOOT)
    assert node.read(index, sub) == u16(321)
    node.anew()
    assert node.read(index, sub) == before


@check("7.2.8.3.2.2", "the heartbeat tells the state in one byte")
def _(node):
    assert node.hear(0x700 + node.number, SDO_WAIT_S) in (bytes([PRE_OPERATIONAL]), bytes([OPERATIONAL]))


def lost(node, behaviour):
    """A heartbeat that was heard and ceases, in OPERATIONAL; gives back the emergency."""
    node.set(0x1029, 1, bytes([behaviour]))
    node.set(0x1016, 3, u32(100 << 16 | 100))
    if node.kind != "controller":
        node.into(OPERATIONAL)
    node.drop()
    node.send(0x700 + 100, b"\5")
    if behaviour == 2:               # a stopped node may not tell
        return None
    return emcy(node, 0x8130)


@check("7.2.8.2.2.2", "a heartbeat that ceases is EMCY 0x8130, its return 0x0000", SLAVES)
def _(node):
    frame = lost(node, 1)
    node.drop()
    node.send(0x700 + 100, b"\5")
    back = emcy(node, 0)
    node.into(PRE_OPERATIONAL)
    node.set(0x1016, 3, u32(0))
    assert frame is not None and frame[2] & 0x10 and back is not None, (frame, back)


@check("7.2.8.2.2.2", "a heartbeat that never came is not missed", SLAVES)
def _(node):
    node.set(0x1016, 3, u32(101 << 16 | 100))
    node.into(OPERATIONAL)
    found = [data for data in node.meanwhile(0x080 + node.number, 2 * QUIET_S) if data[:2] == u16(0x8130)]
    node.into(PRE_OPERATIONAL)
    node.set(0x1016, 3, u32(0))
    assert not found, found


@check("7.5.2.32", "0x1029:1 = 0 leads to PRE-OPERATIONAL, 1 to nothing, 2 to STOPPED", SLAVES)
def _(node):
    before = node.read(0x1029, 1)
    for behaviour, state in ((0, PRE_OPERATIONAL), (1, OPERATIONAL), (2, STOPPED)):
        assert lost(node, behaviour) is not None or behaviour == 2
        node.state_is(state)
        node.into(PRE_OPERATIONAL)
        node.set(0x1016, 3, u32(0))
    node.set(0x1029, 1, before)


def ask_all(node):
    wrong = 0
    for clause, what, kinds, function in CHECKS:
        if node.kind not in kinds:
            continue
        try:
            if node.kind != "controller":
                node.nmt(ENTER_PRE)
                node.set(0x1017, 0, u16(HEARTBEAT_MS))
            function(node)
            verdict, why = "ok", ""
        except (AssertionError, TypeError, IndexError) as error:
            verdict, why, wrong = "WRONG", f": {error}", wrong + 1
        print(f"{verdict} | {node.kind} {node.number} | CiA 301, {clause} | {what}{why}", flush=True)
    return wrong


def main(arguments):
    wanted = [identifier for number in map(int, arguments[::2])
              for identifier in (0x080 + number, 0x480 + number, 0x580 + number, 0x700 + number)] + [0x290]
    wanted += [SYNC_ID] if "controller" in arguments else []
    bus = can.Bus(interface="socketcan", channel="vcan0",
                  can_filters=[{"can_id": identifier, "can_mask": 0x7FF} for identifier in wanted])
    bus.socket.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, RECEIVE_BYTES)
    wrong = 0
    try:
        for number, kind in zip(arguments[::2], arguments[1::2]):
            node = Node(bus, int(number), kind)
            node.come()
            if kind != "controller":
                node.anew()
            wrong += ask_all(node)
    finally:
        bus.shutdown()
    print("done")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
