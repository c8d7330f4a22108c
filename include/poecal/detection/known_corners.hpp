// Corners that were found before, kept in a file: no picture is searched twice, and a killed run continues where it stopped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "poecal/capture/detections.hpp"
#include "poecal/target/target.hpp"

namespace poecal {

struct DetectOptions;

/// What was found in one picture.
struct PictureFinding {
  std::vector<Corner> corners;     ///< sorted by id
  std::vector<std::string> notes;  ///< one sentence each; there is one where `corners` is empty
  int width = 0, height = 0;       ///< of the picture
  std::optional<PictureLook> look = std::nullopt;
};

/// Findings by pictureKey(). Each is appended to the file as its picture is finished; a line whose checksum is wrong, such as
/// the last one of a killed program, is ignored. All but the constructors and finish() may be called from any thread.
class KnownCorners {
 public:
  /// Reads what `file` knows; what is added goes there. The file need not exist yet.
  /// @throws FileError where it exists and is of another kind, or cannot be read.
  explicit KnownCorners(const std::filesystem::path& file);
  ~KnownCorners();
  KnownCorners(const KnownCorners&) = delete;
  KnownCorners& operator=(const KnownCorners&) = delete;

  /// Takes in what another such file knows. @throws FileError as the constructor does, and where there is no such file.
  void read(const std::filesystem::path& file);

  std::optional<PictureFinding> find(const std::string& key);
  /// @throws FileError where the file cannot be written.
  void add(const std::string& key, const PictureFinding& finding);

  /// Rewrites the file with those findings alone that were asked for or added since the constructor, sorted by key: its bytes then depend
  /// on the pictures and not on the order in which they were finished. @throws FileError where it cannot be written.
  void finish();

  std::size_t reused() const;  ///< how many different findings find() gave that were not added here

 private:
  struct Store;
  std::unique_ptr<Store> store_;
};

/// Everything but the picture that decides what detect() finds in it: target, quad_decimate, refine, camera, other_tags, and the versions
/// of poecal and OpenCV. Not the expected size, which is checked afterwards.
std::string detectionKey(const Target& target, const DetectOptions& options);

/// The key of what a picture shows. @param detection_key  detectionKey(). @param bytes  of the picture's file.
std::string pictureKey(const std::string& detection_key, std::string_view bytes);

}  // namespace poecal
