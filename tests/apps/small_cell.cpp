#include "apps/small_cell.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "poecal/core/text.hpp"
#include "poecal/simulation/simulate.hpp"

namespace poecal::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCamera = R"(image_width: 400
image_height: 300
camera_name: small_camera
camera_matrix: {rows: 3, cols: 3, data: [694.35, 0, 203.3, 0, 694.75, 146.7, 0, 0, 1]}
distortion_model: plumb_bob
distortion_coefficients: {rows: 1, cols: 5, data: [-0.081, 0.057, -0.0005, 0.0002, 0]}
)";

constexpr const char* kScene = R"(format: poecal-scene/1
name: small
robot: cobot6.urdf
base_link: base_link
tip_link: flange
errors: {seed: 1, position: 6.0e-4, rotation: 2.0e-3}
camera: camera.yaml
target: target.yaml
registration:
  T_camera_base: {position: [0.0279, 0.2779, 1.7527], quaternion_xyzw: [0.555067, 0.611943, -0.453013, 0.33497]}
  T_flange_target: {position: [0.012, -0.008, 0.02], quaternion_xyzw: [-0.97962, 0.198639, 0, 0.029796]}
)";

}  // namespace

void writeSmallScene(const fs::path& folder, SmallCell kind, const std::string& more, int poses) {
  const fs::path cobot = fs::path(POECAL_SOURCE_DIR) / "calib_data/cobot6";
  for (const char* name : {"cobot6.urdf", "target.yaml", "board.yaml"}) writeTextFile(folder / "scene" / name, readTextFile(cobot / name));
  writeTextFile(folder / "scene/camera.yaml", kCamera);
  const std::string image =
      kind == SmallCell::kPictures ? "image: {blur: 0.7, noise: 2.0, background: plain}\n" : "corners: {sigma: 0.1}\n";
  const std::string samples =
      more.find("samples:") == std::string::npos ? "samples: {count: " + std::to_string(poses) + ", seed: 12}\n" : "";
  writeTextFile(folder / "scene/scene.yaml", kScene + samples + image + more);
}

void simulateSmallCell(const fs::path& folder, SmallCell kind, int poses) {
  writeSmallScene(folder, kind, "", poses);
  simulate(readScene(folder / "scene/scene.yaml"), folder / "capture", {.jobs = 1});
}

void replaceInFile(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = readTextFile(file);
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::runtime_error("'" + from + "' is not in " + file.string());
  writeTextFile(file, text.replace(at, from.size(), to));
}

void rewriteCsv(const fs::path& file, const std::function<void(Rows&)>& change) {
  Rows rows;
  std::istringstream text(readTextFile(file));
  for (std::string line; std::getline(text, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  change(rows);
  std::string changed;
  for (const std::vector<std::string>& row : rows) {
    for (std::size_t k = 0; k < row.size(); ++k) changed += (k == 0 ? "" : ",") + row[k];
    changed += "\n";
  }
  writeTextFile(file, changed);
}

std::size_t columnOf(const Rows& rows, const std::string& name) {
  const auto found = std::find(rows.front().begin(), rows.front().end(), name);
  if (found == rows.front().end()) throw std::runtime_error("no column " + name);
  return static_cast<std::size_t>(found - rows.front().begin());
}

std::map<std::string, std::string> contentOf(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::error_code status;  // of a link to itself, which is no file
    if (entry.is_regular_file(status)) content[entry.path().lexically_relative(folder).string()] = readTextFile(entry.path());
  }
  return content;
}

}  // namespace poecal::test
