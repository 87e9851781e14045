// SPDX-License-Identifier: BSD-3-Clause
// The format is described in numpy.lib.format: "\x93NUMPY", version, length of the header, header (a Python dictionary
// with descr, fortran_order and shape), numbers.
#include "plans/numpy.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "plans/refuse.h"
#include "plans/zip.h"

namespace fcl_artic::plans {
namespace {

/// An array as the file has it.
struct Array {
  std::string name;   ///< for messages
  std::string descr;  ///< as "<f8"
  bool fortran = false;
  std::vector<std::size_t> shape;
  std::string_view bytes;

  std::size_t size() const {
    std::size_t n = 1;
    for (const std::size_t s : shape) n *= s;
    return n;
  }
  std::size_t itemSize() const {
    std::size_t n = 0;
    for (const char c : descr.substr(2)) n = n * 10 + static_cast<std::size_t>(c - '0');
    return descr[1] == 'U' ? 4 * n : n;
  }
  bool isNumbers() const { return descr[1] == 'f' || descr[1] == 'i' || descr[1] == 'u'; }
  bool isText() const { return descr[1] == 'U' || descr[1] == 'S'; }
  std::string shapeText() const {
    std::string text;
    for (const std::size_t s : shape) text += (text.empty() ? "" : " x ") + std::to_string(s);
    return text.empty() ? "no dimension" : text;
  }
};

/// The text that stands after 'key': in the header.
std::string_view valueOf(std::string_view header, const std::string& key, const std::string& name) {
  const std::size_t at = header.find("'" + key + "':");
  if (at == std::string_view::npos) refuse(fmt::format("'{}': its header has no '{}'", name, key));
  header.remove_prefix(at + key.size() + 3);
  header.remove_prefix(std::min(header.find_first_not_of(' '), header.size()));
  return header;
}

Array parseOne(std::string_view content, const std::string& name) {
  const std::string_view magic("\x93NUMPY", 6);
  if (content.substr(0, 6) != magic || content.size() < 12) refuse(fmt::format("'{}' is no array of NumPy's", name));
  const int version = static_cast<unsigned char>(content[6]);
  if (version < 1 || version > 3) refuse(fmt::format("'{}' is of version {} of NumPy's format", name, version));
  const std::size_t count = version == 1 ? 2 : 4;
  std::size_t length = 0;
  for (std::size_t i = count; i-- > 0;) length = length << 8 | static_cast<unsigned char>(content[8 + i]);
  if (length > content.size() - 8 - count) refuse(fmt::format("'{}' is cut short", name));
  const std::string_view header = content.substr(8 + count, length);
  Array array;
  array.name = name;
  array.bytes = content.substr(8 + count + length);
  const std::string_view descr = valueOf(header, "descr", name);
  const std::size_t quote = descr.empty() || descr[0] != '\'' ? std::string_view::npos : descr.find('\'', 1);
  if (quote == std::string_view::npos) refuse(fmt::format("'{}' has fields, which are not read", name));
  array.descr = descr.substr(1, quote - 1);
  const std::string& d = array.descr;
  const bool digits =
      d.size() > 2 && d.size() < 8 && std::all_of(d.begin() + 2, d.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (digits && array.itemSize() == 0) refuse(fmt::format("'{}' is of type '{}', whose items have no size", name, d));
  if (!digits || std::string("<>|=").find(d[0]) == std::string::npos ||
      std::string("fiuUS").find(d[1]) == std::string::npos) {
    refuse(fmt::format("'{}' is of type '{}': real numbers are read, and texts for names", name, d));
  }
  const std::string_view order = valueOf(header, "fortran_order", name);
  array.fortran = order.substr(0, 4) == "True";
  if (!array.fortran && order.substr(0, 5) != "False") {
    refuse(fmt::format("'{}': the fortran_order of its header is neither True nor False", name));
  }
  std::string_view shape = valueOf(header, "shape", name);
  if (shape.empty() || shape[0] != '(') refuse(fmt::format("'{}': its header has no shape", name));
  shape = shape.substr(1, std::min(shape.find(')'), shape.size()) - 1);
  constexpr std::size_t kMax = std::size_t{1} << 40;  // so that no product overflows
  std::size_t total = 1;
  for (std::size_t i = 0; i < shape.size();) {
    if (shape[i] < '0' || shape[i] > '9') {
      if (std::string_view(", L").find(shape[i]) == std::string_view::npos)  // L: of Python 2
        refuse(fmt::format("'{}': its header has a shape of other than whole numbers", name));
      ++i;
      continue;
    }
    std::size_t n = 0;
    for (; i < shape.size() && shape[i] >= '0' && shape[i] <= '9'; ++i) {
      n = n * 10 + static_cast<std::size_t>(shape[i] - '0');
      if (n > kMax) refuse(fmt::format("'{}' claims {} rows and more", name, kMax));
    }
    array.shape.push_back(n);
    if (n > 0 && total > kMax / n) refuse(fmt::format("'{}' claims {} numbers and more", name, kMax));
    total *= n;
  }
  if (array.bytes.size() != array.size() * array.itemSize()) {
    refuse(fmt::format("'{}' has {} bytes of data, its header says {}", name, array.bytes.size(),
                       array.size() * array.itemSize()));
  }
  return array;
}

/// Item by its position in the file.
template <class T>
double itemAs(const Array& array, std::size_t i) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, array.bytes.data() + i * sizeof(T), sizeof(T));
  if (array.descr[0] == '>') std::reverse(bytes, bytes + sizeof(T));
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double item(const Array& array, std::size_t i) {
  const std::string type = array.descr.substr(1);
  if (type == "f8") return itemAs<double>(array, i);
  if (type == "f4") return itemAs<float>(array, i);
  if (type == "i8") return itemAs<std::int64_t>(array, i);
  if (type == "i4") return itemAs<std::int32_t>(array, i);
  if (type == "i2") return itemAs<std::int16_t>(array, i);
  if (type == "i1") return itemAs<std::int8_t>(array, i);
  if (type == "u8") return itemAs<std::uint64_t>(array, i);
  if (type == "u4") return itemAs<std::uint32_t>(array, i);
  if (type == "u2") return itemAs<std::uint16_t>(array, i);
  if (type == "u1") return itemAs<std::uint8_t>(array, i);
  refuse(fmt::format("'{}' is of type '{}', which is not read", array.name, array.descr));
}

/// Item by its indices.
double at(const Array& array, std::initializer_list<std::size_t> indices) {
  std::size_t flat = 0;
  std::vector<std::size_t> index(indices);
  if (array.fortran) {
    for (std::size_t i = index.size(); i-- > 0;) flat = flat * array.shape[i] + index[i];
  } else {
    for (std::size_t i = 0; i < index.size(); ++i) flat = flat * array.shape[i] + index[i];
  }
  return item(array, flat);
}

std::vector<std::string> textsOf(const Array& array) {
  if (!array.isText() || array.shape.size() != 1) {
    refuse(fmt::format("'{}' is no list of names, but {} of type '{}'", array.name, array.shapeText(), array.descr));
  }
  const bool wide = array.descr[1] == 'U', big = array.descr[0] == '>';
  const std::size_t step = array.itemSize(), width = wide ? 4 : 1;
  std::vector<std::string> out;
  for (std::size_t i = 0; i < array.shape[0]; ++i) {
    std::string& text = out.emplace_back();
    for (std::size_t k = 0; k < step; k += width) {
      unsigned long code = 0;
      for (std::size_t b = 0; b < width; ++b) {
        const std::size_t place = big ? b : width - 1 - b;
        code = code << 8 | static_cast<unsigned char>(array.bytes[i * step + k + place]);
      }
      if (code == 0) break;
      if (code > 127) refuse(fmt::format("'{}': a name with letters beyond ASCII", array.name));
      text += static_cast<char>(code);
    }
  }
  return out;
}

void requireNumbers(const Array& array) {
  if (!array.isNumbers()) refuse(fmt::format("'{}' is of type '{}', which is no number", array.name, array.descr));
}

/// Rows of plan p: of [waypoints, joints], or of [plans, waypoints, joints].
Plan::Rows rowsOf(const Array& array, std::size_t p, std::size_t waypoints) {
  const bool many = array.shape.size() == 3;
  const std::size_t joints = array.shape.back();
  Plan::Rows rows(waypoints, std::vector<double>(joints));
  for (std::size_t k = 0; k < waypoints; ++k) {
    for (std::size_t j = 0; j < joints; ++j) rows[k][j] = many ? at(array, {p, k, j}) : at(array, {k, j});
  }
  return rows;
}

/// The arrays that together are plans.
struct Arrays {
  const Array *positions = nullptr, *times = nullptr, *velocities = nullptr, *accelerations = nullptr;
  const Array *names = nullptr, *lengths = nullptr;
};

std::vector<Plan> plansOf(const Arrays& arrays) {
  const Array& positions = *arrays.positions;
  requireNumbers(positions);
  const std::size_t dimensions = positions.shape.size();
  if (dimensions != 2 && dimensions != 3) {
    refuse(fmt::format("'{}' is {}: waypoints by joints are wanted, or plans by waypoints by joints", positions.name,
                       positions.shapeText()));
  }
  const bool many = dimensions == 3;
  const std::size_t plans = many ? positions.shape[0] : 1, waypoints = positions.shape[dimensions - 2];
  if (positions.size() == 0) refuse(fmt::format("'{}' is {}: it is empty", positions.name, positions.shapeText()));
  for (const Array* rates : {arrays.velocities, arrays.accelerations}) {
    if (!rates) continue;
    requireNumbers(*rates);
    if (rates->shape != positions.shape) {
      refuse(fmt::format("'{}' is {}, '{}' is {}", rates->name, rates->shapeText(), positions.name,
                         positions.shapeText()));
    }
  }
  if (const Array* times = arrays.times) {
    requireNumbers(*times);
    const bool own = times->shape.size() == 2;
    const bool fits = own ? many && times->shape[0] == plans && times->shape[1] == waypoints
                          : times->shape.size() == 1 && times->shape[0] == waypoints;
    if (!fits) {
      refuse(fmt::format("'{}' is {}, '{}' is {}", times->name, times->shapeText(), positions.name,
                         positions.shapeText()));
    }
  }
  if (const Array* lengths = arrays.lengths) {
    requireNumbers(*lengths);
    if (!many || lengths->shape.size() != 1 || lengths->shape[0] != plans) {
      refuse(fmt::format("'{}' is {}, '{}' is {}", lengths->name, lengths->shapeText(), positions.name,
                         positions.shapeText()));
    }
  }
  const std::vector<std::string> joints = arrays.names ? textsOf(*arrays.names) : std::vector<std::string>();
  std::vector<Plan> out;
  for (std::size_t p = 0; p < plans; ++p) {
    Plan& plan = out.emplace_back();
    if (many) plan.name = fmt::format("{}[{}]", positions.name, p);
    plan.joints = joints;
    std::size_t length = waypoints;
    if (arrays.lengths) {
      const double wanted = at(*arrays.lengths, {p});
      if (!(wanted >= 0 && wanted <= static_cast<double>(waypoints)) || wanted != std::floor(wanted)) {
        plan.error = fmt::format("its length {} is no whole number from 0 to {}", wanted, waypoints);
        continue;
      }
      length = static_cast<std::size_t>(wanted);
    }
    plan.positions = rowsOf(positions, p, length);
    if (arrays.velocities) plan.velocities = rowsOf(*arrays.velocities, p, length);
    if (arrays.accelerations) plan.accelerations = rowsOf(*arrays.accelerations, p, length);
    for (std::size_t k = 0; arrays.times && k < length; ++k) {
      plan.times.push_back(arrays.times->shape.size() == 2 ? at(*arrays.times, {p, k}) : at(*arrays.times, {k}));
    }
  }
  return out;
}

}  // namespace

std::vector<Plan> parseArray(std::string_view content) {
  const Array array = parseOne(content, "array");
  Arrays arrays;
  arrays.positions = &array;
  return plansOf(arrays);
}

std::vector<Plan> parseArchive(std::string_view content) {
  const std::vector<ZipEntry> entries = unzip(content);
  std::vector<Array> all;
  for (const ZipEntry& entry : entries) {
    const bool npy = entry.name.size() > 4 && entry.name.compare(entry.name.size() - 4, 4, ".npy") == 0;
    all.push_back(parseOne(entry.content, npy ? entry.name.substr(0, entry.name.size() - 4) : entry.name));
  }
  const auto find = [&](std::initializer_list<const char*> names) -> const Array* {
    const Array* found = nullptr;
    for (const Array& array : all) {
      if (std::none_of(names.begin(), names.end(), [&](const char* name) { return array.name == name; })) continue;
      if (found) refuse(fmt::format("'{}' and '{}' are the same", found->name, array.name));
      found = &array;
    }
    return found;
  };
  Arrays arrays;
  arrays.positions = find({"positions", "waypoints", "q"});
  arrays.times = find({"times", "time", "t"});
  arrays.velocities = find({"velocities", "velocity", "qd"});
  arrays.accelerations = find({"accelerations", "acceleration", "qdd"});
  arrays.names = find({"joint_names", "joints"});
  arrays.lengths = find({"lengths"});
  const auto used = [&](const Array* array) {
    return array == arrays.positions || array == arrays.times || array == arrays.velocities ||
           array == arrays.accelerations || array == arrays.names || array == arrays.lengths;
  };
  if (arrays.positions) {
    std::vector<Plan> out = plansOf(arrays);
    for (const Array& array : all) {
      if (!used(&array)) out.front().notes.push_back(fmt::format("the array '{}' is not used", array.name));
    }
    return out;
  }
  for (const Array* rates : {arrays.times, arrays.velocities, arrays.accelerations, arrays.lengths}) {
    if (rates) refuse(fmt::format("the archive has '{}', but no 'positions'", rates->name));
  }
  std::vector<Plan> out;
  for (const Array& array : all) {
    if (&array == arrays.names) continue;
    Arrays one;
    one.positions = &array;
    one.names = arrays.names;
    std::vector<Plan> plans;
    try {
      plans = plansOf(one);
      if (plans.size() == 1) plans[0].name = array.name;
    } catch (const std::invalid_argument& error) {
      plans.resize(1);
      plans[0].name = array.name;
      plans[0].error = error.what();
    }
    out.insert(out.end(), std::make_move_iterator(plans.begin()), std::make_move_iterator(plans.end()));
  }
  if (out.empty()) refuse("the archive has no plan");
  return out;
}

}  // namespace fcl_artic::plans
