"""scripts/release: one folder with the images, their hashes and a bill of materials; another image is refused."""
import json
import pathlib
import shutil
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAME = "afo-nucleo-g474re"


def release(build, *options):
    return subprocess.run([str(ROOT / "scripts/release"), "--build", str(build), "--version", "1.2.3", "--build-id", "0xABC", *options],
                          cwd=ROOT, capture_output=True, text=True)


def copy_of_the_build(folder):
    (folder / "arm").mkdir(parents=True)
    for suffix in ("bin", "elf", "hex", "map"):
        shutil.copy(ROOT / "build/arm" / f"{NAME}.{suffix}", folder / "arm")
    return folder


def test_the_folder_is_whole_and_its_hashes_are_right(tmp_path):
    build = copy_of_the_build(tmp_path / "build")
    result = release(build, "--again", str(copy_of_the_build(tmp_path / "again")))
    assert result.returncode == 0, result.stderr
    folder = build / "release/1.2.3"
    assert {path.name for path in folder.iterdir()} == {f"{NAME}.bin", f"{NAME}.elf", f"{NAME}.hex", f"{NAME}.map", f"{NAME}.update",
                                                        "bom.json", "SHA256SUMS"}
    subprocess.run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=folder, check=True, capture_output=True)
    assert (folder / f"{NAME}.update").read_bytes() == (folder / f"{NAME}.bin").read_bytes()[0x2000:]
    bill = json.loads((folder / "bom.json").read_text())
    assert bill["metadata"]["component"]["version"] == "1.2.3"
    names = [component["name"] for component in bill["components"]]
    assert "controller/controller.c" in names
    assert not [name for name in names if name.endswith(".a")], "the image took a compiler's library: say so in firmware/README.md"


def test_a_library_of_the_compiler_is_in_the_bill(tmp_path):
    """The map as GNU ld writes it: what was linked, then what was thrown away."""
    build = copy_of_the_build(tmp_path / "build")
    taken = "/usr/lib/arm-none-eabi/newlib/thumb/v7e-m+fp/hard/libc.a(lib_a-memmove.o)\n"
    left = "/usr/lib/gcc/arm-none-eabi/12.2.1/thumb/v7e-m+fp/hard/libgcc.a(_divdi3.o)\n"
    (build / "arm" / f"{NAME}.map").write_text(f"Archive member included to satisfy reference by file (symbol)\n\n{taken}"
                                               f"\nDiscarded input sections\n\n .text {left}")
    result = release(build)
    assert result.returncode == 0, result.stderr
    bill = json.loads((build / "release/1.2.3/bom.json").read_text())
    archives = {component["name"]: component["properties"][0]["value"] for component in bill["components"] if component["name"].endswith(".a")}
    assert archives == {"libc.a": "memmove.o"}


def test_another_image_from_the_same_sources_is_refused(tmp_path):
    build, again = copy_of_the_build(tmp_path / "build"), copy_of_the_build(tmp_path / "again")
    image = again / "arm" / f"{NAME}.bin"
    content = image.read_bytes()
    image.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    result = release(build, "--again", str(again))
    assert result.returncode == 1 and "another image" in result.stderr
    assert not (build / "release").exists()


def test_without_an_image_it_says_what_to_do(tmp_path):
    result = release(tmp_path)
    assert result.returncode == 1 and "make firmware" in result.stderr
