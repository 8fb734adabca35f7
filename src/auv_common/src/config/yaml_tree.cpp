#include "auv_common/config/yaml_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/regular_file.hpp"

namespace stg::config {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;
constexpr std::size_t kMaxDepth = 16;

/// Builds the tree from the parser's events. The parser's own node type would expand aliases and
/// lose duplicate keys.
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string origin, bool with_lines, int max_values)
      : origin_(std::move(origin)), with_lines_(with_lines), max_values_(max_values) {}

  YamlTree Take() { return std::move(root_); }

  [[noreturn]] void Fail(int line, const std::string& message) const {
    throw UserError(origin_ + (with_lines_ ? ":" + std::to_string(line) : "") + ": " + message);
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Refuse(mark, "", anchor);
    Add(Make(mark, YamlTree::Kind::kNull));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Fail(mark.line + 1, "aliases (*name) are not allowed here");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    Refuse(mark, tag, anchor);
    YamlTree node = Make(mark, YamlTree::Kind::kScalar);
    node.scalar = value;
    node.quoted = tag == "!";
    Add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Refuse(mark, tag, anchor);
    Open(Make(mark, YamlTree::Kind::kSequence));
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Refuse(mark, tag, anchor);
    Open(Make(mark, YamlTree::Kind::kMap));
  }
  void OnMapEnd() override { Close(); }

 private:
  /// A map or sequence that is not complete yet.
  struct Frame {
    YamlTree node;
    bool has_key = false;
    std::string key;
    int key_line = 1;
    std::map<std::string, int> seen;  ///< line of each key
  };

  void Refuse(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) const {
    if (anchor != YAML::NullAnchor) Fail(mark.line + 1, "anchors (&name) are not allowed here");
    if (!tag.empty() && tag != "?" && tag != "!") {
      Fail(mark.line + 1, "tags are not allowed here, found " + Quoted(tag));
    }
  }

  YamlTree Make(const YAML::Mark& mark, YamlTree::Kind kind) {
    if (++nodes_ > max_values_) {
      Fail(mark.line + 1, "more than " + std::to_string(max_values_) + " values");
    }
    YamlTree node;
    node.kind = kind;
    node.line = mark.line + 1;
    return node;
  }

  void Open(YamlTree node) {
    if (stack_.size() >= kMaxDepth) Fail(node.line, "nested too deeply");
    if (ExpectsKey()) Fail(node.line, "not valid here: a key must be a plain word");
    Frame frame;
    frame.node = std::move(node);
    stack_.push_back(std::move(frame));
  }

  void Close() {
    YamlTree node = std::move(stack_.back().node);
    stack_.pop_back();
    Add(std::move(node));
  }

  bool ExpectsKey() const {
    return !stack_.empty() && stack_.back().node.kind == YamlTree::Kind::kMap &&
           !stack_.back().has_key;
  }

  void Add(YamlTree node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Frame& frame = stack_.back();
    if (frame.node.kind == YamlTree::Kind::kSequence) {
      frame.node.items.push_back(std::move(node));
      return;
    }
    if (!frame.has_key) {
      if (node.kind != YamlTree::Kind::kScalar)
        Fail(node.line, "not valid here: a key must be a plain word");
      const auto inserted = frame.seen.emplace(node.scalar, node.line);
      if (!inserted.second) {
        Fail(node.line, KeyPath(node.scalar) + ": duplicate key, first given in line " +
                            std::to_string(inserted.first->second));
      }
      frame.has_key = true;
      frame.key = node.scalar;
      frame.key_line = node.line;
      return;
    }
    frame.has_key = false;
    frame.node.entries.push_back({frame.key, frame.key_line, std::move(node)});
  }

  std::string KeyPath(const std::string& leaf) const {
    std::string path;
    for (const Frame& frame : stack_) {
      if (frame.has_key) path += frame.key + ".";
    }
    return path + leaf;
  }

  std::string origin_;
  bool with_lines_;
  int max_values_, nodes_ = 0;
  YamlTree root_;
  std::vector<Frame> stack_;
};

}  // namespace

YamlTree ParseYaml(const std::string& text, const std::string& origin, bool with_lines,
                   int max_values) {
  TreeBuilder builder(origin, with_lines, max_values);
  const auto nul = text.find('\0');
  if (nul != std::string::npos) builder.Fail(1, "not a text file (it holds a zero byte)");
  std::istringstream stream(text);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return {};
    YamlTree tree = builder.Take();
    TreeBuilder rest(origin, with_lines, max_values);
    if (parser.HandleNextDocument(rest)) {
      builder.Fail(rest.Take().line, "more than one YAML document");
    }
    return tree;
  } catch (const YAML::Exception& e) {
    builder.Fail(e.mark.is_null() ? 1 : e.mark.line + 1, "not valid YAML: " + e.msg);
  }
}

std::string ReadBoundedFile(const std::string& path) {
  RequireRegularFile(path, kMaxBytes);
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    throw UserError(path + ": cannot be read" +
                    (errno != 0 ? std::string(": ") + std::strerror(errno) : ""));
  }
  // The size is checked again, because the file may grow while it is read.
  std::string text;
  char part[4096];
  while (stream.read(part, sizeof(part)), stream.gcount() > 0) {
    text.append(part, static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaxBytes) {
      throw UserError(path + ": larger than " + std::to_string(kMaxBytes) + " bytes");
    }
  }
  if (stream.bad()) throw UserError(path + ": cannot be read");
  return text;
}

std::string Quoted(const std::string& text) {
  constexpr std::size_t kLongest = 60;
  std::string out = "'";
  for (std::size_t i = 0; i < text.size() && i < kLongest; ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    out += (c < 0x20 || c == 0x7f) ? '?' : text[i];
  }
  return out + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace stg::config
