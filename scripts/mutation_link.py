"""Links a test with changed objects in the place of its own, as the Makefile links it. Part of scripts/mutation-score."""
import functools
import re
import shutil
import subprocess

from mutation_changes import ROOT

OUT = ROOT / "build" / "mutants"
PLAIN_BUILD = OUT / "plain"
LINK = ["gcc", "-s", *(["-fuse-ld=gold"] if shutil.which("ld.gold") else [])]  # in half the time
LIBS = ["libsim.a", "libfirmware.a", "libhal.a", "libcontroller_f32.a", "libcontroller_f64.a", "libmodel_f32.a",
        "libmodel_f64.a"]
CHECK = ["-lcheck", "-lsubunit", "-lrt", "-lm", "-lpthread"]


@functools.cache
def links():
    """{test: (its objects, as f32/PATH.o, and its options)}, by what the Makefile would do."""
    at = PLAIN_BUILD.relative_to(ROOT)
    done = subprocess.run(["make", "-n", "-B", "V=1", "CC=gcc", "CFLAGS=-g0", f"BUILD={at}", "tests"], cwd=ROOT, text=True,
                          capture_output=True, check=True)
    found = {}
    for line in done.stdout.splitlines():
        out = re.search(rf" -o {at}/tests/(\S+)$", line)
        if out:
            found[out.group(1)] = (re.findall(rf"{at}/(f\d\d/\S+\.o)", line), re.findall(r"-Wl,--wrap\S+", line))
    return found


@functools.cache
def apart():
    """Objects that are in no library: a test has them by name, or not at all."""
    return {name for objects, _ in links().values() for name in objects}


def with_changed(build, named, changed):
    """The objects of a program: those *named*, and the *changed* ones ({f32/PATH.o: object}) in their place or in
    that of a library's."""
    own = [str(changed.get(name, build / name)) for name in named]
    return own + [str(path) for name, path in changed.items() if name not in apart()]


def link_program(build, test, changed, options, out):
    """Links a test with changed objects ({f32/PATH.o: object}). Returns whether it could."""
    named, wraps = links()[test]
    done = subprocess.run([*LINK, *[o for o in options if "sanitize" in o], *wraps, *with_changed(build, named, changed),
                           *[str(build / "lib" / lib) for lib in LIBS], *CHECK, "-o", str(out)], check=False,
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    return done.returncode == 0
