// SPDX-License-Identifier: BSD-3-Clause
#include <set>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "plans/document.h"

namespace fcl_artic::plans {
namespace {

/// Lists and objects within each other. (Messages nest ten deep. Whoever goes through a document calls itself for each
/// level.)
constexpr std::size_t kDeepest = 100;

/// The text with NaN, Infinity and -Infinity in quotes, where they stand outside of strings.
std::string withQuotedWords(std::string_view content) {
  std::string out;
  out.reserve(content.size());
  bool in_string = false;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const char c = content[i];
    if (in_string) {
      if (c == '\\' && i + 1 < content.size()) out += content[i++];
      in_string = content[i] != '"' || c == '\\';
      out += content[i];
      continue;
    }
    bool word = false;
    for (const std::string_view name : {"NaN", "Infinity", "-Infinity"}) {
      if (content.substr(i, name.size()) != name) continue;
      out += fmt::format("\"{}\"", name);
      i += name.size() - 1;
      word = true;
      break;
    }
    if (word) continue;
    in_string = c == '"';
    out += c;
  }
  return out;
}

/// Makes a document of the parser's events, in time that grows with the text. (The parser's own callbacks look through
/// a list again after each object in it.)
class DocumentBuilder : public nlohmann::json_sax<Json> {
 public:
  Json take() { return std::move(document_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // JSON has none
  bool start_object(std::size_t) override {
    keys_.emplace_back();
    return open(Json::object());
  }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override {
    keys_.pop_back();
    return close();
  }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second)
      throw std::invalid_argument(fmt::format("the key '{}' is there twice in one object", name));
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) override {
    throw std::invalid_argument(fmt::format("it is no JSON: {}", error.what()));
  }

 private:
  /// Puts a value where the next one goes. @return it, there.
  Json& place(Json value) {
    if (open_.empty()) return document_ = std::move(value);
    if (open_.back()->is_array()) {
      open_.back()->push_back(std::move(value));
      return open_.back()->back();
    }
    // At the end of an ordered object, whose operator[] would look through all keys.
    auto& members = open_.back()->get_ref<Json::object_t&>();
    members.push_back({key_, std::move(value)});
    return members.back().second;
  }
  bool put(Json value) {
    place(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (open_.size() == kDeepest)
      throw std::invalid_argument(fmt::format("lists and objects are nested more than {} deep", kDeepest));
    open_.push_back(&place(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  Json document_;
  std::vector<Json*> open_;                  ///< what is open grows at its end only, so that these stay where they are
  std::vector<std::set<std::string>> keys_;  ///< of the objects that are open
  std::string key_;
};

}  // namespace

Json parseJson(std::string_view content) {
  DocumentBuilder builder;
  try {
    Json::sax_parse(withQuotedWords(content), &builder);
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(fmt::format("it is no JSON: {}", error.what()));
  }
  return builder.take();
}

}  // namespace fcl_artic::plans
