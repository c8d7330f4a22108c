#include <algorithm>

#include "poecal/robot/robot_file.hpp"
#include "robot/urdf_file.hpp"

namespace poecal {
namespace {

/// Adds up masses and their centres.
struct Balance {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< sum of mass times centre, in base [kg m]

  LinkMass total() const { return {mass, mass > 0.0 ? Eigen::Vector3d(moment / mass) : Eigen::Vector3d::Zero()}; }
};

/// Adds the mass of `link` and of all that it carries at q = 0, but for the branch through `next`.
void addBodies(const urdf::ModelInterface& model, const std::string& link_name, const Eigen::Isometry3d& T_base_link,
               const urdf::Joint* next, Balance& balance) {
  const urdf::LinkConstSharedPtr link = model.getLink(link_name);
  if (link->inertial) {
    balance.mass += link->inertial->mass;
    balance.moment += link->inertial->mass * (T_base_link * poseOfUrdf(link->inertial->origin)).translation();
  }
  for (const urdf::JointSharedPtr& joint : link->child_joints) {
    if (joint.get() == next) continue;
    addBodies(model, joint->child_link_name, T_base_link * poseOfUrdf(joint->parent_to_joint_origin_transform), next, balance);
  }
}

/// One mass per moving joint: the bodies between it and the next one, with all that they carry. Empty if none has a mass.
std::vector<LinkMass> linksOfChain(const urdf::ModelInterface& model, const std::vector<urdf::JointConstSharedPtr>& chain) {
  std::vector<Balance> balances;
  Eigen::Isometry3d T_base_child = Eigen::Isometry3d::Identity();
  for (std::size_t k = 0; k < chain.size(); ++k) {
    T_base_child = T_base_child * poseOfUrdf(chain[k]->parent_to_joint_origin_transform);
    if (isMoving(*chain[k])) balances.emplace_back();
    if (balances.empty()) continue;  // before the first moving joint everything stands still with the base
    const urdf::Joint* next = k + 1 < chain.size() ? chain[k + 1].get() : nullptr;
    addBodies(model, chain[k]->child_link_name, T_base_child, next, balances.back());
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
  arm.links = linksOfChain(urdf.model(), chain);
  return arm;
}

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
