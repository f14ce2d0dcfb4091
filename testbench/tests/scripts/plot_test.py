"""scripts/plot on a made-up sweep: what it refuses, and that the same results give the same bytes. Status 77: no matplotlib here, so
that nothing could be drawn."""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

plot = sys.argv[1]
faults = []


def run(*arguments):
    return subprocess.run(["/usr/bin/python3", plot, *arguments], capture_output=True, text=True, check=False)


def results(folder, points, **changes):
    folder.mkdir()
    (folder / "results.json").write_text(json.dumps({"format": "rtusim sweep results", "version": 2, "points": points, **changes}))
    return str(folder)


def point(cores, policy, status="done"):
    figures = {"rays_per_second": 1e6 * min(cores, 6), "checksum": "00ff", "waits.dispatch": 9.0 / cores, "waits.traversal": 13.0}
    axes = {"rtu.cores": cores, "scheduler.policy": policy, "camera.target": [0, 1, 0.5], "driver.norm": True}
    return {"point": f"{cores}{policy}", "scene": "a.toml", "architecture": "", "axes": axes, "status": status, "reason": "",
            "figures": figures if status == "done" else {}}


with tempfile.TemporaryDirectory() as scratch:
    base = Path(scratch)
    good = results(base / "good", [point(c, p) for p in ("round_robin", "first_available") for c in range(1, 17)])
    for text, *arguments in [
            ("none: no such folder", str(base / "none"), "knee"),
            ("no results.json", scratch, "knee"),
            ("no results of a sweep", results(base / "garbled", [], format=3), "knee"),
            ("version 3; expected version 2", results(base / "later", [], version=3), "knee"),
            ("no point that is done, 1 failed", results(base / "failed", [point(1, "x", "failed")]), "knee"),
            ("points without axes or figures", results(base / "odd", [3]), "knee"),
            ("no column rtu.core; expected rtu.cores", good, "axis", "rtu.core", "rays_per_second"),
            ("no column ray_per_second; expected rays_per_second", good, "axis", "rtu.cores", "ray_per_second"),
            ("checksum, which is no number", good, "axis", "rtu.cores", "checksum"),
            ("rtu.cores is 3 everywhere", good, "knee", "--where", "rtu.cores=3"),
            ("camera.target=[ 0, 1, 0.5 ]", good, "knee", "--where", "camera.target=[0, 1, 0.5]"),
            ("driver.norm=true", good, "knee", "--where", "driver.norm=True"),
            ("scheduler.policy=round_robin", good, "knee", "--where", "scheduler.policy=round_robbin"),
            ("no picture of a point", good, "sheet"),
            ("a name that ends in .png or .svg", good, "knee", "--out", "knee.pdf"),
            ("--help' lists", good, "kneee")]:
        done = run(*arguments)
        if done.returncode != 2 or done.stdout or done.stderr.count("\n") != 1 or text not in done.stderr:
            faults.append(f"{arguments}: status {done.returncode}, {done.stderr!r}; expected {text!r}")

    python = subprocess.run(["/usr/bin/python3", "-c", "import matplotlib"], capture_output=True, check=False)
    if python.returncode == 0:
        twin = results(base / "twin", json.loads((base / "good/results.json").read_text())["points"])
        for folder, *kind in [(good, "knee"), (twin, "knee"), (good, "axis", "scheduler.policy", "waits.dispatch")]:
            done = run(folder, *kind)
            if done.returncode != 0 or done.stdout.count("\n") != 2:
                faults.append(f"{kind}: {done.stderr}")
        for name in ("plots/knee.png", "plots/knee.svg"):
            if (base / "good" / name).read_bytes() != (base / "twin" / name).read_bytes():
                faults.append(f"{name}: other bytes from the same results")

print("\n".join(faults))
sys.exit(1 if faults else 77 if python.returncode != 0 else 0)
