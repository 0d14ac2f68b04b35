"""The page of afo view in headless Chromium: as a person uses it, by keyboard; pictures lie in build/view."""
import json
import pathlib

import pandas
import pytest

from afo import run
from chromium import By, Keys, Page, browser, prefer, selenium  # noqa: F401
from viewer import viewing, wait_until


@pytest.fixture(scope="module")
def walking(tmp_path_factory):
    with viewing("--speed", "0.5", "--control", "--trials", tmp_path_factory.mktemp("trials")) as view:
        yield view


@pytest.fixture(scope="module")
def page(browser, walking):
    return Page(browser, walking)


def test_it_walks(page):
    """The figure moves on, every tick is there, sixteen signals and more are drawn."""
    before, tick = page.figure(), page.js("return afo.store.next")
    page.until(f"return afo.store.next > {tick} + 3000 && afo.draw.drawn > 2000", "three seconds more")
    assert page.figure() != before
    # On a machine that is overloaded ticks are left out for the browser, and it is told.
    assert page.js("return afo.store.stats.lost === 0 || afo.skipped > 0 || afo.hellos > 1")
    assert page.js("return document.querySelectorAll('#charts .u-legend .u-series').length") >= 16 + 5
    assert page.js("return afo.store.value('hip_x', afo.store.next - 1) > afo.store.value('hip_x', afo.store.next - 2500)")
    page.until_text("#state", "walking")
    assert "steps/min" in page.text("#facts") and "J a step" in page.text("#facts")
    assert page.complaints() == []


def test_it_says_that_stop_is_no_emergency_stop(page):
    assert "no emergency stop" in page.text("#no-emergency-stop")
    red = page.js("return getComputedStyle(document.getElementById('no-emergency-stop')).color")
    r, g, b = (int(one) for one in red[4:-1].split(",")[:3])
    assert r > 2 * g or r > g + 80 > b


def test_the_slider_changes_the_speed(page, walking):
    """By the keyboard; what the walker does is read off its own leg at the apex, not off the controller's word."""
    page.until("return !document.getElementById('speed').disabled", "the speed is known")
    assert page.js("return Number(document.getElementById('speed').value)") == pytest.approx(0.5)
    page.tab_to("speed", "tune")
    page.keys(Keys.ARROW_RIGHT * 4)
    page.until_text("#write-outcome", "read back 0.52")
    page.until_text("#changes", "desired_apex_speed = 0.52")
    page.until_text("#speed-verdict", "settled")
    rate = """
        const s = afo.store;
        for (let t = s.next - 10; t > s.first + 10; t--) {
          if (s.value("double_support", t)) continue;
          const side = s.value("stance", t) === 1 ? "right" : "left";
          const a = s.value(`leg_angle_${side}`, t - 5), b = s.value(`leg_angle_${side}`, t + 5);
          if (a > 0 && b <= 0) return (a - b) / 0.01;
        }"""
    wait_until(lambda: page.js(rate) == pytest.approx(0.52, abs=0.01), "the leg turns so fast at the apex")
    page.js("document.activeElement.blur()")
    page.keys("z")
    page.until_text("#write-outcome", "read back 0.5")


def test_pause_zoom_and_cursor(page):
    page.js("document.activeElement.blur()")
    page.keys(" ")
    clock = page.text("#clock").split(" of ")[0]
    page.keys(Keys.ARROW_LEFT * 3)
    page.until("return afo.paused", "paused")
    wait_until(lambda: page.text("#clock").split(" of ")[0] != clock, "the clock goes back")
    page.keys("+", "+")
    assert page.js("return afo.windowS") == 1
    over = page.browser.find_element(By.CSS_SELECTOR, "#charts .u-over")
    selenium.ActionChains(page.browser).move_to_element(over).perform()
    page.until("return /\\d rad/.test(document.querySelector('#charts .u-legend').innerText)", "values at the cursor")
    page.keys("-", "-", Keys.END)
    page.until("return !afo.paused", "goes on")


def test_mark_keep_report(page, walking, tmp_path):
    """By keyboard: record, mark, end; the report is opened and read; the record replays."""
    page.focus("subject-code").send_keys("P12")
    page.js("document.activeElement.blur()")
    page.keys("r")
    page.until_text("#record-state", "P12")
    page.focus("mark-text").send_keys("stumbled", Keys.ENTER)
    page.until_text("#event-list", "stumbled")
    tick = page.js("return afo.store.next")
    page.until(f"return afo.store.next > {tick} + 4000", "four seconds")
    page.js("document.activeElement.blur()")
    page.keys("r")
    page.until("return document.querySelector('#trials tbody tr')?.innerText.includes('P12') && "
               "!document.querySelector('#trials tbody').innerText.includes('incomplete')", "kept")
    page.browser.find_element(By.CSS_SELECTOR, "#trials button[aria-label^='Report']").send_keys(Keys.ENTER)
    page.until("return document.querySelector('dialog .report')?.innerText.includes('By step')", "report")
    report = page.text("dialog .report")
    assert "stumbled" in report and "energy a push" in report
    page.picture("report")
    page.keys(Keys.ESCAPE)
    page.until("return !document.querySelector('dialog')", "closed")
    page.js("scrollTo(0, 0)")
    folder = next(pathlib.Path(walking.process.args[walking.process.args.index("--trials") + 1]).glob("*P12"))
    assert run("--speed", "0.5", folder / "bus.log", command="replay").returncode == 0
    page.picture("live-light")


def test_a_table_is_saved_with_what_it_is_of(page, tmp_path):
    """One key saves two files: pandas reads the table, and the JSON beside it has every column's unit."""
    page.browser.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)})
    page.browser.find_element(By.CSS_SELECTOR, "#trials button[aria-label$='as csv']").send_keys(Keys.ENTER)
    wait_until(lambda: len(list(tmp_path.glob("*.csv")) + list(tmp_path.glob("*.csv.json"))) == 2, "both files are saved")
    page.until_text("#keep-outcome", ".csv.json is saved")
    table = pandas.read_csv(next(tmp_path.glob("*.csv")))
    about = json.loads(next(tmp_path.glob("*.csv.json")).read_text())
    assert len(table) > 4000 and set(table.columns) == set(about["units"])


def test_compare_two_trials(page):
    """A second trial, and both over each other."""
    page.js("document.activeElement.blur()")
    page.keys("r")
    page.until_text("#record-state", "Recording into")
    tick = page.js("return afo.store.next")
    page.until(f"return afo.store.next > {tick} + 2500", "two strides")
    page.focus("record").send_keys(Keys.ENTER)
    page.until("return document.querySelectorAll('#trials tbody tr').length === 2 && "
               "!document.querySelector('#trials tbody').innerText.includes('incomplete')", "two trials")
    for box in page.browser.find_elements(By.CSS_SELECTOR, "#trials input"):
        box.send_keys(" ")
    page.focus("compare").send_keys(Keys.ENTER)
    page.until("return document.querySelector('dialog .report')?.innerText.includes('difference')", "compared")
    page.picture("compare")
    page.keys(Keys.ESCAPE)
    page.until("return !document.querySelector('dialog')", "closed")


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_dark_and_light(page, scheme):
    prefer(page.browser, scheme)
    back = page.js("return getComputedStyle(document.body).backgroundColor")
    assert (sum(int(one) for one in back[4:-1].split(",")[:3]) < 200) == (scheme == "dark")
    drawn = page.js("return afo.draw.drawn")
    page.until(f"return afo.draw.drawn > {drawn} + 500", "drawn in these colours")
    page.js("scrollTo(0, 0)")
    page.picture(f"live-{scheme}")


def test_a_phones_width(page):
    page.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                 {"width": 360, "height": 740, "deviceScaleFactor": 2, "mobile": True})
    page.until("return innerWidth === 360", "narrow")
    page.js("scrollTo(0, 0)")
    page.until("return document.documentElement.scrollWidth <= 360", "nothing is wider than the screen")
    drawn = page.js("return afo.draw.drawn")
    page.until(f"return afo.draw.drawn > {drawn} + 500", "drawn")
    page.picture("phone")
    small = page.js("return [...document.querySelectorAll('button, select')].filter((b) => b.offsetParent && b.offsetHeight < 30 && "
                    "!b.closest('#event-list')).length")
    assert small == 0
    page.browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


@pytest.fixture(scope="module")
def broken(tmp_path_factory):
    """The log of a walk that lost its drives at step 4."""
    path = tmp_path_factory.mktemp("broken") / "b.log"
    run("--speed", "0.5", "--steps", "12", "--fault", "cut-drives", "--fault-step", "4", "--log", path, "--quiet")
    return path


def test_a_fault_in_words_by_the_replays_slider(browser, broken):
    with viewing("--replay", broken) as view:
        page = Page(browser, view)
        button = wait_until(lambda: browser.find_elements(By.CSS_SELECTOR, "#event-list button.bad"), "a fault among the events")[0]
        assert "drive silent" in button.text and "cable" in button.text
        total = page.js("return afo.total")
        page.focus("slider")
        page.keys(Keys.HOME)
        page.until("return afo.head === 0", "the beginning")
        page.keys(Keys.END)
        page.until(f"return afo.head === {total - 1} && afo.store.has(afo.head)", "the end")
        end = page.figure()
        button.send_keys(Keys.ENTER)
        page.until(f"return afo.head < {total - 1} && afo.store.has(Math.floor(afo.head))", "at the fault")
        wait_until(lambda: page.figure() != end, "another pose")
        page.js("document.activeElement.blur()")
        page.keys(Keys.HOME, " ")
        page.until("return afo.head > 2500", "it plays")
        page.until_text("#state", "walking")
        page.picture("replay")
        button.send_keys(Keys.ENTER)
        page.until_text("#fault-todo", "cable")
        page.picture("fault")
        assert page.complaints() == []


def test_the_address_keeps_no_token(page, walking, browser):
    assert walking.token not in browser.execute_script("return location.href")
