# SPDX-License-Identifier: BSD-3-Clause
import os
import pathlib

import numpy as np
import pytest

import fcl_artic

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"


@pytest.fixture(scope="session")
def data():
    """Folder of the bundled robot and scene."""
    return DATA


@pytest.fixture(scope="session")
def shared_data():
    """Folder of further robots and scenes; tests that need it are skipped, by name, without it."""
    folder = os.environ.get("FCL_ARTIC_DATA")
    if not folder:
        pytest.skip("FCL_ARTIC_DATA is not set")
    return pathlib.Path(folder)


@pytest.fixture(scope="session")
def robot():
    return fcl_artic.load_urdf(DATA / "puma560" / "puma560.urdf")


@pytest.fixture(scope="session")
def scene():
    return fcl_artic.load_scene(DATA / "pipes.obj")


@pytest.fixture(scope="session")
def shared_world(robot, scene):
    """The bundled arm among pipes; not to be changed."""
    world = fcl_artic.World(robot, scene)
    world.setup()
    return world


@pytest.fixture
def world(robot, scene):
    """The bundled arm among pipes, for the test alone."""
    return fcl_artic.World(robot, scene)


HIT = (np.array([-2.1, 1, -1, -0.1, -0.1, 0]), np.array([-0.1, 0.3, -2.3, -1, 1.1, 0]))


@pytest.fixture
def hit():
    """A motion of the bundled arm that meets the pipes."""
    return HIT


@pytest.fixture
def miss():
    """A motion of the bundled arm that is free."""
    return HIT[0], HIT[0] + 0.02 * (HIT[1] - HIT[0])


def random_motions(robot, count, angle=0.3, seed=7):
    """Straight motions between random configurations within the limits, each joint by at most `angle`."""
    random = np.random.default_rng(seed)
    lower, upper = np.clip(robot.tree.limits, -np.pi, np.pi).T
    q0 = random.uniform(lower, upper, (count, robot.dof))
    return q0, q0 + random.uniform(-angle, angle, q0.shape)
