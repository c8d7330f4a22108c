#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "poecal/robot/robot_file.hpp"
#include "robot/arm_size.hpp"
#include "robot/urdf_file.hpp"

namespace poecal {
namespace {

/// Adds up masses and their centres.
struct Balance {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< sum of mass times centre, in base [kg m]

  LinkMass total() const { return {mass, mass > 0.0 ? Eigen::Vector3d(moment / mass) : Eigen::Vector3d::Zero()}; }
};

/// Adds the mass of `link_name` and of all that hangs on it at q = 0, but for the branch through `next`.
void addBodies(const UrdfFile& urdf, const std::string& link_name, const Eigen::Isometry3d& T_base_link, const urdf::Joint* next,
               Balance& balance) {
  std::vector<std::pair<std::string, Eigen::Isometry3d>> waiting{{link_name, T_base_link}};
  while (!waiting.empty()) {
    const auto [name, T_base_body] = waiting.back();
    waiting.pop_back();
    const urdf::LinkConstSharedPtr link = urdf.model().getLink(name);
    if (link->inertial) {
      const Eigen::Vector3d centre = (T_base_body * poseOfUrdf(link->inertial->origin)).translation();
      const double mass = link->inertial->mass;
      if (const auto problem = massProblem(mass)) urdf.failAtLink(name, "has a mass of " + *problem);
      if (const auto problem = sizeProblem(centre)) urdf.failAtLink(name, *problem);
      balance.mass += mass;
      balance.moment += mass * centre;
    }
    for (const urdf::JointSharedPtr& joint : link->child_joints) {
      if (joint.get() != next)
        waiting.emplace_back(joint->child_link_name, T_base_body * poseOfUrdf(joint->parent_to_joint_origin_transform));
    }
  }
}

/// One mass per moving joint: the bodies between it and the next one, with all that they carry. Empty if none has a mass.
std::vector<LinkMass> linksOfChain(const UrdfFile& urdf, const std::vector<urdf::JointConstSharedPtr>& chain) {
  std::vector<Balance> balances;
  Eigen::Isometry3d T_base_child = Eigen::Isometry3d::Identity();
  for (std::size_t k = 0; k < chain.size(); ++k) {
    T_base_child = T_base_child * poseOfUrdf(chain[k]->parent_to_joint_origin_transform);
    if (isMoving(*chain[k])) balances.emplace_back();
    if (balances.empty()) continue;  // before the first moving joint everything stands still with the base
    const urdf::Joint* next = k + 1 < chain.size() ? chain[k + 1].get() : nullptr;
    addBodies(urdf, chain[k]->child_link_name, T_base_child, next, balances.back());
  }
  std::vector<LinkMass> links;
  if (std::none_of(balances.begin(), balances.end(), [](const Balance& balance) { return balance.mass > 0.0; })) return links;
  for (const Balance& balance : balances) links.push_back(balance.total());
  return links;
}

}  // namespace

Arm readUrdf(const std::filesystem::path& file, const std::string& base_link, const std::string& tip_link) {
  const UrdfFile urdf(file);
  const std::vector<urdf::JointConstSharedPtr> chain = urdf.chain(base_link, tip_link);
  Arm arm = armOfChain(urdf, chain);
  arm.name = urdf.model().getName();
  arm.links = linksOfChain(urdf, chain);
  return arm;
}

bool hasLink(const std::filesystem::path& file, const std::string& link) { return UrdfFile(file).model().links_.contains(link); }

UrdfEnds urdfEnds(const std::filesystem::path& file) {
  const UrdfFile urdf(file);
  UrdfEnds ends;
  ends.root = urdf.model().getRoot()->name;
  for (const auto& [name, link] : urdf.model().links_) {
    if (link->child_joints.empty()) ends.leaves.push_back(name);
  }
  return ends;
}

}  // namespace poecal
