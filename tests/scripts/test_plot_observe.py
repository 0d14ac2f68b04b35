"""scripts/plot-observe draws the observer's table, and refuses what is none."""
import pathlib
import subprocess

import pytest
from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts" / "plot-observe"
HEADER = ("sensor,noise_counts,latency_s,speed_rad_s,fell_after,observer_rms,observer_worst,plain_rms,butterworth_rms,"
          "swing_angle_rad,swing_rate_rad_s,apex_delay_s,strike_delay_s,lift_off_delay_s,loop_spread,observer_spread,"
          "observer_falls,plain_spread,plain_falls,butterworth_spread,butterworth_falls")


def table():
    lines = [HEADER]
    for bits in (12, 14, 17):
        error = 4.0 / 2 ** bits
        for noise in (0.25, 1, 2):
            lines.append(f"{bits} bit,{noise},0.002,0.8,0,{error * noise},{error},{3000 * error},{18 * error},0,0,0,0,0,0,"
                         f"{3 * error},,,2,{5 * error if bits > 12 else ''},{'' if bits > 12 else 5}")
    lines[3] = "12 bit,2,0.002,0.8,6" + "," * 16  # fell before there was anything to count
    assert all(line.count(",") == HEADER.count(",") for line in lines)
    return "\n".join(lines) + "\n"


def plot(path, out):
    return subprocess.run(["/usr/bin/python3", SCRIPT, path, "--out", out], capture_output=True, text=True, timeout=120)


def test_a_picture_with_something_on_it(tmp_path):
    (tmp_path / "observe.csv").write_text(table())
    done = plot(tmp_path / "observe.csv", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["observe.png"]
    with Image.open(tmp_path / "out" / "observe.png") as picture:
        assert picture.width > 1000 and picture.height > 300
        assert len(picture.convert("RGB").getcolors(1 << 24)) > 50


@pytest.mark.parametrize("text", ["a,b\n1,2\n", HEADER + "\n", "sensor,noise_counts\n12 bit,1\n"])
def test_no_table_no_picture(text, tmp_path):
    (tmp_path / "other.csv").write_text(text)
    done = plot(tmp_path / "other.csv", tmp_path / "out")
    assert done.returncode != 0 and "other.csv" in done.stderr
    assert not (tmp_path / "out").exists()
