# SPDX-License-Identifier: BSD-3-Clause
"""An object that goes to another process comes back as it was."""
import os
import pickle
import shutil

import numpy as np
import pytest

import fcl_artic
from conftest import random_motions
from test_robot import SHAPES


def copied(value):
    return pickle.loads(pickle.dumps(value))


def test_a_result_keeps_all_its_fields(shared_world, hit):
    result = shared_world.check(*hit, mode="first_of_every_pair", certificate=True)
    copy = copied(result)
    assert repr(copy) == repr(result) and copy.statistics == result.statistics
    for name in ("status", "t_lower", "t_upper", "certain", "pair", "unproven_allowed_pairs"):
        assert getattr(copy, name) == getattr(result, name)
    assert np.array_equal(copy.link_poses, result.link_poses)
    assert len(copy.contacts) == len(result.contacts) > 1
    for a, b in zip(copy.contacts, result.contacts):
        assert repr(a) == repr(b) and np.array_equal(a.point, b.point) and np.array_equal(a.nearest2, b.nearest2)
        assert (a.body1.link, a.piece1, a.feature, a.approach_speed) == (b.body1.link, b.piece1, b.feature, b.approach_speed)
    assert copy.certificate.record() == result.certificate.record()


def test_a_request_keeps_all_its_options(shared_world, hit):
    redon = fcl_artic.RedonOptions(newton=True, refinement_level=2)
    assert repr(copied(redon)) == repr(redon) != repr(fcl_artic.RedonOptions())
    request = fcl_artic.Request(mode="any", margin=0.02, method="redon2004", redon=redon, check_self=False)
    copy = copied(request)
    assert repr(copy) == repr(request) and copy.redon.refinement_level == 2
    # A number of contacts that nobody chose follows the mode still.
    for again in (request, copy):
        assert len(shared_world.check(*hit, request=again, mode="first_of_every_pair", margin=0).contacts) > 1
    one = copied(fcl_artic.Request(max_contacts=1))
    assert len(shared_world.check(*hit, request=one, mode="first_of_every_pair").contacts) == 1


def test_other_answers_keep_all_their_fields(shared_world, robot, miss):
    clearance = shared_world.clearance(*miss)
    copy = copied(clearance)
    assert repr(copy) == repr(clearance) and copy.lower == clearance.lower and copy.pair == clearance.pair
    line = fcl_artic.tool_deviation(robot, fcl_artic.JointMotion.linear(robot, *miss), robot.tree.links[-1])
    copy = copied(line)
    assert repr(copy) == repr(line) and copy.distance_lower == line.distance_lower and copy.within_tolerance
    answers = shared_world.check_many(*random_motions(robot, 20, angle=0.5))
    copy = copied(answers)
    assert np.array_equal(copy.status, answers.status) and np.array_equal(copy.pair, answers.pair)
    assert copy.pair_names(0) == answers.pair_names(0)
    ball = fcl_artic.sphere(0.5)
    pair = fcl_artic.continuous_collide(ball, fcl_artic.Motion.translation([-5, 0, 0], [10, 0, 0]), ball, np.eye(4))
    copy = copied(pair)
    assert repr(copy) == repr(pair) and np.array_equal(copy.pose1_at_upper, pair.pose1_at_upper)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.kind)
def test_a_shape_answers_as_before(shape):
    copy = copied(shape)
    assert copy.kind == shape.kind and repr(copy) == repr(shape) and copy.solid == shape.solid
    down = fcl_artic.Motion.translation([0.05, 0.05, 10], [0, 0, -20])
    before, after = (fcl_artic.continuous_collide(fcl_artic.sphere(0.2), down, s, np.eye(4)) for s in (shape, copy))
    assert (before.status, before.t_lower, before.t_upper) == (after.status, after.t_lower, after.t_upper)


def test_a_robot_answers_as_before_without_its_files(data, tmp_path, scene, hit):
    folder = tmp_path / "puma560"
    shutil.copytree(data / "puma560", folder)
    robot = fcl_artic.load_urdf(folder / "puma560.urdf")
    pickled = pickle.dumps(robot)
    before = fcl_artic.World(robot, scene).check(*hit)
    shutil.rmtree(folder)
    copy = pickle.loads(pickled)
    assert copy.tree.links == robot.tree.links and copy.notes == robot.notes
    after = fcl_artic.World(copy, copied(scene)).check(*hit)
    assert (after.status, after.pair) == (before.status, before.pair)
    # Joints are made orthonormal again, which may move a last bit.
    assert abs(after.t_lower - before.t_lower) <= 2e-6
    # Motions of the one are taken by the other.
    motion = fcl_artic.JointMotion.linear(robot, *hit)
    assert motion.is_of(copy)


def test_meshes_that_links_share_are_pickled_once():
    tree = fcl_artic.KinematicTree()
    tree.add_link("a")
    random = np.random.default_rng(1)
    mesh = fcl_artic.mesh(random.normal(size=(1000, 3)), random.integers(0, 1000, (2000, 3)))
    one, two = fcl_artic.Robot(tree), fcl_artic.Robot(tree)
    one.add_geometry("a", mesh)
    for z in (0, 1):
        two.add_geometry("a", mesh, [0, 0, z])
    assert len(pickle.dumps(two)) < 1.1 * len(pickle.dumps(one))


def test_allowed_pairs_go_along_and_proofs_are_left_out(data):
    robot = fcl_artic.load_urdf(data / "puma560" / "puma560.urdf")
    report = robot.classify_link_pairs(samples=50)
    robot.allowed, robot.proofs = report.need_no_check, report.proofs
    copy = copied(robot)
    assert copy.allowed == robot.allowed


def motions_of(robot, q0, q1):
    """One of each maker."""
    M, T = fcl_artic.JointMotion, fcl_artic.JointTrajectory
    points, zeros = [q0, q1, q0], np.zeros((3, robot.dof))
    coefficients = np.column_stack([q0, q1 - q0, 0.1 * q1])
    return [
        M.linear(robot, q0, q1),
        M.shortest(robot, q0, q1),
        M.still(robot, q0),
        M.polynomial(robot, coefficients),
        M.tangent_half_angle(robot, q0, q1, 0.1 * q0),
        M.tangent_half_angle_polynomial(robot, coefficients),
        T.linear(robot, [10, 12, 15], points),
        T.tangent_half_angle(robot, [10, 12, 15], points),
        T.cubic(robot, [0, 1, 3], points, zeros),
        T.quintic(robot, [0, 1, 3], points, zeros, zeros),
        T.parabolic_blends(robot, [0, 1, 3], points, 0.2),
        T.bspline(robot, 1, [0, 0, 1, 2, 2], points),
        T.piecewise(robot, [0, 1], [coefficients]),
        T.linear(robot, [10, 12, 15], points).piece(1),
    ]


def test_a_motion_of_joints_is_the_same_to_the_last_bit(robot, shared_world, hit):
    for motion in motions_of(robot, *hit):
        copy = copied(motion)
        assert repr(copy) == repr(motion) and type(copy) is type(motion)
        for t in np.linspace(0, 15, 31):
            assert np.array_equal(copy.configuration(t), motion.configuration(t))
        before, after = shared_world.check(motion), shared_world.check(copy)
        assert (before.status, before.t_lower, before.t_upper) == (after.status, after.t_lower, after.t_upper)


def test_a_pickled_motion_does_not_follow_its_arrays(robot, hit):
    q0, q1 = np.array(hit)
    motion = fcl_artic.JointMotion.linear(robot, q0, q1)
    wanted = motion.configuration(0.5)
    q0 += 1
    assert np.array_equal(copied(motion).configuration(0.5), wanted)


def test_the_in_between_motion_is_pickled(robot, hit):
    poses = [robot.tree.forward_kinematics(q) for q in hit]
    motion = fcl_artic.in_between_motion(fcl_artic.in_between_tree(robot), *poses)
    assert np.array_equal(copied(motion).configuration(0.3), motion.configuration(0.3))


def steady(t):
    return fcl_artic.pose([t, 0, 0])


def at_most(begin, end):
    return 1, 0


def test_a_motion_of_a_rigid_body_is_the_same(robot, hit):
    M, one = fcl_artic.Motion, fcl_artic.pose([1, 2, 3])
    spline = np.random.default_rng(3).normal(size=(2, 4, 3))
    motions = [M.still(one), M.translation(one, [1, 0, 0]), M.linear(np.eye(4), one), M.screw(np.eye(4), one),
               M.spline(*spline), M.of_link(robot, fcl_artic.JointMotion.linear(robot, *hit), "flange"),
               M.bounded(steady, at_most, derivatives=False)]
    for motion in motions:
        copy = copied(motion)
        assert copy.kind == motion.kind
        for t in (0, 0.3, 1):
            assert np.array_equal(copy.pose(t), motion.pose(t))
    # If pickle cannot find an object by its name, it refuses the object.
    with pytest.raises((AttributeError, pickle.PicklingError)):
        pickle.dumps(M.bounded(lambda t: np.eye(4), at_most, derivatives=False))


def ask(arguments):
    robot, scene, q0, q1 = arguments
    return os.getpid(), fcl_artic.World(robot, scene).check(q0, q1)


def test_a_pool_of_processes_asks(robot, scene, hit, miss):
    import multiprocessing

    with multiprocessing.get_context("spawn").Pool(1) as pool:
        answers = pool.map(ask, [(robot, scene, *hit), (robot, scene, *miss)])
    assert [a.contact for _, a in answers] == [True, False]
    assert answers[0][0] != os.getpid()


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_every_protocol_pickles(protocol, robot):
    for value in (fcl_artic.box((1, 2, 3)), robot, fcl_artic.Request(margin=0.25)):
        copy = pickle.loads(pickle.dumps(value, protocol))
        assert type(copy) is type(value)
    assert repr(pickle.loads(pickle.dumps(robot, protocol))) == repr(robot)


def test_what_a_robot_says_of_neighbours_is_pickled(robot):
    robot = copied(robot)
    robot.allowed_complete = True
    robot.allowed = [robot.tree.links[:2]]
    again = copied(robot)
    assert again.allowed_complete and again.allowed == robot.allowed


def test_pairs_that_a_robot_has_checked_are_pickled(robot):
    state = list(robot.__getstate__())
    links = robot.tree.links
    state[6] = frozenset(zip(links, links[1:]))
    checked = type(robot).__new__(type(robot))
    checked.__setstate__(tuple(state))
    assert len(checked.__getstate__()[6]) == len(links) - 1
    assert copied(checked).__getstate__()[6] == checked.__getstate__()[6]
