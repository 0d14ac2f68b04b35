"""What the documents promise is there: commands, options, paths, links, pictures; and README stays readable."""
import functools
import os
import pathlib
import re
import subprocess

import pytest

from documents import (CODE, LINK, PICTURE, ROOT, anchors, blocks, commands, documents, read, sentences, tables,
                       words_alone)

BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()
README = read("README.md")
DOCUMENTS = documents()
# Front door and rooms for everybody; the rooms of the trade may say more at once.
SHORT_SENTENCES = ("README.md", "sim_host/README.md", "tests/README.md", ".github/GLOSSARY.md", ".github/CHANGELOG.md")
each_document = pytest.mark.parametrize("document", DOCUMENTS, ids=str)


def test_ci_calls_the_test_command_of_the_readme():
    assert re.search(r"^    make test\b", README, re.MULTILINE)
    assert re.search(r"^make test\b", (ROOT / ".ci" / "run").read_text(encoding="utf-8"), re.MULTILINE)


def test_the_readme_is_short():
    assert len(README.splitlines()) <= 150


def test_the_readme_has_one_table_of_ten_rows():
    found = tables(README)
    assert len(found) == 1 and found[0] <= 10


def test_each_door_has_ten_lines_at_most():
    doors = {"I study gait", "I build a device", "I fit it to a person", "I change the code"}
    parts = re.split(r"^## ", README, flags=re.MULTILINE)
    found = {part.splitlines()[0]: [line for line in part.splitlines()[1:] if line.strip()] for part in parts}
    assert doors <= set(found)
    for door in doors:
        assert 1 <= len(found[door]) <= 10, door


def test_safety_is_said_in_five_sentences():
    part = README[README.index("## Safety"):]
    part = part[:part.index("\n## ")]
    assert len(list(sentences(part.split("\n", 1)[1]))) == 5
    assert "hold the foot up in swing" in part


@each_document
def test_no_sentence_is_too_long(document):
    limit = 25 if str(document) in SHORT_SENTENCES else 45
    long = [f"{words} words: {sentence}" for sentence, words in sentences(read(document)) if words > limit]
    assert not long, "\n".join(long)


def test_a_long_sentence_is_found():
    found = dict(sentences("One two three.\nFour `a b c` five\n- six\n\n    code is no sentence\n"))
    assert found == {"One two three.": 3, "Four CODE five": 3, "six": 1}


def test_no_number_in_the_readme_stands_without_its_command():
    """But the paper's own data, and names such as NUCLEO-G474RE."""
    for block in blocks(README):
        prose = re.sub(r"\S*[A-Za-z/_.]\S*", "", words_alone(block))
        if re.search(r"\d", prose) and not block.startswith(("Journal:", "DOI:")):
            assert CODE.search(block), block


@each_document
def test_every_make_target_exists(document):
    targets = {match for piece in commands(read(document)) for match in re.findall(r"(?:^|\s)make ([a-z][a-z0-9-]*)", piece)}
    if document == pathlib.Path("README.md"):
        assert {"run", "test"} <= targets
    for target in sorted(targets):
        done = subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, f"make {target}: {done.stderr}"


@functools.lru_cache(maxsize=None)
def help_of(*command):
    try:
        done = subprocess.run([*command, "--help"], cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=60)
    except FileNotFoundError:
        return None
    return done.stdout if done.returncode == 0 else None


def check_options(piece, text):
    for option in re.findall(r"(?<=\s)--[a-zA-Z][a-zA-Z0-9-]*", piece):
        assert re.search(rf"{option}(?![\w-])", text), f"`{piece}`: its help has no {option}"


@each_document
def test_every_command_of_afo_exists(document):
    """`build/afo NAME --option`: the command has a help, and the help has the option."""
    for piece in commands(read(document)):
        for call in re.findall(r"build/afo(?: [^;&|)]*)?", piece):
            names = re.match(r"build/afo((?: [a-z][a-z0-9-]*){0,2})", call)[1].split()
            if names[:1] == ["study"]:
                text = help_of(BUILD / "afo", *names) or ""
                text += help_of(BUILD / "afo", "study") or ""
            elif names[:1] == ["help"]:
                text = help_of(BUILD / "afo", *names[1:])
            else:
                text = help_of(BUILD / "afo", *names[:1])
            assert text, f"`{call}`: no such command"
            check_options(call, text)


@each_document
def test_every_script_and_its_options_exist(document):
    for piece in commands(read(document)):
        call = re.match(r"(?:\w+=\S+ )*(scripts/[\w-]+)([^;&|>]*)", piece)
        if call:
            assert os.access(ROOT / call[1], os.X_OK), piece
            options = call[2].split(" -- ")[0]
            if "--" in options:
                check_options(options, help_of(ROOT / call[1]) or "")


@each_document
def test_every_path_exists(document):
    text = re.sub(r"\bbuild/\S+", "", read(document))
    for path in set(re.findall(r"(?<![\w./-])((?:scripts|tests|model|controller|hal|firmware|sim_host)/[\w./-]*\w)", text)):
        # NAME stands for any; a name without its ending stands for the .c and the .h.
        path = path.replace("NAME", "*")
        assert list(ROOT.glob(path)) or list(ROOT.glob(path + ".*")), f"{document}: {path}"


@each_document
def test_every_link_and_picture_leads_somewhere(document):
    text = read(document)
    for target in LINK.findall(text) + PICTURE.findall(text):
        if target.startswith("https://"):
            continue
        path, _, anchor = target.partition("#")
        place = (ROOT / document.parent / path).resolve() if path else ROOT / document
        assert place.is_relative_to(ROOT), f"{target} lies outside the tree"
        assert place.exists(), target
        if anchor:
            assert anchor in anchors(place.read_text(encoding="utf-8")), target


@each_document
def test_nothing_outside_the_tree_is_named(document):
    for piece in re.findall(r"(?<![\w.])(?:/(?:home|work|tmp|root|mnt)/\S*|(?:\.\./){1,}shared\S*)", read(document)):
        pytest.fail(f"{piece} lies outside the tree")


def test_the_change_log_begins_with_this_version():
    base = re.search(r"^VERSION_BASE := (\S+)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)[1]
    assert re.search(r"^## (\S+)$", read(".github/CHANGELOG.md"), re.MULTILINE)[1] == base


def test_the_glossary_has_thirty_terms():
    terms = re.findall(r"^- \*\*([^*]+)\*\*", read(".github/GLOSSARY.md"), re.MULTILINE)
    assert len(terms) >= 30 and len(set(terms)) == len(terms)
    for term in ("Step", "Stride", "Stance", "Apex", "Push-off", "Heel strike", "Toe-off"):
        assert term in terms


@pytest.mark.parametrize("script", sorted(p.name for p in (ROOT / "scripts").iterdir()
                                          if p.is_file() and not p.suffix))
def test_scripts_can_be_run_and_say_what_they_are_for(script):
    path = ROOT / "scripts" / script
    assert path.stat().st_mode & 0o111, "not executable"
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("#!")
    assert re.match(r'# \w|"""\w', lines[1]), "the second line says what it is for"


def test_every_misra_deviation_has_a_reason():
    rows = [line for line in (ROOT / "scripts" / "misra-deviations.txt").read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#")]
    assert rows
    for row in rows:
        rule, place, reason = (field.strip() for field in row.split("|", 2))
        assert re.fullmatch(r"\d+\.\d+", rule) and place
        assert re.match(r"\((A|R)\) .{20}", reason), row
