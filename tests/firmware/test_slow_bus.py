"""The tree built for another bit rate: one that fits walks, one that does not is refused."""
import json
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def build(name, *settings):
    subprocess.run(["make", "--no-print-directory", f"BUILD=build/{name}", *settings, "programs"], cwd=ROOT,
                   capture_output=True, check=True)
    return ROOT / "build" / name


def sim(directory, *arguments):
    program = directory / "afo"
    command = [program, "sim"] if program.exists() else [directory / "afo-sim"]
    return subprocess.run([*command, *arguments], cwd=ROOT, capture_output=True, text=True)


def means(walk):
    """Apex speed and precompression over the last 20 steps."""
    return [sum(walk[name][-20:]) / 20 for name in ("apex_speed_rad_s", "r0_m")]


@pytest.mark.long
@pytest.mark.parametrize("tick_us", [1900, 2000])
def test_500_kbit_s_walks_at_the_tick_that_fits(tick_us):
    directory = build(f"slow-{tick_us}", f"TICK_US={tick_us}", "BITRATE=500000")
    try:
        for law in ("proportional", "predictive"):
            walking = ("--law", law, "--speed", "0.6", "--steps", "40", "--json", "--quiet")
            result = sim(directory, *walking)
            assert result.returncode == 0, result.stderr
            walk = json.loads(result.stdout)
            assert walk["steps"] == 40 and not walk["fell"] and walk["fault"] is None
            assert means(walk) == pytest.approx(means(json.loads(sim(ROOT / "build", *walking).stdout)), rel=1e-3)
        assert "at 500 kbit/s" in sim(directory, "--steps", "5").stdout
    finally:
        shutil.rmtree(directory)


@pytest.mark.long
def test_500_kbit_s_with_a_tick_of_1_ms_is_refused_at_the_start():
    directory = build("unfit", "BITRATE=500000")
    try:
        result = sim(directory, "--steps", "5")
        assert result.returncode == 2
        assert "TICK_US=1900 BITRATE=500000" in result.stderr
        image = subprocess.run(["make", "BUILD=build/unfit", "BITRATE=500000", "firmware"], cwd=ROOT, capture_output=True,
                               text=True)
        assert image.returncode != 0
        assert "they hold with a SYNC every 1900 us" in image.stderr
    finally:
        shutil.rmtree(directory)
