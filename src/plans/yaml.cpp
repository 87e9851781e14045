// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "plans/document.h"

namespace fcl_artic::plans {
namespace {

Json valueOf(const std::string& text) {
  if (text.empty() || text == "~" || text == "null") return nullptr;
  if (text == "true" || text == "false") return text == "true";
  const std::size_t sign = text[0] == '+' || text[0] == '-';
  const std::string bare = text.substr(sign);
  if (bare == ".inf" || bare == ".Inf" || bare == ".INF") {
    return (text[0] == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
  }
  if (bare == ".nan" || bare == ".NaN" || bare == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  // 010 is 8 in YAML 1.1, and 10 in 1.2.
  if (bare.size() > 1 && bare[0] == '0' && bare[1] >= '0' && bare[1] <= '9') return text;
  double value = 0;
  const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  const bool number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return number ? Json(value) : Json(text);
}

/// Builds documents from the parser's events.
class Builder : public YAML::EventHandler {
 public:
  std::vector<Json> documents;

  void OnDocumentStart(const YAML::Mark& mark) override {
    // If a sign begins no value, the parser gives an empty document, and then another one at the same sign, for ever.
    if (mark.pos <= begin_) refuse(mark, "a sign that begins no value");
    begin_ = mark.pos;
    document_ = text::DocumentBuilder();
  }
  void OnDocumentEnd() override { documents.push_back(document_.take()); }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(mark, nullptr); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse(mark, "an alias, which is not read"); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& value) override {
    const bool text = tag == "!" || tag == kCore + std::string("str");
    requireTag(mark, tag, {"!", "bool", "float", "int", "null", "str"});
    add(mark, text || expectsKey() ? Json(value) : valueOf(value));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    requireTag(mark, tag, {"!", "seq"});
    open(mark, false);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, YAML::EmitterStyle::value) override {
    requireTag(mark, tag, {"!", "map"});
    open(mark, true);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    bool is_object, has_key;
  };

  static constexpr const char* kCore = "tag:yaml.org,2002:";  ///< Before the names of YAML's own types.

  /// Refuses a tag that may say what a value means: ROS has !degrees.
  static void requireTag(const YAML::Mark& mark, const std::string& tag, std::initializer_list<const char*> known) {
    if (tag.empty() || tag == "?") return;
    for (const char* name : known) {
      if (tag == name || tag == kCore + std::string(name)) return;
    }
    refuse(mark, fmt::format("the tag {}, which is not read: write values in rad and m", tag));
  }
  [[noreturn]] static void refuse(const YAML::Mark& mark, const std::string& what) {
    throw std::invalid_argument(fmt::format("line {}, column {}: {}", mark.line + 1, mark.column + 1, what));
  }
  bool expectsKey() const { return !levels_.empty() && levels_.back().is_object && !levels_.back().has_key; }
  /// Calls the document's builder, whose errors get the place.
  template <class F>
  static void at(const YAML::Mark& mark, const F& call) {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      refuse(mark, error.what());
    }
  }
  void open(const YAML::Mark& mark, bool is_object) {
    if (expectsKey()) refuse(mark, "a key that is no text");
    at(mark, [&] { is_object ? document_.start_object(0) : document_.start_array(0); });
    if (!levels_.empty()) levels_.back().has_key = false;
    levels_.push_back({is_object, false});
  }
  void close() {
    levels_.back().is_object ? document_.end_object() : document_.end_array();
    levels_.pop_back();
  }
  void add(const YAML::Mark& mark, Json value) {
    if (!expectsKey()) {
      document_.put(std::move(value));
      if (!levels_.empty()) levels_.back().has_key = false;
      return;
    }
    if (!value.is_string()) refuse(mark, "a key that is no text");
    at(mark, [&] { document_.key(value.get_ref<std::string&>()); });
    levels_.back().has_key = true;
  }

  text::DocumentBuilder document_;
  std::vector<Level> levels_;
  int begin_ = -1;  ///< of the document, in the text
};

}  // namespace

std::vector<Json> parseYaml(std::string_view content) {
  // YAML has no such bytes. The parser takes some of them for the end, and would leave out the rest.
  const auto isControl = [](char c) {
    return static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\n' && c != '\r';
  };
  if (std::any_of(content.begin(), content.end(), isControl)) {
    throw std::invalid_argument("it is no YAML: it has a control character");
  }
  std::istringstream in{std::string(content)};
  Builder builder;
  try {
    YAML::Parser parser(in);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(fmt::format("it is no YAML: {}", error.what()));
  }
  return std::move(builder.documents);
}

}  // namespace fcl_artic::plans
