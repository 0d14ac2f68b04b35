"""A trial: one folder with the frames, what happened, and who walked with what.

    bus.log          every frame, as candump -L writes it; notes in 29-bit identifiers hold snapshot and marks
    events.jsonl     marks, changes, faults, steps, a JSON object a line
    trial.json       subject by its code, device, versions, parameters
    INCOMPLETE       as long as the trial was not ended: what is missing

Written at least once a second, and then made sure of: a killed server or a full disk loses at most that much.
"""
import datetime
import json
import os
import pathlib
import queue
import re
import threading
import time

import numpy as np

import frames

MARK_BEGIN, MARK_TEXT = frames.ID_EXTENDED | 0x1AB20000, frames.ID_EXTENDED | 0x1AB20001
MARK_TEXT_MAX = 200
SYNC_S = 0.5  # half of what may be lost
MARKER = "INCOMPLETE"


class TrialError(Exception):
    """Why a trial cannot be recorded, or read."""


def mark_records(number, text, time_us):
    """A mark as notes in the log."""
    data = text.encode("utf-8")[:MARK_TEXT_MAX]
    head = number.to_bytes(4, "little") + len(data).to_bytes(4, "little")
    parts = [frames.record(MARK_BEGIN, head, time_us)]
    parts += [frames.record(MARK_TEXT + i // 8, data[i:i + 8], time_us) for i in range(0, len(data), 8)]
    return np.frombuffer(b"".join(parts), frames.RECORD)


class MarkReader:
    """Marks out of a log, from their notes."""

    def __init__(self):
        self.number, self.length, self.text = None, 0, b""

    def take(self, identifier, data, length):
        """Returns (number, text) when a mark is whole."""
        if identifier == MARK_BEGIN and length == 8:
            self.number, self.text = int.from_bytes(data[:4], "little"), b""
            self.length = int.from_bytes(data[4:8], "little")
        elif self.number is not None and identifier == MARK_TEXT + len(self.text) // 8:
            self.text += data[:length]
        if self.number is None or len(self.text) < self.length:
            return None
        number, self.number = self.number, None
        return number, self.text.decode("utf-8", "replace")


def folder_name(root, code):
    if not re.fullmatch(r"[A-Za-z0-9_-]{0,20}", code):
        raise TrialError("The code of the subject has letters, digits, - and _ only, 20 at most; and is no name.")
    stamp = datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d-%H%M%S")
    base = f"{stamp}-{code or 'nobody'}"
    for number in range(1, 100):
        path = root / (base if number == 1 else f"{base}-{number}")
        if not path.exists():
            return path
    raise TrialError(f"{root} has a hundred trials of this second")


class Recorder:
    """Writes in a thread of its own; the server never waits for a disk."""

    def __init__(self, root, description, on_trouble, wait_for_snapshot):
        root = pathlib.Path(root)
        self.folder = folder_name(root, description["subject_code"])
        self.on_trouble, self.waits = on_trouble, wait_for_snapshot
        self.queue, self.failed, self.first_us = queue.Queue(), None, None
        try:
            self.folder.mkdir(parents=True)
            write_whole(self.folder / MARKER, "This trial was not ended: up to its last second may be missing.\n")
            write_whole(self.folder / "trial.json", json.dumps(description, indent=1) + "\n")
            self.log = open(self.folder / "bus.log", "wb")
            self.events = open(self.folder / "events.jsonl", "wb")
            sync_folder(self.folder)
            sync_folder(root)
        except OSError as error:
            raise TrialError(f"{self.folder}: {error.strerror}") from error
        self.thread = threading.Thread(target=self._write, name="trial", daemon=True)
        self.thread.start()

    # ---- from the hub -------------------------------------------------------------

    def take(self, records):
        if self.waits:
            found = np.flatnonzero(records["id"] == frames.IDENTITY)
            if len(found) == 0:
                return
            records, self.waits = records[found[0]:], False
        self.queue.put(("log", records))

    def mark(self, number, text, time_us):
        if not self.waits:
            self.queue.put(("log", mark_records(number, text, time_us)))

    def event(self, event):
        self.queue.put(("event", event))

    def note(self, kind, text):
        self.queue.put(("event", {"kind": kind, "tick": 0, "text": text}))

    def incomplete(self, text):
        self.queue.put(("incomplete", text))

    def close(self):
        """Ends the trial. Returns None, or why it is incomplete."""
        self.queue.put(("end", None))
        self.thread.join(30.0)
        return self.failed

    # ---- the thread ------------------------------------------------------------------

    def _write(self):
        synced, lacks = time.monotonic(), None
        try:
            while True:
                try:
                    kind, what = self.queue.get(timeout=SYNC_S)
                except queue.Empty:
                    kind, what = "nothing", None
                if kind == "log":
                    self.log.write(frames.log_lines(what).encode())
                elif kind == "event":
                    self.events.write((json.dumps(what, default=str) + "\n").encode())
                elif kind == "incomplete":
                    lacks = what
                    write_whole(self.folder / MARKER, what + "\n")
                if time.monotonic() - synced >= SYNC_S or kind == "end":
                    self._sync()
                    synced = time.monotonic()
                if kind == "end":
                    break
            if lacks is None:
                (self.folder / MARKER).unlink()
                sync_folder(self.folder)
            self.failed = lacks
        except OSError as error:
            self.failed = f"{self.folder}: {error.strerror}: the trial is incomplete"
            self.on_trouble(self.failed)
        finally:
            for stream in (self.log, self.events):
                try:
                    stream.close()
                except OSError:
                    pass

    def _sync(self):
        for stream in (self.log, self.events):
            stream.flush()
            os.fsync(stream.fileno())


def write_whole(path, text):
    with open(path, "w", encoding="utf-8") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())


def sync_folder(path):
    number = os.open(path, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def listing(root):
    """The trials of a folder, newest first: what the page shows of them."""
    found = []
    for path in sorted(pathlib.Path(root).glob("*/trial.json"), reverse=True)[:200]:
        folder = path.parent
        found.append({"name": folder.name, "complete": not (folder / MARKER).exists(), "seconds": length_s(folder)})
    return found


def length_s(folder):
    """From the first to the last line of the log."""
    try:
        with open(folder / "bus.log", "rb") as stream:
            head = stream.read(4096).splitlines()
            stream.seek(max(0, os.path.getsize(folder / "bus.log") - 4096))
            tail = stream.read().splitlines()
        times = [float(frames.LINE.match(line)[1] + b"." + frames.LINE.match(line)[2]) for line in (head[0], tail[-1])]
        return times[1] - times[0]
    except (OSError, IndexError, TypeError):
        return None


def describe(folder):
    """trial.json of a folder, with whether the trial is whole."""
    try:
        told = json.loads((pathlib.Path(folder) / "trial.json").read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise TrialError(f"{folder} is no trial: it has no trial.json") from error
    except (OSError, ValueError) as error:
        raise TrialError(f"{folder}/trial.json: {error}") from error
    marker = pathlib.Path(folder) / MARKER
    told["complete"] = not marker.exists()
    told["lacks"] = marker.read_text(encoding="utf-8").strip() if marker.exists() else ""
    return told
