// Forward kinematics of a URDF by KDL: a second implementation to hold ours against.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <urdf_parser/urdf_parser.h>

namespace poecal::test {

inline KDL::Frame kdlFrame(const urdf::Pose& pose) {
  return {KDL::Rotation::Quaternion(pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w),
          KDL::Vector(pose.position.x, pose.position.y, pose.position.z)};
}

inline KDL::Joint kdlJoint(const urdf::Joint& joint) {
  const KDL::Frame T_parent_joint = kdlFrame(joint.parent_to_joint_origin_transform);
  const KDL::Vector axis = T_parent_joint.M * KDL::Vector(joint.axis.x, joint.axis.y, joint.axis.z);
  if (joint.type == urdf::Joint::FIXED) return KDL::Joint(joint.name, KDL::Joint::Fixed);
  const bool prismatic = joint.type == urdf::Joint::PRISMATIC;
  return KDL::Joint(joint.name, T_parent_joint.p, axis, prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis);
}

/// The chain base_link .. tip_link of a URDF text, built from urdfdom's model as ROS' kdl_parser builds it.
inline KDL::Chain kdlChain(const std::string& urdf_text, const std::string& base_link, const std::string& tip_link) {
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(urdf_text);
  if (!model) throw std::runtime_error("urdfdom does not read this URDF");
  std::vector<KDL::Segment> segments;
  for (urdf::LinkConstSharedPtr link = model->getLink(tip_link); link->name != base_link; link = link->getParent()) {
    const urdf::Joint& joint = *link->parent_joint;
    segments.emplace(segments.begin(), link->name, kdlJoint(joint), kdlFrame(joint.parent_to_joint_origin_transform));
  }
  KDL::Chain chain;
  for (const KDL::Segment& segment : segments) chain.addSegment(segment);
  return chain;
}

/// T_base_tip of a chain at q.
inline Eigen::Isometry3d kdlForwardKinematics(const KDL::Chain& chain, const Eigen::VectorXd& q) {
  KDL::JntArray joints(chain.getNrOfJoints());
  joints.data = q;
  KDL::Frame frame;
  if (KDL::ChainFkSolverPos_recursive(chain).JntToCart(joints, frame) < 0) throw std::runtime_error("KDL: wrong number of joints");
  Eigen::Isometry3d T_base_tip = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) T_base_tip(row, column) = frame.M(row, column);
    T_base_tip(row, 3) = frame.p(row);
  }
  return T_base_tip;
}

}  // namespace poecal::test
