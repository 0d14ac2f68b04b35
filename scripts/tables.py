"""Reads the CSV tables that the programs write; what is wrong with one is said in words."""
import csv
import pathlib
import sys

WRONG_INPUT = 2   # exit status: usage, input or output
NO_PICTURES = 3   # exit status: the library that draws is not installed


class TableError(Exception):
    """What is wrong, in words that name the file."""


def read_table(path, numbers=(), text=(), optional=(), may_be_empty=False):
    """The rows of a CSV file as {column: text}.

    numbers and text are columns that must be there; those of numbers hold a number in every row, and an
    empty field only where the column is in optional, too. Raises TableError.
    """
    path = pathlib.Path(path)
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            rows = list(reader)
            columns = reader.fieldnames or []
    except OSError as error:
        raise TableError(f"{path}: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise TableError(f"{path}: not a CSV table of text") from error
    if not columns:
        raise TableError(f"{path}: the file is empty; a CSV table was expected")
    missing = [name for name in (*text, *numbers) if name not in columns]
    if missing:
        raise TableError(f"{path}: no column {', '.join(missing)}; its first line is: {','.join(columns)[:120]}")
    if not rows and not may_be_empty:
        raise TableError(f"{path}: the table has no rows")
    for line, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise TableError(f"{path}, line {line}: not as many fields as the first line has ({len(columns)})")
        for name in numbers:
            if not is_number(row[name]) and not (row[name] == "" and name in optional):
                raise TableError(f"{path}, line {line}: {name} is '{row[name]}'; a number was expected")
    return rows


def is_number(value):
    try:
        float(value)
    except ValueError:
        return False
    return True


def complain(program, words, status=WRONG_INPUT):
    print(f"{program}: {words}", file=sys.stderr)
    return status


def run(program, main, *arguments):
    """The exit status of main(*arguments), which is 0 where it returns None; errors become words and 2."""
    try:
        return main(*arguments) or 0
    except TableError as error:
        return complain(program, error)
    except OSError as error:
        return complain(program, f"{error.filename}: {error.strerror}")
    except KeyboardInterrupt:
        print(f"{program}: broken off; what was there before stays", file=sys.stderr)
        return 130


# The columns of `afo study laws STUDY`, by study: (numbers, text).
_JUMPS = (("from_rad_s", "to_rad_s", "fell", "settled", "steps"), ("law",))
_GROUND = (("speed_rad_s", "size_mm", "steps", "falls"), ("law", "kind"))
_WALKS = (("speed_rad_s", "fell", "speed_share"), ("law", "case"))
LAWS_COLUMNS = {
    "jumps": _JUMPS,
    "jumps-chain": _JUMPS,
    "basin": (("speed_rad_s", "samples", "reached"), ("law",)),
    "ground": _GROUND,
    "ground-chain": _GROUND,
    "push-chain": (("speed_rad_s", "phase", "share_of_m_sqrt_gl"), ("law", "direction")),
    "sensitivity": (("speed_rad_s", "step_time_s_per_leg"), ("law",)),
    "slope": _WALKS,
    "mismatch": _WALKS,
    "energy": (("energy_J_per_m", *_WALKS[0]), _WALKS[1]),
    "timing": (("speed_rad_s", "release_s", "cost_of_transport", "eigenvalue"), ()),
}


def read_laws(folder, study, more_numbers=(), may_be_empty=False):
    """The rows of one study of the laws, from the folder given to `afo study laws ... --out`."""
    numbers, text = LAWS_COLUMNS[study]
    return read_table(pathlib.Path(folder) / f"laws-{study}.csv", (*numbers, *more_numbers), text,
                      may_be_empty=may_be_empty)
