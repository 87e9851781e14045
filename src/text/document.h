// SPDX-License-Identifier: BSD-3-Clause
// Documents of names, lists and values.
#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace fcl_artic::text {

using Json = nlohmann::ordered_json;

/// Lists and objects within each other. (Messages nest ten deep. Whoever goes through a document calls itself for each
/// level.)
constexpr std::size_t kDeepestDocument = 100;

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
      throw std::invalid_argument("the key '" + name + "' is there twice in one object");
    key_ = std::move(name);
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) override {
    throw std::invalid_argument(std::string("it is no JSON: ") + error.what());
  }

  /// A value of any kind.
  bool put(Json value) {
    place(std::move(value));
    return true;
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
  bool open(Json value) {
    if (open_.size() == kDeepestDocument)
      throw std::invalid_argument("lists and objects are nested more than " + std::to_string(kDeepestDocument) +
                                  " deep");
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

/// @throws std::invalid_argument for what is no JSON, a key that an object has twice, and lists that are too deep.
inline Json parseJson(std::string_view content) {
  if (content.find('\0') != content.npos) throw std::invalid_argument("it is no JSON: it has a byte 0");
  DocumentBuilder builder;
  try {
    Json::sax_parse(content, &builder);
  } catch (const nlohmann::json::exception& error) {
    throw std::invalid_argument(std::string("it is no JSON: ") + error.what());
  }
  return builder.take();
}

}  // namespace fcl_artic::text
