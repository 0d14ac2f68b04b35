"""The committed EDS and DBC files against the code, and against each other, read by the
packages canopen and cantools, which know nothing of this project."""
import re

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
            ROW.finditer((ROOT / "hal" / "bus" / "frame_table.h").read_text())}


def test_the_files_are_what_the_code_says_now(tmp_path):
    done = run(tmp_path, program=BUILD / "afo-eds")
    assert done.returncode == 0, done.stderr
    names = sorted(path.name for path in FILES.iterdir())
    assert names == sorted([f"{name}.eds" for name in NODES] + ["afo.dbc"])
    for name in names:
        assert (tmp_path / name).read_text() == (FILES / name).read_text(), \
            f"{name} is out of date: run build/afo-eds hal/canopen/eds"


def test_the_dbc_has_every_frame_of_the_table():
    table = frame_table()
    messages = {m.frame_id: m for m in dbc().messages}
    assert set(messages) == set(table)
    for identifier, row in table.items():
        assert messages[identifier].name == row[1]
        assert messages[identifier].length == int(row[3])


def mapped_pdos(name):
    """COB-ID -> list of (first bit, bits, is signed, is dummy) by the EDS's default mapping."""
    od = canopen.import_od(str(FILES / f"{name}.eds"))
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
    od = canopen.import_od(str(FILES / f"{name}.eds"))
    assert od[0x1000].default is not None
    assert od[0x1017].default == 100
    assert od[0x1018][1].access_type == "const"
    assert od[0x1005].default == 0x80
    assert od[0x1014].default == 0x80 + NODES[name]
    assert od[0x1200][1].default == 0x600 + NODES[name]
    if name.startswith("drive"):
        assert (od[0x6007].min, od[0x6007].max) == (0, 3)
        assert od[0x6064].access_type == "ro"
        assert od[0x6502].default == 1 << 7
