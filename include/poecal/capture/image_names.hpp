// Names of pictures: what joins samples.csv to detections.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace poecal {

struct SampleTable;
struct Detections;

/// The name as it is compared and read: `./a\\b.png`, as programs on Windows write it, is `a/b.png`. Empty where `text` is.
std::string imageName(const std::string& text);

/// Holds the pictures of samples.csv against those of a detections.csv. A row without corners alone is no mistake: there the target was not
/// seen.
/// @return what to warn of: pictures that have corners and no row, and beside them the rows that have no corners; empty where all meet.
/// @throws FileError with the line where not one row has corners.
std::vector<std::string> checkImagesMeet(const SampleTable& table, const Detections& detections,
                                         const std::filesystem::path& detections_file);

}  // namespace poecal
