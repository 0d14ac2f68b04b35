"""A trial or a log as a whole: all rows, steps, events; for reports, exports and comparisons."""
import json
import pathlib

import numpy as np

import frames
import hub as hubs
import signals
import trial
from objects import Objects
from places import eds_path


class Walk:
    """name, told (trial.json), rows (ticks by signals), steps, events, subject, tick_s."""

    def __init__(self, folder, afo, subject=None):
        self.folder = pathlib.Path(folder)
        self.name = self.folder.name
        if subject is None and not self.folder.is_dir():
            raise trial.TrialError(f"{folder} is no folder of a trial; of a log say --log, --person and --device")
        self.told = trial.describe(self.folder) if self.folder.is_dir() else {"complete": True, "lacks": "", "note": ""}
        self.subject = subject or {**self.told["subject"], "parameters": self.told["parameters"]}
        self.tick_s = self.subject["tick_s"]
        self.objects = Objects(afo, eds_path())
        self._read()

    def _read(self):
        log = self.folder / "bus.log" if self.folder.is_dir() else self.folder
        with open(log, "rb") as stream:
            records, _ = frames.parse_log(stream, log, tolerate_cut=True)
        hub = hubs.Hub(self.subject, self.objects, events_kept=None)
        syncs = np.flatnonzero(records["id"] == frames.SYNC)
        hub.history = hubs.History(max(len(syncs), 1))
        for start in range(0, len(records), 200000):
            hub.take(records[start:start + 200000])
        self.rows = hub.history.rows[:hub.history.next]
        self.events = list(hub.events)
        self.steps = [event for event in self.events if event["kind"] == "step"]
        self.start_us = int(records["time_us"][syncs[0]]) if len(syncs) else 0
        self.sync_us = records["time_us"][syncs][:len(self.rows)].astype(np.int64)

    def column(self, name):
        return self.rows[:, signals.INDEX[name]]

    def rows_of(self, name, first, last):
        """(first tick, values), for findings.py."""
        return first, self.column(name)[first:last]

    def of_kind(self, *kinds):
        return [event for event in self.events if event["kind"] in kinds]

    # ---- strides ---------------------------------------------------------------------

    def strides(self, side):
        """[(first tick, last tick)] from heel strike to heel strike of a leg, those of an ordinary length."""
        ticks = [event["tick"] for event in self.of_kind("strike") if event["side"] == side]
        pairs = [(a, b) for a, b in zip(ticks, ticks[1:]) if b <= len(self.rows)]
        if not pairs:
            return []
        usual = np.median([b - a for a, b in pairs])
        return [(a, b) for a, b in pairs if 0.6 * usual < b - a < 1.5 * usual]

    def ensemble(self, side, name):
        """(percent of the stride, mean, standard deviation, number) of a leg's signal."""
        strides = self.strides(side)
        percent = np.linspace(0, 100, 101)
        if not strides:
            return percent, None, None, 0
        values = self.column(f"{name}_{signals.SIDES[side]}")
        curves = np.array([np.interp(np.linspace(a, b - 1, 101), np.arange(a, b), values[a:b]) for a, b in strides])
        return percent, np.nanmean(curves, axis=0), np.nanstd(curves, axis=0), len(curves)

    # ---- figures -----------------------------------------------------------------------

    def figures(self):
        """{name: (value, unit)} of the whole trial."""
        pushes = self.of_kind("push")
        strikes = [event for event in self.of_kind("strike") if event["step_s"]]
        parameters = self.subject["parameters"]
        mass = parameters["torso_mass_kg"] + 2 * parameters["leg_mass_kg"]
        total = sum(event["energy_J"] for event in pushes)
        found = {"length": (len(self.rows) * self.tick_s, "s"), "steps": (len(self.steps), ""),
                 "pushes given": (len(pushes), ""), "energy of the pushes": (total, "J")}
        if pushes:
            found["energy a push"] = (total / len(pushes), "J")
            found["energy a push and kilogram"] = (total / len(pushes) / mass, "J/kg")
        if strikes:
            time, way = sum(event["step_s"] for event in strikes), sum(event["step_m"] for event in strikes)
            found["walking speed"] = (way / time, "m/s")
            found["cadence"] = (60 * len(strikes) / time, "steps/min")
        if self.steps:
            found["mean apex speed"] = (float(np.mean([step["speed_rad_s"] for step in self.steps])), "rad/s")
            found["scatter of the apex speed"] = (float(np.std([step["speed_rad_s"] for step in self.steps])), "rad/s")
            found["mean r0"] = (float(np.mean([step["r0_m"] for step in self.steps])), "m")
        found["missed ticks"] = (int(np.sum(np.round(self.column("period") / (1000 * self.tick_s)) - 1)), "")
        return found

    def symmetry(self):
        """[(name, left, right, unit, index in percent)]: 2 (left - right) / (left + right)."""
        strikes, pushes = self.of_kind("strike"), self.of_kind("push")
        rows = []
        for name, unit, events, key in (("step time", "s", strikes, "step_s"), ("step length", "m", strikes, "step_m"),
                                        ("push energy", "J", pushes, "energy_J"), ("precompression", "m", pushes, "r0_m")):
            means = [np.mean([e[key] for e in events if e["side"] == side and e[key]] or [np.nan]) for side in (0, 1)]
            if np.isfinite(means).all() and sum(means):
                rows.append((name, *map(float, means), unit, 200 * float(means[0] - means[1]) / float(sum(means))))
        return rows


def load(folder, afo, subject_json=None):
    return Walk(folder, afo, json.loads(subject_json) if subject_json else None)
