"""The committed EDS and DBC files against the code, and against each other, read by the
packages canopen and cantools, which know nothing of this project."""
import configparser
import re
import subprocess

import pytest

from afo import BUILD, ROOT, run

canopen = pytest.importorskip("canopen")
cantools = pytest.importorskip("cantools")

FILES = ROOT / "hal" / "canopen" / "eds"
NODES = {"drive-left": 1, "drive-right": 2, "sensor-left": 3, "sensor-right": 4, "controller": 16}
ROW = re.compile(r"X\((\w+), (0x[0-9A-F]+), (\d+), (FRAME_TICKS\(\d+\)|\d+), (FRAME_TICKS\(\d+\)|\d+), (\d+), ([A-Z])\)")
SIGNED = {2, 3, 4, 0x10}


def dbc():
    return cantools.database.load_file(str(FILES / "afo.dbc"))


def frame_table():
    return {int(m[2], 16): m for m in
            ROW.finditer((ROOT / "hal" / "bus" / "frame_table.h").read_text().split("FRAME_OPTIONAL_TABLE")[0])}


def test_the_files_are_what_the_code_says_now(tmp_path):
    done = run(tmp_path, command="eds")
    assert done.returncode == 0, done.stderr
    names = sorted(path.name for path in FILES.iterdir())
    assert names == sorted([f"{name}.eds" for name in NODES] + ["afo.dbc"])
    for name in names:
        assert (tmp_path / name).read_text() == (FILES / name).read_text(), \
            f"{name} is out of date: run build/afo eds hal/canopen/eds"


def test_the_dbc_has_every_frame_of_the_table():
    table = frame_table()
    messages = {m.frame_id: m for m in dbc().messages}
    assert set(messages) == set(table)
    for identifier, row in table.items():
        assert messages[identifier].name == row[1]
        assert messages[identifier].length == int(row[3])


def mapped_pdos(name):
    """COB-ID -> list of (first bit, bits, is signed, is dummy) by the EDS's default mapping."""
    od = canopen.import_od(str(FILES / f"{name}.eds"), NODES[name])
    pdos = {}
    for communication, mapping in ((0x1400, 0x1600), (0x1800, 0x1A00)):
        for number in range(4):
            if communication + number not in od:
                continue
            cob_id = od[communication + number][1].default
            if cob_id & 0x80000000:
                continue
            start, layout = 0, []
            for i in range(od[mapping + number][0].default):
                entry = od[mapping + number][i + 1].default
                index, sub, bits = entry >> 16, entry >> 8 & 0xFF, entry & 0xFF
                dummy = index < 0x20
                if dummy:
                    data_type = index
                else:
                    variable = od[index] if sub == 0 and not hasattr(od[index], "subindices") \
                        else od[index][sub]
                    data_type = variable.data_type
                    assert variable.pdo_mappable
                layout.append((start, bits, data_type in SIGNED, dummy))
                start += bits
            pdos[cob_id & 0x7FF] = layout
    return pdos


@pytest.mark.parametrize("name", NODES)
def test_the_default_pdo_mapping_is_the_dbcs_layout(name):
    messages = {m.frame_id: m for m in dbc().messages}
    pdos = mapped_pdos(name)
    assert pdos
    for identifier, layout in pdos.items():
        message = messages[identifier]
        assert sum(bits for _, bits, _, _ in layout) == 8 * message.length
        for start, bits, is_signed, dummy in layout:
            inside = [s for s in message.signals if start <= s.start < start + bits]
            assert inside, f"{message.name}: no signal in bits {start}.."
            assert all(s.start + s.length <= start + bits for s in inside)
            whole = [s for s in inside if s.length == bits]
            if whole:
                assert whole[0].is_signed == is_signed
            assert not dummy or identifier == 0x201


@pytest.mark.parametrize("name", NODES)
def test_eds_has_identity_and_limits(name):
    od = canopen.import_od(str(FILES / f"{name}.eds"), NODES[name])
    assert od[0x1000].default is not None
    assert od[0x1017].default == 100
    assert od[0x1018][1].access_type == "const"
    assert od[0x1005].default == (0x40000080 if name == "controller" else 0x80)  # it sends SYNC
    assert od[0x1006].default == (1000 if name == "controller" else 0)
    assert od[0x1009].default == "1"
    assert od[0x1014].default == 0x80 + NODES[name]
    assert od[0x1200][1].default == 0x600 + NODES[name]
    if name.startswith("drive"):
        assert (od[0x6007].min, od[0x6007].max) == (0, 3)
        assert od[0x6064].access_type == "ro"
        assert od[0x6502].default == 1 << 7


def sections(name):
    parser = configparser.RawConfigParser(strict=True, delimiters=("=",))
    parser.optionxform = str
    parser.read_string((FILES / f"{name}.eds").read_text())
    return {section: dict(parser[section]) for section in parser.sections()}


def number(text):
    return float(text) if "." in text or "e" in text else int(text.replace("$NODEID+", ""), 0)


@pytest.mark.parametrize("name", NODES)
def test_a_default_lies_within_its_limits(name):
    limited = 0
    for section, values in sections(name).items():
        if values.get("DefaultValue") and "LowLimit" in values:
            limited += 1
            low, default, high = (number(values[key]) for key in ("LowLimit", "DefaultValue", "HighLimit"))
            assert low <= default <= high, section
    assert limited > 0


@pytest.mark.parametrize("name", NODES)
def test_what_is_constant_has_a_value_and_no_value_an_equals_sign(name):
    for section, values in sections(name).items():
        assert values.get("AccessType") != "const" or values["DefaultValue"], section
        assert not [key for key, value in values.items() if "=" in value or ";" in value], section


def variables(od):
    for entry in od.values():
        yield from [entry] if isinstance(entry, canopen.objectdictionary.ODVariable) else \
            (entry[sub] for sub in entry.subindices)


@pytest.mark.parametrize("name", [name for name in NODES if name != "controller"])
def test_cob_ids_follow_the_node_number(name):
    """The number of a drive or sensor is set at the device; the predefined connection set goes with it (CiA 306:
    $NODEID). What does not: the SYNC, and the targets that both drives share. (The controller is always 16.)"""
    one, other = (canopen.import_od(str(FILES / f"{name}.eds"), node) for node in (NODES[name], NODES[name] + 40))
    fixed = {(0x1005, 0)} | ({(0x1400, 1)} if name.startswith("drive") else set())
    seen = 0
    for a, b in zip(variables(one), variables(other)):
        is_cob_id = a.index in (0x1005, 0x1014, 0x1200) or 0x1400 <= a.index < 0x1600 or 0x1800 <= a.index < 0x1A00
        if is_cob_id and a.data_type == 7:
            seen += 1
            assert b.default - a.default == (0 if (a.index, a.subindex) in fixed else 40), hex(a.index)
    assert seen >= 12


@pytest.mark.parametrize("name", NODES)
def test_no_pdo_promises_to_answer_remote_requests(name):
    od = canopen.import_od(str(FILES / f"{name}.eds"), NODES[name])
    pdos = [od[index] for index in range(0x1800, 0x1804) if index in od]
    assert pdos and all(pdo[1].default & 0x40000000 for pdo in pdos)


def test_every_default_is_what_the_node_says(tmp_path):
    """Uploaded from the running programs before anybody sets them up, for two devices with other drives."""
    eds = "hal/canopen/eds"
    python = ROOT / "build" / "venv" / "bin" / "python"
    nodes = " ".join(f"{number} {eds}/{name}.eds" for name, number in NODES.items() if number != 16)
    script = f"""
        status=0
        for who in paper:virtual adult70:virtual-adult; do
            who="--person sim_host/persons/${{who%:*}}.ini --device sim_host/devices/${{who#*:}}.ini"
            {BUILD}/afo walker $who --can vcan0 --silence 60000 --quiet & walker=$!
            sleep 0.5
            {python} tests/system/peer_eds.py {nodes} || status=$?
            kill -TERM $walker; wait $walker
            {BUILD}/afo host $who --can vcan0 --quiet & host=$!
            sleep 0.5
            {python} tests/system/peer_eds.py 16 {eds}/controller.eds || status=$?
            kill -TERM $host; wait $host
        done
        exit $status"""
    done = subprocess.run(["scripts/vcan-guest", "--timeout", "200", "--", "bash", "-c", script], cwd=ROOT,
                          capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.split("\n")
    assert lines.count("done") == 4 and not [line for line in lines if "says" in line], done.stdout
