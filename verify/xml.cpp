// SPDX-License-Identifier: BSD-3-Clause
#include "xml.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "readers.h"

namespace verify {
namespace {

constexpr const char* kBlanks = " \t\r\n";

/// Whether a number stands for no character of Unicode: tinyxml2 may end an attribute there, and drops what follows.
bool namesNoCharacter(const std::string& text) {
  for (std::size_t at = text.find("&#"); at != std::string::npos; at = text.find("&#", at + 1)) {
    const bool hexadecimal = text.compare(at + 2, 1, "x") == 0;
    const char* const digits = text.c_str() + at + (hexadecimal ? 3 : 2);
    char* end = nullptr;
    const unsigned long value = std::strtoul(digits, &end, hexadecimal ? 16 : 10);
    if (end != digits && (value == 0 || value > 0x10ffff)) return true;
  }
  return false;
}

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

/// Whether all of a word is a decimal number: no other base, no comma, nothing after it.
bool isDecimal(const std::string& word) {
  std::size_t at = 0, digits = 0;
  const auto sign = [&]() { at += at < word.size() && (word[at] == '-' || word[at] == '+'); };
  const auto take = [&]() {
    for (; at < word.size() && isDigit(word[at]); ++at) ++digits;
  };
  sign();
  take();
  if (at < word.size() && word[at] == '.') {
    ++at;
    take();
  }
  if (digits == 0) return false;
  if (at < word.size() && (word[at] == 'e' || word[at] == 'E')) {
    ++at;
    sign();
    digits = 0;
    take();
    if (digits == 0) return false;
  }
  return at == word.size();
}

}  // namespace

// (The program runs in C's own locale.)
double decimal(const std::string& word) {
  if (!isDecimal(word)) throw BadInput("'" + word.substr(0, 60) + "' is no decimal number");
  const double x = std::strtod(word.c_str(), nullptr);
  if (!std::isfinite(x)) throw BadInput("'" + word.substr(0, 60) + "' is beyond all doubles");
  return x;
}
std::vector<double> decimals(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t at = text.find_first_not_of(kBlanks), end; at != std::string::npos;
       at = text.find_first_not_of(kBlanks, end)) {
    end = std::min(text.find_first_of(kBlanks, at), text.size());
    numbers.push_back(decimal(text.substr(at, end - at)));
  }
  return numbers;
}

std::string readFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in || std::filesystem::is_directory(path)) throw BadInput("can't open '" + path + "'");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string packageName(const std::string& path) {
  tinyxml2::XMLDocument document;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  const std::string text = readFile(path);
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) return {};
  const tinyxml2::XMLElement* const name = document.RootElement()->FirstChildElement("name");
  const std::string all = name == nullptr || name->GetText() == nullptr ? "" : name->GetText();
  const std::size_t begin = std::min(all.find_first_not_of(kBlanks), all.size());
  return all.substr(begin, all.find_first_of(kBlanks, begin) - begin);
}

Xml::Xml(const std::string& path) : path_(path) {
  const std::string text = readFile(path);
  if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw BadInput("'" + path + "' is no XML that can be read");
  if (text.find('\0') != std::string::npos) throw BadInput("'" + path + "' has a byte 0");
  if (namesNoCharacter(text)) throw BadInput("'" + path + "' has a number (&#...;) that is no character");
  for (const tinyxml2::XMLNode* node = document_.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToUnknown() != nullptr) throw BadInput("'" + path + "' has a document type, which is not read");
    if (node->ToText() != nullptr) throw BadInput("'" + path + "' has text outside of <robot>");
    if (node->ToElement() == nullptr) continue;
    if (robot_ != nullptr) throw BadInput("'" + path + "' has two root elements");
    robot_ = node->ToElement();
  }
  if (robot_ == nullptr || std::string(robot_->Name()) != "robot") throw BadInput("'" + path + "' has no <robot>");
}

void Xml::refuse(const Element& e, const std::string& why) const {
  throw BadInput("'" + path_ + "', line " + std::to_string(e.GetLineNum()) + ", <" + e.Name() + ">: " + why);
}

void Xml::only(const Element& e, const std::set<std::string>& attributes, const std::set<std::string>& children,
               const std::set<std::string>& passed_over, Text text) const {
  std::set<std::string> seen;
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string name = a->Name();
    if (attributes.count(name) == 0 && name.rfind("xmlns:", 0) != 0)
      refuse(e, "the attribute '" + name + "' is not known here");
    if (!seen.insert(name).second) refuse(e, "the attribute '" + name + "' is there twice");
  }
  for (const tinyxml2::XMLNode* node = e.FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (node->ToComment() != nullptr) continue;
    if (node->ToText() != nullptr && text == Text::passed_over) continue;
    const Element* const child = node->ToElement();
    if (child == nullptr) refuse(e, "there is text in it");
    if (children.count(child->Name()) == 0 && passed_over.count(child->Name()) == 0)
      refuse(*child, std::string("this element is not known in <") + e.Name() + ">");
  }
}

const Xml::Element* Xml::one(const Element& e, const char* name) const {
  const Element* const child = e.FirstChildElement(name);
  if (child != nullptr && child->NextSiblingElement(name) != nullptr)
    refuse(e, std::string("it has two elements <") + name + ">");
  return child;
}

std::string Xml::attribute(const Element& e, const char* name) const {
  const char* const value = e.Attribute(name);
  if (value == nullptr) refuse(e, std::string("the attribute '") + name + "' is missing");
  return value;
}

std::vector<double> Xml::numbers(const Element* e, const char* name, const char* otherwise, std::size_t count) const {
  const char* value = e == nullptr ? nullptr : e->Attribute(name);
  if (value == nullptr) value = otherwise;
  if (value == nullptr) {
    const std::string why = std::string("the attribute '") + name + "' is missing";
    if (e != nullptr) refuse(*e, why);
    throw BadInput(why);
  }
  std::vector<double> numbers;
  try {
    numbers = decimals(value);
  } catch (const BadInput& error) {
    refuse(*e, std::string("the attribute '") + name + "': " + error.what());
  }
  if (numbers.size() != count)
    refuse(*e, std::string("the attribute '") + name + "' has not " + std::to_string(count) + " numbers");
  return numbers;
}

}  // namespace verify
