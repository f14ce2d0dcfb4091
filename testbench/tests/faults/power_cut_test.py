"""Cuts the power behind each call that syncs something in a sweep, and goes on from what the disk holds for certain.

Usage: power_cut_test.py RTUSIM SHIM SOURCE

A file that was never synced is empty then, a name that was not synced is not there. From each such state the same command must come to
the same tables, run no point again whose files were whole, and what was whole once must be so after every later cut. After the last one,
behind an exit status of 0, nothing is left to run.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

program, shim, source = (Path(a).resolve() for a in sys.argv[1:4])
SCENE = f"""[scene]
model = "{source}/testbench/golden/svo/models/dragon_32.svo"
[frame]
width = 16
height = 9
"""
SWEEP = """[sweep]
scenes = ["scene.toml"]
images = ["png"]
[axes]
"rtu.cores" = [1, 2, 3]
"source.valid" = ["always", "paced"]
"""
FILES = ("identity.json", "image.png", "stats.json")
faults = []


def sweep(folder, **environment):
    return subprocess.run([program, "sweep", "sweep.toml", "--out", "out", "-j", "2"], cwd=folder, env={**os.environ, **environment},
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120)


def restored(folder, inode, folders, files):
    """Builds what the disk holds of a folder."""
    folder.mkdir(exist_ok=True)
    for line in folders.get(inode, "").splitlines():
        number, name = line.split(" ", 1)
        if name.endswith("/"):
            restored(folder / name[:-1], number, folders, files)
        else:
            (folder / name).write_bytes(files.get(number, b""))


def whole_points(folder):
    """The points of a sweep's folder whose files are all there and not empty."""
    return {p.parent.name for p in folder.glob("out/points/*/identity.json")
            if not p.parent.name.startswith(".") and all((p.parent / name).is_file() and (p.parent / name).stat().st_size for name in FILES)}


base = Path(tempfile.mkdtemp(prefix="rtusim-power-"))
try:
    work, journal = base / "work", base / "journal"
    for folder in (work, journal):
        folder.mkdir()
    (work / "scene.toml").write_text(SCENE)
    (work / "sweep.toml").write_text(SWEEP)
    folders, files = {str(work.stat().st_ino): ""}, {}
    for path in work.iterdir():
        folders[str(work.stat().st_ino)] += f"{path.stat().st_ino} {path.name}\n"
        files[str(path.stat().st_ino)] = path.read_bytes()
    done = sweep(work, LD_PRELOAD=str(shim), POWER_ROOT=str(work), POWER_JOURNAL=str(journal))
    if done.returncode != 0:
        sys.exit(f"the sweep itself: status {done.returncode}\n{done.stdout}{done.stderr}")
    tables = {name: (work / "out" / name).read_bytes() for name in ("results.csv", "results.json")}

    cuts = (journal / "log").stat().st_size // 8
    whole_before, seen = set(), set()
    for cut in range(cuts):
        for kept in journal.glob(f"{cut}.*"):
            _, inode, kind = kept.name.split(".")
            folders.pop(inode, None)  # a number is used again
            files.pop(inode, None)
            if kind == "folder":
                folders[inode] = kept.read_text()
            else:
                files[inode] = kept.read_bytes()
        after = base / f"cut_{cut}"
        restored(after, str(work.stat().st_ino), folders, files)
        whole = whole_points(after)
        if not whole_before <= whole:
            faults.append(f"cut {cut}: {len(whole_before - whole)} points that were whole are not")
        whole_before = whole
        dates = {name: (after / "out/points" / name / "stats.json").stat().st_mtime_ns for name in whole}
        resumed = sweep(after)
        if resumed.returncode != 0:
            faults.append(f"cut {cut}: status {resumed.returncode}: {resumed.stderr.strip()}")
            continue
        for name, data in tables.items():
            if (after / "out" / name).read_bytes() != data:
                faults.append(f"cut {cut}: other bytes in {name}")
        again = [name for name, date in dates.items() if (after / "out/points" / name / "stats.json").stat().st_mtime_ns != date]
        if again:
            faults.append(f"cut {cut}: {len(again)} whole points ran again")
        seen.add(len(whole))
        shutil.rmtree(after)
    if len(whole_before) != 6:
        faults.append(f"after the sweep's end {len(whole_before)} points are whole; expected 6")
    if cuts < 4 or len(seen) < 2:
        faults.append(f"{cuts} cuts with {sorted(seen)} whole points; expected more of both")
finally:
    shutil.rmtree(base, ignore_errors=True)
print("\n".join(faults) or f"{cuts} cuts, {sorted(seen)} points whole after them, each goes on to the same tables")
sys.exit(1 if faults else 0)
