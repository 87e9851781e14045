# SPDX-License-Identifier: BSD-3-Clause
import fcl_artic

robot = fcl_artic.load_urdf("data/puma560/puma560.urdf")  # second argument: an SRDF file, if you have one
world = fcl_artic.World(robot, fcl_artic.load_scene("data/pipes.obj"))

q0 = [-2.1, 1.0, -1.0, -0.1, -0.1, 0.0]  # rad, in the order of robot.tree.variables
q1 = [-0.1, 0.3, -2.3, -1.0, 1.1, 0.0]
result = world.check(q0, q1)
print(result)  # "contact within [0.43395303..., 0.43395303...], proven", or "free: proven"
if result.first:
    print(result.pair, result.first.point)  # who and where
    world.picture(q0, q1, result=result).save("contact.png")
