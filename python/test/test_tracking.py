# SPDX-License-Identifier: BSD-3-Clause
"""Tracking errors from logs: what is read, what is refused, and the option that is printed."""
import subprocess
import sys

import numpy as np
import pytest

import fcl_artic
from fcl_artic import tracking

URDF = """<robot name="cell"><link name="base"/><link name="arm"/><link name="rail"/><link name="wrist"/><link name="jaw"/>
<joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="slide" type="prismatic"><parent link="arm"/><child link="rail"/><axis xyz="1 0 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="spin" type="continuous"><parent link="rail"/><child link="wrist"/><axis xyz="0 0 1"/></joint>
<joint name="jaw_joint" type="prismatic"><parent link="wrist"/><child link="jaw"/><axis xyz="0 1 0"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="slide" multiplier="-2"/></joint></robot>"""


@pytest.fixture(scope="module")
def urdf(tmp_path_factory):
    path = tmp_path_factory.mktemp("robot") / "cell.urdf"
    path.write_text(URDF)
    return path


@pytest.fixture(scope="module")
def tree(urdf):
    return fcl_artic.load_urdf(urdf).tree


@pytest.fixture
def log(tmp_path):
    def write(text, name="log.csv"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


ROWS = [[0.5, 0.503, 0.1, 0.1], [0.6, 0.598, 0.2, 0.195], [0.7, 0.7, 0.3, 0.301]]
LARGEST = {"hinge": 0.003, "slide": 0.005}


def table(header, separator=",", rows=ROWS):
    lines = [header.replace(",", separator)]
    return "\n".join(lines + [separator.join(map(str, row)) for row in rows]) + "\n"


def largest(tracked):
    return {one.joint: pytest.approx(one.largest) for one in tracked}


@pytest.mark.parametrize("header", [
    "hinge/command,hinge/actual,slide/command,slide/actual",
    "hinge_cmd,hinge,slide_cmd,slide",
    "desired hinge,measured hinge,desired slide,measured slide",
    "/ctl/reference/hinge/position,/joint_states/hinge/position,/ctl/reference/slide/position,/joint_states/slide/position",
    "# target.hinge,actual.hinge,target.slide,actual.slide",
])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_columns_are_found_by_their_names(tree, log, header, separator):
    assert largest(tracking.measure([log(table(header, separator))], tree)) == LARGEST


def test_numbered_columns_are_the_joints_in_their_order(tree, log):
    for first, form in ((0, "target_q_{},actual_q_{}"), (1, "/jtc/desired/positions[{}],/jtc/actual/positions[{}]")):
        header = ",".join(form.format(k, k) for k in range(first, first + 3)) + ",target_qd_0,actual_qd_0,timestamp"
        rows = [[0.5, 0.503, 0.1, 0.1, 0, 0.001, 9, 0, 1], [0.6, 0.598, 0.2, 0.195, 0, 0, 9, 0, 2]]
        tracked = tracking.measure([log(table(header, rows=rows))], tree)
        assert largest(tracked) == {**LARGEST, "spin": 0.001}


def test_quantile_place_and_several_logs(tree, log):
    rows = [[0, 0.001 * (k < 2) + 1e-4] for k in range(1000)]
    first = log(table("hinge_ref,hinge", rows=rows), "a.csv")
    (one,) = tracking.measure([first], tree)
    assert (one.rows, one.unit, one.where) == (1000, "rad", f"{first} line 2")
    assert one.quantile == pytest.approx(0.0011), "998 rows of 1000 are no 99.9 %"
    rows[0] = [0, 1e-4]
    (other,) = tracking.measure([log(table("hinge_ref,hinge", rows=rows))], tree)
    assert (other.largest, other.quantile) == (pytest.approx(0.0011), pytest.approx(1e-4)), "999 rows of 1000 are"
    second = log(table("hinge_ref,hinge", rows=[[0, 0], [1, 0.75]]), "b.csv")
    (both,) = tracking.measure([first, second], tree)
    assert (both.rows, both.largest, both.where) == (1002, 0.25, f"{second} line 3")


def test_endless_turns_count_by_their_angle(tree, log):
    text = table("spin_cmd,spin,hinge_cmd,hinge", rows=[[3.14, -3.14, 1, 1.5]])
    assert largest(tracking.measure([log(text)], tree)) == {"hinge": 0.5, "spin": 2 * np.pi - 6.28}
    text = table("spin_cmd,spin", rows=[[179, -179]])
    assert largest(tracking.measure([log(text)], tree, degrees=True)) == {"spin": 2}


def test_the_option_covers_the_largest_difference(tree, log):
    for value in (0.00123456, 0.9995, 3.0, 0.1, 123.4, 1e-7, 0.001001):
        rows = [[0, value, 0, 0.5 * value, 0, 2 * value]]
        path = log(table("hinge_cmd,hinge,slide_cmd,slide,jaw_joint_cmd,jaw_joint", rows=rows))
        option = tracking.option(tracking.measure([path], tree), tree)
        parts = dict(part.split("=") for part in option.split(" ")[1].split(","))
        assert set(parts) == {"hinge", "slide"}, "the jaw follows the slide"
        for joint, unit in (("hinge", "rad"), ("slide", "m")):
            assert value <= float(parts[joint].removesuffix(unit)) <= 1.011 * value, option


def refusal(*arguments, **options):
    with pytest.raises(ValueError) as error:
        tracking.measure(*arguments, **options)
    return str(error.value)


def test_bad_logs_are_refused_by_file_line_and_column(tree, log):
    assert "is empty" in refusal([log("\n\n")], tree)
    assert "has a header and no row" in refusal([log("hinge_cmd,hinge\n")], tree)
    assert "two columns are named 'hinge'" in refusal([log("hinge,hinge\n1,2\n")], tree)
    assert "line 3 has 1 values, the header 2 names" in refusal([log("hinge_cmd,hinge\n1,2\n1\n")], tree)
    path = log("hinge_cmd,hinge\n1,2\n\n1,\n")
    assert refusal([path], tree).startswith(f"'{path}' line 4, column 'hinge' is empty: each row needs both values")
    assert "line 2, column 'hinge_cmd' is '0,5', no number" in refusal([log("hinge_cmd;hinge\n0,5;1\n")], tree)
    assert "line 2, column 'hinge' is nan" in refusal([log("hinge_cmd,hinge\n1,nan\n")], tree)
    none = refusal([log("time,hinge,slide\n0,1,2\n")], tree)
    assert "no joint has both a commanded and an actual column among time, hinge, slide: say which with --joint" in none
    assert "'hinge' and 'actual_hinge' may both be the actual values of joint 'hinge': say which with --joint" in refusal(
        [log("hinge_cmd,hinge,actual_hinge\n1,2,3\n")], tree)
    two = refusal([log("target_q_0,actual_q_0,target_q_1,actual_q_1\n1,2,3,4\n")], tree)
    assert "columns are numbered 0, 1, and the robot has 3 joints" in two
    assert "some columns name their joint" in refusal(
        [log(",".join(f"cmd_q{k},q{k}" for k in range(3)) + ",hinge_cmd,hinge\n" + ",".join("1" * 8) + "\n")], tree)


def test_columns_may_be_said(tree, log):
    path = log("u,x\n0.5,0.25\n")
    assert "no joint has both" in refusal([path], tree)
    assert largest(tracking.measure([path], tree, columns={"hinge": ("u", "x")})) == {"hinge": 0.25}
    assert "has no column 'y' among u, x" in refusal([path], tree, columns={"hinge": ("u", "y")})
    assert "robot 'cell' has no joint 'henge'" in refusal([path], tree, columns={"henge": ("u", "x")})


def run(*arguments):
    command = [sys.executable, "-m", "fcl_artic.tracking", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def test_the_program(urdf, log):
    path = log(table("hinge_cmd,hinge,slide_cmd,slide"))
    status, out, err = run(path, "--robot", urdf)
    assert (status, err) == (0, "")
    assert "--joint-tolerance hinge=0.00301rad,slide=0.00501m\n" in out or \
        "--joint-tolerance hinge=0.00300rad,slide=0.00500m\n" in out, out
    assert f"{path} line 2" in out and "note: no tolerance is measured of spin: " in out
    assert "note: with less than 1000 rows" in out
    status, out, err = run(path, "--robot", urdf, "--degrees", "--joint", "hinge=hinge_cmd,hinge")
    assert status == 0 and "deg" in out and "slide=" not in out
    status, out, err = run(log("hinge_cmd,hinge\n1,1\n"), "--robot", urdf)
    assert status == 0 and "are the same in every row" in out and "--joint-tolerance hinge=0rad" in out
    for arguments, said in (
        ((path, "--robot", path), "log.csv"),
        ((urdf.parent / "none.csv", "--robot", urdf), "none.csv"),
        ((path, "--robot", urdf, "--joint", "hinge"), "--joint: 'hinge' is not JOINT=COMMANDED,ACTUAL"),
    ):
        status, out, err = run(*arguments)
        assert (status, out) == (2, "") and err.startswith("tracking: ") and said in err and "Traceback" not in err, err


def test_few_rows_that_are_far_off_are_named(urdf, log):
    path = log(table("hinge_cmd,hinge", rows=[[0, 1 if k == 700 else 0.01] for k in range(2000)]))
    status, out, _ = run(path, "--robot", urdf)
    assert status == 0 and f"note: hinge: few rows are far off, the most in {path} line 702" in out
