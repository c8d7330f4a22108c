#include "core/yaml.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <sstream>

#include <yaml-cpp/eventhandler.h>

#include <fmt/format.h>

#include "poecal/core/choices.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

/// Listens to the documents of a file being read for keys that a map has twice, on which readers of YAML differ, and for a document beside
/// the first, which most readers leave out in silence.
class Contradictions : public YAML::EventHandler {
 public:
  Contradictions(const std::filesystem::path& file, YamlNode::Documents documents) : file_(file), documents_(documents) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    ++document_;
    line_ = mark.line + 1;
    position_ = mark.pos;
  }
  /// Where the last document began [bytes].
  int position() const { return position_; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override { endNode(); }
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override { endNode(); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& text) override {
    if (!open_.empty() && open_.back().key_next && !open_.back().keys.insert(text).second) {
      throw FileError(file_, mark.line + 1, fmt::format("key '{}' is there twice, expected it once", text));
    }
    endNode();
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    requireFirst();
    open_.push_back({.is_map = false, .key_next = false, .keys = {}});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    requireFirst();
    open_.push_back({.is_map = true, .key_next = true, .keys = {}});
  }
  void OnMapEnd() override { close(); }

 private:
  struct Collection {
    bool is_map, key_next;
    std::set<std::string> keys;
  };
  /// An empty document, or a word after the end, is none: "---" also ends one.
  void requireFirst() const {
    if (document_ < 2 || documents_ == YamlNode::Documents::kFirstOfMany) return;
    throw FileError(file_, line_, "a second document begins here, expected one");
  }
  void close() {
    open_.pop_back();
    endNode();
  }
  void endNode() {
    if (!open_.empty() && open_.back().is_map) open_.back().key_next = !open_.back().key_next;
  }

  const std::filesystem::path& file_;
  YamlNode::Documents documents_;
  int document_ = 0;
  int line_ = 0;
  int position_ = 0;
  std::vector<Collection> open_;
};

void requireNoContradiction(const std::filesystem::path& file, const std::string& content, YamlNode::Documents documents) {
  std::istringstream stream(content);
  YAML::Parser parser(stream);
  Contradictions contradictions(file, documents);
  // Of many documents the first is read, whatever the others are. What follows one without "---" is no document, and yaml-cpp stays at it.
  int at = -1;
  bool more = parser.HandleNextDocument(contradictions);
  while (more && documents == YamlNode::Documents::kOne && contradictions.position() > at) {
    at = contradictions.position();
    more = parser.HandleNextDocument(contradictions);
  }
}

/// Whether an integer begins with a zero that is not all of it.
bool hasLeadingZero(std::string_view text) {
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  return text.size() > 1 && text.front() == '0';
}

}  // namespace

YamlNode::YamlNode(std::shared_ptr<const std::filesystem::path> file, YAML::Node node, std::string name)
    : file_(std::move(file)), node_(std::move(node)), name_(std::move(name)) {}

YamlNode YamlNode::load(const std::filesystem::path& file, Documents documents) {
  const std::string content = readUtf8File(file);
  if (looksLikeXml(content)) throw FileError(file, 1, "begins as XML does, expected YAML");
  try {
    requireNoContradiction(file, content, documents);
    YamlNode root(std::make_shared<const std::filesystem::path>(file), YAML::Load(content), "");
    if (!root.isMap()) throw FileError(file, 1, "expected a YAML map of keys and values");
    return root;
  } catch (const YAML::Exception& error) {
    throw FileError(file, error.mark.line + 1, "not valid YAML: " + error.msg);
  }
}

int YamlNode::line() const { return node_.Mark().line + 1; }

void YamlNode::fail(const std::string& message) const { throw FileError(*file_, line(), name_.empty() ? message : name_ + ": " + message); }

void YamlNode::failAtKey(const std::string& key, const std::string& message) const {
  for (const auto& entry : node_) {
    if (entry.first.as<std::string>("") == key) throw FileError(*file_, entry.first.Mark().line + 1, message);
  }
  fail(message);
}

void YamlNode::checkKeys(std::initializer_list<const char*> known) const {
  if (!isMap()) fail("expected a map");
  for (const auto& entry : node_) {
    const std::string key = entry.first.as<std::string>("");
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw FileError(*file_, entry.first.Mark().line + 1,
                      fmt::format("unknown key '{}'{}, expected one of: {}", key, name_.empty() ? "" : " in " + name_,
                                  choices(key, {known.begin(), known.end()})));
    }
  }
}

std::vector<std::string> YamlNode::keys() const {
  if (!isMap()) fail("expected a map");
  std::vector<std::string> keys;
  for (const auto& entry : node_) keys.push_back(entry.first.as<std::string>(""));
  return keys;
}

bool YamlNode::has(const char* key) const { return isMap() && node_[key].IsDefined() && !node_[key].IsNull(); }

YamlNode YamlNode::operator[](const char* key) const {
  if (auto found = find(key)) return *found;
  fail(fmt::format("key '{}' is missing", key));
}

std::optional<YamlNode> YamlNode::find(const char* key) const {
  if (!isMap()) fail("expected a map");
  if (!has(key)) return std::nullopt;
  return YamlNode(file_, node_[key], name_.empty() ? std::string(key) : name_ + "." + key);
}

std::vector<YamlNode> YamlNode::items() const {
  if (!isSequence()) fail("expected a list");
  std::vector<YamlNode> nodes;
  for (std::size_t k = 0; k < node_.size(); ++k) nodes.push_back(YamlNode(file_, node_[k], fmt::format("{}[{}]", name_, k)));
  return nodes;
}

double YamlNode::number() const {
  double value = 0.0;
  if (!node_.IsScalar() || !YAML::convert<double>::decode(node_, value)) fail("expected a number");
  if (!(std::abs(value) <= kLargestNumber)) fail("expected a finite number");
  return value;
}

double YamlNode::positive() const {
  const double value = number();
  if (!(value > 0.0)) fail(fmt::format("is {}, expected a positive number", formatNumber(value)));
  return value;
}

int YamlNode::integer() const {
  int value = 0;
  if (!node_.IsScalar() || !YAML::convert<int>::decode(node_, value)) fail("expected an integer");
  if (hasLeadingZero(node_.Scalar())) fail(fmt::format("is {}, expected an integer without a leading zero", node_.Scalar()));
  return value;
}

std::string YamlNode::text() const {
  if (!node_.IsScalar()) fail("expected a text");
  return node_.Scalar();
}

Eigen::VectorXd YamlNode::vector(int count) const {
  const std::vector<YamlNode> entries = items();
  if (count >= 0 && static_cast<int>(entries.size()) != count) {
    fail(fmt::format("{} numbers, expected {}", entries.size(), count));
  }
  Eigen::VectorXd values(static_cast<Eigen::Index>(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k) values(static_cast<Eigen::Index>(k)) = entries[k].number();
  return values;
}

void YamlNode::checkFormat(const char* expected) const {
  const YamlNode format = (*this)["format"];
  if (format.text() != expected) format.fail(fmt::format("is '{}', expected {}", format.text(), expected));
}

std::string yamlVector(const Eigen::VectorXd& values) {
  std::string text = "[";
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    text += k > 0 ? ", " : "";
    text += std::isinf(values(k)) ? (values(k) > 0.0 ? ".inf" : "-.inf") : formatNumber(values(k));
  }
  return text + "]";
}

std::string yamlText(const std::string& text) {
  // The emitter alone leaves plain what reads back as a number or a truth value, and commas and brackets that split a flow map.
  double number = 0.0;
  bool truth = false;
  const YAML::Node scalar(text);
  YAML::Emitter emitter;
  if (text.find_first_of(",[]{}") != std::string::npos || YAML::convert<double>::decode(scalar, number) ||
      YAML::convert<bool>::decode(scalar, truth)) {
    emitter << YAML::DoubleQuoted;
  }
  emitter << text;
  return emitter.c_str();
}

}  // namespace poecal
