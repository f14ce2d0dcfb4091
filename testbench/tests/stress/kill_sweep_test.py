"""Ends a sweep at random moments, by signals that it can and can't see, and goes on with it: kill_sweep_test.py RTUSIM MODEL.svo KILLS [SEED].

The resumed tables must have the bytes of one that ran through, each point its files; no part of a file may be left after the next start,
nor one by a sweep that could see its end come, and no worker may outlive its sweep. Tells each fault; status 1 if there was one.
"""
import ctypes
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PR_SET_CHILD_SUBREAPER = 36
SIGNALS = [signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP]
SWEEP = """[sweep]
scenes = ["scene.toml"]
images = ["png"]
[axes]
"scheduler.policy" = ["round_robin", "first_available"]
"rtu.cores" = {from = 1, to = 12}
"""
FILES = ["identity.json", "image.png", "stats.json"]

program, model, kills = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), int(sys.argv[3])
seed = int(sys.argv[4]) if len(sys.argv) > 4 else 1
chance = random.Random(seed)
faults = []


def check(holds, text):
    if not holds:
        faults.append(text)
        print(text, file=sys.stderr)


def start(out):
    return subprocess.Popen([program, "sweep", "sweep.toml", "--out", out, "--quiet", "-j", "2"], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def parts(out):
    return [str(p) for p in Path(out).rglob(".*part-*")]


def end_of_workers():
    """Those of a sweep that was killed are ours now; the kernel ends them."""
    while True:
        try:
            os.waitpid(-1, 0)
        except ChildProcessError:
            return


def check_whole(number):
    for name in ("results.csv", "results.json"):
        check((Path("out") / name).read_bytes() == (Path("whole") / name).read_bytes(), f"kill {number}: other bytes in {name}")
    check(not parts("out"), f"kill {number}: left over: {parts('out')}")


def check_points(number):
    for point in Path("out/points").glob("[!.]*"):
        check(sorted(f.name for f in point.iterdir()) == FILES and all(f.stat().st_size for f in point.iterdir()),
              f"kill {number}: {point} is not whole")


with tempfile.TemporaryDirectory() as scratch:
    os.chdir(scratch)
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    Path("scene.toml").write_text(f'[scene]\nmodel = "{model}"\n[frame]\nwidth = 32\nheight = 18\n')
    Path("sweep.toml").write_text(SWEEP)
    begin = time.monotonic()
    check(start("whole").wait() == 0, "a sweep that nobody ends fails")
    longest = 1.2 * (time.monotonic() - begin)
    number = runs = 0
    while number < kills:
        sweep = start("out")
        try:
            check(sweep.wait(chance.uniform(0, longest)) == 0, f"kill {number}: the sweep failed by itself")
            check_whole(number)
            shutil.rmtree("out")
            runs += 1
            continue
        except subprocess.TimeoutExpired:
            pass
        sent = chance.choice(SIGNALS)
        sweep.send_signal(sent)
        sweep.wait()
        end_of_workers()
        number += 1
        if Path("out/points").is_dir():
            check_points(number)
        # Before it has begun, or after its last point, a signal ends it as any program.
        if sweep.returncode == 1 and Path("out").is_dir():
            check(not parts("out"), f"kill {number}: {sent.name} left {parts('out')}")
    check(start("out").wait() == 0, "the last sweep fails")
    check_whole(number)
    print(f"{number} kills, {runs + 1} sweeps came to their end, seed {seed}: {len(faults)} faults")
sys.exit(1 if faults else 0)
