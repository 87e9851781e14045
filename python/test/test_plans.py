# SPDX-License-Identifier: BSD-3-Clause
"""Plans of files: load_plans() and World.certify()."""
import json
import pickle

import numpy as np
import pytest

import fcl_artic

FROM = [-2.1, 1.0, -1.0, -0.1, -0.1, 0.0]
TO = [-0.1, 0.3, -2.3, -1.0, 1.1, 0.0]
ASIDE = [0.9, 0.4, -2.0, 0.0, 0.2, 0.0]


def test_numpys_own_file_and_json_say_what_check_trajectory_says(shared_world, robot, tmp_path):
    times = np.array([0.5, 2.5])
    names = robot.tree.variables
    np.savez(tmp_path / "a.npz", positions=[FROM, TO], times=times, joint_names=names)
    np.savez_compressed(tmp_path / "b.npz", q=np.array([FROM[::-1], TO[::-1]], order="F"), t=times, joints=names[::-1])
    np.savetxt(tmp_path / "c.csv", np.column_stack([times, [FROM, TO]]), delimiter=",", fmt="%.17g", comments="",
               header=",".join(["time", *names]))
    (tmp_path / "d.json").write_text(json.dumps({"joints": list(names), "times": list(times), "waypoints": [FROM, TO]}))
    wanted = shared_world.check_trajectory([FROM, TO], times)
    assert not wanted.free
    for file in ("a.npz", "b.npz", "c.csv", "d.json"):
        (plan,) = fcl_artic.load_plans(tmp_path / file, robot)
        assert plan.error is None and plan.interpolation == "linear", file
        assert np.array_equal(plan.waypoints, [FROM, TO]) and np.array_equal(plan.times, times)
        result = shared_world.certify(plan)
        assert (result.t_lower, result.t_upper, result.pair) == (wanted.t_lower, wanted.t_upper, wanted.pair)
        assert plan.waypoint_before(result.t_lower) == 0
        assert str(shared_world.check(plan.trajectory)) == str(wanted)
    np.save(tmp_path / "many.npy", np.array([[FROM, ASIDE], [FROM, TO]]))
    verdicts = [shared_world.certify(plan).free for plan in fcl_artic.load_plans(tmp_path / "many.npy", robot)]
    assert verdicts == [True, False]


def test_logs_of_others_are_read(robot, tmp_path):
    rows = np.column_stack([[0.5, 2.5], [FROM, TO]])
    np.savetxt(tmp_path / "bare.csv", rows)
    (plan,) = fcl_artic.load_plans(tmp_path / "bare.csv", robot)
    assert np.allclose(plan.waypoints, [FROM, TO], atol=1e-15) and list(plan.times) == [0.5, 2.5]
    assert plan.notes[0].startswith("its columns are taken so: time = column 0, joint1 = column 1")
    log = np.column_stack([rows[:, 0], np.degrees(rows[:, 1:]), [7, 7]])
    np.savetxt(tmp_path / "log.csv", log, delimiter=";", comments="", header="stamp;q1;q2;q3;q4;q5;q6;gripper")
    (plan,) = fcl_artic.load_plans(tmp_path / "log.csv", robot, skip=["gripper"], time="stamp", degrees=True)
    assert np.allclose(plan.waypoints, [FROM, TO], atol=1e-12)
    columns = ["time", *robot.tree.variables, "-"]
    (plan,) = fcl_artic.load_plans(tmp_path / "log.csv", robot, columns=columns, degrees=True)
    assert np.allclose(plan.waypoints, [FROM, TO], atol=1e-12)
    (plan,) = fcl_artic.load_plans(tmp_path / "log.csv", robot, columns=columns)
    assert "are these degrees?" in plan.error
    with pytest.raises(ValueError, match="leave skip and time out"):
        fcl_artic.load_plans(tmp_path / "log.csv", robot, columns=columns, time="stamp")


def test_what_is_wrong_is_said(shared_world, robot, tmp_path):
    file = tmp_path / "plans.jsonl"
    file.write_text(json.dumps({"waypoints": [FROM, ASIDE]}) + "\n" + json.dumps({"waypoints": [FROM, ASIDE[:5]]}))
    good, bad = fcl_artic.load_plans(file, robot)
    assert good.error is None and shared_world.certify(good).free
    assert bad.error == "waypoint 1 has 5 positions for 6 joints" and bad.times is None and bad.waypoints is None
    for use in (lambda: bad.trajectory, lambda: shared_world.certify(bad), lambda: bad.waypoint_before(0)):
        with pytest.raises(ValueError, match="waypoint 1 has 5 positions"):
            use()
    with pytest.raises(TypeError, match="plan is no Plan but PosixPath; load_plans"):
        shared_world.certify(file)
    with pytest.raises(FileNotFoundError):
        fcl_artic.load_plans(tmp_path / "nothing.csv", robot)
    with pytest.raises(ValueError, match="none of .csv"):
        fcl_artic.load_plans(tmp_path / "nothing.plan", robot)
    file.write_text("")
    with pytest.raises(ValueError, match="plans.jsonl.*no plan in it"):
        fcl_artic.load_plans(file, robot)
    for options in ({"interpolation": "wild"}, {"turns": "wild"}, {"interpolation": "blends"}, {"format": "wild"}):
        with pytest.raises(ValueError, match="wild|blends"):
            fcl_artic.load_plans(file, robot, **options)


def test_a_carried_object_is_asked_for(robot, tmp_path):
    points = [{"positions": FROM, "time_from_start": 0}, {"positions": ASIDE, "time_from_start": 1}]
    message = {"trajectory": [{"joint_trajectory": {"joint_names": list(robot.tree.variables), "points": points}}],
               "trajectory_start": {"attached_collision_objects": [{"object": {"id": "cup"}}]}}
    (tmp_path / "plan.json").write_text(json.dumps(message))
    (plan,) = fcl_artic.load_plans(tmp_path / "plan.json", robot)
    assert plan.carried == ["cup"]
    world = fcl_artic.World(robot)
    with pytest.raises(ValueError, match="carries 'cup'"):
        world.certify(plan)


def test_every_carried_object_is_attached_by_its_name(robot, tmp_path):
    points = [{"positions": FROM, "time_from_start": 0}, {"positions": ASIDE, "time_from_start": 1}]
    message = {"trajectory": [{"joint_trajectory": {"joint_names": list(robot.tree.variables), "points": points}}],
               "trajectory_start": {"attached_collision_objects": [
                   {"link_name": "flange", "object": {"id": "cup"}}, {"link_name": "flange", "object": {"id": "spoon"}}]}}
    (tmp_path / "plan.json").write_text(json.dumps(message))
    (plan,) = fcl_artic.load_plans(tmp_path / "plan.json", robot)
    assert plan.carried == ["cup", "spoon"] and plan.joints == list(robot.tree.variables)
    world = fcl_artic.World(robot)
    for name in ("cup", "plate"):
        world.add(name, fcl_artic.sphere(0.01), [0, 0, 9])
        world.attach(name, "flange", [0, 0, 0.3])
    with pytest.raises(ValueError, match=r"carries 'spoon': World.attach\(\) says what that is; .* 'cup', 'plate'"):
        world.certify(plan)
    world.add("spoon", fcl_artic.sphere(0.01), [0, 0, 9])
    world.attach("spoon", "upper_arm", [0, 0, 0.9])
    with pytest.raises(ValueError, match="link 'flange' carries 'spoon', and it is attached to 'upper_arm'"):
        world.certify(plan)
    world.detach("spoon")
    world.attach("spoon", "flange", [0, 0, 0.5])
    assert world.certify(plan).status is not None


def test_a_plans_trajectory_is_one(robot, tmp_path):
    times = [0.5, 2.5]
    (tmp_path / "a.json").write_text(json.dumps({"times": times, "waypoints": [FROM, TO]}))
    (plan,) = fcl_artic.load_plans(tmp_path / "a.json", robot)
    trajectory = plan.trajectory
    assert type(trajectory) is fcl_artic.JointTrajectory and repr(trajectory).startswith("<JointTrajectory of 1 piece ")
    assert (trajectory.begin_time, trajectory.end_time, len(trajectory)) == (0.5, 2.5, 1)
    assert np.array_equal(trajectory.configuration(0.5), FROM)
    copy = pickle.loads(pickle.dumps(trajectory))
    for t in np.linspace(*times, 7):
        assert np.array_equal(copy.configuration(t), trajectory.configuration(t))


def test_plans_are_pickled(shared_world, robot, tmp_path):
    points = [{"positions": FROM, "velocities": 6 * [0.1], "time_from_start": 0},
              {"positions": TO, "velocities": 6 * [0.0], "time_from_start": 1}]
    message = {"trajectory": [{"joint_trajectory": {"joint_names": list(robot.tree.variables), "points": points}}],
               "trajectory_start": {"attached_collision_objects": [{"link_name": "flange", "object": {"id": "cup"}}]}}
    (tmp_path / "a.json").write_text(json.dumps(message))
    (tmp_path / "b.jsonl").write_text(json.dumps({"name": "good", "waypoints": [FROM, ASIDE]}) + "\n" +
                                      json.dumps({"name": "bad", "waypoints": [FROM, ASIDE[:5]]}))
    np.savetxt(tmp_path / "c.csv", np.degrees([FROM, ASIDE]), delimiter=",")
    plans = fcl_artic.load_plans(tmp_path / "a.json", robot) + fcl_artic.load_plans(tmp_path / "b.jsonl", robot)
    plans += fcl_artic.load_plans(tmp_path / "c.csv", robot, degrees=True)
    for plan in plans:
        copy = pickle.loads(pickle.dumps(plan))
        assert type(copy) is fcl_artic.Plan and repr(copy) == repr(plan)
        for name in ("name", "error", "interpolation", "joints", "carried", "notes"):
            assert getattr(copy, name) == getattr(plan, name), name
        if plan.error:
            continue
        assert np.array_equal(copy.times, plan.times) and np.array_equal(copy.waypoints, plan.waypoints)
        for t in np.linspace(plan.times[0], plan.times[-1], 9):
            assert np.array_equal(copy.trajectory.configuration(t), plan.trajectory.configuration(t))
        if not plan.carried:
            assert str(shared_world.certify(copy)) == str(shared_world.certify(plan))
    assert plans[0].interpolation == "cubic" and plans[0].carried == ["cup"] and plans[2].error


def test_no_note_gets_lost(robot, tmp_path):
    """Units that a comment speaks of are noted: for a plan, for one that is wrong, and for their copies."""
    for last, wrong in ((ASIDE, False), ([100.0] + ASIDE[1:], True)):
        rows = [",".join(robot.tree.variables)] + [",".join(map(str, q)) for q in (FROM, last)]
        (tmp_path / "a.csv").write_text("# angles in degrees, lengths in mm\n" + "\n".join(rows) + "\n")
        (plan,) = fcl_artic.load_plans(tmp_path / "a.csv", robot)
        assert bool(plan.error) == wrong
        for copy in (plan, pickle.loads(pickle.dumps(plan))):
            assert [("angles are taken" in note, "lengths are taken" in note) for note in copy.notes] == [(True, False), (False, True)]
