#include "withheld/drawing.hpp"

namespace withheld {

Wishes wishesFor(const std::vector<std::string>& effects, Wishes wishes) {
  for (const std::string& effect : effects) {
    const KindNeeds needs = needsOf(effect);
    wishes.stamp = wishes.stamp || needs.stamp;
    wishes.dir = wishes.dir || needs.dir;
    wishes.dq = wishes.dq || needs.dq;
    wishes.several_tags = wishes.several_tags || needs.several_tags;
  }
  return wishes;
}

bool separable(const Leftover& leftover, const std::vector<Hidden>& effects) {
  constexpr double kLeast = 6.0;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    Eigen::MatrixXd others;
    for (std::size_t j = 0; j < effects.size(); ++j) {
      if (j == i) continue;
      const Eigen::MatrixXd more = leftover.columns(effects[j].flaw);
      others.conservativeResize(more.rows(), others.cols() + more.cols());
      others.rightCols(more.cols()) = more;
    }
    if (!(Leftover::besides(leftover.left({effects[i].flaw}), others).norm() > kLeast)) return false;
  }
  return true;
}

}  // namespace withheld
