# SPDX-License-Identifier: BSD-3-Clause
"""The examples run as printed."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

import fcl_artic

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "python" / "example"


def run(folder, *command):
    environment = {**os.environ, "PYTHONPATH": str(pathlib.Path(fcl_artic.__file__).parents[1])}
    done = subprocess.run([sys.executable, *map(str, command)], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def requires_pictures(shared_world, hit):
    try:
        shared_world.picture(*hit, size=(64, 64))
    except RuntimeError as error:
        pytest.skip(str(error))


def test_the_readme_has_the_first_check_as_it_is():
    code = (EXAMPLES / "first_check.py").read_text().split("\n", 1)[1]
    assert f"```python\n{code}```" in (ROOT / "README.md").read_text()


def test_the_first_check_meets_the_pipes(tmp_path, shared_world, hit):
    requires_pictures(shared_world, hit)
    (tmp_path / "data").symlink_to(ROOT / "data")
    printed = run(tmp_path, EXAMPLES / "first_check.py")
    assert re.match(r"contact within \[0\.43395303\d*, 0\.43395303\d*\], proven\n\('wrist_roll', 'pipes'\) \[", printed)
    assert (tmp_path / "contact.png").read_bytes().startswith(b"\x89PNG")


def check_tutorial(tmp_path, *robot):
    script = EXAMPLES / "tutorial.py"
    assert len(script.read_text().splitlines()) <= 40
    printed = run(tmp_path, script, *robot)
    assert re.search(r"<Answers: [1-9]\d* free( \(\d+ but for some pairs\))?, [1-9]\d* in contact", printed), printed
    assert "free: proven" in printed and "<Clearance: from" in printed and "contact within" in printed
    assert (tmp_path / "tutorial.png").stat().st_size > 10000


def test_the_tutorial_runs_on_the_bundled_arm(tmp_path, data, shared_world, hit):
    requires_pictures(shared_world, hit)
    check_tutorial(tmp_path, data / "puma560" / "puma560.urdf")


def test_the_tutorial_runs_on_the_panda_of_the_shared_data(tmp_path, shared_data, shared_world, hit):
    requires_pictures(shared_world, hit)
    panda = shared_data / "robots" / "panda"
    check_tutorial(tmp_path, panda / "panda.urdf", panda / "panda.srdf")
