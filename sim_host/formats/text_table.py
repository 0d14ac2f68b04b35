"""A table of numbers in a text file: any separator, a point or a comma as decimal sign, a header line somewhere above."""
import collections
import csv
import dataclasses
import re

import numpy as np

from walk_source import Refusal

SEPARATORS = (";", "\t", ",", "|", None)  # None: blanks
SEPARATOR_WORDS = {";": "semicolons", "\t": "tabs", ",": "commas", "|": "bars", None: "blanks"}
NOTHING = {"", "nan", "na", "n/a", "null", "none", "-", "--", "#n/a"}
NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)([eE][+-]?\d+)?$")
LOOKED_AT = 60


@dataclasses.dataclass
class Table:
    """names: of the columns; units: what a line below them says; rows: fields as text; lines: their line numbers."""
    names: list
    units: list
    rows: list
    lines: list
    separator: str
    decimal_comma: bool

    def values(self, name):
        """A column as numbers; NaN where a field is empty. Refuses a field that is no number."""
        place = self.names.index(name)
        out = np.empty(len(self.rows))
        for i, row in enumerate(self.rows):
            text = row[place].strip()
            try:
                out[i] = np.nan if text.lower() in NOTHING else float(text.replace(",", ".") if self.decimal_comma else text)
            except ValueError:
                raise Refusal(f"line {self.lines[i]}, column \"{name}\": \"{text[:40]}\" is not a number; "
                              "an empty field says that there is none") from None
        return out

    def words(self):
        comma = ", decimal commas" if self.decimal_comma else ""
        return f"text between {SEPARATOR_WORDS[self.separator]}{comma}, {len(self.names)} columns"


def decoded(path):
    try:
        data = open(path, "rb").read()
    except OSError as error:
        raise Refusal(error.strerror) from error
    for encoding in ("utf-16",) if data[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "latin-1"):
        try:
            text = data.decode(encoding)
            break
        except UnicodeDecodeError:
            continue
    if "\0" in text:
        raise Refusal("a zero byte: this is not a text file")
    return text


def split(lines, separator):
    if separator is None:
        return [line.split() for line in lines]
    return [[field.strip() for field in row] for row in csv.reader(lines, delimiter=separator)]


def is_number(text):
    return bool(NUMBER.match(text))


def numeric_rows(rows, columns):
    """How many rows have that many fields, at least one number, and nothing but numbers and empty fields."""
    return sum(len(row) == columns and any(map(is_number, row)) and
               all(is_number(field) or field.lower() in NOTHING for field in row) for row in rows)


def choose_separator(lines):
    """The one by which most lines become rows of numbers of one length; of equals the first of SEPARATORS."""
    best, most = None, (0, 0)
    sample = lines[:LOOKED_AT] + lines[-LOOKED_AT:]
    for separator in SEPARATORS:
        rows = split(sample, separator)
        counts = collections.Counter(len(row) for row in rows if len(row) > 1)
        for columns, _ in counts.most_common(3):
            score = (numeric_rows(rows, columns), -SEPARATORS.index(separator))
            if score > most:
                best, most = (separator, columns), score
    if best is None:
        raise Refusal("no lines of numbers with a separator between them: this is no table in a text file")
    return best


def read(text):
    """Reads a table: a header of names, perhaps a line of units, rows of numbers. Refuses in words."""
    numbered = [(i + 1, line) for i, line in enumerate(text.splitlines()) if line.strip() and line.lstrip()[0] not in "#%"]
    if not numbered:
        raise Refusal("the file is empty")
    separator, columns = choose_separator([line for _, line in numbered])
    rows = split([line for _, line in numbered], separator)
    first = next(i for i, row in enumerate(rows) if numeric_rows([row], columns))
    header = next((i for i in range(first) if len(rows[i]) == columns), None)
    if header is None:
        raise Refusal(f"line {numbered[first][0]} has numbers, and no line of {columns} names is above it: write "
                      "the columns' names there")
    for i in range(first, len(rows)):
        if len(rows[i]) != columns:
            raise Refusal(f"line {numbered[i][0]}: {len(rows[i])} fields where the header has {columns}")
    names = rows[header]
    doubled = [name for name, count in collections.Counter(names).items() if count > 1 and name]
    if doubled:
        raise Refusal(f"column \"{doubled[0]}\" is there twice")
    data = rows[first:]
    comma = separator != "," and any("," in field for row in data[:LOOKED_AT] for field in row)
    return Table(names, rows[first - 1] if first - 1 > header else [""] * columns, data,
                 [number for number, _ in numbered[first:]], separator, comma)
