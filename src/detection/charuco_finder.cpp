#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <opencv2/aruco/charuco.hpp>

#include "detection/board_saddles.hpp"
#include "detection/charuco_layout.hpp"
#include "detection/corner_finder.hpp"
#include "detection/subpixel.hpp"
#include "detection/tag_family.hpp"

namespace poecal {
namespace {

class CharucoFinder : public CornerFinder {
 public:
  CharucoFinder(const Target& target, bool refine)
      : target_(target),
        refine_(refine),
        dictionary_(makeMarkerDictionary(target.dictionary)),
        margin_((target.square - target.marker) / (2.0 * target.marker)),
        cells_(SaddleCells::charuco((target.square - target.marker) / (2.0 * target.square),
                                    target.marker / target.square / (dictionary_->markerSize + 2))),
        board_(cv::aruco::CharucoBoard::create(target.cols, target.rows, static_cast<float>(target.square),
                                               static_cast<float>(target.marker), dictionary_)),
        parameters_(cv::aruco::DetectorParameters::create()) {
    // Refining the markers' corners would let those near a corner of the board snap to it: the interpolation from markers is then off by
    // the margin between marker and square.
    parameters_->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  }

  FoundCorners find(const cv::Mat& grey) override {
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> marker_ids;
    cv::aruco::detectMarkers(grey, dictionary_, markers, marker_ids, parameters_);
    if (marker_ids.empty()) return {{}, {"no marker of the board was found"}};
    if (auto contradiction = layoutContradiction(target_, markers, marker_ids)) return {{}, {*std::move(contradiction)}};
    std::vector<cv::Point2f> corners;
    std::vector<int> ids;
    cv::aruco::interpolateCornersCharuco(markers, marker_ids, grey, board_, corners, ids);
    // OpenCV 4.6 has refined these already and returns them 0.5 px off in both axes; from there our own pass finds the saddle.
    if (!corners.empty()) refineSaddles(grey, corners, clearance(markers));
    std::vector<BoardSaddle> saddles;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const cv::Point2d px = corners[k];
      saddles.push_back({ids[k] % (target_.cols - 1), ids[k] / (target_.cols - 1), {px.x, px.y}});
    }
    // The square of the board's outer corner is black, and its corner is the first.
    if (refine_) fitBoardSaddles(grey, cells_, DarkPair::kMain, saddles);
    FoundCorners finding;
    for (std::size_t k = 0; k < ids.size(); ++k) finding.corners.push_back({{-1, ids[k]}, saddles[k].px, saddles[k].sigma});
    std::sort(finding.corners.begin(), finding.corners.end(), [](const Corner& a, const Corner& b) { return a.id < b.id; });
    if (ids.empty()) {
      finding.notes.push_back(fmt::format("{} markers of the board were found, but no corner between two of them", marker_ids.size()));
    }
    return finding;
  }

 private:
  /// From a corner of the board to where the markers beside it begin, less a pixel of blur [px].
  double clearance(const std::vector<std::vector<cv::Point2f>>& markers) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const auto& marker : markers) {
      for (std::size_t k = 0; k < 4; ++k) shortest = std::min(shortest, cv::norm(marker[(k + 1) % 4] - marker[k]));
    }
    return margin_ * shortest - 1.0;
  }

  Target target_;
  bool refine_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  double margin_;  ///< between marker and square, in sides of a marker
  SaddleCells cells_;
  cv::Ptr<cv::aruco::CharucoBoard> board_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
};

}  // namespace

std::unique_ptr<CornerFinder> makeCharucoFinder(const Target& target, bool refine) {
  return std::make_unique<CharucoFinder>(target, refine);
}

}  // namespace poecal
