"""How the system tests start the programs: as a user would, from the outside."""
import functools
import json
import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("AFO_BUILD", ROOT / "build")).resolve()
AFO = BUILD / "afo"
LIMIT_S = 240

STEP_COLUMNS = ["step", "time_s", "side", "apex_speed_rad_s", "measured_speed_rad_s",
                "target_speed_rad_s", "r0_m", "step_time_s", "step_length_m", "used_fallback",
                "heel_strike_s", "toe_off_s", "walking_speed_m_s", "push_off_J", "margin_of_stability_m"]
TICK_COLUMNS = ["tick", "time_s", "stance", "phase", "theta_left_rad", "theta_right_rad",
                "rate_left_rad_s", "rate_right_rad_s", "ankle_left_m", "ankle_right_m",
                "motor_left_m", "motor_right_m", "hip_x_m", "hip_y_m", "event", "supervisor",
                *(f"{what}_{side}_{axis}_{unit}" for what, unit in (("toe", "m"), ("ground", "N")) for side in ("left", "right")
                  for axis in "xy")]


def run(*arguments, command="sim", program=AFO, cwd=ROOT):
    """Runs a command to its end; a hang fails the test."""
    return subprocess.run([str(program), command, *map(str, arguments)], cwd=cwd, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=LIMIT_S)


def file_of(room, name):
    """A person's or a device's file that is shipped."""
    return ROOT / "sim_host" / room / f"{name}.ini"


def who(person="paper", device="virtual"):
    """The options for a shipped person with a shipped device on."""
    return ("--person", file_of("persons", person), "--device", file_of("devices", device))


ADULT = who("adult70", "virtual-adult")


def with_lines(path, original, lines, section="both"):
    """A person's or a device's file: `original` with further lines of a section; a key given there is replaced."""
    keys = [line.split("=")[0].strip() for line in lines]
    kept = [line for line in original.read_text(encoding="utf-8").splitlines() if line.split("=")[0].strip() not in keys]
    path.write_text("\n".join([*kept, f"[{section}]", *lines]) + "\n", encoding="utf-8")
    return path


def converted(folder, text):
    """The options for an old subject file of that text, parted by the program."""
    paths = [folder / name for name in ("old.ini", "person.ini", "device.ini")]
    paths[0].write_text(text, encoding="utf-8")
    done = run("convert", *paths, command="device")
    assert done.returncode == 0, done.stderr
    return ("--person", paths[1], "--device", paths[2])


@functools.lru_cache(maxsize=None)
def walk(*arguments):
    """(exit status, the JSON object) of a run; the same run is made once only."""
    done = run("--json", "--quiet", *arguments)
    assert done.stdout, f"no JSON; standard error says: {done.stderr}"
    return done.returncode, json.loads(done.stdout)


def data(name):
    """A file of the folder that AFO_DATA names; the calling test bears the mark `data`.

    The files belong to other people and lie outside the tree. One that is not there is a skip,
    and a failure where CI=true.
    """
    path = pathlib.Path(os.environ["AFO_DATA"]) / name
    if not path.is_file():
        complain = pytest.fail if os.environ.get("CI") == "true" else pytest.skip
        complain(f"AFO_DATA={os.environ['AFO_DATA']} holds no {name}")
    return path


def recording():
    """The recorded walk of a healthy adult on level ground, 50 s."""
    return data("gait_young.csv")
