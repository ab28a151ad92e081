"""Prints CPU time, us, of doStep + get of two outputs through fmpy of an FMI 3.0 FMU: fmpy3.py <unzipped> <token>"""

import sys
import time

from fmpy.fmi3 import FMU3Slave

STEPS = 2000
fmu = FMU3Slave(guid=sys.argv[2], unzipDirectory=sys.argv[1], modelIdentifier="BallFmi3")
fmu.instantiate()
fmu.enterInitializationMode()
fmu.exitInitializationMode()
t, h, best = 0.01, 1e-12, float("inf")
fmu.doStep(0.0, t)
for _ in range(5):
    began = time.process_time()
    for _ in range(STEPS):
        fmu.doStep(t, h)
        fmu.getFloat64([1, 2])
        t += h
    best = min(best, time.process_time() - began)
print(1e6 * best / STEPS)
