"""A walk from a table whose columns are angles and contacts: CSV of any kind, and OpenSim's .mot and .sto."""
import math

import numpy as np

import column_names
import contacts
from walk_source import ANKLES, PITCHES, ROLES, SIDES, Refusal, Source, listed

JOINTS = ("pelvis", "hip_l", "hip_r", "knee_l", "knee_r")
RAD_AT_MOST = 2.3  # all pitches of a walk within this many units: radians. In degrees a leg sweeps ten times that.


def unit_of(name, unit_line, kinds):
    words = [word.lower() for word in column_names.words_in(name) + column_names.words_in(unit_line)]
    return next((kinds[word] for word in words if word in kinds), None)


def time_of(table, name, options):
    """Seconds, and from where, in words."""
    values = table.values(name)
    if np.isnan(values).any():
        raise Refusal(f"line {table.lines[int(np.isnan(values).argmax())]}: no time")
    step = float(np.median(np.diff(values))) if len(values) > 1 else 0.0
    words = {word.lower() for word in column_names.words_in(name)}
    if words & {"frame", "sample"}:
        if options.rate is None:
            raise Refusal(f"\"{name}\" counts samples: how many a second? --rate HZ")
        return values / options.rate, f"\"{name}\" at {options.rate:g} Hz"
    unit = options.time or unit_of(name, table.units[table.names.index(name)],
                                   {"ms": "ms", "s": "s", "sec": "s", "seconds": "s", "us": "us"})
    how = ""
    if unit is None:
        unit = "ms" if step >= 1.0 else "s"
        how = f", taken as {unit}: its step is {step:g} (--time {'s' if unit == 'ms' else 'ms'} for the other)"
    return values * {"s": 1.0, "ms": 1e-3, "us": 1e-6}[unit], f"\"{name}\", {unit}{how}"


def check_times(time_s, lines):
    if len(time_s) < 2:
        raise Refusal("fewer than two samples")
    back = np.flatnonzero(np.diff(time_s) <= 0)
    if len(back):
        at = f"line {lines[back[0] + 1]}: " if lines is not None else ""
        raise Refusal(f"{at}time does not go on: {time_s[back[0] + 1]:g} s after {time_s[back[0]]:g} s")


def angle_factor(table, names, options):
    """Degrees per unit of the angles, and how that was told."""
    if options.angles:
        return (1.0 if options.angles == "deg" else math.degrees(1.0)), f"{options.angles}, as told"
    for name in names:
        unit = unit_of(name, table.units[table.names.index(name)], {"deg": "deg", "degrees": "deg", "rad": "rad"})
        if unit:
            return (1.0 if unit == "deg" else math.degrees(1.0)), unit
    largest = max(float(np.nanmax(np.abs(table.values(name)))) for name in names)
    if largest < RAD_AT_MOST:
        return math.degrees(1.0), f"taken as rad: none is beyond {largest:.2f} (--angles deg for the other)"
    return 1.0, f"taken as deg: the largest is {largest:.0f} (--angles rad for the other)"


def from_joints(source, table, found, factor):
    """Segment pitch from joint angles: thigh = pelvis tilt + hip flexion, shank = thigh - knee flexion.

    As OpenSim's models define them (gait2392, Rajagopal 2016): pelvis_tilt backward positive, hip flexion positive.
    Knee flexion has either sign there; the one is taken by which the knees bend."""
    lacking = [role for role in JOINTS if found.get(role) is None]
    if lacking:
        return False
    values = {role: factor * table.values(found[role]) for role in JOINTS}
    bent = np.concatenate([values["knee_l"], values["knee_r"]])
    sign = 1.0 if np.nanmax(bent) > -np.nanmin(bent) else -1.0
    for side in SIDES:
        thigh = values["pelvis"] + values[f"hip_{side}"]
        source.take(f"thigh_{side}", thigh, f"{found['pelvis']} + {found[f'hip_{side}']}")
        source.take(f"shank_{side}", thigh - sign * values[f"knee_{side}"],
                    f"thigh_{side} {'-' if sign > 0 else '+'} {found[f'knee_{side}']}")
    source.notes.append(f"the knees' flexion is {'positive' if sign > 0 else 'negative'} in this file: they bend that way")
    return True


def pitches(source, table, found, options):
    """Thigh, shank and ankle; from joint angles where there are no segments."""
    missing = [role for role in PITCHES if found[role] is None]
    names = [found[role] for role in (*PITCHES, *ANKLES, *JOINTS) if found[role]]
    if not names:
        raise Refusal(column_names.missing("no column for " + ", ".join(missing), missing, table.names) +
                      f"; tell which is which: --column {missing[0]}=NAME")
    factor, how = angle_factor(table, names, options)
    if missing and (len(missing) < len(PITCHES) or not from_joints(source, table, found, factor)):
        raise Refusal(column_names.missing("no column for " + ", ".join(missing), missing, table.names) +
                      f"; tell which is which: --column {missing[0]}=NAME")
    for role in (*PITCHES, *ANKLES):
        if found[role] and role not in source.columns:
            source.take(role, factor * table.values(found[role]), f"\"{found[role]}\"")
    source.notes.append(f"angles are {how}")


def read(table, kind, options):
    """A walk from a table; forces in it (ground_force_vy and its like) become contacts."""
    found = column_names.assign(table.names, options.column, (*ROLES, *JOINTS))
    if found["time"] is None and options.rate is None:
        raise Refusal(column_names.missing("no column for time, and no --rate HZ", ["time", "time_s"], table.names))
    if found["time"] is None:
        time_s, words = np.arange(len(table.rows)) / options.rate, f"{options.rate:g} Hz, as told"
    else:
        time_s, words = time_of(table, found["time"], options)
    check_times(time_s, table.lines)
    source = Source(kind, time_s)
    source.taken["time"] = words
    pitches(source, table, found, options)
    for role in ("contact_l", "contact_r"):
        if found[role]:
            values, how = contacts.from_column(table.values(found[role]), found[role], options)
            source.take(role, values, how)
    if options.forces is None and not any(found[role] for role in ("contact_l", "contact_r")):
        contacts.from_plates(source, contacts.plates_of_table(table, time_s), options, feet=None)
    return source
