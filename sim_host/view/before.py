"""What was on a bus since the controller's last start: a trial that begins in the middle of a walk needs it to be replayed.

Kept as the text of a candump log, compressed, as long as it is not too much.
"""
import zlib

import numpy as np

import frames

BOOT_ID, CONTROLLER = 0x710, 16
BYTES_MAX = 64 << 20   # compressed: about an hour of a full bus
EARLIER_MAX = 4096     # records before the boot-up: the first ticks may overtake it on the bus
PAUSE_US, LATE_TICKS = 5000, 100  # as afo replay finds the beginning of a run (log/replay_boot.c)
FROM_NODES = (0x080, 0x180, 0x280, 0x380, 0x480, 0x580, 0x700)


def of_other_nodes(records):
    """Those that a node other than the controller sent."""
    identifiers = records["id"]
    node = identifiers & np.uint32(0x7F)
    return records[(identifiers < 0x800) & np.isin(identifiers & ~np.uint32(0x7F), FROM_NODES) & (node > 0) & (node != CONTROLLER)]


class Before:
    """Takes records as they come; copy() is everything from the controller's start up to now."""

    def __init__(self):
        self.earlier = np.zeros(0, frames.RECORD)
        self.synced = False  # a SYNC was seen before `earlier'
        self.packer = None  # None: its start was not seen, or was too long ago
        self.parts, self.bytes = [], 0

    def take(self, records):
        boots = np.flatnonzero((records["id"] == BOOT_ID) & (records["length"] == 1) & (records["data"][:, 0] == 0))
        if len(boots):
            at = int(boots[-1])
            self.packer, self.parts, self.bytes = zlib.compressobj(1, wbits=31), [], 0
            self._pack(self._run(np.concatenate([self.earlier, records[:at]]), int(records["time_us"][at])))
            self._pack(records[at:])
        elif self.packer:
            self._pack(records)
        both = np.concatenate([self.earlier, records])
        self.synced = self.synced or frames.SYNC in both["id"][:-EARLIER_MAX]
        self.earlier = both[-EARLIER_MAX:]

    def _run(self, earlier, boot_us):
        """Of what lies before a boot-up: the first ticks of this run, and what others said before those."""
        syncs = np.flatnonzero(earlier["id"] == frames.SYNC)
        if len(syncs) == 0:
            return of_other_nodes(earlier)
        longest = np.iinfo(np.int64).max
        period = np.diff(earlier["time_us"][syncs].astype(np.int64), prepend=earlier["time_us"][syncs[0]].astype(np.int64))
        period[period < 0] = longest
        period[0] = 0 if self.synced else longest
        late = max(len(syncs) - LATE_TICKS, 0)
        run = late + int(np.argmax(period[late:]))  # the SYNC behind the longest pause
        run = run if period[run] > max(PAUSE_US, boot_us - int(earlier["time_us"][syncs[-1]])) else len(syncs)
        start = int(syncs[run - 1]) + 1 if run > 0 else 0
        first = int(syncs[run]) if run < len(syncs) else len(earlier)
        return np.concatenate([of_other_nodes(earlier[start:first]), earlier[first:]])

    def _pack(self, records):
        part = self.packer.compress(frames.log_lines(records).encode())
        self.parts.append(part)
        self.bytes += len(part)
        if self.bytes > BYTES_MAX:
            self.packer, self.parts = None, []

    def copy(self):
        """[bytes] of a .gz file, or None: there is nothing to begin with."""
        return [*self.parts, self.packer.copy().flush()] if self.packer else None
