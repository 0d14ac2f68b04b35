"""What `make flash` writes: settings that the firmware reads, at the address it reads them from."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]


def make(*arguments, path):
    environment = {"PATH": path, "HOME": "/"}
    return subprocess.run(["/usr/bin/make", "-n", "--no-print-directory", *arguments], cwd=ROOT, env=environment,
                          capture_output=True, text=True)


def test_the_settings_go_where_the_store_looks():
    registers = (ROOT / "hal/port_stm32g474/flash_registers.h").read_text()
    store = (ROOT / "hal/port_stm32g474/flash_store.h").read_text()
    base = int(re.search(r"FLASH_MEMORY_BASE (0x[0-9A-Fa-f]+)u", registers).group(1), 16)
    bank = int(re.search(r"FLASH_BANK_BYTES (0x[0-9A-Fa-f]+)u", registers).group(1), 16)
    page = int(re.search(r"FLASH_PAGE_BYTES (\d+)u", registers).group(1))
    first = int(re.search(r"FLASH_STORE_FIRST_PAGE = (\d+)", store).group(1))
    pages = int(re.search(r"FLASH_STORE_PAGES = (\d+)", store).group(1))
    place = int(re.search(r"SETTINGS_AT_\w+ := (0x\w+)", (ROOT / "firmware/boards/nucleo_g474re/board.mk").read_text()).group(1), 16)
    assert place == base + bank + first * page
    words = int(re.search(r"SETTINGS_IMAGE_WORDS = (\d+)", (ROOT / "sim_host/subjects/settings_image.h").read_text()).group(1))
    assert words * 8 == pages * page


def test_the_image_holds_two_banks_and_the_store_s_magic(tmp_path):
    out = tmp_path / "settings.bin"
    result = subprocess.run([str(ROOT / "build/afo"), "settings", "--person", "sim_host/persons/adult70.ini", "--device",
                             "sim_host/devices/virtual-adult.ini", "--speed",
                             "1.0", str(out)], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    image = out.read_bytes()
    assert len(image) == 8192
    assert image[:4] == b"PAFO" and image[4096:] == b"\xff" * 4096
    for device in ("ak80", "odrive"):  # the board speaks every protocol
        subprocess.run([str(ROOT / "build/afo"), "settings", "--device", f"sim_host/devices/{device}.ini", str(out)],
                       cwd=ROOT, check=True)


def test_a_person_is_always_asked(tmp_path):
    person = tmp_path / "person.ini"
    text = (ROOT / "sim_host/persons/adult70.ini").read_text()
    person.write_text(text)
    out = tmp_path / "settings.bin"
    command = [str(ROOT / "build/afo"), "settings", "--person", str(person), "--device",
               "sim_host/devices/virtual-adult.ini", str(out)]
    assert subprocess.run([*command, "--autostart"], cwd=ROOT, capture_output=True).returncode == 0
    person.write_text(text + "\n[prescription]\nengage_steps = 4\n")
    out.unlink()
    result = subprocess.run([*command, "--autostart"], cwd=ROOT, capture_output=True, text=True)
    assert result.returncode == 2 and "engage_steps" in result.stderr, result.stderr
    assert not out.exists()
    assert subprocess.run(command, cwd=ROOT, capture_output=True).returncode == 0


def test_the_crash_record_lies_where_every_build_looks_for_it():
    """Its address is a promise to images of other builds, like the layout that its magic names."""
    for image in ("afo-nucleo-g474re", "afo-mps2-an386"):
        text = subprocess.run(["arm-none-eabi-nm", str(ROOT / "build/arm" / f"{image}.elf")], capture_output=True, text=True,
                              check=True).stdout
        assert [line.split()[0] for line in text.splitlines() if line.endswith(" crash_record")] == ["2000ff00"]


def test_both_programmers_write_settings_and_image():
    text = make("flash", "PERSON=sim_host/persons/paper.ini", "DEVICE=sim_host/devices/virtual.ini", path="/usr/bin:/bin").stdout
    assert "afo settings --person 'sim_host/persons/paper.ini' --device 'sim_host/devices/virtual.ini'" in text
    assert "settings.bin 0x0807E000 verify" in text and "st-flash write build/arm/settings.bin 0x0807E000" in text
    assert "settings" not in make("flash", path="/usr/bin:/bin").stdout.split("command -v")[-1]


def test_the_debugger_stops_the_watchdog_and_the_clock():
    """RM0440, DBGMCU_APB1FZR1 at 0xE0042008: TIM2 is bit 0, the independent watchdog bit 12."""
    text = make("debug", path="/usr/bin:/bin").stdout
    assert f"set {{unsigned}}0xE0042008 = {1 << 12 | 1 << 0:#x}" in text


def test_the_programmer_s_work_area_lies_on_nothing_that_is_kept():
    """Black box and crash record must outlive a programmer or a debugger that comes to look at them."""
    board = ROOT / "firmware/boards/nucleo_g474re"
    text = (board / "openocd.cfg").read_text()
    area = re.search(r"-work-area-phys (0x\w+) -work-area-size (0x\w+)", text)
    assert text.index("source [find target/stm32g4x.cfg]") < area.start()  # whose own setting it replaces
    begin, size = (int(number, 16) for number in area.groups())
    assert 0x20000000 <= begin and begin + size <= 0x20020000  # DS12288: 128 KiB, CCM SRAM included
    kept = re.findall(r"(\w+) \(rw\) : ORIGIN = (0x\w+), LENGTH = (\d+)(K?)", (board / "link.ld").read_text())
    kept = [(int(origin, 16), int(length) * (1024 if kilo else 1)) for name, origin, length, kilo in kept if name != "RAM"]
    assert len(kept) == 2
    # stlink, src/stlink-lib/flash_loader.c: the loader at the beginning of RAM, some 100 bytes, behind it up to 0x8000.
    for at, length in ((begin, size), (0x20000000, 0x8000 + 0x400)):
        assert all(at + length <= origin or at >= origin + bytes_kept for origin, bytes_kept in kept)
    for target in ("flash", "debug"):
        command = make(target, path="/usr/bin:/bin").stdout
        assert "-f firmware/boards/nucleo_g474re/openocd.cfg" in command and "target/stm32g4x" not in command
