"""Which C test reaches which line, by gcov, and in what order the tests try a mutant: the likeliest for their time
first. Part of scripts/mutation-score."""
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import tempfile

from mutation_changes import ROOT, files
from mutation_link import OUT, PLAIN_BUILD, link_program

REACH = OUT / "reach.json"
COVERAGE = ROOT / "build" / "coverage"
MOST_S = 10.0  # processor time of all tests of one mutant
# Kills that a test of the file itself, of its room, of its top folder, or of another one is credited at the start.
CREDIT = (4.0, 1.0, 0.25, 0.1)
START_S = 0.2  # to link and start a test


def tests():
    base = PLAIN_BUILD / "tests"
    return sorted(path.relative_to(base).as_posix() for path in base.rglob("test_*") if path.is_file())


def environment(extra=None):
    return dict(os.environ, CK_DEFAULT_TIMEOUT="0", CK_TIMEOUT_MULTIPLIER="1000", **(extra or {}))


def lines_reached(test):
    """{file: {line: reached}} of one test, by gcov."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([COVERAGE / "tests" / test], cwd=ROOT, env=environment({"GCOV_PREFIX": folder}), check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        top = pathlib.Path(folder + str(COVERAGE))
        data = [path for path in top.rglob("*.gcda") if re.search(r"/(controller|firmware|hal|tests)/", str(path.relative_to(top)))]
        for path in data:
            (path.with_suffix(".gcno")).symlink_to(COVERAGE / path.relative_to(top).with_suffix(".gcno"))
        done = subprocess.run(["gcov", "--json-format", "--stdout", *map(str, data)], cwd=folder, text=True,
                              capture_output=True, check=False)
    found = collections.defaultdict(dict)
    for text in done.stdout.splitlines():
        for entry in json.loads(text)["files"] if text.startswith("{") else ():
            name = os.path.relpath(entry["file"], ROOT) if entry["file"].startswith("/") else entry["file"]
            for line in entry["lines"]:
                number = line["line_number"]
                found[name][number] = found[name].get(number, False) or line["count"] > 0
    return found


def seconds_of(test):
    """Processor time of a test, linked as it is for a mutant. One that cannot be, or fails, would tell nothing."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "program"
        if not link_program(PLAIN_BUILD, test, {}, [], out):
            raise SystemExit(f"mutation-score: {test} cannot be linked without any mutant")
        with subprocess.Popen([out], cwd=ROOT, env=environment(), stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, start_new_session=True) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"mutation-score: {test} fails without any mutant")
    return round(usage.ru_utime + usage.ru_stime, 3)


def measured(test):
    """(test, what it reaches, its processor time). A far test that takes longer than all of a mutant may is never tried:
    what it reaches is not measured."""
    seconds = seconds_of(test)
    tried = seconds <= MOST_S or test.split("/")[0] in ("controller", "firmware", "hal")
    return test, lines_reached(test) if tried else {}, seconds


def measure_reach(jobs):
    """Makes the map of tests and lines; of new or changed tests only, where a map is there."""
    known = json.loads(REACH.read_text()) if REACH.exists() else {"lines": {}, "seconds": {}, "made": {}}
    wanted = set(files())
    made = {test: hashlib.sha256((ROOT / "tests" / f"{test}.c").read_bytes()).hexdigest() for test in tests()}
    new = [test for test in made if known["made"].get(test) != made[test]]
    for lines in known["lines"].values():
        for line, names in lines.items():
            lines[line] = [test for test in names if test not in new]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        running = [pool.submit(measured, test) for test in new]
        for done in concurrent.futures.as_completed(running):
            test, found, seconds = done.result()
            print(f"{seconds:>7.1f} s of processor time: {test}", flush=True)
            for name in wanted & set(found):
                rows = known["lines"].setdefault(name, {})
                for line, reached in found[name].items():
                    rows.setdefault(str(line), []).extend([test] * reached)
            known["seconds"][test] = seconds
            known["made"][test] = made[test]
            part = REACH.with_suffix(".part")
            part.write_text(json.dumps(known))
            part.replace(REACH)
    return known


def distance(name, test):
    stem = pathlib.Path(name).stem
    if pathlib.Path(test).name.startswith(f"test_{stem}"):
        return 0
    words = {word for word in stem.split("_") if len(word) > 4}
    if pathlib.Path(test).parent == pathlib.Path(name).parent or words & set(pathlib.Path(test).name.split("_")):
        return 1
    return 2 if test.split("/")[0] == name.split("/")[0] else 3


def likeliest_first(name, chosen, reach, kills):
    """The order in which tests try a mutant of this file: by kills in it so far (kills: {(file, test): how many})
    for the time that the test takes."""
    def rate(test):
        credit = CREDIT[distance(name, test)]
        return (kills.get((name, test), 0) + credit) / (reach["seconds"][test] + START_S)
    return sorted(chosen, key=lambda test: (-rate(test), test))


def tests_for(mutant, reach, kills, most_s=MOST_S):
    """The tests that reach the line, the likeliest first. A line without code of its own (a brace, a table's row, a
    second line of a statement) counts with the code around it, else with the file. Far tests that take more than
    most_s together are left out: their mutants count as survivors."""
    name, line, _ = mutant
    rows = reach["lines"].get(name, {})
    near = [names for number, names in rows.items() if abs(int(number) - line) <= 6]
    if str(line) in rows:
        chosen = set(rows[str(line)])
    else:
        chosen = set().union(*(near or rows.values()))
    if not chosen and not rows:  # a file of tables only: what reaches its neighbours
        chosen = {test for other, lines in reach["lines"].items() if pathlib.Path(other).parent == pathlib.Path(name).parent
                  for names in lines.values() for test in names}
        chosen |= {test for test in reach["seconds"] if distance(name, test) < 2}
    taken, spent = [], 0.0
    for test in sorted(chosen, key=lambda test: (distance(name, test) > 0, reach["seconds"][test])):
        spent += reach["seconds"][test]
        if spent <= most_s or distance(name, test) < 2:
            taken.append(test)
    return likeliest_first(name, taken, reach, kills)
