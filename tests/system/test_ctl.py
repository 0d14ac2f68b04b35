"""afo ctl from the outside: against the EDS as the package canopen reads it, and over a virtual bus
against the same package as a second tool."""
import json
import re

import pytest

from afo import BUILD, ROOT, run
from test_peers import PYTHON, in_guest

canopen = pytest.importorskip("canopen")
EDS = ROOT / "hal" / "canopen" / "eds"


def names(node):
    done = run("names", "--json", "--node", node, command="ctl")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize("node, file", [(16, "controller.eds"), (1, "drive-left.eds"), (4, "sensor-right.eds")])
def test_names_are_the_data_sheets(node, file):
    """Same objects, same access, the same words and limits."""
    dictionary = canopen.import_od(str(EDS / file), node)
    listed = {}
    for name, told in names(node).items():
        index, sub = (int(part, 16) for part in told["address"].split(":"))
        listed[index, sub] = name, told
    in_sheet = {}
    for index, entry in dictionary.items():
        if isinstance(entry, canopen.objectdictionary.ODVariable):
            in_sheet[index, 0] = entry
        else:
            in_sheet.update({(index, sub): entry[sub] for sub in entry if sub != 0})
    # Dummy entries of the sheet are types. The PDO set-up of drives and sensors is not for a person.
    in_sheet = {key: entry for key, entry in in_sheet.items() if key[0] >= 0x1000 and not 0x1400 <= key[0] < 0x1B00}
    shown = {key: value for key, value in listed.items() if not 0x1400 <= key[0] < 0x1B00}
    assert set(shown) == set(in_sheet)
    for key, entry in in_sheet.items():
        name, told = shown[key]
        first_word = re.split(r"[^a-z0-9]+", entry.name.lower())[0]
        assert first_word in name, (name, entry.name)
        assert (told["access"] in ("rw", "wo")) == entry.writable, name
        if entry.max is not None and entry.data_type != canopen.objectdictionary.REAL32 and entry.writable:
            assert (told["low"], told["high"]) == (entry.min, entry.max), name


def test_wrong_usage_and_a_missing_interface():
    for words, part in ((["get", "kp"], "--can INTERFACE"), ([], "verbs"),
                        (["--can", "nocan9", "get", "law"], "nocan9"),
                        (["--node", "200", "names"], "--node"), (["--jason", "names"], "nearest: --json")):
        done = run(*words, command="ctl")
        assert done.returncode == 2 and part in done.stderr, (words, done.stderr)
        assert not done.stdout
    done = run("--help", command="ctl")
    assert done.returncode == 0
    for verb in ("names", "get", "set", "watch", "dump", "diff", "save", "walk", "stop", "reset", "zero"):
        assert re.search(rf"^  {verb} ", done.stdout, re.M), verb


def test_it_and_another_tool_agree_on_a_walking_device(tmp_path):
    out = in_guest(f"""
        {BUILD}/afo walker --can vcan0 --silence 60000 --quiet & walker=$!
        sleep 0.3
        {BUILD}/afo host --can vcan0 --speed 0.41 --quiet & host=$!
        {PYTHON} tests/system/peer_ctl.py {BUILD}/afo {tmp_path}; status=$?
        kill -TERM $host; wait $host
        kill -TERM $walker; wait $walker
        exit $status""", 300)
    assert out.rstrip().endswith("done"), out
    assert out.count("\n") == 6, out
