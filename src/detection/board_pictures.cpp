#include "poecal/detection/board_pictures.hpp"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "poecal/core/error.hpp"

namespace poecal {
namespace {

BoardView boardView(const ImageCorners& image, const Target& target) {
  const auto count = static_cast<Eigen::Index>(image.corners.size());
  BoardView view{image.image, Eigen::Matrix3Xd(3, count), Eigen::Matrix2Xd(2, count)};
  Eigen::VectorXd sigmas(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Corner& corner = image.corners[static_cast<std::size_t>(i)];
    const TargetPoint* point = target.find(corner.id);
    assert(point != nullptr && "detect() names only points of its target");
    view.points.col(i) = point->p_target;
    view.pixels.col(i) = corner.px;
    sigmas(i) = corner.sigma;
  }
  if (sigmas.allFinite()) view.sigmas = sigmas;
  return view;
}

/// A view whose corners are those of an earlier one to the last digit loses them: noise alone makes two pictures differ.
void leaveOutCopies(BoardPictures& pictures) {
  std::vector<const BoardView*> kept;
  for (BoardView& view : pictures.views) {
    const auto original = std::find_if(kept.begin(), kept.end(), [&view](const BoardView* earlier) {
      return earlier->pixels.cols() == view.pixels.cols() && earlier->points == view.points && earlier->pixels == view.pixels;
    });
    if (view.pixels.cols() == 0) continue;
    if (original == kept.end()) {
      kept.push_back(&view);
      continue;
    }
    pictures.notes.push_back({view.image, fmt::format("is a copy of {}, left out", (*original)->image), true});
    view = {view.image, Eigen::Matrix3Xd(3, 0), Eigen::Matrix2Xd(2, 0)};
  }
}

}  // namespace

BoardPictures readBoardPictures(const std::filesystem::path& folder, const DetectOptions& options, KnownCorners* known) {
  BoardPictures pictures;
  pictures.target = readTarget(folder / "target.yaml");
  const std::vector<std::string> images = listPictures(folder);
  if (images.empty()) throw FileError(folder, 0, "no pictures, expected PNG, JPEG or TIFF files of the board");
  DetectResult found = detect(folder, images, pictures.target, options, known);
  if (found.width == 0) throw FileError(folder, 0, fmt::format("none of the {} pictures can be read", images.size()));
  for (const ImageCorners& image : found.detections.images) pictures.views.push_back(boardView(image, pictures.target));
  pictures.notes = std::move(found.notes);
  leaveOutCopies(pictures);
  pictures.width = found.width;
  pictures.height = found.height;
  return pictures;
}

}  // namespace poecal
