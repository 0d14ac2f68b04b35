"""The walker on paper: return map, steady gaits, stability, basins.

An apex is the moment when the stance leg is vertical. Its state is three numbers: stance rate in rad/s, swing angle in
rad, swing rate in rad/s. The walker moves towards -x, so a forward walker's stance rate is negative; its apex speed is
-x[0]. All units are SI. An array of apexes has the shape (..., 3).

What is asked with numbers that do not fit raises AfoError. A walker that falls raises nothing: its next apex is NaN.
"""
from __future__ import annotations

import dataclasses
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from ._library import (AfoError, choice, complain, doubles, ffi, lib, number, numbers, states, text_buffer, whole, words)

BRANCHES = ("long", "short")
AXES = ("stance_rate", "swing_angle", "swing_rate")
RANGES = {"stance_rate": (-1.2, 0.0), "swing_angle": (-1.0, 0.6), "swing_rate": (-3.0, 6.0)}
OUTCOMES = ("falls", "converges", "walks on")
_SLICE = 1 << 18  # strides between two looks for Ctrl-C: about a tenth of a second


class Walks(NamedTuple):
    """What became of many walkers. n is the shape that x and r0 have together, without the last axis of x."""
    x: NDArray[np.float64]         #: (n, 3) last apex; NaN of a walker that fell
    strides: NDArray[np.int64]     #: (n,) whole strides
    fault: NDArray[np.int8]        #: (n,) 0, or why there is no next apex: fault_name()


class Derivatives(NamedTuple):
    """One stride and its derivatives."""
    x: NDArray[np.float64]         #: (n, 3) next apex
    by_x: NDArray[np.float64]      #: (n, 3, 3) d next[i] / d x[j]
    by_r0: NDArray[np.float64]     #: (n, 3) d next[i] / d r0, per m


class Basin(NamedTuple):
    """What becomes of the starts of a plane through a gait."""
    axes: tuple[str, str]          #: names of the plane's axes, of stance_rate, swing_angle, swing_rate
    a: NDArray[np.float64]         #: (points,) values along the first axis
    b: NDArray[np.float64]         #: (points,) values along the second
    outcome: NDArray[np.int8]      #: (points, points) [i, j] of (a[i], b[j]): place in OUTCOMES
    strides: NDArray[np.int32]     #: (points, points) strides until then

    @property
    def share(self) -> float:
        """The part of the starts that come to the gait."""
        return float(np.mean(self.outcome == OUTCOMES.index("converges")))


@dataclasses.dataclass(frozen=True)
class Gait:
    """A walk that repeats after `period` strides."""
    r0: float                           #: push-off, m: the spring's rest length
    kp: float                           #: gain of eq. (16), m per rad/s
    period: int
    x: NDArray[np.float64]              #: (3,) first apex
    eigenvalues: NDArray[np.complex128]  #: (3,) of by_x, largest magnitude first
    by_x: NDArray[np.float64]           #: (3, 3) derivative of the apex `period` strides on
    by_r0: NDArray[np.float64]          #: (3,) of the same by r0
    times_s: NDArray[np.float64]        #: (3,) first stride: apex to strike, double support, lift-off to apex
    step_length_m: float                #: of the first stride, toe to toe
    inter_leg_rad: float                #: between the legs at its heel strike
    speed_m_s: float                    #: over the whole period
    cost_of_transport: float            #: spring energy over weight and distance
    clamped_strides: int                #: strides in which the heel came to rest at the strike
    residual: float                     #: of the fixed point

    @property
    def apex_speed_rad_s(self) -> float:
        """Forward apex speed, rad/s."""
        return float(-self.x[0])

    @property
    def stable(self) -> bool:
        """Whether small departures die out."""
        return bool(abs(self.eigenvalues[0]) < 1.0)


def fault_name(fault: int) -> str:
    """Why a stride has no next apex, in words."""
    return ffi.string(lib.afo_fault_name(int(fault))).decode()


def _broadcast(x: ArrayLike, r0: ArrayLike, speed: ArrayLike | None) -> tuple[tuple[int, ...], Any, Any, Any]:
    """The shape of the walkers, and contiguous arrays of that many; no copy where they are so already."""
    x_in, r0_in = states(x), numbers(r0, "r0")
    speed_in = None if speed is None else numbers(speed, "speed")
    try:
        shape = np.broadcast_shapes(x_in.shape[:-1], r0_in.shape, () if speed_in is None else speed_in.shape)
    except ValueError:
        raise AfoError(f"x of the shape {x_in.shape} and r0 of the shape {r0_in.shape}"
                       + ("" if speed_in is None else f" and speed of the shape {speed_in.shape}")
                       + " do not go together: r0 and speed must be single numbers, or as many as there are walkers, "
                       f"{x_in.shape[:-1]}") from None

    def spread(array: NDArray[np.float64], to: tuple[int, ...]) -> NDArray[np.float64]:
        return np.ascontiguousarray(np.broadcast_to(array, to))
    return (shape, spread(x_in, shape + (3,)), spread(r0_in, shape),
            None if speed_in is None else spread(speed_in, shape))


@dataclasses.dataclass(frozen=True)
class Walker:
    """A compass walker with a spring at each ankle: the paper's one, if nothing is said.

    M: mass at the hip, kg, 1e-3 to 1e4. m: mass of a leg, kg, 0 to M. l: leg length, m, 0.01 to 100.
    k: stiffness of the ankle's spring along the leg, N/m, 1e-3 to 1e8. g: gravity, m/s^2, 1e-3 to 1e3.
    Raises AfoError, which names the parameter and its limits.
    """
    M: float = 1.0
    m: float = 0.01
    l: float = 1.0  # noqa: E741
    k: float = 100.0
    g: float = 9.80665

    def __post_init__(self) -> None:
        for name, unit in (("M", "kg"), ("m", "kg"), ("l", "m"), ("k", "N/m"), ("g", "m/s^2")):
            object.__setattr__(self, name, number(getattr(self, name), name, unit))
        text = text_buffer()
        if lib.afo_walker_check(self._c(), text) != 0:
            raise complain(text)

    def _c(self) -> Any:
        return ffi.new("struct afo_walker *", (self.M, self.m, self.l, self.k, self.g))

    # ---- the return map ----------------------------------------------------------------

    def _run(self, x: ArrayLike, r0: ArrayLike, strides: int, kp: float, speed: ArrayLike | None, accuracy: float,
             threads: int, derivatives: bool) -> tuple[Walks, NDArray[np.float64] | None, NDArray[np.float64] | None]:
        count_strides = whole(strides, "strides", 1, 10**12)
        gain = number(kp, "kp", "m per rad/s", 0.0)
        if (gain > 0.0) != (speed is not None):
            raise AfoError("kp and speed go together: eq. (16) is r0[k] = r0 + kp (v[k] - speed)")
        error = number(accuracy, "accuracy", "rad, rad/s", 0.0)
        cores = whole(threads, "threads", 0, 1 << 16)
        shape, start, push, aim = _broadcast(x, r0, speed)
        size = int(np.prod(shape))
        walks = Walks(np.empty(shape + (3,)), np.zeros(shape, np.int64), np.zeros(shape, np.int8))
        by_x = np.empty(shape + (3, 3)) if derivatives else None
        by_r0 = np.empty(shape + (3,)) if derivatives else None
        walker, text = self._c(), text_buffer()
        if size == 0:
            return walks, by_x, by_r0
        flat = [one if one is None else one.reshape(size, -1) for one in (start, push, aim, walks.x, walks.strides,
                                                                       walks.fault, by_x, by_r0)]
        step = max(4096, _SLICE // count_strides)
        for first in range(0, size, step):
            part = [one if one is None else one[first:first + step] for one in flat]
            self._run_part(walker, part, count_strides, gain, error, cores, text)
        return walks, by_x, by_r0

    @staticmethod
    def _run_part(walker: Any, part: list[Any], strides: int, kp: float, accuracy: float, threads: int, text: Any) -> None:
        """Some walkers, by so many strides at a time that Ctrl-C need not wait; Python looks for it between two calls."""
        start, push, aim, ends, done, fault, by_x, by_r0 = part
        left, most, whole_strides = strides, max(1, _SLICE // len(start)), done
        for begin in range(0, strides, most):
            left = min(most, strides - begin)
            now = done if begin == 0 else np.zeros_like(done)
            now_fault = fault if begin == 0 else np.zeros_like(fault)
            job = ffi.new("struct afo_strides *", {
                "count": len(start), "strides": left, "x": doubles(start), "r0": doubles(push), "speed": doubles(aim),
                "kp": kp, "accuracy": accuracy, "threads": threads, "next": doubles(ends),
                "done": ffi.cast("int64_t *", ffi.from_buffer(now)),
                "fault": ffi.cast("int8_t *", ffi.from_buffer(now_fault)), "by_x": doubles(by_x), "by_r0": doubles(by_r0)})
            if lib.afo_strides_run(walker, job, text) != 0:
                raise complain(text)
            if begin > 0:
                whole_strides += now
                fault[fault == 0] = now_fault[fault == 0]
            start = ends  # in place from here on; one that fell starts from NaN, and keeps its fault

    def walk(self, x: ArrayLike, r0: ArrayLike, strides: int = 1, *, kp: float = 0.0, speed: ArrayLike | None = None,
             accuracy: float = 1e-9, threads: int = 0) -> Walks:
        """Walks from many apexes at once, on the batch engine.

        x: (..., 3). r0: push-off of every stride, m, >= 0: one number, or one a walker. kp, speed: with them
        r0[k] = r0 + kp (v[k] - speed), eq. (16), v the forward apex speed in rad/s. accuracy: largest error of a stride,
        1e-12 to 1e-4. threads: 0 is one a core. Returns Walks. A number that is not finite is that walker's fault.
        Raises AfoError for shapes and settings that do not fit. The GIL is released; Ctrl-C is heard ten times a second.
        """
        return self._run(x, r0, strides, kp, speed, accuracy, threads, False)[0]

    def return_map(self, x: ArrayLike, r0: ArrayLike, strides: int = 1, *, kp: float = 0.0,
                   speed: ArrayLike | None = None, accuracy: float = 1e-9, threads: int = 0) -> NDArray[np.float64]:
        """The apexes `strides` strides on, (..., 3), NaN where a walker falls. Arguments as for walk()."""
        return self.walk(x, r0, strides, kp=kp, speed=speed, accuracy=accuracy, threads=threads).x

    def derivatives(self, x: ArrayLike, r0: ArrayLike, *, accuracy: float = 1e-9, threads: int = 0) -> Derivatives:
        """One stride with its derivatives by the apex and by r0. Arguments as for walk(); NaN where a walker falls.

        By automatic differentiation, no finite differences: as exact as the map. Eight times the cost of a stride.
        """
        walks, by_x, by_r0 = self._run(x, r0, 1, 0.0, None, accuracy, threads, True)
        assert by_x is not None and by_r0 is not None
        return Derivatives(walks.x, by_x, by_r0)

    # ---- steady gaits ------------------------------------------------------------------

    def _gait(self, found: Any) -> Gait:
        pairs = np.array(list(found.eigenvalues))
        weight_N = (self.M + 2.0 * self.m) * self.g
        return Gait(r0=found.r0_m, kp=found.kp, period=found.period, x=np.array(list(found.x)),
                    eigenvalues=pairs[0::2] + 1j * pairs[1::2], by_x=np.array(list(found.by_x)).reshape(3, 3),
                    by_r0=np.array(list(found.by_r0)), times_s=np.array(list(found.times_s)),
                    step_length_m=found.step_length_m, inter_leg_rad=found.inter_leg_rad,
                    speed_m_s=found.distance_m / found.duration_s,
                    cost_of_transport=found.spring_energy_J / (weight_N * found.distance_m),
                    clamped_strides=found.clamped_strides, residual=found.residual)

    def fixed_point(self, r0: float, branch: str = "long", period: int = 1, *, kp: float = 0.0,
                    guess: ArrayLike | None = None) -> Gait:
        """The gait of a push-off r0 (m, above 0 and below the leg length) that repeats after `period` strides (1 to 1024).

        branch: "long" or "short", the two gaits of period 1, named by step period. kp: gain of eq. (16) around the long
        one. guess: (3,) where Newton's method starts, else the branch is followed from the paper's gait at 0.05 m.
        Raises AfoError where there is none, and says where the branch was lost.
        """
        side, strides = choice(branch, "branch", BRANCHES), whole(period, "period", 1, 1024)
        start = None if guess is None else np.ascontiguousarray(states(guess, "guess"))
        if start is not None and (start.shape != (3,) or not np.isfinite(start).all()):
            raise AfoError(f"guess must be three finite numbers, not {guess!r}")
        found, text = ffi.new("struct afo_gait *"), text_buffer()
        if lib.afo_fixed_point(self._c(), number(r0, "r0", "m"), side, strides, number(kp, "kp", "m per rad/s", 0.0),
                               doubles(start), found, text) != 0:
            raise complain(text)
        return self._gait(found)

    def gaits(self, r0: ArrayLike, branch: str = "long", *, kp: float = 0.0) -> list[Gait]:
        """The gaits of period 1 at each r0 (m) in turn, each followed from the one before: give them in rising order.

        Raises AfoError where the branch is lost; its attribute `gaits` has those found before.
        """
        wanted = np.ascontiguousarray(np.atleast_1d(numbers(r0, "r0")))
        if wanted.ndim != 1:
            raise AfoError(f"r0 has the shape {wanted.shape}; it must be one number or a list of numbers")
        found, text = ffi.new("struct afo_gait[]", max(1, len(wanted))), text_buffer()
        count = lib.afo_branch(self._c(), choice(branch, "branch", BRANCHES), doubles(wanted), len(wanted),
                               number(kp, "kp", "m per rad/s", 0.0), found, text)
        gaits = [self._gait(found[i]) for i in range(count)]
        if count < len(wanted):
            error = complain(text)
            error.gaits = gaits  # type: ignore[attr-defined]
            raise error
        return gaits

    def branch(self, r0: ArrayLike, branch: str = "long", *, kp: float = 0.0) -> pd.DataFrame:
        """gaits() as a table, a row an r0.

        Columns: r0_m, speed_rad_s (forward apex speed), swing_angle_rad, swing_rate_rad_s, re1, im1 ... re3, im3
        (eigenvalues), largest (their largest magnitude), speed_m_s, step_length_m, inter_leg_rad, cost_of_transport.
        """
        rows = []
        for gait in self.gaits(r0, branch, kp=kp):
            row: dict[str, float] = {"r0_m": gait.r0, "speed_rad_s": gait.apex_speed_rad_s, "swing_angle_rad": gait.x[1],
                                     "swing_rate_rad_s": gait.x[2]}
            for i, value in enumerate(gait.eigenvalues, 1):
                row[f"re{i}"], row[f"im{i}"] = value.real, value.imag
            row |= {"largest": abs(gait.eigenvalues[0]), "speed_m_s": gait.speed_m_s,
                    "step_length_m": gait.step_length_m, "inter_leg_rad": gait.inter_leg_rad,
                    "cost_of_transport": gait.cost_of_transport}
            rows.append(row)
        return pd.DataFrame(rows)

    def eigenvalues(self, r0: ArrayLike, branch: str = "long", *, kp: float = 0.0) -> NDArray[np.complex128]:
        """Eigenvalues of the gaits of period 1, largest magnitude first: (3,) of one r0, (n, 3) of n of them."""
        found = np.array([gait.eigenvalues for gait in self.gaits(r0, branch, kp=kp)])
        return found[0] if np.ndim(r0) == 0 else found

    # ---- basins ------------------------------------------------------------------------

    def settle(self, x: ArrayLike, r0: float, *, kp: float = 0.0, strides: int = 200,
               threads: int = 0) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
        """What becomes of starts x (..., 3): places in OUTCOMES, and the strides until then, both (...).

        A start converges when it comes within 1e-4 (rad, rad/s) of the long branch's gait at r0 (m). kp: eq. (16)
        around that gait, m per rad/s. strides: at most so many.
        """
        start = np.ascontiguousarray(states(x))
        shape, flat = start.shape[:-1], start.reshape(-1, 3)
        outcome, taken = np.zeros(len(flat), np.int8), np.zeros(len(flat), np.int32)
        most, push = whole(strides, "strides", 1, 1000000), number(r0, "r0", "m")
        gain, cores = number(kp, "kp", "m per rad/s", 0.0), whole(threads, "threads", 0, 1 << 16)
        walker, text = self._c(), text_buffer()
        step = max(64, 8 * _SLICE // most)
        for first in range(0, len(flat), step):
            part = [one[first:first + step] for one in (flat, outcome, taken)]
            if lib.afo_basin(walker, push, gain, len(part[0]), doubles(part[0]), most, cores,
                             ffi.cast("int8_t *", ffi.from_buffer(part[1])),
                             ffi.cast("int32_t *", ffi.from_buffer(part[2])), text) != 0:
                raise complain(text)
        return outcome.reshape(shape), taken.reshape(shape)

    def basin(self, r0: float, axes: tuple[str, str] = ("swing_angle", "stance_rate"), *,
              ranges: dict[str, tuple[float, float]] | None = None, points: int = 100, kp: float = 0.0,
              strides: int = 200, threads: int = 0) -> Basin:
        """A cross-section of the basin of the long branch's gait at r0 (m): points x points starts.

        axes: two of stance_rate, swing_angle, swing_rate; the third stays at the gait. ranges: low and high of an axis,
        rad or rad/s, in the place of RANGES. The rest as for settle().
        """
        count = whole(points, "points", 2, 5000)
        if len(axes) != 2 or axes[0] == axes[1]:
            raise AfoError(f"axes = {axes!r}: two different ones of {', '.join(AXES)}")
        places = [choice(axis, "axes", AXES) for axis in axes]
        values = []
        for axis in axes:
            low, high = (number(end, f"range of {axis}", "rad, rad/s") for end in {**RANGES, **(ranges or {})}[axis])
            if not high > low:
                raise AfoError(f"the range of {axis} must rise, {low:g} to {high:g} does not")
            values.append(np.linspace(low, high, count))
        start = np.tile(self.fixed_point(r0, kp=0.0).x, (count, count, 1))
        start[..., places[0]], start[..., places[1]] = values[0][:, None], values[1][None, :]
        outcome, taken = self.settle(start, r0, kp=kp, strides=strides, threads=threads)
        return Basin((axes[0], axes[1]), values[0], values[1], outcome, taken)


def return_map(x: ArrayLike, r0: ArrayLike, strides: int = 1, *, walker: Walker | None = None, kp: float = 0.0,
               speed: ArrayLike | None = None, accuracy: float = 1e-9, threads: int = 0) -> NDArray[np.float64]:
    """Walker.return_map() of a walker, the paper's if none is given: apexes (..., 3) to apexes (..., 3)."""
    return (walker or Walker()).return_map(x, r0, strides, kp=kp, speed=speed, accuracy=accuracy, threads=threads)
