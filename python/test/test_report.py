# SPDX-License-Identifier: BSD-3-Clause
"""Answers as pages."""
import html
import json
import re

import numpy as np
import pytest

import fcl_artic


@pytest.fixture(scope="module")
def made(shared_world):
    from conftest import HIT

    try:
        return shared_world.report(*HIT)
    except RuntimeError as error:
        pytest.skip(str(error))


def part(page, name):
    return json.loads(re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', page.html, re.S)[1])


def test_a_page_has_the_answer(made, shared_world, hit):
    result, answer = shared_world.check(*hit), part(made, "answer")
    assert (answer["status"], answer["t_lower"], answer["t_upper"]) == ("contact", result.t_lower, result.t_upper)
    assert answer["contacts"][0]["body1"]["name"] == "wrist_roll"
    assert answer["request"]["margin"] == 0 and answer["statistics"]["total_us"] > 0
    assert repr(made).startswith("<Report: first contact at t = 0.4340: wrist_roll - pipes, ")
    steps = part(made, "motion")["distances"]
    assert len(steps["obstacles"]) == len(steps["links"]) == 100
    touching = [i for i, s in enumerate(steps["obstacles"]) if s["upper"] == 0]
    assert steps["times"][touching[0]] <= result.t_lower <= steps["times"][touching[0] + 1]


def test_a_page_is_saved_and_shown_in_a_frame(made, shared_world, hit, tmp_path):
    made.save(tmp_path / "a.html")
    assert (tmp_path / "a.html").read_text() == made.html
    frame = made._repr_html_()
    assert frame.startswith('<iframe title="first contact') and 'sandbox="allow-scripts"' in frame
    assert html.unescape(re.search(r'srcdoc="([^"]*)"', frame)[1]) == made.html
    again = shared_world.report(*hit, path=tmp_path / "b.html")
    assert (tmp_path / "b.html").read_text() == again.html
    asked = []
    with pytest.raises(FileNotFoundError, match="no such folder.*nowhere"):
        shared_world.report(*hit, path=tmp_path / "nowhere" / "c.html", progress=asked.append)
    assert asked == []  # refused before the work


def test_a_result_that_is_there_is_shown(made, shared_world, hit):
    result = shared_world.check(*hit, margin=0.004)
    page = shared_world.report(*hit, result)
    assert part(page, "answer")["t_lower"] == result.t_lower and part(page, "answer")["request"] is None
    known = shared_world.report(*hit, result, margin=0.004)
    assert part(known, "answer")["request"]["margin"] == 0.004
    assert "first approach within the margin, 0.004 m" in known.html and "first approach" not in page.html


def test_a_result_of_another_motion_is_refused(made, shared_world, hit, miss):
    contact, free = shared_world.check(*hit), shared_world.check(*miss)
    for call in (shared_world.report, shared_world.picture):
        with pytest.raises(ValueError, match="another motion"):
            call(*miss, result=contact)
    with pytest.raises(ValueError, match="another motion"):
        shared_world.report(*hit, result=free)
    assert part(shared_world.report(*miss, result=free), "answer")["status"] == "free"
    with pytest.raises(ValueError, match="max_contacts=0"):
        shared_world.report(*hit, result=shared_world.check(*hit, max_contacts=0))


def test_options_are_those_of_a_query(made, shared_world, hit):
    page = shared_world.report(*hit, mode="first_of_every_pair", max_contacts=10, check_self=False)
    assert len(part(page, "answer")["contacts"]) == 4
    distances = part(page, "motion")["distances"]
    assert distances["links"] is None and distances["obstacles"]
    with pytest.raises(TypeError, match="margn"):
        shared_world.report(*hit, margn=1)


def test_a_trajectory_is_in_its_own_time(made, shared_world, hit):
    page = shared_world.report_trajectory(np.array(hit), [10, 30])
    answer, motion = part(page, "answer"), part(page, "motion")
    assert (answer["t_begin"], answer["t_end"]) == (10, 30) and 18 < answer["t_lower"] < 19
    assert motion["times"][0] == 10 and motion["distances"]["times"][-1] == 30
    same = shared_world.report(fcl_artic.JointTrajectory.linear(shared_world, [10, 30], np.array(hit)))
    assert part(same, "motion") == motion


def test_carried_and_moving_bodies_are_there(made, world, miss):
    world.add("cup", fcl_artic.cylinder(0.05, 0.1))
    world.attach("cup", "flange", [0, 0, 0.1], touch_links=world.tree.links)
    world.add_moving("ball", fcl_artic.sphere(0.1), fcl_artic.Motion.translation([0, 0, 5], [0, 0, 1]))
    motion = part(world.report(*miss), "motion")
    kinds = {body["name"]: (body["kind"], body.get("link")) for body in motion["bodies"]}
    assert kinds["cup"] == ("attached object", "flange") and kinds["ball"] == ("moving obstacle", None)
    links = {body["name"] for body in motion["bodies"] if body["kind"] == "link"} | {"flange"}
    assert motion["frames"] == len(links) + 1
    assert motion["distances"] == {"missing": "obstacles move by themselves"}


def test_progress_can_end_it(made, shared_world, hit):
    def stop(part_done):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        for _ in range(50):  # what takes less than 40 ms is not asked
            shared_world.report(*hit, progress=stop)


def test_a_result_of_another_robot_is_refused(made, shared_world, hit):
    tree = fcl_artic.KinematicTree("one")
    tree.add_link("a")
    other = fcl_artic.Robot(tree)
    other.add_geometry("a", fcl_artic.sphere(1))
    with pytest.raises(ValueError, match="another robot"):
        fcl_artic.World(other).report([], [], shared_world.check(*hit))
