"""Whether signs, units and sides can be a person's walk; what does not fit is said in words, with the option that mends it.

Facts of walking that any textbook has (Perry and Burnfield, Gait Analysis, 2010): the knee bends by some 60 degrees
and hardly the other way, which thighs and shanks of other signs, or of two legs, do not; at heel strike the leg is in
front, at toe-off behind; a foot is down for some 60 % of a stride.
"""
import numpy as np

from walk_source import SIDES, leg_pitch_deg

KNEE_BACK_DEG, KNEE_BENT_DEG = -15.0, 25.0
SWEEP_LEAST_DEG, SWEEP_MOST_DEG = 12.0, 110.0
UPRIGHT_WITHIN_DEG = 20.0
STANCE_SHARE = (0.4, 0.85)


def knee_back_deg(knee):
    """How far the knee goes the wrong way (negative), or NaN where it does not bend at all."""
    low, high = np.percentile(knee, (1, 99))
    return float(low) if high > KNEE_BENT_DEG else float("nan")


def bends(knee):
    return knee_back_deg(knee) > KNEE_BACK_DEG


def signs(columns):
    """The one change of signs with which a knee bends as a knee does."""
    for side in SIDES:
        thigh, shank = columns[f"thigh_{side}"], columns[f"shank_{side}"]
        if bends(thigh - shank):
            continue
        fits = [words for words, turned in (("shank", thigh + shank), ("thigh", -thigh - shank), ("both", shank - thigh))
                if bends(turned)]
        if fits == ["both"]:
            yield (f"the {SIDES[side]} knee bends backwards: the signs of thigh and shank are reversed, or the walk goes the "
                   f"other way (--reverse thigh_{side} --reverse shank_{side})")
        elif len(fits) == 1:
            yield f"the {SIDES[side]} {fits[0]}'s sign is reversed (--reverse {fits[0]}_{side})"
        else:
            yield (f"the {SIDES[side]} knee goes from {np.min(thigh - shank):.0f} to {np.max(thigh - shank):.0f} degrees, which "
                   "is no knee of a walk: look at the columns of thigh and shank")


def leads(ahead, contact_l, contact_r):
    """Mean of left less right when the left foot comes down, and right less left for the right one."""
    values = [ahead[i] for i in strikes(contact_l)] + [-ahead[i] for i in strikes(contact_r)]
    return float(np.mean(values)) if values else 0.0


def strikes(contact):
    return np.flatnonzero((contact[1:] > 0) & (contact[:-1] == 0)) + 1


def offs(contact):
    return np.flatnonzero((contact[1:] == 0) & (contact[:-1] > 0)) + 1


def sides(columns):
    """Thigh and shank of two legs, where only those of different legs make knees; else contacts of the other foot."""
    crossed = (not all(bends(columns[f"thigh_{side}"] - columns[f"shank_{side}"]) for side in SIDES) and
               all(bends(columns[f"thigh_{a}"] - columns[f"shank_{b}"]) for a, b in ("lr", "rl")))
    contacts = [columns.get(f"contact_{side}") for side in SIDES]
    if any(contact is None for contact in contacts):
        if crossed:
            yield "thigh and shank of a leg do not go together: left and right of one of them look swapped (--swap thigh)"
        return
    lead = {part: leads(columns[f"{part}_l"] - columns[f"{part}_r"], *contacts) for part in ("thigh", "shank")}
    if crossed:
        part = min(lead, key=lead.get)
        yield f"left and right {part} look swapped (--swap {part})"
    elif lead["thigh"] < 0 and lead["shank"] < 0:
        yield ("each foot comes down when its leg is behind: left and right contact look swapped (--swap contact), or "
               "contact is 0 on the ground")


def units(columns):
    for side in SIDES:
        pitch = leg_pitch_deg(columns, side)
        sweep = np.ptp(pitch)
        if sweep < SWEEP_LEAST_DEG:
            yield (f"the {SIDES[side]} leg sweeps {sweep:.2g} degrees, less than in any walk: does the person "
                   "stand, or are these angles in radians? (--angles rad)")
        elif sweep > SWEEP_MOST_DEG:
            yield f"the {SIDES[side]} leg sweeps {sweep:.0f} degrees, more than any walk: angles in another unit? (--angles deg)"
        elif abs(np.mean(pitch)) > UPRIGHT_WITHIN_DEG:
            yield (f"the {SIDES[side]} leg points {abs(np.mean(pitch)):.0f} degrees {'ahead' if np.mean(pitch) > 0 else 'back'} on "
                   "average: are pitches measured from the vertical?")


def contact_shares(columns):
    for side in SIDES:
        contact = columns.get(f"contact_{side}")
        if contact is None:
            continue
        at, end = strikes(contact), offs(contact)
        if len(at) < 3 or len(end) < 3:
            continue
        share = np.mean(contact[at[0]:at[-1]])
        if not STANCE_SHARE[0] <= share <= STANCE_SHARE[1]:
            yield (f"the {SIDES[side]} foot is down for {100 * share:.0f} % of the time between its strikes, and some 60 % are "
                   "usual in walking: is contact 1 on the ground, and the threshold right? (--contact-over VALUE)")


def findings(columns):
    """Everything that does not look like a walk, a sentence each; the first kind that is wrong hides what follows of it."""
    found = [*units(columns)]
    if not found:
        wrong = [*sides(columns)]
        of_contacts = all("contact" in text for text in wrong)
        found = ([*signs(columns)] or wrong) if of_contacts else wrong
    return found + [*contact_shares(columns)]
