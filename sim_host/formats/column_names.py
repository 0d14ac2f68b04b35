"""Which column of a table is which role, by the words in its name."""
import re

from walk_source import Refusal, listed, nearest

SIDE_WORDS = {"l": "l", "left": "l", "lt": "l", "li": "l", "links": "l", "gauche": "l",
              "r": "r", "right": "r", "rt": "r", "re": "r", "rechts": "r", "droite": "r"}
PART_WORDS = {
    "thigh": ("thigh", "femur", "upperleg", "oberschenkel", "cuisse"),
    "shank": ("shank", "tibia", "lowerleg", "calf", "unterschenkel", "jambe"),
    "ankle": ("ankle", "dorsiflexion", "sprunggelenk", "cheville"),
    "hip": ("hip", "huefte", "hüfte", "hanche"),
    "knee": ("knee", "knie", "genou"),
    "pelvis": ("pelvis", "becken", "bassin"),
    "contact": ("contact", "stance", "footswitch", "fsr", "grf", "vgrf", "force", "kontakt", "bodenkontakt", "kraft"),
    "time": ("time", "times", "timestamp", "zeit", "temps", "t", "ms", "seconds", "frame", "sample"),
}
PART_OF = {word: part for part, words in PART_WORDS.items() for word in words}
# Words that say that a column is something else than an angle or a contact.
OTHER = {"velocity", "velo", "vel", "rate", "speed", "gyro", "gyr", "acc", "accel", "acceleration", "moment", "torque",
         "power", "tx", "ty", "tz", "beta", "fx", "vx", "vz", "px", "py", "pz", "adduction", "abduction", "rotation", "list", "ml", "ap", "cop"}


def words_in(name):
    name = re.sub(r"([a-z])([A-Z])", r"\1 \2", name)
    return [word for word in re.split(r"[^0-9a-zäöüéA-Z]+", name) if word]


def meaning(name):
    """(part, side) of a column's name, None where it tells none: ("thigh", "l") for "LeftThigh [deg]"."""
    parts, sides = set(), set()
    for word in (word.lower() for word in words_in(name)):
        if word in OTHER:
            return None, None
        if word in SIDE_WORDS:
            sides.add(SIDE_WORDS[word])
        elif word in PART_OF:
            parts.add(PART_OF[word])
        elif word[:1] in "lr" and word[1:] in PART_OF:
            sides.add(word[0])
            parts.add(PART_OF[word[1:]])
        elif word[-1:] in "lr" and word[:-1] in PART_OF:
            sides.add(word[-1])
            parts.add(PART_OF[word[:-1]])
    part = parts.pop() if len(parts) == 1 else None
    return part, sides.pop() if len(sides) == 1 else None


def assign(names, chosen, roles):
    """role -> name. chosen: what the user named (an empty name: there is none). Refuses a doubt, in words."""
    unknown = [role for role in chosen if role not in roles]
    if unknown:
        raise Refusal(f"--column: there is no role \"{unknown[0]}\"; the roles are {listed(roles)}")
    found = {}
    for role in roles:
        if role in chosen:
            if chosen[role] and chosen[role] not in names:
                raise Refusal(missing(f"--column {role}={chosen[role]}: no such column", [chosen[role]], names))
            found[role] = chosen[role] or None
            continue
        part, side = (role[:-2], role[-1]) if role[-2:] in ("_l", "_r") else (role, None)
        own = [name for name in names if name.lower() in (role, f"{role}_deg", f"{role}_s", f"{role}_rad", f"{role}_ms")]
        all_such = own[:1] or [name for name in names if meaning(name) == (part, side)]
        if len(all_such) > 1:
            raise Refusal(f"{len(all_such)} columns could be {role}: {listed(all_such)}; choose one with "
                          f"--column \"{role}={all_such[0]}\", or --column {role}= for none")
        found[role] = all_such[0] if all_such else None
    return found


def missing(what, wanted, names):
    """A complaint about something that is not there: what is there, and what looks like it."""
    close = nearest(wanted, names)
    return f"{what}; found are {listed(names)}" + (f"; the nearest: {listed(close)}" if close else "")
