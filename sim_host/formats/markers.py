"""Segment pitch from markers: which marker is which joint, which way is up, which way the walk goes.

pitch = atan2(d . forward, -d . up), d from the segment's upper joint to its lower one.
dorsiflexion = pitch of the foot from the horizontal, less the shank's: 0 with the sole flat below an upright shank.
"""
import numpy as np

import column_names
from walk_source import SIDES, Refusal, Source, listed

# By joint, without the letter of the side: names of Plug-in Gait, OpenSim's models and common marker sets.
NAMES = {
    "hip": ("hjc", "hip", "fep", "troc", "gtr", "tro", "gt", "greatertrochanter", "hipcenter"),
    "knee": ("kjc", "kne", "knee", "kneelat", "knee1", "lek", "fle", "lfe", "latcondyle", "kneeouter", "femoralepicondyle"),
    "ankle": ("ajc", "ank", "ankle", "anklelat", "lm", "fal", "lml", "latmalleolus", "ankleouter", "malleolus", "mall"),
    "heel": ("hee", "heel", "cal", "fcc", "calc", "calcaneus"),
    "toe": ("toe", "toetip", "mt2", "toemid", "fm2", "d2m", "meta2", "toelat", "mt5", "fm5", "met"),
    "asi": ("asi", "asis", "ias"),
    "psi": ("psi", "psis", "ips"),
}
SACRUM = ("sacr", "sacrum", "sac", "vsacr")
NEEDED = ("hip", "knee", "ankle")
STRAIGHT = 0.9  # way from begin to end over way along the path: above it the walk is one straight line
WENT_LEGS = 1.5  # and it went at least so many leg lengths; else it is a treadmill
# Bell, Pedersen, Brand (1990), J Biomech 23:617: hip centre from the middle of the ASIS, over their distance.
BELL_BACK, BELL_SIDE, BELL_DOWN = 0.19, 0.36, 0.30


def folded(name):
    return "".join(c for c in name.lower() if c.isalnum())


def find(markers, joint, side):
    """The marker of that joint: its letter before or behind any of the names."""
    by_name = {}
    for name in markers:
        by_name.setdefault(folded(name), name)
    word = SIDES[side]
    for base in NAMES[joint]:
        for form in (side + base, base + side, word + base, base + word):
            if form in by_name:
                return by_name[form]
    return None


def chosen(markers, options):
    """(joint, side) -> the marker's name, or None."""
    found = {}
    for joint in NAMES:
        for side in SIDES:
            role = f"{joint}_{side}"
            if role in options.marker:
                if options.marker[role] not in markers:
                    raise Refusal(column_names.missing(f"--marker {role}={options.marker[role]}: no such marker",
                                                       [options.marker[role]], list(markers)))
                found[joint, side] = options.marker[role]
            else:
                found[joint, side] = find(markers, joint, side)
    unknown = [role for role in options.marker if tuple(role.rsplit("_", 1)) not in found]
    if unknown:
        raise Refusal(f"--marker: there is no role \"{unknown[0]}\"; the roles are "
                      + listed(f"{joint}_{side}" for joint in NAMES for side in SIDES))
    return found


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def hip_centres(markers, names):
    """Both hips by Bell's regression from the pelvis markers: both ASIS, and both PSIS or the sacrum; None without them."""
    sacrum = next((name for name in markers if folded(name) in SACRUM), None)
    backs = [names["psi", side] for side in SIDES] if all(names["psi", side] for side in SIDES) else [sacrum]
    if not all(names["asi", side] for side in SIDES) or None in backs:
        return None
    left, right = (markers[names["asi", side]] for side in SIDES)
    front, back = 0.5 * (left + right), np.mean([markers[name] for name in backs], axis=0)
    wide = left - right
    width = np.linalg.norm(wide, axis=1, keepdims=True)
    left = wide / width
    ahead = front - back
    ahead = unit(ahead - left * np.sum(ahead * left, axis=1, keepdims=True))
    up = np.cross(ahead, left)
    return {side: front + width * (-BELL_BACK * ahead - BELL_DOWN * up + (BELL_SIDE if side == "l" else -BELL_SIDE) * left)
            for side in SIDES}


def joints(markers, options):
    """(joint -> side -> (n, 3), where from in words): hip, knee, ankle, and heel and toe where they are."""
    names = chosen(markers, options)
    centres = hip_centres(markers, names) if not all(names["hip", side] for side in SIDES) else None
    lacking = [f"{joint}_{side}" for joint in NEEDED for side in SIDES
               if names[joint, side] is None and (joint != "hip" or centres is None)]
    if lacking:
        wanted = [f"{lacking[0][-1]}{base}" for base in NAMES[lacking[0][:-2]]]
        raise Refusal(column_names.missing("no marker for " + ", ".join(lacking), wanted, list(markers)) +
                      f"; tell which is which: --marker {lacking[0]}=NAME")
    found, words = {}, {}
    for joint in (*NEEDED, "heel", "toe"):
        for side in SIDES:
            name = names[joint, side]
            if joint == "hip" and centres is not None:
                found.setdefault(joint, {})[side], words[joint, side] = centres[side], "hip centre (Bell 1990)"
            elif name is not None:
                found.setdefault(joint, {})[side], words[joint, side] = markers[name], name
    return found, words


def upwards(found):
    """A unit vector along the axis that the hips are above the ankles."""
    rise = np.nanmean(np.concatenate([found["hip"][side] - found["ankle"][side] for side in SIDES]), axis=0)
    axis = int(np.nanargmax(np.abs(rise)))
    up = np.zeros(3)
    up[axis] = np.sign(rise[axis])
    return up


def smooth(values, count):
    """Mean over `count` samples around each, of those that are there."""
    kernel = np.ones(max(count, 1))
    have = np.isfinite(values).all(axis=1)
    filled = np.where(have[:, None], values, 0.0)
    number = np.convolve(have, kernel, "same")
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.stack([np.convolve(filled[:, i], kernel, "same") / number for i in range(3)], 1)


def forwards(time_s, found, up):
    """(unit vector at each sample, words). A straight walk goes where it went; else where the hips face."""
    middle = 0.5 * (found["hip"]["l"] + found["hip"]["r"])
    level = middle - up * (middle @ up)[:, None]
    have = level[np.isfinite(level).all(axis=1)]
    if len(have) < 2:
        raise Refusal("the hips' markers are never there together")
    leg = np.nanmean(np.linalg.norm(found["hip"]["l"] - found["ankle"]["l"], axis=1))
    went = have[-1] - have[0]
    # The path without the sway of each step: every half second.
    stops = have[::max(1, int(0.5 / np.median(np.diff(time_s))))]
    path = np.linalg.norm(np.diff(stops, axis=0), axis=1).sum()
    facing = np.cross(found["hip"]["l"] - found["hip"]["r"], up)
    facing = facing - up * (facing @ up)[:, None]
    names = "xyz"
    if np.linalg.norm(went) > WENT_LEGS * leg and np.linalg.norm(went) > STRAIGHT * path:
        ahead = unit(went)
        axis = int(np.argmax(np.abs(ahead)))
        words = f"towards {'+-'[int(ahead[axis] < 0)]}{names[axis]}, by its way"
        if np.nanmean(facing @ ahead) < 0:
            words += "; but the hips face the other way: it walks backwards, or left and right are swapped"
        return np.broadcast_to(ahead, level.shape), words
    ahead = smooth(unit(facing), int(1.0 / np.median(np.diff(time_s))))
    with np.errstate(invalid="ignore"):
        return unit(ahead), "where the hips face (a treadmill, or a way with turns)"


def pitch_deg(upper, lower, ahead, up):
    way = lower - upper
    return np.degrees(np.arctan2(np.sum(way * ahead, axis=1), -(way @ up)))


def read(kind, time_s, markers, options):
    """(source with thigh, shank and, with heel and toe, ankle; the places of the feet; the axis that is up)."""
    found, words = joints(markers, options)
    up = upwards(found)
    ahead, direction = forwards(time_s, found, up)
    source = Source(kind, time_s)
    axis = int(np.argmax(np.abs(up)))
    source.notes.append(f"up is {'+-'[int(up[axis] < 0)]}{'xyz'[axis]}; the walk goes {direction}")
    source.taken["time"] = f"{len(time_s)} frames"
    for side in SIDES:
        hip, knee, ankle = (found[joint][side] for joint in NEEDED)
        shank = pitch_deg(knee, ankle, ahead, up)
        source.take(f"thigh_{side}", pitch_deg(hip, knee, ahead, up), f"{words['hip', side]} to {words['knee', side]}")
        source.take(f"shank_{side}", shank, f"{words['knee', side]} to {words['ankle', side]}")
        if all(side in found.get(joint, {}) for joint in ("heel", "toe")):
            foot = found["toe"][side] - found["heel"][side]
            rise = np.degrees(np.arctan2(foot @ up, np.sum(foot * ahead, axis=1)))
            source.take(f"ankle_{side}", (rise - shank + 180.0) % 360.0 - 180.0,
                        f"{words['heel', side]} to {words['toe', side]}, and the shank")
    if "heel" in found and "toe" in found:
        source.notes.append("a sole is flat where its heel and toe markers are level")
    feet = {side: found.get("heel", found["ankle"]).get(side, found["ankle"][side]) for side in SIDES}
    return source, feet, axis
