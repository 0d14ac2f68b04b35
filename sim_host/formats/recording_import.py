#!/usr/bin/env python3
"""Makes the recording that `afo sim --recording` plays from files of gait laboratories; started by `afo import`."""
import argparse
import hashlib
import json
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from walk_source import ANKLES, CONTACTS, PITCHES, ROLES, SIDES, Refusal  # noqa: E402

EXIT_GOOD, EXIT_BAD, EXIT_USAGE = 0, 1, 2
DEBIAN = {"numpy": "python3-numpy"}
PYPI = {"can": "python-can"}
KINDS = ("c3d", "trc", "mot", "table", "log")
SUFFIXES = {".c3d": "c3d", ".mot": "mot", ".sto": "mot", ".asc": "log", ".blf": "log", ".mf4": "log"}


def options_of(arguments):
    parser = argparse.ArgumentParser(prog="afo import", description=__doc__, allow_abbrev=False)
    parser.add_argument("file", type=pathlib.Path)
    parser.add_argument("--version", default="")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--from", dest="kind", choices=KINDS)
    parser.add_argument("--forces", type=pathlib.Path)
    for name in ("column", "marker"):
        parser.add_argument(f"--{name}", action="append", default=[])
    for name in ("reverse", "swap"):
        parser.add_argument(f"--{name}", action="append", default=[])
    parser.add_argument("--angles", choices=("deg", "rad"))
    parser.add_argument("--time", choices=("s", "ms", "us"))
    for name in ("rate", "contact-over", "ankle-neutral"):
        parser.add_argument(f"--{name}", type=float)
    parser.add_argument("--longest-gap", type=float, default=0.1)
    parser.add_argument("--part", type=int)
    parser.add_argument("--interface")
    options = parser.parse_args(arguments)
    options.column, options.marker = pairs("--column", options.column), pairs("--marker", options.marker)
    return options


def pairs(option, texts):
    """role -> name of ROLE=NAME texts."""
    for text in texts:
        if "=" not in text:
            raise Refusal(f"{option}: \"{text}\" is not ROLE=NAME")
    return dict(text.split("=", 1) for text in texts)


def need(module):
    """Refuses with the command that installs a missing package."""
    try:
        __import__(module)
    except ImportError as error:
        command = (f"sudo apt-get install {DEBIAN[module]}" if module in DEBIAN else
                   f"{sys.executable} -m pip install {PYPI.get(module, module)}, or scripts/setup formats in a clone")
        raise Refusal(f"the Python package {module} is missing ({error}); to install it: {command}") from None


def kind_of(path, options):
    if options.kind:
        return options.kind
    suffix = path.suffix.lower()
    if suffix == ".trc":
        import can_logs
        return "log" if can_logs.is_peak(path) else "trc"
    if suffix == ".log":
        raise Refusal("a candump log needs no import: afo replay and afo view --replay read it as it is")
    return SUFFIXES.get(suffix, "table")


def read_forces(source, options, feet=None, level=(0, 2)):
    import contacts
    import opensim
    import table_source
    try:
        table, _ = opensim.storage(options.forces)
    except Refusal as refusal:
        raise Refusal(f"--forces {options.forces}: {refusal}") from None
    time_s = table.values("time")
    table_source.check_times(time_s, table.lines)
    plates = contacts.plates_of_table(table, time_s)
    if not plates:
        raise Refusal(f"--forces {options.forces}: no column such as ground_force_vy; found are {', '.join(table.names[:20])}")
    contacts.from_plates(source, plates, options, feet)


def read_markers(path, kind, options):
    """A walk from C3D or .trc: pitches from markers, contacts from events, else from plates."""
    import contacts
    import markers
    if kind == "c3d":
        need("ezc3d")
        import c3d_file
        file = c3d_file.read(path)
        time_s, places = file["time_s"], file["markers"]
        words = (f"C3D, {len(places)} points at {file['rate']:g} Hz, {len(file['events'])} events, "
                 f"{len(file['plates'])} force plates")
    else:
        import opensim
        import table_source
        time_s, places = opensim.trc(path)
        table_source.check_times(time_s, None)
        file, words = {"events": [], "plates": [], "notes": []}, f"OpenSim markers, {len(places)} of them"
    source, feet, axis = markers.read(words, time_s, places, options)
    source.notes += file["notes"]
    events = [(side, bool(contacts.STRIKE.search(label)), s) for side, label, s in file["events"]
              if side and (contacts.STRIKE.search(label) or contacts.OFF.search(label))]
    level = [i for i in range(3) if i != axis]
    if options.forces:
        read_forces(source, options)
    elif events:
        contacts.from_events(source, events)
    elif file["plates"]:
        for plate in file["plates"]:
            plate["up"], plate["level"] = plate["force"][:, axis], level
        contacts.from_plates(source, file["plates"], options, feet)
    return source


def read(path, options):
    need("numpy")
    kind = kind_of(path, options)
    if kind in ("c3d", "trc"):
        return read_markers(path, kind, options)
    import opensim
    import table_source
    import text_table
    if kind == "mot":
        table, in_degrees = opensim.storage(path)
        if options.angles is None and in_degrees is not None:
            options.angles = "deg" if in_degrees else "rad"
        source = table_source.read(table, f"OpenSim motion, {len(table.names)} columns", options)
    else:
        table = text_table.read(text_table.decoded(path))
        source = table_source.read(table, table.words(), options)
    if options.forces:
        read_forces(source, options)
    return source


def change(source, options):
    """What the user asked to turn or swap, and the ankle's neutral."""
    columns = source.columns
    for role in options.reverse:
        if role not in columns or role in CONTACTS:
            raise Refusal(f"--reverse {role}: there is no such angle; these are {', '.join(r for r in columns if r not in CONTACTS)}")
        columns[role] = -columns[role]
        source.taken[role] += ", sign turned"
    for part in options.swap:
        left, right = f"{part}_l", f"{part}_r"
        if left not in columns or right not in columns:
            raise Refusal(f"--swap {part}: the file has no {left} and {right}; thigh, shank, ankle or contact")
        for table in (columns, source.taken):
            table[left], table[right] = table[right], table[left]
    if any(role in columns for role in ANKLES):
        if options.ankle_neutral is None:
            source.notes.append("ankle neutral unknown: 0 assumed; --ankle-neutral DEG says at which angle of this file a "
                                "standing person's foot is")
        for role in ANKLES:
            if role in columns and options.ankle_neutral is not None:
                columns[role] = columns[role] - options.ankle_neutral
                source.taken[role] += f", less {options.ankle_neutral:g} deg"


def strikes_and_offs(source):
    import checks
    return {side: (checks.strikes(source.columns[f"contact_{side}"]), checks.offs(source.columns[f"contact_{side}"]))
            for side in SIDES if f"contact_{side}" in source.columns}


def report(source, options, said, found, where):
    import numpy as np
    lines = [f"file       {options.file}: {source.kind}"]
    rate = 1.0 / float(np.median(np.diff(source.time_s)))
    lines.append(f"time       {source.time_s[0]:g} to {source.time_s[-1]:g} s, {len(source.time_s)} samples, {rate:.4g} Hz; "
                 f"from {source.taken['time']}")
    lines.append("")
    lines.append("           role        from to (deg)   taken from")
    events = strikes_and_offs(source)
    for role in ROLES[1:]:
        values = source.columns.get(role)
        if values is None:
            lines.append(f"           {role:<9}  {'-':>6} {'-':>6}   nothing")
        elif role in CONTACTS:
            at, end = events[role[-1]]
            lines.append(f"           {role:<9}  {'':13}   {source.taken[role]}: {len(at)} heel strikes, {len(end)} toe-offs")
        else:
            lines.append(f"           {role:<9}  {values.min():6.1f} {values.max():6.1f}   {source.taken[role]}")
    lines.append("")
    lines += [f"note       {note}" for note in source.notes]
    lines += [f"gaps       {text}" for text in said or ["none"]]
    lines += [f"check      {text}" for text in found or ["signs, units and sides look like those of a walk"]]
    lacking = [role for role in (*ANKLES, *CONTACTS) if role not in source.columns]
    if where is None:
        lines.append("written    nothing: --out FILE.csv writes it")
    else:
        lines.append(f"written    {where}, and {where}.json, which says from what")
        lines.append(f"play it    afo sim --recording {where}" + "".join(f" --column {role}=" for role in lacking))
    if any(role in lacking for role in CONTACTS):
        lines.append("           without contacts there are no foot switches, and nothing to judge events by: add --switches none")
    return "\n".join(lines)


def write_whole(path, text):
    """The file appears whole or not at all."""
    fresh = path.with_name(path.name + ".new")
    try:
        with open(fresh, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        os.replace(fresh, path)
    except OSError as error:
        fresh.unlink(missing_ok=True)
        raise Refusal(f"{path}: {error.strerror}") from error


def csv_text(source):
    roles = [role for role in ROLES[1:] if role in source.columns]
    header = ["time_s", *(role if role in CONTACTS else f"{role}_deg" for role in roles)]
    lines = [",".join(header)]
    for i, time_s in enumerate(source.time_s):
        lines.append(",".join([f"{time_s:.9g}", *(f"{source.columns[role][i]:.0f}" if role in CONTACTS else
                                                  f"{source.columns[role][i]:.4f}" for role in roles)]))
    return "\n".join(lines) + "\n"


def about(source, options, said, found):
    """What the recording was made of, for the file beside it."""
    def fingerprint(path):
        return hashlib.sha256(path.read_bytes()).hexdigest()
    files = {str(path): fingerprint(path) for path in (options.file, options.forces) if path}
    return json.dumps({"made_by": f"afo import, {options.version}", "source_sha256": files, "source_kind": source.kind,
                       "taken_from": source.taken, "assumed": source.notes, "gaps": said, "checks": found,
                       "options": {"reverse": options.reverse, "swap": options.swap, "ankle_neutral_deg": options.ankle_neutral,
                                   "longest_gap_s": options.longest_gap, "part": options.part}}, indent=2) + "\n"


def import_log(options):
    need("can")
    import can_logs
    text, words = can_logs.read(options.file, options.interface)
    print(f"file       {options.file}: {words}")
    if options.out is None:
        print("written    nothing: --out FILE.log writes it")
        return EXIT_GOOD
    write_whole(options.out, text)
    print(f"written    {options.out}\nreplay it  afo replay {options.out}")
    return EXIT_GOOD


def import_walk(options):
    need("numpy")
    import gaps
    import checks
    source = read(options.file, options)
    lacking = [role for role in PITCHES if role not in source.columns]
    if lacking:
        raise Refusal(f"it has no {', '.join(lacking)}")
    change(source, options)
    said = gaps.treat(source, options.longest_gap, options.part)
    found = checks.findings(source.columns)
    if options.out:
        write_whole(options.out, csv_text(source))
        write_whole(options.out.with_name(options.out.name + ".json"), about(source, options, said, found))
    print(report(source, options, said, found, options.out))
    return EXIT_BAD if found else EXIT_GOOD


def main(arguments):
    where = None
    try:
        options = options_of(arguments)
        where = options.file
        if not where.is_file():
            raise Refusal("no such file" if not where.exists() else "this is no file")
        if options.out and options.out.exists() and options.out.samefile(where):
            raise Refusal("--out names the file itself")
        return import_log(options) if kind_of(where, options) == "log" else import_walk(options)
    except Refusal as refusal:
        sys.stdout.flush()
        print(f"afo import: {where}: {refusal}" if where else f"afo import: {refusal}", file=sys.stderr)
        return EXIT_USAGE
    except PermissionError as error:
        print(f"afo import: {error.filename}: {error.strerror}", file=sys.stderr)
        return EXIT_USAGE
    except KeyboardInterrupt:
        print("afo import: stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
