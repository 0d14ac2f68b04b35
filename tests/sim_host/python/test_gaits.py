"""Python's gaits, branches and basins against what the paper prints, and against SciPy."""
import pathlib
import sys

import numpy
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))
import bench_scipy  # noqa: E402


@pytest.fixture(scope="module")
def walker(afo):
    return afo.Walker()


def test_the_papers_fixed_point(walker):
    """Section 3.2: x* = (-0.4069, -0.0596, 1.7568), eigenvalues -0.5715, -0.1102, 0."""
    gait = walker.fixed_point(0.05)
    assert numpy.abs(gait.x - (-0.4069, -0.0596, 1.7568)).max() < 1e-4
    assert numpy.abs(gait.eigenvalues - (-0.5715, -0.1102, 0.0)).max() < 1e-4
    assert gait.stable and gait.residual < 1e-12 and gait.apex_speed_rad_s == -gait.x[0]


def test_the_other_gait_is_faster_and_never_stable(walker):
    """Figures 6 and 7."""
    long, short = walker.branch(numpy.linspace(0.02, 0.28, 14)), walker.branch(numpy.linspace(0.02, 0.28, 14), "short")
    assert (short.speed_rad_s > long.speed_rad_s).all() and (short.largest > 1).all()


@pytest.mark.parametrize("r0,period", [(0.0657282, 1), (0.0848527, 2), (0.0892606, 4)])
def test_period_doublings_of_table_1(walker, r0, period):
    """A gait of that period is stable below, and has an eigenvalue beyond -1 above."""
    below, above = walker.fixed_point(r0 - 2e-5, period=period), walker.fixed_point(r0 + 2e-5, period=period)
    assert below.stable and not above.stable
    assert above.eigenvalues[0].real < -1 and above.period == period


def test_a_long_walk_finds_the_gait_of_two_steps(afo, walker):
    """Figure 8: at 0.075 m walks repeat after two steps."""
    x = afo.return_map(walker.fixed_point(0.075).x + [0, 1e-3, 0], 0.075, 2000)
    assert numpy.abs(afo.return_map(x, 0.075, 2) - x).max() < 1e-7 < numpy.abs(afo.return_map(x, 0.075) - x).max()
    assert numpy.abs(walker.fixed_point(0.075, period=2).x - x).max() < 1e-6 or \
        numpy.abs(walker.fixed_point(0.075, period=2).x - afo.return_map(x, 0.075)).max() < 1e-6


def test_the_gains_of_figure_12(walker):
    r0 = numpy.linspace(0.05, 0.27, 45)
    largest = {kp: numpy.abs(walker.eigenvalues(r0, kp=kp)[:, 0]) for kp in (0.0, 0.02, 0.042)}
    assert largest[0.042].max() < 0.9 and largest[0.042].min() > 0.5
    assert (largest[0.02][(r0 > 0.091) & (r0 < 0.224)] > 1).all() and largest[0.02][r0 < 0.085].max() < 1
    assert (largest[0.0][(r0 > 0.066) & (r0 < 0.261)] > 1).all()


def test_a_walker_of_another_size_is_the_papers_in_its_own_units(afo, walker):
    """Dynamic similarity: masses times 3, lengths times 2, k with M g / l; rates go with sqrt(g/l)."""
    paper, other = walker.fixed_point(0.05), afo.Walker(M=3.0, m=0.03, l=2.0, k=150.0).fixed_point(0.1)
    assert numpy.allclose(other.x * (numpy.sqrt(2.0), 1.0, numpy.sqrt(2.0)), paper.x, atol=1e-10)
    assert numpy.allclose(other.eigenvalues, paper.eigenvalues, atol=1e-9)
    assert other.cost_of_transport == pytest.approx(paper.cost_of_transport, rel=1e-9)


def test_what_becomes_of_starts_as_scipy_walks_them(afo, walker):
    generator = numpy.random.default_rng(3)
    gait = walker.fixed_point(0.05).x
    starts = gait + generator.uniform(-1, 1, (12, 3)) * (0.15, 0.2, 0.4)
    outcome, strides = walker.settle(starts, 0.05)
    assert {0, 1} <= set(outcome)
    for start, came, after in zip(starts, outcome, strides):
        x, near = start, False
        for _ in range(after):
            x = bench_scipy.stride_or_nothing((1.0, 0.01, 1.0, 100.0, 9.80665, *x, 0.05), 1e-10, bench_scipy.single_support)
            near = numpy.abs(numpy.array(x) - gait).max() < 1.01e-4
        assert near == (afo.OUTCOMES[came] == "converges")


def test_a_plane_of_the_basin(afo, walker):
    basin = walker.basin(0.05, points=41, ranges={"swing_angle": (-0.2, 0.1)})
    assert basin.outcome.shape == (41, 41) and basin.a[0] == -0.2 and basin.b[-1] == 0.0
    gait = walker.fixed_point(0.05).x
    nearest = basin.outcome[numpy.abs(basin.a - gait[1]).argmin(), numpy.abs(basin.b - gait[0]).argmin()]
    assert afo.OUTCOMES[nearest] == "converges" and 0 < basin.share < 0.6
    assert (basin.outcome[:, -1] == 0).all()  # standing still


@pytest.mark.parametrize("call,words", [
    (lambda w: w.fixed_point(-0.1), "r0 = -0.1 m must be above 0 and below the leg length of 1 m"),
    (lambda w: w.fixed_point(0.9), r"lost near r0 = 0\.3.*try an r0 on this side"),
    (lambda w: w.fixed_point(0.05, "longer"), "branch = 'longer' is none of long, short"),
    (lambda w: w.fixed_point(0.05, period=0), "period must be a whole number from 1 to 1024, not 0"),
    (lambda w: w.fixed_point(0.05, guess=[1, 2]), "guess has the shape"),
    (lambda w: w.fixed_point(0.05, guess=[0.1, 0, 0]), "no fixed point from this guess"),
    (lambda w: w.branch([0.05, numpy.nan]), "r0 = nan m"),
    (lambda w: w.basin(0.05, axes=("r0", "swing_rate")), "axes = 'r0' is none of stance_rate"),
    (lambda w: w.basin(0.05, ranges={"swing_angle": (1, 0)}), "the range of swing_angle must rise"),
])
def test_what_does_not_fit_is_said(afo, walker, call, words):
    with pytest.raises(afo.AfoError, match=words):
        call(walker)


def test_the_gaits_before_a_lost_branch_are_kept(afo, walker):
    with pytest.raises(afo.AfoError, match="lost before r0 = 0.9 m") as caught:
        walker.gaits([0.05, 0.1, 0.9])
    assert [gait.r0 for gait in caught.value.gaits] == [0.05, 0.1]
