#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The time that Python adds to a query: the same motions asked from C++ and from Python, in one process, on one world.

    PYTHONPATH=build/release/python python3 python/bench/overhead.py

Prints the time of check() beside C++'s for free motions of the bundled arm. Then it prints motions per second of
check_many() beside C++'s on one and two threads, and the time that `import fcl_artic` takes. Passes alternate, and the
fastest of each counts: other programs on the machine only slow down.
"""
import argparse
import pathlib
import subprocess
import sys
import time

import numpy as np

import _fcl_artic_bench as cpp
import fcl_artic

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"


def best(passes, *functions):
    """The shortest time of each function, s."""
    times = [[] for _ in functions]
    for _ in range(passes):
        for function, taken in zip(functions, times):
            taken.append(function())
    return [min(taken) for taken in times]


def timed(function):
    begin = time.perf_counter()
    function()
    return time.perf_counter() - begin


def measure_check(world, q0, q1, passes):
    """Time of a call of check(), from C++ and from Python, µs."""
    pairs = list(zip(q0, q1))

    def from_python():
        check = world.check
        begin = time.thread_time()  # this thread's own time: short passes, in which nothing waits
        for a, b in pairs:
            check(a, b)
        return time.thread_time() - begin

    a, b = best(passes, lambda: cpp.check_each(world, q0, q1), from_python)
    return 1e6 * a / len(q0), 1e6 * b / len(q0)


def measure_many(world, q0, q1, threads, passes):
    """Motions per second, from C++ and from Python."""
    a, b = best(
        passes,
        lambda: cpp.check_many(world, q0, q1, threads),
        lambda: timed(lambda: world.check_many(q0, q1, threads=threads)),
    )
    return len(q0) / a, len(q0) / b


def measure_import(passes):
    """Time that the import takes, ms, NumPy's own left out."""
    code = "import numpy, time; begin = time.perf_counter(); import fcl_artic; print(time.perf_counter() - begin)"
    return 1e3 * min(
        float(subprocess.run([sys.executable, "-c", code], capture_output=True, check=True).stdout) for _ in range(passes)
    )


def cheap_world():
    """A ball on six joints, and an obstacle out of its reach: about a microsecond a query."""
    tree = fcl_artic.KinematicTree("six joints")
    tree.add_link("link0")
    for i in range(6):
        tree.add_link(f"link{i + 1}")
        tree.add_joint(fcl_artic.Joint.revolute(f"joint{i}", f"link{i}", f"link{i + 1}", np.eye(3)[i % 3], [0, 0, 0.2]))
    robot = fcl_artic.Robot(tree)
    robot.add_geometry("link6", fcl_artic.sphere(0.1))
    scene = fcl_artic.Scene()
    scene.add("far", fcl_artic.sphere(0.1), [20, 0, 0])
    return fcl_artic.World(robot, scene)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--passes", type=int, default=9)
    passes = parser.parse_args().passes
    robot = fcl_artic.load_urdf(DATA / "puma560" / "puma560.urdf")
    world = fcl_artic.World(robot, fcl_artic.load_scene(DATA / "pipes.obj"))
    random = np.random.default_rng(3)
    lower, upper = np.clip(robot.tree.limits, -np.pi, np.pi).T
    q0 = random.uniform(lower, upper, (20000, robot.dof))
    q1 = q0 + random.uniform(-0.1, 0.1, q0.shape)
    answers = world.check_many(q0, q1)
    free = answers.free
    good = True

    print(f"fcl_artic {fcl_artic.__version__}, Python {sys.version.split()[0]}, NumPy {np.__version__}")
    print(f"{len(q0)} motions of {robot.name} by at most 0.1 rad: {answers}")
    # The time that Python adds can be seen beside a cheap query only.
    in_cpp, in_python = measure_check(cheap_world(), q0[:300], q1[:300], 20 * passes)
    good &= in_python - in_cpp <= 2
    print(f"check, free        C++ {in_cpp:8.2f} us   Python {in_python:8.2f} us   more {in_python - in_cpp:6.2f} us (at most 2)")
    for threads in (1, 2):
        cpp_rate, python_rate = measure_many(world, q0[:2000], q1[:2000], threads, 3 * passes)
        share = python_rate / cpp_rate
        good &= share >= 0.95
        print(f"check_many, {threads} thr.  C++ {cpp_rate:8.0f} /s   Python {python_rate:8.0f} /s   {100 * share:5.1f} % (at least 95)")
    milliseconds = measure_import(passes)
    good &= milliseconds < 100
    print(f"import fcl_artic   {milliseconds:.1f} ms (below 100)")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
