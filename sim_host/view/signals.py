"""From frames to signals, a row a tick: what the DBC says of the frames, in SI units of the device that is worn.

A tick begins with the SYNC, as for the controller; the values of its row are those that were on the bus up to the next
one. A value holds until the next frame that has it.
"""
import cantools
import numpy as np

import frames

LEFT, RIGHT = 0, 1
SIDES = ("left", "right")
LEVER_RAD = 2 * np.pi / 65536

# name, unit, group, what it is. The groups are the page's panels.
PER_LEG = (
    ("leg_angle", "rad", "legs", "leg against the vertical, positive with the foot in front"),
    ("leg_rate", "rad/s", "legs", "its rate, over 8 ms"),
    ("ankle", "m", "springs", "ankle extension"),
    ("motor", "m", "springs", "motor position: precompression measured"),
    ("target", "m", "springs", "motor position commanded"),
    ("spring_force", "N", "force", "spring stiffness times motor position less ankle extension"),
    ("motor_force", "N", "force", "what the drive says (every 100 ms)"),
    ("latch_closed", "", "latch", "the latch reports that it holds"),
    ("latch_armed", "", "latch", "the controller lets it open at the heel strike"),
    ("foot_down", "", "latch", "the foot switch is closed"),
    ("enabled", "", "latch", "the drive is enabled"),
    ("temperature", "degC", "drive", "of the drive"),
    ("supply", "V", "drive", "of the drive"),
    ("moment", "N m", "person", "spring force times the lever, or the leg length times the extension's angle"),
    ("power", "W/kg", "person", "spring force times the ankle's speed, by the whole mass"),
)
SHARED = (
    ("speed_measured", "rad/s", "speed", "apex speed as the controller measured it"),
    ("speed_commanded", "rad/s", "speed", "apex speed asked for by the law's ramp"),
    ("r0_wanted", "m", "springs", "precompression that the law asked for"),
    ("state", "", "state", "supervisor's state"),
    ("fault", "", "state", "latched fault"),
    ("stance", "", "state", "leg that carries: 0 left, 1 right"),
    ("double_support", "", "state", "both feet on the ground"),
    ("bus_load", "%", "bus", "of the bus, over this tick"),
    ("period", "ms", "bus", "from SYNC to SYNC"),
    ("hip_x", "m", "figure", "way of the hip over the ground"),
)
NAMES = [f"{name}_{side}" for name, *_ in PER_LEG for side in SIDES] + [name for name, *_ in SHARED]
INDEX = {name: place for place, name in enumerate(NAMES)}
COUNT = len(NAMES)


def descriptions():
    """[{name, unit, group, help}] in the order of the columns."""
    legs = [{"name": f"{name}_{side}", "unit": unit, "group": group, "help": f"{side}: {text}"}
            for name, unit, group, text in PER_LEG for side in SIDES]
    return legs + [{"name": name, "unit": unit, "group": group, "help": text} for name, unit, group, text in SHARED]


class Field:
    """One signal of the DBC, for arrays of frames. Little-endian signals only; this bus has no others."""

    def __init__(self, signal):
        if signal.byte_order != "little_endian":
            raise ValueError(f"{signal.name}: big-endian signals are not expected on this bus")
        self.start, self.length = np.uint64(signal.start), signal.length
        self.mask = np.uint64((1 << signal.length) - 1)
        self.signed, self.scale, self.offset = signal.is_signed, float(signal.scale), float(signal.offset)
        self.bytes = (signal.start + signal.length + 7) // 8

    def raw(self, words):
        value = ((words >> self.start) & self.mask).astype(np.int64)
        if self.signed:
            value -= (value >> (self.length - 1)) << self.length
        return value

    def value(self, words):
        return self.raw(words) * self.scale + self.offset


class Decoder:
    """Takes records as they come, gives whole ticks: (rows float32, first tick, frames of interest).

    subject: what `afo view` says of person and device.
    """

    def __init__(self, subject, dbc):
        database = cantools.database.load_file(str(dbc))
        self.subject = subject
        self.field = {message.frame_id: {one.name: Field(one) for one in message.signals}
                      for message in database.messages}
        self.length = {message.frame_id: message.length for message in database.messages}
        self.by_name = {message.name: message.frame_id for message in database.messages}
        self.rest = np.zeros(0, frames.RECORD)
        self.held = np.full(COUNT, np.nan)
        self.held[INDEX["fault"]] = 0
        self.tick = 0
        self.last_sync_us = None
        self.angles = [np.zeros(0), np.zeros(0)]
        self.setters = self._setters()
        self.bits = frame_bits_table()

    # ---- which signal goes where ------------------------------------------------

    def _leg(self, side):
        return self.subject[SIDES[side]]

    def _position(self, side, name):
        leg = self._leg(side)
        scale = (leg["direction"] or 1) / (leg["counts_per_m"] or 1.0)
        return lambda field, words: (field[name].raw(words) - (leg["zero_counts"] or 0)) * scale

    def _angle(self, side):
        leg, parameters = self._leg(side), self.subject["parameters"]
        zero = (leg["leg_zero_rad"] or 0.0)
        trim = parameters[f"angle_zero_{SIDES[side]}_rad"]
        direction = leg["leg_direction"] or 1
        return lambda field, words: (field["LegAngle"].value(words) - zero) * direction - trim

    def _ankle(self, side):
        leg, trim = self._leg(side), self.subject["parameters"][f"ankle_zero_{SIDES[side]}_m"]
        if not leg["lever_ankle"]:
            return lambda field, words: field["Ankle"].value(words) - trim
        arm, neutral = leg["ankle_lever_m"] or 0.0, leg["ankle_neutral_rad"] or 0.0
        return lambda field, words: arm * np.sin(field["Ankle"].raw(words) * LEVER_RAD - neutral) - trim

    def _setters(self):
        setters = {}
        for side, upper in enumerate(("LEFT", "RIGHT")):
            one = SIDES[side]
            leg = self._leg(side)
            latch = np.int64(leg["latch_bit"] or 14)
            rated = leg["rated_force_N"] or 0.0
            setters[self.by_name[f"DRIVE_STATE_{upper}"]] = [
                (f"motor_{one}", self._position(side, "PositionActual")),
                (f"latch_closed_{one}", lambda f, w, b=latch: f["Statusword"].raw(w) >> b & 1),
                (f"enabled_{one}", lambda f, w: (f["Statusword"].raw(w) & 0x6F) == 0x27)]
            setters[self.by_name[f"LEG_STATE_{upper}"]] = [(f"leg_angle_{one}", self._angle(side)),
                                                           (f"ankle_{one}", self._ankle(side))]
            setters[self.by_name[f"DRIVE_COMMAND_{upper}"]] = [
                (f"latch_armed_{one}", lambda f, w: f["LatchArmed"].raw(w))]
            setters[self.by_name[f"DRIVE_SLOW_{upper}"]] = [
                (f"motor_force_{one}", lambda f, w, r=rated, d=leg["direction"] or 1: f["Torque"].value(w) * d * r / 100),
                (f"temperature_{one}", lambda f, w: f["Temperature"].value(w)),
                (f"supply_{one}", lambda f, w: f["DcLink"].value(w))]
            setters[self.by_name[f"FOOT_{upper}"]] = [(f"foot_down_{one}", lambda f, w: f["Down"].raw(w))]
        setters[self.by_name["DRIVE_TARGETS"]] = [("target_left", self._position(LEFT, "TargetLeft")),
                                                  ("target_right", self._position(RIGHT, "TargetRight"))]
        setters[self.by_name["TELEMETRY"]] = [
            ("speed_measured", lambda f, w: f["MeasuredSpeed"].value(w)),
            ("speed_commanded", lambda f, w: f["CommandedSpeed"].value(w)),
            ("r0_wanted", lambda f, w: f["Precompression"].value(w))]
        setters[self.by_name["CONTROLLER_STATE"]] = [("state", lambda f, w: f["SupervisorState"].raw(w)),
                                                     ("fault", lambda f, w: f["LatchedFault"].raw(w))]
        return setters

    # ---- ticks ---------------------------------------------------------------------

    def take(self, records):
        """Returns (rows, tick of each frame, frames), both of the ticks that are whole now."""
        records = np.concatenate([self.rest, records]) if len(self.rest) else records
        standard = records["id"] < 0x800
        syncs = np.flatnonzero(records["id"] == frames.SYNC)
        if len(syncs) < 2:
            self.rest = records if len(records) < 100000 else records[-1000:]
            return np.zeros((0, COUNT), np.float32), np.zeros(0, np.int64), records[:0]
        first, last = syncs[0], syncs[-1]
        self.rest = records[last:].copy()
        whole = records[first:last]
        tick_of = np.cumsum(whole["id"] == frames.SYNC) - 1
        early = records[:first][standard[:first]]  # before the first SYNC: bootup, heartbeats
        rows = self._rows(whole, tick_of, int(tick_of[-1]) + 1)
        seen = np.concatenate([early, whole])
        at = np.concatenate([np.zeros(len(early), np.int64), tick_of]) + self.tick
        self.tick += len(rows)
        return rows, at, seen

    def _rows(self, records, tick_of, count):
        rows = np.full((count, COUNT), np.nan)
        rows[0] = self.held
        words = np.ascontiguousarray(records["data"]).view("<u8").ravel()
        for identifier, setters in self.setters.items():
            hits = np.flatnonzero((records["id"] == identifier) & (records["length"] == self.length[identifier]))
            if len(hits) == 0:
                continue
            field, word, tick = self.field[identifier], words[hits], tick_of[hits]
            for name, value in setters:
                rows[tick, INDEX[name]] = value(field, word)
        self._bus(rows, records, tick_of, count)
        hold(rows)
        self._derive(rows)
        self.held = rows[-1].copy()
        return rows.astype(np.float32)

    def _bus(self, rows, records, tick_of, count):
        bits = np.bincount(tick_of, self.bits[np.minimum(records["length"], 8)], count)
        period = float(self.subject["tick_s"])
        rows[:, INDEX["bus_load"]] = 100 * bits / (self.subject["bitrate"] * period)
        sync_us = records["time_us"][records["id"] == frames.SYNC].astype(np.int64)
        before = self.last_sync_us if self.last_sync_us is not None else sync_us[0] - int(1e6 * period)
        rows[:, INDEX["period"]] = np.diff(sync_us, prepend=before) / 1000
        self.last_sync_us = int(sync_us[-1])

    def _derive(self, rows):
        parameters = self.subject["parameters"]
        mass = parameters["torso_mass_kg"] + 2 * parameters["leg_mass_kg"]
        tick_s = float(self.subject["tick_s"])
        for side, one in enumerate(SIDES):
            leg = self._leg(side)
            stiffness = leg["spring_N_per_m"] or parameters["spring_stiffness_n_m"]
            motor, ankle = rows[:, INDEX[f"motor_{one}"]], rows[:, INDEX[f"ankle_{one}"]]
            force = stiffness * np.maximum(motor - ankle, 0.0)
            rows[:, INDEX[f"spring_force_{one}"]] = force
            angle_and_before, ankle_and_before = self._with_past(side, rows)
            span = 8
            rows[:, INDEX[f"leg_rate_{one}"]] = (angle_and_before[span:] - angle_and_before[:-span]) / (span * tick_s)
            speed = (ankle_and_before[span:] - ankle_and_before[:-span]) / (span * tick_s)
            rows[:, INDEX[f"moment_{one}"]] = force * (leg["ankle_lever_m"] or 0.0)
            rows[:, INDEX[f"power_{one}"]] = force * speed / mass

    def _with_past(self, side, rows):
        one = SIDES[side]
        both = np.stack([rows[:, INDEX[f"leg_angle_{one}"]], rows[:, INDEX[f"ankle_{one}"]]])
        past = self.angles[side] if self.angles[side].ndim == 2 else np.repeat(both[:, :1], 8, axis=1)
        joined = np.concatenate([past, both], axis=1)
        self.angles[side] = joined[:, -8:]
        return joined


def hold(rows):
    """Where there is no new value the last one holds, column by column, in place."""
    known = ~np.isnan(rows)
    if known.all():
        return
    place = np.where(known, np.arange(len(rows))[:, None], 0)
    np.maximum.accumulate(place, axis=0, out=place)
    rows[:] = np.take_along_axis(rows, place, axis=0)


def frame_bits_table():
    """Bits of a standard frame with so many data bytes, intermission included, and a tenth of stuff bits."""
    return np.array([47 + 8 * n + (34 + 8 * n) // 10 for n in range(9)], float)

