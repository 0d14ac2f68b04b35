"""afo: a walker with springs at its ankles, and the controller that makes it walk, in Python.

    import afo
    walker = afo.Walker()                       # the paper's; Walker(M, m, l, k, g) is another
    gait = walker.fixed_point(0.05)             # x, eigenvalues, cost of transport
    afo.return_map(gait.x, 0.05)                # one stride; arrays (..., 3) are many walkers at once
    walk = afo.sim(law="predictive", speed=0.8)  # the whole chain: controller, bus, sensors, drives
    walk.steps                                  # a pandas table, a row a step
    afo.sim(law=lambda step: step.steady_r0_m - 0.05 * (step.command_rad_s - step.speed_rad_s), speed=0.8)

All is computed by the C code of afo, in one shared library. Units are SI. What does not fit raises AfoError.
"""
from ._library import AfoError, version
from .reading import read_log, read_trial
from .walker import (AXES, BRANCHES, OUTCOMES, RANGES, Basin, Derivatives, Gait, Walker, Walks, fault_name, return_map)
from .walking import SENSORS, Law, Step, Walk, devices, persons, sim

__version__ = version
__all__ = ["AXES", "BRANCHES", "OUTCOMES", "RANGES", "SENSORS", "AfoError", "Basin", "Derivatives", "Gait", "Law", "Step",
           "Walk", "Walker", "Walks", "devices", "fault_name", "persons", "read_log", "read_trial", "return_map", "sim"]
