// What one pixel gathers from the picture that the lens throws on it.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace poecal {

/// Weights of a pixel along one axis for the means over the `parts` that it and its neighbours are divided into: the lens blurs first, then
/// the pixel integrates over its square,
///   w_k = sum over the pixel's own parts j of g_(j - k) / parts,   g_d = N(d / parts; 0, blur^2), both scaled to add up to 1.
/// A part's own square and the sum over j make the pixel's square, with nothing left over, and of a Gaussian wider than a part no more than
/// exp(-2 (pi parts blur)^2) is lost by sampling it: whatever is drawn by areas keeps its place and its spread.
class PixelKernel {
 public:
  /// @param blur  standard deviation of the Gaussian [px]; 0: the pixel's square alone. @param parts  of a pixel's width.
  PixelKernel(double blur, int parts);

  int parts() const { return parts_; }
  /// Whole pixels to either side beyond which the weights are nothing.
  int reach() const { return reach_; }
  /// parts * (2 reach + 1) weights, from the left.
  const std::vector<float>& weights() const { return weights_; }

  /// Every pixel of a picture whose pixels are all of one grey within; beyond its border it goes on as at it. CV_32F.
  cv::Mat gather(const cv::Mat& pixels) const;
  /// Along the rows of a picture of parts: (columns / parts - 2 reach) columns. CV_32F.
  cv::Mat gatherRows(const cv::Mat& parts_picture) const;
  /// Likewise along the columns.
  cv::Mat gatherColumns(const cv::Mat& parts_picture) const;

 private:
  int parts_, reach_;
  std::vector<float> weights_;
};

}  // namespace poecal
