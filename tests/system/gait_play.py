"""A recorded walk read, changed, played in other ways (another pace and size, with pauses and
turns), and written again. A person at rest stands upright."""
import bisect
import csv
import math

RATE_HZ = 200
SIDES = {"left": "l", "right": "r"}


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def pitch(row, side):
    thigh, shank = (math.radians(row[f"{part}_{side}_deg"]) for part in ("thigh", "shank"))
    return math.atan2(math.sin(thigh) + math.sin(shank), math.cos(thigh) + math.cos(shank))


def changes(rows, side, to):
    return [b["time_s"] for a, b in zip(rows, rows[1:])
            if a[f"contact_{side}"] != to and b[f"contact_{side}"] == to]


def apexes(rows, side):
    angles = [pitch(row, side) for row in rows]
    return [rows[i]["time_s"] for i in range(1, len(rows))
            if angles[i - 1] > 0 >= angles[i] and rows[i][f"contact_{side}"] == 1]


def write(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=rows[0].keys())
        writer.writeheader()
        writer.writerows({key: f"{value:.6g}" if key != "time_s" else f"{value:.9g}"
                          for key, value in row.items()} for row in rows)
    return path


class Gait:
    """The recording as a function of its own time."""

    def __init__(self, rows):
        self.rows = rows
        self.times = [row["time_s"] for row in rows]
        self.angles = [key for key in rows[0] if key.endswith("_deg")]
        upright = {"thigh": 8.0, "shank": -8.0, "ankle": 5.0}
        self.rest = {key: upright[key.split("_")[0]] for key in self.angles}

    def at(self, time_s):
        i = min(max(bisect.bisect_right(self.times, time_s) - 1, 0), len(self.rows) - 2)
        a, b = self.rows[i], self.rows[i + 1]
        u = (time_s - self.times[i]) / (self.times[i + 1] - self.times[i])
        row = {key: a[key] + u * (b[key] - a[key]) for key in self.angles}
        row.update({f"contact_{side}": a[f"contact_{side}"] for side in "lr"})
        return row


def smooth(u):
    u = min(max(u, 0.0), 1.0)
    return u * u * (3.0 - 2.0 * u)


def play(gait, seconds, pace, size, start_s=5.0):
    """pace(t) and size(t, side): how fast the recording goes on, and by how much its angles
    differ from standing; both of the played time t. Contact: as recorded, down when still."""
    rows, recorded_s = [], start_s
    for i in range(int(seconds * RATE_HZ)):
        t = i / RATE_HZ
        recorded_s += pace(t) / RATE_HZ
        moment = gait.at(recorded_s)
        row = {"time_s": t}
        for key in gait.angles:
            part, side = key.split("_")[:2]
            row[key] = gait.rest[key] + size(t, side) * (moment[key] - gait.rest[key])
        for side in "lr":
            still = pace(t) == 0.0 or size(t, side) < 0.2
            row[f"contact_{side}"] = 1 if still else int(moment[f"contact_{side}"])
        rows.append(row)
    return rows
