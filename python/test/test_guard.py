# SPDX-License-Identifier: BSD-3-Clause
"""Objects that move by themselves, and the guard. A ball of radius 0.1 on a rail along x; the drives brake by 2 m/s²."""
import json
import math
import pickle
import threading

import numpy as np
import pytest

import fcl_artic

PERIOD = 0.05


def rail():
    tree = fcl_artic.KinematicTree("rail")
    tree.add_link("base")
    tree.add_link("cart")
    tree.add_joint(fcl_artic.Joint.prismatic("x", "base", "cart", [1, 0, 0], lower=-9, upper=9))
    robot = fcl_artic.Robot(tree)
    robot.add_geometry("cart", fcl_artic.sphere(0.1), np.eye(4))
    return robot


@pytest.fixture
def track():
    """The world with a ball of radius 0.1 at x = 5, and the way from 0 at 1 m/s, from t = 10 on."""
    robot = rail()
    world = fcl_artic.World(robot)
    world.add("ball", fcl_artic.sphere(0.1), [5, 0, 0])
    return world, fcl_artic.JointTrajectory.linear(robot, [10, 12, 14], [[0], [2], [4]])


def guard_of(world, trajectory, **options):
    guard = fcl_artic.Guard(world, deceleration=2, period=PERIOD, tries=20, **options)
    guard.follow(trajectory)
    return guard


def fastest(gap):
    """From rest: the period at f and the stop, f² / 4, fill the gap."""
    return 2 * (math.sqrt(PERIOD**2 + gap) - PERIOD)


def test_an_object_moves_for_as_long_as_the_trajectory_takes(track):
    world, trajectory = track
    assert world.check(trajectory).free
    world.set_object_speed("ball", 0.2)  # it comes 0.8 m near in 4 s, and the gap is 0.8 m at the end
    assert world.check(trajectory).contact
    world.set_object_speed("ball", 0.19)
    assert world.check(trajectory).free and "0.19" in world.tolerances
    world.set_object_speed("ball", 0.19, since=-1)
    assert world.check(trajectory).contact
    # By time: the gap is 4.8 - t - 0.5 t.
    world.set_object_speed("ball", 0.5)
    assert world.check(trajectory).t_lower == pytest.approx(10 + 4.8 / 1.5, abs=1e-4)
    world.reset_tolerances()
    assert world.check(trajectory).free and not world.tolerances


def test_no_motion_without_times_is_called_free(track, tmp_path):
    world, trajectory = track
    world.set_object_speed("ball", 0.1)
    asks = [
        lambda: world.check([0], [1]),
        lambda: world.check(fcl_artic.JointMotion.linear(world, [0], [1])),
        lambda: world.is_free([0], [1]),
        lambda: world.clearance([0], [1]),
        lambda: world.dump(tmp_path / "q.json", [0], [1]),
        lambda: world.check_trajectory([[0], [1]]),
        lambda: world.check_many(np.zeros((2, 1)), np.ones((2, 1))),
    ]
    for ask in asks:
        with pytest.raises(ValueError, match="times"):
            ask()
    assert world.check_trajectory([[0], [1]], [0, 2]).free
    (tmp_path / "no_times.csv").write_text("x\n0\n1\n")
    (tmp_path / "times.csv").write_text("t,x\n0,0\n2,1\n")
    part = [{"joint_trajectory": {"joint_names": ["x"], "points": [
        {"positions": [k], "time_from_start": {"sec": 0, "nanosec": 0}},
        {"positions": [k + 1], "time_from_start": {"sec": 2, "nanosec": 0}}]}} for k in (0, 1)]
    (tmp_path / "parts.json").write_text(json.dumps({"trajectory": part}))
    plans = {name: fcl_artic.load_plans(tmp_path / name, world.robot) for name in ("no_times.csv", "times.csv", "parts.json")}
    assert world.certify(plans["times.csv"][0]).free
    assert len(plans["parts.json"]) == 2
    for plan in plans["no_times.csv"] + plans["parts.json"] + pickle.loads(pickle.dumps(plans["parts.json"])):
        assert plan.error is None
        with pytest.raises(ValueError, match="moves by itself"):
            world.certify(plan)
    world.reset_tolerances()
    for ask in asks:
        ask()
    assert all(world.certify(plan).free for plan in plans["parts.json"])


@pytest.mark.parametrize("gap", [0.4, 0.2, 0.05, 1e-3])
def test_stops_before_a_wall(track, gap):
    world, trajectory = track
    world.move("ball", [1 + 0.2 + gap, 0, 0])
    answer = guard_of(world, trajectory).ask(fcl_artic.LiveScene(world, 0.0), now=0.0, path_time=11, path_speed=0)
    assert answer.certified and answer.valid_until == PERIOD
    if fastest(gap) >= 1:
        assert (answer.speed, answer.reason, answer.pair) == (1, fcl_artic.GuardReason.NONE, None)
    else:
        assert fastest(gap) - 1e-5 <= answer.speed <= fastest(gap)
        assert (answer.reason, answer.pair) == (fcl_artic.GuardReason.NEAR, ("cart", "ball"))
    assert answer.braking == pytest.approx(2) and answer.stop_time == pytest.approx(PERIOD + answer.speed / 2)


def test_a_scene_is_the_world_when_it_was_renewed(track):
    world, trajectory = track
    scene = fcl_artic.LiveScene(world, 0.0)
    guard = guard_of(world, trajectory)

    def speed(now=0.0):
        return guard.ask(scene, now, 11, 0).speed

    assert speed() == 1
    world.move("ball", [1.25, 0, 0])  # in place
    world.set_object_speed("ball", 1.6)
    assert speed() == 1, "the scene is what was seen"
    scene.renew(world, 0.02)
    assert scene.seen_at == 0.02 and "0.02" in repr(scene)
    assert speed(0.02) == 0
    world.reset_tolerances()
    world.attach("ball", "base", [3, 0, 0])
    world.detach("ball", [9, 0, 0])
    assert speed(0.02) == 0
    scene.renew(world, 0.04)
    assert speed(0.04) == 1
    world.remove("ball")
    world.add("near", fcl_artic.sphere(0.1), [1.21, 0, 0])
    assert speed(0.04) == 1
    scene.renew(world, 0.06)
    assert speed(0.06) == pytest.approx(fastest(0.01), abs=1e-5)
    for now in (0.05, 0.17):  # before it was seen; too old
        old = guard.ask(scene, now, 11, 1)
        assert (old.speed, old.certified, old.reason) == (0, False, fcl_artic.GuardReason.OLD_SCENE)


def test_looks_ahead(track):
    world, trajectory = track
    guard = guard_of(world, trajectory)
    assert guard.look_ahead(fcl_artic.LiveScene(world, 0.0), 0.0, 10).all_free
    world.move("ball", [3.2, 0, 0])  # touched at t = 13; a stop takes 1/4 of the path's time
    ahead = guard.look_ahead(fcl_artic.LiveScene(world, 0.0), 0.0, 10)
    assert not ahead.all_free and ahead.pair == ("cart", "ball")
    assert ahead.free_until == pytest.approx(13, abs=2e-3) and ahead.run_until == pytest.approx(12.75, abs=2e-3)


def test_answers_are_values(track):
    world, trajectory = track
    world.set_object_speed("ball", 1.6)
    world.set_object_tolerance("ball", 0.03)
    guard = guard_of(world, trajectory)
    scene = fcl_artic.LiveScene(world, 0.0)
    answer, ahead = guard.ask(scene, 0.0, 10, 0), guard.look_ahead(scene, 0.0, 10)
    for value in (answer, ahead, answer.separation):
        assert pickle.loads(pickle.dumps(value)) == value and type(value).__name__ in repr(value)
    assert answer == guard.ask(scene, 0.0, 10, 0)
    s = answer.separation
    assert s.object == pytest.approx(0.03) and s.human_reacting == pytest.approx(1.6 * PERIOD)
    assert s.sum == pytest.approx(s.human_reacting + s.human_stopping + s.robot_reacting + s.robot_stopping + 0.03)
    for value in (answer, ahead):
        with pytest.raises(TypeError, match="neither true nor false"):
            bool(value)


def test_refuses_what_no_guard_can_do(track, data):
    world, trajectory = track
    scene = fcl_artic.LiveScene(world, 0.0)
    for wrong in ({"period": 0}, {"reaction": -1}, {"most_age": math.nan}, {"margin": -1}, {"tries": 31},
                  {"deceleration": 0}, {"deceleration": [1, 2]}, {"work_budget": -1}, {"check_self": "no"}):
        with pytest.raises((ValueError, TypeError), match=next(iter(wrong)).split("_")[0]):
            fcl_artic.Guard(world, **{"deceleration": 1, **wrong})
    guard = fcl_artic.Guard(world.robot, deceleration=[2.0])
    with pytest.raises(RuntimeError, match="follow"):
        guard.ask(scene, 0.0, 10, 0)
    guard.follow(trajectory)
    with pytest.raises(ValueError, match="path_speed"):
        guard.ask(scene, 0.0, 10, 1.5)
    other = fcl_artic.World(fcl_artic.load_urdf(data / "puma560" / "puma560.urdf"))
    with pytest.raises(ValueError):
        guard.ask(fcl_artic.LiveScene(other, 0.0), 0.0, 10, 0)
    for seen_at in (math.nan, math.inf):
        with pytest.raises(ValueError, match="seen_at"):
            fcl_artic.LiveScene(world, seen_at)
        with pytest.raises(ValueError, match="seen_at"):
            scene.renew(world, seen_at)
    world.add_moving("cab", fcl_artic.sphere(0.1), fcl_artic.Motion.translation([9, 9, 0], [1, 0, 0]))
    for ask in (lambda: fcl_artic.LiveScene(world, 0.0), lambda: scene.renew(world, 0.0)):
        with pytest.raises(ValueError, match="'cab' has a motion of its own"):
            ask()
    assert scene.seen_at == 0 and guard.ask(scene, 0.0, 10, 0).speed == 1, "nothing has changed"


def test_threads_renew_while_others_ask(track):
    """The ball jumps between two places; every answer is that of one of them, and in the end that of the last one."""
    world, trajectory = track
    places = ([5, 0, 0], [1 + 0.2 + 0.05, 0, 0])
    speeds = (1.0, fastest(0.05))
    scene = fcl_artic.LiveScene(world, 0.0)
    shared = guard_of(world, trajectory)
    wrong, asked = [], [0, 0]
    stop = threading.Event()

    def ask(guard):
        while not stop.is_set():
            speed = guard.ask(scene, 0.0, 11, 0).speed
            known = [abs(speed - s) < 1e-5 for s in speeds]
            if any(known):
                asked[known.index(True)] += 1
            else:
                wrong.append(speed)

    threads = [threading.Thread(target=ask, args=(g,)) for g in (shared, shared, guard_of(world, trajectory))]
    for thread in threads:
        thread.start()
    for k in range(300):
        world.move("ball", places[k % 2])
        scene.renew(world, 0.0)
    stop.set()
    for thread in threads:
        thread.join()
    assert not wrong and sum(asked) > 0
    assert shared.ask(scene, 0.0, 11, 0).speed == pytest.approx(speeds[1], abs=1e-5)
