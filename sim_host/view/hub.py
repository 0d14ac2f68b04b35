"""Everything that comes from the source, to everybody who looks: rows of signals, events in words."""
import collections
import struct
import time

import numpy as np

import frames
import signals
import words
from findings import before_fault
from gait import Gait
from places import dbc_path
from settling import Settling
from trial import MARK_BEGIN, MARK_TEXT, MarkReader

HISTORY_TICKS = 30000
HEADER = struct.Struct("<IIHHId")  # kind, first tick, rows, columns, walk's number, wall clock in ms
ROWS = 1
SDO_REQUEST, SDO_ANSWER = 0x610, 0x590
HEARTBEAT_CONTROLLER = 0x710
EVENTS_KEPT, CHANGES_KEPT = 4000, 2000


class History:
    """The newest rows, by their ticks."""

    def __init__(self, ticks=HISTORY_TICKS):
        self.rows = np.full((ticks, signals.COUNT), np.nan, np.float32)
        self.next = 0

    def add(self, rows):
        for part in range(0, len(rows), len(self.rows)):
            piece = rows[part:part + len(self.rows)]
            self.rows[(self.next + np.arange(len(piece))) % len(self.rows)] = piece
            self.next += len(piece)

    def get(self, first, last):
        """(first tick, rows) of what is still there of these ticks."""
        first = max(first, self.next - len(self.rows), 0)
        last = min(last, self.next)
        return first, self.rows[np.arange(first, max(last, first)) % len(self.rows)]


class Past:
    """The newest events and rows, as findings.py wants them."""

    def __init__(self, hub):
        self.hub, self.tick_s = hub, hub.subject["tick_s"]
        events = list(hub.events)
        self.events = [one for one in events[:-200] if one["kind"] == "write"] + events[-200:]

    def rows_of(self, name, first, last):
        """(first tick that is there, values)."""
        at, rows = self.hub.history.get(first, last)
        return at, rows[:, signals.INDEX[name]]


class SdoWatch:
    """Who wrote what to the controller, whatever tool it was: read off the bus."""

    def __init__(self, objects):
        self.objects = objects
        self.asked = {}  # (index, sub) -> value, of writes without an answer so far; tools take turns
        self.client = 0

    def take(self, identifier, data):
        """Returns an event for an answered write, else None."""
        command, index, sub = data[0], int.from_bytes(data[1:3], "little"), data[3]
        if identifier == SDO_REQUEST:
            if command >> 5 == 1 and command & 2:  # expedited download
                size = 4 - (command >> 2 & 3) if command & 1 else 4
                self.asked[index, sub] = data[4:4 + size]
            return None
        if (index, sub) not in self.asked or command not in (0x60, 0x80):
            return None
        value = self.asked.pop((index, sub))
        done = command == 0x60
        if (index, sub) == (0x2000, 5):
            self.client = value[3] if done and value[:3] == b"set" else self.client
        entry = self.objects.by_address(index, sub)
        event = {"kind": "write", "name": entry["name"] if entry else f"0x{index:04X}:{sub:02X}", "done": done,
                 "client": self.client, "value": self.objects.number(entry, value) if entry else value.hex()}
        if not done:
            event["abort"] = int.from_bytes(data[4:8], "little")
        return event


class Hub:
    def __init__(self, subject, objects, dbc=None, events_kept=EVENTS_KEPT):
        self.subject, self.objects = subject, objects
        self.dbc = dbc or dbc_path()
        self.events_kept = events_kept
        self.clients = set()
        self.recorder = None
        self.before = None  # of a bus: before.py
        self.listeners = []  # called with every array of records
        self.is_over, self.trouble_text, self.lost_frames, self.walk = False, "", 0, 0
        self._fresh()

    def _fresh(self):
        self.decoder = signals.Decoder(self.subject, self.dbc)
        self.gait = Gait(self.subject)
        self.history = History()
        self.events = collections.deque(maxlen=self.events_kept)
        self.changes = collections.deque(maxlen=CHANGES_KEPT)
        self.state, self.fault_number, self.was_fault = None, None, False
        self.first_us = self.newest_us = None
        self.sdo, self.marks = SdoWatch(self.objects), MarkReader()
        self.settling = Settling(self.subject)
        names = ("TELEMETRY", "CONTROLLER_STATE")
        emergencies = [name for name in self.decoder.by_name if name.startswith("EMCY_")]
        self.identifier = {name: self.decoder.by_name[name] for name in names}
        self.emergency_ids = {self.decoder.by_name[name] for name in emergencies}
        self.interest = np.array([*self.identifier.values(), *self.emergency_ids, SDO_REQUEST, SDO_ANSWER,
                                  HEARTBEAT_CONTROLLER, *range(MARK_BEGIN, MARK_TEXT + 26)], np.uint32)

    # ---- from the source ---------------------------------------------------------

    def begin(self):
        """Another walk begins: everything was switched off and on."""
        if self.decoder.tick == 0:
            return
        self._fresh()
        self.walk += 1
        self.tell({"type": "begin", "walk": self.walk})
        if self.recorder:
            self.recorder.note("walk", "everything was switched off and on")

    def lost(self, count):
        self.lost_frames += count
        self.tell({"type": "trouble", "text": f"{count} frames were lost between walk and view"})
        if self.recorder:
            self.recorder.incomplete(f"{count} frames were lost between walk and view")

    def trouble(self, text):
        if text != self.trouble_text:
            self.trouble_text = text
            self.tell({"type": "trouble", "text": text})

    def ended(self):
        self.is_over = True
        self.tell({"type": "over"})

    def take(self, records):
        if len(records) == 0:
            return
        for listener in list(self.listeners):
            listener(records)
        if self.recorder:
            self.recorder.take(records)
        if self.before:
            self.before.take(records)
        if self.first_us is None:
            self.first_us = int(records["time_us"][0])
        self.newest_us = int(records["time_us"][-1])
        first = self.decoder.tick
        rows, at, seen = self.decoder.take(records)
        if len(rows) == 0:
            return
        rows = rows.copy()
        events = self.gait.take(rows, first) + self._events_of(at, seen)
        self.history.add(rows)
        if self.clients:
            self.broadcast(rows_message(first, rows, self.walk))
        for event in sorted(events, key=lambda one: one["tick"]):
            self._happened(event)

    def _happened(self, event):
        self.gait.follow(event)
        if event["kind"] == "record":
            event = self.gait.step(event["tick"], event["record"])
        if event is None:
            return
        self.event(event)
        for finding in self.settling.take(event):
            self.event(finding)
        if event["kind"] == "state" and event["fault_number"] and not self.was_fault:
            self.event({"kind": "finding", "tick": event["tick"], "fault": event["fault"]["name"],
                        "notes": before_fault(Past(self), event["tick"])})
        if event["kind"] == "state":
            self.was_fault = bool(event["fault_number"])

    # ---- what frames say -----------------------------------------------------------

    def _events_of(self, at, seen):
        events = []
        for place in np.flatnonzero(np.isin(seen["id"], self.interest)).tolist():
            event = self._event_of(int(at[place]), int(seen["id"][place]), seen["data"][place].tobytes(),
                                   int(seen["length"][place]))
            if event is not None:
                events.append(event)
        return events

    def _event_of(self, tick, identifier, data, length):
        if identifier == self.identifier["TELEMETRY"]:
            word = np.frombuffer(data, "<u8")
            record = {name: float(field.value(word)[0]) for name, field in self.decoder.field[identifier].items()}
            return {"kind": "record", "tick": tick, "record": record}
        if identifier == self.identifier["CONTROLLER_STATE"]:
            return self._state(tick, data)
        if identifier in self.emergency_ids:
            return {"kind": "emergency", "tick": tick, **words.emergency(identifier, data)}
        if identifier in (SDO_REQUEST, SDO_ANSWER) and length == 8:
            event = self.sdo.take(identifier, data)
            if event is not None:
                event["tick"] = tick
                self.changes.append(event)
            return event
        if MARK_BEGIN <= identifier <= MARK_TEXT + 25:
            whole = self.marks.take(identifier, data, length)
            return {"kind": "mark", "tick": tick, "number": whole[0], "text": whole[1]} if whole else None
        if identifier == HEARTBEAT_CONTROLLER and data[:1] == b"\0" and tick > 0:
            return {"kind": "boot", "tick": tick, "text": "the controller started"}
        return None

    def _state(self, tick, data):
        state, stop, fault = data[0] & 0x7F, data[0] >> 7, data[1]
        if (state, stop, fault) == (self.state, None, self.fault_number):
            return None
        if state == self.state and fault == self.fault_number:
            return None
        self.state, self.fault_number = state, fault
        return {"kind": "state", "tick": tick, "emergency_stop": bool(stop), **self.state_words()}

    def state_words(self):
        names, faults = self.subject["states"], self.subject["faults"]
        name = names[self.state] if self.state is not None and self.state < len(names) else "unknown"
        number = self.fault_number or 0
        fault = words.fault(faults[number] if number < len(faults) else f"fault {number}")
        return {"state": name, "state_text": words.STATES.get(name, ""), "fault": fault, "fault_number": number}

    def event(self, event):
        self.events.append(event)
        if self.recorder:
            self.recorder.event(event)
        self.tell({"type": "event", "walk": self.walk, **event})

    # ---- to those who look -----------------------------------------------------------

    def tell(self, message):
        for client in list(self.clients):
            client.put(message)

    def broadcast(self, data):
        for client in list(self.clients):
            client.put_live(data)

    def time_s(self):
        return self.decoder.tick * self.subject["tick_s"]


def rows_message(first, rows, walk=0):
    """Rows as one binary message: the header, then column by column."""
    return HEADER.pack(ROWS, first, rows.shape[0], rows.shape[1], walk, time.time() * 1000) + \
        np.ascontiguousarray(rows.T, np.float32).tobytes()
