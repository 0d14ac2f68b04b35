"""Reads the Markdown documents of the tree: sentences, links, commands, tables."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)")
PICTURE = re.compile(r"!\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`]+)`")
BULLET = re.compile(r"\s*(?:[-*]|\d+\.)\s+")


def documents():
    rooms = sorted(path.relative_to(ROOT) for path in ROOT.glob("*/README.md"))
    return [pathlib.Path("README.md"), *rooms, *sorted(path.relative_to(ROOT) for path in ROOT.glob(".github/*.md"))]


def read(path):
    return (ROOT / path).read_text(encoding="utf-8")


def split_code(text):
    """(lines outside code blocks, lines inside)."""
    outside, inside, fenced, before = [], [], False, ""
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
            outside.append("")
        elif fenced or (line.startswith("    ") and (not before.strip() or before.startswith("    "))):
            inside.append(line)
            outside.append("")
            before = line
            continue
        else:
            outside.append(line)
        before = line
    return outside, inside


def blocks(text):
    """What is read as one piece: a paragraph, an item of a list, a heading, a cell of a table."""
    pieces, current = [], []

    def end():
        if current:
            pieces.append(" ".join(current))
            current.clear()
    for line in split_code(text)[0]:
        if line.startswith("|"):
            end()
            pieces += [cell.strip() for cell in line.strip().strip("|").split("|") if not set(cell) <= set(" :-")]
        elif not line.strip() or line.startswith("#"):
            end()
            if line.startswith("#"):
                pieces.append(line.lstrip("# "))
        else:
            if BULLET.match(line):
                end()
                line = BULLET.sub("", line, count=1)
            current.append(line.strip())
    end()
    return pieces


def words_alone(block):
    """The block without what is no prose: pictures, targets of links; a command or name in code is one word."""
    block = PICTURE.sub("", block)
    block = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", block)
    return CODE.sub("CODE", block)


def sentences(text):
    for block in blocks(text):
        for sentence in re.split(r"(?<=[.!?])[*)\"]*\s+", words_alone(block)):
            yield sentence, sum(any(c.isalnum() for c in word) for word in sentence.split())


def tables(text):
    """[number of rows below the heading] of every table."""
    found, rows = [], 0
    for line in [*text.splitlines(), ""]:
        if line.startswith("|"):
            rows += 1
        elif rows:
            found.append(rows - 2)
            rows = 0
    return found


def commands(text):
    """Every piece of code of a document: what stands between backticks, and lines of code blocks without their comments."""
    outside, inside = split_code(text)
    pieces = [piece for line in outside for piece in CODE.findall(line)]
    return pieces + [re.sub(r"(^|\s)#\s.*", "", line).strip() for line in inside]


def anchors(text):
    """The names under which a link reaches the headings."""
    names = set()
    for line in split_code(text)[0]:
        if line.startswith("#"):
            heading = CODE.sub(r"\1", line.lstrip("# ").strip()).lower()
            names.add(re.sub(r"[^\w\- ]", "", heading).replace(" ", "-"))
    return names
