"""afo study atlas: same bytes from one thread, several, and the ranks of mpirun; a killed run goes on from its file."""
import os
import pathlib
import shutil
import signal
import subprocess
import time

import pytest

BUILD = pathlib.Path(__file__).resolve().parents[3] / os.environ.get("BUILD", "build")
ATLAS = (BUILD / "afo", "study", "atlas")
MPI = BUILD / "afo-mpi"  # the same with MPI in it, where that is installed
RANKS = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
HEADING, MARK = 32, 4


def atlas(*arguments, limit_s=120):
    return subprocess.run([*ATLAS, *map(str, arguments)], capture_output=True, text=True, timeout=limit_s)


def under_mpirun(ranks, *arguments):
    return [*"mpirun --oversubscribe -n".split(), str(ranks), str(MPI), "study", "atlas", *map(str, arguments)]


needs_mpirun = pytest.mark.skipif(
    shutil.which("mpirun") is None or not MPI.exists(), reason="built without MPI")


@pytest.fixture(scope="module")
def basin(tmp_path_factory):
    file = tmp_path_factory.mktemp("atlas") / "one"
    assert atlas("basin", file, "--points", 40, "--threads", 1).returncode == 0
    return file.read_bytes()


def points_of(bytes_, chunks):
    return bytes_[HEADING + MARK * chunks:]


def test_the_basin_holds_the_gait_and_has_an_edge(basin):
    points = points_of(basin, 40)
    assert len(points) == 40 ** 3
    # The point next to the paper's gait: speed 0.407, swing angle -0.0596, swing rate 1.757.
    near = [round((0.407 - 0.05) / 1.95 * 39), round((-0.0596 + 0.8) / 2.0 * 39), round((1.757 + 1) / 5 * 39)]
    assert points[(near[0] * 40 + near[1]) * 40 + near[2]] == 255
    assert 0.005 < points.count(255) / len(points) < 0.2


def test_threads_do_not_show(basin, tmp_path):
    assert atlas("basin", tmp_path / "b", "--points", 40, "--threads", 3).returncode == 0
    assert (tmp_path / "b").read_bytes() == basin


@needs_mpirun
def test_ranks_do_not_show(basin, tmp_path):
    done = subprocess.run(under_mpirun(3, "basin", tmp_path / "b", "--points", 40), env=RANKS, timeout=120)
    assert done.returncode == 0
    assert (tmp_path / "b").read_bytes() == basin


@needs_mpirun
def test_a_killed_rank_costs_no_more_than_its_chunk(tmp_path):
    # Whole: with threads. Then with ranks, of which one is killed on the way, and resumed on one core.
    wanted = ("--points", 96, "--strides", 254)
    assert atlas("basin", tmp_path / "whole", *wanted).returncode == 0
    file = tmp_path / "killed"
    run = subprocess.Popen(under_mpirun(3, "basin", file, *wanted), env=RANKS, stderr=subprocess.DEVNULL)

    def done():
        marks = file.read_bytes()[HEADING:HEADING + MARK * 96] if file.exists() else b""
        return sum(marks[i:i + MARK] != bytes(MARK) for i in range(0, len(marks), MARK))
    limit = time.monotonic() + 60
    while done() < 5 and run.poll() is None and time.monotonic() < limit:
        time.sleep(0.005)
    ranks = subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True).stdout.split()
    if ranks:
        os.kill(int(ranks[-1]), signal.SIGKILL)
    run.wait(timeout=60)
    before = done()
    assert before >= 5
    assert atlas("basin", file, *wanted, "--threads", 1).returncode == 0
    assert file.read_bytes() == (tmp_path / "whole").read_bytes()


def test_the_plane_shows_the_papers_cascade(tmp_path):
    assert atlas("plane", tmp_path / "p", "--points", 32).returncode == 0
    points = points_of((tmp_path / "p").read_bytes(), 1)
    # k l / (M g) = 10.2 is the paper's: row 8 of 3..30; r0 = 0.005 + i * 0.2950 / 31.
    row = points[8 * 32:9 * 32]
    def at(r0):
        return row[round((r0 - 0.005) / 0.295 * 31)]
    assert at(0.045) == 1
    assert at(0.075) == 2
    assert at(0.15) == 0
    assert at(0.29) == 1


def test_other_work_and_bad_options_are_refused(tmp_path):
    assert atlas("basin", tmp_path / "b", "--points", 8).returncode == 0
    refused = atlas("basin", tmp_path / "b", "--points", 9)
    assert refused.returncode == 1 and "other work" in refused.stderr
    for wrong, said in ((("--points", "many"), '--points: "many" is not a whole number'), (("--colour", 1), 'no option "--colour"')):
        told = atlas("basin", tmp_path / "c", *wrong)
        assert told.returncode == 2 and said in told.stderr
    assert atlas("sphere").returncode == 2
    for words in (("--points=8",), ("--points", "8"), ("--threads", "8")):
        told = atlas("plane", *words)
        assert told.returncode == 2 and "into which file?" in told.stderr
    assert not pathlib.Path("--points=8").exists()
    assert atlas("--version").stdout.startswith("afo study atlas ")
    assert "Usage" in atlas("--help").stdout
