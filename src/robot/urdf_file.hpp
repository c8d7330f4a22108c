// A URDF read twice: by urdfdom for what it means, by tinyxml2 for the lines of messages and for editing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <tinyxml2.h>
#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include "poecal/robot/arm.hpp"

namespace poecal {

class UrdfFile {
 public:
  /// @throws FileError: missing file, not XML, a xacro, not a URDF (the message is urdfdom's, the line that of the joint or link it names),
  /// links that form no tree.
  explicit UrdfFile(const std::filesystem::path& file);

  const urdf::ModelInterface& model() const { return *model_; }
  tinyxml2::XMLDocument& xml() { return xml_; }
  /// The <joint> or <link> of that name right under <robot> (a transmission has a <joint> too); null if there is none.
  const tinyxml2::XMLElement* element(const char* tag, const std::string& name) const;
  tinyxml2::XMLElement* element(const char* tag, const std::string& name);
  /// @throws FileError at the line of that <joint>.
  [[noreturn]] void failAtJoint(const urdf::Joint& joint, const std::string& message) const;
  /// Likewise of a <link>.
  [[noreturn]] void failAtLink(const std::string& name, const std::string& message) const;
  /// @throws FileError about the file as a whole.
  [[noreturn]] void fail(const std::string& message) const;

  /// Joints from base_link to tip_link in that order, fixed ones included.
  /// @throws FileError: a link that is not there, tip not below base, a mimic, floating or planar joint, no moving joint.
  std::vector<urdf::JointConstSharedPtr> chain(const std::string& base_link, const std::string& tip_link) const;

 private:
  urdf::LinkConstSharedPtr link(const std::string& name) const;
  int lineNamedIn(const std::string& message) const;
  /// The two readers may make different names of odd signs, and then nothing is found by its name. @throws FileError
  void requireNames() const;
  /// urdfdom takes links in a ring, and a link on two joints. @throws FileError
  void requireTree() const;

  std::filesystem::path file_;
  urdf::ModelInterfaceSharedPtr model_;
  tinyxml2::XMLDocument xml_;
};

std::string printedXml(const tinyxml2::XMLDocument& xml);
/// Revolute, continuous or prismatic: one degree of freedom.
bool isMoving(const urdf::Joint& joint);
/// Pose from a URDF's <origin>, R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Isometry3d poseOfUrdf(const urdf::Pose& pose);
/// The moving joints of a chain (UrdfFile::chain) at q = 0 in base, and gamma from its end; without name and links.
/// @throws FileError: an axis without direction, limits that are not lower < upper.
Arm armOfChain(const UrdfFile& urdf, const std::vector<urdf::JointConstSharedPtr>& chain);

}  // namespace poecal
