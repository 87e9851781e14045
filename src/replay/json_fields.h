// SPDX-License-Identifier: BSD-3-Clause
//
// Records as JSON, to and fro. A record lists its fields once, in a function fields(archive, record); FieldWriter and
// FieldReader are the archives. Nothing is passed over: a field that is missing, of another kind or not known is
// refused with the way to it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "query/request_options.h"
#include "text/document.h"
#include "text/nearest_name.h"

namespace fcl_artic::replay {

using text::Json;

/// @param at  way to the value, as "robot.joints[2].axis"
[[noreturn]] inline void refuse(const std::string& at, const std::string& reason) {
  throw std::invalid_argument("query: " + (at.empty() ? std::string("it") : at) + " " + reason);
}

class FieldReader;

inline void read(const Json& json, const std::string& at, bool& value) {
  if (!json.is_boolean()) refuse(at, "is neither true nor false");
  value = json.get<bool>();
}
inline void read(const Json& json, const std::string& at, std::string& value) {
  if (!json.is_string()) refuse(at, "is no text");
  value = json.get<std::string>();
}
/// Numbers that JSON lacks are texts.
inline void read(const Json& json, const std::string& at, double& value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (json.is_number()) {
    value = json.get<double>();
    return;
  }
  const std::string word = json.is_string() ? json.get<std::string>() : "";
  if (word != "inf" && word != "-inf" && word != "nan") refuse(at, "is no number");
  value = word == "inf" ? kInfinity : word == "-inf" ? -kInfinity : std::numeric_limits<double>::quiet_NaN();
}
inline Json written(double value) {
  if (std::isfinite(value)) return value;  // in the fewest digits that are read as the same
  return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
}
template <class T, std::enable_if_t<std::is_integral_v<T> && !std::is_same_v<T, bool>, int> = 0>
void read(const Json& json, const std::string& at, T& value) {
  const bool good =
      std::is_unsigned_v<T> || !json.is_number_integer() || json.is_number_unsigned()
          ? json.is_number_unsigned() && json.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<T>::max()}
          : json.get<std::int64_t>() >= std::int64_t{std::numeric_limits<T>::min()};
  if (!good) refuse(at, "is no whole number of this range");
  value = json.get<T>();
}
template <class T, std::enable_if_t<std::is_same_v<T, bool> || std::is_integral_v<T>, int> = 0>
Json written(T value) {
  return value;
}
inline Json written(const std::string& value) {
  return value;
}

template <class E, std::enable_if_t<std::is_enum_v<E>, int> = 0>
void read(const Json& json, const std::string& at, E& value) {
  std::string name, all;
  read(json, at, name);
  for (const auto& known : namesOf(E())) {
    if (name == known.name) {
      value = known.value;
      return;
    }
    all += std::string(all.empty() ? "" : ", ") + known.name;
  }
  refuse(at, "is '" + name + "', which is none of " + all);
}
template <class E, std::enable_if_t<std::is_enum_v<E>, int> = 0>
Json written(E value) {
  return nameOf(value);
}

inline const Json& list(const Json& json, const std::string& at) {
  if (!json.is_array()) refuse(at, "is no list");
  return json;
}
inline void requireLength(const Json& json, const std::string& at, std::size_t length) {
  if (list(json, at).size() == length) return;
  refuse(at, "has " + std::to_string(json.size()) + " entries, not " + std::to_string(length));
}
inline std::string entry(const std::string& at, std::size_t i) {
  return at + "[" + std::to_string(i) + "]";
}

inline void read(const Json& json, const std::string& at, Eigen::Vector3d& value) {
  requireLength(json, at, 3);
  for (std::size_t i = 0; i < 3; ++i) read(json[i], entry(at, i), value[static_cast<int>(i)]);
}
inline Json written(const Eigen::Vector3d& v) {
  return Json::array({written(v[0]), written(v[1]), written(v[2])});
}
/// Rows of rotation and translation, one after the other.
inline void read(const Json& json, const std::string& at, Eigen::Isometry3d& value) {
  requireLength(json, at, 12);
  value = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < 12; ++i) {
    read(json[i], entry(at, i), value(static_cast<int>(i / 4), static_cast<int>(i % 4)));
  }
}
inline Json written(const Eigen::Isometry3d& M) {
  Json out = Json::array();
  for (int i = 0; i < 12; ++i) out.push_back(written(M(i / 4, i % 4)));
  return out;
}
/// Rows of one length.
inline void read(const Json& json, const std::string& at, Eigen::MatrixXd& value) {
  const std::size_t rows = list(json, at).size(), columns = rows == 0 ? 0 : list(json[0], entry(at, 0)).size();
  value.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  for (std::size_t i = 0; i < rows; ++i) {
    requireLength(json[i], entry(at, i), columns);
    for (std::size_t k = 0; k < columns; ++k) {
      read(json[i][k], entry(entry(at, i), k), value(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)));
    }
  }
}
inline Json written(const Eigen::MatrixXd& matrix) {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) row.push_back(written(matrix(i, k)));
    out.push_back(std::move(row));
  }
  return out;
}

// Records have lists and lists have records: these are declared before either is used.
template <class Record, std::enable_if_t<std::is_class_v<Record>, int> = 0>
void read(const Json& json, const std::string& at, Record& record);
template <class Record, std::enable_if_t<std::is_class_v<Record>, int> = 0>
Json written(const Record& record);
template <class T, std::size_t N>
void read(const Json& json, const std::string& at, std::array<T, N>& value) {
  requireLength(json, at, N);
  for (std::size_t i = 0; i < N; ++i) read(json[i], entry(at, i), value[i]);
}
template <class T, std::size_t N>
Json written(const std::array<T, N>& value) {
  Json out = Json::array();
  for (const T& one : value) out.push_back(written(one));
  return out;
}
template <class T>
void read(const Json& json, const std::string& at, std::vector<T>& value) {
  value.resize(list(json, at).size());
  for (std::size_t i = 0; i < value.size(); ++i) read(json[i], entry(at, i), value[i]);
}
template <class T>
Json written(const std::vector<T>& value) {
  Json out = Json::array();
  for (const T& one : value) out.push_back(written(one));
  return out;
}

class FieldWriter {
 public:
  template <class T>
  void operator()(const char* name, const T& value) {
    out.push_back({name, written(value)});
  }
  /// A field that is left out where it has this value.
  template <class T>
  void unless(const T& usual, const char* name, const T& value) {
    if (!same(value, usual)) (*this)(name, value);
  }

  Json out = Json::object();

 private:
  template <class T>
  static bool same(const T& a, const T& b) {
    return a == b;
  }
  static bool same(double a, double b) { return a == b && std::signbit(a) == std::signbit(b); }
};

class FieldReader {
 public:
  FieldReader(const Json& json, std::string at) : json_(json), at_(std::move(at)) {
    if (!json.is_object()) refuse(at_, "is no object of names and values");
  }
  template <class T>
  void operator()(const char* name, T& value) {
    known_.emplace_back(name);
    const auto found = json_.find(name);
    if (found == json_.end()) refuse(at_, "lacks '" + std::string(name) + "'");
    read(*found, wayTo(name), value);
  }
  template <class T>
  void unless(const T& usual, const char* name, T& value) {
    if (json_.contains(name)) return (*this)(name, value);
    known_.emplace_back(name);
    value = usual;
  }
  /// To be called when all fields were read.
  void requireNoOther() const {
    for (const auto& [name, value] : json_.items()) {
      bool known = false;
      for (const std::string& one : known_) known = known || one == name;
      if (!known) refuse(wayTo(name), "is not known" + text::didYouMean(name, known_));
    }
  }

 private:
  std::string wayTo(const std::string& name) const { return at_.empty() ? name : at_ + "." + name; }

  const Json& json_;
  const std::string at_;
  std::vector<std::string> known_;
};

template <class Record, std::enable_if_t<std::is_class_v<Record>, int>>
void read(const Json& json, const std::string& at, Record& record) {
  FieldReader reader(json, at);
  fields(reader, record);
  reader.requireNoOther();
}
template <class Record, std::enable_if_t<std::is_class_v<Record>, int>>
Json written(const Record& record) {
  FieldWriter writer;
  fields(writer, const_cast<Record&>(record));  // which a writer leaves as it is
  return std::move(writer.out);
}

}  // namespace fcl_artic::replay
