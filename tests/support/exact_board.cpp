#include "support/exact_board.hpp"

#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <opencv2/aruco.hpp>

#include "support/exact_shapes.hpp"

namespace poecal::test {
namespace {

/// Straight on the board, bent in the picture: pieces of a quarter of a square and less stray from it by less than 1e-3 px.
void addRectangle(ExactShapes& dark, const ExactBoard& board, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr int kPieces = 8;
  const Eigen::Vector2d ends[] = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  Eigen::Matrix2Xd outline(2, 4 * kPieces);
  for (int k = 0; k < 4 * kPieces; ++k) {
    const double share = static_cast<double>(k % kPieces) / kPieces;
    outline.col(k) = board.pixelOf((1.0 - share) * ends[k / kPieces] + share * ends[(k / kPieces + 1) % 4]);
  }
  dark.addDark(outline);
}

void addMarker(ExactShapes& dark, const ExactBoard& board, const cv::Ptr<cv::aruco::Dictionary>& dictionary, int id,
               const Eigen::Vector2d& square) {
  const int width = dictionary->markerSize + 2;
  cv::Mat cells;
  cv::aruco::drawMarker(dictionary, id, width, cells, 1);
  const Eigen::Vector2d grown = Eigen::Vector2d::Constant(board.growth);
  const Eigen::Vector2d origin = square.array() + 0.5 * (1.0 - board.marker);
  for (int row = 0; row < width; ++row) {
    // Cells side by side are drawn as one, or they would overlap where they have grown.
    for (int col = 0; col < width; ++col) {
      if (cells.at<std::uint8_t>(row, col) > 127) continue;
      const int first = col;
      while (col + 1 < width && cells.at<std::uint8_t>(row, col + 1) <= 127) ++col;
      const Eigen::Vector2d low = origin + board.marker / width * Eigen::Vector2d(first, row);
      const Eigen::Vector2d high = origin + board.marker / width * Eigen::Vector2d(col + 1, row + 1);
      addRectangle(dark, board, low - grown, high + grown);
    }
  }
}

}  // namespace

cv::Mat exactPicture(const ExactBoard& board) {
  ExactShapes dark(board.size);
  cv::Ptr<cv::aruco::Dictionary> dictionary;
  if (board.dictionary) dictionary = cv::aruco::getPredefinedDictionary(*board.dictionary);
  const Eigen::Vector2d grown = Eigen::Vector2d::Constant(board.growth);
  int id = 0;
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const Eigen::Vector2d square(col, row);
      if ((row + col) % 2 == 0) {
        addRectangle(dark, board, square - grown, square + Eigen::Vector2d::Ones() + grown);
      } else if (dictionary) {
        addMarker(dark, board, dictionary, id++, square);
      }
    }
  }
  const cv::Mat share = cv::min(dark.shares(board.blur), 1.0);
  return board.white + share * (board.black - board.white);
}

Eigen::Matrix2d cornerLimit(const ExactBoard& board, const Eigen::Vector2d& squares, double noise) {
  constexpr double kRounding = 1.0 / 12.0;  // variance
  const Eigen::Vector2d corner = board.pixelOf(squares);
  const auto moved = [&](const Eigen::Vector2d& shift, const Eigen::Matrix2d& turn) {
    ExactBoard other = board;
    other.pixelOf = [&board, corner, shift, turn](const Eigen::Vector2d& place) -> Eigen::Vector2d {
      const Eigen::Vector2d from_corner = board.pixelOf(place) - corner;
      return corner + shift + from_corner + turn * from_corner;
    };
    return exactPicture(other);
  };
  // The pixels nearer to this corner than to others, along the board.
  cv::Mat mine = cv::Mat::zeros(board.size, CV_32F);
  Eigen::Matrix2d J;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d step = 0.5 * Eigen::Vector2d::Unit(k);
    J.col(k) = board.pixelOf(squares + step) - board.pixelOf(squares - step);
  }
  const Eigen::Matrix2d J_squares_px = J.inverse();
  for (int y = 0; y < board.size.height; ++y) {
    for (int x = 0; x < board.size.width; ++x) {
      const Eigen::Vector2d place = J_squares_px * (Eigen::Vector2d(x, y) - corner);
      if (place.cwiseAbs().maxCoeff() <= 0.5) mine.at<float>(y, x) = 1.0F;
    }
  }
  const auto slope = [&](double step, const auto& picture) { return cv::Mat((picture(step) - picture(-step)) / (2.0 * step)); };
  std::vector<cv::Mat> slopes;
  for (int k = 0; k < 2; ++k) {
    slopes.push_back(slope(0.05, [&](double step) { return moved(step * Eigen::Vector2d::Unit(k), Eigen::Matrix2d::Zero()); }));
  }
  for (int k = 0; k < 2; ++k) {
    // Turns the one line and leaves the other.
    const Eigen::Matrix2d turn = J.col(1 - k) * J_squares_px.row(k);
    slopes.push_back(slope(0.002, [&](double step) { return moved(Eigen::Vector2d::Zero(), step * turn); }));
  }
  for (const auto member : {&ExactBoard::blur, &ExactBoard::black, &ExactBoard::white}) {
    slopes.push_back(slope(0.02, [&](double step) {
      ExactBoard other = board;
      other.*member += step;
      return exactPicture(other);
    }));
  }
  const auto count = static_cast<Eigen::Index>(slopes.size());
  Eigen::MatrixXd information(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const cv::Mat of_mine = slopes[static_cast<std::size_t>(i)].mul(mine);
    for (Eigen::Index j = 0; j < count; ++j) {
      information(i, j) = of_mine.dot(slopes[static_cast<std::size_t>(j)]) / (noise * noise + kRounding);
    }
  }
  return information.ldlt().solve(Eigen::MatrixXd::Identity(count, count)).topLeftCorner<2, 2>();
}

}  // namespace poecal::test
