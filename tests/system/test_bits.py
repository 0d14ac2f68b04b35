"""The same seed gives the same log, byte for byte, whoever compiled the program."""
import pytest

from afo import AFO, ROOT, run

VARIANTS = ["gcc-O1", "gcc-O3", "clang", "clang-O1", "clang-O3", "asan"]
STEPS = 25


@pytest.fixture(scope="module", params=["ideal", "17bit"])
def expected(request, tmp_path_factory):
    return request.param, log_of(AFO, request.param, tmp_path_factory.mktemp("log") / "gcc-O2.log")


def log_of(program, sensors, path):
    done = run("--speed", "0.5", "--steps", STEPS, "--sensors", sensors, "--seed", 20, "--quiet",
               "--log", path, program=program)
    assert done.returncode in (0, 1), done.stderr
    log = path.read_bytes()
    assert len(log) > 1000000
    return log


@pytest.mark.parametrize("variant", VARIANTS)
def test_same_log(expected, variant, tmp_path):
    sensors, log = expected
    program = ROOT / "build" / variant / "afo"
    assert program.exists(), f"build it with: make {variant}-programs"
    other = log_of(program, sensors, tmp_path / "other.log")
    if other != log:
        for number, (a, b) in enumerate(zip(log.splitlines(), other.splitlines()), 1):
            assert a == b, f"the logs part at line {number}"
    assert other == log
