"""The build is incremental and honest: what changed is rebuilt, what did not is not."""
import json
import os
import pathlib
import re
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

TREE = {
    "model/one.h": "#ifdef REAL_IS_DOUBLE\n#define one one_f64\n#else\n#define one one_f32\n#endif\nint one(void);\n",
    "model/one.c": '#include "model/one.h"\nint one(void)\n{\n    return 1;\n}\n',
    "model/two.c": '#include "model/one.h"\ntypedef int nothing;\n',
    "sim_host/programs/say.c":
        '#include <stdio.h>\n#include "firmware/version.h"\n#include "model/one.h"\n'
        'int main(void)\n{\n    printf("%s %08x %d\\n", version_text(), (unsigned)version_build_id(), one());\n'
        "    return 0;\n}\n",
}


@pytest.fixture
def tree(tmp_path):
    for name, text in TREE.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    shutil.copy(ROOT / "Makefile", tmp_path)
    (tmp_path / "firmware").mkdir()
    for name in ("version.c", "version.h"):
        shutil.copy(ROOT / "firmware" / name, tmp_path / "firmware")
    return tmp_path


def make(tree, *arguments, check=True):
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "BUILD", "CC")}
    done = subprocess.run(["make", *arguments], cwd=tree, env=environment, capture_output=True, text=True, timeout=120)
    if check:
        assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def compiled(output):
    return sorted(line.split()[1] for line in output.splitlines() if line.split()[:1] in (["CC"], ["CC64"]))


def say(tree, build="build"):
    return subprocess.check_output([tree / build / "afo"], text=True).split()


def test_the_debugger_stops_watchdog_and_clock_with_the_core():
    """DBGMCU_APB1FZR1 of the STM32G4: bit 12 freezes the watchdog, bit 0 TIM2."""
    commands = make(ROOT, "--no-print-directory", "-n", "debug")
    freeze = re.search(r"set \{unsigned\}0xE0042008 = (0x[0-9A-Fa-f]+)", commands)
    assert freeze and int(freeze[1], 16) == 1 << 12 | 1 << 0


def test_a_second_build_does_nothing(tree):
    assert compiled(make(tree))
    again = make(tree)
    assert not compiled(again) and "LD" not in again and "AR" not in again


def test_a_header_rebuilds_its_users_in_both_precisions(tree):
    make(tree)
    (tree / "model" / "one.h").write_text(TREE["model/one.h"] + "\n")
    # version.c too: the build id is a checksum over the sources.
    assert compiled(make(tree)) == ["firmware/version.c", "model/one.c", "model/one.c", "model/two.c",
                                    "model/two.c", "sim_host/programs/say.c"]


def test_changed_flags_rebuild_everything(tree):
    first = compiled(make(tree))
    assert compiled(make(tree, "OPT=-O1")) == first
    assert compiled(make(tree, "OPT=-O1")) == []


def test_a_library_that_came_since_is_in_the_next_build(tree, monkeypatch):
    """The measurements' peers: their program is compiled anew when the compiler finds a header that it did not find."""
    headers, bench = tree / "include", tree / "sim_host/programs/bench"
    bench.mkdir()
    shutil.copy(ROOT / "sim_host" / "batch.mk", tree / "sim_host")
    (bench / "afo_bench_gsl.c").write_text(
        "#include <stdio.h>\nint main(void)\n{\n#ifdef HAVE_PEER\n    puts(\"with\");\n#else\n"
        "    puts(\"without\");\n#endif\n    return 0;\n}\n")
    monkeypatch.setenv("CPATH", str(headers))
    program, what = tree / "build/afo-bench-gsl", ("build/afo-bench-gsl", "gsl_HEADER=peer/peer.h", "gsl_LIBRARIES=")
    make(tree, *what)
    assert subprocess.check_output([program], text=True) == "without\n"
    (headers / "peer").mkdir(parents=True)
    (headers / "peer/peer.h").touch()
    make(tree, *what)
    assert subprocess.check_output([program], text=True) == "with\n"
    assert not compiled(make(tree, *what))


def test_a_removed_source_leaves_its_archive(tree):
    make(tree)
    archive = tree / "build" / "lib" / "libmodel_f32.a"
    assert "two.o" in subprocess.check_output(["ar", "t", archive], text=True)
    (tree / "model" / "two.c").unlink()
    make(tree)
    assert "two.o" not in subprocess.check_output(["ar", "t", archive], text=True)


def test_an_interrupted_or_failed_compilation_leaves_nothing_half_done(tree):
    make(tree)
    (tree / "model" / "one.c").write_text('#include "model/one.h"\nint one(void)\n{\n    return 1\n}\n')
    make(tree, check=False)
    assert not (tree / "build" / "f32" / "model" / "one.o").exists() or say(tree)[2] == "1"
    (tree / "model" / "one.c").write_text(TREE["model/one.c"].replace("return 1", "return 7"))
    make(tree)
    assert say(tree)[2] == "7"


def test_warnings_are_errors(tree):
    (tree / "model" / "one.c").write_text(TREE["model/one.c"].replace("return 1", "int x; return 1"))
    done = subprocess.run(["make"], cwd=tree, capture_output=True, text=True, timeout=120)
    assert done.returncode != 0 and "unused" in done.stderr


def test_builds_side_by_side(tree):
    make(tree)
    make(tree, "BUILD=build/clang", "CC=clang")
    assert compiled(make(tree)) == []
    # Version and build id do not depend on the compiler or its flags.
    assert say(tree) == say(tree, "build/clang")


def test_version_and_build_id(tree):
    make(tree)
    version, build_id, _ = say(tree)
    assert version == "0.3.0"  # no git here
    environment = dict(os.environ, GIT_AUTHOR_NAME="x", GIT_AUTHOR_EMAIL="x@x", GIT_COMMITTER_NAME="x",
                       GIT_COMMITTER_EMAIL="x@x")
    (tree / ".gitignore").write_text("/build/\n")
    for command in (["init", "-q"], ["add", "."], ["commit", "-qm", "x"]):
        subprocess.run(["git", *command], cwd=tree, check=True, env=environment)
    make(tree)
    commit = subprocess.check_output(["git", "rev-parse", "--short=10", "HEAD"], cwd=tree, text=True).strip()
    assert say(tree)[:2] == [f"0.3.0+g{commit}", build_id]
    (tree / "model" / "one.c").write_text(TREE["model/one.c"] + "/* changed */\n")
    make(tree)
    assert say(tree)[0] == f"0.3.0+g{commit}.dirty"
    assert say(tree)[1] != build_id


SAY_LIKE_AFO = r"""
#include <stdio.h>
#include <string.h>
int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[argc - 1], "--version") == 0) {
        puts("afo 1.2.3 (build 00000000)");
    } else if (argc > 2) {
        printf("Usage: afo %s [OPTION...]\n.dots and -dashes\n", argv[1]);
    } else {
        puts("Usage: afo COMMAND [OPTION...]\n\n  walk  some steps\n  fall  once");
    }
    return 0;
}
"""


def furnish(tree):
    """What installing and the list for editors need of the real tree."""
    for name in ("sim_host/install.mk", "scripts/man-page", "scripts/compile-commands"):
        (tree / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tree / name)
    for name in ("persons/somebody.ini", "devices/something.ini"):
        (tree / "sim_host" / name).parent.mkdir()
        (tree / "sim_host" / name).write_text("[person]\n")
    (tree / "sim_host/programs/say.c").write_text(SAY_LIKE_AFO)


def test_install_puts_program_manual_persons_and_devices_below_the_prefix(tree, tmp_path_factory):
    furnish(tree)
    place = tmp_path_factory.mktemp("staged")
    make(tree, "install", "PREFIX=/opt/some", f"DESTDIR={place}")
    files = sorted(path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file())
    assert files == ["opt/some/bin/afo", "opt/some/share/afo/devices/something.ini", "opt/some/share/afo/persons/somebody.ini",
                     "opt/some/share/man/man1/afo.1"]
    assert subprocess.check_output([place / "opt/some/bin/afo", "--version"], text=True).startswith("afo 1.2.3")
    manual = (place / "opt/some/share/man/man1/afo.1").read_text()
    assert "1.2.3" in manual.splitlines()[0]
    assert re.findall(r"^\.SH (afo .*)$", manual, re.M) == ["afo walk", "afo fall"]
    assert "\\&.dots and \\-dashes" in manual.splitlines()


def test_the_list_for_editors_holds_commands_that_compile(tree):
    furnish(tree)
    make(tree, "compile-commands")
    entries = json.loads((tree / "build" / "compile_commands.json").read_text())
    assert sorted(entry["file"] for entry in entries) == sorted(
        ["firmware/version.c", "model/one.c", "model/one.c", "model/two.c", "model/two.c", "sim_host/programs/say.c"])
    assert sum("-DREAL_IS_DOUBLE" in entry["arguments"] for entry in entries) == 2
    assert not list((tree / "build").rglob("*.o")), "nothing is compiled for it"
    for entry in entries:
        assert entry["directory"] == str(tree)
        (tree / entry["output"]).parent.mkdir(parents=True, exist_ok=True)
        subprocess.run(entry["arguments"], cwd=entry["directory"], check=True)


def test_the_editors_files_name_what_is_there():
    tasks = json.loads((ROOT / ".vscode/tasks.json").read_text())["tasks"]
    labels = {task["label"] for task in tasks}
    targets = {line.split()[0] for line in make(ROOT, "help").splitlines()[1:]} | {"programs", "tests"}
    for task in tasks:
        for command in task["command"].split(" && "):
            words = [word for word in command.split() if "=" not in word]
            assert set(words[1:]) <= targets if words[0] == "make" else (ROOT / words[0]).exists(), command
    for configuration in json.loads((ROOT / ".vscode/launch.json").read_text())["configurations"]:
        assert configuration["preLaunchTask"] in labels
    properties = json.loads((ROOT / ".vscode/c_cpp_properties.json").read_text())["configurations"]
    assert all(entry["compileCommands"].endswith("/build/compile_commands.json") for entry in properties)


def test_help_lists_the_main_targets():
    output = make(ROOT, "help")
    for target in ("all", "run", "test", "test-long", "bench", "format", "lint", "clean", "help", "asan"):
        assert any(line.split()[0].rstrip(",") == target for line in output.splitlines()[1:] if line.split()), target


def test_help_says_how_long_the_long_targets_take():
    lines = {line.split()[0]: line for line in make(ROOT, "help").splitlines()[1:]}
    for target in ("run", "test", "test-long", "bench", "lint", "coverage-report", "pil", "g474", "atlas", "soak-strides", "faults",
                   "faults-short", "faults-people", "soak", "laws", "paper", "fuzz", "hil", "hil-long", "restarts"):
        assert re.search(r"\([^)]*\b(s|seconds|min|minutes?|hours?|hour)\b[^)]*\)$", lines[target]), lines[target]
