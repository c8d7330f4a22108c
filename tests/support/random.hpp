// Random numbers of a test: seeded by the running test's name, so the same alone, shuffled or in parallel.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "poecal/core/random.hpp"
#include "poecal/geometry/se3.hpp"

namespace poecal::test {

/// FNV-1a of "Suite.Case".
inline Rng rngOfThisTest(std::uint64_t stream = 0) {
  const ::testing::TestInfo* info = ::testing::UnitTest::GetInstance()->current_test_info();
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : std::string(info->test_suite_name()) + "." + info->name()) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  }
  return Rng(hash, stream);
}

/// Entries uniform in +-limit.
inline Eigen::VectorXd uniformVector(Rng& rng, int size, double limit) {
  Eigen::VectorXd v(size);
  for (int k = 0; k < size; ++k) v(k) = rng.uniform(-limit, limit);
  return v;
}

/// Independent standard normal entries.
inline Eigen::VectorXd normalVector(Rng& rng, int size) {
  Eigen::VectorXd v(size);
  for (int k = 0; k < size; ++k) v(k) = rng.normal();
  return v;
}

/// exp of a twist whose rotation and translation entries are uniform in +-angle and +-distance.
inline Eigen::Isometry3d randomPose(Rng& rng, double angle = 1.5, double distance = 1.0) {
  Vector6d xi;
  xi << uniformVector(rng, 3, angle), uniformVector(rng, 3, distance);
  return expSe3(xi);
}

}  // namespace poecal::test
