# SPDX-License-Identifier: BSD-3-Clause
"""Robots, trees and scenes: from files, and made in Python."""
import math

import numpy as np
import pytest

import fcl_artic


def two_bars():
    """Two bars of 1 m: one turns about z at the origin, the other one at its end."""
    tree = fcl_artic.KinematicTree("two_bars")
    for name in ("base", "upper", "lower"):
        tree.add_link(name)
    tree.add_joint(fcl_artic.Joint.revolute("shoulder", "base", "upper", axis=[0, 0, 1], lower=-3, upper=3))
    tree.add_joint(fcl_artic.Joint.continuous("elbow", "upper", "lower", axis=[0, 0, 1], origin=[1, 0, 0]))
    robot = fcl_artic.Robot(tree)
    for link in ("upper", "lower"):
        robot.add_geometry(link, fcl_artic.box([0.8, 0.1, 0.1]), offset=[0.5, 0, 0])
    return robot


def test_a_robot_is_made_in_python():
    robot = two_bars()
    assert robot.dof == 2 and robot.tree.variables == ["shoulder", "elbow"]
    poses = robot.tree.forward_kinematics([math.pi / 2, 0])
    assert poses.shape == (3, 4, 4) and np.allclose(poses[2][:3, 3], [0, 1, 0])
    scene = fcl_artic.Scene()
    scene.add("post", fcl_artic.cylinder(0.1, 2), [0, 1.5, 0])
    world = fcl_artic.World(robot, scene)
    result = world.check([0, 0], [math.pi / 2, 0])
    # The lower bar, 0.1 wide, straight out: its corner side meets the post of radius 0.1 at 1.5 m.
    assert result.pair == ("lower", "post")
    angle = math.pi / 2 - math.asin(0.15 / 1.5)
    assert math.isclose(result.t_lower, angle / (math.pi / 2), abs_tol=1e-6)


def test_joints_tell_what_they_are():
    joint = fcl_artic.Joint.prismatic("slide", "a", "b", axis=[0, 0, 2], lower=0, upper=1)
    assert joint.type is fcl_artic.JointType.PRISMATIC and joint.has_limits and joint.upper == 1
    for kind in ("fixed", "spherical", "floating"):
        assert getattr(fcl_artic.Joint, kind)("j", "a", "b").type.value == kind
    assert fcl_artic.Joint.planar("j", "a", "b", [0, 0, 1]).type is fcl_artic.JointType.PLANAR
    mimic = fcl_artic.Mimic("finger", multiplier=-1)
    follower = fcl_artic.Joint.revolute("f", "a", "b", [1, 0, 0], mimic=mimic)
    assert follower.mimic.master == "finger" and joint.mimic is None


def test_errors_of_a_tree_name_the_thing():
    robot = two_bars()
    with pytest.raises(ValueError, match="belongs to a robot"):
        robot.tree.add_link("more")
    with pytest.raises(ValueError, match="did you mean 'lower'"):
        robot.add_geometry("lowr", fcl_artic.sphere(1))
    with pytest.raises(ValueError, match="q has 3 entries|3 entries"):
        robot.tree.forward_kinematics([0, 0, 0])
    with pytest.raises(ValueError, match="elbw"):
        robot.tree.joint("elbw")
    with pytest.raises(IndexError):
        robot.tree.link_pose(7, [0, 0])
    tree = fcl_artic.KinematicTree()
    tree.add_link("a")
    with pytest.raises(ValueError, match="'b'"):
        tree.add_joint(fcl_artic.Joint.fixed("j", "a", "b"))
    with pytest.raises(ValueError, match="pose"):
        fcl_artic.Joint.fixed("j", "a", "b", np.ones((4, 4)))


def test_a_tree_that_grows_does_not_change_robots_made_of_it():
    tree = fcl_artic.KinematicTree()
    tree.add_link("a")
    robot = fcl_artic.Robot(tree)
    tree.add_link("b")
    assert tree.links == ["a", "b"] and robot.tree.links == ["a"]


def test_limits_and_neutral_configuration_are_arrays(robot):
    assert robot.tree.limits.shape == (6, 2) and (robot.tree.limits[:, 0] < robot.tree.limits[:, 1]).all()
    assert np.array_equal(robot.tree.neutral, np.zeros(6))
    assert np.isinf(two_bars().tree.limits[1]).all()
    assert len(robot.tree.limit_notes(np.full(6, 100.0))) == 6


def test_a_urdf_is_read_from_text(data):
    path = data / "puma560" / "puma560.urdf"
    text = path.read_text()
    with pytest.raises(FileNotFoundError, match="no such file"):
        fcl_artic.load_urdf(text)  # its meshes lie beside the file
    text = text.replace('filename="', f'filename="{path.parent}/') if 'filename="package' not in text else text
    robot = fcl_artic.load_urdf(text, packages={"puma560": path.parent})
    assert robot.tree.links == fcl_artic.load_urdf(str(path)).tree.links


def test_files_that_are_missing_or_wrong_are_named(tmp_path, data):
    with pytest.raises(FileNotFoundError, match="nothing.urdf"):
        fcl_artic.load_urdf(tmp_path / "nothing.urdf")
    with pytest.raises(FileNotFoundError, match="nothing.stl"):
        fcl_artic.load_scene(tmp_path / "nothing.stl")
    with pytest.raises(FileNotFoundError):
        fcl_artic.load_urdf(data / "puma560" / "puma560.urdf", tmp_path / "nothing.srdf")
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot name='r'><link")
    with pytest.raises(ValueError, match="broken.urdf"):
        fcl_artic.load_urdf(broken)
    with pytest.raises(ValueError, match="robot"):
        fcl_artic.load_urdf("<sdf/>")
    with pytest.raises(TypeError, match="neither a path nor text"):
        fcl_artic.load_urdf(7)


def test_base_and_floating_base_place_a_robot(data):
    path = data / "puma560" / "puma560.urdf"
    raised = fcl_artic.load_urdf(path, base=[0, 0, 1.5])
    plain = fcl_artic.load_urdf(path)
    link = plain.tree.links[-1]
    difference = raised.tree.link_pose(link, np.zeros(6)) - plain.tree.link_pose(link, np.zeros(6))
    assert np.allclose(difference[:3, 3], [0, 0, 1.5])
    floating = fcl_artic.load_urdf(path, floating_base=True)
    assert floating.dof == 13 and floating.tree.neutral[6] == 1


def test_a_tools_line(data):
    robot = fcl_artic.load_urdf(data / "puma560" / "puma560.urdf")
    tool = robot.tree.links[-1]
    motion = fcl_artic.JointMotion.linear(robot, [0, 0.5, 0, 0, 0.3, 0], [1, 0.5, 0, 0, 0.3, 0])
    found = fcl_artic.tool_deviation(robot, motion, tool, tolerance_distance=1e-5)
    assert 0 < found.distance_lower <= found.distance_upper <= found.distance_lower + 1e-5 and found.within_tolerance
    ends = [robot.tree.link_pose(tool, q)[:3, 3] for q in (motion.configuration(0), motion.configuration(1))]
    middle = robot.tree.link_pose(tool, motion.configuration(0.5))[:3, 3]
    assert np.linalg.norm(middle - (ends[0] + ends[1]) / 2) == pytest.approx(found.distance_lower, abs=1e-4)
    assert found.certainly_keeps(1, 3) and found.certainly_leaves(1e-3, 3) and "ToolDeviation" in repr(found)
    by_number = fcl_artic.tool_deviation(robot, motion, len(robot.tree.links) - 1, tool=[0, 0, 0.1])
    assert by_number.length > 0
    # The first joint turns the tool about the vertical: on its own arc it stays, and turns with it.
    arc = fcl_artic.tool_deviation(robot, motion, tool, via=middle)
    assert arc.certainly_keeps(1e-6, 1e-4) and arc.length > found.length
    with pytest.raises(ValueError, match="straight line"):
        fcl_artic.tool_deviation(robot, motion, tool, via=(ends[0] + ends[1]) / 2)
    with pytest.raises(ValueError, match="via"):
        fcl_artic.tool_deviation(robot, motion, tool, via=[0, 1])
    with pytest.raises(TypeError, match="no JointMotion"):
        fcl_artic.tool_deviation(robot, [0, 1], tool)
    with pytest.raises(ValueError, match="1e-6 m"):
        fcl_artic.tool_deviation(robot, fcl_artic.JointMotion.still(robot, np.zeros(6)), tool)


def test_an_srdfs_virtual_joint_moves_the_base_when_asked(data):
    path = data / "puma560" / "puma560.urdf"
    root = fcl_artic.load_urdf(path).tree.links[0]
    srdf = f"<robot name='puma560'><virtual_joint name='v' type='planar' parent_frame='odom' child_link='{root}'/></robot>"
    still = fcl_artic.load_urdf(path, srdf)
    assert still.dof == 6 and "stands still here" in still.notes[-1]
    driven = fcl_artic.load_urdf(path, srdf, virtual_joint=True)
    assert driven.dof == 9 and driven.tree.variables[0] == "v/x"
    with pytest.raises(ValueError, match="no srdf"):
        fcl_artic.load_urdf(path, virtual_joint=True)
    with pytest.raises(ValueError, match="no planar or floating virtual_joint"):
        fcl_artic.load_urdf(path, srdf.replace("planar", "fixed"), virtual_joint=True)


def test_robots_are_combined(robot):
    both = fcl_artic.combine_robots([(robot, "left_"), (robot, "right_", [0, 3, 0])], "two")
    assert both.dof == 12 and both.name == "two"
    assert fcl_artic.World(both).check(np.zeros(12), np.zeros(12)).statistics["pairs"] > 0
    with pytest.raises(TypeError, match="tuples"):
        fcl_artic.combine_robots([robot])


def test_an_allowed_pair_of_no_link_is_refused_by_the_world(robot, data):
    own = fcl_artic.load_urdf(data / "puma560" / "puma560.urdf")
    own.allowed = [("wrist_roll", "shoulder_")]
    with pytest.raises(ValueError, match="shoulder_"):
        fcl_artic.World(own)


def test_scenes_are_made_of_shapes_and_files(data, robot):
    scene = fcl_artic.load_scene(data / "pipes.obj")
    scene.add("table", fcl_artic.box([1, 1, 0.1]), fcl_artic.pose([0, 0, -1], rpy=[0, 0, 0.5]))
    assert scene.names == ["pipes", "table"] and "table" in scene and len(scene) == 2
    assert [o.name for o in scene] == scene.names
    assert scene["table"].geometry.kind == "box" and scene["table"].pose[2, 3] == -1
    with pytest.raises(ValueError, match="already"):
        scene.add("table", fcl_artic.sphere(1))
    with pytest.raises(ValueError, match="did you mean 'table'"):
        scene["tabel"]
    scene.remove("pipes")
    assert scene.names == ["table"]
    both = fcl_artic.combine_scenes([scene, scene], robot)
    assert both.names == ["table", "table#2"]
    small = fcl_artic.load_scene(data / "pipes.obj", scale=0.001)
    assert fcl_artic.unit_notes(robot, small) or small.obstacles[0].geometry.vertices.max() < 0.01


def test_a_scene_is_not_changed_by_the_worlds_that_use_it(robot, scene):
    first, second = fcl_artic.World(robot, scene), fcl_artic.World(robot, scene)
    first.move("pipes", [9, 9, 9])
    assert second.pose("pipes")[0, 3] != 9 and scene["pipes"].pose[0, 3] != 9


SHAPES = [
    fcl_artic.box([1, 2, 3]),
    fcl_artic.sphere(0.5),
    fcl_artic.ellipsoid([1, 2, 3]),
    fcl_artic.capsule(0.5, 1),
    fcl_artic.cylinder(0.5, 1),
    fcl_artic.cone(0.5, 1),
    fcl_artic.halfspace([0, 0, 2], -1),
    fcl_artic.plane([0, 0, 1], 0.5),
    fcl_artic.triangle([0, 0, 0], [1, 0, 0], [0, 1, 0]),
    fcl_artic.convex(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]])),
    fcl_artic.mesh(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])),
    fcl_artic.octree(np.array([[0, 0, 0], [0.5, 0, 0]]), 0.1),
    fcl_artic.points(np.array([[0, 0, 0], [0.5, 0, 0]]), 0.1),
    fcl_artic.points(np.array([[0.0, 0, 0], [0.5, 0, 0]]), [0.1, 0.2]),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.kind)
def test_every_shape_is_met_by_a_ball_that_passes_through_it(shape):
    """A ball goes through the origin, which is in or near every shape, from 10 m above to 10 m below."""
    down = fcl_artic.Motion.translation([0.05, 0.05, 10], [0, 0, -20])
    result = fcl_artic.continuous_collide(fcl_artic.sphere(0.2), down, shape, np.eye(4))
    assert result.contact and result.certain, repr(shape)
    aside = fcl_artic.Motion.translation([50, 50, 9], [0, 0, -1])
    far = fcl_artic.continuous_collide(fcl_artic.sphere(0.2), aside, shape, np.eye(4))
    assert far.free
    assert shape.kind in repr(shape)


def test_the_offset_of_a_plane_is_its_distance():
    down = fcl_artic.Motion.translation([0, 0, 10], [0, 0, -10])
    for shape in (fcl_artic.halfspace([0, 0, 5], 2), fcl_artic.plane([0, 0, 5], 2)):
        result = fcl_artic.continuous_collide(fcl_artic.sphere(1), down, shape, np.eye(4))
        assert math.isclose(result.t_lower, 0.7, abs_tol=1e-5)


class Trimesh:
    def __init__(self, vertices, faces):
        self.vertices, self.faces = vertices, faces


CUBE = Trimesh(
    np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)]),
    np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
              [1, 5, 7], [1, 7, 3]]),
)


def test_a_mesh_is_taken_from_what_has_vertices_and_faces():
    cube = fcl_artic.mesh(CUBE)
    assert np.array_equal(cube.vertices, CUBE.vertices) and np.array_equal(cube.faces, CUBE.faces)
    scene = fcl_artic.Scene()
    scene.add("cube", CUBE)
    assert scene["cube"].geometry.kind == "mesh" and not cube.solid
    inside = fcl_artic.Motion.still([0, 0, 0])
    ball = fcl_artic.sphere(0.1)
    assert fcl_artic.continuous_collide(ball, inside, cube, np.eye(4)).free
    solid = fcl_artic.mesh(CUBE, solid=True)
    assert solid.solid and fcl_artic.continuous_collide(ball, inside, solid, np.eye(4)).contact
    assert fcl_artic.continuous_collide(ball, inside, cube.as_solid(), np.eye(4)).contact


@pytest.mark.parametrize(
    "make, error, text",
    [
        (lambda: fcl_artic.mesh(CUBE.vertices, [[0, 1, 8]]), ValueError, r"faces\[0\] names vertex 8 of 8"),
        (lambda: fcl_artic.mesh(CUBE.vertices, [[0, 1, -1]]), ValueError, r"faces\[0\] names vertex -1"),
        (lambda: fcl_artic.mesh(CUBE.vertices, [[0, 1, 2, 3]]), ValueError, "triangles"),
        (lambda: fcl_artic.mesh(CUBE.vertices, [[0.0, 1, 2]]), TypeError, "integers"),
        (lambda: fcl_artic.mesh(CUBE.vertices * np.nan, CUBE.faces), ValueError, r"vertices\[0\]"),
        (lambda: fcl_artic.mesh(CUBE.vertices[:, :2], CUBE.faces), ValueError, "shape"),
        (lambda: fcl_artic.mesh(CUBE.vertices, np.zeros((0, 3), int)), ValueError, "no triangle"),
        (lambda: fcl_artic.mesh(CUBE.vertices, CUBE.faces[1:], solid=True), ValueError, "closed"),
        (lambda: fcl_artic.mesh(7), TypeError, "vertices and faces"),
        (lambda: fcl_artic.box([1, 1]), ValueError, "size has 2 entries"),
        (lambda: fcl_artic.box([1, 1, 0]), ValueError, "size"),
        (lambda: fcl_artic.sphere(-1), ValueError, "radius is -1.0"),
        (lambda: fcl_artic.sphere(math.inf), ValueError, "radius"),
        (lambda: fcl_artic.sphere("1"), TypeError, "radius"),
        (lambda: fcl_artic.plane([0, 0, 0]), ValueError, "normal"),
        (lambda: fcl_artic.octree([[0, 0, 1e9]], 0.1), ValueError, r"points\[0\]"),
        (lambda: fcl_artic.octree([[0, 0, math.nan]], 0.1), ValueError, r"points\[0\]"),
        (lambda: fcl_artic.octree(np.zeros((0, 3)), 0.1), ValueError, "no row"),
        (lambda: fcl_artic.points(np.zeros((0, 3)), 0.1), ValueError, "no point"),
        (lambda: fcl_artic.points([[0, 0, math.nan]], 0.1), ValueError, "no row that is finite"),
        (lambda: fcl_artic.points([[0, 0, 2e9]], 0.1), ValueError, "point 0"),
        (lambda: fcl_artic.points([[0, 0, 0]], 0.1, voxel=-1), ValueError, "voxel"),
        (lambda: fcl_artic.points([[0, 0, 0]], 0.1, voxel=1e-9), ValueError, "voxel"),
        (lambda: fcl_artic.points(np.zeros(3, [("x", "f4"), ("y", "f4")]), 0.1), ValueError, "no field 'z'"),
        (lambda: fcl_artic.points([[0, 0, 0]], 0), ValueError, "radius"),
        (lambda: fcl_artic.points([[0, 0, 0]], [0.1, 0.2]), ValueError, "1 point and 2 radii"),
    ],
)
def test_a_shape_that_is_none_is_refused_by_name(make, error, text):
    with pytest.raises(error, match=text):
        make()


def test_an_octree_has_the_cell_of_every_point():
    points = np.random.default_rng(5).uniform(-2, 2, (300, 3))
    cells = fcl_artic.octree(points, 0.05)
    for point in points:
        still = fcl_artic.Motion.still(point)
        assert fcl_artic.continuous_collide(fcl_artic.sphere(1e-3), still, cells, np.eye(4)).contact


def test_a_hull_is_the_same_with_and_without_faces():
    points = np.random.default_rng(6).normal(size=(40, 3))
    hull = fcl_artic.convex(points)
    down = fcl_artic.Motion.translation([0, 0, 10], [0, 0, -10])
    ball = fcl_artic.sphere(0.5)
    expected = fcl_artic.continuous_collide(ball, down, hull, np.eye(4))
    given = fcl_artic.continuous_collide(ball, down, fcl_artic.convex(points, [[0, 1, 2]]), np.eye(4))
    assert expected.t_lower == given.t_lower and len(hull.vertices) == 40


def test_an_in_between_motion_meets_both_ends(robot):
    tree = fcl_artic.in_between_tree(robot)
    q0, q1 = np.zeros(6), np.full(6, 0.2)
    begin, end = (robot.tree.forward_kinematics(q) for q in (q0, q1))
    motion = fcl_artic.in_between_motion(tree, begin, end)
    poses = tree.forward_kinematics(motion.configuration(1))
    assert np.allclose(poses[: len(end)], end, atol=1e-9)


def test_poses_turn_as_in_urdf():
    turn = fcl_artic.pose([1, 2, 3], rpy=[0.1, 0.2, 0.3])
    quaternion = [0.0342708, 0.1060205, 0.1435722, 0.9833474]  # of these angles
    assert np.allclose(turn, fcl_artic.pose([1, 2, 3], quaternion=quaternion), atol=1e-6)
    assert np.allclose(turn[:3, :3] @ turn[:3, :3].T, np.eye(3))
    assert np.allclose(fcl_artic.pose(rpy=[0, 0, math.pi / 2])[:3, 0], [0, 1, 0])
    with pytest.raises(ValueError, match="one of them"):
        fcl_artic.pose(rpy=[0, 0, 0], quaternion=[0, 0, 0, 1])
    with pytest.raises(ValueError, match="quaternion is zero"):
        fcl_artic.pose(quaternion=[0, 0, 0, 0])
