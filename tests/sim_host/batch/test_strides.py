"""afo-strides: a digest of every bit of many walks, the same for any vectors, threads, compiler and machine."""
import os
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = os.environ.get("BUILD", "build")
PROGRAM = ROOT / BUILD / "afo-strides"
REFERENCE = pathlib.Path(__file__).with_name("reference_strides.csv")
# Of 4,204 strides of 64 walkers at a time, made by build/afo-strides --strides 2000 --walkers 64. It changes with the
# engine's arithmetic, and with nothing else.
DIGEST = "4204 strides, 87 falls, digest ff3d676cff624f7c"


def strides(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=600)


@pytest.mark.parametrize("lanes, threads", [(2, 1), (2, 3), (4, 2), (8, 1), (8, 2), (0, 0)])
def test_no_bit_depends_on_vectors_or_threads(lanes, threads):
    done = strides("--strides", 2000, "--walkers", 64, "--lanes", lanes, "--threads", threads)
    if lanes > 2 and done.returncode == 2:
        return  # this processor has no such vectors; (2, ...) and (0, 0) run anywhere
    assert done.returncode == 0 and DIGEST in done.stdout


@pytest.mark.parametrize("variant", ["clang", "gcc-O1", "gcc-O3", "clang-O1", "clang-O3"])
def test_no_bit_depends_on_the_compiler(variant):
    program = ROOT / "build" / variant / "afo-strides"
    if not program.exists():
        pytest.skip(f"make {variant}-programs builds it")
    done = subprocess.run([program, "--strides", "2000", "--walkers", "64"], capture_output=True, text=True,
                          timeout=600)
    assert DIGEST in done.stdout


def test_bad_options_are_refused():
    assert strides("--lanes", 3).returncode == 2
    assert "not a number" in strides("--strides", "many").stderr
    assert strides("--walkers", 1).returncode == 2


def test_a_soak_compares_digests():
    done = subprocess.run([ROOT / "scripts" / "soak-strides", BUILD, "20000"], cwd=ROOT, capture_output=True, text=True,
                          timeout=600)
    assert done.returncode == 0 and "the same bits, no growth" in done.stdout
    assert len(set(re.findall("digest ([0-9a-f]+)", done.stdout))) == 1


def test_the_bench_tells_what_it_measures():
    bench = ROOT / BUILD / "afo-bench"
    done = subprocess.run([bench, "--help"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and done.stdout.startswith("usage: ") and "REFERENCE.csv" in done.stdout
    assert subprocess.run([bench], capture_output=True, timeout=60).returncode == 1


@pytest.mark.parametrize("peer", ("gsl", "cvode"))
def test_a_peer_of_the_bench_is_built_and_walks_the_same_strides(peer):
    """The strides are known in quadruple precision: a ladder of tolerances that gets below 1e-6 of them integrates the same walker."""
    with subprocess.Popen(["stdbuf", "-oL", ROOT / BUILD / f"afo-bench-{peer}", REFERENCE, "0.001"], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True) as bench:
        errors = []
        for line in bench.stdout:
            errors.append(float(line.split(",")[2]))
            if errors[-1] < 1e-6:
                break
        bench.kill()
        assert errors and errors[-1] < 1e-6, bench.stderr.read()
