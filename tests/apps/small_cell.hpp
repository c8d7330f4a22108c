// A cell that a test can afford: calib_data/cobot6 with a tenth of the pixels and few poses.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace poecal::test {

constexpr int kSmallCellPoses = 10;

enum class SmallCell { kPictures, kCorners };

/// Writes FOLDER/scene/scene.yaml and what it names. @param more  further keys of the scene; `samples:` among them goes before the usual
/// poses.
void writeSmallScene(const std::filesystem::path& folder, SmallCell kind, const std::string& more = "", int poses = kSmallCellPoses);

/// Writes the scene and simulates it into FOLDER/capture, its truth into FOLDER/capture-truth.
void simulateSmallCell(const std::filesystem::path& folder, SmallCell kind, int poses = kSmallCellPoses);

/// Replaces the first occurrence of `from` in a file. @throws std::runtime_error where there is none, so that no test changes nothing.
void replaceInFile(const std::filesystem::path& file, const std::string& from, const std::string& to);

/// Rewrites a CSV file: its rows as cells, row 0 the header.
using Rows = std::vector<std::vector<std::string>>;
void rewriteCsv(const std::filesystem::path& file, const std::function<void(Rows&)>& change);
/// Index of a column of rows[0]. @throws std::runtime_error where there is none.
std::size_t columnOf(const Rows& rows, const std::string& name);

/// Content of every file below a folder, by its path in it.
std::map<std::string, std::string> contentOf(const std::filesystem::path& folder);

}  // namespace poecal::test
