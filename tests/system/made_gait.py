"""A walk made by computation, for a machine that has no recording of a person.

While the foot is flat the leg turns back evenly over it. Then the heel rises and the leg comes to rest backwards; there the toe leaves the ground. In
swing the leg turns forwards to its furthest point, and just before it lands it turns back to the ground's
speed. The shares of the stride and the angles are those of a healthy adult on level ground, rounded. Knee
and ankle follow curves drawn through a few points with the shape of the mean curves in textbooks of gait
analysis. Heel strike and toe-off are known exactly. Stride times scatter.
"""
import bisect
import math
import random

RATE_HZ = 200
STRIDE_S = 1.12
# Shares of the stride: the heel rises, the toe leaves the ground, the leg is furthest ahead.
HEEL_RISE, TOE_OFF, FURTHEST = 0.53, 0.605, 0.965
STRIKE_DEG, RISE_DEG = 29.5, -17.0   # the leg's pitch at heel strike and at heel rise
# Degrees of flexion by share of the stride, heel strike to heel strike.
KNEE = ((0.0, 4), (0.15, 18), (0.40, 6), (0.62, 40), (0.73, 62), (0.95, 4), (1.0, 4))
ANKLE = ((0.0, 0), (0.07, -5), (0.46, 10), (0.65, -17), (0.78, 1), (1.0, 0))
SIDES = {"l": 0.0, "r": 0.5}     # the phase at which each leg is ahead of the left one


def through(points, share):
    """A smooth curve through the points, level at each of them."""
    for (a, low), (b, high) in zip(points, points[1:]):
        if share <= b:
            u = (share - a) / (b - a)
            return low + (high - low) * u * u * (3 - 2 * u)
    return points[-1][1]


def planted_pitch(share):
    """Pitch and its rate per stride while the foot is flat: the leg turns back evenly."""
    strike, rise = math.radians(STRIKE_DEG), math.radians(RISE_DEG)
    rate = (rise - strike) / HEEL_RISE
    return strike + rate * share, rate


def pitch(share):
    """The leg's pitch in radians. Its rate has no jump."""
    if share < HEEL_RISE:
        return planted_pitch(share)[0]
    rise, rate = planted_pitch(HEEL_RISE)
    strike, strike_rate = planted_pitch(0.0)
    last = rise + rate * (TOE_OFF - HEEL_RISE) / 2
    furthest = strike - strike_rate * (1 - FURTHEST) / 2
    if share < TOE_OFF:
        u = (TOE_OFF - share) / (TOE_OFF - HEEL_RISE)
        return last + (rise - last) * u * u
    if share < FURTHEST:
        u = (share - TOE_OFF) / (FURTHEST - TOE_OFF)
        return last + (furthest - last) * u * u * (3 - 2 * u)
    u = (share - FURTHEST) / (1 - FURTHEST)
    return furthest + (strike - furthest) * u * u


def made_gait(seconds=50.0, seed=1, stride_s=STRIDE_S, size=1.0, asymmetry=0.0):
    """Rows with the columns of a recording: time_s and, by leg, thigh, shank, ankle, contact.

    stride_s is the mean stride time. size scales the legs' pitch, and so the steps. asymmetry is the share
    of the stride by which the right foot lands early, and by which the left leg's steps are smaller. The
    walking speed is about 1.3 m/s * size * 1.12 s / stride_s on a leg of 0.9 m."""
    rng = random.Random(seed)
    starts = [-stride_s]
    while starts[-1] < seconds + stride_s:
        starts.append(starts[-1] + stride_s * (1 + rng.gauss(0.0, 0.01)))
    rows = []
    for i in range(int(seconds * RATE_HZ)):
        time_s = i / RATE_HZ
        k = bisect.bisect_right(starts, time_s) - 1
        phase = (time_s - starts[k]) / (starts[k + 1] - starts[k])
        row = {"time_s": time_s}
        for side, ahead in SIDES.items():
            share = (phase + ahead + (asymmetry if side == "r" else 0.0)) % 1.0
            knee = through(KNEE, share)
            angle = math.degrees(pitch(share)) * size * (1 - asymmetry if side == "l" else 1.0)
            row[f"thigh_{side}_deg"] = angle + knee / 2
            row[f"shank_{side}_deg"] = angle - knee / 2
            row[f"ankle_{side}_deg"] = through(ANKLE, share)
            row[f"contact_{side}"] = int(share < TOE_OFF)
        rows.append(row)
    return rows
