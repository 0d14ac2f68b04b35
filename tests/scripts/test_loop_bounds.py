"""Every loop of the embedded code ends, or is endless on purpose (scripts/loop-bounds)."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def loop_bounds(*arguments):
    return subprocess.run([ROOT / "scripts" / "loop-bounds", *map(str, arguments)], capture_output=True, text=True)


def test_every_loop_of_the_tree_is_counted_or_has_a_variant():
    done = loop_bounds()
    assert done.returncode == 0, done.stdout
    count = [int(word) for word in done.stdout.split() if word.isdigit()]
    assert count[0] > 200 and count[0] == sum(count[1:])


@pytest.mark.parametrize("loop", [
    "for (int i = 0; i < 3; i++) { i = 0; }",
    "for (int i = 0; i < n; i++) { n++; }",
    "for (int i = 0; i < s->count; i++) { take(&s->count); }",
    "for (int i = 0; i < n || more; i++) { }",
    "for (int i = 0; i < n; i--) { }",
    "for (int i = 0;; i++) { }",
    "while (busy()) { }",
    "do { } while (busy());",
    "again: goto again;",
])
def test_a_loop_that_may_not_end_is_told(tmp_path, loop):
    source = tmp_path / "loop.c"
    source.write_text(f"void f(int n)\n{{\n    {loop}\n}}\n")
    done = loop_bounds(source)
    assert done.returncode == 1
    assert "loop.c" in done.stdout


@pytest.mark.parametrize("loop", [
    "for (int i = 0; i < 3; i++) { sum += i; }",
    "for (unsigned i = 0; i < n && more; i++) { if (i == n) { take(i); } }",
    "for (int i = 7; i >= 0; i--) { }",
    "do { } while (0);",
    "/* while (true) */ take(\"for (;;)\");",
])
def test_a_counted_loop_passes(tmp_path, loop):
    source = tmp_path / "loop.c"
    source.write_text(f"void f(int n)\n{{\n    {loop}\n}}\n")
    assert loop_bounds(source).returncode == 0
