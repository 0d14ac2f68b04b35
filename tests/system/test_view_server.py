"""The server of afo view: who gets in, who harms nobody, what is recorded; without a browser."""
import contextlib
import json
import os
import resource
import signal
import socket
import sys
import threading
import urllib.error
import urllib.request

import numpy as np
import pytest
import websocket

from afo import AFO, ROOT, run
from viewer import PATIENCE_S, Talk, viewing, wait_until

sys.path.insert(0, str(ROOT / "sim_host" / "view"))
import trial as trial_module  # noqa: E402


@pytest.fixture(scope="module")
def view(tmp_path_factory):
    """One that may control, for all tests here that leave it as it was."""
    with viewing("--speed", "0.5", "--control", "--trials", tmp_path_factory.mktemp("trials")) as one:
        yield one


def get(view, path, headers=(), host=None):
    request = urllib.request.Request(f"http://{view.host}{path}", headers=dict(headers))
    if host:
        request.add_unredirected_header("Host", host)
    try:
        with urllib.request.urlopen(request, timeout=60) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()


# ---- who gets in ------------------------------------------------------------------------


def test_the_page_and_nothing_else_is_served(view):
    assert get(view, "/")[0] == get(view, "/main.js")[0] == get(view, "/uplot/LICENSE")[0] - 204 == 200
    for path in ("/../serve.py", "/%2e%2e/serve.py", "/..%2fserve.py", "/serve.py", "/page/index.html", "//etc/passwd", "/etc/passwd"):
        assert get(view, path)[0] in (403, 404), path
    headers = get(view, "/")[1]
    assert "default-src 'none'" in headers["Content-Security-Policy"] and headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example"])
def test_another_host_name_is_refused(view, host):
    """A page of somebody else whose name was made to lead here (DNS rebinding)."""
    assert get(view, "/", host=host)[0] == 403


def test_localhost_is_the_same(view):
    assert get(view, "/", host=f"localhost:{view.port}")[0] == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1", "https://127.0.0.1:443"])
def test_another_origin_is_refused(view, origin):
    with pytest.raises(websocket.WebSocketBadStatusException) as refusal:
        view.connect(origin=origin)
    assert refusal.value.status_code == 403


@pytest.mark.parametrize("token", ["x", "x" * 24, "%00", "ü"])
def test_without_the_token_there_is_no_socket(view, token):
    with pytest.raises((websocket.WebSocketBadStatusException, UnicodeError)) as refusal:
        view.connect(token=token)
    assert getattr(refusal.value, "status_code", 403) == 403


@pytest.mark.parametrize("path", ["/report?trial=x", "/export?trial=x&kind=csv", "/compare?a=x&b=y"])
def test_trials_need_the_token_and_are_no_paths(view, path):
    assert get(view, path)[0] == 403
    good = {"Authorization": f"Bearer {view.token}"}
    assert get(view, path, good)[0] == 404
    assert get(view, path.replace("=x", "=..%2f..%2fetc"), good)[0] == 404


def test_only_this_machine_is_listened_to(view):
    found = [line.split()[1] for line in open("/proc/net/tcp", encoding="ascii").read().splitlines()[1:]
             if line.split()[3] == "0A" and int(line.split()[1].split(":")[1], 16) == view.port]
    assert found == [f"0100007F:{view.port:04X}"]


# ---- what may be asked ---------------------------------------------------------------------


def test_nothing_can_be_changed_without_control():
    with viewing("--speed", "0.5") as view:
        talk = Talk(view)
        assert talk.hear()["control"] is False
        for what in ({"do": "write", "name": "parameters.kp_m_s_rad", "value": 0.04}, {"do": "request", "what": "stop"}, {"do": "undo"}):
            talk.ask(**what)
            talk.until(lambda m: m.get("type") == "refused", "refusal")


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"do": "eval"}', '{"do": "range"}', '{"do": "range", "first": "x", "last": 1e99}',
                                  '{"do": "write", "name": "parameters.kp_m_s_rad", "value": "NaN"}',
                                  '{"do": "write", "name": "state.latched_fault", "value": 0}',
                                  '{"do": "write", "name": ["x"], "value": 0}', '{"do": "request", "what": "__init__"}'])
def test_rubbish_is_refused_in_words(view, text):
    talk = Talk(view)
    talk.socket.send(text)
    assert talk.until(lambda m: m.get("type") == "refused", text)["text"]
    talk.close()


def test_a_change_is_read_back_dated_and_undone(view):
    talk = Talk(view)
    before = talk.until(lambda m: m.get("type") == "values" and "commands.desired_apex_speed" in m["values"], "values")["values"]
    assert before["commands.desired_apex_speed"] == 0.5
    talk.ask(do="write", name="commands.desired_apex_speed", value=0.52)
    talk.event("write", name="commands.desired_apex_speed", value=0.52, done=True)
    written = talk.until(lambda m: m.get("type") == "written", "read back")
    assert (written["before"], written["read"]) == (0.5, 0.52)
    talk.ask(do="undo")
    assert talk.until(lambda m: m.get("type") == "written", "undone")["read"] == 0.5
    talk.close()


def test_a_mark_gives_the_boards_pulse_with_control_only(view):
    """It is an SDO write of the mark's number, so its time is in the log; without control nothing is sent."""
    talk = Talk(view)
    talk.ask(do="mark", text="flash")
    number = talk.event("mark", text="flash")["number"]
    assert talk.event("write", name="commands.mark")["value"] == number
    talk.close()
    with viewing("--speed", "0.5") as other:
        looks = Talk(other)
        looks.ask(do="mark", text="flash")
        looks.event("mark")
        looks.event("step")
        assert not [one for one in looks.told if one.get("kind") == "write"]


def test_limits_are_refused_with_their_range(view):
    talk = Talk(view)
    talk.ask(do="write", name="parameters.kp_m_s_rad", value=2)
    assert "allowed is 0 to 1" in talk.until(lambda m: m.get("type") == "refused", "range")["text"]
    talk.ask(do="write", name="parameters.kp_m_s_rad", value=0.9)  # in range; this walker's gaits do not bear it
    assert "too high" in talk.until(lambda m: m.get("type") == "refused", "gait")["text"]
    talk.close()


# ---- who harms nobody -------------------------------------------------------------------------


def lines(path, kinds):
    with open(path, "rb") as stream:
        return [line for line in stream if any(kind in line for kind in kinds)]


def test_who_reads_no_errors_does_not_stop_the_server(tmp_path):
    """A pipe that is full already: whoever writes to it waits."""
    reading, writing = full_pipe()
    with viewing("--speed", "0.5", errors=writing) as view:
        with socket.create_connection(("127.0.0.1", view.port), timeout=5) as one:
            one.sendall(b"GET / HTTP/1.1\r\nX: " + b"y" * 20000)
            one.recv(1000)
        assert get(view, "/")[0] == 200
        view.process.send_signal(signal.SIGINT)
        assert view.process.wait(PATIENCE_S) == 0
    os.close(reading)
    os.close(writing)


def full_pipe():
    """(reading end, writing end): whoever writes to it waits."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writing, b"x" * 4096)
    os.set_blocking(writing, True)
    return reading, writing


def test_who_reads_no_errors_does_not_stop_the_walk(tmp_path):
    """The walk has something to complain of, too: its server was killed."""
    reading, writing = full_pipe()
    with viewing("--speed", "0.5", "--log", tmp_path / "v.log", errors=writing) as view:
        Talk(view).event("step")
        part = next(tmp_path.glob("*v.log*"))
        os.kill(view.server_pid(), signal.SIGKILL)
        size = part.stat().st_size
        wait_until(lambda: part.stat().st_size > size + 1000000, "the walk goes on")
        view.process.send_signal(signal.SIGINT)
        assert view.process.wait(PATIENCE_S) == 0
    os.close(reading)
    os.close(writing)


def test_browsers_that_are_stopped_do_not_hold_the_end(tmp_path):
    """They asked for all of the past and take none of it; the server ends all the same, by itself."""
    with viewing("--speed", "0.5") as view:
        stalled = [Talk(view) for _ in range(4)]
        stalled[0].event("step")
        for talk in stalled:
            talk.ask(do="range", first=0, last=100000)
        view.process.send_signal(signal.SIGINT)
        assert view.process.wait(PATIENCE_S) == 0
        assert "killed" not in view.process.stderr.read()


def test_a_disk_that_hangs_holds_nobody(tmp_path, monkeypatch):
    """The recorder's thread hangs in the disk; who gives it records is never held, and is not drowned in memory."""
    hangs = threading.Event()
    monkeypatch.setattr(trial_module.Recorder, "_sync", lambda self: hangs.wait())
    monkeypatch.setattr(trial_module, "WAITING_MAX", 5000)
    recorder = trial_module.Recorder(tmp_path, {"subject_code": ""}, lambda text: None, False)
    recorder.start()
    one = np.frombuffer(trial_module.frames.record(0x80, b"") * 100, trial_module.frames.RECORD)
    wait_until(lambda: recorder.take(one) or recorder.lacks, "it says that frames are missing")
    assert recorder.waiting <= 5100
    hangs.set()
    assert "did not keep up" in recorder.close() and "did not keep up" in (recorder.folder / "INCOMPLETE").read_text()


def test_a_stopped_server_does_not_hold_the_walks_end(tmp_path):
    with viewing("--speed", "0.8", "--log", tmp_path / "v.log") as view:
        Talk(view).event("step")
        pid = view.server_pid()
        os.kill(pid, signal.SIGSTOP)
        view.process.send_signal(signal.SIGINT)
        assert view.process.wait(PATIENCE_S) == 0
        assert "it is killed" in view.process.stderr.read()
        assert not os.path.exists(f"/proc/{pid}") and (tmp_path / "v.log").stat().st_size > 100000


def test_who_asks_too_often_is_sent_away(view):
    talk = Talk(view)
    sent_away = False
    try:
        for _ in range(2000):
            talk.socket.send('{"do": "range", "first": 0, "last": 0}')
        while talk.socket.recv():
            pass
        sent_away = True
    except websocket.WebSocketTimeoutException:
        pass
    except (OSError, websocket.WebSocketException):
        sent_away = True  # the connection ended while it was sending or reading
    assert sent_away


def test_other_browsers_go_on_beside_a_stalled_one(view):
    stalled, good = Talk(view), Talk(view)
    for _ in range(150):
        good.hear()
    assert good.rows > 1000
    assert good.lost == 0 or any(told["type"] == "skipped" for told in good.told)  # on a machine that is overloaded
    stalled.socket.shutdown()
    good.close()


# ---- what is recorded ----------------------------------------------------------------------------


def one_folder(root):
    return wait_until(lambda: next(iter(root.glob("*/trial.json")), None), "a trial").parent


def record_with_changes(view, talk, changes):
    talk.ask(do="record", on=True, subject="P07", note="with changes")
    talk.until(lambda m: m.get("type") == "recorder" and m["recorder"], "recording")
    for number in range(changes):
        speed = 0.5 + 0.01 * (number % 5)
        talk.ask(do="write", name="commands.desired_apex_speed", value=speed)
        talk.until(lambda m: m.get("type") == "written", "written")
    talk.ask(do="mark", text="fünfzig")
    talk.event("mark")
    talk.ask(do="record", on=False)
    talk.until(lambda m: m.get("type") == "trials" and m["trials"][0]["complete"], "ended")


def test_a_trial_with_fifty_changes_replays_bit_for_bit(tmp_path):
    with viewing("--speed", "0.5", "--control", "--trials", tmp_path) as view:
        talk = Talk(view)
        talk.event("step")
        record_with_changes(view, talk, 50)
        folder = one_folder(tmp_path)
    done = run("--speed", "0.5", folder / "bus.log", command="replay")
    assert done.returncode == 0 and "reproduced" in done.stdout, done.stdout + done.stderr
    events = [json.loads(line) for line in open(folder / "events.jsonl", encoding="utf-8")]
    writes = [event for event in events if event["kind"] == "write" and event["done"]]
    assert len(writes) == 50 and [event["text"] for event in events if event["kind"] == "mark"] == ["fünfzig"]
    assert not (folder / "INCOMPLETE").exists()
    told = json.loads((folder / "trial.json").read_text())
    assert told["subject_code"] == "P07" and len(told["parameters"]) > 30 and int(told["build_id"], 16)


def test_a_killed_server_leaves_a_marked_trial(tmp_path):
    with viewing("--speed", "0.5", "--control", "--trials", tmp_path, "--log", tmp_path / "whole.log") as view:
        talk = Talk(view)
        talk.event("step")
        talk.ask(do="record", on=True)
        talk.until(lambda m: m.get("type") == "recorder", "recording")
        talk.event("step")
        folder = one_folder(tmp_path)
        wait_until(lambda: talk.event("step")["tick"] / 1000 - last_s(folder / "bus.log") <= 1.0, "the disk has all but a second")
        kept = last_s(folder / "bus.log")
        os.kill(view.server_pid(), signal.SIGKILL)
    assert (folder / "INCOMPLETE").read_text()
    assert last_s(folder / "bus.log") >= kept
    assert run("--speed", "0.5", cut_whole(folder / "bus.log"), command="replay").returncode == 0
    report = run(folder, "--out", tmp_path / "r.html", command="report")
    assert report.returncode == 0 and "incomplete" in (tmp_path / "r.html").read_text()


def last_s(path):
    """The time of the last whole line of a log, s; before there is one, long ago."""
    whole = [line for line in path.read_bytes()[-4096:].splitlines(keepends=True)[1:] if line.endswith(b"\n")]
    return float(whole[-1][1:18]) if whole else -1e9


def cut_whole(path):
    """A copy without the line that the kill cut short."""
    data = path.read_bytes()
    other = path.with_suffix(".whole")
    other.write_bytes(data[:data.rindex(b"\n") + 1])
    return other


def test_a_full_disk_ends_the_trial_and_says_so(tmp_path):
    """The limit on a file's size stands for the disk: writes fail in the same place."""
    def small():
        resource.setrlimit(resource.RLIMIT_FSIZE, (400000, 400000))
    with viewing("--speed", "0.5", "--trials", tmp_path, preexec_fn=small) as view:
        talk = Talk(view)
        talk.ask(do="record", on=True)
        assert "incomplete" in talk.until(lambda m: m.get("type") == "trouble", "trouble")["text"]
        talk.event("step")  # and the walk goes on
        folder = one_folder(tmp_path)
        assert (folder / "INCOMPLETE").exists() and 0 < (folder / "bus.log").stat().st_size <= 400000


def test_a_packet_begins_and_ends_a_recording(tmp_path):
    with viewing("--speed", "0.5", "--trials", tmp_path) as view, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.settimeout(PATIENCE_S)

        def say(text):
            udp.sendto(text.encode(), ("127.0.0.1", view.port))
            return udp.recv(1000).decode()
        talk = Talk(view)
        talk.until(lambda m: m.get("type") == "hello", "the server is up")
        talk.close()
        udp.sendto(b"wrong start P1", ("127.0.0.1", view.port))
        assert say(f"{view.token} stop").startswith("refused")  # the wrong one began nothing
        assert say(f"{view.token} start CAM3") == "done"
        assert say(f"{view.token} mark flash") == "done"
        assert say(f"{view.token} stop") == "done"
        folder = one_folder(tmp_path)
        wait_until(lambda: not (folder / "INCOMPLETE").exists(), "ended")
    assert folder.name.endswith("CAM3") and "flash" in (folder / "events.jsonl").read_text()


def test_a_name_is_no_code(view):
    talk = Talk(view)
    talk.ask(do="record", on=True, subject="../../etc")
    assert "no name" in talk.until(lambda m: m.get("type") == "refused", "refusal")["text"]
    talk.close()


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    root = tmp_path_factory.mktemp("kept")
    with viewing("--speed", "0.5", "--control", "--trials", root) as view:
        talk = Talk(view)
        talk.ask(do="record", on=True, subject="P1")
        for _ in range(4):
            talk.event("step")
        talk.ask(do="record", on=False)
        talk.until(lambda m: m.get("type") == "trials" and m["trials"][0]["complete"], "ended")
    return one_folder(root)


def test_exports_are_read_by_other_libraries(trial, tmp_path):
    for kind in ("csv", "parquet", "mcap"):
        assert run(trial, "--export", kind, "--out", tmp_path / f"x.{kind}", command="report").returncode == 0
    import pandas
    import pyarrow.parquet
    table = pandas.read_csv(tmp_path / "x.csv")
    told = json.loads((tmp_path / "x.csv.json").read_text(encoding="utf-8"))
    assert list(told["units"]) == list(table.columns) and told["units"]["spring_force_left"] == "N" and told["parameters"]
    parquet = pyarrow.parquet.read_table(tmp_path / "x.parquet")
    assert parquet.num_rows == len(table) == len(lines(trial / "bus.log", (b" 080#",))) - 1
    assert parquet.schema.field("spring_force_left").metadata[b"unit"] == b"N" and b"build_id" in parquet.schema.metadata[b"provenance"]
    assert np.allclose(parquet["leg_angle_left"].to_numpy(), table["leg_angle_left"], atol=1e-6)
    from mcap.reader import make_reader
    with open(tmp_path / "x.mcap", "rb") as stream:
        reader = make_reader(stream)
        found = [json.loads(message.data)["leg_angle_left"] for _, _, message in reader.iter_messages(topics=["/afo/legs"])]
    assert np.allclose(found, table["leg_angle_left"], atol=1e-6)


def test_a_report_needs_nothing_else(trial, tmp_path):
    assert run(trial, "--out", tmp_path / "r.html", command="report").returncode == 0
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    for part in ("<h2>By step</h2>", "Strides, averaged", "Symmetry", "Faults", "Changes", "energy a push", "P1"):
        assert part in text
    assert "<script" not in text and "http://" not in text and "https://" not in text
    both = run(trial, trial, "--out", tmp_path / "c.html", command="report")
    assert both.returncode == 0 and "difference" in (tmp_path / "c.html").read_text(encoding="utf-8")


def test_what_is_no_trial_is_said():
    done = run("/nowhere", command="report")
    assert done.returncode == 2 and "no folder of a trial" in done.stderr
    assert AFO.name == "afo"
