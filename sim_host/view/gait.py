"""Steps, events and where the figure stands, from the rows of signals; tick by tick, for a walk that goes on.

Signs of a heel strike, best first: the foot's own switch; the latch of the other leg opening under load (that is its
push-off); without either, the leg's angle turning back from its foremost. What was seen of a better sign in the last two
seconds silences the worse ones.
"""
import numpy as np

from signals import INDEX, LEFT, RIGHT, SIDES

TURN_RAD, FOREMOST_RAD = 0.01, 0.08
BETTER_SIGN_S = 0.25  # so long a turned leg waits for a better sign
LOADED_SHARE = 0.005  # of the leg length: below that, an opening latch pushes nothing


class Gait:
    """Events and steps of one walk. take() adds the columns stance, double_support and hip_x to the rows."""

    def __init__(self, subject):
        self.subject = subject
        self.length_m = subject["parameters"]["leg_length_m"]
        self.tick_s = subject["tick_s"]
        self.stance, self.double = LEFT, False
        self.foot_x = 0.0
        self.before = None
        self.foremost = [None, None]
        self.rearmost_ankle = [0.0, 0.0]
        self.pushing = [False, False]
        self.sign_tick = {"switch": -10**9, "latch": -10**9}
        self.last_strike_tick = None
        self.steps = []
        self.push = None
        self.step_m = self.step_s = None

    def take(self, rows, first_tick):
        """Returns the events of these rows, in order."""
        events = []
        angle = [rows[:, INDEX[f"leg_angle_{side}"]].tolist() for side in SIDES]
        ankle = [rows[:, INDEX[f"ankle_{side}"]].tolist() for side in SIDES]
        latch = [rows[:, INDEX[f"latch_closed_{side}"]].tolist() for side in SIDES]
        foot = [rows[:, INDEX[f"foot_down_{side}"]].tolist() for side in SIDES]
        motor = [rows[:, INDEX[f"motor_{side}"]].tolist() for side in SIDES]
        stance, double, hip = [], [], []
        for i in range(len(rows)):
            now = (latch[0][i], latch[1][i], foot[0][i], foot[1][i])
            self._tick(first_tick + i, [angle[0][i], angle[1][i]], [ankle[0][i], ankle[1][i]],
                       [motor[0][i], motor[1][i]], now, events)
            stance.append(self.stance)
            double.append(self.double)
            hip.append(self.foot_x - self.length_m * np_sin(angle[self.stance][i]))
        rows[:, INDEX["stance"]], rows[:, INDEX["double_support"]], rows[:, INDEX["hip_x"]] = stance, double, hip
        return events

    def _tick(self, tick, angle, ankle, motor, now, events):
        before = self.before or now
        for side in (LEFT, RIGHT):
            other = 1 - side
            if before[2 + side] == 0 and now[2 + side] == 1:
                self._strike(tick, side, angle, "switch", events)
            elif before[2 + side] == 1 and now[2 + side] == 0:
                self._toe_off(tick, side, events)
            if before[side] == 1 and now[side] == 0 and motor[side] > LOADED_SHARE * self.length_m:
                self._push(tick, side, motor[side], events)
                if tick - self.sign_tick["switch"] > 2 / self.tick_s:
                    self._strike(tick, other, angle, "latch", events)
            self._follow_push(tick, side, ankle[side], events)
            self._turn(tick, side, angle, events)
        self.before = now

    def _push(self, tick, side, motor_m, events):
        stiffness = self.subject[SIDES[side]]["spring_N_per_m"] or self.subject["parameters"]["spring_stiffness_n_m"]
        energy_J = 0.5 * stiffness * motor_m * motor_m
        self.pushing[side], self.rearmost_ankle[side] = True, 0.0
        events.append({"kind": "push", "tick": tick, "side": side, "r0_m": motor_m, "energy_J": energy_J})

    def _follow_push(self, tick, side, ankle_m, events):
        if not self.pushing[side]:
            return
        self.rearmost_ankle[side] = max(self.rearmost_ankle[side], ankle_m)
        if self.rearmost_ankle[side] > 0.003 * self.length_m and ankle_m < self.rearmost_ankle[side] - 0.0005 * self.length_m:
            self.pushing[side] = False
            if tick - self.sign_tick["switch"] > 2 / self.tick_s:
                self._toe_off(tick, side, events)

    def _turn(self, tick, side, angle, events):
        """The swing leg's angle turns back: the last resort for a heel strike."""
        most = self.foremost[side]
        if side == self.stance or angle[side] != angle[side]:
            self.foremost[side] = None
            return
        if most is None or angle[side] > most[0]:
            self.foremost[side] = (angle[side], tick)
        elif angle[side] < most[0] - TURN_RAD and most[0] > FOREMOST_RAD and tick - most[1] > BETTER_SIGN_S / self.tick_s:
            quiet = tick - max(self.sign_tick.values()) > 2 / self.tick_s
            self.foremost[side] = None
            if quiet:
                self._strike(tick, side, angle, "angle", events)
                self._toe_off(tick, 1 - side, events)

    def _strike(self, tick, side, angle, sign, events):
        if sign in self.sign_tick:
            self.sign_tick[sign] = tick
        if side == self.stance:
            return
        lead, trail = angle[side], angle[1 - side]
        length_m = self.length_m * (np_sin(lead) - np_sin(trail))
        self.foot_x += length_m
        self.stance, self.double = side, True
        time_s = (tick - self.last_strike_tick) * self.tick_s if self.last_strike_tick is not None else None
        self.last_strike_tick = tick
        events.append({"kind": "strike", "tick": tick, "side": side, "sign": sign, "step_m": length_m, "step_s": time_s})

    def _toe_off(self, tick, side, events):
        if side != self.stance:
            self.double = False
            events.append({"kind": "toe_off", "tick": tick, "side": side})

    # ---- steps ----------------------------------------------------------------------

    def follow(self, event):
        """Every event in the order of ticks: what a step is told together with."""
        if event["kind"] == "push":
            self.push = event
        elif event["kind"] == "strike":
            self.step_m, self.step_s = event["step_m"], event["step_s"]

    def step(self, tick, record):
        """The controller's record of a step (its TELEMETRY frame), with what was seen since the last one; None for the
        frame that it sends before any step."""
        number = int(record["StepNumber"])
        if record["MeasuredSpeed"] == 0 and number == 0:
            return None
        last = self.steps[-1]["number"] if self.steps else 0
        number += (last - number + 128) // 256 * 256 if last else 0
        cadence = 60.0 / self.step_s if self.step_s else None
        step = {"kind": "step", "number": number, "tick": tick, "side": int(record["RightSide"]),
                "speed_rad_s": record["MeasuredSpeed"], "command_rad_s": record["CommandedSpeed"],
                "r0_m": record["Precompression"], "fell_back": int(record["FellBack"]),
                "step_m": self.step_m, "step_s": self.step_s, "cadence": cadence,
                "speed_m_s": self.step_m / self.step_s if self.step_s else None,
                "push_J": self.push["energy_J"] if self.push else None,
                "push_m": self.push["r0_m"] if self.push else None}
        self.push = None
        self.steps.append(step)
        return step


def np_sin(value):
    return float(np.sin(value)) if value == value else 0.0
