"""Holds every include of the sources to the direction that the house has: down a floor, or to a room named before on the same floor.

Usage: includes_test.py SOURCE
"""

import os
import re
import subprocess
import sys
from pathlib import Path

source = Path(sys.argv[1])

# Floors and their rooms, from what stands on nothing to what stands on all. Rooms in one line don't know each other.
HOUSE = """
modules/config
modules/numeric
modules/formats
modules/timing
modules/memory modules/scheduler/policies
modules/float_to_fixed modules/t_div modules/scheduler modules/job_manager modules/triangle_unit modules/result_manager
modules/core_bank
modules/svo_core modules/bih_core
modules/rtu
scenes/meshes scenes/rays
scenes/voxels scenes/triangles
scenes
testbench/bench testbench/pictures
testbench/replay testbench/units
testbench/kinds
testbench/run
testbench/sweep
testbench/commands
testbench
"""
FLOOR_OF = {room: floor for floor, line in enumerate(HOUSE.split("\n")) for room in line.split()}


def main():
    faults, rooms = [], set()
    for room in ("modules", "scenes", "testbench"):
        for path in sorted((source / room).rglob("*.*")):
            name = str(path.relative_to(source))
            if path.suffix not in (".h", ".cpp") or re.match(r"testbench/(tests|benchmarks)/", name):
                continue
            here = os.path.dirname(name)
            rooms.add(here)
            for number, line in enumerate(path.read_text().split("\n"), 1):
                found = re.match(r'#include "([^"]+)"', line)
                if not found:
                    continue
                there = os.path.dirname(found.group(1))
                if here not in FLOOR_OF or there not in FLOOR_OF:
                    faults.append(f"{name}:{number}: {here if here not in FLOOR_OF else there} is no room of the house")
                elif here != there and FLOOR_OF[there] >= FLOOR_OF[here]:
                    faults.append(f"{name}:{number}: {here} includes {found.group(1)}, of a room that is not below it")
    faults += [f"{room}: a room of the house without a source" for room in sorted(set(FLOOR_OF) - rooms)]
    print("\n".join(faults) or f"{len(rooms)} rooms, every include goes down")
    return 1 if faults else 0


sys.exit(main())
