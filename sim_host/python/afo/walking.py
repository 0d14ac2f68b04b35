"""A walk through the whole chain: the controller that a device runs, bus, sensors, drives and the simulated walker."""
from __future__ import annotations

import dataclasses
import inspect
import math
import numbers
import os
import pathlib
from collections.abc import Callable
from typing import Any, Union

import numpy as np
import pandas as pd

from ._library import SYSTEM, AfoError, complain, ffi, lib, number, text_buffer, whole, words

SENSORS = ("ideal", "17bit", "14bit", "12bit")
_STEPS_MOST = 10000000
_TICKS = 2000  # between two looks for Ctrl-C: some tens of milliseconds
_SIDES = np.array(["left", "right"])
_SWITCHES = ("none", "seeded", "exact", "10ms", "20ms", "40ms")
_PHASES = np.array(["held", "single", "double", "down"])
_WALKING = ("heel_strike_s", "toe_off_s", "walking_speed_m_s", "push_off_J", "margin_of_stability_m")
_STEP = np.dtype([("step", "u4"), ("side", "i4"), *((name, "f8") for name in (
    "time_s", "apex_speed_rad_s", "measured_speed_rad_s", "target_speed_rad_s", "r0_m", "step_time_s", "step_length_m",
    *_WALKING)), ("used_fallback", "i4")], align=True)
_TICK = np.dtype([("tick", "u8"), *((name, "f8") for name in (
    "time_s", "theta_left_rad", "theta_right_rad", "rate_left_rad_s", "rate_right_rad_s", "ankle_left_m",
    "ankle_right_m", "motor_left_m", "motor_right_m", "hip_x_m", "hip_y_m", "toe_left_x_m", "toe_left_y_m",
    "toe_right_x_m", "toe_right_y_m", "ground_left_x_N", "ground_left_y_N", "ground_right_x_N", "ground_right_y_N")), *(
        (name, "i4") for name in ("stance", "phase", "event", "supervisor"))], align=True)
_EVENT = np.dtype([("side", "i4"), ("kind", "i4"), ("time_s", "f8")], align=True)
assert _STEP.itemsize == ffi.sizeof("struct afo_step") and _TICK.itemsize == ffi.sizeof("struct afo_tick")
assert _EVENT.itemsize == ffi.sizeof("struct afo_event")


@dataclasses.dataclass(frozen=True)
class Step:
    """What a law is told at an apex. All as the controller knows it, in float32 behind it."""
    step: int                #: 1 is the first
    speed_rad_s: float       #: forward apex speed measured, > 0
    swing_angle_rad: float
    swing_rate_rad_s: float
    desired_rad_s: float     #: speed asked for
    command_rad_s: float     #: v*: the speed asked for behind a ramp per step
    steady_r0_m: float       #: finv(v*): push-off of the steady gait of that speed
    r0_m: float              #: last answer, behind the limits
    r0_min_m: float          #: limits behind the law: least and largest value, largest change per step
    r0_max_m: float
    r0_change_max_m: float


Law = Callable[[Step], float]
PathLike = Union[str, "os.PathLike[str]"]


@dataclasses.dataclass(frozen=True)
class Walk:
    """What was walked."""
    steps: pd.DataFrame  #: a row a step; columns as `afo sim --csv` has them, NaN where there is none
    ticks: pd.DataFrame | None  #: a row a millisecond, as `afo sim --csv --ticks`; None where not asked for
    fell: bool
    ended: str           #: "" for a whole walk, else what ended it, in words
    law: str             #: name of the law
    speed_rad_s: float   #: speed asked for; NaN of a person, who chooses their own
    events: pd.DataFrame  #: a row a heel strike and toe-off: side, kind, time_s as it was; in the recording's time
    found: pd.DataFrame   #: the same as the controller found them

    def __bool__(self) -> bool:
        """Whether all steps were walked."""
        return not self.ended


def persons() -> list[str]:
    """Names of the persons that come with the package."""
    return sorted(path.stem for path in (SYSTEM / "share/afo/persons").glob("*.ini"))


def devices() -> list[str]:
    """Names of the devices that come with the package."""
    return sorted(path.stem for path in (SYSTEM / "share/afo/devices").glob("*.ini"))


def find_file(room: str, names: list[str], wanted: PathLike | None) -> str | None:
    """A person's or a device's file: by its name in the package, or by its path."""
    if wanted is None:
        return None
    if str(wanted) in names:
        return str(SYSTEM / "share/afo" / room / f"{wanted}.ini")
    if not pathlib.Path(wanted).is_file():
        raise AfoError(f"{room[:-1]} {str(wanted)!r} is no file, and none of {', '.join(names)}")
    return str(wanted)


class _Caller:
    """A law in Python behind the C side's call. Its exception is kept, and raised when C has returned."""

    def __init__(self, law: Law) -> None:
        self.law = law
        self.error: BaseException | None = None
        try:
            inspect.signature(law).bind(None)
        except TypeError as error:
            raise AfoError(f"the law is called with one Step, and does not take it: {error}") from None
        except ValueError:  # a function of C's tells nothing of its arguments
            pass
        self.pointer = ffi.callback("afo_law_fn", self._call, error=math.nan, onerror=self._keep)

    def _call(self, _context: Any, told: Any) -> float:
        step = Step(**{field.name: getattr(told, field.name) for field in dataclasses.fields(Step)})
        answer = self.law(step)
        if not isinstance(answer, numbers.Real) or not math.isfinite(answer):
            raise AfoError(f"the law gave {answer!r} at step {step.step}; it must give the precompression wanted in m, a "
                           "finite number (step.r0_m is the last one)")
        return float(answer)

    def _keep(self, _kind: Any, error: BaseException, _traceback: Any) -> None:
        """Whatever the law raises, Ctrl-C too: C gets NaN, which ends the walk."""
        self.error = error


def _name_of(law: str | Law | None) -> str:
    return law if isinstance(law, str) else "prescribed" if law is None else getattr(law, "__name__", type(law).__name__)


def _frame_of_steps(walk: Any) -> pd.DataFrame:
    rows = np.zeros(lib.afo_walk_steps(walk, ffi.NULL, 0), _STEP)
    if len(rows):
        lib.afo_walk_steps(walk, ffi.cast("struct afo_step *", ffi.from_buffer(rows)), len(rows))
    frame = pd.DataFrame({name: rows[name] for name in _STEP.names or ()})
    frame["side"] = pd.Categorical.from_codes(frame["side"], _SIDES)
    frame["used_fallback"] = frame["used_fallback"].map({0: False, 1: True}).astype("boolean")
    first = ["step", "time_s", "side"]
    return frame[[*first, *(name for name in frame.columns if name not in (*first, *_WALKING)), *_WALKING]]


def _frame_of_ticks(parts: list[Any]) -> pd.DataFrame:
    rows = np.concatenate(parts) if parts else np.zeros(0, _TICK)

    def named(codes: Any, names: list[str]) -> Any:
        return pd.Categorical.from_codes(codes, names)
    events = ["", *(ffi.string(lib.afo_event_name(i)).decode() for i in range(9))]
    states = [ffi.string(lib.afo_supervisor_name(i)).decode() for i in range(8)]
    columns: dict[str, Any] = {"tick": rows["tick"], "time_s": rows["time_s"], "stance": named(rows["stance"], list(_SIDES)),
                               "phase": named(rows["phase"], list(_PHASES))}
    names = (_TICK.names or ())[2:-4]
    columns |= {name: rows[name] for name in names[:10]}
    columns |= {"event": named(rows["event"] + 1, events), "supervisor": named(rows["supervisor"], states)}
    columns |= {name: rows[name] for name in names[10:]}
    return pd.DataFrame(columns)


def _frame_of_events(walk: Any, take: Any) -> pd.DataFrame:
    rows = np.zeros(take(walk, ffi.NULL, 0), _EVENT)
    if len(rows):
        take(walk, ffi.cast("struct afo_event *", ffi.from_buffer(rows)), len(rows))
    kinds = [ffi.string(lib.afo_event_name(i)).decode() for i in range(9)]
    frame = pd.DataFrame({"time_s": rows["time_s"], "side": pd.Categorical.from_codes(rows["side"], _SIDES),
                          "kind": pd.Categorical.from_codes(rows["kind"], kinds).remove_unused_categories()})
    return frame.sort_values("time_s", kind="stable", ignore_index=True)


def _walking_speed(text: str) -> float:
    """The m/s of a text such as "0.57m/s"."""
    value, unit = text.removesuffix("m/s"), text.endswith("m/s")
    try:
        found = float(value) if unit else 0.0
    except ValueError:
        found = 0.0
    if not 0.0 < found < math.inf:
        raise AfoError(f"speed = {text!r}: it must be a number in rad/s, or a text such as '0.57m/s', above 0")
    return found


def sim(person: PathLike | None = None, device: PathLike | None = None, law: str | Law | None = None,
        speed: float | str | None = None, *, recording: PathLike | None = None, plant: str = "walker",
        switches: str | None = None, steps: int | None = None, r0: float | None = None, start_r0: float | None = None,
        kp: float | None = None, sensors: str = "17bit", seed: int = 1, slope_deg: float = 0.0, terrain_mm: float = 0.0,
        push: tuple[float, float] | None = None, ticks: bool = False) -> Walk:
    """Walks `steps` steps (200; a recording: all), or until the walker falls, and tells every step.

    person, device: a name of persons(), devices(), or the path of a file; the paper's walker and the virtual device if
    none is given. law: "proportional" (eq. 16), "dlqr", "deadbeat", "predictive", "open-loop"; or a function, which is
    called once per step with a Step and gives the precompression wanted, m. Its answer has the limits of the other laws
    behind it: value and change per step. speed: forward apex speed, rad/s, or a walking
    speed as a text, "0.57m/s". r0: constant of open-loop, m. start_r0: the walk
    starts from this push-off's steady gait, m. kp: gain of eq. (16), m per rad/s. sensors: one of SENSORS. seed: of all
    noise. slope_deg: uphill positive. terrain_mm: standard deviation of the footholds' heights. push: impulse on the torso
    in N s and its time in s. ticks: also a table by the millisecond.

    recording: a recorded walk of a person in the walker's place, as `afo import` makes it, or with its columns. plant:
    "walker", or "reflex", a person whose muscles answer to the device. Such a person has no speed to ask for; their law is
    "person", "open-loop" or a function, and their foot switches are `switches`: "seeded", "exact", "10ms", "20ms", "40ms"
    or "none". Of a recorded person the place of hip and toes is NaN.

    A fall is no error: see Walk.ended. Raises AfoError for settings that do not fit, and what the law itself raises.
    Ctrl-C ends the walk. The GIL is released while it walks. About a hundred times faster than real time.
    """
    if plant not in ("walker", "reflex"):
        raise AfoError(f"plant = {plant!r} is none of walker, reflex")
    if switches is not None and switches not in _SWITCHES:
        raise AfoError(f"switches = {switches!r} are none of {', '.join(_SWITCHES)}")
    if recording is not None and not pathlib.Path(recording).is_file():
        raise AfoError(f"recording {str(recording)!r} is no file")
    if steps is None:
        steps = _STEPS_MOST if recording is not None else 200
    caller = None if law is None or isinstance(law, str) else _Caller(law) if callable(law) else None
    if caller is None and law is not None and not isinstance(law, str):
        raise AfoError(f"law must be a name or a function, not {law!r}")
    person_file, device_file = find_file("persons", persons(), person), find_file("devices", devices(), device)
    impulse_Ns, at_s = (0.0, 0.0) if push is None else (number(part, "push", "N s, s") for part in push)

    def optional(value: float | None, name: str, unit: str, none: float) -> float:
        return none if value is None else number(value, name, unit)
    walking_m_s = 0.0
    if isinstance(speed, str):
        walking_m_s, speed = _walking_speed(speed), None
    if kp is not None and kp < 0.0:
        raise AfoError(f"kp = {kp:g} m per rad/s: it must be 0 to 1; a negative gain makes every gait unstable")
    for value, name in ((speed, "speed"), (r0, "r0"), (start_r0, "start_r0")):
        if value is not None and not value > 0:
            raise AfoError(f"{name} = {value} must be above 0")
    kept = [ffi.NULL if value is None else ffi.new("char[]", str(value).encode())
            for value in (person_file, device_file, law if isinstance(law, str) else None, sensors, recording, switches)]
    settings = ffi.new("struct afo_walk_settings *", {
        "person": kept[0], "device": kept[1], "law": kept[2], "sensors": kept[3],
        "speed_rad_s": optional(speed, "speed", "rad/s", 0.0), "walking_m_s": walking_m_s, "r0_m": optional(r0, "r0", "m", 0.0),
        "start_r0_m": optional(start_r0, "start_r0", "m", 0.0), "kp": optional(kp, "kp", "m per rad/s", -1.0),
        "seed": whole(seed, "seed", 0, 2**64 - 1), "steps": whole(steps, "steps", 1, _STEPS_MOST), "recording": kept[4],
        "switches": kept[5], "by_reflexes": plant == "reflex",
        "slope_deg": number(slope_deg, "slope_deg", "deg"), "terrain_mm": number(terrain_mm, "terrain_mm", "mm"),
        "push_Ns": impulse_Ns, "push_s": at_s, "own_law": ffi.NULL if caller is None else caller.pointer})
    is_person = recording is not None or plant == "reflex"
    text = text_buffer()
    walk = lib.afo_walk_open(settings, text)
    if walk == ffi.NULL:
        raise complain(text)
    try:
        parts, ended = _advance(walk, caller, ticks)
        return Walk(_frame_of_steps(walk), _frame_of_ticks(parts) if ticks else None, bool(lib.afo_walk_fell(walk)), ended,
                    "person" if is_person and law is None else _name_of(law), math.nan if is_person else lib.afo_walk_speed(walk),
                    _frame_of_events(walk, lib.afo_walk_events), _frame_of_events(walk, lib.afo_walk_found))
    finally:
        lib.afo_walk_close(walk)


def _advance(walk: Any, caller: _Caller | None, ticks: bool) -> tuple[list[Any], str]:
    """To the walk's end; the rows by tick, and what ended it. Python looks for Ctrl-C between two calls."""
    parts, text, taken, state = [], text_buffer(), ffi.new("uint32_t *"), lib.AFO_WALK_GOES_ON
    while state == lib.AFO_WALK_GOES_ON:
        rows = np.empty(_TICKS if ticks else 0, _TICK)
        pointer = ffi.cast("struct afo_tick *", ffi.from_buffer(rows)) if ticks else ffi.NULL
        state = lib.afo_walk_advance(walk, _TICKS, pointer, taken, text)
        if caller is not None and caller.error is not None:
            raise caller.error
        if ticks:
            parts.append(rows[:taken[0]])
    return parts, words(text) if state == lib.AFO_WALK_ENDED else ""
