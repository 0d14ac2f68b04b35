"""Small faults ("mutants") in controller/, firmware/ and hal/ without the ports: one line changed in each, by
universalmutator, and those that tests/equivalent-mutants.txt lists as equivalent. Part of scripts/mutation-score."""
import contextlib
import functools
import hashlib
import io
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path += map(str, ROOT.glob("build/venv/lib/python3*/site-packages"))
EQUIVALENT = ROOT / "tests" / "equivalent-mutants.txt"
RULES = ["universal.rules", "c_like.rules", "c.rules"]
# The rooms of which 99 % must be killed; of all others 95 %.
HELD = re.compile(r"controller/(supervisor|screening|actuation)/|hal/devices/(sea_|node_setup|setup_steps)")


def files():
    found = []
    for room, pattern in (("controller", "**/*.[ch]"), ("firmware", "*.[ch]"), ("hal", "*.h"), ("hal", "*/*.[ch]")):
        for path in (ROOT / room).glob(pattern):
            name = path.relative_to(ROOT).as_posix()
            if "hal/port_" not in name and (name.endswith(".c") or "static inline" in path.read_text()):
                found.append(name)
    return sorted(found)


def without_comments(text):
    """The text with comments blanked: the tool leaves out lines that have one."""
    def blank(match):
        found = match.group(0)
        return found if found[0] in "\"'" else re.sub(r"[^\n]", " ", found)
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', blank, text, flags=re.S)


def mutants_of(name, reached):
    """(file, line, new text) of a file; of a header only where it holds code."""
    from universalmutator import mutator
    lines = [line.rstrip() + "\n" for line in without_comments((ROOT / name).read_text()).splitlines()]
    with contextlib.redirect_stdout(io.StringIO()):
        found = mutator.mutants_regexp(lines, RULES, ignorePatterns=[r"^\s*#", r"static_assert"])
    return [(name, line, text) for line, text, *_ in found
            if text.strip() != lines[line - 1].strip() and (name.endswith(".c") or str(line) in reached.get(name, {}))]


@functools.cache
def key_of(mutant):
    name, line, text = mutant
    before = (ROOT / name).read_text().splitlines()
    near = "\n".join(before[max(0, line - 4):line + 3])
    return hashlib.sha256(f"{name}\0{near}\0{text}".encode()).hexdigest()[:16]


def squeezed(text):
    return re.sub(r"\s+", " ", text).strip()


def listed_equivalents():
    """(file, line, the line changed) of the table; a brace's line is told by the line that follows it, too."""
    rows = {}
    for row in EQUIVALENT.read_text().splitlines() if EQUIVALENT.exists() else []:
        if row.strip() and not row.startswith("#"):
            name, old, new, why = (part.strip() for part in row.split(" ¦ "))
            rows[name, squeezed(old), squeezed(new)] = why
    return rows


@functools.cache
def row_of(mutant):
    name, line, text = mutant
    lines = without_comments((ROOT / name).read_text()).splitlines()
    old = squeezed(lines[line - 1])
    if old in ("}", "{", "} else {"):
        old += " before " + next((squeezed(after) for after in lines[line:] if after.strip()), "the end")
    return name, old, squeezed(text)
