"""A walk written as gait laboratories keep it, by the libraries and in the layouts of others.

A body is put under the recorded pitches: hip, knee and ankle as joints of rods, a foot of heel and toe; it walks along x,
its left at +y, z up (C3D), or along x with y up (OpenSim). Forces under the feet are made of the contacts.
"""
import math

import numpy as np

THIGH_M, SHANK_M, HIP_M, HALF_WIDTH_M, SPEED_M_S = 0.42, 0.41, 0.92, 0.09, 1.2
HEEL_M, TOE_M = 0.05, 0.18
LOAD_N = 700.0
SIDES = "lr"


def columns(rows):
    return {key: np.array([row[key] for row in rows]) for key in rows[0]}


def rod(length, pitch):
    """From a joint to the one below it, in the plane of walking: (forward, up)."""
    return length * np.stack([np.sin(pitch), -np.cos(pitch)], 1)


def body(walk):
    """name -> (n, 3) of (forward, left, up), m: hip, knee, ankle, heel and toe of both legs, as Plug-in Gait calls them."""
    forward = SPEED_M_S * (walk["time_s"] - walk["time_s"][0])
    out = {}
    for side in SIDES:
        thigh, shank, ankle = (np.radians(walk[f"{part}_{side}_deg"]) for part in ("thigh", "shank", "ankle"))
        plane = {"HJC": np.stack([forward, np.full_like(forward, HIP_M)], 1)}
        plane["KNE"] = plane["HJC"] + rod(THIGH_M, thigh)
        plane["ANK"] = plane["KNE"] + rod(SHANK_M, shank)
        sole = np.stack([np.cos(ankle + shank), np.sin(ankle + shank)], 1)
        plane["HEE"] = plane["ANK"] - HEEL_M * sole
        plane["TOE"] = plane["ANK"] + TOE_M * sole
        left = HALF_WIDTH_M if side == "l" else -HALF_WIDTH_M
        for name, place in plane.items():
            out[side.upper() + name] = np.stack([place[:, 0], np.full(len(place), left), place[:, 1]], 1)
    return out


def changes(walk, side):
    """(is_strike, s) of each change of contact."""
    contact = walk[f"contact_{side}"]
    return [(contact[i] == 1, walk["time_s"][i]) for i in range(1, len(contact)) if contact[i] != contact[i - 1]]


def c3d(path, walk, with_events=True, with_plates=False, hidden=()):
    """By ezc3d, in mm; hidden: (marker, first, last + 1) that the cameras did not see. Two plates, one under each foot."""
    import ezc3d
    rate = 1.0 / np.median(np.diff(walk["time_s"]))
    markers = body(walk)
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [rate]
    file["parameters"]["POINT"]["LABELS"]["value"] = list(markers)
    points = np.ones((4, len(markers), len(walk["time_s"])))
    for i, (name, place) in enumerate(markers.items()):
        points[:3, i, :] = 1000.0 * place.T
        for which, first, end in hidden:
            if which == name:
                points[:3, i, first:end] = np.nan
    file["data"]["points"] = points
    if with_events:
        start = walk["time_s"][0]
        for s, side, strike in sorted((s, side, strike) for side in SIDES for strike, s in changes(walk, side)):
            file.add_event([float((s - start) // 60), (s - start) % 60], "Left" if side == "l" else "Right",
                           "Foot Strike" if strike else "Foot Off")
    if with_plates:
        put_plates(file, walk, rate)
    file.write(str(path))
    return path


def put_plates(file, walk, rate):
    """Two plates of type 2 (force and moments), as wide as the way is long: corners in mm, the origin in the surface.

    A plate measures what it is pressed with: its z points down, so a foot gives a positive Fz there, and the force on the
    plate at (x, y) has the moments Mx = y Fz and My = -x Fz about the plate's middle."""
    n, feet = len(walk["time_s"]), body(walk)
    length = 1000.0 * (SPEED_M_S * (walk["time_s"][-1] - walk["time_s"][0]) + 2.0)
    channels = np.zeros((12, n))
    corners, middle = [], 0.5 * length - 1000.0
    for i, side in enumerate("rl"):  # a plate does not say whose it is
        y = -200.0 if side == "r" else 200.0
        corners.append([[middle + dx, y + dy, 0.0] for dx, dy in
                        ((length / 2, 190.0), (-length / 2, 190.0), (-length / 2, -190.0), (length / 2, -190.0))])
        down = LOAD_N * walk[f"contact_{side}"]
        foot = 1000.0 * feet[side.upper() + "ANK"]
        x = foot[:, 0] - middle
        channels[6 * i + 2] = -down
        channels[6 * i + 3] = -(foot[:, 1] - y) * down
        channels[6 * i + 4] = x * down
    names = [f"{kind}{axis}{plate}" for plate in (1, 2) for kind in "FM" for axis in "xyz"]
    analog = file["parameters"]["ANALOG"]
    analog["RATE"]["value"] = [rate]
    analog["LABELS"]["value"] = names
    analog["SCALE"]["value"] = [1.0] * 12
    analog["OFFSET"]["value"] = [0] * 12
    analog["UNITS"]["value"] = ["N", "N", "N", "Nmm", "Nmm", "Nmm"] * 2
    file["data"]["analogs"] = channels[None]
    plate = file["parameters"]["FORCE_PLATFORM"]  # is there from the start: whole numbers stay such
    for name, value in (("USED", [2]), ("TYPE", [2, 2]), ("ZERO", [0, 0]), ("CHANNEL", np.arange(1, 13).reshape(2, 6).T),
                        ("CORNERS", np.array(corners).transpose(2, 1, 0)), ("ORIGIN", np.zeros((3, 2)))):
        plate[name]["value"] = value


def trc(path, walk):
    """OpenSim's markers: y up, in mm, tabs."""
    markers = body(walk)
    rate = 1.0 / np.median(np.diff(walk["time_s"]))
    n = len(walk["time_s"])
    lines = [f"PathFileType\t4\t(X/Y/Z)\t{path.name}",
             "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
             f"{rate:g}\t{rate:g}\t{n}\t{len(markers)}\tmm\t{rate:g}\t1\t{n}",
             "Frame#\tTime\t" + "\t".join(f"{name}\t\t" for name in markers),
             "\t\t" + "\t".join(f"X{i}\tY{i}\tZ{i}" for i in range(1, len(markers) + 1)), ""]
    for i in range(n):
        places = [1000.0 * place[i] for place in markers.values()]
        lines.append(f"{i + 1}\t{walk['time_s'][i]:.6f}\t" +
                     "\t".join(f"{x:.5f}\t{z:.5f}\t{-y:.5f}" for x, y, z in places))
    path.write_text("\r\n".join(lines) + "\r\n", encoding="ascii")
    return path


def storage(path, names, values, in_degrees=None):
    """An OpenSim .mot or .sto."""
    lines = [path.stem, "version=1", f"nRows={len(values)}", f"nColumns={len(names)}"]
    if in_degrees is not None:
        lines.append(f"inDegrees={'yes' if in_degrees else 'no'}")
    lines += ["endheader", "\t".join(names)]
    lines += ["\t".join(f"{value:.9g}" for value in row) for row in values]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def joints(path, walk, unit="deg", knee=-1.0, tilt_deg=-11.0):
    """Joint angles as gait2392 has them (knee: -1) or Rajagopal's model (+1): tilt backward positive, on its own.

    All coordinates of these models that have such a word in their names are there, as inverse kinematics writes them."""
    factor = 1.0 if unit == "deg" else math.pi / 180.0
    names = ["time", "pelvis_tilt", "pelvis_list", "pelvis_rotation", "pelvis_tx", "pelvis_ty", "pelvis_tz"]
    tilt = tilt_deg + 1.5 * np.sin(11.0 * walk["time_s"])
    values = [walk["time_s"], factor * tilt, 0.01 * tilt, 0.02 * tilt, 1.2 * walk["time_s"], 0.9 + 0.001 * tilt, 0.0 * tilt]
    for side in "rl":
        thigh, shank = walk[f"thigh_{side}_deg"], walk[f"shank_{side}_deg"]
        names += [f"hip_flexion_{side}", f"hip_adduction_{side}", f"hip_rotation_{side}", f"knee_angle_{side}",
                  f"knee_angle_{side}_beta", f"ankle_angle_{side}", f"subtalar_angle_{side}", f"mtp_angle_{side}"]
        bend = factor * knee * (thigh - shank)
        values += [factor * (thigh - tilt), 0.0 * thigh, 0.1 * thigh, bend, bend, factor * walk[f"ankle_{side}_deg"], 0.0 * thigh,
                   0.0 * thigh]
    return storage(path, names, np.stack(values, 1), unit == "deg")


def forces(path, walk, sides=("ground_force_", "1_ground_force_"), rate_times=5):
    """Ground reaction of the right foot, then the left one's, at a multiple of the walk's rate."""
    start, end = walk["time_s"][[0, -1]]
    step = np.median(np.diff(walk["time_s"])) / rate_times
    time_s = start + step * np.arange(round((end - start) / step) + 1)
    names, values = ["time"], [time_s]
    last = np.searchsorted(walk["time_s"], time_s + 1e-9) - 1
    for base, side in zip(sides, "rl"):
        down = walk[f"contact_{side}"][last]
        names += [f"{base}vx", f"{base}vy", f"{base}vz", f"{base}px", f"{base}py", f"{base}pz"]
        values += [30.0 * down, LOAD_N * down + 3.0 * np.sin(40.0 * time_s), 0 * down, 0 * down, 0 * down, 0 * down]
    return storage(path, names, np.stack(values, 1))


def german_table(path, walk):
    """A spreadsheet's export: lines above, semicolons, decimal commas, ms, units below the names, forces in N."""
    def number(value):
        return f"{value:.4f}".replace(".", ",")
    names = ["Zeit", "Oberschenkel links", "Oberschenkel rechts", "Unterschenkel links", "Unterschenkel rechts",
             "Sprunggelenk links", "Sprunggelenk rechts", "Kraft links", "Kraft rechts"]
    keys = ["thigh_l_deg", "thigh_r_deg", "shank_l_deg", "shank_r_deg", "ankle_l_deg", "ankle_r_deg"]
    lines = ["Messung;12", "Datum;3.4.2025", ";".join(names), "ms;" + ";".join(["Grad"] * 6 + ["N"] * 2)]
    for i, time_s in enumerate(walk["time_s"]):
        fields = [number(1000.0 * time_s), *(number(walk[key][i]) for key in keys)]
        fields += [number(2.0 + LOAD_N * walk[f"contact_{side}"][i]) for side in SIDES]
        lines.append(";".join(fields))
    path.write_text("\n".join(lines) + "\n", encoding="latin-1")
    return path


def table(path, walk, names=None, down=1, rows=None, changed=None):
    """A CSV with the project's columns, some renamed, some changed (key -> function of its values)."""
    names = names or {}
    changed = changed or {}
    values = {key: changed.get(key, lambda v: v)(column) for key, column in walk.items()}
    for side in SIDES:
        if f"contact_{side}" in values:
            values[f"contact_{side}"] = down * values[f"contact_{side}"]
    keep = range(len(walk["time_s"])) if rows is None else rows
    lines = [",".join(names.get(key, key) for key in values)]
    lines += [",".join("" if math.isnan(column[i]) else f"{column[i]:.6f}" for column in values.values()) for i in keep]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path
