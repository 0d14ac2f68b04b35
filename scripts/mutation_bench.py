"""Compiles one mutant, links it with the tests that reach it, and runs them until one fails. Part of
scripts/mutation-score."""
import functools
import hashlib
import math
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

from mutation_changes import ROOT, key_of
from mutation_link import LIBS, LINK, PLAIN_BUILD, link_program, with_changed
from mutation_reach import environment, tests_for

# What the EDS files tell, which a Python test reads.
DICTIONARY = re.compile(r"firmware/\w*objects\.[ch]|hal/canopen/co_\w+_objects\.c|hal/bus/frame_table\.h")
# Warnings are none, but for one without which a mutant has no meaning that it keeps.
COMPILE = ["gcc", "-std=c11", "-D_GNU_SOURCE", "-Werror=return-type", "-ffp-contract=off", "-fno-math-errno",
           "-fno-strict-aliasing", "-I.", '-DAFO_VERSION="0"', "-DAFO_BUILD_ID=0u"]
ASAN = ["-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"]
# A build each: its folder, and the options that its objects have in addition.
PLAIN = (PLAIN_BUILD, ["-O2"])
# Only the changed objects are compiled with sanitizers: what a fault reads or writes amiss, it does itself.
CHECKED = (PLAIN_BUILD, ["-O1", "-fno-omit-frame-pointer", *ASAN])
WAIT_S = 900.0  # a test that sleeps for ever; one that computes for ever is ended far earlier


class Bench:
    """A copy of the sources in which one mutant at a time stands."""

    def __init__(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="mutants-"))
        for room in ("model", "controller", "hal", "firmware", "sim_host", "tests"):
            shutil.copytree(ROOT / room, self.root / room)
        self.objects = self.root / "objects"
        self.objects.mkdir()
        self.plain = {}

    def close(self):
        shutil.rmtree(self.root, ignore_errors=True)

    def compile(self, source, precision, options):
        out = self.objects / f"{precision}-{source.replace('/', '+')}.o"
        macro = ["-DREAL_IS_DOUBLE"] if precision == "f64" else []
        done = subprocess.run([*COMPILE, *options, *macro, "-c", source, "-o", str(out)], cwd=self.root, check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=300, start_new_session=True)
        return out if done.returncode == 0 else None

    def original(self, source, precision):
        at = source, precision
        if at not in self.plain:
            out = self.compile(source, precision, PLAIN[1])
            self.plain[at] = hashlib.sha256(out.read_bytes()).hexdigest()
        return self.plain[at]


@functools.cache
def dependencies(build):
    """((source, precision), the files that it includes) of each object of a build."""
    found = []
    for precision in ("f32", "f64"):
        base = build / precision
        for depend in sorted(base.rglob("*.d")):
            source = depend.relative_to(base).with_suffix(".c").as_posix()
            if not source.startswith(("sim_host/programs/", "tests/fuzz/")):
                found.append(((source, precision), frozenset(re.split(r"[\s:\\]+", depend.read_text()))))
    return found


@functools.cache
def units_of(name, build):
    """(source, precision) of what a change of the file compiles anew: of the libraries, and of single tests."""
    units = [unit for unit, includes in dependencies(build)
             if unit[0] == name or (name.endswith(".h") and name in includes)]
    in_tests = {unit for unit in units if re.match(r"tests/(.*/)?test_", unit[0])}
    return [unit for unit in units if unit not in in_tests], in_tests


def object_of(source, precision):
    return f"{precision}/{source[:-2]}.o"


def link(bench, build, test, objects, in_tests, options):
    precision = "f64" if test.endswith("_f64") else "f32"
    own = f"tests/{test}.c", precision
    if own in in_tests:
        made = bench.compile(*own, options)
        if made is None:
            return None
        objects = {**objects, object_of(*own): made}
    out = bench.root / "program"
    return out if link_program(build[0], test, objects, options, out) else None


def fails(bench, program, most_s):
    """How a test program ends with the mutant in it; empty where it passes."""
    scratch = bench.root / "scratch"
    scratch.mkdir(exist_ok=True)
    try:
        done = subprocess.run(["sh", "-c", f"ulimit -c 0; ulimit -t {math.ceil(most_s)}; exec \"$0\"", str(program)], cwd=ROOT,
                              env=environment({"TMPDIR": str(scratch)}), stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, timeout=WAIT_S, check=False,
                              start_new_session=True)
    except subprocess.TimeoutExpired:
        return "time-out"
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
    return "" if done.returncode == 0 else "fails" if done.returncode > 0 else f"signal {-done.returncode}"


def eds_differ(bench, build, objects):
    """Whether the object dictionaries that `afo eds` writes are others than the committed ones, which
    tests/system/test_eds_dbc.py compares."""
    folder = build[0]
    out, written = bench.root / "afo", bench.root / "eds"
    programs = [path.relative_to(folder).as_posix() for path in (folder / "f32/sim_host/programs").glob("*.o")]
    done = subprocess.run([*LINK, *with_changed(folder, programs, objects), *[str(folder / "lib" / lib) for lib in LIBS], "-lm",
                           "-lpthread", "-o", str(out)], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if done.returncode:
        return False
    shutil.rmtree(written, ignore_errors=True)
    written.mkdir()
    done = subprocess.run([str(out), "eds", str(written)], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          timeout=60, cwd=ROOT)
    made = {path.name: path.read_text() for path in written.iterdir()}
    return done.returncode != 0 or made != {path.name: path.read_text() for path in (ROOT / "hal/canopen/eds").iterdir()}


def try_build(bench, build, mutant, reach, kills, slow):
    """(test, how) that kills it, None where none does, "invalid" or "same"."""
    options = build[1]
    units, in_tests = units_of(mutant[0], build[0])
    objects, same = {}, bool(units) and not slow
    for source, precision in units:
        out = bench.compile(source, precision, options)
        if out is None:
            return "invalid"
        same = same and hashlib.sha256(out.read_bytes()).hexdigest() == bench.original_of[source, precision]
        objects[object_of(source, precision)] = out
    if same and not in_tests:
        return "same"
    for test in tests_for(mutant, reach, kills):
        program = link(bench, build, test, objects, in_tests, options)
        if program is None:
            return "invalid"
        how = fails(bench, program, slow * 10 * reach["seconds"][test] + 10 if slow else 10 * reach["seconds"][test] + 5)
        if how:
            return test, how
    if DICTIONARY.match(mutant[0]) and build is PLAIN and eds_differ(bench, build, objects):
        return "the committed EDS files", "differ"
    return None


def judge(bench, mutant, reach, kills):
    name, line, text = mutant
    path = bench.root / name
    original = path.read_text()
    bench.original_of = {unit: bench.original(*unit) for unit in units_of(name, PLAIN[0])[0]}
    lines = original.splitlines(keepends=True)
    lines[line - 1] = text
    start = time.monotonic()
    try:
        path.write_text("".join(lines))
        try:
            result = try_build(bench, PLAIN, mutant, reach, kills, 0)
            if result is None:
                result = try_build(bench, CHECKED, mutant, reach, kills, 6)
                result = (result[0] + " with sanitizers", result[1]) if isinstance(result, tuple) else None
        except subprocess.TimeoutExpired:
            result = "invalid"
    finally:
        path.write_text(original)
    record = {"key": key_of(mutant), "file": name, "line": line, "text": text, "seconds": round(time.monotonic() - start, 1)}
    if isinstance(result, tuple):
        return dict(record, result="killed", by=result[0], how=result[1])
    return dict(record, result=result or "survived")
