#!/usr/bin/env python3
"""Makes the paper's page for any walker; started by `afo study page`, which has checked all it is told."""
import argparse
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

EXIT_GOOD, EXIT_BAD, EXIT_USAGE = 0, 1, 2


def main(arguments):
    parser = argparse.ArgumentParser(prog="afo study page", description=__doc__, allow_abbrev=False)
    parser.add_argument("--afo", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--who", required=True)
    parser.add_argument("--command", required=True)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("walker", type=float, nargs=5)
    options = parser.parse_args(arguments)
    try:
        import page_data
        import page_figures
        import walker_page
    except ImportError as error:
        print(f"afo study page: no figures without matplotlib and numpy ({error}); to install them: sudo apt-get install "
              "python3-matplotlib, or scripts/setup paper in a clone", file=sys.stderr)
        return EXIT_USAGE
    started = time.monotonic()
    print("  all figures and tables: a minute or two on two quiet cores", flush=True)
    try:
        study = page_data.Study(options.afo, options.out / "data", page_data.Walker(*options.walker))
        data = page_data.gather(study, options.quick)
        missing = page_figures.draw_all(data, options.out)
        walker_page.write(data, options.out, options.who, missing, options.command)
    except page_data.PageError as error:
        print(f"afo study page: {error}", file=sys.stderr)
        return EXIT_BAD
    except (ValueError, KeyError, IndexError) as error:
        print(f"afo study page: {options.afo}: its output is not what a study prints ({error})", file=sys.stderr)
        return EXIT_USAGE
    except OSError as error:
        print(f"afo study page: {error.filename}: {error.strerror}", file=sys.stderr)
        return EXIT_USAGE
    except KeyboardInterrupt:
        print("afo study page: broken off; the page was not written", file=sys.stderr)
        return 130
    print(f"  {options.out / 'index.html'}: {time.monotonic() - started:.0f} s")
    return EXIT_GOOD


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
