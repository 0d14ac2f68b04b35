"""Missing samples: short gaps are filled and longer ones cut, and both are said."""
import numpy as np

from walk_source import ANKLES, CONTACTS, PITCHES, SIDES, Refusal

JUMP = 1.5  # a step of time beyond so many usual ones is a gap


def with_missing_rows(source, longest_s):
    """The same with empty rows where samples are missing for no longer than longest_s."""
    step = float(np.median(np.diff(source.time_s)))
    times = [source.time_s[:1]]
    kept = [0]
    for before, after in zip(source.time_s, source.time_s[1:]):
        gap = after - before
        more = int(round(gap / step)) - 1 if JUMP * step < gap <= longest_s + step else 0
        times += [before + gap * np.arange(1, more + 1) / (more + 1), [after]]
        kept.append(kept[-1] + more + 1)
    time_s = np.concatenate(times)
    for role, values in source.columns.items():
        wide = np.full(len(time_s), np.nan)
        wide[kept] = values
        source.columns[role] = wide
    source.time_s = time_s
    return step


def runs(flags):
    """(first, last + 1) of each run of true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    return list(zip(edges[::2], edges[1::2]))


def fill(values, time_s, longest_s):
    """Straight lines over the gaps within the values that last no longer. Returns (filled gaps, their longest, s)."""
    count, most = 0, 0.0
    for first, end in runs(np.isnan(values)):
        if first == 0 or end == len(values):
            continue
        lasted = time_s[end] - time_s[first - 1]
        if lasted <= longest_s + 1e-9:
            values[first:end] = np.interp(time_s[first:end], [time_s[first - 1], time_s[end]],
                                          [values[first - 1], values[end]])
            count, most = count + 1, max(most, lasted)
    return count, most


def hold_contact(values):
    """A contact goes on through a gap; where its ends differ it changes in the gap's middle. Returns how many do."""
    changed = 0
    for first, end in runs(np.isnan(values)):
        if first == 0:
            values[:end] = values[end] if end < len(values) else 0.0
        elif end == len(values) or values[first - 1] == values[end]:
            values[first:end] = values[first - 1]
        else:
            middle = (first + end) // 2
            values[first:middle], values[middle:end] = values[first - 1], values[end]
            changed += 1
    return changed


def treat(source, longest_s, part):
    """Fills and cuts. part: which piece, from 1, or None for the longest. Returns lines that say what was done."""
    step = with_missing_rows(source, longest_s)
    said, filled = [], []
    for role in (*PITCHES, *ANKLES):
        if role in source.columns:
            values = source.columns[role]
            # A turn beyond 180 degrees is none of the leg's.
            have = np.isfinite(values)
            values[have] = np.degrees(np.unwrap(np.radians(values[have])))
            filled.append((role, *fill(values, source.time_s, longest_s)))
    if any(count for _, count, _ in filled):
        said.append("filled: " + ", ".join(f"{count} of {role}" for role, count, _ in filled if count) +
                    f"; the longest was {max(most for *_, most in filled):.3f} s")
    whole = np.all([np.isfinite(values) for role, values in source.columns.items() if role not in CONTACTS], axis=0)
    broken = np.concatenate([[False], np.diff(source.time_s) > JUMP * step])
    pieces = []
    for first, end in runs(whole):
        cuts = [first, *(i for i in range(first + 1, end) if broken[i]), end]
        pieces += [(a, b) for a, b in zip(cuts, cuts[1:]) if b - a > 1]
    if not pieces:
        raise Refusal(f"no two samples in a row have all of {', '.join(source.columns)}, with gaps of {longest_s:g} s "
                      "filled: --longest-gap S fills longer ones")
    if part is not None and not 1 <= part <= len(pieces):
        raise Refusal(f"--part {part}: the gaps leave {len(pieces)} parts")
    first, end = pieces[part - 1] if part is not None else max(pieces, key=lambda piece: piece[1] - piece[0])
    if len(pieces) > 1 or end - first < len(source.time_s):
        told = ", ".join(f"{source.time_s[a]:.2f} to {source.time_s[b - 1]:.2f} s" for a, b in pieces[:8])
        kept = pieces.index((first, end)) + 1
        said.append(f"cut: gaps over {longest_s:g} s leave {told}; kept is part {kept}" +
                    (" (--part N for another)" if len(pieces) > 1 else ""))
    source.time_s = source.time_s[first:end]
    for role in source.columns:
        source.columns[role] = source.columns[role][first:end]
    for side in SIDES:
        role = f"contact_{side}"
        if role in source.columns:
            if np.isnan(source.columns[role]).all():
                raise Refusal(f"{role} has no value in the part that is kept")
            changed = hold_contact(source.columns[role])
            if changed:
                said.append(f"{role} changes inside {changed} gaps: in their middle, it is not known when")
    return said
