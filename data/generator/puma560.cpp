// SPDX-License-Identifier: BSD-3-Clause
// Unimation PUMA 560: kinematics as published, bodies of our own that follow its look and main dimensions.
//
// Standard Denavit-Hartenberg parameters, A_i = Rz(q_i) Tz(d_i) Tx(a_i) Rx(alpha_i), of Corke and Armstrong-Helouvry,
// "A search for consensus among model parameters reported for the PUMA 560 robot" (ICRA 1994). Ranges of the joints as
// in Fu, Gonzalez, Lee, "Robotics" (1987), in Corke's zero position: upper arm level, forearm upright. A URDF link's
// frame turns with its joint, so link i's frame is DH frame i - 1 turned by q_i, and the origin of joint i + 1 is
// Tz(d_i) Tx(a_i) Rx(alpha_i).
#include <filesystem>
#include <stdexcept>

#include "files/files.h"
#include "loft.h"

namespace fcl_artic::generator {

namespace {

constexpr double kShoulderHeight = 0.67183;  // m, joint 2 above the floor
constexpr double kA2 = 0.4318, kA3 = 0.0203, kD3 = 0.15005, kD4 = 0.4318;
constexpr double kFlange = 0.05625;  // m, mounting face before the wrist's centre

struct JointRow {
  const char* link;     // child
  double a, d, alpha;   // of the DH row before: origin of this joint; m, degrees
  double lower, upper;  // degrees
  double effort;        // N m, Armstrong, Khatib, Burdick (ICRA 1986)
};
constexpr JointRow kJoints[] = {
    {"shoulder", 0, kShoulderHeight, 0, -160, 160, 97.6},
    {"upper_arm", 0, 0, 90, -45, 225, 186.4},
    {"forearm", kA2, 0, 0, -225, 45, 89.4},
    {"wrist_roll", kA3, kD3, -90, -110, 170, 24.2},
    {"wrist_bend", 0, kD4, 90, -100, 100, 20.1},
    {"flange", 0, 0, -90, -266, 266, 21.3},
};

/// Local x, y, z as columns.
Eigen::Isometry3d axes(const Eigen::Vector3d& x, const Eigen::Vector3d& y, const Eigen::Vector3d& z) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << x, y, z;
  return pose;
}
const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(), kZ = Eigen::Vector3d::UnitZ();

/// A rectangle with round corners as a hull of circles.
std::vector<Circle> roundedRectangle(double x, double y, double half_x, double half_y, double radius) {
  const double dx = half_x - radius, dy = half_y - radius;
  return {{x + dx, y + dy, radius}, {x - dx, y + dy, radius}, {x - dx, y - dy, radius}, {x + dx, y - dy, radius}};
}

Mesh base() {
  Mesh m;
  const Eigen::Isometry3d up = Eigen::Isometry3d::Identity();
  addPlate(m, up, roundedRectangle(0, 0, 0.14, 0.14, 0.04), 0, 0.03, 0.006);
  addPlate(m, up, {{0, 0, 0.08}}, 0.025, 0.5, 0.004, 48);
  addPlate(m, up, {{0, 0, 0.09}}, 0.48, 0.545, 0.01, 48);
  addPlate(m, up, roundedRectangle(-0.08, 0, 0.035, 0.045, 0.01), 0.02, 0.17, 0.008);  // connectors
  return m;
}

/// Frame: z up the base's axis, in the height of joint 2, whose axis is -y.
Mesh shoulder() {
  Mesh m;
  addPlate(m, Eigen::Isometry3d::Identity(), {{0, 0, 0.085}}, -0.135, -0.03, 0.006, 48);
  const Eigen::Isometry3d sideways = axes(kX, kZ, -kY);
  addPlate(m, sideways, {{0, 0, 0.095}}, -0.115, 0.172, 0.02, 48);
  addPlate(m, sideways, {{0, 0, 0.06}}, -0.135, -0.1, 0.01);
  return m;
}

/// Frame: joint 2 about z, x along the arm to the elbow.
Mesh upperArm() {
  Mesh m;
  const Eigen::Isometry3d flat = Eigen::Isometry3d::Identity();
  addPlate(m, flat, {{0, 0, 0.088}}, 0.165, 0.205, 0.004);
  addPlate(m, flat, {{-0.1, 0, 0.1}, {0, 0, 0.115}, {kA2, 0, 0.07}}, 0.192, 0.295, 0.018, 56);
  addPlate(m, flat, {{0, 0, 0.085}}, 0.28, 0.305, 0.006, 40);
  addPlate(m, flat, {{kA2, 0, 0.05}}, 0.28, 0.303, 0.005);
  return m;
}

/// Frame: joint 3 (the elbow) about z; the wrist's axis runs along y at x = a3, z = d3.
Mesh forearm() {
  Mesh m;
  addPlate(m, Eigen::Isometry3d::Identity(), {{0, 0, 0.06}}, 0.14, 0.198, 0.004, 48);  // elbow bearing
  // A box that tapers into a round end.
  struct Section {
    double y, x, half_x, half_z, radius;
  };
  constexpr Section kSections[] = {
      {-0.118, 0, 0.05, 0.024, 0.02},     {-0.113, 0, 0.064, 0.034, 0.026},   {-0.1, 0, 0.073, 0.04, 0.03},
      {-0.08, 0, 0.078, 0.042, 0.03},     {0.04, 0.002, 0.08, 0.042, 0.03},   {0.09, 0.005, 0.076, 0.042, 0.031},
      {0.16, 0.011, 0.064, 0.042, 0.034}, {0.25, kA3, 0.05, 0.042, 0.04},     {0.285, kA3, 0.045, 0.042, 0.0418},
      {0.318, kA3, 0.045, 0.045, 0.0449}, {0.325, kA3, 0.042, 0.042, 0.0419},
  };
  const Eigen::Isometry3d along = axes(kZ, kX, kY);
  std::vector<Ring> rings;
  for (const Section& s : kSections) {
    Ring ring;
    for (const auto& p : hullOfCircles(roundedRectangle(kD3, s.x, s.half_z, s.half_x, s.radius), 0, 48)) {
      ring.push_back(along * Eigen::Vector3d(p.x(), p.y(), s.y));
    }
    rings.push_back(std::move(ring));
  }
  addLoft(m, rings);
  return m;
}

/// Frame: joint 4 about z, wrist's centre at z = d4; joint 5 is along -y. A neck and a fork.
Mesh wristRoll() {
  Mesh m;
  addPlate(m, Eigen::Isometry3d::Identity(), {{0, 0, 0.043}}, 0.31, 0.385, 0.007);
  const Eigen::Isometry3d sideways = axes(kX, kZ, -kY);
  for (const double side : {-1.0, 1.0}) {
    const auto plate = [&](const std::vector<Circle>& outline, double near, double far, double rim) {
      addPlate(m, sideways, outline, side < 0 ? -far : near, side < 0 ? -near : far, rim, 24);
    };
    plate({{0, kD4, 0.036}, {0, 0.372, 0.03}}, 0.031, 0.044, 0.004);
    plate({{0, kD4, 0.022}}, 0.042, 0.049, 0.002);
  }
  return m;
}

/// Frame: wrist's centre, joint 5 about z, joint 6 along y.
Mesh wristBend() {
  Mesh m;
  addPlate(m, Eigen::Isometry3d::Identity(), {{0, 0, 0.03}}, -0.03, 0.03, 0.004);
  addPlate(m, axes(kZ, kX, kY), {{0, 0, 0.024}}, 0, 0.038, 0.003);
  return m;
}

/// Frame: wrist's centre, joint 6 about z.
Mesh flange() {
  Mesh m;
  addPlate(m, Eigen::Isometry3d::Identity(), {{0, 0, 0.02}}, 0.034, 0.046, 0.002);
  addPlate(m, Eigen::Isometry3d::Identity(), {{0, 0, 0.0315}}, 0.0435, kFlange, 0.002);
  return m;
}

/// Radians of whole degrees, in decimals made by integer arithmetic: 17 digits of pi are ample for six.
std::string radians(double degrees) {
  const auto micro = static_cast<long long>(degrees * 17453.292519943295 + (degrees < 0 ? -0.5 : 0.5));
  std::string text = std::to_string(micro < 0 ? -micro : micro);
  text.insert(0, text.size() < 7 ? 7 - text.size() : 0, '0');
  return (micro < 0 ? "-" : "") + text.insert(text.size() - 6, 1, '.');
}

/// The shortest decimals of a table entry (at most five after the point).
std::string decimals(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  return text.back() == '.' ? text + '0' : text;
}

std::string linkXml(const std::string& name) {
  const std::string geometry = "      <geometry><mesh filename=\"meshes/" + name + ".obj\"/></geometry>\n";
  return "  <link name=\"" + name + "\">\n    <visual>\n" + geometry + "    </visual>\n    <collision>\n" + geometry +
         "    </collision>\n  </link>\n";
}

std::string urdf() {
  std::string text = R"(<?xml version="1.0"?>
<!-- SPDX-License-Identifier: BSD-3-Clause
     Unimation PUMA 560, made by data/generator. Kinematics: standard DH parameters of Corke and Armstrong-Helouvry (1994);
     zero position: upper arm level, forearm upright. Joint limits: Fu, Gonzalez, Lee (1987). Efforts: Armstrong, Khatib,
     Burdick (1986). Velocities are nominal: URDF asks for one. -->
<robot name="puma560">
)";
  std::string parent = "base";
  text += linkXml(parent);
  int number = 1;
  for (const JointRow& j : kJoints) {
    // Right angles to all digits of a double: link frames are to be orthonormal.
    const char* roll = j.alpha > 0 ? "1.5707963267948966" : j.alpha < 0 ? "-1.5707963267948966" : "0";
    text += linkXml(j.link);
    text += "  <joint name=\"joint" + std::to_string(number++) + "\" type=\"revolute\">\n    <parent link=\"" + parent +
            "\"/>\n    <child link=\"" + j.link + "\"/>\n    <origin xyz=\"" + decimals(j.a) + " 0.0 " + decimals(j.d) +
            "\" rpy=\"" + roll + " 0 0\"/>\n    <axis xyz=\"0 0 1\"/>\n    <limit lower=\"" + radians(j.lower) +
            "\" upper=\"" + radians(j.upper) + "\" effort=\"" + decimals(j.effort) +
            "\" velocity=\"1.0\"/>\n  </joint>\n";
    parent = j.link;
  }
  text += "  <link name=\"tool0\"/>\n  <joint name=\"tool0_mount\" type=\"fixed\">\n    <parent link=\"" + parent +
          "\"/>\n    <child link=\"tool0\"/>\n    <origin xyz=\"0.0 0.0 " + decimals(kFlange) +
          "\" rpy=\"0 0 0\"/>\n  </joint>\n</robot>\n";
  return text;
}

}  // namespace

std::vector<NamedMesh> puma560Meshes() {
  std::vector<NamedMesh> meshes = {{"base", base()},       {"shoulder", shoulder()},    {"upper_arm", upperArm()},
                                   {"forearm", forearm()}, {"wrist_roll", wristRoll()}, {"wrist_bend", wristBend()},
                                   {"flange", flange()}};
  for (NamedMesh& m : meshes) snap(m.mesh);
  return meshes;
}

void writePuma560(const std::string& dir) {
  const std::filesystem::path root(dir);
  std::error_code error;
  std::filesystem::create_directories(root / "meshes", error);
  if (error) throw std::runtime_error("can't make folder '" + (root / "meshes").string() + "': " + error.message());
  for (const NamedMesh& m : puma560Meshes()) {
    files::write((root / "meshes" / (m.link + ".obj")).string(), objText(m.mesh, "PUMA 560, link " + m.link + "; m"));
  }
  files::write((root / "puma560.urdf").string(), urdf());
}

}  // namespace fcl_artic::generator
