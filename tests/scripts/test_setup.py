"""scripts/setup is quick when all is there and says what to do when it cannot install."""
import os
import pathlib
import shutil
import subprocess
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture
def poor_machine(tmp_path):
    """A PATH on which nothing is installed, nobody is root and sudo says no."""
    for name, body in {
        "dpkg-query": "exit 1", "apt-get": "echo must not be called >&2; exit 99", "sudo": "exit 1",
        "id": "echo 1000",
    }.items():
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{body}\n")
        path.chmod(0o755)
    return dict(os.environ, PATH=f"{tmp_path}:{os.environ['PATH']}")


def setup(*targets, environment=None):
    return subprocess.run([ROOT / "scripts" / "setup", *targets], env=environment, capture_output=True, text=True,
                          timeout=600)


def test_quick_and_silent_when_nothing_is_missing():
    assert setup("test").returncode == 0  # what runs this test was set up by it
    start = time.monotonic()
    done = setup("test")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert time.monotonic() - start < 10  # a fraction of a second on an idle machine


def test_without_root_the_tests_say_what_to_install(poor_machine):
    done = setup("test", environment=poor_machine)
    assert done.returncode == 1
    assert "must not be called" not in done.stderr
    assert "you are not root" in done.stdout
    line = next(line for line in done.stdout.splitlines() if "install by hand" in line)
    for package in ("gcc", "clang", "check", "python3-pytest", "gcc-arm-none-eabi", "qemu-system-arm"):
        assert package in line


def test_without_root_the_walk_goes_on_without_pictures(poor_machine):
    done = setup("run", environment=poor_machine)
    assert done.returncode == 0
    assert "goes on without" in done.stdout and "python3-matplotlib" in done.stdout


@pytest.mark.parametrize("words,reason", [
    ("Err:1 http://deb.debian.org bookworm InRelease\n  Temporary failure resolving 'deb.debian.org'", "is there a network?"),
    ("E: You don't have enough free space in /var/cache/apt/archives/.", "enough free space"),
])
def test_what_apt_get_could_not_do_is_said(poor_machine, tmp_path, words, reason):
    (tmp_path / "id").write_text("#!/bin/sh\necho 0\n")
    (tmp_path / "words").write_text(words + "\n")
    (tmp_path / "apt-get").write_text(f"#!/bin/sh\ncat {tmp_path}/words >&2\nexit 100\n")
    done = setup("lint", environment=poor_machine)
    assert done.returncode == 1
    assert next(line for line in done.stdout.splitlines() if "not installed" in line).endswith(
        reason if reason[-1] == "?" else "archives/.") and reason in done.stdout


def system_without_apt(folder, *tools):
    for tool in ("bash", "dirname", "sed", "awk", "tr", "id", "mkdir", "grep", "tail", "env", *tools):
        (folder / tool).symlink_to(shutil.which(tool))
    return dict(os.environ, PATH=str(folder))


def test_without_apt_the_walk_needs_compiler_and_make_alone(tmp_path):
    done = setup("run", environment=system_without_apt(tmp_path, "gcc", "make"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "no apt-get" in done.stdout and "python3-matplotlib" in done.stdout


def test_without_apt_and_compiler_it_says_so(tmp_path):
    done = setup("run", environment=system_without_apt(tmp_path, "make"))
    assert done.returncode == 1
    assert "missing: gcc" in done.stdout and "missing: make" not in done.stdout


def test_unknown_target():
    done = setup("everything")
    assert done.returncode == 2
    assert "everything" in done.stdout
