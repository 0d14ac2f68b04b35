#!/usr/bin/python3
"""Time against error of the stride by SciPy's solve_ivp: DOP853 with events, one call a phase.

Single support is written twice: solved by hand on plain floats with Python's math module, the fastest found
("SciPy DOP853"), and with a mass matrix and numpy.linalg.solve, as such models are mostly written ("SciPy
DOP853; NumPy matrices"). Prints what sim_host/batch/benchmark.c prints:
method,setting,largest error,median error,strides per second.

Usage: bench_scipy.py REFERENCE.csv [EVERY]     (EVERY: take each n-th row; default 1)
"""
import csv
import statistics
import sys
import time
from math import acos, asin, cos, pi, sin, sqrt

import numpy
from scipy.integrate import solve_ivp

LIMIT_S = 20.0


def single_support(M, m, l, g):
    A, b, C = (M + 1.25 * m) * l * l, 0.5 * m * l * l, 0.25 * m * l * l

    def rates(_, y):
        ts, tn, ws, wn = y
        s, c = sin(ts - tn), cos(ts - tn)
        f1 = b * s * wn * wn + g * l * (M + 1.5 * m) * sin(ts)
        f2 = -b * s * ws * ws - 0.5 * g * m * l * sin(tn)
        det = A * C - b * b * c * c
        return ws, wn, (C * f1 + b * c * f2) / det, (b * c * f1 + A * f2) / det
    return rates


def single_support_in_matrices(M, m, l, g):
    def rates(_, y):
        angle, rate = y[:2], y[2:]
        s, c = numpy.sin(angle[0] - angle[1]), numpy.cos(angle[0] - angle[1])
        mass = numpy.array([[(M + 1.25 * m) * l * l, -0.5 * m * l * l * c],
                            [-0.5 * m * l * l * c, 0.25 * m * l * l]])
        centrifugal = 0.5 * m * l * l * s * numpy.array([rate[1] ** 2, -rate[0] ** 2])
        gravity = g * l * numpy.array([M + 1.5 * m, -0.5 * m]) * numpy.sin(angle)
        return numpy.concatenate((rate, numpy.linalg.solve(mass, centrifugal + gravity)))
    return rates


def double_support(M, m, l, k, g, d, r0):
    def rates(_, y):
        r, v = y
        l1 = l + r
        cos_d = (l1 * l1 + l * l - d * d) / (2 * l * l1)
        sin_d = sqrt(1 - cos_d * cos_d)
        hip = 1 / (sin_d * sin_d)
        hip_slope = 2 * cos_d * (1 / l - cos_d / l1) * hip * hip
        e = 0.5 * l / l1
        s, s_slope = 1 - e, e / l1
        at_hip = M + 0.25 * m + m * s * s
        mu = at_hip * hip + m * (1 - s * s)
        mu_slope = at_hip * hip_slope + 2 * m * s * s_slope * (hip - 1)
        height = l1 * l * sin_d / d
        height_slope = (d - (d * d - l * l + l1 * l1) / (2 * d)) / (l * sin_d)
        v_slope = g * ((M + 0.5 * m + m * s) * height_slope + m * s_slope * height)
        return v, (k * (r0 - r) - v_slope - 0.5 * mu_slope * v * v) / mu
    return rates


def strike(_, y):
    return y[0] + y[1]


def upright(_, y):
    return y[0]


strike.terminal = upright.terminal = True
strike.direction = upright.direction = -1.0


def phase(rates, start, event, tolerance):
    run = solve_ivp(rates, (0.0, LIMIT_S), start, method="DOP853", events=event,
                    rtol=max(tolerance, 2.3e-14), atol=tolerance)
    if len(run.y_events[0]) == 0:  # a step so long that both crossings fell into it
        raise ArithmeticError("event missed")
    return run.y_events[0][0]


def stride(row, tolerance, equations):
    M, m, l, k, g, ws, tn, wn, r0 = row[:9]
    swing = equations(M, m, l, g)
    ts, tn, ws, wn = phase(swing, (0.0, tn, ws, wn), strike, tolerance)
    D = ts - tn
    d = 2 * l * sin(abs(D) / 2)
    drive = (3 * m + 4 * M) * l * sin(2 * D) * ws - 2 * m * l * sin(D) * wn
    rate = max(drive / (7 * m + 8 * M - 3 * m * cos(2 * D)), 0.0)

    def lifted(_, y):
        return y[0] - r0
    lifted.terminal, lifted.direction = True, 1.0
    r, rate = phase(double_support(M, m, l, k, g, d, r0), (0.0, rate), lifted, tolerance)
    l1 = l + r
    x = (d * d - l * l + l1 * l1) / (2 * d)
    cos_d = (l1 * l1 + l * l - d * d) / (2 * l * l1)
    sin_d = sqrt(1 - cos_d * cos_d)
    start = (asin((d - x) / l), acos(x / l1) - pi / 2, -rate / (sin_d * l), -rate * cos_d / (sin_d * l1))
    ts, tn, ws, wn = phase(swing, start, upright, tolerance)
    return ws, tn, wn


def stride_or_nothing(row, tolerance, equations):
    try:
        return stride(row, tolerance, equations)
    except ArithmeticError:
        return (float("inf"),) * 3


def measure(name, equations, rows):
    for tolerance in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-14):
        best, errors = float("inf"), []
        for _ in range(2):
            start = time.process_time()
            answers = [stride_or_nothing(row, tolerance, equations) for row in rows]
            best = min(best, time.process_time() - start)
        for row, answer in zip(rows, answers):
            errors.append(max(abs(a - b) for a, b in zip(answer, row[9:12])))
        print(f"{name},{tolerance:g},{max(errors):.3e},{statistics.median(errors):.3e},"
              f"{len(rows) / best:.6g}", flush=True)


def main(arguments):
    with open(arguments[0], newline="") as file:
        table = [[float(x) for x in row] for row in list(csv.reader(file))[1:]]
    rows = table[::int(arguments[1]) if len(arguments) > 1 else 1]
    measure("SciPy DOP853", single_support, rows)
    measure("SciPy DOP853; NumPy matrices", single_support_in_matrices, rows)


if __name__ == "__main__":
    main(sys.argv[1:])
