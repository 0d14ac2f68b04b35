"""scripts/bus-budget against what others published, and against a schedule drawn out bit by bit."""
import importlib.machinery
import importlib.util
import types

import pytest

from afo import ROOT

_loader = importlib.machinery.SourceFileLoader("bus_budget", str(ROOT / "scripts" / "bus-budget"))
budget = importlib.util.module_from_spec(importlib.util.spec_from_loader("bus_budget", _loader))
_loader.exec_module(budget)


def options(errors_every_us=0.0):
    return types.SimpleNamespace(errors_every_us=errors_every_us, answer_delay_us=0.0, emergencies=0)


def test_the_example_of_davis_and_others():
    """Real-Time Systems 35 (2007), their counterexample to the older analysis: messages A, B,
    C of 7 data bytes, 125 bits, at 125 kbit/s; periods 2.5, 3.5, 3.5 ms, deadlines 2.5, 3.25, 3.25 ms. The second instance of C ends 3.5 ms after its
    release and misses; the first one alone would have seemed to hold with 3 ms."""
    frames = [budget.Frame(name, identifier, 7, period, deadline, 1, "A")
              for name, identifier, period, deadline in
              (("A", 1, 2500, 2500), ("B", 2, 3500, 3250), ("C", 3, 3500, 3250))]
    assert [frame.bits() for frame in frames] == [125, 125, 125]
    rows = budget.Bus(frames, 125000, options()).analyse()
    assert [row[1] for row in rows] == pytest.approx([2000.0, 3000.0, 3500.0])
    assert [row[3] for row in rows] == [True, True, False]


@pytest.mark.parametrize("size, bits", [(0, 55), (1, 65), (2, 75), (4, 95), (5, 105), (6, 115),
                                        (7, 125), (8, 135)])
def test_longest_frames(size, bits):
    assert budget.Frame("X", 1, size, 1000, 1000, 1, "A").bits() == bits


def drawn_out(frames, chosen, bit_us=1):
    """Worst response in us by drawing the bus's busy period from the worst instant: the longest
    less urgent frame has begun one bit before all others are queued at once and then come
    again as fast as they may. No formula: at each end of a frame the most urgent waiting one goes."""
    longer = [f.bits() for f in frames if f.identifier > chosen.identifier]
    release = {f.name: 0 for f in frames if f.identifier <= chosen.identifier}
    now = max(longer, default=0) - 1 if longer else 0
    worst = 0
    while True:
        waiting = [f for f in frames if f.name in release and release[f.name] <= now]
        if not waiting:
            return worst
        frame = min(waiting, key=lambda f: f.identifier)
        now += frame.bits() * bit_us
        if frame is chosen:
            worst = max(worst, now - release[frame.name])
        release[frame.name] += frame.period_us


def test_every_frame_against_the_drawn_schedule():
    """The formula must not lie below the schedule, and above it by the blocking's bit and,
    where a release falls into that bit, by frames that it counts in."""
    frames = [f for f in budget.read_table(budget.TABLE) if not f.apart]
    bus = budget.Bus(frames, 1000000, options())
    exact = 0
    for frame, response, _, _ in bus.analyse():
        drawn = drawn_out(frames, frame)
        assert drawn <= response
        if frame.deadline_us <= 1000:
            assert response - drawn <= 1 + 1e-9, frame.name
        exact += response - drawn <= 1 + 1e-9
    assert exact >= 0.7 * len(frames)


def test_an_error_costs_the_longest_frame_and_31_bits():
    frames = [f for f in budget.read_table(budget.TABLE) if not f.apart]
    without = {row[0].name: row[1] for row in budget.Bus(frames, 1000000, options()).analyse()}
    with_one = {row[0].name: row[1]
                for row in budget.Bus(frames, 1000000, options(10000.0)).analyse()}
    assert with_one["SYNC"] - without["SYNC"] == pytest.approx(31 + 55)
    assert with_one["LEG_STATE_RIGHT"] - without["LEG_STATE_RIGHT"] == pytest.approx(31 + 135)
