#!/usr/bin/env python3
"""What Python costs: strides per second of afo.return_map beside the engine's own, in the same number of walkers.

Both walk the paper's gait at 1e-9 on one core, by turns, so that a busy machine slows both alike; processor time, the
fastest of all turns counts. Prints one remark for the table of bench-strides, and exits with 1 where the share is below
LEAST.

Usage: bench_python.py BUILD REFERENCE.csv [SECONDS]     (of one turn; default 0.4)
"""
import pathlib
import subprocess
import sys
import time

import numpy

TURNS = 5
LEAST = 0.9


def main(arguments):
    build, reference = pathlib.Path(arguments[0]), arguments[1]
    seconds = float(arguments[2]) if len(arguments) > 2 else 0.4
    sys.path.insert(0, str(build / "python"))
    import afo
    gait = afo.Walker().fixed_point(0.05).x
    engine = mine = 0.0
    for _ in range(TURNS):
        said = subprocess.run([build / "afo-bench", reference, str(seconds), "engine"], capture_output=True, text=True, check=True)
        walkers, strides, rate = said.stdout.split(",")
        engine = max(engine, float(rate))
        x, r0 = numpy.tile(gait, (int(walkers), 1)), numpy.full(int(walkers), 0.05)
        spent = 0.0
        while spent < seconds:
            start = time.process_time()
            afo.return_map(x, r0, int(strides), threads=1)
            took = time.process_time() - start
            mine, spent = max(mine, len(x) * int(strides) / took), spent + took
    print(f"# afo.return_map in Python: {mine:,.0f} strides per second on one core, {100 * mine / engine:.0f} % of the engine's "
          f"{engine:,.0f}")
    return 0 if mine >= LEAST * engine else 1


if __name__ == "__main__":
    if {"-h", "--help"} & set(sys.argv[1:]):
        print(__doc__.strip())
        sys.exit(0)
    sys.exit(main(sys.argv[1:]))
