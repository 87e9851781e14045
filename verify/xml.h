// SPDX-License-Identifier: BSD-3-Clause
// XML read by a whitelist: an element or attribute that is not named is refused, so that nothing that moves, places or
// shapes anything is passed over.
#pragma once

#include <tinyxml2.h>

#include <set>
#include <string>
#include <vector>

#include "fixed.h"

namespace verify {

/// Numbers of a text, separated by blanks: each a decimal one, in whole, as the nearest double. @throws BadInput
std::vector<double> decimals(const std::string& text);
/// One word of a text as such a number. @throws BadInput
double decimal(const std::string& word);

/// The name that a package.xml gives; empty where there is none that can be read.
std::string packageName(const std::string& path);

class Xml {
 public:
  using Element = tinyxml2::XMLElement;

  /// @throws BadInput: unreadable, no <robot>, a document type (which may define what names and numbers stand for).
  explicit Xml(const std::string& path);
  const Element& robot() const { return *robot_; }

  /// Refuses an attribute that is not listed, or that is there twice, and a child that is neither in `children` nor in
  /// `passed_over`; also text, unless that is passed over.
  enum class Text { refused, passed_over };
  void only(const Element& e, const std::set<std::string>& attributes, const std::set<std::string>& children = {},
            const std::set<std::string>& passed_over = {}, Text text = Text::refused) const;
  /// The one child of that name, or null; two are refused.
  const Element* one(const Element& e, const char* name) const;
  std::string attribute(const Element& e, const char* name) const;
  std::vector<double> numbers(const Element* e, const char* name, const char* otherwise, std::size_t count) const;
  [[noreturn]] void refuse(const Element& e, const std::string& why) const;

 private:
  std::string path_;
  tinyxml2::XMLDocument document_;
  const Element* robot_ = nullptr;
};

}  // namespace verify
