# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of answers."""
import numpy as np
import pytest

import fcl_artic


@pytest.fixture
def drawn(shared_world, hit):
    try:
        return shared_world.picture(*hit, size=(320, 200))
    except RuntimeError as error:
        pytest.skip(str(error))


def test_a_picture_is_an_array_and_a_file(drawn, tmp_path):
    assert drawn.array.shape == (200, 320, 3) and drawn.array.dtype == np.uint8
    assert drawn.array.std() > 5  # something is drawn
    drawn.save(tmp_path / "hit.png")
    assert (tmp_path / "hit.png").read_bytes().startswith(b"\x89PNG")
    assert drawn._repr_png_() == (tmp_path / "hit.png").read_bytes()
    assert np.asarray(drawn).shape == drawn.array.shape and repr(drawn) == "<Picture: 320 x 200 pixels>"


def test_a_result_that_is_there_is_drawn(drawn, shared_world, hit):
    result = shared_world.check(*hit)
    assert np.array_equal(shared_world.picture(*hit, result=result, size=(320, 200)).array, drawn.array)
    other = shared_world.picture(*hit, result=result, size=(320, 200), camera=(120, 20), title="from aside")
    assert not np.array_equal(other.array, drawn.array)


def test_moving_and_carried_bodies_are_drawn(drawn, world, miss):
    bare = world.picture(*miss, size=(320, 200), camera=(-55, 20)).array
    world.add("bar", fcl_artic.box([0.05, 0.05, 1.0]), [0, 0, 3])
    world.attach("bar", "wrist_roll", [0, 0, 0.5], touch_links=world.tree.links)
    world.add_moving("ball", fcl_artic.sphere(0.1), fcl_artic.Motion.still([0.2, 0.2, 1.2]))
    assert not np.array_equal(world.picture(*miss, size=(320, 200), camera=(-55, 20)).array, bare)


def test_a_trajectory_is_drawn_in_its_own_time(drawn, shared_world, hit):
    trajectory = fcl_artic.JointTrajectory.linear(shared_world, [10, 30], np.array(hit))
    assert shared_world.picture(trajectory, size=(320, 200)).array.shape == (200, 320, 3)


def test_a_size_that_is_none_is_refused(shared_world, hit):
    with pytest.raises((ValueError, RuntimeError)):
        shared_world.picture(*hit, size=(10, 10))


def test_a_camera_without_a_direction_is_refused(shared_world, hit):
    for camera in ((float("nan"), 20), (30, float("inf"))):
        with pytest.raises((ValueError, RuntimeError), match="camera|pictures"):
            shared_world.picture(*hit, size=(320, 200), camera=camera)


def test_a_file_of_another_kind_is_refused(tmp_path):
    picture = fcl_artic.Picture(np.zeros((64, 64, 3), np.uint8))
    with pytest.raises(ValueError, match="a.jpg' ends in '.jpg'"):
        picture.save(tmp_path / "a.jpg")
    assert list(tmp_path.iterdir()) == []
    for name in ("a.PNG", "a"):
        picture.save(str(tmp_path / name))
        assert (tmp_path / name).read_bytes() == picture.png()
