// report.html as a file: its size, what it says of pictures, and that nothing in the data becomes markup.
#include <stdexcept>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "poecal/core/error.hpp"
#include "poecal/core/text.hpp"
#include "poecal/report/report.hpp"
#include "report/report_cells.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

using Json = nlohmann::json;

#define POECAL_REQUIRE_D3 \
  if (!reportBuilt()) GTEST_SKIP() << "built without D3"

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++count;
  return count;
}

/// The data that a page holds.
Json dataIn(const std::string& html, const std::string& id) {
  const std::string open = "<script type=\"application/json\" id=\"" + id + "\">";
  const std::size_t begin = html.find(open) + open.size();
  return Json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

TEST(ReportPage, NamesEndNoScriptAndComeBackAsTheyAre) {
  POECAL_REQUIRE_D3;
  const std::string json = reportJson(test::runWithBacklash(), "");
  const std::string html = reportHtml(json, {}, 1);
  EXPECT_EQ(countOf(html, "<script"), 4u);
  EXPECT_EQ(countOf(html, "</script>"), 4u);
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_THAT(html, Not(HasSubstr("\xE2\x80\xA8")));
  EXPECT_EQ(dataIn(html, "data"), Json::parse(json));
  EXPECT_EQ(dataIn(html, "data")["robot"], test::kHostileName);
}

TEST(ReportPage, AsksNobodyForAnything) {
  POECAL_REQUIRE_D3;
  const std::string html = reportHtml(reportJson(test::runWithout(), ""), {}, 1);
  EXPECT_THAT(html, HasSubstr("content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:;"));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, Not(HasSubstr("src=\"")));
  EXPECT_THAT(html, HasSubstr("Redistribution and use in source and binary forms"));
}

TEST(ReportPage, TenThousandSamplesAreThinnedAndTold) {
  POECAL_REQUIRE_D3;
  CalibrationRun run = test::runWithBacklash();
  const std::vector<Observation> observations = run.measurements.observations;
  while (run.measurements.observations.size() < 10000) {
    for (const Observation& observation : observations) run.measurements.observations.push_back(observation);
  }
  // One picture is worse than all others, and stands where an even choice would pass it by.
  run.measurements.observations[7001].corners[0].px.x() += 50.0;
  const Json report = Json::parse(reportJson(run, ""));
  EXPECT_EQ(report["counts"]["measured"], run.measurements.observations.size());
  EXPECT_EQ(report["counts"]["shown"], kMostReportSamples);
  ASSERT_THAT(report["samples"], SizeIs(kMostReportSamples));
  double worst = 0.0;
  for (const Json& sample : report["samples"]) worst = std::max(worst, sample["sizes"].back().get<double>());
  EXPECT_GT(worst, 20.0);
  EXPECT_LT(reportHtml(report.dump(), {}, 1).size(), 5'000'000u);
}

/// Pictures of noise, which no JPEG makes small.
class PicturesOfNoise : public ::testing::Test {
 protected:
  PicturesOfNoise() {
    for (Sample& sample : run_.measurements.samples) {
      sample.image = std::to_string(&sample - run_.measurements.samples.data()) + ".png";
      cv::Mat noise(1024, 1224, CV_8UC1);
      cv::randu(noise, 0, 256);
      cv::imwrite((folder_.path() / sample.image).string(), noise, {cv::IMWRITE_PNG_COMPRESSION, 0});
    }
  }
  const test::TempFolder folder_;
  CalibrationRun run_ = test::runWithBacklash();
};

TEST_F(PicturesOfNoise, AreTakenInWithinTheSizeOfThePage) {
  POECAL_REQUIRE_D3;
  const std::string html = reportHtml(reportJson(run_, "."), folder_.path(), 1);
  EXPECT_LT(html.size(), 5'000'000u);
  const Json pictures = dataIn(html, "pictures")["pictures"];
  ASSERT_THAT(pictures, SizeIs(60));
  EXPECT_THAT(pictures[0]["whole"].get<std::string>(), HasSubstr("data:image/jpeg;base64,/9j/"));
}

TEST_F(PicturesOfNoise, TheNumberOfJobsChangesNoByte) {
  POECAL_REQUIRE_D3;
  const std::string json = reportJson(run_, ".");
  EXPECT_TRUE(reportHtml(json, folder_.path(), 1) == reportHtml(json, folder_.path(), 3));
}

TEST_F(PicturesOfNoise, AreToldOneByOneAndCanBeStopped) {
  POECAL_REQUIRE_D3;
  const std::string json = reportJson(run_, ".");
  std::vector<std::size_t> done;
  std::size_t total = 0;
  const auto listen = [&](const std::string&, std::size_t pieces, std::size_t all) {
    done.push_back(pieces);
    total = all;
  };
  EXPECT_TRUE(reportHtml(json, folder_.path(), 2, {}, listen) == reportHtml(json, folder_.path(), 1));
  ASSERT_THAT(done, SizeIs(60));
  for (std::size_t k = 0; k < done.size(); ++k) EXPECT_EQ(done[k], k + 1);
  EXPECT_EQ(total, 60u);
  const auto enough = [](const std::string&, std::size_t pieces, std::size_t) {
    if (pieces == 3) throw std::runtime_error("enough");
  };
  const std::filesystem::path out = folder_.path() / "results/stopped";
  EXPECT_THAT([&] { writeReport(run_, folder_.path(), out, 1, enough); }, ThrowsMessage<std::runtime_error>("enough"));
  EXPECT_FALSE(std::filesystem::exists(out / "report.html"));
}

TEST_F(PicturesOfNoise, ThoseThatAreGoneAreLeftOut) {
  POECAL_REQUIRE_D3;
  std::filesystem::remove(folder_.path() / "0.png");
  folder_.write("1.png", "no picture");
  EXPECT_THAT(dataIn(reportHtml(reportJson(run_, "."), folder_.path(), 1), "pictures")["pictures"], SizeIs(58));
}

TEST_F(PicturesOfNoise, TheCommandWritesWhatTheRunWrote) {
  POECAL_REQUIRE_D3;
  const std::filesystem::path out = folder_.path() / "results/out";
  EXPECT_EQ(writeReport(run_, folder_.path(), out, 1), "");
  EXPECT_EQ(Json::parse(readTextFile(out / "report.json"))["pictures"], "../..");
  const std::string written = readTextFile(out / "report.html");
  std::filesystem::remove(out / "report.html");
  renderReport(out, 2);
  EXPECT_TRUE(readTextFile(out / "report.html") == written);
}

TEST_F(PicturesOfNoise, SmallPicturesAreKeptUntilAPictureChanges) {
  POECAL_REQUIRE_D3;
  const std::filesystem::path kept = folder_.path() / "kept";
  const std::string json = reportJson(run_, ".");
  const std::string first = reportHtml(json, folder_.path(), 1, kept);
  // What is kept is taken: a mark in it is in the page.
  folder_.write("kept", readTextFile(kept) + " ");
  EXPECT_EQ(reportHtml(json, folder_.path(), 1, kept).size(), first.size() + 1);
  std::filesystem::copy_file(folder_.path() / "1.png", folder_.path() / "0.png", std::filesystem::copy_options::overwrite_existing);
  const Json pictures = dataIn(reportHtml(json, folder_.path(), 1, kept), "pictures")["pictures"];
  EXPECT_NE(pictures[0], dataIn(first, "pictures")["pictures"][0]);
  EXPECT_EQ(pictures[1], dataIn(first, "pictures")["pictures"][1]);
}

TEST(ReportPage, ResultsThatHoldNoReportAreRefused) {
  POECAL_REQUIRE_D3;
  const test::TempFolder folder;
  EXPECT_THAT([&] { renderReport(folder.path(), 1); },
              ThrowsMessage<FileError>(HasSubstr("expected the results of poecal run, identify or diagnose")));
  for (const char* text : {"", "[]", "{\"format\": \"poecal-diagnosis/1\"}", "{\"format\": 7}"}) {
    folder.write("report.json", text);
    EXPECT_THAT([&] { renderReport(folder.path(), 1); }, ThrowsMessage<FileError>(HasSubstr("expected format poecal-report/1"))) << text;
  }
  for (const char* text :
       {"{\"format\": \"poecal-report/1\"}",
        "{\"format\": \"poecal-report/1\", \"pictures\": \"x\", \"samples\": [{\"image\": 7, \"sizes\": [1]}], \"model_after\": 0}"}) {
    folder.write("report.json", text);
    EXPECT_THAT([&] { renderReport(folder.path(), 1); }, ThrowsMessage<FileError>(HasSubstr("is not as it was written"))) << text;
  }
}

TEST(ReportPage, SamplesWithoutSizesAreNoReport) {
  POECAL_REQUIRE_D3;
  const test::TempFolder folder;
  Json report{{"format", "poecal-report/1"}, {"pictures", "."}, {"samples", Json::array()}, {"model_after", 0}};
  for (int k = 0; k < 201; ++k) report["samples"].push_back({{"image", "x.png"}});  // more than the page has pictures: the worst are chosen
  folder.write("report.json", report.dump());
  EXPECT_THAT([&] { renderReport(folder.path(), 1); }, ThrowsMessage<FileError>(HasSubstr("is not as it was written")));
}

TEST(ReportPage, CornersFarFromAnyPictureHaveNoPart) {
  POECAL_REQUIRE_D3;
  const test::TempFolder folder;
  cv::imwrite((folder.path() / "0.png").string(), cv::Mat(60, 80, CV_8UC1, cv::Scalar(100)));
  const Json sample{{"image", "0.png"}, {"corners", {1e308, 1e308, 1e308, 1e308}}, {"sizes", Json::array({1.0})}};
  const Json report{{"format", "poecal-report/1"}, {"pictures", "."}, {"samples", Json::array({sample})}, {"model_after", 0}};
  const Json pictures = dataIn(reportHtml(report.dump(), folder.path(), 1), "pictures")["pictures"];
  ASSERT_THAT(pictures, SizeIs(1));
  EXPECT_FALSE(pictures[0].contains("part"));
  EXPECT_TRUE(pictures[0].contains("whole"));
}

}  // namespace
}  // namespace poecal
