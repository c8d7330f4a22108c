#include "poecal/calibration/board_folder.hpp"

#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/detection/board_pictures.hpp"
#include "poecal/detection/known_corners.hpp"

namespace poecal {
namespace {

std::string residualsCsv(const IntrinsicsResult& result) {
  CsvWriter csv({"image", "points", "outliers", "rms_px", "max_px", "bad"});
  for (const ViewResidual& view : result.views) {
    csv.cell(view.image).cell(view.points).cell(view.outliers);
    // A picture that took no part has no residuals, which is not the same as none of any size.
    if (view.used) {
      csv.cell(view.rms_px).cell(view.max_px);
    } else {
      csv.cell("").cell("");
    }
    csv.cell(view.bad ? 1 : 0).endRow();
  }
  return csv.str();
}

/// calibrateIntrinsics(); where that fails, what each picture has to say comes first, and the last of it again with the error.
IntrinsicsResult calibrateOrSayWhyNot(const BoardPictures& pictures, const IntrinsicsOptions& options, Listener& listener) {
  try {
    return calibrateIntrinsics(pictures.views, pictures.width, pictures.height, options);
  } catch (const InsufficientData& error) {
    const std::vector<std::string> notes = texts(pictures.notes);
    listener.warnings(notes);
    throw InsufficientData(error.what() + (notes.empty() ? std::string() : " (" + notes.back() + ")"));
  }
}

}  // namespace

std::filesystem::path residualsFile(const std::filesystem::path& camera_file) {
  return camera_file.parent_path() / (camera_file.stem().string() + "-residuals.csv");
}

IntrinsicsResult calibrateBoardFolder(const std::filesystem::path& folder, const IntrinsicsOptions& options, int jobs,
                                      const std::filesystem::path& camera_file, Listener& listener) {
  DetectOptions detect_options;
  detect_options.jobs = jobs;
  detect_options.progress = listener.progressFunction();
  IntrinsicsOptions fit_options = options;
  if (!fit_options.progress) fit_options.progress = listener.progressFunction();
  KnownCorners known(camera_file.parent_path() / ".stages" / "board-corners");
  BoardPictures pictures = readBoardPictures(folder, detect_options, &known);
  IntrinsicsResult result = calibrateOrSayWhyNot(pictures, fit_options, listener);
  // Edges of tags are fitted as a whole, bent as the lens bends them: their corners depend on the lens that they are found with.
  if (pictures.target.hasTags()) {
    detect_options.camera = result.chosen().camera;
    pictures = readBoardPictures(folder, detect_options, &known);
    result = calibrateOrSayWhyNot(pictures, fit_options, listener);
  }
  known.finish();
  listener.warnings(texts(pictures.notes));
  listener.warnings(result.warnings);
  writeTextFile(residualsFile(camera_file), residualsCsv(result));
  writeTextFile(camera_file, cameraYaml(result.chosen().camera));
  return result;
}

}  // namespace poecal
