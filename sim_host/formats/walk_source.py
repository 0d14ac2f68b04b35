"""What every reader of a file gives: times, angles and contacts, and from where each was taken.

Roles: thigh_l, thigh_r, shank_l, shank_r (segment pitch from the vertical, distal end forward positive),
ankle_l, ankle_r (dorsiflexion positive), contact_l, contact_r (1: the foot is on the ground). Angles in degrees.
"""
import dataclasses
import difflib

SIDES = {"l": "left", "r": "right"}
PITCHES = ("thigh_l", "thigh_r", "shank_l", "shank_r")
ANKLES = ("ankle_l", "ankle_r")
CONTACTS = ("contact_l", "contact_r")
ROLES = ("time", *PITCHES, *ANKLES, *CONTACTS)


class Refusal(Exception):
    """What is wrong with a file, or missing, in words for the user, with what to do next."""


@dataclasses.dataclass
class Source:
    """A walk as it was read. time_s ascends; columns: role -> values, NaN where the file has none."""
    kind: str
    time_s: object  # a numpy array, as the columns are
    columns: dict = dataclasses.field(default_factory=dict)
    taken: dict = dataclasses.field(default_factory=dict)  # role -> from where, in words
    notes: list = dataclasses.field(default_factory=list)  # what was assumed

    def take(self, role, values, words):
        import numpy  # here: a machine without it is to be told so in words
        self.columns[role] = numpy.asarray(values, dtype=float)
        self.taken[role] = words


def side_of(role):
    return role[-1]


def leg_pitch_deg(columns, side):
    """Pitch of the virtual leg from hip to ankle, thigh and shank equally long, degrees."""
    return 0.5 * (columns[f"thigh_{side}"] + columns[f"shank_{side}"])


def nearest(wanted, names, most=3):
    """The names that look most like one of the wanted ones; lower case counts as upper."""
    folded = {}
    for name in names:
        folded.setdefault(name.lower(), name)
    found = {}
    for one in wanted:
        for match in difflib.get_close_matches(one.lower(), list(folded), n=most, cutoff=0.5):
            ratio = difflib.SequenceMatcher(None, one.lower(), match).ratio()
            found[folded[match]] = max(ratio, found.get(folded[match], 0.0))
    return sorted(found, key=lambda name: -found[name])[:most]


def listed(names, most=30):
    names = [str(name) for name in names]
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more if names else "none"
