// A small cell on disk: two turning joints, one sliding one, a tag and a camera of few pixels, so that each test is quick.
#pragma once

#include <string>

#include "poecal/simulation/scene.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {

/// The top of scene.yaml; what a test is about follows it. Line 8 is the first that a test writes.
inline const std::string kSceneHead = R"(format: poecal-scene/1
name: small
robot: robot.yaml
camera: camera.yaml
target: target.yaml
registration: {T_camera_base: {position: [0, 0, 0.7], quaternion_xyzw: [0, 0, 0, 1]},
               T_flange_target: {position: [0.01, 0.02, 0], quaternion_xyzw: [0, 0, 0, 1]}}
)";

/// Writes the files that a scene names, and scene.yaml as kSceneHead + `rest`.
inline std::filesystem::path writeScene(const TempFolder& folder, const std::string& rest) {
  folder.write("robot.yaml", R"(format: poecal-robot/1
name: small
joints:
  - {name: swivel, type: revolute, axis: [0, 0, 1], point: [0.05, 0, 0], limits: [-2, 2]}
  - {name: nod, type: revolute, axis: [1, 0, 0], point: [0, 0.03, 0], limits: [-0.9, 0.9]}
  - {name: slide, type: prismatic, axis: [0, 1, 0], limits: [-0.1, 0.1]}
flange: {position: [0, 0, 0.05], quaternion_xyzw: [0, 0, 0, 1]}
)");
  const auto camera = [](int fx) {
    return "image_width: 320\nimage_height: 240\ncamera_name: small\ncamera_matrix: {rows: 3, cols: 3, data: [" + std::to_string(fx) +
           ", 0, 158, 0, 401, 122, 0, 0, 1]}\ndistortion_model: plumb_bob\n"
           "distortion_coefficients: {rows: 1, cols: 5, data: [-0.08, 0.05, 0.001, -0.0007, 0.01]}\n";
  };
  folder.write("camera.yaml", camera(400));
  folder.write("stated.yaml", camera(404));
  folder.write("target.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n  - {id: 7, size: 0.1, center: [0, 0, 0]}\n");
  folder.write("larger.yaml", "type: apriltag\nfamily: tag36h11\ntags:\n  - {id: 7, size: 0.101, center: [0, 0, 0]}\n");
  folder.write("points.yaml", "type: points\npoints:\n  - {id: 3, position: [0, 0, 0]}\n  - {id: 4, position: [0.05, 0, 0]}\n");
  folder.write("board.yaml", "type: chessboard\ncols: 5\nrows: 4\nsquare: 0.02\n");
  return folder.write("scene.yaml", kSceneHead + rest);
}

inline Scene smallScene(const TempFolder& folder, const std::string& rest) { return readScene(writeScene(folder, rest)); }

}  // namespace poecal::test
