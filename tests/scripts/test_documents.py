"""What the documents promise is there: the two commands, the scripts, the reasons."""
import pathlib
import re
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_ci_calls_the_test_command_of_the_readme():
    assert re.search(r"^    make test\b", README, re.MULTILINE)
    assert re.search(r"^make test\b", (ROOT / ".ci" / "run").read_text(encoding="utf-8"), re.MULTILINE)


def test_every_make_target_in_the_readme_exists():
    targets = set(re.findall(r"`make ([a-z][a-zA-Z0-9-]*)", README)) | set(
        re.findall(r"^    make ([a-z-]+)", README, re.MULTILINE))
    assert {"run", "test"} <= targets
    for target in sorted(targets):
        done = subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, f"make {target}: {done.stderr}"


def test_every_path_in_the_readme_exists():
    for path in set(re.findall(r"\b((?:scripts|tests|model|controller|hal|firmware|sim_host)/[\w./-]*\w)", README)):
        assert (ROOT / path).exists(), path


def test_every_picture_in_the_readme_exists():
    for path in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README):
        assert (ROOT / path).is_file(), path


@pytest.mark.parametrize("script", sorted(p.name for p in (ROOT / "scripts").iterdir()
                                          if p.is_file() and not p.suffix))
def test_scripts_can_be_run_and_say_what_they_are_for(script):
    path = ROOT / "scripts" / script
    assert path.stat().st_mode & 0o111, "not executable"
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("#!")
    assert re.match(r'# \w|"""\w', lines[1]), "the second line says what it is for"


def test_every_misra_deviation_has_a_reason():
    rows = [line for line in (ROOT / "scripts" / "misra-deviations.txt").read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#")]
    assert rows
    for row in rows:
        rule, place, reason = (field.strip() for field in row.split("|", 2))
        assert re.fullmatch(r"\d+\.\d+", rule) and place
        assert re.match(r"\((A|R)\) .{20}", reason), row
