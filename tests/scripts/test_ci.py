""".ci/run ends with the counts, whatever happened, and its exit status is the tests'."""
import os
import pathlib
import shutil
import signal
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def prepare(tmp_path, make_body):
    """(.ci/run in an empty tree, environment with a make that only says what it is told to)."""
    tree = tmp_path / "tree"
    (tree / ".ci").mkdir(parents=True)
    shutil.copy(ROOT / ".ci" / "run", tree / ".ci")
    (tmp_path / "bin").mkdir()
    make = tmp_path / "bin" / "make"
    make.write_text(f'#!/bin/sh\necho "called with $*, CI=$CI"\n{make_body}\n')
    make.chmod(0o755)
    environment = {key: value for key, value in os.environ.items() if key not in ("CI", "AFO_DATA")}
    environment["PATH"] = f"{make.parent}:{environment['PATH']}"
    return tree / ".ci" / "run", environment


def run_ci(tmp_path, make_body, **more):
    script, environment = prepare(tmp_path, make_body)
    done = subprocess.run([script], env={**environment, **more}, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout.splitlines()


@pytest.mark.parametrize("make_body,status,last", [
    ("echo '7 passed, 0 failed'", 0, "7 passed, 0 failed"),
    # What make itself says behind the counts does not hide them.
    ("echo '6 passed, 1 failed'; echo 'make: *** Error 1' >&2; exit 2", 2, "6 passed, 1 failed"),
    ("echo 'error: expected ;' >&2; exit 2", 2, "0 passed, 1 failed"),
    # No count is no success.
    ("true", 1, "0 passed, 1 failed"),
])
def test_last_line_and_status(tmp_path, make_body, status, last):
    returncode, lines = run_ci(tmp_path, make_body)
    assert lines[0] == "called with test, CI=true"
    assert (returncode, lines[-1]) == (status, last)


DATA = 'echo "data: ${AFO_DATA-none}"; echo "1 passed, 0 failed"'


def test_recordings_beside_the_tree_are_used(tmp_path):
    (tmp_path / "shared" / "data").mkdir(parents=True)
    assert f"data: {tmp_path / 'shared' / 'data'}" in run_ci(tmp_path, DATA)[1]


def test_without_recordings_afo_data_stays_unset(tmp_path):
    assert "data: none" in run_ci(tmp_path, DATA)[1]


def test_a_folder_that_is_named_counts_more_than_the_neighbour(tmp_path):
    (tmp_path / "shared" / "data").mkdir(parents=True)
    assert "data: /elsewhere" in run_ci(tmp_path, DATA, AFO_DATA="/elsewhere")[1]


def test_no_other_place_knows_where_the_recordings_are():
    """The tree names no path outside itself, but in .ci/run."""
    found = subprocess.run(["git", "grep", "-lE", r"shared/data|AFO_GAIT_CSV", "--", ".", ":!.ci/run",
                            ":!tests/scripts/test_ci.py", ":!.github/CHANGELOG.md"], cwd=ROOT, capture_output=True, text=True)
    assert found.stdout == ""


def test_an_interrupt_leaves_the_counts_as_the_last_line(tmp_path):
    script, environment = prepare(
        tmp_path, "trap 'echo 3 passed, 0 failed, interrupted; exit 130' INT; echo started; while :; do sleep 0.1; done")
    process = subprocess.Popen([script], env=environment, stdout=subprocess.PIPE, text=True, start_new_session=True)
    try:
        while process.stdout.readline() != "started\n":
            assert process.poll() is None
        os.killpg(process.pid, signal.SIGINT)
        lines = process.communicate(timeout=10)[0].splitlines()
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    assert process.returncode == 130
    assert lines[-1].startswith("3 passed, 0 failed")
