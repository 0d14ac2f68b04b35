"""A trial: one folder with the frames, what happened, and who walked with what.

    bus.log          every frame, as candump -L writes it; notes in 29-bit identifiers hold snapshot and marks
    before.log.gz    of a bus: what was on it since the controller started, up to the beginning of bus.log
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
WAITING_MAX = 4000000  # records; 100 MB: minutes of a disk that hangs
MARKER, BEFORE = "INCOMPLETE", "before.log.gz"
# Where the replay of a trial begins: a snapshot at its head, the file of what was before, a start of the controller in it,
# or the next one of a controller that was walking already when the view began.
SNAPSHOT, BEFORE_IT, OWN_BOOT, NEXT_BOOT = "snapshot", "before", "own boot", "next boot"


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
        self.queue, self.failed, self.lacks = queue.Queue(), None, None
        self.waiting = 0  # records that the disk has not taken
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
        self.before = None

    def start(self, before=None):
        """From now on it takes records. before: what was on the bus up to now, or None."""
        self.thread.start()
        if before:
            self.before = threading.Thread(target=self._write_before, args=(before,), daemon=True)  # beside: it may be long
            self.before.start()

    # ---- from the hub -------------------------------------------------------------

    def take(self, records):
        if self.waits:
            found = np.flatnonzero(records["id"] == frames.IDENTITY)
            if len(found) == 0:
                return
            records, self.waits = records[found[0]:], False
        if self.waiting > WAITING_MAX:
            if self.lacks is None:
                self.incomplete("the disk did not keep up: frames are missing")
            return
        self.waiting += len(records)
        self.queue.put(("log", records))

    def mark(self, number, text, time_us):
        if not self.waits:
            records = mark_records(number, text, time_us)
            self.waiting += len(records)
            self.queue.put(("log", records))

    def event(self, event):
        self.queue.put(("event", event))

    def note(self, kind, text):
        self.queue.put(("event", {"kind": kind, "tick": 0, "text": text}))

    def incomplete(self, text):
        self.lacks = text
        self.queue.put(("incomplete", text))

    def close(self):
        """Ends the trial. Returns None, or why it is incomplete."""
        if self.before:
            self.before.join(30.0)
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
                    self.waiting -= len(what)
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

    def _write_before(self, parts):
        try:
            with open(self.folder / BEFORE, "wb") as stream:
                for part in parts:
                    stream.write(part)
                stream.flush()
                os.fsync(stream.fileno())
        except OSError as error:
            self.incomplete(f"{self.folder / BEFORE}: {error.strerror}: the trial does not replay")

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


def how_to_replay(told, folder):
    """(command, what it does) of a trial that trial.json describes."""
    subject = told["subject"]
    given = [f"--{key} {subject[f'{key}_file']}" for key in ("person", "device") if subject.get(f"{key}_file")]
    if subject.get("desired_speed_rad_s"):
        given.append(f"--speed {subject['desired_speed_rad_s']:g}")
    command = " ".join(["afo replay", *given])
    begins = told.get("replay_from")
    if (pathlib.Path(folder) / BEFORE).exists():
        return f"zcat {folder}/{BEFORE} | cat - {folder}/bus.log | {command} --foreign-nodes -", "from the controller's start on"
    if begins == NEXT_BOOT:
        return f"{command} --foreign-nodes --from-boot {folder}/bus.log", (
            "from the controller's next start in this trial only: it was walking already when afo view began to watch")
    foreign = "--foreign-nodes " if begins == OWN_BOOT else ""
    return f"{command} {foreign}{folder}/bus.log", "from the beginning of the trial on"


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
