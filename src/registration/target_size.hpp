// The size of the target as the registration sees it.
#pragma once

#include <optional>

#include "registration/problem.hpp"

namespace poecal {

struct TargetSize {
  double factor = 1.0;     ///< of the stated size
  double deviation = 0.0;  ///< 1 sigma; each picture counts as the six numbers of its pose
  double rms = 0.0;        ///< sqrt(sum |r|^2 / N) over the corners of the samples that agree, at that size [px]
  double rms_as_stated = 0.0;
  Registration registration;  ///< at that size
};

/// Least squares over registration and size, from a registration that is near. Pictures that do not agree with it are left out.
/// @return nothing where it does not converge, or there are too few pictures for 13 unknowns.
std::optional<TargetSize> fitTargetSize(const Problem& problem, const Registration& start);

}  // namespace poecal
