"""scripts/laws-table: the cells follow from the studies' rows."""
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

HOLD = "law,case,speed_rad_s,fell,steps,speed_share,spread,fallbacks,energy_J_per_m,cost_of_transport\n"
FILES = {
    "jumps-chain": "law,from_rad_s,to_rad_s,fell,settled,steps\n"
                   "dlqr,0.2,0.2,0,1,1\ndlqr,0.2,0.3,0,1,17\ndlqr,0.2,0.4,1,0,3\ndlqr,0.3,0.2,0,0,80\n",
    "jumps": "law,from_rad_s,to_rad_s,fell,settled,steps\ndlqr,0.3,0.2,0,1,6\n",
    "basin": "law,speed_rad_s,samples,reached\ndlqr,0.4,1000,123\ndlqr,0.6,1000,4\n",
    "ground": "law,kind,speed_rad_s,size_mm,steps,falls\n"
              "dlqr,straight,0.4,10,999,1\ndlqr,heights,0.4,10,500,200\ndlqr,heights,0.6,10,4321,1\n"
              "dlqr,heights,0.8,10,100000,0\n",
    "ground-chain": "law,kind,speed_rad_s,size_mm,steps,falls\ndlqr,heights,0.4,10,60,20\n",
    "push-chain": "law,speed_rad_s,direction,phase,share_of_m_sqrt_gl\n"
                  "dlqr,0.4,forward,0.1,0.02\ndlqr,0.4,backward,0.1,0.013\ndlqr,0.8,forward,0.1,0\n",
    "sensitivity": "law,speed_rad_s,step_time_s_per_leg\ndlqr,0.3,31.9\ndlqr,0.4,17.9\ndlqr,0.8,2.71\n",
    "slope": HOLD + "dlqr,+0.0 deg,0.8,0,200,1,0,0,1,1\ndlqr,-0.5 deg,0.8,0,200,1.043,0,0,1,1\n"
                    "dlqr,+0.5 deg,0.8,1,9,1,0,0,1,1\ndlqr,+1.0 deg,0.8,0,200,1.5,0,0,1,1\n",
    "mismatch": HOLD + "dlqr,M -10 %,0.6,0,200,1.1,0,0,1,1\ndlqr,k +10 %,0.6,1,5,1,0,0,1,1\n"
                       "dlqr,l +10 %,0.6,0,200,3,0,0,1,1\n",
    "energy": HOLD + "dlqr,noise 0.0 %,0.4,0,200,1,0,0,0.2208,1\ndlqr,noise 1.0 %,0.4,1,4,1,0,0,9,1\n",
}


@pytest.fixture(name="cells")
def table(tmp_path):
    for study, text in FILES.items():
        (tmp_path / f"laws-{study}.csv").write_text(text, encoding="utf-8")
    run = subprocess.run([ROOT / "scripts" / "laws-table", tmp_path], capture_output=True, text=True, check=True)
    rows = [line.strip("|").split("|") for line in run.stdout.splitlines()]
    assert all(len(row) == 6 for row in rows)
    assert rows[0][3].strip() == "dlqr"
    return {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows[2:]}


@pytest.mark.parametrize("title, cell", [
    ("jumps among", "1"), ("... that never settle", "1"), ("... steps to settle", "17 / -; - / 6"),
    ("basin", "12.3 / 0.40"), ("... within 10 mm", "2.5 / 4,321 / none in 100,000"),
    ("... within 10 mm, through", "3"), ("largest push", "0.0130 / under 0.0002"),
    ("gait sensitivity", "18 / fell / 2.7"), ("slopes", "-0.5 .. 0 (4.3 %)"),
    ("hip mass", "10 %, 1 of 2 fall"), ("spring energy", "0.22 (falls)")])
def test_cells(cells, title, cell):
    row = next(cells[name] for name in cells if name.startswith(title))
    assert row[2] == cell
    assert row[0] == row[4] == ("- / -; - / -" if title == "... steps to settle" else "")
