"""What a C3D file holds of a walk: markers, events, force plates. It is read by ezc3d."""
import numpy as np

from walk_source import Refusal


def read(path):
    """{"time_s", "markers": name -> (n, 3) with NaN in gaps, "events": (side, label, s), "plates", "notes"}."""
    import ezc3d
    notes = []
    try:
        file = ezc3d.c3d(str(path), extract_forceplat_data=True)
    except Exception as error:  # ezc3d raises what its C++ threw
        try:
            file = ezc3d.c3d(str(path))
        except Exception:
            raise Refusal(f"ezc3d cannot read it: {error}") from None
        notes.append(f"the force plates cannot be read: {error}")
    points = file["data"]["points"]
    rate = float(file["header"]["points"]["frame_rate"])
    if points.shape[2] < 2 or rate <= 0:
        raise Refusal(f"{points.shape[2]} frames of {points.shape[1]} markers at {rate:g} Hz: nothing to read a walk from")
    time_s = (file["header"]["points"]["first_frame"] + np.arange(points.shape[2])) / rate
    names = label_list(file["parameters"]["POINT"])
    markers = {}
    for i, name in enumerate(names[:points.shape[1]]):
        values = points[:3, i, :].T.copy()
        values[(values == 0.0).all(axis=1)] = np.nan  # how many a program writes a marker that was not seen
        markers[name.split(":")[-1].strip()] = values
    return {"time_s": time_s, "rate": rate, "markers": markers, "notes": notes,
            "events": events(file["parameters"].get("EVENT", {})), "plates": plates(file, time_s[0])}


def label_list(group):
    """LABELS, LABELS2, ...: a parameter holds 255 of them."""
    names = list(group["LABELS"]["value"])
    more = 2
    while f"LABELS{more}" in group:
        names += group[f"LABELS{more}"]["value"]
        more += 1
    return names


def events(group):
    """(side or None, label, seconds) of each; the side by its context, else by the label's first letter."""
    if "LABELS" not in group or "TIMES" not in group:
        return []
    times = np.array(group["TIMES"]["value"], dtype=float).reshape(2, -1)
    contexts = group.get("CONTEXTS", {}).get("value", [])
    found = []
    for i, label in enumerate(group["LABELS"]["value"][:times.shape[1]]):
        told = (contexts[i] if i < len(contexts) else "").strip().lower()[:1]
        side = told if told in ("l", "r") else label.strip().lower()[:1]
        found.append((side if side in ("l", "r") else None, label.strip(), 60.0 * times[0, i] + times[1, i]))
    return found


def plates(file, start_s):
    rate = float(file["header"]["analogs"]["frame_rate"])
    found = []
    for i, platform in enumerate(file["data"].get("platform", [])):
        force = np.asarray(platform["force"])
        if force.size and rate > 0:
            found.append({"name": f"plate {i + 1}", "time_s": start_s + np.arange(force.shape[1]) / rate,
                          "force": force.T, "at": np.asarray(platform["center_of_pressure"]).T, "side": None})
    return found
