"""afo commission from the outside, over a virtual bus: a device in a stand, a person at the terminal."""
import configparser
import html.parser
import re

import pytest

from afo import BUILD, ROOT, run
from test_peers import in_guest

DEVICE = ROOT / "sim_host" / "devices" / "virtual.ini"


class Page(html.parser.HTMLParser):
    """Rows of the first table, and everything that a page could fetch."""
    def __init__(self):
        super().__init__()
        self.rows, self.fetched, self.text = [], [], ""

    def handle_starttag(self, tag, attributes):
        if tag == "tr":
            self.rows.append([])
        if tag == "td":
            self.rows[-1].append("")
        self.fetched += [value for name, value in attributes if name in ("src", "href")]

    def handle_data(self, data):
        self.text += data
        if self.rows and self.rows[-1]:
            self.rows[-1][-1] += data


def read_page(path):
    page = Page()
    page.feed(path.read_text())
    return page


def commission(folder, *words, answers="y\\n" * 8):
    line = " ".join(f"'{word}'" for word in words)
    return f"""printf '{answers}' | {BUILD}/afo commission --can vcan0 --device {DEVICE} --out {folder}/out.ini \
        --page {folder}/page.html --record {folder}/record.ini {line}; echo "status $?"
    """


def in_stand(script):
    return in_guest(f"""
        {BUILD}/afo walker --can vcan0 --stand --silence 60000 --quiet & walker=$!
        sleep 0.3
        {BUILD}/afo host --can vcan0 --speed 0.41 --standby --quiet & host=$!
        for _ in {{1..100}}; do {BUILD}/afo ctl --can vcan0 get supervisor_state | grep -q standby && break; sleep 0.1; done
        {script}
        kill -TERM $host; wait $host
        kill -TERM $walker; wait $walker; true""", 280)


HANDS = ["--skip", "latch=no foot is mounted", "--skip", "zero=nobody stands", "--skip", "sensors=nobody swings",
         "--skip", "stop=there is no button"]

LATER = [word for step in ("spring", "bandwidth", "link") for word in ("--skip", f"{step}=tomorrow; in <the> lab")]


def verdicts(page):
    return {row[0]: row[2] for row in page.rows if len(row) == 5}


def test_a_device_in_a_stand_is_moved_and_the_page_tells_what_is_left(tmp_path):
    out = in_stand(commission(tmp_path, *HANDS, *LATER) + commission(tmp_path, "--step", "rest"))
    assert out.count("status 0") == 2, out
    page = read_page(tmp_path / "page.html")
    verdict = verdicts(page)
    assert [name for name in verdict if verdict[name] == "passed"] == ["identify", "rest", "moves"]
    assert verdict["switches"] == "no such part" and list(verdict.values()).count("skipped") == 7
    assert not page.fetched
    assert "in <the> lab" in page.text and "Not shown (skipped)" in page.text
    assert run("check", tmp_path / "out.ini", command="device").returncode == 0


@pytest.mark.long
def test_a_device_in_a_stand_is_commissioned(tmp_path):
    out = in_stand(commission(tmp_path, *HANDS))
    assert out.count("status 0") == 1, out
    verdict = verdicts(read_page(tmp_path / "page.html"))
    assert verdict == {"identify": "passed", "rest": "passed", "moves": "passed", "zero": "skipped",
                       "sensors": "skipped", "latch": "skipped", "spring": "passed", "bandwidth": "passed",
                       "link": "passed", "stop": "skipped", "switches": "no such part"}
    device = configparser.ConfigParser(inline_comment_prefixes=(";",))
    device.read(tmp_path / "out.ini")
    assert device["both"]["unload"].strip() == "drive"


def test_a_walking_device_and_a_silent_person_are_told(tmp_path):
    out = in_stand(f"""
        {commission(tmp_path, "--step", "identify", "--step", "rest")}
        {commission(tmp_path, "--step", "moves", answers="")}
        {BUILD}/afo ctl --can vcan0 set walk_requested=1 >/dev/null
        {commission(tmp_path, "--step", "rest")}""")
    assert "FOUND: left leg: nobody confirmed which motor moved" in out, out
    assert "a walk is requested" in out, out
    assert out.count("status 1") == 3, out    # steps are open


def test_ctrl_c_and_kill_in_the_middle_of_a_motion_do_no_harm(tmp_path):
    """It ends at once, the springs are slack, and the step can be done again."""
    files = f"--out {tmp_path}/out.ini --page {tmp_path}/page.html --record {tmp_path}/record.ini"
    out = in_stand(f"""
        {commission(tmp_path, "--step", "identify", "--step", "rest")}
        for signal in INT KILL; do
            {BUILD}/afo commission --can vcan0 --device {DEVICE} {files} --step moves </dev/null >{tmp_path}/$signal 2>&1 & tool=$!
            until candump -n 1 vcan0,290:7FF | grep -q '\\]  07 '; do :; done   # a second tool would disturb it
            kill -$signal $tool; wait $tool; echo "$signal $?"
            until {BUILD}/afo ctl --can vcan0 get supervisor_state | grep -q standby; do :; done
            {BUILD}/afo ctl --can vcan0 get measured.left_motor
        done
        {commission(tmp_path, "--step", "moves")}""")
    assert "INT 1\n" in out and "KILL 137\n" in out, out
    assert re.search(r"moves +interrupted\n +interrupted; the controller unloads", (tmp_path / "INT").read_text())
    for found in re.findall(r"measured.left_motor = (\S+) m", out):
        assert abs(float(found)) < 1e-3, out
    assert len(re.findall("measured.left_motor", out)) == 2
    assert re.search(r"moves +passed", out), out


# Those that move a motor are struck when it is under way; the others wait for hands or for quiet.
INTERRUPTED = ("zero", "sensors", "latch", "spring", "bandwidth", "link")
MOVING = ("latch", "spring", "bandwidth", "link")


@pytest.mark.long
@pytest.mark.parametrize("step", INTERRUPTED)
def test_ctrl_c_and_kill_do_no_harm_in_any_step(tmp_path, step):
    """It ends at once, the springs are slack, the record is whole, and the next step can be done."""
    files = f"--out {tmp_path}/out.ini --page {tmp_path}/page.html --record {tmp_path}/record.ini"
    struck = "until candump -n 1 vcan0,290:7FF | grep -q '\\]  07 '; do :; done" if step in MOVING else "sleep 0.4"
    out = in_stand(f"""
        {commission(tmp_path, *HANDS, *LATER)}
        for signal in INT KILL; do
            mkfifo {tmp_path}/hands_$signal; exec 3<>{tmp_path}/hands_$signal; echo y >&3   # they answer once
            {BUILD}/afo commission --can vcan0 --device {DEVICE} {files} --step {step} <&3 >{tmp_path}/$signal 2>&1 & tool=$!
            {struck}
            kill -$signal $tool; wait $tool; echo "$signal $?"
            for _ in {{1..100}}; do
                {BUILD}/afo ctl --can vcan0 get supervisor_state | grep -q standby && break; sleep 0.1; done
            {BUILD}/afo ctl --can vcan0 get supervisor_state measured.left_motor measured.right_motor
        done
        {BUILD}/afo commission --list --can vcan0 --device {DEVICE} {files}
        {commission(tmp_path, "--step", "moves")}""")
    assert "INT 1\n" in out and "KILL 137\n" in out, out
    assert out.count("standby") == 2, out
    motors = re.findall(r"measured.(?:left|right)_motor = (\S+) m", out)
    assert len(motors) == 4 and all(abs(float(found)) < 1e-3 for found in motors), out
    assert re.search(r"moves +passed", out), out
    assert run("check", tmp_path / "out.ini", command="device").returncode == 0


def test_wrong_usage():
    for words, part in ((["--device", DEVICE], "--can"), (["--can", "vcan0"], "--device"),
                        (["--can", "x", "--device", DEVICE, "--step", "sprin"], "nearest: spring"),
                        (["--can", "x", "--device", DEVICE, "--skip", "zero"], "NAME=REASON"),
                        (["--can", "x", "--device", "/nowhere"], "/nowhere"),
                        (["--can", "x", "--device", DEVICE, "--out", DEVICE], "named twice"),
                        (["--can", "nocan9", "--device", DEVICE], "nocan9")):
        done = run(*words, command="commission")
        assert done.returncode == 2 and part in done.stderr, (words, done.stderr)
