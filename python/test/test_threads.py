# SPDX-License-Identifier: BSD-3-Clause
"""Threads, forks and lifetimes. A test that could wait for ever runs in a Python of its own, which is ended if it does."""
import gc
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
import weakref

import numpy as np
import pytest

import fcl_artic

PATIENCE = 60  # s until a script counts as hanging: hundreds of times what it takes

BEGIN = """
import os, signal, sys, threading, time
import numpy as np
import fcl_artic

def arm():
    tree = fcl_artic.KinematicTree("arm")
    tree.add_link("base")
    tree.add_link("arm")
    tree.add_joint(fcl_artic.Joint.revolute("hinge", "base", "arm", [0, 0, 1], lower=-3, upper=3))
    robot = fcl_artic.Robot(tree)
    robot.add_geometry("arm", fcl_artic.box((1, 0.1, 0.1)), [0.5, 0, 0])
    return robot

world = fcl_artic.World(arm())
world.add("ball", fcl_artic.sphere(0.1), [5, 0, 0])

def add_own(state):
    # Where the way from 0 to -2 meets it: such a question calls state() about 200 times.
    motion = fcl_artic.Motion.bounded(lambda t: state() or fcl_artic.pose([0.5, -0.5, 0]), lambda a, b: (1, 0),
                                      derivatives=False)
    world.add_moving("own", fcl_artic.sphere(0.1), motion)
    world.setup()

def ask_for_ever(world=world, stop=None):
    while stop is None or not stop.is_set():
        world.check_many(np.zeros((300, 1)), np.ones((300, 1)), threads=1)
"""


def run(script, status=0, begin=BEGIN):
    """Runs a script; it must end by itself, with this status. Returns what it says."""
    done = subprocess.run([sys.executable, "-c", begin + textwrap.dedent(script)], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
    assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
    return done.stdout


def test_changes_come_in_turn_beside_threads_that_ask():
    said = run("""
        stop = threading.Event()
        askers = [threading.Thread(target=ask_for_ever, args=(world, stop)) for _ in range(4)]
        for asker in askers: asker.start()
        for k in range(20):
            world.move("ball", [5 + k, 0, 0])
        print(world.pose("ball")[0, 3])
        stop.set()
        for asker in askers: asker.join()
    """)
    assert float(said) == 24


def test_questions_come_in_turn_beside_threads_that_change():
    run("""
        stop = threading.Event()
        def change():
            while not stop.is_set(): world.move("ball", [5, 0, 0])
        changers = [threading.Thread(target=change) for _ in range(2)]
        for changer in changers: changer.start()
        for k in range(20): assert world.is_free([0], [1])
        stop.set()
        for changer in changers: changer.join()
    """)


def test_nested_questions_do_not_wait_for_changes_that_wait():
    # While a question runs a change comes to wait for it; then the question asks, on its own thread and on another.
    for threads in (1, 2):
        said = run(f"""
            asked, begun, on = set(), threading.Event(), threading.Event()
            here = threading.local()
            def state():
                if not running or getattr(here, "asks", False): return
                here.asks = True
                begun.set()
                on.wait()
                world.is_free([0], [0.5])
                asked.add(threading.get_ident())
                here.asks = False
            running = False
            add_own(state)
            running = True
            question = threading.Thread(target=lambda: world.check_many(np.zeros((8, 1)), np.full((8, 1), -2.0),
                                                                        threads={threads}))
            question.start()
            begun.wait()
            change = threading.Thread(target=lambda: world.move("ball", [7, 0, 0]))
            change.start()
            time.sleep(0.1)  # it stands in line now, or soon
            on.set()
            question.join(); change.join()
            print(len(asked) > 0, world.pose("ball")[0, 3])
        """)
        assert said.split() == ["True", "7.0"]


def test_bodies_that_ask_each_other_beside_changes():
    run("""
        a, b = fcl_artic.Bodies(), fcl_artic.Bodies()
        for bodies in (a, b): bodies.add("ball", fcl_artic.sphere(0.1), np.eye(4))
        def ask(one, other):
            for _ in range(200): one.check_against(other)
        def change(one):
            for k in range(100): one.set_motion("ball", fcl_artic.pose([k, 0, 0]))
        threads = [threading.Thread(target=f, args=x) for f, x in
                   [(ask, (a, b)), (ask, (b, a)), (ask, (a, a)), (change, (a,)), (change, (b,))]]
        for thread in threads: thread.start()
        for thread in threads: thread.join()
    """)


def test_a_callback_that_changes_the_world_is_an_error_on_every_thread():
    for threads in (1, 3):
        said = run(f"""
            errors = set()
            def state():
                try:
                    world.move("ball", [6, 0, 0])
                except RuntimeError as error:
                    errors.add((threading.get_ident() == main, str(error)))
                time.sleep(0.0005)  # so that all threads have something to do
            main = threading.get_ident()
            add_own(state)
            world.check_many(np.zeros((12, 1)), np.full((12, 1), -2.0), threads={threads})
            for on_main, error in sorted(errors): print(on_main, error)
        """)
        lines = said.splitlines()
        assert "True a world can't be changed from within its own query" in lines
        if threads > 1:
            assert "False a world can't be changed from within its own query" in lines


def test_ctrl_c_ends_the_wait():
    # For a question that does not end before it is let to.
    assert run("""
        begun, on = threading.Event(), threading.Event()
        def state():
            begun.set()
            on.wait()
        on.set()
        add_own(state)
        on.clear(); begun.clear()
        question = threading.Thread(target=lambda: world.check([0], [-2]))
        question.start()
        begun.wait()
        for wait in (lambda: world.move("ball", [7, 0, 0]), lambda: world.remove("ball")):
            threading.Timer(0.1, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
            try:
                wait()
            except KeyboardInterrupt:
                print("interrupted")
        assert world.pose("ball")[0, 3] == 5
        on.set()
        question.join()
        world.move("ball", [7, 0, 0])
    """) == "interrupted\ninterrupted\n"


def test_a_child_that_is_forked_beside_a_thread_that_asks_may_change_the_world():
    run("""
        stop = threading.Event()
        askers = [threading.Thread(target=ask_for_ever, args=(world, stop)) for _ in range(3)]
        for asker in askers: asker.start()
        for k in range(10):
            child = os.fork()
            if child == 0:
                signal.alarm(20)  # of a child that waits for ever
                world.move("ball", [0.5, 0.5, 0])
                free = world.check_many(np.zeros((9, 1)), np.ones((9, 1)), threads=2).free.any()
                os._exit(7 if not free else 8)
            status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            assert status == 7, status
            world.move("ball", [5 + k, 0, 0])
        stop.set()
        for asker in askers: asker.join()
    """)


def test_a_child_that_is_forked_in_a_callback_goes_on():
    run("""
        children, running = [], False
        def state():
            if not running or children: return
            children.append(os.fork())
            if children[0] == 0: signal.alarm(20)
        add_own(state)
        running = True
        answer = str(world.check([0], [-2]))
        world.move("ball", [7, 0, 0])
        assert str(world.check([0], [-2])) == answer
        if children[0] == 0: os._exit(7)
        assert os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]) == 7
    """)


def test_a_daemon_thread_that_asks_while_the_script_ends_does_no_harm():
    for threads in ("1", "2"):
        for _ in range(5):
            run(f"""
                def ask():
                    while True:
                        world.check([0], [1])
                        world.check_many(np.zeros((50, 1)), np.ones((50, 1)), threads={threads})
                for _ in range(3): threading.Thread(target=ask, daemon=True).start()
                time.sleep(0.05)
            """)
    # A change that waits for what never goes on ends with the script, too.
    run("""
        begun = threading.Event()
        asked = threading.Event()
        def state():
            if begun.is_set():
                asked.set()
                time.sleep(1000)
        add_own(state)
        begun.set()
        threading.Thread(target=lambda: world.check([0], [-2]), daemon=True).start()
        asked.wait()
        class AtTheEnd:
            def __del__(self): world.move("ball", [7, 0, 0])
        keep = AtTheEnd()
        sys.keep = keep
    """)


def test_a_daemon_thread_in_any_long_call_while_the_script_ends_does_no_harm():
    for call in ("world.robot.classify_link_pairs(progress=lambda part: time.sleep(0.01))",
                 "world.classify_link_pairs(progress=lambda part: time.sleep(0.01))",
                 "fcl_artic.World(arm()).setup()",
                 "world.report([0], [1], progress=lambda part: time.sleep(0.01))"):
        run(f"""
            def call():
                while True: {call}
            for _ in range(3): threading.Thread(target=call, daemon=True).start()
            time.sleep(0.1)
        """)


def test_a_thread_that_calls_any_function_once_the_script_has_ended_sleeps():
    said = run("""
        import atexit, os, threading, time
        ended, begun, returned = threading.Event(), [], []
        def at_the_end():  # after the module's own
            ended.set()
            while len(begun) < len(calls): time.sleep(0.01)
            time.sleep(0.1)
            print(len(begun), "called, returned:", *returned, flush=True)
            os._exit(0)
        atexit.register(at_the_end)
        import fcl_artic
        from fcl_artic import _fcl_artic

        def functions(owner, prefix):
            for name, value in vars(owner).items():
                if isinstance(value, type): yield from functions(value, name + ".")
                elif isinstance(value, property):
                    for kind in ("fget", "fset"):
                        if getattr(value, kind): yield prefix + name + " " + kind, getattr(value, kind)
                elif prefix + name != "__spec__" and callable(getattr(owner, name)):
                    function = getattr(owner, name)
                    if type(function).__name__ in ("builtin_function_or_method", "instancemethod"): yield prefix + name, function
        def call(name, function):
            ended.wait()
            begun.append(name)
            try: function()
            except BaseException: pass
            returned.append(name)
        threading.stack_size(1 << 18)
        calls = [threading.Thread(target=call, args=one, daemon=True) for one in functions(_fcl_artic, "")]
        for one in calls: one.start()
    """, begin="")
    count, returned = re.fullmatch(r"(\d+) called, returned:(.*)\n", said).groups()
    assert int(count) > 400 and returned == "", said


def test_a_full_disk_leaves_both_files_of_a_certificate_as_they_were(tmp_path):
    run(f"""
        import resource
        file = {str(tmp_path / "proof")!r}
        world.check([0], [1], certificate=True).certificate.save(file)
        before = open(file, "rb").read(), open(file + ".world").read()
        world.add("other", fcl_artic.sphere(0.1), [5, 5, 0])
        certificate = world.check([0], [1], certificate=True).certificate
        world_size, size = len(certificate.world), len(certificate.record())
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (max(world_size, size) - 1, resource.RLIM_INFINITY))
        try:
            certificate.save(file)
            assert False, "it was written"
        except OSError as error:
            assert "File too large" in str(error), error
        assert (open(file, "rb").read(), open(file + ".world").read()) == before
    """)


class Owner:
    """Something whose methods are callbacks."""

    def state(self, t):
        return np.eye(4)

    def bounds(self, begin, end):
        return 0, 0

    def progress(self, part):
        return True


def is_collected(make):
    """Whether what an owner holds, and is held by, goes away with it."""
    owner = Owner()
    owner.holds = make(owner)
    alive = weakref.ref(owner)
    del owner
    gc.collect()
    return alive() is None


def test_cycles_through_callbacks_are_collected(world):
    assert is_collected(lambda o: fcl_artic.Request(progress=o.progress))
    assert is_collected(lambda o: fcl_artic.Motion.bounded(o.state, o.bounds, derivatives=False))

    def in_a_world(owner):
        mine = fcl_artic.World(world.robot)
        mine.add_moving("own", fcl_artic.sphere(1), fcl_artic.Motion.bounded(owner.state, owner.bounds, False))
        return mine

    def in_bodies(owner):
        bodies = fcl_artic.Bodies()
        bodies.add("own", fcl_artic.sphere(1), fcl_artic.Motion.bounded(owner.state, owner.bounds, False))
        return bodies

    assert is_collected(in_a_world)
    assert is_collected(in_bodies)
    request = fcl_artic.Request(margin=0.25)
    request.progress = request.__repr__
    assert gc.is_tracked(request) and request in gc.get_objects()
    before = sum(isinstance(o, fcl_artic.Request) for o in gc.get_objects())
    del request
    gc.collect()
    assert sum(isinstance(o, fcl_artic.Request) for o in gc.get_objects()) < before


def test_what_is_held_is_not_collected(world):
    owner = Owner()
    world.add_moving("own", fcl_artic.sphere(0.01), fcl_artic.Motion.bounded(owner.state, owner.bounds, False))
    request = fcl_artic.Request(progress=owner.progress)
    alive = weakref.ref(owner)
    del owner
    for _ in range(3):
        gc.collect()
    assert alive() is not None and request.progress(1)
    assert world.check(np.zeros(world.dof), np.zeros(world.dof), request=request) is not None


def test_what_moved_goes_with_it(world):
    owner = Owner()
    alive = weakref.ref(owner)
    motion = fcl_artic.Motion.bounded(owner.state, owner.bounds, derivatives=False)
    del owner
    world.add_moving("own", fcl_artic.sphere(0.01), motion)
    del motion
    world.setup()
    assert alive() is not None
    world.remove("own")
    assert alive() is None


def test_a_motion_does_not_copy_its_callbacks_owner():
    owner = Owner()
    owner.copied = False
    motion = fcl_artic.Motion.bounded(owner.state, owner.bounds, derivatives=False)
    assert sys.getrefcount(owner) > 2  # held itself, and not in a copy
    assert np.array_equal(motion.pose(0.5), np.eye(4))
