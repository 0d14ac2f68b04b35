#!/usr/bin/env python3
"""Time against error of the stride by heyoka: Taylor series compiled for the equations, with its own event detection.

The whole hybrid stride: single support to the heel strike, collision, double support to lift-off, single support to the
apex. "heyoka" integrates one walker at a time, "heyoka N lanes" N of them side by side in vectors. Between two phases the
walkers are moved on in NumPy, all at once; compiling does not count. Python still takes most of the time of the vectors. So
"heyoka N lanes; steps alone" counts nothing but the steps that the stride took, each at the fastest time of a step, with
its look for events: no program around it, in whatever language, can be faster. Prints what
sim_host/batch/benchmark.c prints: method,setting,largest error,median error,strides per second.

Usage: bench_heyoka.py REFERENCE.csv [EVERY]     (EVERY: take each n-th row; default 1)
"""
import csv
import statistics
import sys
import time

import heyoka
import numpy

LIMIT_S = 20.0
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14, 1e-15, 1e-16)
PASSES = 3
STEP_ROUNDS, STEP_PAIRS = 20, 100


def single_support():
    """Parameters A, b, C, g l (M + 1.5 m), g l m / 2: the model's equations solved for the accelerations."""
    ts, tn, ws, wn = heyoka.make_vars("ts", "tn", "ws", "wn")
    A, b, C, stance, swing = (heyoka.par[i] for i in range(5))
    s, c = heyoka.sin(ts - tn), heyoka.cos(ts - tn)
    f1 = b * s * wn * wn + stance * heyoka.sin(ts)
    f2 = -b * s * ws * ws - swing * heyoka.sin(tn)
    det = A * C - b * b * c * c
    rates = [(ts, ws), (tn, wn), (ws, (C * f1 + b * c * f2) / det), (wn, (b * c * f1 + A * f2) / det)]
    return rates, ts, tn


def double_support():
    """Parameters M, m, l, k, g, d, r0."""
    r, v = heyoka.make_vars("r", "v")
    M, m, l, k, g, d, r0 = (heyoka.par[i] for i in range(7))
    l1 = l + r
    cos_d = (l1 * l1 + l * l - d * d) / (2.0 * l * l1)
    sin_d2 = 1.0 - cos_d * cos_d
    sin_d = heyoka.sqrt(sin_d2)
    hip = 1.0 / sin_d2
    hip_slope = 2.0 * cos_d * (1.0 / l - cos_d / l1) * hip * hip
    e = 0.5 * l / l1
    s, s_slope = 1.0 - e, e / l1
    at_hip = M + 0.25 * m + m * s * s
    mu = at_hip * hip + m * (1.0 - s * s)
    mu_slope = at_hip * hip_slope + 2.0 * m * s * s_slope * (hip - 1.0)
    height = l1 * l * sin_d / d
    height_slope = (d - (d * d - l * l + l1 * l1) / (2.0 * d)) / (l * sin_d)
    v_slope = g * ((M + 0.5 * m + m * s) * height_slope + m * s_slope * height)
    return [(r, v), (v, (k * (r0 - r) - v_slope - 0.5 * mu_slope * v * v) / mu)], r - r0


class Phase:
    """One phase of many walkers: from their states to its event, `lanes` walkers at a time."""

    def __init__(self, rates, event, direction, tolerance, lanes):
        states, self.lanes, self.steps = len(rates), lanes, 0
        make = heyoka.taylor_adaptive if lanes == 1 else heyoka.taylor_adaptive_batch
        zeros = numpy.zeros(states) if lanes == 1 else numpy.zeros((states, lanes))
        if lanes == 1:
            events = [heyoka.t_event(event, direction=direction)]
        else:
            events = [heyoka.t_event_batch(event, direction=direction, callback=self.on_arrival())]
        self.integrator = make(rates, zeros, t_events=events, tol=tolerance)
        self.arrived, self.waiting = numpy.empty_like(zeros), set()

    def on_arrival(self):
        """A function and no method: heyoka copies what it is given, and functions stay what they are."""
        def arrive(block, _direction, lane):
            """A lane is at its event: its state is kept, and it goes on for nothing until the last one is there."""
            if lane in self.waiting:
                self.waiting.remove(lane)
                self.arrived[:, lane] = block.state[:, lane]
            return bool(self.waiting)
        return arrive

    def run(self, states, parameters):
        """states (n, rows), parameters (p, rows); rows is a multiple of the lanes. Returns the states at the event."""
        end = numpy.empty_like(states)
        run_block = self._one if self.lanes == 1 else self._block
        for first in range(0, states.shape[1], self.lanes):
            run_block(states, parameters, end, first)
        return end

    def _one(self, states, parameters, end, row):
        one = self.integrator
        one.state[:], one.pars[:], one.time = states[:, row], parameters[:, row], 0.0
        one.reset_cooldowns()
        outcome = one.propagate_until(LIMIT_S)[0]
        end[:, row] = one.state if int(outcome) == -1 else numpy.nan

    def _block(self, states, parameters, end, first):
        block, last = self.integrator, first + self.lanes
        block.state[:], block.pars[:] = states[:, first:last], parameters[:, first:last]
        block.set_time(0.0)
        block.reset_cooldowns()
        self.waiting = set(range(self.lanes))
        block.propagate_until(LIMIT_S)
        self.steps += max(result[3] for result in block.propagate_res)
        end[:, first:last] = self.arrived if not self.waiting else numpy.nan

    def step_s(self, states, parameters):
        """The fastest time of one step, there and back, from the first walkers of a phase."""
        block, best = self.integrator, float("inf")
        for _ in range(STEP_ROUNDS):
            block.state[:], block.pars[:] = states[:, :self.lanes], parameters[:, :self.lanes]
            block.set_time(0.0)
            block.reset_cooldowns()
            start = time.process_time()
            for _ in range(STEP_PAIRS):
                block.step()
                block.step_backward()
            best = min(best, (time.process_time() - start) / (2 * STEP_PAIRS))
        return best


class Stride:
    """The whole stride of the rows of the reference."""

    def __init__(self, tolerance, lanes):
        rates, ts, tn = single_support()
        falling = heyoka.event_direction.negative
        pushing, lifted = double_support()
        self.to_strike = Phase(rates, ts + tn, falling, tolerance, lanes)
        self.push_off = Phase(pushing, lifted, heyoka.event_direction.positive, tolerance, lanes)
        self.to_apex = Phase(rates, ts, falling, tolerance, lanes)
        self.begun = {}  # phase: where it began last

    def run(self, phase, states, parameters):
        self.begun[phase] = (states, parameters)
        return phase.run(states, parameters)

    def steps_alone_s(self, table):
        """Time of the steps that a pass takes."""
        for phase in (self.to_strike, self.push_off, self.to_apex):
            phase.steps = 0
        self.next_of(table)
        return sum(phase.steps * phase.step_s(*begun) for phase, begun in self.begun.items())

    def next_of(self, table):
        M, m, l, k, g, ws, tn, wn, r0 = table
        swinging = numpy.array(((M + 1.25 * m) * l * l, 0.5 * m * l * l, 0.25 * m * l * l, g * l * (M + 1.5 * m),
                                0.5 * g * m * l))
        ts, tn, ws, wn = self.run(self.to_strike, numpy.array((0.0 * tn, tn, ws, wn)), swinging)
        D = ts - tn
        d = 2.0 * l * numpy.sin(numpy.abs(D) / 2.0)
        drive = (3.0 * m + 4.0 * M) * l * numpy.sin(2.0 * D) * ws - 2.0 * m * l * numpy.sin(D) * wn
        rate = numpy.maximum(drive / (7.0 * m + 8.0 * M - 3.0 * m * numpy.cos(2.0 * D)), 0.0)
        r, rate = self.run(self.push_off, numpy.array((0.0 * rate, rate)), numpy.array((M, m, l, k, g, d, r0)))
        l1 = l + r
        x = (d * d - l * l + l1 * l1) / (2.0 * d)
        cos_d = (l1 * l1 + l * l - d * d) / (2.0 * l * l1)
        sin_d = numpy.sqrt(1.0 - cos_d * cos_d)
        start = numpy.array((numpy.arcsin((d - x) / l), numpy.arccos(x / l1) - numpy.pi / 2.0, -rate / (sin_d * l),
                             -rate * cos_d / (sin_d * l1)))
        ts, tn, ws, wn = self.run(self.to_apex, start, swinging)
        return numpy.array((ws, tn, wn))


def measure(name, lanes, table):
    count = table.shape[1]
    padded = numpy.concatenate((table, numpy.repeat(table[:, -1:], -count % lanes, axis=1)), axis=1)
    for tolerance in TOLERANCES:
        stride = Stride(tolerance, lanes)
        best, found = float("inf"), None
        for _ in range(PASSES):
            start = time.process_time()
            found = stride.next_of(padded[:9])
            best = min(best, time.process_time() - start)
        errors = numpy.max(numpy.abs(found[:, :count] - table[9:12]), axis=0)
        tell = f"{tolerance:g},{errors.max():.3e},{statistics.median(errors):.3e}"
        print(f"{name},{tell},{padded.shape[1] / best:.6g}", flush=True)
        if lanes > 1:
            print(f"{name}; steps alone,{tell},{padded.shape[1] / stride.steps_alone_s(padded[:9]):.6g}", flush=True)


def main(arguments):
    with open(arguments[0], newline="") as file:
        table = numpy.array([[float(x) for x in row] for row in list(csv.reader(file))[1:]])
    rows = numpy.ascontiguousarray(table[::int(arguments[1]) if len(arguments) > 1 else 1].T)
    measure("heyoka", 1, rows)
    lanes = heyoka.recommended_simd_size()
    measure(f"heyoka {lanes} lanes", lanes, rows)


if __name__ == "__main__":
    main(sys.argv[1:])
