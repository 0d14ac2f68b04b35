"""Not only steady walking: standing, starting, stopping, shuffling, turning, another pace, and
backwards, played from a recording (gait_play.py). No event twice, none missed, none while
standing; the device pushes in the right phase only, and joins in again after a stop.

Played are a made walk and, where AFO_DATA names a folder with it, a recorded one (conftest.py).
"""
import math

import pytest

from afo import walk
from gait_play import SIDES, Gait, apexes, changes, play, read, smooth, write

KINDS = ("apex", "heel_strike", "toe_off")


@pytest.fixture(scope="module")
def gait(person):
    return Gait(read(person))


def between(t, first, last, ramp=1.0):
    return smooth((t - first) / ramp) * smooth((last - t) / ramp)


def full(_t, _side):
    return 1.0


def truths(rows, side):
    return {"apex": apexes(rows, side), "heel_strike": changes(rows, side, 1),
            "toe_off": changes(rows, side, 0)}


def once_each(result, rows, first_s, last_s):
    """Every event within the time span was found, once, near its place."""
    for name, side in SIDES.items():
        for kind, true in truths(rows, side).items():
            found = result[name][f"{kind}_s"]
            assert all(b - a > 0.3 for a, b in zip(found, found[1:])), (name, kind)
            inner = [t for t in true if first_s < t < last_s]
            assert inner
            for t in inner:
                assert min(abs(f - t) for f in found) < 0.12, (name, kind, t)
            for f in found:
                if first_s + 0.2 < f < last_s - 0.2:
                    assert min(abs(f - t) for t in true) < 0.12, (name, kind, f)


def pushes_in_phase(result, rows, pace=1.0):
    """From just before the other foot lands (its contact is recorded late by some ms) until
    it stands; never with the leg ahead."""
    for name, side in SIDES.items():
        strikes = changes(rows, "r" if side == "l" else "l", 1)
        for release in result[name]["release_s"]:
            assert min(abs(release - strike) for strike in strikes) < 0.06 / pace, (name, release)


@pytest.mark.parametrize("manner", [
    ("slow", lambda t: 0.5, full),
    ("brisk", lambda t: 1.2, full),
    ("shuffling", lambda t: 0.8, lambda t, side: 0.35),
    ("slow and small", lambda t: 0.6, lambda t, side: 0.25),
    ("speeding up and slowing down", lambda t: 1 + 0.3 * math.sin(0.8 * t),
     lambda t, side: 1 + 0.2 * math.sin(0.8 * t)),
    ("a turn, the inner leg's steps short", lambda t: 0.9,
     lambda t, side: 1 - (0.4 if side == "l" else 0.15) * between(t, 10, 22, 3)),
], ids=lambda manner: manner[0])
def test_walking_in_another_way(gait, manner, tmp_path):
    _, pace, size = manner
    rows = play(gait, 30, pace, size)
    _, result = walk("--recording", write(tmp_path / "way.csv", rows))
    once_each(result, rows, 2.0, 29.0)
    pushes_in_phase(result, rows, min(1.0, pace(0)))
    assert all(len(result[name]["release_s"]) >= 30 * pace(0) / 1.13 - 5 for name in SIDES)


def test_standing(gait, tmp_path):
    """Quietly, and swaying to and fro, and from leg to leg."""
    still = play(gait, 20, lambda t: 0.0, lambda t, side: 0.0)
    for i, row in enumerate(still):
        t = row["time_s"]
        sway = 4.0 * math.sin(1.5 * t) if i > 1000 else 0.0
        against = 1.2 * math.sin(6.0 * t) if i > 2500 else 0.0
        for side, sign in (("l", 1), ("r", -1)):
            for part in ("thigh", "shank"):
                row[f"{part}_{side}_deg"] += sway + sign * against
    _, result = walk("--recording", write(tmp_path / "still.csv", still))
    for name in SIDES:
        assert not any(result[name][f"{kind}_s"] for kind in KINDS + ("release",))


def test_starting_and_stopping(gait, tmp_path):
    """Two bouts of walking, each begun and ended within a second."""
    bouts = ((4, 18), (24, 40))

    def going(t, _side=None):
        return max(between(t, *bout) for bout in bouts)
    rows = play(gait, 46, going, going)
    _, result = walk("--recording", write(tmp_path / "bouts.csv", rows))
    for first, last in bouts:
        once_each(result, rows, first + 1.5, last - 1.5)
        for name in SIDES:
            pushes = [t for t in result[name]["release_s"] if first < t < last]
            assert len(pushes) >= (last - first) / 1.13 - 6, "did not join in again"
    pushes_in_phase(result, rows)
    at_rest = [(0, 4), (18.2, 24), (40.2, 46)]
    for name in SIDES:
        for kind in KINDS + ("release",):
            assert not [t for t in result[name][f"{kind}_s"]
                        for a, b in at_rest if a < t < b], (name, kind)


def test_stopping_in_mid_stride(gait, tmp_path):
    """Frozen where they are, legs apart, for six seconds; then on."""
    rows = play(gait, 40, lambda t: 1.0 - smooth((t - 12) / 0.5) + smooth((t - 18) / 0.7), full)
    _, result = walk("--recording", write(tmp_path / "frozen.csv", rows))
    once_each(result, rows, 1.0, 11.8)
    once_each(result, rows, 19.5, 39.0)
    pushes_in_phase(result, rows)
    for name in SIDES:
        assert not [t for t in result[name]["release_s"] if 12.6 < t < 18]
        assert len([t for t in result[name]["release_s"] if t > 18]) >= 20 / 1.13 - 5


def test_walking_backwards(gait, tmp_path):
    """A planted foot then turns its leg forwards: what looks like steps is none, and the device
    keeps out of it from the second one on."""
    rows = play(gait, 30, lambda t: 1.0 if t < 14 else -1.0, full)
    _, result = walk("--recording", write(tmp_path / "back.csv", rows))
    for name in SIDES:
        assert [t for t in result[name]["release_s"] if t < 14]
        assert not [t for t in result[name]["release_s"] if t > 14.6]
