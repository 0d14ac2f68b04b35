"""scripts/bench: which builds it times."""
import importlib.machinery
import importlib.util
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]


def load():
    loader = importlib.machinery.SourceFileLoader("bench", str(ROOT / "scripts" / "bench"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("bench", loader))
    loader.exec_module(module)
    return module


def test_the_python_package_and_the_sanitizers_are_no_builds_to_time(tmp_path):
    for name in ("gcc-O3", "asan"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "afo").touch()
    (tmp_path / "python" / "afo").mkdir(parents=True)
    assert load().programs_of(tmp_path, tmp_path) == {".": tmp_path / "afo", "gcc-O3": tmp_path / "gcc-O3" / "afo"}
