# SPDX-License-Identifier: BSD-3-Clause
"""Questions that are written to files, and asked again."""
import json

import numpy as np
import pytest

import fcl_artic


def of(result):
    """All that must be the same to the bit."""
    counts = {name: value for name, value in result.statistics.items() if isinstance(value, int)}
    contacts = [(c.pair, c.piece1, c.piece2, c.point.tobytes(), c.normal.tobytes(), c.t_lower, c.t_upper)
                for c in result.contacts]
    return result.status, result.t_lower, result.t_upper, result.certain, contacts, counts


def test_a_question_is_asked_again_with_the_same_bits(world, hit, miss, tmp_path):
    world.add("box", fcl_artic.box([0.1, 0.2, 0.3]), fcl_artic.pose([1, 1, 1]))
    world.add("tool", fcl_artic.sphere(0.01))
    world.attach("tool", world.tree.links[-1], [0, 0, 0.1])
    world.set_margin("box", 0.001)
    turn = fcl_artic.Motion.linear(fcl_artic.pose([2, 0, 0]), fcl_artic.pose([2, 0, 1]))
    world.add_moving("lift", fcl_artic.capsule(0.1, 0.2), turn)
    seen = set()
    for k, (q0, q1) in enumerate((hit, miss)):
        file = tmp_path / f"{k}.json"
        for options in ({}, {"mode": "first_of_every_pair", "margin": 0.002}, {"method": "redon2004"},
                        {"work_budget": 40}):
            world.dump(file, q0, q1, **options)
            answer = world.check(q0, q1, **options)
            assert of(fcl_artic.replay(file)) == of(answer)
            seen.add(answer.status.name)
    assert seen == {"FREE", "CONTACT", "UNDECIDED"}


def test_a_trajectory_is_asked_again(shared_world, hit, tmp_path):
    trajectory = fcl_artic.JointTrajectory.linear(shared_world, [1.0, 2.5, 4.0], [hit[0], hit[1], hit[0]])
    shared_world.dump(tmp_path / "q.json", trajectory)
    assert of(fcl_artic.replay(tmp_path / "q.json")) == of(shared_world.check(trajectory))


def test_a_dump_is_of_one_question_and_goes_where_it_can(shared_world, hit, tmp_path):
    with pytest.raises(TypeError, match="q1 is missing"):
        shared_world.dump(tmp_path / "q.json", hit[0])
    with pytest.raises(TypeError, match="margn.*margin"):
        shared_world.dump(tmp_path / "q.json", *hit, margn=0.1)
    with pytest.raises(OSError, match="nowhere"):
        shared_world.dump(tmp_path / "nowhere" / "q.json", *hit)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_no_question_is_refused_by_name(shared_world, hit, tmp_path):
    file = tmp_path / "q.json"
    with pytest.raises(FileNotFoundError, match="q.json"):
        fcl_artic.replay(file)
    shared_world.dump(file, *hit)
    question = json.loads(file.read_text())
    question["request"]["mode"] = "last"
    file.write_text(json.dumps(question))
    with pytest.raises(ValueError, match=r"q\.json': query: request\.mode is 'last'"):
        fcl_artic.replay(file)
