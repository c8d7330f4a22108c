#include "poecal/detection/board_pictures.hpp"

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
  pictures.width = found.width;
  pictures.height = found.height;
  return pictures;
}

}  // namespace poecal
