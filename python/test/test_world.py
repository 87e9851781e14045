# SPDX-License-Identifier: BSD-3-Clause
"""Questions to a world."""
import math
import pickle
import subprocess
import threading
import time

import numpy as np
import pytest

import fcl_artic
from conftest import random_motions


def test_a_contact_has_pair_time_point_and_normal(shared_world, hit):
    result = shared_world.check(*hit)
    assert result.contact and result.certain and not result.free and not result.undecided
    assert result.status is fcl_artic.Status.CONTACT
    assert 0 <= result.t_lower <= result.t_upper <= result.t_lower + 1e-6
    first = result.first
    assert result.pair == first.pair == ("wrist_roll", "pipes")
    assert first.body1.name == "wrist_roll" and first.body2.link is None
    assert math.isclose(np.linalg.norm(first.normal), 1)
    assert first.point.shape == (3,) and first.approach_speed > 0
    assert isinstance(first.feature, fcl_artic.FeatureKind)
    assert result.link_poses.shape == (len(shared_world.tree.links), 4, 4)
    assert result.statistics["pairs"] > 0
    assert repr(result) == f"<Result: {result}: wrist_roll and pipes>"
    assert str(result).startswith("contact within [")


def test_a_free_motion_is_free_and_has_no_contact(shared_world, miss):
    result = shared_world.check(*miss)
    assert result.free and not result.contact and result.pair is None and result.first is None
    assert result.t_lower == 1 and len(result.contacts) == 0
    assert repr(result) == "<Result: free: proven>"
    assert shared_world.is_free(*miss)


def test_a_result_is_neither_true_nor_false(shared_world, miss):
    with pytest.raises(TypeError, match="result.free"):
        bool(shared_world.check(*miss))


def test_a_world_without_pairs_says_that_nothing_was_checked():
    tree = fcl_artic.KinematicTree()
    tree.add_link("base")
    world = fcl_artic.World(fcl_artic.Robot(tree))
    result = world.check([], [])
    assert result.free and result.nothing_checked and "nothing was checked" in repr(result)


def test_lists_and_other_types_of_numbers_are_taken(shared_world, hit):
    expected = shared_world.check(*hit).t_lower
    lists = [list(q) for q in hit]
    strided = [np.repeat(q, 2)[::2] for q in hit]
    swapped = [q.astype(">f8") for q in hit]
    for q0, q1 in (lists, strided, swapped):
        assert shared_world.check(q0, q1).t_lower == expected
    assert shared_world.check(np.zeros(6, np.int32), np.zeros(6, np.float32)).t_lower >= 0


@pytest.mark.parametrize(
    "q1, error, text",
    [
        (np.zeros(5), ValueError, "5 entries"),
        ([0, 0, 0, math.nan, 0, 0], ValueError, "q1|finite"),
        (np.zeros((2, 3)), ValueError, r"q1 has shape \(2, 3\)"),
        (["1"] * 6, TypeError, "q1 holds no real numbers"),
        ([True] * 6, TypeError, "q1 holds no real numbers"),
        ([None] * 6, TypeError, "q1 holds no real numbers"),
        (np.zeros(6, complex), TypeError, "complex"),
        (np.ma.masked_array(np.zeros(6), mask=[1] * 6), TypeError, "masked"),
        ([[0, 1], [2]], ValueError, "q1"),
    ],
)
def test_a_configuration_that_is_none_is_refused_by_name(shared_world, q1, error, text):
    with pytest.raises(error, match=text):
        shared_world.check(np.zeros(6), q1)


def test_the_end_of_the_motion_may_not_be_left_out(shared_world):
    with pytest.raises(TypeError, match="q1 is missing"):
        shared_world.check(np.zeros(6))


def test_options_are_those_of_a_request(shared_world, hit):
    by_options = shared_world.check(*hit, tolerance_time=1e-3)
    request = fcl_artic.Request(tolerance_time=1e-3)
    by_request = shared_world.check(*hit, request=request)
    assert by_options.t_lower == by_request.t_lower and by_options.t_upper == by_request.t_upper
    overridden = shared_world.check(*hit, request=request, tolerance_time=1e-6)
    assert overridden.t_upper - overridden.t_lower <= 1e-6
    assert repr(request) == "Request(tolerance_time=0.001)"
    assert repr(fcl_artic.Request(mode="any")) == "Request(mode='any')"


def test_an_unknown_option_is_refused_with_the_one_that_is_meant(shared_world, hit):
    with pytest.raises(TypeError, match="no option 'margn'; did you mean 'margin'"):
        shared_world.check(*hit, margn=0.01)


@pytest.mark.parametrize(
    "options, error",
    [
        ({"mode": "anny"}, ValueError),
        ({"mode": 1}, TypeError),
        ({"check_self": None}, TypeError),
        ({"check_self": 0}, TypeError),
        ({"check_scene": "no"}, TypeError),
        ({"max_contacts": -1}, ValueError),
        ({"max_contacts": 1.5}, TypeError),
        ({"work_budget": True}, TypeError),
        ({"margin": -1}, ValueError),
        ({"margin": math.nan}, ValueError),
        ({"margin": "1"}, TypeError),
        ({"tolerance_time": 0}, ValueError),
        ({"progress": 1}, TypeError),
        ({"request": {}}, TypeError),
    ],
)
def test_a_value_that_an_option_has_not_is_refused(shared_world, hit, options, error):
    with pytest.raises(error):
        shared_world.check(*hit, **options)


def test_all_pairs_are_reported_where_all_are_asked_for(shared_world, hit):
    result = shared_world.check(*hit, mode=fcl_artic.ContactMode.FIRST_OF_EVERY_PAIR)
    assert len(result.contacts) > 1
    assert len({contact.pair for contact in result.contacts}) == len(result.contacts)
    assert len(shared_world.check(*hit, mode="first_of_every_pair", max_contacts=1).contacts) == 1


def test_a_budget_that_runs_out_is_undecided_and_never_free(shared_world, hit):
    result = shared_world.check(*hit, work_budget=1)
    assert result.undecided and not result.free
    assert not shared_world.is_free(*hit, work_budget=1)


def test_the_papers_method_agrees(shared_world, hit):
    ours = shared_world.check(*hit)
    options = fcl_artic.RedonOptions(enclosure="taylor")
    theirs = shared_world.check(*hit, method="redon2004", redon=options)
    assert theirs.contact and theirs.t_lower <= ours.t_upper and ours.t_lower <= theirs.t_upper
    assert theirs.statistics["redon"]["box_tests"] > 0


def test_collide_looks_at_one_configuration(shared_world, hit):
    assert shared_world.collide(hit[0]).free
    at_contact = hit[0] + shared_world.check(*hit).t_upper * (hit[1] - hit[0])
    assert shared_world.collide(at_contact + 1e-3 * (hit[1] - hit[0])).contact


def test_clearance_is_bounded_from_both_sides(shared_world, miss):
    found = shared_world.clearance(*miss, check_self=False)
    assert 0 < found.lower <= found.upper < 1 and found.within_tolerance
    assert found.pair[1] == "pipes"
    assert shared_world.check(*miss, check_self=False, margin=0.99 * found.lower).free
    assert shared_world.check(*miss, check_self=False, margin=1.01 * found.upper).contact
    with pytest.raises(TypeError, match="no option 'mosst'; did you mean 'most'"):
        shared_world.clearance(*miss, mosst=1)


def test_a_trajectory_is_asked_in_its_own_time(shared_world, hit):
    waypoints = np.array([hit[0], 0.5 * (hit[0] + hit[1]), hit[1]])
    alone = shared_world.check(*hit)
    in_numbers = shared_world.check_trajectory(waypoints)
    assert in_numbers.contact and math.isclose(in_numbers.t_lower, 2 * alone.t_lower, abs_tol=1e-5)
    in_seconds = shared_world.check_trajectory(waypoints, [10, 12, 14])
    assert math.isclose(in_seconds.t_lower, 10 + 4 * alone.t_lower, abs_tol=1e-5)
    trajectory = fcl_artic.JointTrajectory.linear(shared_world, [10, 12, 14], waypoints)
    assert shared_world.check(trajectory).t_lower == in_seconds.t_lower
    assert shared_world.check_trajectory(waypoints, blend=0.1).contact
    zeros = np.zeros_like(waypoints)
    assert shared_world.check_trajectory(waypoints, velocities=zeros).contact
    assert shared_world.check_trajectory(waypoints, velocities=zeros, accelerations=zeros).contact
    with pytest.raises(ValueError, match="accelerations need velocities"):
        shared_world.check_trajectory(waypoints, accelerations=zeros)
    with pytest.raises(ValueError):
        shared_world.check_trajectory(waypoints, [1, 1, 2])


def test_motions_are_made_of_the_tree(shared_world, robot, hit):
    motion = fcl_artic.JointMotion.linear(robot, *hit)
    assert shared_world.check(motion).t_lower == shared_world.check(*hit).t_lower
    assert np.array_equal(motion.q0, hit[0]) and motion.degree == 1 and len(motion) == 6
    assert np.allclose(motion.configuration(0.5), (hit[0] + hit[1]) / 2)
    polynomial = fcl_artic.JointMotion.polynomial(robot, np.column_stack([hit[0], hit[1] - hit[0], np.zeros(6)]))
    assert polynomial.degree == 2 and shared_world.check(polynomial).contact
    with pytest.raises(TypeError, match="a motion and q1"):
        shared_world.check(motion, hit[1])
    other = fcl_artic.KinematicTree("other")
    other.add_link("base")
    with pytest.raises(ValueError, match="other"):
        shared_world.check(fcl_artic.JointMotion.still(other, []))


def test_a_path_in_place_of_what_it_holds_is_refused(world, scene):
    for call, text in (
        (lambda: fcl_artic.World("robot.urdf"), "robot is no Robot but str; load_urdf"),
        (lambda: fcl_artic.World(world.robot, "cell.stl"), "scene is no Scene but str; load_scene"),
        (lambda: world.add_scene("cell.stl"), "scene is no Scene but str; load_scene"),
        (lambda: world.replace_scene(None), "scene is no Scene but NoneType; load_scene"),
    ):
        with pytest.raises(TypeError, match=text):
            call()
    with pytest.raises(ValueError, match="^the margin of 'pipes' is -1, not a number >= 0"):
        world.set_margin("pipes", -1)


def test_obstacles_are_added_moved_and_removed(world, miss):
    assert world.check(*miss).free
    at = world.tree.link_pose("wrist_roll", miss[0])[:3, 3]
    world.add("ball", fcl_artic.sphere(0.05), at)
    assert "ball" in world.obstacles
    result = world.check(*miss, mode="first_of_every_pair")
    assert result.contact and all("ball" in contact.pair for contact in result.contacts)
    world.move("ball", [10, 10, 10])
    assert world.check(*miss).free and np.array_equal(world.pose("ball")[:3, 3], [10, 10, 10])
    world.remove("ball")
    assert "ball" not in world.obstacles and world.check(*miss).free
    with pytest.raises(ValueError, match="no obstacle 'pipe'; did you mean 'pipes'"):
        world.remove("pipe")
    with pytest.raises(ValueError, match="pipes"):
        world.add("pipes", fcl_artic.sphere(0.05))
    with pytest.raises(ValueError, match="orthonormal"):
        world.move("pipes", np.diag([2.0, 1, 1, 1]))
    assert world.check(*miss).free


def test_a_replaced_scene_answers_as_a_new_world(robot, scene, hit, miss):
    world = fcl_artic.World(robot)
    world.add("bar", fcl_artic.box([0.02, 0.02, 0.1]), [5, 5, 5])
    world.attach("bar", "wrist_roll", [0, 0, 0.1], touch_links=world.tree.links)
    world.add_moving("ball", fcl_artic.sphere(0.01), fcl_artic.Motion.translation([6, 6, 6], [1, 0, 0]))
    other = fcl_artic.Scene()
    other.add("plate", fcl_artic.box([0.1, 0.1, 0.01]), world.tree.link_pose("wrist_roll", miss[0])[:3, 3])
    pairs = set()
    for obstacles in (scene, other, fcl_artic.Scene(), scene):
        world.replace_scene(obstacles)
        assert world.obstacles == obstacles.names and world.attached == {"bar": "wrist_roll"} and world.moving == ["ball"]
        fresh = fcl_artic.World(robot, obstacles)
        fresh.add("bar", fcl_artic.box([0.02, 0.02, 0.1]), [5, 5, 5])
        fresh.attach("bar", "wrist_roll", [0, 0, 0.1], touch_links=world.tree.links)
        for motion in (hit, miss):
            answer, expected = world.check(*motion), fresh.check(*motion)
            assert (answer.status, answer.pair, answer.t_lower) == (expected.status, expected.pair, expected.t_lower)
            pairs.add(answer.pair)
    assert len(pairs) > 2 and None in pairs  # or the scenes make no difference


def test_a_scene_that_is_refused_replaces_nothing(world, scene, hit):
    before = world.check(*hit)
    taken = fcl_artic.Scene()
    taken.add("far", fcl_artic.sphere(0.1), [9, 9, 9])
    taken.add("wrist_roll", fcl_artic.sphere(0.1), [9, 9, 9])  # the name of a link
    with pytest.raises(ValueError, match="wrist_roll"):
        world.replace_scene(taken)
    assert world.obstacles == scene.names and world.check(*hit).t_lower == before.t_lower


def test_what_is_left_out_of_points_and_meshes_is_a_warning(tmp_path):
    points = tmp_path / "scan.xyz"
    points.write_text("1 2 3\nnan nan nan\n")
    with pytest.warns(UserWarning, match="1 of 2 points are not finite"):
        fcl_artic.load_points(points, 0.01)
    mesh = tmp_path / "wire.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\n")
    with pytest.warns(UserWarning, match="its lines, 1, have no surface"):
        fcl_artic.load_mesh(mesh)
    other = tmp_path / "part.ac"
    other.write_text("AC3Db\n")
    with pytest.raises(ValueError, match="import_meshes"):
        fcl_artic.load_mesh(other)
    pairs = tmp_path / "arm.srdf"
    pairs.write_text("<robot name='arm'><disable_collisions link1='a' link2='x'/><disable_collisions link1='a' link2='b'/></robot>")
    tree = fcl_artic.KinematicTree("arm")
    for link in ("a", "b"):
        tree.add_link(link)
    for read in (fcl_artic.load_srdf, fcl_artic.read_srdf):
        with pytest.warns(UserWarning, match="1 of 2 entries name links"):
            assert len(read(pairs, tree)) == 1


def test_messages_hold_what_is_no_utf8(tmp_path):
    wrong = tmp_path / "wrong.obj"
    wrong.write_bytes(b"\xe4bc 1 2\n")
    with pytest.raises(ValueError, match=r"'\\xe4bc' begins a line of no kind"):
        fcl_artic.load_mesh(wrong)
    odd = tmp_path / "odd.ply"
    lines = ["ply", "format ascii 1.0", "element vertex 3"]
    lines += [f"property float {name}" for name in ("x", "y", "z", "w\xe4rm")]
    lines += ["element face 1", "property list uchar int vertex_indices", "end_header"]
    lines += ["0 0 0 1", "1 0 0 1", "0 1 0 1", "3 0 1 2", ""]
    odd.write_bytes("\n".join(lines).encode("latin-1"))
    with pytest.warns(UserWarning, match=r"passed over of each vertex: 'w\\xe4rm'"):
        fcl_artic.load_mesh(odd)
    assert r"w\xe4rm" in fcl_artic.load_scene(odd).notes[0]


def test_the_instruction_set_has_a_name():
    assert fcl_artic.instruction_set() in ("avx512", "avx2", "sse2", "neon", "portable")


def test_what_a_link_carries_is_checked(world, miss):
    world.add("bar", fcl_artic.box([0.02, 0.02, 1.0]), [5, 5, 5])
    assert world.check(*miss).free
    world.attach("bar", "wrist_roll", [0, 0, 0.5], touch_links=["wrist_roll"])
    assert world.attached == {"bar": "wrist_roll"} and "bar" not in world.obstacles
    carried = world.check(*miss, mode="first_of_every_pair")
    assert carried.contact and any("bar" in c.pair for c in carried.contacts)
    world.detach("bar", pose=[5, 5, 6])
    assert world.check(*miss).free and world.pose("bar")[2, 3] == 6
    with pytest.raises(ValueError, match="did you mean 'wrist_roll'"):
        world.attach("bar", "wrist_rol")


def test_allowed_pairs_are_not_checked_and_said_to_be_unproven(world, hit):
    assert world.allowed == frozenset()
    world.allow("wrist_roll", "pipes")
    first = world.check(*hit).pair
    assert first != ("wrist_roll", "pipes")
    for link in world.tree.links:
        world.allow(link, "pipes")
    result = world.check(*hit, check_self=False)
    assert result.free and result.unproven_allowed_pairs > 0 and "allowed pairs not proven apart" in repr(result)
    world.disallow("wrist_roll", "pipes")
    assert world.check(*hit).pair == ("wrist_roll", "pipes")
    world.allowed = []
    assert world.allowed == frozenset() and world.check(*hit).contact
    with pytest.raises(ValueError, match="did you mean 'pipes'"):
        world.allow("wrist_roll", "pipess")
    with pytest.raises(TypeError, match="pair of names"):
        world.allowed = ["wrist_roll"]


def test_what_a_free_says_nothing_of_is_said():
    tree = fcl_artic.KinematicTree("lane")
    for link in ("rail", "cart"):
        tree.add_link(link)
    tree.add_joint(fcl_artic.Joint.prismatic("slide", "rail", "cart", axis=[1, 0, 0], lower=-9, upper=9))
    robot = fcl_artic.Robot(tree)
    robot.add_geometry("cart", fcl_artic.sphere(0.1))
    world = fcl_artic.World(robot)
    world.add("wall", fcl_artic.box([1, 4, 4]), fcl_artic.pose([2.5, 0, 0]))
    deeper = world.check([2.2], [2.3], ignore_initial_contact=True)
    assert deeper.free and deeper.never_apart_pairs == 1
    assert "but for 1 pair that never comes apart" in repr(deeper)
    leaves = world.check([2.2], [0], ignore_initial_contact=True)
    assert leaves.free and leaves.never_apart_pairs == 0 and len(leaves.ignored_initial_contacts) == 1
    near = world.check([1.7], [2.5], margin=0.3, ignore_initial_contact=True)  # within the margin, then into the wall
    assert near.free and near.never_apart_pairs == 1 and "but for 1 pair" in str(near)
    many = world.check_many([[2.2], [2.2]], [[2.3], [0]], ignore_initial_contact=True)
    assert many.free.all() and many.never_apart_pairs.tolist() == [1, 0]
    assert many.ignored_initial_contacts.tolist() == [1, 1] and "2 free (2 but for some pairs)" in repr(many)
    assert repr(world.check_many([[0]], [[1]])) == "<Answers: 1 free, 0 in contact, 0 undecided>"
    verdict = world.check([1.7], [2.5], max_contacts=0)
    assert verdict.contact and verdict.contacts == [] and len(verdict.link_poses) == 0


def test_margins_count_as_contact(world, miss):
    gap = world.clearance(*miss, check_self=False)
    assert world.check(*miss, check_self=False).free
    world.set_margin("pipes", 1.1 * gap.upper)
    assert world.check(*miss, check_self=False).contact
    world.set_margin(*gap.pair, 0)
    for link in world.tree.links:
        world.set_margin(link, "pipes", 0.0)
    assert world.check(*miss, check_self=False).free
    world.reset_margins()
    assert world.check(*miss, check_self=False).free
    with pytest.raises(ValueError):
        world.set_margin("pipes", -1)


def test_what_is_said_of_an_obstacle_goes_with_it(world, miss):
    at = world.tree.link_pose("wrist_roll", miss[0])
    world.add("box", fcl_artic.box([0.1, 0.1, 0.1]), at)
    world.set_margin("box", 0.3)
    for link in world.tree.links:
        world.allow("box", link)
    assert world.check(*miss).free
    world.remove("box")
    assert not any("box" in pair for pair in world.allowed)
    world.add("box", fcl_artic.box([0.1, 0.1, 0.1]), at)
    assert "box" in world.check(*miss).pair


def test_pairs_of_links_are_classified(world):
    seen = []
    report = world.classify_link_pairs(samples=100, progress=seen.append)
    assert len(report) == sum(report.count(kind) for kind in fcl_artic.LinkPairKind)
    assert all(isinstance(f.kind, fcl_artic.LinkPairKind) for f in report.pairs)
    assert seen == sorted(seen) and seen[-1] == 1
    before = len(world.checked_link_pairs())
    world.allowed = report.always_touching
    world.set_proofs(report.proofs)
    assert len(world.checked_link_pairs()) <= before
    robot = world.robot
    robot.allowed, robot.proofs = report.always_touching, report.proofs
    assert fcl_artic.World(robot).check(np.zeros(6), 0.1 * np.ones(6)).unproven_allowed_pairs >= 0


def test_an_srdf_is_written_and_read(world, tmp_path):
    report = world.classify_link_pairs(samples=100)
    path = tmp_path / "arm.srdf"
    report.write_srdf(path, world.tree.name)
    pairs = fcl_artic.load_srdf(path, world)
    assert pairs == report.need_no_check
    assert fcl_artic.load_srdf(path.read_text(), world.tree) == pairs
    assert {frozenset(p[:2]) for p in fcl_artic.read_srdf(path, world)} == {frozenset(p) for p in pairs}


def test_an_obstacle_moves_while_the_robot_does(world, miss):
    at = world.tree.link_pose("wrist_roll", miss[0])[:3, 3]
    far = at + [3.0, 0, 0]
    world.add_moving("ball", fcl_artic.sphere(0.05), fcl_artic.Motion.translation(far, at - far))
    assert world.moving == ["ball"]
    result = world.check(*miss)
    assert result.contact and result.pair[1] == "ball" and result.t_lower > 0.5
    world.remove("ball")
    assert world.check(*miss).free


def test_a_certificate_is_proven_again(shared_world, miss, tmp_path):
    result = shared_world.check(*miss, certificate=True)
    certificate = result.certificate
    assert certificate and len(certificate.proof) > 0 and certificate.missing == ""
    certificate.save(tmp_path / "motion.fac")
    assert (tmp_path / "motion.fac").read_bytes() == certificate.record()
    assert (tmp_path / "motion.fac.world").read_text() == certificate.world
    assert shared_world.check(*miss).certificate is None


def test_progress_rises_and_ends_at_one(shared_world, robot):
    seen = []
    q0, q1 = random_motions(robot, 4000)
    shared_world.check_many(q0, q1, threads=1, progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1 and all(0 <= f <= 1 for f in seen)


def test_progress_that_returns_false_ends_the_query(shared_world, robot):
    q0, q1 = random_motions(robot, 20000)
    calls = []

    def stop(fraction):
        calls.append(fraction)
        return False

    answers = shared_world.check_many(q0, q1, threads=2, progress=stop)
    assert len(calls) == 1 and answers.undecided.any()
    # a motion that was never begun has no answer; each thread may have left one in its middle, free up to t_lower
    left = answers.undecided
    begun = (answers.t_lower[left] > 0) | (answers.pair[left] != -1).any(axis=1)
    assert begun.sum() <= 2


def test_an_exception_in_progress_ends_the_query(shared_world, robot):
    q0, q1 = random_motions(robot, 20000)

    def fail(fraction):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        shared_world.check_many(q0, q1, progress=fail)


def test_progress_is_taken_by_tqdm(shared_world, robot):
    tqdm = pytest.importorskip("tqdm")
    q0, q1 = random_motions(robot, 4000)
    with tqdm.tqdm(total=1, disable=None, file=open("/dev/null", "w")) as bar:
        shared_world.check_many(q0, q1, progress=lambda f: bar.update(f - bar.n))
        assert bar.n == 1 or bar.disable


def test_a_world_cannot_be_changed_from_within_its_query(world, robot):
    q0, q1 = random_motions(robot, 20000)
    with pytest.raises(RuntimeError, match="within its own query"):
        world.check_many(q0, q1, progress=lambda f: world.remove("pipes"))
    with pytest.raises(RuntimeError, match="within its own query"):
        world.check_many(q0, q1, progress=lambda f: world.replace_scene(fcl_artic.Scene()))
    seen = []
    answers = world.check_many(q0[:4000], q1[:4000], progress=lambda f: seen.append(world.check(q0[0], q1[0]).status))
    assert seen[0] == answers.status[0]


def test_control_c_ends_a_long_call(data):
    script = f"""
import numpy as np, signal, threading, os, time, fcl_artic
world = fcl_artic.World(fcl_artic.load_urdf({str(data / 'puma560' / 'puma560.urdf')!r}),
                        fcl_artic.load_scene({str(data / 'pipes.obj')!r}))
world.setup()
q = np.random.default_rng(1).uniform(-1, 1, (2000000, 6))
begin = None
def interrupt():
    global begin
    time.sleep(0.5)
    begin = time.perf_counter()
    os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=interrupt, daemon=True).start()
try:
    world.check_many(q, q[::-1], threads=2)
except KeyboardInterrupt:
    print("ended after", time.perf_counter() - begin)
"""
    done = subprocess.run(
        [__import__("sys").executable, "-c", script], capture_output=True, text=True, timeout=400
    )
    assert done.stdout.startswith("ended after"), done.stderr
    # 0.04 s on an idle machine, 30 s beside a dozen busy processes; all motions would take half an hour
    assert float(done.stdout.split()[-1]) < 300


def test_eight_threads_on_one_world_answer_as_one(shared_world, robot):
    q0, q1 = random_motions(robot, 160, angle=0.5)
    alone = [shared_world.check(a, b) for a, b in zip(q0, q1)]
    answers = [None] * len(q0)

    def ask(first):
        for i in range(first, len(q0), 8):
            answers[i] = shared_world.check(q0[i], q1[i])

    threads = [threading.Thread(target=ask, args=(i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for a, b in zip(alone, answers):
        assert (a.status, a.t_lower, a.t_upper, a.pair) == (b.status, b.t_lower, b.t_upper, b.pair)
    assert {a.status for a in alone} == {fcl_artic.Status.FREE, fcl_artic.Status.CONTACT}


def test_a_world_that_changes_while_threads_ask_stays_sound(world, robot, miss):
    done = threading.Event()
    statuses, errors = set(), []

    def ask():
        try:
            while not done.is_set():
                statuses.add(world.check(*miss).status)
        except Exception as error:  # noqa: BLE001
            errors.append(error)

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    at = world.tree.link_pose("wrist_roll", miss[0])[:3, 3]
    for i in range(20):
        world.add("ball", fcl_artic.sphere(0.05), at)
        assert world.check(*miss).contact
        world.remove("ball")
        assert world.check(*miss).free
    done.set()
    for thread in threads:
        thread.join()
    assert not errors and statuses <= {fcl_artic.Status.FREE, fcl_artic.Status.CONTACT}


def test_queries_let_other_threads_run(shared_world, robot):
    q0, q1 = random_motions(robot, 6000)
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    before = len(ticks)
    shared_world.check_many(q0, q1, threads=1)
    during = len(ticks) - before
    done.set()
    thread.join()
    assert during > 3


def test_visibility_does_not_change_answers(world, hit, miss):
    for q0, q1 in (hit, miss):
        alone = world.check(q0, q1)
        culled = world.check(q0, q1, visibility="on")
        assert (alone.status, alone.t_lower, alone.pair) == (culled.status, culled.t_lower, culled.pair)
    world.set_visibility("cpu", resolution=16)
    assert world.check(*hit, visibility=fcl_artic.VisibilityMode.ON).statistics["visibility_executor"] == "cpu"
    with pytest.raises(ValueError, match="resolution"):
        world.set_visibility("cpu", resolution=3)
    with pytest.raises(ValueError, match="visibility is 'automatic', which is none of 'off', 'on'"):
        world.check(*hit, visibility="automatic")


def test_objects_are_kept_alive_as_long_as_they_are_used(data, miss):
    import gc

    world = fcl_artic.World(
        fcl_artic.load_urdf(data / "puma560" / "puma560.urdf"), fcl_artic.load_scene(data / "pipes.obj")
    )
    tree = world.tree
    world.add_moving("ball", fcl_artic.sphere(0.1), fcl_artic.Motion.still([5, 5, 5]))
    result = world.check(*miss)
    motion = fcl_artic.JointMotion.linear(world, *miss)
    gc.collect()
    assert world.check(motion).free
    del world
    gc.collect()
    assert result.free and tree.dof == 6 and motion.configuration(1).shape == (6,)


def test_tolerances(robot):
    world = fcl_artic.World(robot)
    world.add("ball", fcl_artic.sphere(0.1), pose=[2.5, 0, 0])
    q = np.zeros(6)
    assert world.tolerances == "" and world.check(q, q).free
    world.set_joint_tolerance(angle=0.01)
    world.set_base_tolerance(0.002)
    world.set_object_tolerance("ball", length=0.001, angle=0.02, pivot=[0, 0, 0.1])
    assert "joints" in world.tolerances and "base 2 mm" in world.tolerances and "'ball' 1 mm" in world.tolerances
    assert world.check(q, q).free
    world.set_object_tolerance("ball", length=3)
    hit = world.check(q, q)
    contact = hit.contacts[0]
    assert hit.contact and hit.certain and contact.body2.name == "ball"
    assert np.abs(contact.q_witness).max() <= 0.01 and np.linalg.norm(contact.base_deviation[:3, 3]) <= 0.002
    assert (contact.deviation1 == np.eye(4)).all() and 1 < np.linalg.norm(contact.deviation2[:3, 3]) <= 3
    again = pickle.loads(pickle.dumps(hit)).contacts[0]
    assert (again.deviation2 == contact.deviation2).all() and (again.base_deviation == contact.base_deviation).all()
    with pytest.raises(ValueError):
        world.set_joint_tolerance(angle=-1)
    with pytest.raises(ValueError, match="jiont"):
        world.set_joint_tolerance(angle=0.1, joint="jiont")
    world.reset_tolerances()
    assert world.tolerances == "" and world.check(q, q).free


def test_tolerance_left(robot):
    world = fcl_artic.World(robot)
    world.add("ball", fcl_artic.sphere(0.1), pose=[2.5, 0, 0])
    q = np.zeros(6)
    with pytest.raises(RuntimeError, match="setJointTolerances"):
        world.tolerance_left(q, q)
    world.set_joint_tolerance(angle=0.01)
    world.set_object_tolerance("ball", length=0.01)
    left = world.tolerance_left(q, q, check_self=False)
    assert 1 < left.lower <= left.upper <= 1.011 * left.lower and left.within_accuracy
    assert left.pair[1] == left.body2.name == "ball" and left.time == 0 and left.ignored_initial_contacts == []
    assert left.certain == (left.q_witness is not None) and left.statistics["pairs"] > 0
    assert repr(left).startswith("<ToleranceLeft: from ") and ": " + left.pair[0] in repr(left)
    copy = pickle.loads(pickle.dumps(left))
    assert repr(copy) == repr(left) and copy.lower == left.lower and copy.certain == left.certain
    world.set_joint_tolerance(angle=0.01 * left.lower)
    world.set_object_tolerance("ball", length=0.01 * left.lower)
    assert world.check(q, q, check_self=False).free
    far = world.tolerance_left(q, q, check_self=False, check_scene=False, most=7)
    assert far.lower == 7 and far.pair is None and far.upper == np.inf
    with pytest.raises(TypeError, match="accuracy_factor"):
        world.tolerance_left(q, q, acuracy_factor=1)
    with pytest.raises(ValueError, match="most"):
        world.tolerance_left(q, q, most=0)
