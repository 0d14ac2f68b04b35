"""No input makes controller and decoders fail (scripts/prove), and a fault in the code is noticed."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def prove(*arguments, timeout):
    return subprocess.run([ROOT / "scripts" / "prove", *arguments], capture_output=True, text=True, timeout=timeout)


def table(output):
    """Columns of the table by the proof's name."""
    return {line.split()[0]: line.split() for line in output.splitlines() if "% " in line}


def test_the_quick_proofs_raise_no_alarm():
    done = prove("--quick", timeout=1500)
    assert done.returncode == 0, done.stdout
    rows = table(done.stdout)
    assert "equation_16" in rows and len(rows) >= 10
    for name, row in rows.items():
        assert int(row[1]) > 8 and int(row[5].rstrip("%")) >= 85, row  # functions, share of statements
        assert row[-2] == "0", name


@pytest.mark.long
def test_every_proof_raises_no_alarm():
    done = prove(timeout=7200)
    assert done.returncode == 0, done.stdout
    assert "any_law" in table(done.stdout)


@pytest.mark.long
def test_each_injected_fault_is_noticed():
    done = prove("--mutants", timeout=14400)
    assert done.returncode == 0, done.stdout
    assert int(done.stdout.splitlines()[-1].split()[0]) >= 20


def test_an_unknown_proof_is_refused():
    done = prove("no_such", timeout=60)
    assert done.returncode == 2
    assert "no_such" in done.stderr and "--list" in done.stderr
