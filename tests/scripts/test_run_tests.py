"""scripts/run-tests counts single cases and lets no failure, crash, hang or skip pass.

It is run on small trees of its own: a copy of the script beside tests made up here.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

CHECK_PROGRAM = """
#include <check.h>
#include <stdlib.h>
#include <unistd.h>
START_TEST(test_good) {{ ck_assert(1); }} END_TEST
START_TEST(test_other) {{ {body} }} END_TEST
int main(void)
{{
    Suite *suite = suite_create("s");
    TCase *tcase = tcase_create("c");
    tcase_add_test(tcase, test_good);
    tcase_add_test(tcase, test_other);
    suite_add_tcase(suite, tcase);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    {end}
    return failed ? 1 : 0;
}}
"""


@pytest.fixture
def tree(tmp_path):
    (tmp_path / "scripts").mkdir()
    (tmp_path / "tests" / "room").mkdir(parents=True)
    shutil.copy(ROOT / "scripts" / "run-tests", tmp_path / "scripts")
    shutil.copy(ROOT / "tests" / "pytest.ini", tmp_path / "tests")
    return tmp_path


def add_check(tree, name, body, end=""):
    source = tree / "tests" / "room" / f"{name}.c"
    source.write_text(CHECK_PROGRAM.format(body=body, end=end))
    program = tree / "build" / "tests" / "room" / name
    program.parent.mkdir(parents=True, exist_ok=True)
    libraries = subprocess.check_output(["pkg-config", "--libs", "check"], text=True).split()
    subprocess.run(["gcc", "-w", source, *libraries, "-o", program], check=True)


def add_file(tree, name, text):
    path = tree / "tests" / "room" / name
    path.write_text(text)
    path.chmod(0o755)


def run(tree, *arguments, ci=False):
    environment = {key: value for key, value in os.environ.items() if key != "CI"}
    if ci:
        environment["CI"] = "true"
    done = subprocess.run([tree / "scripts" / "run-tests", *arguments], env=environment,
                          capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout, (done.stdout.splitlines() or [""])[-1]


def test_single_cases_are_counted(tree):
    add_check(tree, "test_a", "ck_assert(1);")
    add_file(tree, "test_b.py", "def test_x():\n    pass\n\ndef test_y():\n    pass\n")
    add_file(tree, "test_c.sh", "#!/bin/sh\nexit 0\n")
    status, _, last = run(tree, "--build", tree / "build", "--python", "--scripts")
    assert (status, last) == (0, "5 passed, 0 failed")


@pytest.mark.parametrize("body,end", [
    ("ck_assert_int_eq(1, 2);", ""),     # an assertion
    ("abort();", ""),                    # a crash inside a case
    ("ck_assert(1);", "return 3;"),      # all cases fine, the program says no
    ("ck_assert(1);", "abort();"),       # a crash after the last case
])
def test_a_bad_check_program_fails(tree, body, end):
    add_check(tree, "test_a", body, end)
    status, output, last = run(tree, "--build", tree / "build")
    assert status == 1
    assert last.endswith(", 1 failed")
    assert "FAILED   build/tests/room/test_a" in output


def test_a_hanging_program_is_ended_and_fails(tree):
    add_check(tree, "test_a", "ck_assert(1);", "sleep(60);")
    status, output, last = run(tree, "--build", tree / "build", "--limit", "2")
    assert (status, last) == (1, "2 passed, 1 failed")
    assert "did not end within 2 s" in output


def test_a_program_that_was_not_built_is_noticed(tree):
    add_check(tree, "test_a", "ck_assert(1);")
    (tree / "tests" / "room" / "test_forgotten.c").write_text("int main(void) { return 0; }\n")
    status, _, _ = run(tree, "--build", tree / "build")
    assert status != 0


def test_a_program_without_its_source_is_not_run(tree):
    add_check(tree, "test_a", "ck_assert(1);")
    add_check(tree, "test_old", "ck_assert(0);")
    (tree / "tests" / "room" / "test_old.c").unlink()
    status, _, last = run(tree, "--build", tree / "build")
    assert (status, last) == (0, "2 passed, 0 failed")


@pytest.mark.parametrize("text,failed", [
    ("def test_x():\n    assert 1 == 2\n", 1),
    ("import absent_module\n", 1),
    ("def test_x(:\n", 1),
    ("import os\ndef test_x():\n    os._exit(0)\n", 1),
])
def test_a_bad_python_test_fails(tree, text, failed):
    add_file(tree, "test_b.py", text)
    status, _, last = run(tree, "--python")
    assert (status, last) == (1, f"0 passed, {failed} failed")


def test_a_skip_is_counted_and_fails_in_ci(tree):
    add_file(tree, "test_b.py", "import pytest\ndef test_x():\n    pytest.skip('no bus')\n"
                                "def test_y():\n    pass\n")
    add_file(tree, "test_c.sh", "#!/bin/sh\nexit 77\n")
    status, output, last = run(tree, "--python", "--scripts")
    assert (status, last) == (0, "1 passed, 0 failed, 2 skipped")
    assert "no bus" in output
    status, _, last = run(tree, "--python", "--scripts", ci=True)
    assert (status, last) == (1, "1 passed, 2 failed")


def test_long_tests_run_only_when_asked_for(tree):
    add_file(tree, "test_b.py", "import pytest\n@pytest.mark.long\ndef test_x():\n    pass\n"
                                "def test_y():\n    pass\ndef test_z():\n    pass\n")
    assert run(tree, "--python")[2] == "2 passed, 0 failed"
    assert run(tree, "--python", "--long")[2] == "1 passed, 0 failed"


def test_no_test_at_all_is_no_success(tree):
    status, _, last = run(tree, "--python")
    assert (status, last) == (1, "0 passed, 0 failed")


SLOW = """
import os
import pathlib
import subprocess
import time


def test_quick():
    pass


def test_slow():
    # A child in a session of its own is out of reach of a signal to the test's group.
    child = subprocess.Popen(["sleep", "600"], start_new_session=True)
    place = pathlib.Path(__file__).parents[2] / f"started-{os.getpid()}"
    place.write_text(f"{os.getpid()} {child.pid}")
    time.sleep(600)
"""


def alive(pid):
    """Whether the process runs; one that ended and waits for its parent does not."""
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


def started(tree):
    return [int(word) for path in tree.glob("started-*") for word in path.read_text().split()]


def interrupt(tree, command, number):
    """Starts command on a tree of one quick and three slow files, sends the signal to its whole
    process group as a terminal does, and returns (status, output, seconds until it ended)."""
    add_file(tree, "test_a.py", "def test_x():\n    pass\n")
    for name in ("test_b.py", "test_c.py", "test_d.py"):
        add_file(tree, name, SLOW)
    with open(tree / "output", "w+", encoding="utf-8") as output:
        process = subprocess.Popen(command, cwd=tree, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            limit = time.monotonic() + 60
            while len(started(tree)) < 4 or "test_a.py" not in (tree / "output").read_text():
                assert time.monotonic() < limit and process.poll() is None, (tree / "output").read_text()
                time.sleep(0.05)
            begin = time.monotonic()
            os.killpg(process.pid, number)
            status = process.wait(timeout=30)
            seconds = time.monotonic() - begin
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            for pid in started(tree):
                if alive(pid):
                    left.append(pid)
                    os.kill(pid, signal.SIGKILL)
        output.seek(0)
        return status, output.read(), seconds


left = []  # processes that outlived an interrupted run


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_stops_at_once(tree, number):
    left.clear()
    status, output, seconds = interrupt(tree, [tree / "scripts" / "run-tests", "--python", "--jobs", "2"], number)
    assert seconds < 2.0
    assert not left, "a test's process outlived the run"
    assert len(started(tree)) == 4, "a new test was started after the signal"
    assert status == 128 + number
    last = output.splitlines()[-1]
    assert last.startswith("1 passed, 0 failed, interrupted: 3 of 4 files did not end"), output
    assert "Traceback" not in output


def test_make_obeys_an_interrupt_too(tree):
    (tree / "Makefile").write_text("test:\n\t@scripts/run-tests --python --jobs 2\n")
    left.clear()
    status, output, seconds = interrupt(tree, ["make", "test"], signal.SIGINT)
    assert seconds < 2.0 and status != 0 and not left
    assert "1 passed, 0 failed, interrupted" in output


def test_progress_and_length_are_told(tree):
    for name in ("test_b.py", "test_c.py"):
        add_file(tree, name, "def test_x():\n    pass\n")
    _, output, _ = run(tree, "--python", "--jobs", "1")
    assert output.splitlines()[0].startswith("2 files, 1 at a time")
    assert "[1/2]" in output and "[2/2]" in output
    _, output, _ = run(tree, "--python", "--jobs", "1")
    assert "last time" in output.splitlines()[0]
    assert "[2/2]" in (tree / "build" / "run-tests.log").read_text()
