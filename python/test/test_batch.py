# SPDX-License-Identifier: BSD-3-Clause
"""Many motions at once, in arrays."""
import tracemalloc

import numpy as np
import pytest

import fcl_artic
from conftest import random_motions


@pytest.mark.parametrize("threads", [0, 1, 2, 3])
def test_many_answers_are_those_of_one_by_one(shared_world, robot, threads):
    q0, q1 = random_motions(robot, 100, angle=0.5)
    answers = shared_world.check_many(q0, q1, threads=threads)
    assert len(answers) == 100 and answers.bodies == shared_world.names
    for i in range(100):
        alone = shared_world.check(q0[i], q1[i])
        assert answers.status[i] == alone.status
        assert (answers.t_lower[i], answers.t_upper[i]) == (alone.t_lower, alone.t_upper)
        assert answers.certain[i] == alone.certain and answers.pair_names(i) == alone.pair
        if alone.first:
            assert np.array_equal(answers.point[i], alone.first.point)
            assert np.array_equal(answers.normal[i], alone.first.normal)
        else:
            assert (answers.pair[i] == -1).all() and np.isnan(answers.point[i]).all()
    assert 0 < answers.free.sum() < 100 and answers.contact.sum() + answers.free.sum() == 100


def test_columns_are_numpy_arrays_of_plain_types(shared_world, robot):
    answers = shared_world.check_many(*random_motions(robot, 10))
    assert answers.status.dtype == np.int8 and answers.pair.dtype == np.int32 and answers.pair.shape == (10, 2)
    assert answers.t_lower.dtype == answers.t_upper.dtype == np.float64
    assert answers.certain.dtype == bool and answers.point.shape == (10, 3)
    assert np.array_equal(answers.free, answers.status == fcl_artic.Status.FREE)
    assert repr(answers).startswith("<Answers: ")
    with pytest.raises(TypeError, match="answers.free.all"):
        bool(answers)
    with pytest.raises(IndexError):
        answers.pair_names(10)


def test_large_arrays_are_not_copied(shared_world, robot):
    count = 100_000  # 4.8 MB each
    q0 = np.zeros((count, 6))
    q0[:] = [-2.1, 1, -1, -0.1, -0.1, 0]
    q1 = q0 + 1e-3
    shared_world.check_many(q0[:10], q1[:10])
    answers_size = count * (1 + 8 + 8 + 1 + 8 + 24 + 24 + 3 * 4)

    def peak(a, b):
        tracemalloc.start()
        try:
            shared_world.check_many(a, b, threads=1, work_budget=1)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    assert peak(q0, q1) < answers_size + q0.nbytes / 10
    # The same measure sees the copies that other arrays need.
    assert peak(np.asfortranarray(q0), np.asfortranarray(q1)) > answers_size + 2 * q0.nbytes


def test_arrays_in_any_layout_are_taken(shared_world, robot):
    q0, q1 = random_motions(robot, 50, angle=0.5)
    expected = shared_world.check_many(q0, q1).t_lower
    for change in (np.asfortranarray, lambda a: np.repeat(a, 2, axis=0)[::2], lambda a: a.tolist()):
        assert np.array_equal(shared_world.check_many(change(q0), change(q1)).t_lower, expected)
    read_only = q0.copy()
    read_only.flags.writeable = False
    assert np.array_equal(shared_world.check_many(read_only, q1).t_lower, expected)
    assert np.array_equal(read_only, q0)


@pytest.mark.parametrize("threads", [1, 2])
def test_a_row_that_is_no_configuration_is_named(shared_world, robot, threads):
    q0, q1 = random_motions(robot, 50)
    q1[17, 2] = np.nan
    with pytest.raises(ValueError, match="motion 17"):
        shared_world.check_many(q0, q1, threads=threads)


def test_shapes_that_do_not_fit_are_refused(shared_world):
    with pytest.raises(ValueError, match=r"q0 has shape \(6,\), not \(N, 6\)"):
        shared_world.check_many(np.zeros(6), np.zeros(6))
    with pytest.raises(ValueError, match=r"q1 has shape \(2, 5\), not \(N, 6\)"):
        shared_world.check_many(np.zeros((2, 6)), np.zeros((2, 5)))
    with pytest.raises(ValueError, match="q0 has 2 rows, q1 has 3"):
        shared_world.check_many(np.zeros((2, 6)), np.zeros((3, 6)))
    with pytest.raises(ValueError, match="threads"):
        shared_world.check_many(np.zeros((2, 6)), np.zeros((2, 6)), threads=-1)
    with pytest.raises(TypeError, match="certificates"):
        shared_world.check_many(np.zeros((2, 6)), np.zeros((2, 6)), certificate=True)


def test_no_motion_is_no_answer(shared_world):
    answers = shared_world.check_many(np.zeros((0, 6)), np.zeros((0, 6)))
    assert len(answers) == 0 and answers.free.all()


def test_bodies_are_named_also_when_carried_or_moving(world, robot):
    world.add("bar", fcl_artic.box([0.02, 0.02, 1.0]), [5, 5, 5])
    world.attach("bar", "wrist_roll", [0, 0, 0.5])
    world.add_moving("cloud", fcl_artic.sphere(3.0), fcl_artic.Motion.still([0, 0, 4.0]))
    q0, q1 = random_motions(robot, 40)
    answers = world.check_many(q0, q1)
    names = {name for i in range(40) if answers.pair_names(i) for name in answers.pair_names(i)}
    assert names & {"bar", "cloud"} and (answers.pair[answers.contact] >= 0).all()
