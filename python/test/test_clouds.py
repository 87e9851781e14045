# SPDX-License-Identifier: BSD-3-Clause
"""Frames of sensors: arrays as they come, fewer balls that hold all, points on the robot."""
import pickle
import warnings

import numpy as np
import pytest

import fcl_artic


def frame(dtype, points):
    """Points as an array of a PointCloud2's rows, garbage in all that is none of x, y, z."""
    rows = np.frombuffer(np.random.default_rng(2).bytes(len(points) * np.dtype(dtype).itemsize), dtype).copy()
    for k, name in enumerate("xyz"):
        rows[name] = points[:, k]
    return rows


PLAIN = [("x", "f4"), ("y", "f4"), ("z", "f4")]
PADDED = {"names": ["x", "y", "z", "rgb"], "formats": ["f4", "f4", "f4", "u4"], "offsets": [0, 4, 8, 16], "itemsize": 32}
ODD = {"names": ["ring", "z", "x", "y"], "formats": ["u2", "f8", "f8", "f8"], "offsets": [0, 3, 11, 19], "itemsize": 31}
MIXED = [("x", "f4"), ("i", "u1"), ("y", "f8"), ("z", ">f4")]


def state(cloud):
    """Points, radii and the number of rows left out."""
    return cloud.__getstate__()[1:]


def places(cloud):
    return state(cloud)[0]


@pytest.mark.parametrize("dtype", [PLAIN, PADDED, ODD, MIXED])
def test_structured_arrays_are_taken_as_they_come(dtype):
    points = np.random.default_rng(1).uniform(-1, 1, (60, 3)).astype(np.float32).astype(float)
    rows = frame(dtype, points)
    for array in (rows, rows.reshape(6, 10), np.repeat(rows, 2)[::2]):
        assert (places(fcl_artic.points(array, 0.1)) == points).all()
    assert (places(fcl_artic.points(points.astype(np.float32), 0.1)) == points).all()
    assert (places(fcl_artic.points(np.asfortranarray(points), 0.1)) == points).all()


@pytest.mark.parametrize("dtype", [PLAIN, ODD, MIXED])
def test_rows_without_a_point_are_left_out_and_counted(dtype):
    points = np.random.default_rng(1).uniform(-1, 1, (50, 3)).astype(np.float32).astype(float)
    good = np.ones(50, bool)
    for row, value in ((3, np.nan), (7, np.inf), (20, -np.inf), (49, np.nan)):
        points[row, row % 3] = value
        good[row] = False
    radii = np.arange(1, 51) * 0.01
    for array in (points, frame(dtype, points)):
        with pytest.warns(UserWarning) as caught:
            cloud = fcl_artic.points(array, radii)
        texts = [str(warning.message) for warning in caught]
        assert len(texts) == 2 and "not finite" in texts[0] and "too near" in texts[1]
        assert cloud.missing == 4
        assert (places(cloud) == points[good]).all()
        assert (state(cloud)[1] == radii[good]).all()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            again = pickle.loads(pickle.dumps(cloud))
        assert again.missing == 4 and (places(again) == places(cloud)).all()
    assert fcl_artic.sphere(1).missing == 0


def test_thinned_clouds_hold_all_points():
    points = np.random.default_rng(3).uniform(-1, 1, (5000, 3))
    thinned = fcl_artic.points(points, 0.01, voxel=0.2)
    centers, radii, _ = state(thinned)
    assert len(centers) == len({tuple(row) for row in np.floor(points / 0.2)})
    away = np.linalg.norm(points[:, None] - centers[None], axis=2) + 0.01
    assert (away <= radii + 1e-15).any(axis=1).all()
    assert radii.max() <= 0.01 + 0.2 * 0.8661


def test_points_on_the_robot_are_dropped(robot):
    world = fcl_artic.World(robot)
    q = np.array([0.3, 0.5, -1.0, 0.2, 0.1, 0.0])
    world.setup()
    hand = robot.tree.link_pose(robot.tree.links[-1], q)[:3, 3]
    far = np.array([[5.0, 0, 0], [0, 5, 0], [np.nan, 0, 0]])
    points = np.vstack([far[:1], [hand], far[1:2], [hand], far[2:]])
    left, removed = world.remove_self(points, q, 0.2)
    assert removed == 2
    assert np.array_equal(left, far, equal_nan=True)
    rows = frame(PADDED, points)
    kept, removed = world.remove_self(rows, q, padding=0.2)
    assert removed == 2 and kept.dtype == rows.dtype
    for name in rows.dtype.names:
        assert np.array_equal(kept[name], rows[name][[0, 2, 4]], equal_nan=name in "xyz")
    pose = np.eye(4)
    pose[:3, 3] = [1, 2, 3]
    left, removed = world.remove_self(points - [1, 2, 3], q, 0.2, pose=pose)
    assert removed == 2
    world.add("ball", fcl_artic.sphere(0.3))
    world.attach("ball", robot.tree.links[-1], [0, 0, 0.6])
    world.setup()
    at = robot.tree.link_pose(robot.tree.links[-1], q) @ [0, 0, 0.85, 1]
    assert world.remove_self([at[:3]], q)[1] == 1
    with pytest.raises(ValueError, match="padding"):
        world.remove_self(points, q, -1)
