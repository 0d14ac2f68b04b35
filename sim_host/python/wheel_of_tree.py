"""What pip calls to build the package (PEP 517): make assembles it, this puts it into a wheel.

The C code lies in other rooms of the tree, so there is no source archive: the package is built in a clone.
"""
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import zipfile

ROOM = pathlib.Path(__file__).resolve().parent
TREE = ROOM.parents[1]
LICENSE = TREE / "LICENSE"


class CannotBuild(SystemExit):
    """Why there is no wheel, and what to do."""


def listed(name, text):
    """The strings of a list in pyproject.toml; tomllib is newer than some Pythons that are served."""
    return re.findall(r'"([^"]+)"', re.search(rf"^{name} = \[(.*)\]$", text, re.MULTILINE)[1])


def value(name, text):
    return re.search(rf'^{name} = "(.*)"$', text, re.MULTILINE)[1]


def build_folder():
    return pathlib.Path(os.environ.get("AFO_BUILD", TREE / "build")).resolve()


def assemble():
    """The folder of the assembled package."""
    compiler = os.environ.get("CC", "gcc").split()[-1]
    missing = [tool for tool in ("make", compiler) if shutil.which(tool) is None]
    if missing:
        raise CannotBuild(f"afo is C code, and {' and '.join(missing)} is not here to compile it. "
                          "Install it: sudo apt-get install gcc libc6-dev make")
    build = build_folder()
    command = ["make", "--no-print-directory", f"BUILD={os.path.relpath(build, TREE)}", "python-package"]
    environment = {name: text for name, text in os.environ.items() if name not in ("MAKEFLAGS", "MAKELEVEL", "MFLAGS")}
    if "CC" in os.environ:
        command.append(f"CC={os.environ['CC']}")
    done = subprocess.run(command, cwd=TREE, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", check=False)
    if done.returncode != 0:
        raise CannotBuild(f"{' '.join(command)} failed in {TREE}:\n{done.stdout[-2000:]}")
    return build / "python" / "afo"


def version_of(package):
    said = subprocess.run([package / "system/bin/afo", "--version"], capture_output=True, text=True, check=True).stdout
    return re.search(r"\d+\.\d+\.\d+(?:\+[a-z0-9.]+)?", said)[0]


def metadata(version, text):
    extras = listed("logs", text)
    return "\n".join(["Metadata-Version: 2.1", f"Name: {value('name', text)}", f"Version: {version}",
                      f"Summary: {value('description', text)}", f"License: {value('license', text)}",
                      f"Requires-Python: {value('requires-python', text)}",
                      *(f"Requires-Dist: {one}" for one in listed("dependencies", text)), "Provides-Extra: logs",
                      *(f'Requires-Dist: {one}; extra == "logs"' for one in extras)]) + "\n"


def digest(data):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    package = assemble()
    version, text = version_of(package), (ROOM / "pyproject.toml").read_text(encoding="utf-8")
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    info, tag = f"afo-{version}.dist-info", f"py3-none-{platform}"
    name = f"afo-{version}-{tag}.whl"
    files = {f"afo/{path.relative_to(package)}": path.read_bytes() for path in sorted(package.rglob("*"))
             if path.is_file() and "__pycache__" not in path.parts}
    files[f"{info}/METADATA"] = metadata(version, text).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: afo\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    files[f"{info}/LICENSE"] = LICENSE.read_bytes()
    record = "".join(f"{path},{digest(data)},{len(data)}\n" for path, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path)
            entry.external_attr = (0o755 if path.endswith(("bin/afo", ".so")) else 0o644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise CannotBuild("afo has no source archive: its C code lies in the whole tree. In a clone: pip install sim_host/python")


if __name__ == "__main__":
    print(build_wheel(sys.argv[1]))
