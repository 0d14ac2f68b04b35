""".ci/run ends with the counts, whatever happened, and its exit status is the tests'."""
import os
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def run_ci(tmp_path, make_body):
    """.ci/run in an empty tree, with a make that only says what it is told to."""
    (tmp_path / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", tmp_path / ".ci")
    (tmp_path / "bin").mkdir()
    make = tmp_path / "bin" / "make"
    make.write_text(f'#!/bin/sh\necho "called with $*, CI=$CI"\n{make_body}\n')
    make.chmod(0o755)
    environment = {key: value for key, value in os.environ.items() if key != "CI"}
    environment["PATH"] = f"{make.parent}:{environment['PATH']}"
    done = subprocess.run([tmp_path / ".ci" / "run"], env=environment, capture_output=True, text=True, timeout=60)
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
