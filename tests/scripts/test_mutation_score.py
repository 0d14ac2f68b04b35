"""The mutation score (scripts/mutation-score): its interval, its sample, and its table of equivalents."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def score():
    """The script, with the names of the files that it is made of."""
    loader = importlib.machinery.SourceFileLoader("mutation_score", str(ROOT / "scripts" / "mutation-score"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("mutation_score", loader))
    loader.exec_module(module)
    for part in ("mutation_changes", "mutation_reach"):
        for name, value in vars(importlib.import_module(part)).items():
            module.__dict__.setdefault(name, value)
    return module


@pytest.mark.parametrize("killed, total, low, high", [
    # R: prop.test(x, n, correct = FALSE), that is Wilson's interval
    (95, 100, 88.825, 97.846), (100, 100, 96.301, 100.0), (0, 10, 0.0, 27.753), (190, 200, 91.042, 97.261)])
def test_the_interval_is_wilsons(score, killed, total, low, high):
    assert score.wilson(killed, total) == pytest.approx((low, high), abs=2e-3)


def test_comments_are_blanked_and_nothing_else(score):
    text = 'a = 1; /* b\nc */ d("/* no */"); // e\n'
    blanked = score.without_comments(text)
    assert blanked == 'a = 1;     \n     d("/* no */");     \n'


def test_the_sample_depends_on_the_seed_alone(score):
    mutants = [("hal/storage/crc.c", 18, f"text {i}\n") for i in range(200)]
    first, again, other = (score.Sample(mutants, 50, seed).order for seed in (1, 1, 2))
    assert first == again and first != other and sorted(first) == sorted(other)


def test_left_out_mutants_are_replaced_by_others(score):
    mutants = [("hal/storage/crc.c", 18, f"text {i}\n") for i in range(40)]
    sample = score.Sample(mutants, 10, 1)
    results = {}
    for i, mutant in enumerate(sample.order):
        key = score.key_of(mutant)
        results[key] = {"key": key, "result": ("invalid", "same", "killed", "survived")[i % 4]}
    counted, left_out, missing = sample.counted(results)
    assert len(counted) == 10 and not missing
    assert left_out["invalid"] == 5 and left_out["same"] == 5


def test_what_is_behind_a_mutant_not_tried_does_not_count(score):
    mutants = [("hal/storage/crc.c", 18, f"text {i}\n") for i in range(40)]
    sample = score.Sample(mutants, 30, 1)
    results = {score.key_of(m): {"result": "killed"} for i, m in enumerate(sample.order) if i != 5}
    counted, _, missing = sample.counted(results)
    assert len(counted) == 5 and missing == [sample.order[5]]


def test_the_likeliest_test_for_its_time_comes_first(score):
    tests = ["hal/test_far", "hal/storage/test_crc", "sim_host/faults/test_slow", "sim_host/faults/test_quick"]
    reach = {"seconds": {"hal/test_far": 0.1, "hal/storage/test_crc": 0.1, "sim_host/faults/test_slow": 60.0,
                         "sim_host/faults/test_quick": 0.1}}
    name = "hal/storage/crc.c"
    assert score.likeliest_first(name, tests, reach, {}) == [tests[i] for i in (1, 0, 3, 2)]
    assert score.likeliest_first(name, tests, reach, {(name, tests[3]): 8}) == [tests[i] for i in (3, 1, 0, 2)]


def test_strata_are_tried_in_turn(score):
    held, other = (score.Sample([("hal/storage/crc.c", line, "text\n") for line in range(first, first + count)], count, 1)
                   for first, count in ((1, 10), (20, 20)))
    order = score.in_turn((("held", held, 99), ("other", other, 95)), {})
    assert sorted(order) == sorted(held.order + other.order)
    assert sum(m in held.order for m in order[:15]) == 5


def test_each_equivalent_fits_a_line_of_the_code(score):
    rows = score.listed_equivalents()
    assert rows
    for (name, old, new), why in rows.items():
        lines = {score.squeezed(line) for line in score.without_comments((ROOT / name).read_text()).splitlines()}
        assert set(old.split(" before ")) <= lines, f"{name}: {old}"
        assert new != old and len(why) > 20


def test_without_a_build_it_says_what_to_do(tmp_path):
    (tmp_path / "scripts").mkdir()
    for script in (ROOT / "scripts").glob("mutation*"):
        (tmp_path / "scripts" / script.name).write_text(script.read_text())
    (tmp_path / "scripts" / "mutation-score").chmod(0o755)
    done = subprocess.run([tmp_path / "scripts" / "mutation-score"], capture_output=True, text=True)
    assert done.returncode == 2 and "make mutants" in done.stderr
