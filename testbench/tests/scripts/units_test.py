"""Looks for folders of modules/ with an sc_module and without a test in the folder of that name below testbench/tests/modules, and for units
that contract_test.cpp does not know.

Usage: units_test.py SOURCE
"""

import re
import sys
from pathlib import Path

source = Path(sys.argv[1])

# Each class of the hardware with its folder and the classes that it comes from.
CLASS = re.compile(r"^(?:class|struct) (\w+)(?: final)? : ([^{;]*)\{", re.M)
classes = {}
for path in sorted((source / "modules").rglob("*.h")):
    for name, bases in CLASS.findall(path.read_text()):
        classes[name] = path.parent.name, re.findall(r"\w+", bases)


def comes_from(name, base):
    return name == base or (name in classes and any(comes_from(above, base) for above in classes[name][1] if above != name))


units = {name: folder for name, (folder, _) in classes.items() if comes_from(name, "sc_module")}
tests = source / "testbench/tests/modules"
faults = []
for folder in sorted(set(units.values())):
    if not any((tests / folder).glob("*_test.cpp")):
        names = ", ".join(sorted(name for name in units if units[name] == folder))
        faults.append(f"modules/{folder}: {names} without a test in testbench/tests/modules/{folder}")
contract = (tests / "contract_test.cpp").read_text()
for name in sorted(units):
    is_base = any(name in bases for _, bases in classes.values())
    if comes_from(name, "unit") and not is_base and not re.search(rf"\b{name}\b", contract):
        faults.append(f"{name}: not in testbench/tests/modules/contract_test.cpp")
if len(units) < 8:
    faults.append(f"{len(units)} units; expected more, so they are not found here as they are written")
print("\n".join(faults) or f"{len(units)} units in {len(set(units.values()))} folders, each with a test")
sys.exit(1 if faults else 0)
