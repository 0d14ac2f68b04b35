"""Python's return map against strides in quadruple precision, and against SciPy's integration of the equations."""
import csv
import pathlib
import sys

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))
import bench_scipy  # noqa: E402

GAIT = (-0.406960, -0.059569, 1.756768)


@pytest.fixture(scope="module")
def reference():
    """{walker's five numbers: rows} of strides known in quadruple precision."""
    found = {}
    with open(ROOT / "tests/sim_host/batch/reference_strides.csv", newline="", encoding="utf-8") as file:
        for row in list(csv.reader(file))[1:]:
            numbers = [float(x) for x in row]
            found.setdefault(tuple(numbers[:5]), []).append(numbers[5:])
    return {walker: numpy.array(rows) for walker, rows in found.items()}


def by_scipy(state, r0, walker=(1.0, 0.01, 1.0, 100.0, 9.80665)):
    return numpy.array(bench_scipy.stride((*walker, *state, r0), 1e-13, bench_scipy.single_support))


def test_every_stride_of_the_reference(afo, reference):
    strides = 0
    for walker, rows in reference.items():
        M, m, l, k, g = walker
        found = afo.return_map(rows[:, :3], rows[:, 3], walker=afo.Walker(M, m, l, k, g))
        assert numpy.abs(found - rows[:, 4:7]).max() < 1e-9
        strides += len(rows)
    assert strides == 240 and len(reference) > 1


def test_accuracy_is_what_is_asked_for(afo, reference):
    M, m, l, k, g = walker = next(iter(reference))
    rows = reference[walker]
    errors = [numpy.abs(afo.return_map(rows[:, :3], rows[:, 3], walker=afo.Walker(M, m, l, k, g), accuracy=accuracy)
                        - rows[:, 4:7]).max() for accuracy in (1e-4, 1e-6, 1e-12)]
    assert errors[0] < 1e-4 and errors[1] < 1e-6 and errors[2] < 1e-12


def test_derivatives_are_those_of_scipys_stride(afo):
    step = 1e-4
    found = afo.Walker().derivatives(GAIT, 0.05)
    for column in range(3):
        by = numpy.eye(3)[column] * step
        slope = (by_scipy(GAIT + by, 0.05) - by_scipy(GAIT - by, 0.05)) / (2 * step)
        assert numpy.allclose(found.by_x[:, column], slope, atol=2e-6)
    step = 1e-5  # the map is much more curved along r0
    slope = (by_scipy(GAIT, 0.05 + step) - by_scipy(GAIT, 0.05 - step)) / (2 * step)
    assert numpy.allclose(found.by_r0, slope, atol=2e-5)
    assert numpy.abs(found.x - by_scipy(GAIT, 0.05)).max() < 1e-9


def test_the_law_is_eq_16(afo):
    """Ten strides with kp, the push-off of each by the paper's formula in SciPy's loop."""
    state, speed, kp = numpy.array(GAIT) + [0.003, 0, 0], 0.40696, 0.042
    found = afo.return_map(state, 0.05, 10, kp=kp, speed=speed)
    for _ in range(10):
        state = by_scipy(state, 0.05 - kp * (speed + state[0]))
    assert numpy.abs(found - state).max() < 1e-8


@pytest.mark.parametrize("threads", (1, 2, 0))
def test_shapes_and_threads_change_nothing(afo, threads):
    """Each walker's result is its own, bit for bit."""
    generator = numpy.random.default_rng(1)
    x = numpy.array(GAIT) + generator.uniform(-0.02, 0.02, (7, 300, 3))
    r0 = generator.uniform(0.04, 0.06, 300)
    together = afo.return_map(x, r0, 3, threads=threads)
    assert together.shape == (7, 300, 3)
    assert numpy.array_equal(together[2, 11], afo.return_map(x[2, 11], r0[11], 3))
    assert numpy.array_equal(together, afo.return_map(x[:, :, ::-1].copy()[:, :, ::-1], r0, 3), equal_nan=True)


def test_many_strides_are_cut_without_a_trace(afo):
    """Long runs return to Python in between, so that Ctrl-C is heard; the bits are the same."""
    x = numpy.tile(numpy.array(GAIT), (5000, 1)) + numpy.linspace(-1e-4, 1e-4, 5000)[:, None]
    once, steps = afo.Walker().walk(x, 0.052, 120), x
    for _ in range(120):
        steps = afo.return_map(steps, 0.052)
    assert numpy.array_equal(once.x, steps, equal_nan=True)
    assert numpy.isfinite(once.x).any() and (once.strides[once.fault == 0] == 120).all()


def test_a_fall_is_nan_and_has_its_reason(afo):
    walks = afo.Walker().walk([GAIT, (0.1, 0.0, 1.0), (-0.4, numpy.nan, 1.7), (-3.0, 0.0, 0.0)], 0.05, 4)
    assert numpy.isfinite(walks.x[0]).all() and numpy.isnan(walks.x[1:]).all()
    assert list(walks.strides) == [4, 0, 0, 0]
    assert [afo.fault_name(fault) for fault in walks.fault[:3]] == ["none", "walking backwards", "bad input"]
    assert walks.fault[3] != 0


def test_no_walkers_are_no_walkers(afo):
    assert afo.return_map(numpy.zeros((0, 3)), 0.05).shape == (0, 3)


@pytest.mark.parametrize("call,words", [
    (lambda afo: afo.return_map([1.0, 2.0], 0.05), r"x has the shape \(2,\); it must be \(\.\.\., 3\): stance rate rad/s"),
    (lambda afo: afo.return_map(numpy.zeros((4, 3)), [0.1, 0.2]), r"\(4, 3\) and r0 of the shape \(2,\).*\(4,\)"),
    (lambda afo: afo.return_map("abc", 0.05), "x must be numbers, not 'abc'"),
    (lambda afo: afo.return_map(GAIT, 0.05, 0), "strides must be a whole number from 1"),
    (lambda afo: afo.return_map(GAIT, 0.05, 2.5), "strides must be a whole number"),
    (lambda afo: afo.return_map(GAIT, 0.05, accuracy=1.0), "accuracy must be 1e-12 to 1e-4"),
    (lambda afo: afo.return_map(GAIT, 0.05, kp=0.04), "kp and speed go together"),
    (lambda afo: afo.return_map(GAIT, 0.05, kp=-0.04, speed=0.4), "kp = -0.04 m per rad/s.*from 0 on"),
    (lambda afo: afo.Walker(M=-1), "hip mass M must be 0.001 to 10000 kg"),
    (lambda afo: afo.Walker(m=-0.1), "leg mass m must be"),
    (lambda afo: afo.Walker(m=2.0), "m.*M"),
    (lambda afo: afo.Walker(l=float("nan")), "l = nan m: it must be a finite number"),
    (lambda afo: afo.Walker(k="stiff"), "k must be a number in N/m, not 'stiff'"),
])
def test_what_does_not_fit_is_said(afo, call, words):
    with pytest.raises(afo.AfoError, match=words):
        call(afo)
