#include "poecal/capture/row_order.hpp"

#include <algorithm>

namespace poecal {

RowOrder standInByRowOrder(std::vector<Sample>& samples) {
  const auto none = [&samples](auto has) { return !samples.empty() && std::none_of(samples.begin(), samples.end(), has); };
  RowOrder order;
  order.stamp = none([](const Sample& sample) { return sample.stamp.has_value(); });
  order.dir = none([](const Sample& sample) { return sample.dir.size() > 0; }) && samples.front().q.size() > 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (order.stamp) samples[i].stamp = static_cast<double>(i);
    if (!order.dir) continue;
    Eigen::VectorXd& dir = samples[i].dir;
    dir = i > 0 ? samples[i - 1].dir : Eigen::VectorXd::Ones(samples[i].q.size()).eval();
    for (Eigen::Index k = 0; i > 0 && k < dir.size(); ++k) {
      const double moved = samples[i].q(k) - samples[i - 1].q(k);
      if (moved != 0.0) dir(k) = moved > 0.0 ? 1.0 : -1.0;
    }
  }
  return order;
}

}  // namespace poecal
