// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cmath>
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

constexpr std::size_t kDeepestYaml = 100;  // no message is deeper

Json valueOf(const std::string& text) {
  if (text.empty() || text == "~" || text == "null") return nullptr;
  if (text == "true" || text == "false") return text == "true";
  const std::size_t sign = text[0] == '+' || text[0] == '-';
  const std::string bare = text.substr(sign);
  if (bare == ".inf" || bare == ".Inf" || bare == ".INF") {
    return (text[0] == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
  }
  if (bare == ".nan" || bare == ".NaN" || bare == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  double value = 0;
  const char* begin = text.data() + (text[0] == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  const bool number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return number ? Json(value) : Json(text);
}

/// Builds a document from the parser's events.
class Builder : public YAML::EventHandler {
 public:
  std::vector<Json> documents;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(mark, nullptr); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse(mark, "an alias, which is not read"); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t, const std::string& value) override {
    add(mark, tag == "!" || expectsKey() ? Json(value) : valueOf(value));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, Json::array());
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(mark, Json::object());
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    Json value;
    std::string key;  ///< of the value to come
    bool has_key = false;
  };

  [[noreturn]] static void refuse(const YAML::Mark& mark, const std::string& what) {
    throw std::invalid_argument(fmt::format("line {}, column {}: {}", mark.line + 1, mark.column + 1, what));
  }
  bool expectsKey() const { return !levels_.empty() && levels_.back().value.is_object() && !levels_.back().has_key; }
  void open(const YAML::Mark& mark, Json value) {
    if (expectsKey()) refuse(mark, "a key that is no text");
    if (levels_.size() >= kDeepestYaml) refuse(mark, fmt::format("more than {} levels", kDeepestYaml));
    levels_.push_back({std::move(value), {}, false});
  }
  void close() {
    Json value = std::move(levels_.back().value);
    levels_.pop_back();
    put(std::move(value));
  }
  void add(const YAML::Mark& mark, Json value) {
    if (!expectsKey()) return put(std::move(value));
    Level& level = levels_.back();
    if (!value.is_string()) refuse(mark, "a key that is no text");
    level.key = value.get<std::string>();
    if (level.value.contains(level.key)) refuse(mark, fmt::format("the key '{}' is there twice", level.key));
    level.has_key = true;
  }
  void put(Json value) {
    if (levels_.empty()) {
      documents.push_back(std::move(value));
      return;
    }
    Level& level = levels_.back();
    if (level.value.is_array()) {
      level.value.push_back(std::move(value));
    } else {
      level.value[level.key] = std::move(value);
      level.has_key = false;
    }
  }

  std::vector<Level> levels_;
};

}  // namespace

std::vector<Json> parseYaml(std::string_view content) {
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
