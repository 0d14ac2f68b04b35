"""The black box of a walk over a real CAN stack, fetched over the bus, replays: one taken
while it walks, then one that a fault froze."""
import re
import subprocess

import pytest

from afo import BUILD, ROOT, run

# The cycles are counted by the frame with both targets, not by time: the walk goes as fast as
# the machine does. The frame sent is an emergency message of the left drive (CiA 301), 0x2310:
# continuous over-current.
GUEST = """
cycles() {{ candump -n $1 vcan0,201:7FF >/dev/null; }}
fetch() {{ {build}/afo blackbox vcan0 $2 --out {out}/$1.log 2>{out}/$1.txt || status=1; }}
status=0
{build}/afo walker --can vcan0 --silence 60000 --quiet --json >{out}/walker.json & walker=$!
sleep 0.5
{build}/afo host --can vcan0 --speed 0.45 --quiet --json >{out}/host.json & host=$!
cycles 1800
fetch walking "--freeze --release"
cycles 1200
cansend vcan0 081#1023010000000000
cycles 400
fetch fault
kill -TERM $host; wait $host
kill -TERM $walker; wait $walker
exit $status
"""


@pytest.fixture(scope="module")
def fetched(tmp_path_factory):
    out = tmp_path_factory.mktemp("box")
    script = out / "guest.sh"
    script.write_text(GUEST.format(build=BUILD, out=out))
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "150", "--", "bash", str(script)], cwd=ROOT,
                          capture_output=True, text=True, timeout=200)
    told = {path.name: path.read_text() for path in out.glob("*.txt")}
    assert done.returncode == 0, f"{done.stdout}{done.stderr}{told}"
    return out


NODE_LOST = 1 << 2


# A node that tells of an error of its own device is not counted on any more.
@pytest.mark.parametrize("name, fault", [("walking", 0), ("fault", NODE_LOST)])
def test_the_box_replays_to_every_frame(fetched, name, fault):
    told = (fetched / f"{name}.txt").read_text()
    found = re.search(r"ticks (\d+) to (\d+): (\d+) frames, (\d+) snapshots; fault bits ([0-9a-f]{8})", told)
    first, last, frames, snapshots = (int(text) for text in found.groups()[:4])
    assert int(found[5], 16) == fault
    assert last - first > 600 and frames > 2 * (last - first) and snapshots >= 1

    done = run("--speed", "0.45", fetched / f"{name}.log", command="replay")
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(re.search(r"(\d+) ticks; all \d+ frames", done.stdout)[1]) > 500


def test_one_bit_of_a_target_is_told_with_its_line(fetched, tmp_path):
    lines = (fetched / "fault.log").read_text().splitlines()
    targets = [i for i, line in enumerate(lines) if " 201#" in line]
    place = targets[3 * len(targets) // 4]
    lines[place] = lines[place][:-1] + format(int(lines[place][-1], 16) ^ 1, "X")
    changed = tmp_path / "changed.log"
    changed.write_text("\n".join(lines) + "\n")
    done = run("--speed", "0.45", changed, command="replay")
    assert done.returncode == 1 and f"line {place + 1}" in done.stdout
