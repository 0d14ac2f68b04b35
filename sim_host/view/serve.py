#!/usr/bin/env python3
"""The server behind `afo view`; started by it. One page, one web socket, nothing else."""
import argparse
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
EXIT_USAGE = 2
NEEDED = (("aiohttp", "python3-aiohttp", None), ("numpy", "python3-numpy", None), ("cantools", None, "cantools"),
          ("canopen", None, "canopen"), ("can", None, "python-can"))


def complain(text):
    print(f"afo view: {text}", file=sys.stderr, flush=True)


def missing_packages():
    """What cannot be imported, with the command that installs it."""
    missing = []
    for module, debian, pypi in NEEDED:
        try:
            __import__(module)
        except ImportError as error:
            command = f"sudo apt-get install {debian}" if debian else f"VENV/bin/pip install {pypi}, with AFO_PYTHON=VENV/bin/python"
            missing.append(f"the Python package {module} is missing ({error}): scripts/setup view, or {command}")
    return missing


def options_of(arguments):
    parser = argparse.ArgumentParser(prog="afo view", description=__doc__)
    parser.add_argument("--afo", required=True)
    parser.add_argument("--subject", required=True)
    parser.add_argument("--fd", type=int)
    parser.add_argument("--can")
    parser.add_argument("--replay")
    parser.add_argument("--port", type=int, default=8021)
    parser.add_argument("--listen", default="127.0.0.1")
    parser.add_argument("--names", default="")
    parser.add_argument("--trials", default="trials")
    parser.add_argument("--control", action="store_true")
    return parser.parse_args(arguments)


def main(arguments):
    options = options_of(arguments)
    missing = missing_packages()
    for text in missing:
        complain(text)
    if missing:
        return EXIT_USAGE
    import complaints
    import web  # behind the check of what it needs
    heard = complaints.gather()
    try:
        return web.run(options, json.loads(options.subject), heard.say)
    finally:
        heard.end()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
