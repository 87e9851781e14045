// SPDX-License-Identifier: BSD-3-Clause
#include "array.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fcl_artic::python {
namespace {

std::string shapeOf(const py::array& array) {
  return py::str(array.attr("shape"));
}

bool isAligned(const py::array& array) {
  return (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
}

/// NumPy's array of a value, of any type of number.
/// @param kinds  letters of NumPy's `dtype.kind` that are taken.
py::array numbers(py::handle value, const char* what, const char* kinds) {
  const py::module_ numpy = py::module_::import("numpy");
  if (py::isinstance(value, numpy.attr("ma").attr("MaskedArray"))) {
    typeError(std::string(what) + " is a masked array; fill its masked entries first");
  }
  py::array array;
  try {
    array = numpy.attr("asarray")(value);
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError)) throw;
    valueError(std::string(what) + " is no array of numbers: " + std::string(py::str(error.value())));
  }
  const bool empty = array.size() == 0;
  if (!empty && !std::strchr(kinds, array.dtype().kind())) {
    typeError(std::string(what) + " holds no " + (std::strchr(kinds, 'f') ? "real numbers" : "integers") + " but " +
              (array.ndim() == 0 ? typeName(value) : std::string(py::str(array.dtype()))));
  }
  return array;
}

}  // namespace

Doubles doubles(py::handle value, const char* what) {
  if (py::isinstance<Doubles>(value) && Py_TYPE(value.ptr()) == py::detail::npy_api::get().PyArray_Type_) {
    auto array = py::reinterpret_borrow<Doubles>(value);
    if (isAligned(array)) return array;
  }
  const py::array array = numbers(value, what, "fiu");
  // If an array has another type, order or alignment, NumPy makes a copy that has these.
  return py::module_::import("numpy").attr("require")(array, py::dtype::of<double>(), py::make_tuple("C", "A"));
}

double numberOf(py::handle value, const char* what) {
  if (PyFloat_CheckExact(value.ptr())) return PyFloat_AS_DOUBLE(value.ptr());
  const Doubles array = doubles(value, what);
  if (array.ndim() != 0) typeError(std::string(what) + " is no number but an array of shape " + shapeOf(array));
  return *array.data();
}

Eigen::VectorXd vectorOf(py::handle value, const char* what) {
  const Doubles array = doubles(value, what);
  if (array.ndim() != 1) valueError(std::string(what) + " has shape " + shapeOf(array) + ", not (n,)");
  return Eigen::Map<const Eigen::VectorXd>(array.data(), array.shape(0));
}

Eigen::Vector3d vector3Of(py::handle value, const char* what) {
  const Eigen::VectorXd vector = vectorOf(value, what);
  if (vector.size() != 3) valueError(std::string(what) + " has " + std::to_string(vector.size()) + " entries, not 3");
  if (!vector.allFinite()) valueError(std::string(what) + " has an entry that is not finite");
  return vector;
}

Matrix matrixOf(py::handle value, const char* what, py::ssize_t columns) {
  Matrix matrix{doubles(value, what)};
  if (matrix.array.ndim() != 2 || (columns >= 0 && matrix.array.shape(1) != columns)) {
    valueError(std::string(what) + " has shape " + shapeOf(matrix.array) + ", not (N, " +
               (columns < 0 ? "n" : std::to_string(columns)) + ")");
  }
  return matrix;
}

std::vector<Eigen::VectorXd> vectorsOf(py::handle value, const char* what) {
  const Matrix matrix = matrixOf(value, what);
  const Rows rows = matrix.rows();
  std::vector<Eigen::VectorXd> vectors;
  vectors.reserve(static_cast<std::size_t>(rows.rows()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) vectors.emplace_back(rows.row(i).transpose());
  return vectors;
}

Eigen::Isometry3d poseOf(py::handle value, const char* what) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (value.is_none()) return pose;
  const Doubles array = doubles(value, what);
  if (array.ndim() == 1 && array.shape(0) == 3) {
    pose.translation() = Eigen::Map<const Eigen::Vector3d>(array.data());
    return pose;
  }
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
    valueError(std::string(what) + " has shape " + shapeOf(array) + ", not (4, 4); a position alone has shape (3,)");
  }
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(array.data());
  if (pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    valueError(std::string(what) + " is no pose: its last row is not 0 0 0 1");
  }
  return pose;
}

std::vector<Eigen::Matrix<std::size_t, 3, 1>> facesOf(py::handle value, std::size_t vertices) {
  const py::array array = numbers(value, "faces", "iu");
  if (array.ndim() != 2 || array.shape(1) != 3) {
    valueError("faces has shape " + shapeOf(array) + ", not (F, 3): triangles are taken, no other polygons");
  }
  const py::array_t<std::int64_t, py::array::c_style> indices =
      py::module_::import("numpy").attr("require")(array, py::dtype::of<std::int64_t>(), py::make_tuple("C", "A"));
  std::vector<Eigen::Matrix<std::size_t, 3, 1>> faces(static_cast<std::size_t>(indices.shape(0)));
  const std::int64_t* next = indices.data();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t& corner : faces[f]) {
      if (*next < 0 || static_cast<std::size_t>(*next) >= vertices) {
        valueError("faces[" + std::to_string(f) + "] names vertex " + std::to_string(*next) + " of " +
                   std::to_string(vertices));
      }
      corner = static_cast<std::size_t>(*next++);
    }
  }
  return faces;
}

Doubles arrayOf(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  Doubles array(vector.size());
  std::copy_n(vector.data(), vector.size(), array.mutable_data());
  return array;
}

Doubles array3(const Eigen::Vector3d& vector) {
  return arrayOf(Eigen::VectorXd(vector));
}

Doubles arrayOfRows(const RowMajor& matrix) {
  Doubles array({matrix.rows(), matrix.cols()});
  std::copy_n(matrix.data(), matrix.size(), array.mutable_data());
  return array;
}

Doubles arrayOf(const Eigen::Isometry3d& pose) {
  return arrayOfRows(RowMajor(pose.matrix()));
}

Doubles arrayOf(const std::vector<Eigen::Isometry3d>& poses) {
  Doubles array({static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  double* out = array.mutable_data();
  for (const Eigen::Isometry3d& pose : poses) {
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(out);
    matrix = pose.matrix();
    out += 16;
  }
  return array;
}

}  // namespace fcl_artic::python
