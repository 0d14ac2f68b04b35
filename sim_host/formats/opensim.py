"""OpenSim's text files: motions and forces (.mot, .sto), and markers (.trc)."""
import re

import numpy as np

import text_table
from walk_source import Refusal


def storage(path):
    """The table of a .mot or .sto file, and whether its angles are in degrees (None: the file does not say)."""
    text = text_table.decoded(path)
    lines = text.splitlines()
    end = next((i for i, line in enumerate(lines) if line.strip().lower() == "endheader"), None)
    if end is None:
        raise Refusal("no line \"endheader\": this is no OpenSim .mot or .sto file")
    head = dict(re.findall(r"^\s*(\w+)\s*=\s*(\S+)", "\n".join(lines[:end]), re.M))
    kind = head.get("DataType", "double")
    if kind != "double":
        raise Refusal(f"its DataType is {kind}, and double is expected: OpenSim's flatten() makes such a table")
    table = text_table.read("\n" * (end + 1) + "\n".join(lines[end + 1:]))
    told = {key.lower(): value.lower() for key, value in head.items()}.get("indegrees")
    return table, None if told is None else told in ("yes", "true", "1")


def trc(path):
    """(seconds, marker -> (n, 3) with NaN in gaps) of an OpenSim marker file. Positions in the file's unit."""
    lines = text_table.decoded(path).splitlines()
    start = next((i for i, line in enumerate(lines) if line.startswith("Frame#")), None)
    if start is None:
        raise Refusal("no line begins with Frame#: this is no OpenSim marker file")
    fields = lines[start].rstrip("\r\n").split("\t")
    places = {name.strip(): i for i, name in enumerate(fields) if i >= 2 and name.strip()}
    if not places:
        raise Refusal(f"line {start + 1} names no markers behind Frame# and Time")
    time_s, rows = [], []
    width = max(places.values()) + 3
    for i, line in enumerate(lines[start + 1:], start + 2):
        row = [field.strip() for field in line.split("\t")]
        if not row[0] or not row[0].lstrip("-").isdigit():
            continue
        row += [""] * (width - len(row))
        try:
            time_s.append(float(row[1]))
            rows.append([float(field) if field and field.lower() != "nan" else np.nan for field in row[2:width]])
        except ValueError as error:
            raise Refusal(f"line {i}: {error}") from None
    values = np.array(rows).reshape(len(rows), -1)
    markers = {name: values[:, place - 2:place + 1] for name, place in places.items()} if rows else {}
    return np.array(time_s), markers
