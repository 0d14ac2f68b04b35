"""The campaign of hostile neighbours: the commands of a walk that is viewed are those of the walk that nobody views."""
import pytest

from afo import run
from view_hostility import CLASSES, EARLIEST_TICK, SPEED, campaign, commands, neighbours, undisturbed
from viewer import Talk, viewing

STEPS, SECONDS, LONG_SECONDS = 60, 1.0, 20.0


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    return undisturbed(tmp_path_factory.mktemp("undisturbed"), STEPS)


@pytest.mark.parametrize("seed", [1, 2])
def test_all_neighbours_at_once_change_no_command(tmp_path, expected, seed):
    """One walk: flooded, twenty, stalled and rubbish beside each other, then stopped, at last killed."""
    assert campaign(CLASSES, seed, tmp_path, SECONDS, expected) is None


@pytest.mark.long
@pytest.mark.parametrize("kind", CLASSES)
@pytest.mark.parametrize("seed", range(3, 8))
def test_no_neighbour_changes_a_command(tmp_path, expected, kind, seed):
    assert campaign([kind], seed, tmp_path, LONG_SECONDS, expected) is None


def test_those_who_only_read_send_nothing(tmp_path):
    """Without --control every frame of the walk, byte for byte and by its time, is that of afo sim."""
    log = tmp_path / "v.log"
    assert neighbours(["twenty", "flooded"], 1, tmp_path, SECONDS) is None
    assert run("--speed", SPEED, "--steps", STEPS, "--log", tmp_path / "sim.log", "--quiet").returncode == 0
    mine, other = log.read_bytes(), (tmp_path / "sim.log").read_bytes()
    mine = mine[:min(len(mine), len(other)) - 1000]  # at its end the controller stops
    assert mine.count(b" 080#") > EARLIEST_TICK and other.startswith(mine)
    assert "LineTooLong" in (tmp_path / "errors.txt").read_text(encoding="utf-8")


def test_a_command_that_was_changed_is_found(tmp_path, expected):
    """A comparison that finds nothing would prove nothing: here somebody is allowed to change the speed."""
    log = tmp_path / "v.log"
    with viewing("--speed", "0.8", "--control", "--log", log) as view:
        talk = Talk(view)
        talk.event("step")
        talk.ask(do="write", name="commands.desired_apex_speed", value=0.42)  # the start ramp is on its way to 0.8
        talk.event("write", done=True)
        talk.event("step", number=7)
    found = commands(log)
    same = min(len(found), len(expected)) - 10
    assert found[:1000] == expected[:1000] and found[:same] != expected[:same]
