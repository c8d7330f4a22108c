#include "report/sample_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "detection/picture.hpp"
#include "poecal/core/content_key.hpp"
#include "poecal/core/parallel.hpp"
#include "poecal/core/text.hpp"

namespace poecal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kLongestSide = 360;  // [px]

/// One way to make a picture smaller than kLongestSide makes it.
struct Smallness {
  double scale = 1.0;
  int quality = 0;  ///< of JPEG
};
constexpr Smallness kSmaller[] = {{1.0, 70}, {1.0, 50}, {1.0, 35}, {0.75, 35}, {0.5, 30}};

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - k);
    unsigned int group = bytes[k] << 16U;
    if (left > 1) group |= static_cast<unsigned int>(bytes[k + 1]) << 8U;
    if (left > 2) group |= bytes[k + 2];
    for (std::size_t digit = 0; digit < 4; ++digit) text += digit <= left ? kDigits[(group >> (18U - 6U * digit)) & 63U] : '=';
  }
  return text;
}

/// The mean of whole blocks of pixels, as many as make no side longer than kLongestSide: other ratios take several times as long.
cv::Mat shrunk(const cv::Mat& picture) {
  const int block = (std::max(picture.cols, picture.rows) + kLongestSide - 1) / kLongestSide;
  if (block <= 1) return picture;
  cv::Mat small;
  const cv::Rect whole_blocks(0, 0, std::max(1, picture.cols / block) * block, std::max(1, picture.rows / block) * block);
  const cv::Mat part = picture(whole_blocks & cv::Rect(cv::Point(0, 0), picture.size()));
  cv::resize(part, small, cv::Size(std::max(1, part.cols / block), std::max(1, part.rows / block)), 0.0, 0.0, cv::INTER_AREA);
  return small;
}

/// The best of kSmaller that is not larger than `most` bytes; else the last.
std::string dataUri(const cv::Mat& picture, std::size_t most) {
  const cv::Mat largest = shrunk(picture);
  std::vector<unsigned char> bytes;
  for (const Smallness& smaller : kSmaller) {
    cv::Mat small = largest;
    if (smaller.scale < 1.0) {
      const cv::Size size(std::max(1, cvRound(smaller.scale * largest.cols)), std::max(1, cvRound(smaller.scale * largest.rows)));
      cv::resize(largest, small, size, 0.0, 0.0, cv::INTER_AREA);
    }
    cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, smaller.quality});
    if (bytes.size() * 4 / 3 <= most) break;
  }
  return "data:image/jpeg;base64," + base64(bytes);
}

/// The part of a picture around the corners, half of their extent more on each side; at least 32 px.
cv::Rect aroundCorners(const Json& corners, const cv::Size& size) {
  constexpr double kFar = 1e8;  // [px] beyond any picture, and twice as far still within an int
  double low[2] = {kFar, kFar}, high[2] = {-kFar, -kFar};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (!corners.at(k).is_number()) continue;
    const double px = std::clamp(corners.at(k).get<double>(), -kFar, kFar);
    low[k % 2] = std::min(low[k % 2], px);
    high[k % 2] = std::max(high[k % 2], px);
  }
  if (low[0] > high[0] || low[1] > high[1]) return {};
  const double half = std::max(16.0, std::max(high[0] - low[0], high[1] - low[1]));
  const double u = 0.5 * (low[0] + high[0]), v = 0.5 * (low[1] + high[1]);
  const cv::Rect wanted(static_cast<int>(std::lround(u - half)), static_cast<int>(std::lround(v - half)),
                        static_cast<int>(std::lround(2.0 * half)), static_cast<int>(std::lround(2.0 * half)));
  return wanted & cv::Rect(cv::Point(0, 0), size);
}

Json pictureJson(const Json& sample, std::size_t row, const std::filesystem::path& folder, std::size_t most) {
  const std::string name = sample.value("image", "");
  if (name.empty()) return nullptr;
  const cv::Mat grey = readPicture(folder / name).grey;
  if (grey.empty()) return nullptr;
  Json json{{"row", row}, {"whole", dataUri(grey, most * 6 / 10)}};
  const cv::Rect part = aroundCorners(sample.value("corners", Json::array()), grey.size());
  if (part.area() > 0) {
    json["part"] = {part.x, part.y, part.width, part.height};
    json["near"] = dataUri(grey(part), most * 4 / 10);
  }
  return json;
}

/// Rows of the samples whose pictures the page has: the worst, and an even choice of the others.
std::vector<std::size_t> chosenRows(const Json& samples, std::size_t after, std::size_t most) {
  std::vector<std::size_t> rows(samples.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (rows.size() <= most) return rows;
  const auto size = [&](std::size_t row) {
    const Json& value = samples.at(row).at("sizes").at(after);
    return value.is_number() ? value.get<double>() : 0.0;
  };
  std::stable_sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
  const std::size_t worst = most / 4;
  std::vector<std::size_t> chosen(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(worst));
  std::vector<std::size_t> others(rows.begin() + static_cast<std::ptrdiff_t>(worst), rows.end());
  std::sort(others.begin(), others.end());
  for (std::size_t k = 0; k < most - worst; ++k) chosen.push_back(others[k * others.size() / (most - worst)]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// Of all that the small pictures are made from.
std::string keyOf(const Json& samples, const std::vector<std::size_t>& rows, const std::filesystem::path& folder, std::size_t each) {
  ContentKey key;
  key.add(std::to_string(each));
  for (const std::size_t row : rows) {
    const Json& sample = samples.at(row);
    key.add(std::to_string(row)).add(sample.value("corners", Json::array()).dump());
    key.addFile(folder / sample.value("image", ""));
  }
  return key.text();
}

/// What was kept under this key.
std::optional<std::string> keptText(const std::filesystem::path& kept, const std::string& key) {
  std::error_code status;
  if (kept.empty() || !std::filesystem::is_regular_file(kept, status)) return std::nullopt;
  const std::string text = readTextFile(kept);
  if (!text.starts_with(key + '\n')) return std::nullopt;
  return text.substr(key.size() + 1);
}

}  // namespace

std::string samplePictures(const nlohmann::ordered_json& report, const std::filesystem::path& folder, std::size_t most_bytes, int jobs,
                           const std::filesystem::path& kept, const ProgressFunction& progress) {
  constexpr std::size_t kMostPictures = 200;
  constexpr std::size_t kFewestBytes = 6000, kMostBytes = 40000;  // of a picture: fewer show nothing, more show no more
  const Json& samples = report.at("samples");
  const std::size_t most = std::min(kMostPictures, most_bytes / kFewestBytes);
  std::vector<std::size_t> rows;
  if (!folder.empty()) rows = chosenRows(samples, report.at("model_after").get<std::size_t>(), most);
  const std::size_t each = rows.empty() ? 0 : std::min(kMostBytes, most_bytes / rows.size());
  const std::string key = kept.empty() ? "" : keyOf(samples, rows, folder, each);
  if (const std::optional<std::string> same = keptText(kept, key)) return *same;
  std::vector<Json> pictures(rows.size());
  Progress told(progress, "pictures of the report", rows.size());
  parallelFor(rows.size(), jobs, [&](std::size_t k) {
    pictures[k] = pictureJson(samples.at(rows[k]), rows[k], folder, each);
    told.advance();
  });
  Json list = Json::array();
  for (Json& picture : pictures) {
    if (!picture.is_null()) list.push_back(std::move(picture));
  }
  const std::string text = Json{{"wanted", rows.size()}, {"pictures", std::move(list)}}.dump();
  if (!kept.empty()) writeTextFile(kept, key + '\n' + text);
  return text;
}

}  // namespace poecal
