"""The wheel: pip makes it from the clone, it runs elsewhere, and it says what it lacks."""
import ast
import inspect
import os
import re
import shutil
import subprocess
import sys

import numpy

from package_tree import BUILD, ROOT

ROOM = ROOT / "sim_host/python"


def compiler():
    """What this build was made with: another one would build all anew."""
    return re.search(r"\d+\.\d+\.\d+ (.+?) -std=", (BUILD / "stamp/flags").read_text(encoding="utf-8"))[1]


def pip(*arguments, **environment):
    clean = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MAKEFLAGS", "CC")}
    return subprocess.run([sys.executable, "-m", "pip", "--disable-pip-version-check", *map(str, arguments)], cwd=ROOT,
                          env={**clean, "AFO_BUILD": str(BUILD), **environment}, capture_output=True, text=True, check=False)


def test_pip_installs_it_from_a_clone(tmp_path):
    done = pip("install", "--quiet", "--no-deps", "--no-index", "--target", tmp_path, ROOM, CC=compiler())
    assert done.returncode == 0, done.stdout + done.stderr
    code = ("import afo\nprint(afo.__file__, afo.__version__, round(afo.Walker().fixed_point(0.05).eigenvalues[0].real, 4))\n"
            "print(len(afo.sim('adult70', 'virtual-adult', speed=0.8, steps=2).steps))")
    said = subprocess.run([sys.executable, "-c", code], cwd="/", env={**os.environ, "PYTHONPATH": str(tmp_path)},
                          capture_output=True, text=True, check=True).stdout.split()
    assert said[0] == str(tmp_path / "afo/__init__.py") and said[2] == "-0.5714" and said[3] == "2"
    assert (tmp_path / "afo/py.typed").is_file() and next(tmp_path.glob("afo-*.dist-info/RECORD")).is_file()
    assert subprocess.run(["git", "status", "--porcelain", ROOM], cwd=ROOT, capture_output=True, text=True,
                          check=False).stdout.count("egg-info") == 0


def test_without_a_compiler_pip_says_what_to_install(tmp_path):
    for tool in ("sh", "bash"):
        (tmp_path / tool).symlink_to(f"/bin/{tool}")
    done = pip("wheel", "--no-deps", "--no-index", "--wheel-dir", tmp_path / "wheel", ROOM, PATH=str(tmp_path))
    assert done.returncode != 0
    assert "afo is C code, and make and gcc is not here to compile it. Install it: sudo apt-get install gcc libc6-dev make" \
        in done.stdout + done.stderr


def test_a_package_without_its_library_says_how_to_build_it(tmp_path):
    folder = tmp_path / "afo"
    folder.mkdir()
    for path in (BUILD / "python/afo").iterdir():
        if path.suffix in (".py", ".h"):
            shutil.copy(path, folder)
    done = subprocess.run([sys.executable, "-c", "import afo"], env={**os.environ, "PYTHONPATH": str(tmp_path)},
                          capture_output=True, text=True, check=False)
    assert "ImportError" in done.stderr and "pip install sim_host/python, or make python" in done.stderr


def test_the_library_shows_what_its_header_declares_and_nothing_else():
    shown = subprocess.run(["nm", "-D", "--defined-only", BUILD / "python/afo/libafo.so"], capture_output=True, text=True,
                           check=True).stdout
    declared = set(re.findall(r"\b(afo_\w+)\(", (ROOM / "library.h").read_text(encoding="utf-8")))
    assert {line.split()[2] for line in shown.splitlines()} - {"_init", "_fini"} == declared & set(re.findall(r"afo_\w+", shown))


def test_all_that_is_public_has_words_and_types(afo):
    for name in afo.__all__:
        one = getattr(afo, name)
        if inspect.isroutine(one) or inspect.isclass(one):
            assert inspect.getdoc(one) and "namedtuple" not in inspect.getdoc(one).lower(), name
    for path in (ROOM / "afo").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                arguments = [one for one in node.args.args + node.args.kwonlyargs if one.arg != "self"]
                assert node.returns is not None and all(one.annotation for one in arguments), f"{path.name}: {node.name}"


def test_python_costs_less_than_a_tenth():
    """The share that make bench prints, with short turns: processor time, so that other work does not count."""
    done = subprocess.run([sys.executable, "scripts/bench_python.py", BUILD, "tests/sim_host/batch/reference_strides.csv", "0.15"],
                          cwd=ROOT, capture_output=True, text=True, check=False)
    assert re.search(r"(\d+) % of the engine's", done.stdout), done.stderr
    assert done.returncode == 0, done.stdout


def test_states_are_not_copied(afo):
    """What is contiguous and double already is read where it lies."""
    x, r0 = numpy.zeros((1000, 3)), numpy.full(1000, 0.05)
    _, start, push, _ = afo.Walker._run.__globals__["_broadcast"](x, r0, None)
    assert numpy.shares_memory(start, x) and numpy.shares_memory(push, r0)
