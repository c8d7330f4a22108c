// numpy arrays in and out: matrices, vectors and poses of Eigen, and lists of them, as arrays of doubles. What comes out is a copy. That of
// a member cannot be written to, since the member would not change.
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace poecal::python {

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Anything that numpy makes an array of numbers of; an empty object for others, as pybind11's casters want it.
inline Array arrayOf(py::handle source) { return source.is_none() ? py::reinterpret_steal<Array>(py::handle()) : Array::ensure(source); }

/// "(3, 4)". @param sizes  -1: any, "N", "n".
inline std::string shapeText(const std::vector<py::ssize_t>& sizes) {
  std::string text = "(";
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const std::string size = sizes[k] >= 0 ? std::to_string(sizes[k]) : k == 0 ? "N" : "n";
    text += (k == 0 ? "" : ", ") + size;
  }
  return text + (sizes.size() == 1 ? ",)" : ")");
}

/// @throws ValueError. @param expected  -1: any.
inline void requireShape(const Array& array, const std::vector<py::ssize_t>& expected) {
  const std::vector<py::ssize_t> got(array.shape(), array.shape() + array.ndim());
  const auto fits = [](py::ssize_t size, py::ssize_t wanted) { return wanted < 0 || size == wanted; };
  if (got.size() == expected.size() && std::equal(got.begin(), got.end(), expected.begin(), fits)) return;
  throw py::value_error("expected an array of shape " + shapeText(expected) + ", got " + shapeText(got));
}

/// An array about to leave.
inline py::handle released(Array array, py::return_value_policy policy) {
  if (policy == py::return_value_policy::reference_internal) array.attr("setflags")(py::arg("write") = false);
  return array.release();
}

/// Row by row.
using PoseMatrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

/// @throws ValueError: no rotation and translation.
inline Eigen::Isometry3d poseOf(const double* numbers) {
  constexpr double kRounded = 1e-6;  // poses of single precision are off by 1e-7
  const Eigen::Matrix4d T = Eigen::Map<const PoseMatrix>(numbers);
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const bool rotates = (R.transpose() * R).isIdentity(kRounded) && R.determinant() > 0.0;
  if (!T.allFinite() || !rotates || T.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    throw py::value_error("expected a pose: a rotation matrix, a translation and the last row 0 0 0 1");
  }
  return Eigen::Isometry3d(T);
}

}  // namespace poecal::python

namespace pybind11::detail {

template <typename Matrix>
struct type_caster<
    Matrix, enable_if_t<std::is_base_of_v<Eigen::PlainObjectBase<Matrix>, Matrix> && std::is_same_v<typename Matrix::Scalar, double>>> {
  static constexpr bool kVector = Matrix::IsVectorAtCompileTime != 0;
  PYBIND11_TYPE_CASTER(Matrix, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const auto array = poecal::python::arrayOf(source);
    if (!array) return false;
    if constexpr (kVector) {
      poecal::python::requireShape(array, {Matrix::SizeAtCompileTime});
      value = Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
    } else {
      poecal::python::requireShape(array, {Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime});
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      value = Eigen::Map<const RowMajor>(array.data(), array.shape(0), array.shape(1));
    }
    return true;
  }

  static handle cast(const Matrix& matrix, return_value_policy policy, handle) {
    std::vector<ssize_t> shape{matrix.rows(), matrix.cols()};
    if (kVector) shape = {matrix.size()};
    poecal::python::Array array(shape);
    double* out = array.mutable_data();
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      for (Eigen::Index j = 0; j < matrix.cols(); ++j) *out++ = matrix(i, j);
    }
    return poecal::python::released(std::move(array), policy);
  }
};

template <>
struct type_caster<Eigen::Isometry3d> {
  PYBIND11_TYPE_CASTER(Eigen::Isometry3d, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const auto array = poecal::python::arrayOf(source);
    if (!array) return false;
    poecal::python::requireShape(array, {4, 4});
    value = poecal::python::poseOf(array.data());
    return true;
  }

  static handle cast(const Eigen::Isometry3d& T, return_value_policy policy, handle parent) {
    return type_caster<Eigen::Matrix4d>::cast(T.matrix(), policy, parent);
  }
};

/// N x 4 x 4.
template <>
struct type_caster<std::vector<Eigen::Isometry3d>> {
  PYBIND11_TYPE_CASTER(std::vector<Eigen::Isometry3d>, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const auto array = poecal::python::arrayOf(source);
    if (!array) return false;
    poecal::python::requireShape(array, {-1, 4, 4});
    value.clear();
    for (ssize_t k = 0; k < array.shape(0); ++k) value.push_back(poecal::python::poseOf(array.data(k, 0, 0)));
    return true;
  }

  static handle cast(const std::vector<Eigen::Isometry3d>& poses, return_value_policy policy, handle) {
    poecal::python::Array array(std::vector<ssize_t>{static_cast<ssize_t>(poses.size()), 4, 4});
    for (std::size_t k = 0; k < poses.size(); ++k) {
      Eigen::Map<poecal::python::PoseMatrix> out(array.mutable_data() + 16 * k);
      out = poses[k].matrix();
    }
    return poecal::python::released(std::move(array), policy);
  }
};

/// N x m x 2, as pictures with m corners have them.
template <>
struct type_caster<std::vector<Eigen::MatrixX2d>> {
  PYBIND11_TYPE_CASTER(std::vector<Eigen::MatrixX2d>, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const auto array = poecal::python::arrayOf(source);
    if (!array) return false;
    poecal::python::requireShape(array, {-1, -1, 2});
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
    value.clear();
    for (ssize_t k = 0; k < array.shape(0); ++k) {
      value.emplace_back(Eigen::Map<const RowMajor>(array.data() + 2 * k * array.shape(1), array.shape(1), 2));
    }
    return true;
  }
};

template <>
struct type_caster<std::vector<double>> {
  PYBIND11_TYPE_CASTER(std::vector<double>, const_name("numpy.ndarray"));

  bool load(handle source, bool) {
    const auto array = poecal::python::arrayOf(source);
    if (!array) return false;
    poecal::python::requireShape(array, {-1});
    value.assign(array.data(), array.data() + array.size());
    return true;
  }

  static handle cast(const std::vector<double>& numbers, return_value_policy policy, handle) {
    return poecal::python::released(poecal::python::Array(static_cast<ssize_t>(numbers.size()), numbers.data()), policy);
  }
};

}  // namespace pybind11::detail

namespace poecal::python {

/// One pose of n readings, N x 4 x 4 of N x n.
template <typename PoseOfOne>
py::object posesOf(const Array& q, const PoseOfOne& pose) {
  if (q.ndim() == 1) return py::cast(pose(q.cast<Eigen::VectorXd>()));
  const auto rows = q.cast<Eigen::MatrixXd>();
  std::vector<Eigen::Isometry3d> poses;
  for (Eigen::Index k = 0; k < rows.rows(); ++k) poses.push_back(pose(rows.row(k).transpose()));
  return py::cast(poses);
}

}  // namespace poecal::python
