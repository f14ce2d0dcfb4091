"""Installs a build into a folder: the program draws a picture from there, and another project finds and links a library.

Usage: install_test.py BUILD CMAKE GENERATOR COMPILER
"""

import subprocess
import sys
import tempfile
from pathlib import Path

build, cmake, generator, compiler = sys.argv[1:]

PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES CXX)
find_package(rtusim 0.1 REQUIRED)
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE rtusim::numeric)
foreach(library rtu scenes svo_core bih_core)
  if(NOT TARGET rtusim::${library})
    message(FATAL_ERROR "no rtusim::${library}")
  endif()
endforeach()
"""
PROGRAM = """
#include <cstdio>

#include "modules/numeric/fixed_point.h"

int main() {
  const rtusim::numeric::fixed_format format{8, 8};
  std::printf("%g\\n", format.value(384));
}
"""
RUN = ["--model", "cube.obj", "--set", "scene.resolution=4", "--set", "frame.width=16", "--set", "frame.height=9", "--quiet"]
CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1))
CUBE += "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"


def run(*command, folder):
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout}")
    return done.stdout


with tempfile.TemporaryDirectory() as scratch:
    base = Path(scratch)
    prefix = base / "prefix"
    run(cmake, "--install", build, "--prefix", prefix, folder=base)
    (base / "cube.obj").write_text(CUBE)
    run(prefix / "bin/rtusim", "run", *RUN, "--image", "cube.png", folder=base)
    if not (base / "cube.png").read_bytes().startswith(b"\x89PNG"):
        sys.exit("cube.png: no PNG")

    (base / "CMakeLists.txt").write_text(PROJECT)
    (base / "main.cpp").write_text(PROGRAM)
    run(cmake, "-G", generator, f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCMAKE_PREFIX_PATH={prefix}", "-B", "consumer", folder=base)
    run(cmake, "--build", "consumer", folder=base)
    if (out := run("consumer/consumer", folder=base)) != "1.5\n":
        sys.exit(f"consumer: {out!r}; expected 1.5")
    print("installed, and found by another project")
