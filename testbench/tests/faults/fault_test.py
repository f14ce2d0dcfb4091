"""Lets each call of rtusim's that can fail do so, one a run, and holds what is left against what should be.

Usage: fault_test.py RTUSIM SHIM SOURCE [CALLS]
CALLS: of each function in each command so many, spread over all that there are; "all" for every one, or 5000 where there are
more. 6 if left out, and 60 of malloc, which is called in most places.

After each fault every output is the old file, or none, or the whole new one; all are new when the exit status is 0; else there is one line
on stderr; no hidden file is left. Besides, a power cut after an exit status of 0 loses nothing: each output was synced before it got its
name, and its folder after.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile

program, shim, source = (os.path.abspath(a) for a in sys.argv[1:4])
most_calls = sys.argv[4] if len(sys.argv) > 4 else None


def samples(function):
    if most_calls is None:
        return 60 if function == "malloc" else 6
    return 5000 if most_calls == "all" else int(most_calls)


design = ["--arch", os.path.join(source, "testbench/architectures/espe2019.toml"), "--set", "frame.width=16", "--set", "frame.height=9"]
octree = ["--model", os.path.join(source, "testbench/golden/svo/models/dragon_32.svo")]
cube = os.path.join(source, "testbench/tests/cases/mesh_cube.obj")

scene = f"""[scene]
model = "{octree[1]}"
[frame]
width = 16
height = 9
"""
sweep = f"""[sweep]
scenes = ["scene.toml"]
architectures = ["{source}/testbench/architectures/espe2019.toml"]
record = ["total_cycles"]
[axes]
"rtu.cores" = [1, 2]
"""

# A name; arguments; the outputs; functions that are made to fail.
files = ["open", "write", "short", "fsync", "rename", "mkdir", "close"]
commands = [
    ("run", ["run", *design, *octree, "--quiet", "--stats", "s.json", "--log", "l.csv", "--save-jobs", "j.bin", "--vcd", "w.vcd",
             "--vcd-to", "300"], ["s.json", "l.csv", "j.bin", "w.vcd"], ["malloc", *files]),
    ("replay", ["run", *design, *octree, "--quiet", "--pace", "replay", "--log", "l.csv"], ["l.csv"], ["malloc"]),
    ("pictures", ["run", *design, *octree, "--quiet", "--pace", "replay", "--image", "p.png", "--image", "p.exr"], ["p.png", "p.exr"],
     ["malloc", *files]),
    ("convert", ["convert", cube, "c.svo", "--resolution", "16", "--solid", "--quiet"], ["c.svo"], ["malloc", *files]),
    ("convert to voxels", ["convert", octree[1], "c.binvox", "--quiet"], ["c.binvox"], ["malloc", *files]),
    ("sweep", ["sweep", "sweep.toml", "--out", "out", "--quiet", "-j", "2"], ["out/results.csv"], files),
]


def content(path):
    """What a file says, without what differs from run to run."""
    with open(path, "rb") as f:
        data = f.read()
    if path.endswith(".json") and data != b"old":
        record = json.loads(data)
        record.pop("simulator")
        return record
    return data


def hidden(folder):
    return [os.path.join(at, n) for at, folders, names in os.walk(folder) for n in folders + names if n.startswith(".") and n != ".lock"]


def start(arguments, folder, **fault):
    environment = dict(os.environ, LD_PRELOAD=shim, **fault)
    return subprocess.run([program, *arguments], cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True, timeout=120)


def prepare(outputs):
    folder = tempfile.mkdtemp(prefix="rtusim-faults-")
    for name, text in (("sweep.toml", sweep), ("scene.toml", scene)):
        with open(os.path.join(folder, name), "w") as f:
            f.write(text)
    for name in outputs:
        if os.path.dirname(name) == "":
            with open(os.path.join(folder, name), "w") as f:
                f.write("old")
    return folder


def check_power_cut(log, folder, outputs):
    """Every output: what was written is synced, then it gets its name, then the folder is synced."""
    with open(log) as f:
        events = [line.rstrip("\n").split("\t") for line in f]
    for name in outputs:
        final = os.path.join(folder, name)
        at = [i for i, e in enumerate(events) if e[0] == "rename" and os.path.join(folder, e[2]) == final]
        assert at, f"{name} was not renamed into its place"
        part = os.path.join(folder, events[at[-1]][1])
        before = [e[0] for e in events[: at[-1]] if e[0] in ("write", "sync") and e[1] == part]
        assert before and before[-1] == "sync", f"{name} was renamed before it was synced: {before[-3:]}"
        assert ["sync", os.path.dirname(final)] in events[at[-1]:], f"{name}: its folder was not synced"


def check_sweep(folder, new):
    """The table is whole: of other points than failed ones the rows are right."""
    path = os.path.join(folder, "out/results.csv")
    if os.path.exists(path):
        expected, found = new.decode().splitlines(), content(path).decode().splitlines()
        assert len(found) == len(expected), f"a table of {len(found)} lines"
        for right, row in zip(expected, found):
            assert row == right or "done" not in row.split(","), f"a wrong row: {row}"


def main():
    runs = 0
    for name, arguments, outputs, functions in commands:
        folder = os.path.realpath(prepare(outputs))
        log, counted = os.path.join(folder, "log.txt"), os.path.join(folder, "counts.txt")
        done = start(arguments, folder, FAULT_LOG=log, FAULT_COUNT=counted)
        assert done.returncode == 0, (name, done.stderr)
        new = {n: content(os.path.join(folder, n)) for n in outputs}
        assert b"old" not in new.values() and not hidden(folder), (name, hidden(folder))
        if name != "sweep":
            check_power_cut(log, folder, outputs)
        with open(counted) as f:
            calls = {line.split()[0]: int(line.split()[1]) for line in f}
        shutil.rmtree(folder)
        for function in functions:
            step = max(1, -(-calls[function] // samples(function)))
            for n in range(1 + (runs % step), calls[function] + 1, step):
                runs += 1
                folder = os.path.realpath(prepare(outputs))
                what = f"{name}, {function} {n} of {calls[function]}"
                ended = start(arguments, folder, FAULT_CALL=f"{function}:{n}")
                told = ended.stderr.decode()
                # Libraries behind OpenImageIO abort where they get no memory, or call it by another name, and libpng says so itself.
                in_library = name == "pictures" and function == "malloc"
                is_aborted = in_library and ended.returncode in (-signal.SIGABRT, -signal.SIGTRAP)
                if in_library:
                    told = "".join(line for line in told.splitlines(True) if not line.startswith("libpng "))
                try:
                    left = hidden(folder)
                    assert not left or is_aborted, f"left {left}"
                    assert ended.returncode in (0, 1, 2) or is_aborted, f"exit status {ended.returncode}"
                    if name == "sweep":
                        check_sweep(folder, new[outputs[0]])
                        table = os.path.join(folder, outputs[0])
                        is_new = [os.path.exists(table) and content(table) == new[outputs[0]]]
                    else:
                        found = {o: content(os.path.join(folder, o)) for o in outputs}
                        is_new = [found[o] == new[o] for o in outputs]
                        for o in outputs:
                            assert found[o] in (b"old", new[o]), f"{o} is neither the old nor the new file"
                        # SystemC's words, before it calls us, on either stream.
                        if function == "malloc" and b"(E549) uncaught exception: std::bad_alloc" in ended.stdout + ended.stderr:
                            told = "rtusim: out of memory\n"
                        if ended.returncode != 0 and not is_aborted:
                            assert told.startswith("rtusim: ") and told.count("\n") == 1, "not one line"
                        if function == "malloc" and ended.returncode != 0 and not in_library:
                            assert told == "rtusim: out of memory\n", "another word for a lack of memory"
                    assert all(is_new) or ended.returncode != 0, f"exit status 0 without {[o for o, i in zip(outputs, is_new) if not i]}"
                    assert function != "short" or ended.returncode == 0, "a short write is no error"
                except AssertionError as e:
                    sys.exit(f"fault_test: {what}: {e}\n{told}")
                shutil.rmtree(folder)
    print(f"{runs} faults, and no output lost or torn")


main()
