#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/urdf_file.hpp"

namespace poecal {
namespace {

// Differences below this [m], [rad] are rounding, not calibration: a hundred times that of a chain of ten joints of a metre.
constexpr double kRounding = 1e-13;

/// (roll, pitch, yaw) with R = Rz(yaw) Ry(pitch) Rx(roll), to rounding also where pitch is +-90 degrees.
Eigen::Vector3d rpyOf(const Eigen::Matrix3d& R) {
  // Where R(0, 0) and R(1, 0) are both rounding, roll and yaw turn about the same axis: any yaw will do, and 0 reads best. What yaw
  // leaves over, Ry(pitch) Rx(roll), is read off after turning it back, so an error of yaw cannot spoil the product.
  const bool locked = std::hypot(R(0, 0), R(1, 0)) < 4.0 * std::numeric_limits<double>::epsilon();
  const double yaw = locked ? 0.0 : std::atan2(R(1, 0), R(0, 0));
  const Eigen::Matrix3d rest = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * R;
  return {std::atan2(-rest(1, 2), rest(1, 1)), std::atan2(-rest(2, 0), rest(0, 0)), yaw};
}

std::string urdfNumbers(const Eigen::Vector3d& v) {
  return fmt::format("{} {} {}", formatNumber(v.x()), formatNumber(v.y()), formatNumber(v.z()));
}

void writeOrigin(tinyxml2::XMLElement& joint, const Eigen::Isometry3d& T_parent_child) {
  tinyxml2::XMLElement* origin = joint.FirstChildElement("origin");
  if (origin == nullptr) {
    origin = joint.GetDocument()->NewElement("origin");
    joint.InsertFirstChild(origin);
  }
  origin->SetAttribute("xyz", urdfNumbers(T_parent_child.translation()).c_str());
  origin->SetAttribute("rpy", urdfNumbers(rpyOf(T_parent_child.linear())).c_str());
}

/// Places the origin of a joint; one that is right but for rounding keeps its text.
void placeOrigin(UrdfFile& urdf, const urdf::Joint& joint, const Eigen::Isometry3d& T_parent_child) {
  const Eigen::Isometry3d old = poseOfUrdf(joint.parent_to_joint_origin_transform);
  if ((old.matrix() - T_parent_child.matrix()).norm() <= kRounding) return;
  writeOrigin(*urdf.element("joint", joint.name), T_parent_child);
}

/// Child frame of a moving joint at q = 0: the nominal one moved by the least that takes its axis to the calibrated axis.
Eigen::Isometry3d movedFrame(const Eigen::Isometry3d& T_base_nominal, const Joint& nominal, const Joint& calibrated) {
  Eigen::Isometry3d T_base_child = T_base_nominal;
  T_base_child.linear() = Eigen::Quaterniond::FromTwoVectors(nominal.axis(), calibrated.axis()) * T_base_nominal.linear();
  // A prismatic axis has a direction and no place.
  if (calibrated.type == JointType::kRevolute) {
    const Eigen::Vector3d from_anchor = T_base_nominal.translation() - calibrated.anchor;
    T_base_child.translation() = calibrated.anchor + calibrated.axis() * calibrated.axis().dot(from_anchor);
  }
  return T_base_child;
}

/// True if the joint's frame may be T_base_child: its origin on the axis, the axis where the frame has it.
bool carriesFrame(const Joint& calibrated, const Eigen::Vector3d& axis_child, const Eigen::Isometry3d& T_base_child) {
  if ((T_base_child.linear() * axis_child - calibrated.axis()).norm() > kRounding) return false;
  const Eigen::Vector3d from_anchor = T_base_child.translation() - calibrated.anchor;
  return calibrated.type == JointType::kPrismatic || calibrated.axis().cross(from_anchor).norm() <= kRounding;
}

/// `name`, or with underscores added until no link and no joint is called so.
std::string freeName(const UrdfFile& urdf, std::string name) {
  while (urdf.model().getLink(name) || urdf.model().getJoint(name)) name += '_';
  return name;
}

/// Puts a link and a fixed joint between the last moving joint and its child, the tip link.
void insertFixedJoint(UrdfFile& urdf, const urdf::Joint& last, const Eigen::Isometry3d& T_last_tip) {
  tinyxml2::XMLDocument& xml = urdf.xml();
  tinyxml2::XMLElement* last_element = urdf.element("joint", last.name);
  const std::string& tip = last.child_link_name;
  const std::string carrier = freeName(urdf, tip + "_carrier");
  last_element->FirstChildElement("child")->SetAttribute("link", carrier.c_str());

  tinyxml2::XMLElement* link = xml.NewElement("link");
  link->SetAttribute("name", carrier.c_str());
  tinyxml2::XMLElement* joint = xml.NewElement("joint");
  joint->SetAttribute("name", freeName(urdf, tip + "_calibrated").c_str());
  joint->SetAttribute("type", "fixed");
  joint->InsertNewChildElement("parent")->SetAttribute("link", carrier.c_str());
  joint->InsertNewChildElement("child")->SetAttribute("link", tip.c_str());
  writeOrigin(*joint, T_last_tip);
  xml.RootElement()->InsertAfterChild(last_element, link);
  xml.RootElement()->InsertAfterChild(link, joint);
}

std::string typesOf(const Arm& arm) {
  std::string types;
  for (const Joint& joint : arm.joints) types += joint.type == JointType::kRevolute ? 'R' : 'P';
  return types;
}

}  // namespace

std::string correctedUrdf(const std::filesystem::path& file, const std::string& base_link, const std::string& tip_link, const Arm& arm) {
  UrdfFile urdf(file);
  const std::vector<urdf::JointConstSharedPtr> chain = urdf.chain(base_link, tip_link);
  const Arm nominal = armOfChain(urdf, chain);
  if (typesOf(arm) != typesOf(nominal)) {
    urdf.fail(fmt::format("joints from '{}' to '{}' are {}, expected those of the model: {} (R revolute, P prismatic)", base_link, tip_link,
                          typesOf(nominal), typesOf(arm)));
  }
  const Eigen::Isometry3d T_base_tip = expSe3(arm.gamma);
  Eigen::Isometry3d T_base_nominal = Eigen::Isometry3d::Identity();  // child frame of the joint in hand, as the URDF has it,
  Eigen::Isometry3d T_base_child = Eigen::Isometry3d::Identity();    // and as it shall be
  std::size_t moving = 0;
  for (const urdf::JointConstSharedPtr& joint : chain) {
    const Eigen::Isometry3d T_parent_nominal = poseOfUrdf(joint->parent_to_joint_origin_transform);
    const Eigen::Isometry3d T_base_parent = T_base_child;
    const bool is_last = joint == chain.back();
    T_base_nominal = T_base_nominal * T_parent_nominal;
    if (isMoving(*joint)) {
      const Joint& from = nominal.joints[moving];
      const Joint& to = arm.joints[moving];
      ++moving;
      const bool tip_fits = is_last && carriesFrame(to, T_base_nominal.linear().transpose() * from.axis(), T_base_tip);
      T_base_child = tip_fits ? T_base_tip : movedFrame(T_base_nominal, from, to);
      placeOrigin(urdf, *joint, T_base_parent.inverse() * T_base_child);
      if (is_last && !tip_fits) insertFixedJoint(urdf, *joint, T_base_child.inverse() * T_base_tip);
    } else if (is_last) {
      placeOrigin(urdf, *joint, T_base_parent.inverse() * T_base_tip);
    } else {
      T_base_child = T_base_parent * T_parent_nominal;
    }
  }
  return printedXml(urdf.xml());
}

}  // namespace poecal
