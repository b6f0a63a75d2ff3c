// NumPy arrays and Glint's types. The Python side has checked dtype, shape and contiguity (glint/_arrays.py).
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "core/check.h"
#include "geometry/rigid.h"
#include "geometry/triangle_mesh.h"

namespace glint::python {

namespace py = pybind11;

template <class T>
using Array = py::array_t<T, py::array::c_style>;

// Rows of an (n, D) array as packed vectors, and back.
template <class Vector>
std::vector<Vector> RowsOf(const Array<typename Vector::Scalar>& array) {
  static_assert(sizeof(Vector) == Vector::SizeAtCompileTime * sizeof(typename Vector::Scalar));
  GLINT_CHECK_EQ(array.ndim(), 2);
  GLINT_CHECK_EQ(array.shape(1), Vector::SizeAtCompileTime);
  std::vector<Vector> rows(array.shape(0));
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), array.data(), rows.size() * sizeof(Vector));
  return rows;
}

template <class Vector>
Array<typename Vector::Scalar> ArrayOf(const std::vector<Vector>& rows) {
  static_assert(sizeof(Vector) == Vector::SizeAtCompileTime * sizeof(typename Vector::Scalar));
  Array<typename Vector::Scalar> array({rows.size(), static_cast<size_t>(Vector::SizeAtCompileTime)});
  if (!rows.empty()) std::memcpy(array.mutable_data(), rows.data(), rows.size() * sizeof(Vector));
  return array;
}

template <class T>
Array<T> ArrayOfScalars(const std::vector<T>& values) {
  return Array<T>(values.size(), values.data());
}

// An (n, D) array of get(item) for every item.
template <int D, class T, class Items, class Get>
Array<T> ArrayOfRows(const Items& items, const Get& get) {
  Array<T> array({items.size(), static_cast<size_t>(D)});
  T* out = array.mutable_data();
  for (const auto& item : items) {
    const auto row = get(item);
    for (int k = 0; k < D; ++k) *out++ = static_cast<T>(row[k]);
  }
  return array;
}

template <class T, class Items, class Get>
Array<T> ArrayOfEach(const Items& items, const Get& get) {
  Array<T> array(static_cast<py::ssize_t>(items.size()));
  T* out = array.mutable_data();
  for (const auto& item : items) *out++ = static_cast<T>(get(item));
  return array;
}

// A matrix in NumPy's order of rows.
template <class Matrix>
Array<double> ArrayOfMatrix(const Matrix& matrix) {
  Array<double> array({matrix.rows(), matrix.cols()});
  for (Eigen::Index r = 0; r < matrix.rows(); ++r)
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) array.mutable_at(r, c) = matrix(r, c);
  return array;
}

// mesh.cc: the fields of glint.Mesh by name, and back.
py::dict DictOf(const TriangleMesh& mesh);
TriangleMesh MeshOf(const py::dict& fields);

// project.cc: [R | t], 3 x 4.
Array<double> ArrayOfRigid(const Rigid3d& rigid);

}  // namespace glint::python
