// SPDX-License-Identifier: BSD-3-Clause
//
// NumPy arrays to and from Eigen. A C-contiguous array of float64 is read where it lies; other values that hold numbers
// are converted first. Values that hold none (text, None, truth values, complex numbers, masked entries) are refused:
// nothing is converted in silence into other numbers.
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "errors.h"

namespace fcl_artic::python {

using Doubles = py::array_t<double, py::array::c_style>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = Eigen::Map<const RowMajor>;

/// The value as a C-contiguous, aligned array of float64: itself, if it is one, else a converted copy.
/// @param what  names the value in errors.
/// @throws py::type_error for what holds no real numbers.
Doubles doubles(py::handle value, const char* what);

/// A matrix of an array's numbers, read in place; keeps the array, which may be a converted copy, alive.
struct Matrix {
  Doubles array;
  Rows rows() const& { return {array.data(), array.shape(0), array.shape(1)}; }
  Rows rows() const&& = delete;  // of numbers that are gone
};

/// The number that a value is. @throws py::type_error naming `what`.
double numberOf(py::handle value, const char* what);
/// @throws py::type_error, py::value_error naming `what`: not one-dimensional. The numbers are copied.
Eigen::VectorXd vectorOf(py::handle value, const char* what);
/// @throws py::type_error, py::value_error naming `what`: not three finite numbers.
Eigen::Vector3d vector3Of(py::handle value, const char* what);
/// @param columns  that it must have; -1: any number.
/// @throws py::type_error, py::value_error naming `what`: not two-dimensional, or of another width.
Matrix matrixOf(py::handle value, const char* what, py::ssize_t columns = -1);
/// @throws as matrixOf().
std::vector<Eigen::VectorXd> vectorsOf(py::handle value, const char* what);
/// A pose: a 4x4 matrix or a position of three numbers; None is the identity. Whether the rotation is one is for the
/// library to say.
/// @throws py::type_error, py::value_error naming `what`: another shape, another last row than 0 0 0 1.
Eigen::Isometry3d poseOf(py::handle value, const char* what);
/// Triangles: (F, 3) integers from 0 to below `vertices`.
/// @throws py::type_error, py::value_error naming the face.
std::vector<Eigen::Matrix<std::size_t, 3, 1>> facesOf(py::handle value, std::size_t vertices);

Doubles arrayOf(const Eigen::Ref<const Eigen::VectorXd>& vector);
Doubles array3(const Eigen::Vector3d& vector);
Doubles arrayOfRows(const RowMajor& matrix);
/// 4x4.
Doubles arrayOf(const Eigen::Isometry3d& pose);
/// (n, 4, 4).
Doubles arrayOf(const std::vector<Eigen::Isometry3d>& poses);

}  // namespace fcl_artic::python
