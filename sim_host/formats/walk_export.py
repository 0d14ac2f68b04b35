#!/usr/bin/env python3
"""Turns a table of afo into Parquet, OpenSim's .mot and .sto, or a moving picture, with all that its .json tells; started by `afo export`."""
import argparse
import csv
import json
import math
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from walk_source import Refusal, listed  # noqa: E402

EXIT_GOOD, EXIT_USAGE = 0, 2
# OpenSim's names of what a table of ticks has; its walker goes along x, and the model's along -x.
GROUND_COLUMNS = tuple(f"{what}_{side}_{axis}" for side in ("left", "right") for what, axis in (
    ("toe", "x_m"), ("toe", "y_m"), ("ground", "x_N"), ("ground", "y_N")))
SEGMENTS = ("thigh", "shank", "foot")  # of a person who bends their knees
BODY_COLUMNS = ("trunk_lean_rad", *(f"{part}_{side}_rad" for side in ("left", "right") for part in SEGMENTS))
TICK_COLUMNS = ("time_s", "theta_left_rad", "theta_right_rad", "ankle_left_m", "ankle_right_m", "hip_x_m", "hip_y_m")


def read(path):
    """(names, columns as text, what FILE.json tells)."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise Refusal(error.strerror) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise Refusal(f"this is no table: {error}") from error
    if len(rows) < 2:
        raise Refusal("it has no rows")
    ragged = next((i for i, row in enumerate(rows) if len(row) != len(rows[0])), None)
    if ragged is not None:
        raise Refusal(f"line {ragged + 1}: {len(rows[ragged])} fields where the header has {len(rows[0])}")
    beside = path.with_name(path.name + ".json")
    try:
        told = json.loads(beside.read_text(encoding="utf-8")) if beside.is_file() else {}
    except ValueError as error:
        raise Refusal(f"{beside}: {error}") from error
    return rows[0], list(zip(*rows[1:])), told


def number(text):
    try:
        return float(text) if text else math.nan
    except ValueError:
        raise Refusal(f"'{text}' where a number was expected") from None


def typed(column):
    """Whole numbers, numbers, truth or text; an empty field is None."""
    kept = [text for text in column if text]
    for make in (int, float):
        try:
            [make(text) for text in kept]
        except ValueError:
            continue
        return [make(text) if text else None for text in column]
    if kept and all(text in ("true", "false") for text in kept):
        return [text == "true" if text else None for text in column]
    return [text or None for text in column]


def unit_of(name):
    """The unit that a column's name ends in, as this project writes names."""
    for ending, unit in (("_rad_s", "rad/s"), ("_m_s", "m/s"), ("_rad", "rad"), ("_N", "N"), ("_m", "m"), ("_s", "s"), ("_J", "J"),
                         ("_Nm", "N m"), ("_W", "W"), ("_A", "A"), ("_V", "V"), ("_degC", "degC"), ("_percent", "%")):
        if name.endswith(ending):
            return unit
    return ""


def to_parquet(names, columns, told, path):
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise Refusal(f"the Python package pyarrow is missing ({error}); to install it: {sys.executable} -m pip install "
                      "pyarrow, or scripts/setup formats in a clone") from None
    arrays = [pyarrow.array(typed(column)) for column in columns]
    fields = [pyarrow.field(name, array.type, metadata={"unit": unit_of(name)}) for name, array in zip(names, arrays)]
    schema = pyarrow.schema(fields, metadata={"experiment": json.dumps(told)})
    pyarrow.parquet.write_table(pyarrow.table(arrays, schema=schema), path)


def write_storage(name, wanted, degrees, told, path):
    """An OpenSim table of these columns."""
    rows = len(wanted["time"])
    lines = [name, "version=1", f"nRows={rows}", f"nColumns={len(wanted)}", f"inDegrees={'yes' if degrees else 'no'}",
             f"experiment={json.dumps(told)}", "endheader", "\t".join(wanted)]
    lines += ["\t".join(f"{value:.9g}" for value in row) for row in zip(*wanted.values())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def ground_forces(names, columns):
    """The columns of a file of ground reaction forces for OpenSim, x forwards and y up; or None and the words why.

    They act at the centre of pressure below a foot, and at a compass' toe."""
    if any(name not in names for name in GROUND_COLUMNS):
        return None, "the table has no ground forces"
    places = tuple(f"pressure_{side}_{axis}_m" for side in ("left", "right") for axis in "xy")
    where = "pressure" if all(name in names for name in places) else "toe"
    if where == "toe" and "trunk_lean_rad" in names:
        return None, "the table is of a person, and has no centres of pressure: make it anew"
    wanted = ("time_s", *GROUND_COLUMNS, *(places if where == "pressure" else ()))
    values = {name: [number(text) for text in columns[names.index(name)]] for name in wanted}
    if any(math.isnan(value) for value in values["ground_left_y_N"]):
        return None, "where the ground's force acts on a person's foot is not known"
    zero, forces = [0.0] * len(values["time_s"]), {"time": values["time_s"]}
    for side, letter in (("left", "l"), ("right", "r")):
        plate = f"ground_force_{letter}"
        x, y = ([0.0 if math.isnan(value) else value for value in values[f"{where}_{side}_{axis}_m"]] for axis in "xy")
        forces |= {f"{plate}_vx": [-x_N for x_N in values[f"ground_{side}_x_N"]], f"{plate}_vy": values[f"ground_{side}_y_N"],
                   f"{plate}_vz": zero, f"{plate}_px": [-x_m for x_m in x], f"{plate}_py": y, f"{plate}_pz": zero,
                   **{f"ground_torque_{letter}_{axis}": zero for axis in "xyz"}}
    return forces, f"at the {'toes' if where == 'toe' else 'centres of pressure'}"


def beside_motion(path, names, columns, told):
    """Writes walk_grf.mot beside walk.mot, where the forces are known; the words for who exports."""
    forces, words = ground_forces(names, columns)
    if forces is None:
        return f"no file of ground forces: {words}"
    path = path.with_name(f"{path.stem}_grf{path.suffix}")
    fresh = path.with_name(path.name + ".new")
    try:
        write_storage("afo_walk_ground_forces", forces, False, told, fresh)
        os.replace(fresh, path)
    finally:
        fresh.unlink(missing_ok=True)
    return f"{path}: the ground's forces on both legs, N, {words}"


def joints_of_compass(values, side):
    """A straight leg, which is pitched from the vertical, and gets longer at the ankle."""
    return {"hip_flexion": [math.degrees(angle) for angle in values[f"theta_{side}_rad"]],
            "knee_angle": [0.0] * len(values["time_s"])}


def joints_of_person(values, side):
    """Joint angles of segments that the table has against the vertical, and of the foot against the ground."""
    lean, thigh, shank, foot = (values[name] for name in ("trunk_lean_rad", *(f"{part}_{side}_rad" for part in SEGMENTS)))
    joints = {"hip_flexion": zip(thigh, lean), "knee_angle": zip(thigh, [-angle for angle in shank]),
              "ankle_angle": zip(foot, [-angle for angle in shank])}
    return {name: [math.degrees(sum(pair)) for pair in pairs] for name, pairs in joints.items()}


def to_storage(names, columns, told, path):
    """An OpenSim motion: the pelvis at the hip, and of both legs hip, knee and ankle in degrees.

    Coordinates as in Rajagopal et al. (2016): pelvis_tx is the way that the hip went, pelvis_tilt is positive backwards, and
    hip_flexion, knee_angle and ankle_angle are positive in flexion and dorsiflexion. A compass keeps its pelvis upright and its
    knees straight, and its legs get longer at the ankles."""
    who = told.get("who", {})
    if who.get("recording"):
        raise Refusal("a recorded person has no hip in the table of ticks: the motion is of a simulated walker")
    bends = "trunk_lean_rad" in names
    wants = (*TICK_COLUMNS, *(BODY_COLUMNS if bends else ()))
    lacking = [name for name in wants if name not in names]
    if lacking:
        raise Refusal(f"a motion is made of a table of ticks (afo sim --ticks=FILE), and this one lacks {listed(lacking)}")
    values = {name: [number(text) for text in columns[names.index(name)]] for name in wants}
    lean = values["trunk_lean_rad"] if bends else [0.0] * len(values["time_s"])
    motion = {"time": values["time_s"], "pelvis_tilt": [-math.degrees(angle) for angle in lean],
              "pelvis_tx": [-x for x in values["hip_x_m"]], "pelvis_ty": values["hip_y_m"]}
    for side, letter in (("left", "l"), ("right", "r")):
        joints = (joints_of_person if bends else joints_of_compass)(values, side)
        motion |= {f"{name}_{letter}": angles for name, angles in joints.items()}
        if not bends:
            motion[f"leg_extension_{letter}_m"] = values[f"ankle_{side}_m"]
    write_storage("afo_walk", motion, True, told, path)


def to_picture(names, columns, told, path):
    """The walk of a table of ticks, moving."""
    import walk_picture
    lacking = [name for name in walk_picture.NEEDED if name not in names]
    if lacking:
        raise Refusal(f"a moving picture is made of a table of ticks (afo sim --ticks=FILE), and this one lacks {listed(lacking)}")
    if told.get("who", {}).get("recording"):
        raise Refusal("a recorded person has no hip in the table of ticks: the picture is of a simulated walker")
    kept = {name: columns[names.index(name)] if name in ("stance", "phase") else [number(x) for x in columns[names.index(name)]]
            for name in (*walk_picture.NEEDED, *walk_picture.BODY) if name in names}
    rows = [dict(zip(kept, row)) for row in zip(*kept.values())]
    if len(rows) < 2:
        raise Refusal("a moving picture needs two rows or more")
    path.write_text(walk_picture.draw(rows, told), encoding="utf-8")


WRITERS = {".parquet": to_parquet, ".mot": to_storage, ".sto": to_storage, ".svg": to_picture}


def main(arguments):
    parser = argparse.ArgumentParser(prog="afo export", description=__doc__, allow_abbrev=False)
    parser.add_argument("table", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args(arguments)
    fresh = options.out.with_name(options.out.name + ".new")
    try:
        write = WRITERS.get(options.out.suffix.lower())
        if write is None:
            raise Refusal(f"--out {options.out}: its ending says in what format, and is one of {listed(WRITERS)}")
        names, columns, told = read(options.table)
        write(names, columns, told, fresh)
        os.replace(fresh, options.out)
        more = beside_motion(options.out, names, columns, told) if write is to_storage else None
    except (Refusal, OSError) as error:
        fresh.unlink(missing_ok=True)
        print(f"afo export: {options.table}: {error}", file=sys.stderr)
        return EXIT_USAGE
    except KeyboardInterrupt:
        fresh.unlink(missing_ok=True)
        print("afo export: stopped", file=sys.stderr)
        return 130
    print(f"{options.out}: {len(columns[0])} rows of {len(names)} columns from {options.table}"
          + ("" if told else f"; {options.table}.json is not there, so it says not how they were made"))
    if more:
        print(more)
    return EXIT_GOOD


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
