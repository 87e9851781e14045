# SPDX-License-Identifier: BSD-3-Clause
"""Rigid bodies that move freely."""
import math

import numpy as np
import pytest

import fcl_artic
from test_robot import CUBE

CUBE_MESH = fcl_artic.mesh(CUBE)


def test_two_meshes_meet_when_they_should():
    towards = fcl_artic.Motion.translation([-5, 0, 0], [10, 0, 0])
    result = fcl_artic.continuous_collide(CUBE_MESH, towards, CUBE_MESH, fcl_artic.pose([0, 0.3, 0.4]))
    # Faces meet when the centres are 2 m apart, after 3 of 10 m.
    assert result.contact and result.certain
    assert result.t_lower <= 0.3 <= result.t_upper and result.t_upper - result.t_lower <= 1e-6
    assert np.allclose(result.pose1_at_lower[:3, 3], [-2, 0, 0], atol=1e-5)
    assert np.allclose(np.abs(result.first.normal), [1, 0, 0], atol=1e-6)
    assert result.first.piece1 is not None and "contact within" in repr(result)


def test_what_a_free_says_nothing_of_is_said():
    ball, wall = fcl_artic.sphere(0.1), fcl_artic.box([1, 4, 4])
    inside, out = fcl_artic.Motion.translation([0, 0, 0], [0.1, 0, 0]), fcl_artic.Motion.translation([0, 0, 0], [5, 0, 0])
    bodies = fcl_artic.Bodies()
    bodies.add("wall", wall, np.eye(4))
    for motion, never, text in ((inside, 1, "but for 1 pair that never comes apart"), (out, 0, "but for the initial contact of 1 pair")):
        pair = fcl_artic.continuous_collide(ball, motion, wall, np.eye(4), ignore_initial_contact=True)
        assert pair.free and pair.ignored_initial_contact and pair.never_apart == bool(never)
        assert repr(pair) == f"<PairResult: free: proven, {text}>" and text in str(pair)
        bodies.add("ball", ball, motion)
        found = bodies.check(ignore_initial_contact=True)
        assert found.free and found.never_apart_pairs == never and len(found.ignored_initial_contacts) == 1
        assert repr(found) == f"<BodiesResult: free: proven, {text}>"
        bodies.remove("ball")
    assert bodies.check(ignore_initial_contact=True).never_apart_pairs == 0


def test_every_kind_of_motion_has_its_ends():
    begin, end = fcl_artic.pose([0, 0, 1]), fcl_artic.pose([1, 2, 3], rpy=[0.2, 0.4, 0.6])
    for motion in (fcl_artic.Motion.linear(begin, end), fcl_artic.Motion.screw(begin, end)):
        assert np.allclose(motion.pose(0), begin) and np.allclose(motion.pose(1), end)
    slid = fcl_artic.Motion.translation(begin, [1, 0, 0])
    assert np.allclose(slid.pose(0.5)[:3, 3], [0.5, 0, 1])
    assert np.allclose(fcl_artic.Motion.still(end).pose(0.7), end)
    spline = fcl_artic.Motion.spline(np.ones((4, 3)), np.zeros((4, 3)))
    assert np.allclose(spline.pose(0.5)[:3, 3], 1)


def test_the_origin_of_a_linear_motion_goes_straight():
    ball, random = fcl_artic.sphere(0.5), np.random.default_rng(11)
    for _ in range(300):
        garbage = [np.full(n, np.nan) for n in range(3, 60)]  # what memory holds that is not written to
        del garbage
        begin, end = (fcl_artic.pose([x, 0, 0], rpy=random.uniform(-1.5, 1.5, 3)) for x in (-5, 5))
        motion = fcl_artic.Motion.linear(begin, end)
        for t in (0, 0.25, 1):
            assert np.allclose(motion.pose(t)[:3, 3], [-5 + 10 * t, 0, 0], atol=1e-9)
        result = fcl_artic.continuous_collide(ball, motion, ball, np.eye(4))
        assert result.certain and abs(result.t_lower - 0.4) < 1e-5


def test_a_link_moves_as_its_robot_does(robot, shared_world, hit):
    motion = fcl_artic.JointMotion.linear(robot, *hit)
    link = fcl_artic.Motion.of_link(robot, motion, "wrist_roll")
    assert np.allclose(link.pose(0.5), robot.tree.link_pose("wrist_roll", motion.configuration(0.5)))


def test_what_is_no_motion_is_refused():
    with pytest.raises(TypeError, match="motion_b is no Motion"):
        fcl_artic.continuous_collide(CUBE_MESH, np.eye(4), CUBE_MESH, "still")
    with pytest.raises(TypeError, match="motion_a is no Motion"):
        fcl_artic.continuous_collide(CUBE_MESH, (np.eye(4), np.eye(4)), CUBE_MESH, np.eye(4))
    with pytest.raises(ValueError, match="motion_b|pose"):
        fcl_artic.continuous_collide(CUBE_MESH, np.eye(4), CUBE_MESH, np.zeros((3, 3)))
    with pytest.raises(TypeError, match="check_self"):
        fcl_artic.continuous_collide(CUBE_MESH, np.eye(4), CUBE_MESH, np.eye(4), check_self=True)
    with pytest.raises(TypeError, match="geometry_a"):
        fcl_artic.continuous_collide(7, np.eye(4), CUBE_MESH, np.eye(4))


def swing(angle, radius):
    """A motion of one's own: about z on a circle, by `angle` in all."""

    def state(t):
        c, s = math.cos(angle * t), math.sin(angle * t)
        return (
            fcl_artic.pose([radius * c, radius * s, 0], rpy=[0, 0, angle * t]),
            [-radius * angle * s, radius * angle * c, 0],
            [-radius * angle**2 * c, -radius * angle**2 * s, 0],
            [0, 0, angle],
            [0, 0, 0],
        )

    def bounds(begin, end):
        return [radius * angle, radius * angle**2, radius * angle**3, angle, 0, 0]

    return fcl_artic.Motion.bounded(state, bounds)


def test_a_motion_of_ones_own_is_proven_by_its_bounds():
    ball, post = fcl_artic.sphere(0.1), fcl_artic.sphere(0.1)
    result = fcl_artic.continuous_collide(ball, swing(math.pi, 2.0), post, fcl_artic.pose([0, 2, 0]))
    # The centres, on a circle of radius 2, are 0.2 apart when the angle between them is 2 asin(0.05).
    expected = (math.pi / 2 - 2 * math.asin(0.05)) / math.pi
    assert result.contact and result.t_lower <= expected <= result.t_upper


def test_an_error_in_a_motion_of_ones_own_comes_through():
    def state(t):
        raise LookupError("no such time")

    broken = fcl_artic.Motion.bounded(state, lambda a, b: [1] * 6)
    with pytest.raises(LookupError, match="no such time"):
        fcl_artic.continuous_collide(CUBE_MESH, broken, CUBE_MESH, np.eye(4))
    # A pose that may be left out elsewhere: who forgets to return one does not mean the identity.
    for state, derivatives in ((lambda t: None, False), (lambda t: None, True), (lambda t: (None, *[[0, 0, 0]] * 4), True)):
        silent = fcl_artic.Motion.bounded(state, lambda a, b: [1] * (6 if derivatives else 2), derivatives=derivatives)
        with pytest.raises(TypeError, match="returned None"):
            fcl_artic.continuous_collide(CUBE_MESH, silent, CUBE_MESH, fcl_artic.pose([5, 0, 0]))
    few = fcl_artic.Motion.bounded(lambda t: np.eye(4), lambda a, b: [1], derivatives=False)
    with pytest.raises(TypeError, match="2 values"):
        fcl_artic.continuous_collide(CUBE_MESH, few, CUBE_MESH, np.eye(4))


def test_many_bodies_are_checked_against_each_other():
    bodies = fcl_artic.Bodies()
    bodies.add("left", fcl_artic.sphere(0.5), fcl_artic.Motion.translation([-5, 0, 0], [10, 0, 0]))
    bodies.add("right", fcl_artic.sphere(0.5), fcl_artic.Motion.translation([5, 0, 0], [-10, 0, 0]))
    bodies.add("far", fcl_artic.sphere(0.5), fcl_artic.pose([0, 50, 0]))
    result = bodies.check()
    assert result.contact and [(p.name1, p.name2) for p in result.pairs] == [("left", "right")]
    assert result.t_lower <= 0.45 <= result.t_upper
    bodies.set_motion("right", fcl_artic.Motion.still([5, 5, 0]))
    assert bodies.check().free
    lower, upper = bodies.swept_box("left")
    assert (lower <= [-5.5, -0.5, -0.5]).all() and (upper >= [5.5, 0.5, 0.5]).all()
    still = fcl_artic.Bodies()
    still.add("wall", fcl_artic.box([0.1, 2, 2]), np.eye(4))
    against = bodies.check_against(still)
    assert against.contact and against.pairs[0].name2 == "wall"
    assert bodies.names == ["left", "far", "right"] or set(bodies.names) == {"left", "far", "right"}
    bodies.remove("far")
    assert len(bodies) == 2 and "far" not in bodies
    with pytest.raises(ValueError, match="did you mean 'left'"):
        bodies.remove("lefft")
    with pytest.raises(ValueError, match="already"):
        bodies.add("left", fcl_artic.sphere(1), np.eye(4))
