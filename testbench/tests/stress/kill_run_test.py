"""Ends runs at random moments, and sees what they leave.

Usage: kill_run_test.py RTUSIM SOURCE [KILLS [SEED]]

Each run writes statistics, a log, jobs, a picture and a waveform over older ones. Behind each end every one of them is whole, the old or
the new; after SIGINT and SIGTERM no part file is left, and after SIGKILL none once another run has written there.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time

program, source = (os.path.abspath(a) for a in sys.argv[1:3])
kills = int(sys.argv[3]) if len(sys.argv) > 3 else 8
seed = int(sys.argv[4]) if len(sys.argv) > 4 else 1
dice = random.Random(seed)

common = ["run", "--quiet", "--arch", os.path.join(source, "testbench/architectures/espe2019.toml"), "--model",
          os.path.join(source, "testbench/golden/svo/models/dragon_32.svo")]
outputs = {"--stats": "s.json", "--log": "l.csv", "--save-jobs": "j.bin", "--image": "p.png", "--vcd": "w.vcd"}
named = [word for pair in outputs.items() for word in pair]


def frame(width, height):
    return ["--set", f"frame.width={width}", "--set", f"frame.height={height}"]


def whole(folder):
    """What the outputs hold; of the statistics what does not differ from run to run."""
    found = {}
    for name in outputs.values():
        with open(os.path.join(folder, name), "rb") as f:
            data = f.read()
        found[name] = data[: data.find(b'"simulator"')] if name == "s.json" else data
        assert name != "s.json" or data.endswith(b"}\n"), "torn statistics"
    return found


def hidden(folder):
    return [n for n in os.listdir(folder) if n.startswith(".")]


with tempfile.TemporaryDirectory(prefix="rtusim-kills-") as folder:
    small, large = [*common, *frame(16, 9), *named], [*common, *frame(128, 72), *named]
    begin = time.monotonic()
    subprocess.run([program, *large], cwd=folder, check=True)
    seconds = time.monotonic() - begin
    new = whole(folder)
    left_parts = ended = 0
    for number in range(kills):
        subprocess.run([program, *small], cwd=folder, check=True)
        assert not hidden(folder), f"left of the kill before: {hidden(folder)}"
        old = whole(folder)
        how = dice.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        run = subprocess.Popen([program, *large], cwd=folder, stderr=subprocess.PIPE)
        time.sleep(dice.uniform(0, seconds))
        run.send_signal(how)
        told = run.communicate()[1]
        ended += run.returncode != 0
        assert run.returncode in (0, -how), (run.returncode, told)
        found = whole(folder)
        for name, data in found.items():
            assert data in (old[name], new[name]), f"kill {number} of seed {seed}: {name} is torn"
        left_parts += len(hidden(folder))
        assert how == signal.SIGKILL or not hidden(folder), f"{how.name} leaves {hidden(folder)}"
    subprocess.run([program, *small], cwd=folder, check=True)
    assert not hidden(folder), f"left: {hidden(folder)}"
    assert kills < 8 or ended != 0, "no run was ended: they are too short"
    print(f"{kills} kills, {ended} of them before the end, {left_parts} part files left and removed; no output torn")
