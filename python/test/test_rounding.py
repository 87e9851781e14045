# SPDX-License-Identifier: BSD-3-Clause
"""Calls from Python in all four rounding modes of the processor, and the mode afterwards."""
import ctypes
import platform

import numpy as np
import pytest

import fcl_artic

# FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO of <fenv.h>.
MODES = {"x86_64": (0, 0x800, 0x400, 0xC00), "aarch64": (0, 0x400000, 0x800000, 0xC00000)}.get(platform.machine())

# Brackets are 1e-6 wide, and their lower ends that far before the contact.
NEAR = 3e-6


@pytest.fixture(params=MODES or [])
def mode(request):
    """Sets the mode for one call, and tells whether it is there afterwards."""
    libm = ctypes.CDLL("libm.so.6")

    def call(function, *arguments, **options):
        libm.fesetround(request.param)
        try:
            return function(*arguments, **options)
        finally:
            after = libm.fegetround()
            libm.fesetround(0)
            assert after == request.param

    return call


def test_motions_are_answered_alike_in_all_rounding_modes(mode, shared_world, hit, miss):
    usual = shared_world.check(*hit)
    result = mode(shared_world.check, *hit)
    assert result.contact and result.certain and result.pair == usual.pair
    assert abs(result.t_lower - usual.t_lower) < NEAR
    assert mode(shared_world.check, *miss, certificate=True).free
    assert mode(shared_world.is_free, *miss) and not mode(shared_world.is_free, *hit)
    clearance = mode(shared_world.clearance, *miss)
    assert 0 < clearance.lower <= shared_world.clearance(*miss).upper


def test_arrays_are_answered_alike_in_all_rounding_modes(mode, shared_world, hit, miss):
    starts, ends = np.array([hit[0], miss[0]] * 4), np.array([hit[1], miss[1]] * 4)
    usual, said = shared_world.check_many(starts, ends, 2), mode(shared_world.check_many, starts, ends, 2)
    assert (said.status == usual.status).all() and (said.certain == usual.certain).all()
    assert np.allclose(said.t_lower, usual.t_lower, rtol=0, atol=NEAR)
    floats = mode(shared_world.check, hit[0].astype(np.float32), hit[1].astype(np.float32))
    assert floats.contact and abs(floats.t_lower - usual.t_lower[0]) < 1e-4
    waypoints = np.array([miss[0], miss[1], miss[0]])
    trajectory = mode(shared_world.check_trajectory, waypoints, [0, 0.7, 1.9])
    assert trajectory.free


def test_a_wheel_goes_the_way_that_was_asked_for_in_all_rounding_modes(mode):
    tree = fcl_artic.KinematicTree("wheel")
    tree.add_link("world")
    tree.add_link("wheel")
    tree.add_joint(fcl_artic.Joint.continuous("turn", "world", "wheel", [0, 0, 1]))
    for begin, end, way in ((0, 0.6, 0.6), (0.1, 6.2, 6.1 - 2 * np.pi), (-3, 3, 6 - 2 * np.pi), (0, 40, 40 - 12 * np.pi)):
        motion = mode(fcl_artic.JointMotion.shortest, tree, [begin], [end])
        assert abs(motion.dq[0] - way) < 1e-12


def test_files_are_read_alike_in_all_rounding_modes(mode, data, tmp_path, hit):
    robot = mode(fcl_artic.load_urdf, data / "puma560" / "puma560.urdf")
    scene = mode(fcl_artic.load_scene, data / "pipes.obj")
    two = mode(fcl_artic.combine_robots, [(robot, "left_"), (robot, "right_", [2, 0, 0])])
    assert len(two.tree.variables) == 12
    world = mode(fcl_artic.World, robot, scene)
    mode(world.setup)
    usual = fcl_artic.World(fcl_artic.load_urdf(data / "puma560" / "puma560.urdf"), scene).check(*hit)
    result = mode(world.check, *hit)
    assert result.contact and abs(result.t_lower - usual.t_lower) < NEAR
    plan = tmp_path / "plan.csv"
    names = robot.tree.variables
    plan.write_text(",".join(["time", *names]) + "\n0," + ",".join(["0.1"] * 6) + "\n1.5," + ",".join(["-0.3"] * 6))
    (read,) = mode(fcl_artic.load_plans, plan, robot)
    assert np.allclose(read.waypoints, [[0.1] * 6, [-0.3] * 6], rtol=0, atol=1e-15)
    assert np.allclose(read.times, [0, 1.5], rtol=0, atol=1e-15)
