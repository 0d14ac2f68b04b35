"""Contact of each foot, from events, from forces under each foot, or from plates that know no foot."""
import re

import numpy as np

from walk_source import SIDES, Refusal, leg_pitch_deg

FORCE_N = 20.0  # a foot is on the ground above it, as in most laboratories
FORCE_BODY_WEIGHTS = 0.03
LEAST_S = 0.1  # a shorter load of a plate is no step
STRIKE = re.compile(r"strike|initial contact|foot ?down|^[lr]?(fs|hs|ic)$", re.I)
OFF = re.compile(r"foot ?off|toe ?off|^[lr]?(fo|to)$", re.I)
# ground_force_vy, 1_ground_force_vy, ground_force_r_vy, ground_force_1_vy, FP1_vy: a plate, and a letter of x y z
FORCE_NAME = re.compile(r"^(?P<plate>.*?)_?v(?P<axis>[xyz])$", re.I)


def level_of(force, options, newtons=False):
    """(force, above which a foot is down, in N or body weights; words). The sign is made that of a push upwards."""
    largest, least = np.nanmax(force), np.nanmin(force)
    sign = 1.0 if largest >= -least else -1.0
    peak = max(largest, -least)
    if options.contact_over is not None:
        level, unit = options.contact_over, ""
    elif peak < 10.0 and not newtons:
        level, unit = FORCE_BODY_WEIGHTS, " body weights"
    else:
        level, unit = FORCE_N, " N"
    return sign * force, level, f"over {level:g}{unit}{', sign turned' if sign < 0 else ''}"


def from_column(values, name, options):
    """(0, 1 or NaN; words) from a column of contacts or forces."""
    kinds = np.unique(values[~np.isnan(values)])
    if len(kinds) <= 2 and options.contact_over is None:
        if len(kinds) < 2:
            raise Refusal(f"contact column \"{name}\" is {kinds[0] if len(kinds) else 'empty'} everywhere; leave it "
                          "out with --column contact_l= or contact_r=")
        shown = "" if tuple(kinds) == (0, 1) else f", {kinds[1]:g} taken as down and {kinds[0]:g} as up"
        return np.where(np.isnan(values), np.nan, values == kinds[1]), f"\"{name}\"{shown}"
    force, level, words = level_of(values, options)
    return np.where(np.isnan(force), np.nan, force > level), f"\"{name}\", a force {words}"


def from_events(source, events):
    """events: (side, is_strike, seconds). A foot is down from its strike, and up from its toe-off, to the nearest sample."""
    for side in SIDES:
        own = sorted((s, strike) for which, strike, s in events if which == side)
        if not own:
            continue
        values = np.full(len(source.time_s), 0.0 if own[0][1] else 1.0)
        doubles = sum(a[1] == b[1] for a, b in zip(own, own[1:]))
        for seconds, strike in own:
            half = 0.5 * np.median(np.diff(source.time_s))
            values[np.searchsorted(source.time_s, seconds - half):] = 1.0 if strike else 0.0
        source.take(f"contact_{side}", values, f"{len(own)} events")
        if doubles:
            source.notes.append(f"{doubles} {SIDES[side]} events follow one of their own kind: one between them is missing")


def plates_of_table(table, time_s):
    """The plates of an OpenSim table of forces, whose y is up."""
    plates = []
    for name in table.names:
        match = FORCE_NAME.match(name)
        if match is None or match["axis"].lower() != "y" or "force" not in name.lower():
            continue
        words = set(re.split(r"[^a-z0-9]+", match["plate"].lower()))
        side = "l" if words & {"l", "left"} else "r" if words & {"r", "right"} else None
        plates.append({"name": name, "time_s": time_s, "up": table.values(name), "side": side, "at": None})
    return plates


def loads(plate, options):
    """(first, last + 1) of each load of the plate, and the words of the threshold."""
    force, level, words = level_of(plate["up"], options, newtons=True)
    on = np.concatenate([[False], force > level, [False]])
    edges = np.flatnonzero(np.diff(on.astype(int)))
    step = np.median(np.diff(plate["time_s"]))
    return [(a, b) for a, b in zip(edges[::2], edges[1::2])
            if (b - a) * step >= LEAST_S or a == 0 or b == len(force)], words


def nearest_foot(plate, load, feet):
    """By the centre of pressure in the middle of the load. feet: side -> (n, 3) at the plate's own samples."""
    middle = slice(load[0] + (load[1] - load[0]) // 3, load[1] - (load[1] - load[0]) // 3 + 1)
    with np.errstate(invalid="ignore"):
        far = {side: np.nanmean(np.linalg.norm((foot[middle] - plate["at"][middle])[:, plate["level"]], axis=1))
               for side, foot in feet.items()}
    return min(far, key=far.get) if np.isfinite(list(far.values())).all() else None


def leading_leg(plate, load, pitch):
    """A foot that comes down is the one in front, and the one behind when it leaves. pitch: at the plate's samples."""
    ahead = pitch["l"] - pitch["r"]
    begin = ahead[load[0]] if load[0] > 0 else 0.0
    end = ahead[load[1] - 1] if load[1] < len(ahead) else 0.0
    return "l" if begin - end > 0 else "r"


def from_plates(source, plates, options, feet):
    """Contacts by force plates. A plate that names no side is given step by step to a foot: to the nearer one where
    feet (side -> positions at source.time_s) are known, else to the leg that is in front at the load's begin."""
    if not plates:
        return
    step = np.median(np.diff(source.time_s))
    down = {side: np.zeros(len(source.time_s)) for side in SIDES}
    words = ""
    for plate in plates:
        pitch = {side: np.interp(plate["time_s"], source.time_s, leg_pitch_deg(source.columns, side)) for side in SIDES}
        at = {side: np.stack([np.interp(plate["time_s"], source.time_s, foot[:, i]) for i in range(3)], 1)
              for side, foot in (feet or {}).items()}
        steps, words = loads(plate, options)
        for load in steps:
            side = plate["side"] or (nearest_foot(plate, load, at) if at and plate["at"] is not None else None)
            side = side or leading_leg(plate, load, pitch)
            begin = plate["time_s"][load[0]] - 1e-9 if load[0] > 0 else -np.inf
            end = plate["time_s"][load[1]] - 1e-9 if load[1] < len(plate["time_s"]) else np.inf
            down[side][(source.time_s >= begin) & (source.time_s < end)] = 1.0
    outside = (source.time_s < plates[0]["time_s"][0] - step) | (source.time_s > plates[0]["time_s"][-1] + step)
    how = "plates, " if all(plate["side"] is None for plate in plates) else "forces, "
    for side in SIDES:
        own = [plate["name"] for plate in plates if plate["side"] == side]
        source.take(f"contact_{side}", np.where(outside, np.nan, down[side]), f"{own[0] + ', ' if own else how}{words}")
    if all(plate["side"] is None for plate in plates):
        source.notes.append("the plates name no foot: each load is given to the "
                            f"{'nearer foot' if feet else 'leg in front when it begins'}")
