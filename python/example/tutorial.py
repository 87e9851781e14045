# SPDX-License-Identifier: BSD-3-Clause
"""From a URDF to a proof and a picture:  python3 tutorial.py ROBOT.urdf [ROBOT.srdf]"""
import sys

import numpy as np

import fcl_artic

robot = fcl_artic.load_urdf(*sys.argv[1:3])
report = robot.classify_link_pairs()  # which pairs of links never touch, proven; which always do
robot.allowed |= report.always_touching
robot.proofs = report.proofs
print(robot, report, sep="\n")

# A table below the arm, and posts around it.
reach = robot.reach
scene = fcl_artic.Scene()
scene.add("table", fcl_artic.box([2 * reach, 2 * reach, 0.02]), [0, 0, -0.3 * reach])
for i, angle in enumerate(np.linspace(0, 2 * np.pi, 7)[:-1]):
    place = 0.7 * reach * np.array([np.cos(angle), np.sin(angle), 0])
    scene.add(f"post{i}", fcl_artic.cylinder(0.03, reach), place + [0, 0, 0.2 * reach])
world = fcl_artic.World(robot, scene)

# Motions between random configurations, at once: the first free one and the first contact.
random = np.random.default_rng(1)
lower, upper = np.clip(robot.tree.limits, -2.5, 2.5).T
q0 = random.uniform(lower, upper, (2000, robot.dof))
q1 = q0 + random.uniform(-0.8, 0.8, q0.shape)
answers = world.check_many(q0, q1)
print(answers)
free = np.flatnonzero(answers.free)[0]
hit = np.flatnonzero(answers.contact & (answers.t_lower > 0.3))[0]

print(world.check(q0[free], q1[free]), world.clearance(q0[free], q1[free], check_self=False), sep="\n")
print(world.check(q0[hit], q1[hit]))
world.picture(q0[hit], q1[hit]).save("tutorial.png")
