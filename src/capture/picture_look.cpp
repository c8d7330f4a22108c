#include "poecal/capture/picture_look.hpp"

#include <fmt/format.h>

#include "poecal/capture/detections.hpp"
#include "poecal/core/csv.hpp"
#include "poecal/core/error.hpp"
#include "poecal/core/statistics.hpp"
#include "poecal/core/text.hpp"

namespace poecal {

std::optional<PictureLook> medianLook(const std::vector<PictureLook>& looks) {
  if (looks.empty()) return std::nullopt;
  const auto medianOf = [&looks](double PictureLook::*figure) {
    std::vector<double> values;
    for (const PictureLook& look : looks) values.push_back(look.*figure);
    return median(std::move(values));
  };
  return PictureLook{medianOf(&PictureLook::blur), medianOf(&PictureLook::noise), medianOf(&PictureLook::growth)};
}

std::filesystem::path picturesFile(const std::filesystem::path& detections) {
  std::filesystem::path name = detections.stem();
  name += "-pictures";
  name += detections.extension();
  return detections.parent_path() / name;
}

std::string picturesCsv(const Detections& detections) {
  CsvWriter writer({"image", "blur", "noise", "growth"});
  for (const ImageCorners& image : detections.images) {
    if (!image.look) continue;
    writer.cell(image.image).cell(image.look->blur).cell(image.look->noise).cell(image.look->growth);
    writer.endRow();
  }
  return writer.str();
}

std::vector<PictureLook> readPictureLooks(const std::filesystem::path& file) {
  const CsvTable csv = CsvTable::read(file);
  const std::size_t blur = csv.column("blur"), noise = csv.column("noise");
  const std::optional<std::size_t> growth = csv.findColumn("growth");
  const auto notNegative = [&csv](std::size_t row, std::size_t column, double largest) {
    const double value = csv.number(row, column);
    if (value < 0.0 || value > largest) {
      throw FileError(csv.file(), csv.line(row),
                      fmt::format("{} is {}, expected 0 to {}", csv.header()[column], formatNumber(value), formatNumber(largest)));
    }
    return value;
  };
  std::vector<PictureLook> looks;
  for (std::size_t row = 0; row < csv.rowCount(); ++row) {
    looks.push_back(
        {notNegative(row, blur, kLargestBlur), notNegative(row, noise, kLargestNoise), growth ? csv.number(row, *growth) : 0.0});
  }
  if (looks.empty()) throw FileError(file, 1, "has no rows, expected blur and noise of at least one picture");
  return looks;
}

}  // namespace poecal
