#include "robot/urdf_file.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <locale>
#include <map>
#include <mutex>
#include <numbers>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/utf8.hpp"
#include "poecal/core/choices.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/robot/robot_file.hpp"
#include "robot/arm_size.hpp"

namespace poecal {
namespace {

// urdfdom reports through console_bridge, whose handler is global: it is borrowed under a lock and given back.
class CollectedErrors : public console_bridge::OutputHandler {
 public:
  CollectedErrors() : lock_(mutex()) { console_bridge::useOutputHandler(this); }
  ~CollectedErrors() override { console_bridge::restorePreviousOutputHandler(); }
  CollectedErrors(const CollectedErrors&) = delete;
  CollectedErrors& operator=(const CollectedErrors&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) messages.push_back(text);
  }

  std::vector<std::string> messages;

 private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
};

// True of messages about a link that urdfdom keeps all the same, with whatever part of its mass it had understood.
bool isAboutInertial(const std::string& message) { return message.find("nertial element") != std::string::npos; }

const char* typeName(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::FLOATING:
      return "floating";
    case urdf::Joint::PLANAR:
      return "planar";
    default:
      return "of unknown type";
  }
}

/// The first element, in the order of the file, for which `condition` holds; null where there is none.
template <typename Condition>
const tinyxml2::XMLElement* findFirst(const tinyxml2::XMLElement* element, const Condition& condition) {
  for (; element != nullptr; element = element->NextSiblingElement()) {
    if (condition(*element)) return element;
    if (const tinyxml2::XMLElement* inner = findFirst(element->FirstChildElement(), condition)) return inner;
  }
  return nullptr;
}

template <typename Condition>
bool anyAttribute(const tinyxml2::XMLElement& element, const Condition& condition) {
  for (const tinyxml2::XMLAttribute* attribute = element.FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    if (condition(std::string_view(attribute->Value()))) return true;
  }
  return false;
}

/// Whether xacro would replace it: it is one of its own, or has an expression in an attribute.
bool isMacro(const tinyxml2::XMLElement& element) {
  return std::string_view(element.Name()).starts_with("xacro:") || anyAttribute(element, [](std::string_view value) {
           return value.find("${") != std::string_view::npos || value.find("$(") != std::string_view::npos;
         });
}

/// Whether an angle of its rpy is more than a whole turn: no program writes that in radians, and people write 90 for a right angle.
bool isTurnedInDegrees(const tinyxml2::XMLElement& element) {
  constexpr double kTurn = 2.0 * std::numbers::pi + 1e-3;  // 6.2832 is a rounded turn
  const char* rpy = element.Attribute("rpy");
  if (rpy == nullptr) return false;
  std::istringstream angles(rpy);
  angles.imbue(std::locale::classic());
  double angle = 0.0;
  while (angles >> angle) {
    if (std::abs(angle) > kTurn) return true;
  }
  return false;
}

/// The file is UTF-8, but a number such as &#xD800; in it may stand for no sign at all.
bool holdsNoSign(const tinyxml2::XMLElement& element) {
  for (const tinyxml2::XMLNode* node = element.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToText() != nullptr && !isUtf8(node->Value())) return true;
  }
  return anyAttribute(element, [](std::string_view value) { return !isUtf8(value); });
}

constexpr double kSmallestAxis = 1e-9;

bool isBelow(urdf::LinkConstSharedPtr link, const std::string& ancestor) {
  while (link && link->name != ancestor) link = link->getParent();
  return link != nullptr;
}

}  // namespace

bool isUrdf(const std::filesystem::path& file) { return file.extension() == ".urdf" || looksLikeXml(readTextFile(file)); }

std::string printedXml(const tinyxml2::XMLDocument& xml) {
  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  return printer.CStr();
}

UrdfFile::UrdfFile(const std::filesystem::path& file) : file_(file) {
  const std::string text = readUtf8File(file);
  if (xml_.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw FileError(file, xml_.ErrorLineNum(), fmt::format("not valid XML ({}), expected a URDF", xml_.ErrorName()));
  }
  const tinyxml2::XMLElement* root = xml_.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot") {
    throw FileError(file, root == nullptr ? 1 : root->GetLineNum(),
                    fmt::format("begins with {}, expected <robot>", root == nullptr ? "no element" : fmt::format("<{}>", root->Name())));
  }
  for (const tinyxml2::XMLNode* node = root->NextSibling(); node != nullptr; node = node->NextSibling()) {
    if (node->ToComment() == nullptr) throw FileError(file, node->GetLineNum(), "goes on behind </robot>, expected nothing there");
  }
  if (const tinyxml2::XMLElement* element = findFirst(root, holdsNoSign)) {
    throw FileError(file, element->GetLineNum(), "holds a number of a sign (as &#xD800;) that there is not, expected a text in UTF-8");
  }
  if (const tinyxml2::XMLElement* macro = findFirst(root, isMacro)) {
    throw FileError(file, macro->GetLineNum(), "is a xacro, expected it expanded: xacro arm.urdf.xacro > arm.urdf");
  }
  if (const tinyxml2::XMLElement* origin = findFirst(root, isTurnedInDegrees)) {
    throw FileError(file, origin->GetLineNum(),
                    fmt::format("rpy is '{}', more than a whole turn, expected radians; is it in degrees?", origin->Attribute("rpy")));
  }
  CollectedErrors errors;
  // What the one reader made of the text, so that the other makes nothing else of odd signs in it.
  model_ = urdf::parseURDF(printedXml(xml_));
  const bool bad_inertial = std::any_of(errors.messages.begin(), errors.messages.end(), isAboutInertial);
  if (!model_ || bad_inertial) {
    const std::string message = fmt::format("{}", fmt::join(errors.messages, "; "));
    throw FileError(file, lineNamedIn(message), "not a valid URDF: " + message);
  }
  requireNames();
  requireTree();
}

void UrdfFile::requireNames() const {
  const auto require = [&](const char* tag, const auto& of_urdfdom) {
    std::set<std::string> names;
    for (const auto* each = xml_.RootElement()->FirstChildElement(tag); each != nullptr; each = each->NextSiblingElement(tag)) {
      if (const char* name = each->Attribute("name")) names.insert(name);
    }
    for (const auto& [name, one] : of_urdfdom) {
      if (names.contains(name)) continue;
      fail(fmt::format("{} '{}' has a name that readers of XML disagree about, expected plain letters", tag, name));
    }
  };
  require("link", model_->links_);
  require("joint", model_->joints_);
}

void UrdfFile::requireTree() const {
  std::map<std::string, const urdf::Joint*> joint_above;
  for (const auto& [name, joint] : model_->joints_) {
    const auto [other, fresh] = joint_above.emplace(joint->child_link_name, joint.get());
    if (!fresh) {
      failAtJoint(*joint, fmt::format("closes a ring of links (link '{}' is on joint '{}' too), expected a tree", other->first,
                                      other->second->name));
    }
  }
  std::set<std::string> rooted;  // links from which the way up ends
  for (const auto& [name, joint] : model_->joints_) {
    std::set<std::string> path;
    std::string link = joint->child_link_name;
    while (!rooted.contains(link)) {
      if (!path.insert(link).second) failAtJoint(*joint_above.at(link), "has links that form a ring, expected a tree");
      const auto above = joint_above.find(link);
      if (above == joint_above.end()) break;
      link = above->second->parent_link_name;
    }
    rooted.merge(path);
  }
}

const tinyxml2::XMLElement* UrdfFile::element(const char* tag, const std::string& name) const {
  const tinyxml2::XMLElement* element = xml_.RootElement()->FirstChildElement(tag);
  while (element != nullptr && !element->Attribute("name", name.c_str())) element = element->NextSiblingElement(tag);
  return element;
}

tinyxml2::XMLElement* UrdfFile::element(const char* tag, const std::string& name) {
  return const_cast<tinyxml2::XMLElement*>(std::as_const(*this).element(tag, name));
}

int UrdfFile::lineNamedIn(const std::string& message) const {
  for (const auto* element = xml_.RootElement()->FirstChildElement(); element != nullptr; element = element->NextSiblingElement()) {
    const char* name = element->Attribute("name");
    if (name != nullptr && message.find(fmt::format("[{}]", name)) != std::string::npos) return element->GetLineNum();
  }
  return 0;
}

void UrdfFile::failAtJoint(const urdf::Joint& joint, const std::string& message) const {
  throw FileError(file_, element("joint", joint.name)->GetLineNum(), fmt::format("joint '{}' {}", joint.name, message));
}

void UrdfFile::failAtLink(const std::string& name, const std::string& message) const {
  throw FileError(file_, element("link", name)->GetLineNum(), fmt::format("link '{}' {}", name, message));
}

void UrdfFile::fail(const std::string& message) const { throw FileError(file_, 0, message); }

urdf::LinkConstSharedPtr UrdfFile::link(const std::string& name) const {
  if (const urdf::LinkConstSharedPtr found = model_->getLink(name)) return found;
  std::vector<std::string> names;
  for (const auto& entry : model_->links_) names.push_back(entry.first);
  fail(fmt::format("link '{}' is not there, expected one of: {}", name, choices(name, std::move(names))));
}

std::vector<urdf::JointConstSharedPtr> UrdfFile::chain(const std::string& base_link, const std::string& tip_link) const {
  const urdf::LinkConstSharedPtr base = link(base_link);
  const urdf::LinkConstSharedPtr tip = link(tip_link);
  if (!isBelow(tip, base_link)) {
    if (isBelow(base, tip_link)) {
      fail(fmt::format("base link '{}' lies below tip link '{}', expected the base nearer to the root", base_link, tip_link));
    }
    fail(fmt::format("no chain leads from link '{}' to link '{}', they are on different branches", base_link, tip_link));
  }
  std::vector<urdf::JointConstSharedPtr> joints;
  for (urdf::LinkConstSharedPtr link = tip; link->name != base_link; link = link->getParent()) joints.push_back(link->parent_joint);
  std::reverse(joints.begin(), joints.end());
  for (const urdf::JointConstSharedPtr& joint : joints) {
    if (joint->mimic) failAtJoint(*joint, fmt::format("mimics '{}', expected a joint of its own", joint->mimic->joint_name));
    if (!isMoving(*joint) && joint->type != urdf::Joint::FIXED) {
      failAtJoint(*joint, fmt::format("is {}, expected revolute, continuous, prismatic or fixed", typeName(*joint)));
    }
  }
  if (std::none_of(joints.begin(), joints.end(), [](const auto& joint) { return isMoving(*joint); })) {
    fail(fmt::format("no moving joint between link '{}' and link '{}', expected at least one", base_link, tip_link));
  }
  return joints;
}

bool isMoving(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS || joint.type == urdf::Joint::PRISMATIC;
}

Eigen::Isometry3d poseOfUrdf(const urdf::Pose& pose) {
  return poseFromQuaternion({pose.position.x, pose.position.y, pose.position.z},
                            {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w});
}

Arm armOfChain(const UrdfFile& urdf, const std::vector<urdf::JointConstSharedPtr>& chain) {
  Arm arm;
  Eigen::Isometry3d T_base_child = Eigen::Isometry3d::Identity();
  for (const urdf::JointConstSharedPtr& joint : chain) {
    T_base_child = T_base_child * poseOfUrdf(joint->parent_to_joint_origin_transform);
    if (const auto problem = sizeProblem(T_base_child.translation())) urdf.failAtJoint(*joint, *problem);
    if (!isMoving(*joint)) continue;
    const Eigen::Vector3d axis(joint->axis.x, joint->axis.y, joint->axis.z);
    if (!(axis.norm() > kSmallestAxis && axis.norm() < 1.0 / kSmallestAxis)) {
      urdf.failAtJoint(*joint, fmt::format("has an axis of length {:.3g}, expected a direction", axis.norm()));
    }
    const Eigen::Vector3d origin = T_base_child.translation();
    const Eigen::Vector3d axis_base = T_base_child.linear() * axis;
    arm.joints.push_back(joint->type == urdf::Joint::PRISMATIC ? Joint::prismatic(joint->name, axis_base, origin)
                                                               : Joint::revolute(joint->name, axis_base, origin));
    // Some exporters write 0 for what is not known.
    if (joint->limits && joint->limits->velocity > 0.0) arm.joints.back().largest_speed = joint->limits->velocity;
    // Lower and upper are 0 where <limit> leaves them out, which is no range at all.
    const bool has_range = joint->limits && (joint->limits->lower != 0.0 || joint->limits->upper != 0.0);
    if (joint->type == urdf::Joint::CONTINUOUS || !has_range) continue;
    const JointLimits limits{joint->limits->lower, joint->limits->upper};
    if (const auto problem = limitsProblem(arm.joints.back().type, limits)) urdf.failAtJoint(*joint, "has limits " + *problem);
    arm.joints.back().limits = limits;
  }
  arm.gamma = logSe3(T_base_child);
  return arm;
}

}  // namespace poecal
