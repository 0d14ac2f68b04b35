"""The same seed gives the same log, byte for byte, whoever compiled the program."""
import pytest

from afo import AFO, ROOT, run

VARIANTS = ["gcc-O1", "gcc-O3", "clang", "clang-O1", "clang-O3", "asan"]
WALKER = ("--speed", "0.5", "--steps", 25)
PERSON = ("--plant", "reflex", "--person", "sim_host/persons/adult70.ini", "--device", "sim_host/devices/virtual-adult.ini",
          "--steps", 10)
WALKS = {"ideal": (*WALKER, "--sensors", "ideal"), "17bit": (*WALKER, "--sensors", "17bit"), "reflex person": PERSON,
         "noisy reflex person": ("--plant", "reflex", "--person", "sim_host/persons/reflex-new.ini", *PERSON[4:])}


@pytest.fixture(scope="module", params=WALKS)
def expected(request, tmp_path_factory):
    return WALKS[request.param], log_of(AFO, WALKS[request.param], tmp_path_factory.mktemp("log") / "gcc-O2.log")


def log_of(program, walk, path):
    done = run(*walk, "--seed", 20, "--quiet", "--log", path, program=program)
    assert done.returncode in (0, 1), done.stderr
    log = path.read_bytes()
    assert len(log) > 1000000
    return log


@pytest.mark.parametrize("variant", VARIANTS)
def test_same_log(expected, variant, tmp_path):
    walk, log = expected
    program = ROOT / "build" / variant / "afo"
    assert program.exists(), f"build it with: make {variant}-programs"
    other = log_of(program, walk, tmp_path / "other.log")
    if other != log:
        for number, (a, b) in enumerate(zip(log.splitlines(), other.splitlines()), 1):
            assert a == b, f"the logs part at line {number}"
    assert other == log
