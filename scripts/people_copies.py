"""Changed copies of a recorded walk, each by a stated formula.

Rows are dictionaries with the columns of a recording: time_s and, by leg (l, r), thigh_*_deg,
shank_*_deg, ankle_*_deg, contact_*. A copy may say from when on the person stands, and whether
anything in it is forward walking at all.
"""
import bisect
import csv
import math
from collections import namedtuple

LEGS = ("l", "r")
SEGMENTS = ("thigh", "shank")
UPRIGHT = {"thigh": 8.0, "shank": -8.0, "ankle": 5.0}  # a person who stands, degrees

# walks: there is forward walking in it. stands_s: standing from this time on, or None.
Copy = namedtuple("Copy", "rows walks stands_s")


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def write(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0].keys())
        writer.writeheader()
        writer.writerows({key: f"{value:.6g}" if key != "time_s" else f"{value:.9g}"
                          for key, value in row.items()} for row in rows)
    return path


def _angles(row):
    return [key for key in row if key.endswith("_deg")]


def _scaled(row, size):
    """Angles around standing, times size(leg)."""
    other = dict(row)
    for key in _angles(row):
        part, leg = key.split("_")[:2]
        other[key] = UPRIGHT[part] + size(leg) * (row[key] - UPRIGHT[part])
    return other


def _with(row, **values):
    return dict(row, **values)


def slow(rows):
    """0.6 of the amplitude at 1.8 times the period: a third of the walking speed."""
    return Copy([_with(_scaled(row, lambda leg: 0.6), time_s=row["time_s"] * 1.8) for row in rows], True, None)


def short(rows):
    """Half of the amplitude at the same pace."""
    return Copy([_scaled(row, lambda leg: 0.5) for row in rows], True, None)


def limp(rows, share=0.3):
    """The left leg's amplitude is smaller by that share, and its stance is hurried: within each left stance
    time runs faster by the share, outside slower, so that strides keep about their length."""
    other, time_s = [], 0.0
    down = sum(row["contact_l"] for row in rows) / len(rows)
    quick = 1.0 - share / 2
    rest = (1.0 - quick * down) / (1.0 - down) if down < 1.0 else 1.0
    for i, row in enumerate(rows):
        if i > 0:
            time_s += (row["time_s"] - rows[i - 1]["time_s"]) * (quick if row["contact_l"] == 1 else rest)
        other.append(_with(_scaled(row, lambda leg: 1.0 - share if leg == "l" else 1.0), time_s=time_s))
    return Copy(other, True, None)


def limp_40(rows):
    """As limp, by 40 %."""
    return limp(rows, 0.4)


def backwards(rows):
    """The recording from its end to its beginning."""
    last = rows[-1]["time_s"]
    return Copy([_with(row, time_s=last - row["time_s"]) for row in reversed(rows)], False, None)


def _made(seconds, at):
    rows = []
    for i in range(int(seconds * 200)):
        row = {"time_s": i / 200}
        for leg in LEGS:
            thigh, shank, ankle, contact = at(i / 200, leg)
            row.update({f"thigh_{leg}_deg": thigh, f"shank_{leg}_deg": shank, f"ankle_{leg}_deg": ankle,
                        f"contact_{leg}": contact})
        rows.append(row)
    return Copy(rows, False, None)


def rocking(_rows):
    """Both legs together, +-6 degrees at 0.7 Hz, both feet on the ground."""
    def at(t, _leg):
        pitch = 6.0 * math.sin(2 * math.pi * 0.7 * t)
        return pitch + 4, pitch - 4, -pitch, 1
    return _made(20, at)


def scissoring(_rows):
    """The legs against each other, +-12 degrees at 0.9 Hz, both feet on the ground."""
    def at(t, leg):
        pitch = (12.0 if leg == "l" else -12.0) * math.sin(2 * math.pi * 0.9 * t)
        return pitch + 4, pitch - 4, -pitch, 1
    return _made(20, at)


def spot(_rows):
    """Marching on the spot, 0.9 Hz: a foot is lifted by the knee and put down where it was."""
    def at(t, leg):
        phase = (0.9 * t + (0.5 if leg == "r" else 0.0)) % 1.0
        lift = math.sin(math.pi * (phase - 0.6) / 0.4) ** 2 if phase > 0.6 else 0.0
        return 8 + 35 * lift, -8 - 25 * lift, 5 - 15 * lift, 0 if phase > 0.6 else 1
    return _made(20, at)


def harness(rows):
    """Legs as recorded, nothing under the feet: no contact, ankles at neutral."""
    return Copy([_with(row, **{f"contact_{leg}": 0 for leg in LEGS}, **{f"ankle_{leg}_deg": 0.0 for leg in LEGS})
                 for row in rows], False, None)


def leg_held(rows):
    """From two thirds on somebody holds the left leg where it is, in the air."""
    start = 2 * len(rows) // 3
    held = {key: value for key, value in rows[start].items() if "_l" in key}
    held["contact_l"] = 0
    return Copy([dict(row) if i < start else _with(row, **held) for i, row in enumerate(rows)], True,
                rows[start]["time_s"])


def stop(rows, phase):
    """At two thirds, and that share of a left stride later, everything stands still: the last sample is held for
    3 s, with its contacts."""
    strikes = [b["time_s"] for a, b in zip(rows, rows[1:]) if a["contact_l"] == 0 and b["contact_l"] == 1]
    later = [t for t in strikes if t >= rows[2 * len(rows) // 3]["time_s"]]
    if len(later) < 2:
        return None
    stop_s = later[0] + phase * (later[1] - later[0])
    other = [dict(row) for row in rows if row["time_s"] <= stop_s]
    period = rows[1]["time_s"] - rows[0]["time_s"]
    held = other[-1]
    other += [_with(held, time_s=held["time_s"] + period * (n + 1)) for n in range(int(3.0 / period))]
    return Copy(other, True, stop_s)


def trip(rows):
    """Every 7 s the left leg stays where it is for 150 ms in its swing, and is back with the recording 150 ms later."""
    other, held, since = [], None, -1.0
    swing_s, last = 0.0, 0.0
    for row in rows:
        t = row["time_s"]
        swing_s = 0.0 if row["contact_l"] == 1 else swing_s + (t - last)
        last = t
        if held is None and swing_s > 0.12 and t - since > 7.0:
            held, since = row, t
        now = dict(row)
        if held is not None:
            away = 1.0 if t - since < 0.15 else max(0.0, 1.0 - (t - since - 0.15) / 0.15)
            for key in _angles(row):
                if "_l_" in key:
                    now[key] = row[key] + away * (held[key] - row[key])
            held = None if away == 0.0 else held
        other.append(now)
    return Copy(other, True, None)


def gap(rows):
    """In every 5.37 s the samples of 100 ms are missing."""
    start = rows[0]["time_s"]
    return Copy([dict(row) for row in rows if not 3.0 < (row["time_s"] - start) % 5.37 < 3.0995], True, None)


def offset(rows):
    """The left leg's thigh and shank read 5 degrees too much."""
    return Copy([_with(row, **{f"{part}_l_deg": row[f"{part}_l_deg"] + 5.0 for part in SEGMENTS}) for row in rows],
                True, None)


def neutral(rows):
    """Both ankles read 5 degrees too much plantarflexion."""
    return Copy([_with(row, **{f"ankle_{leg}_deg": row[f"ankle_{leg}_deg"] - 5.0 for leg in LEGS}) for row in rows],
                True, None)


def drift(rows):
    """Thigh and shank drift by 3 sin(t / 3 s) degrees on the left, 2 sin(t / 5 s) on the right."""
    by = {"l": (3.0, 3.0), "r": (2.0, 5.0)}
    return Copy([_with(row, **{f"{part}_{leg}_deg": row[f"{part}_{leg}_deg"] +
                               by[leg][0] * math.sin(row["time_s"] / by[leg][1])
                               for part in SEGMENTS for leg in LEGS}) for row in rows], True, None)


def quick(rows):
    """After two thirds of the time the pace rises by 30 %."""
    start = rows[2 * len(rows) // 3]["time_s"]
    return Copy([_with(row, time_s=min(row["time_s"], start) + max(0.0, row["time_s"] - start) / 1.3)
                 for row in rows], True, None)


COPIES = {"slow": slow, "short": short, "limp": limp, "limp-40": limp_40, "backwards": backwards,
          "harness": harness, "leg-held": leg_held, "trip": trip, "gap": gap, "offset": offset,
          "neutral": neutral, "drift": drift, "quick": quick}
COPIES.update({f"stop-{n}": (lambda rows, n=n: stop(rows, n / 10)) for n in range(0, 10, 1)})
# Made without a recording.
MADE = {"rocking": rocking, "scissoring": scissoring, "on-the-spot": spot}


def edges(rows, leg, to):
    """Times at which the contact of a leg changes to `to`."""
    return [b["time_s"] for a, b in zip(rows, rows[1:])
            if a[f"contact_{leg}"] != to and b[f"contact_{leg}"] == to]


def pitch(row, leg):
    """The virtual leg's pitch, rad."""
    thigh, shank = (math.radians(row[f"{part}_{leg}_deg"]) for part in SEGMENTS)
    return math.atan2(math.sin(thigh) + math.sin(shank), math.cos(thigh) + math.cos(shank))


def at(rows, times, time_s):
    """The row that holds at that time."""
    return rows[max(bisect.bisect_right(times, time_s) - 1, 0)]
