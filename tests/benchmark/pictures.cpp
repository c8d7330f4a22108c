// Time of the whole `poecal run` on a capture of pictures against a bare loop of AprilTag over the same files with as many threads.
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "poecal/core/parallel.hpp"
#include "poecal/simulation/simulate.hpp"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

namespace poecal {
namespace {

namespace fs = std::filesystem;

/// Of a piece of work and the programs that it starts.
struct Seconds {
  double wall = 1e9, processor = 1e9;

  void keepLess(const Seconds& other) {
    wall = std::min(wall, other.wall);
    processor = std::min(processor, other.processor);
  }
};

double processorSeconds() {
  double sum = 0.0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime}) {
      sum += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    }
  }
  return sum;
}

template <typename Work>
Seconds secondsOf(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  const double processor = processorSeconds();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), processorSeconds() - processor};
}

/// What anybody would write. @return the number of tags.
int bareLoop(const std::vector<std::string>& files, int threads) {
  std::atomic<std::size_t> next{0};
  std::atomic<int> tags{0};
  std::vector<std::thread> workers;
  for (int thread = 0; thread < threads; ++thread) {
    workers.emplace_back([&] {
      apriltag_detector_t* detector = apriltag_detector_create();
      apriltag_family_t* family = tag36h11_create();
      apriltag_detector_add_family(detector, family);
      detector->quad_decimate = 2.0F;
      for (std::size_t k = next++; k < files.size(); k = next++) {
        const cv::Mat grey = cv::imread(files[k], cv::IMREAD_GRAYSCALE);
        image_u8_t view{grey.cols, grey.rows, static_cast<int32_t>(grey.step[0]), grey.data};
        zarray_t* found = apriltag_detector_detect(detector, &view);
        tags += zarray_size(found);
        apriltag_detections_destroy(found);
      }
      apriltag_detector_destroy(detector);
      tag36h11_destroy(family);
    });
  }
  for (std::thread& worker : workers) worker.join();
  return tags;
}

int runProgram(const fs::path& capture, const fs::path& out, int threads) {
  fs::remove_all(out);
  return std::system(
      fmt::format("'{}' run '{}' --out '{}' --jobs {} --quiet > /dev/null", POECAL_PROGRAM, capture.string(), out.string(), threads)
          .c_str());
}

int run(bool quick, const fs::path& folder) {
  const int repetitions = quick ? 1 : 5;
  Scene scene = readScene(POECAL_SCENE);
  scene.count = quick ? 30 : 200;
  scene.board.reset();
  const fs::path capture = folder / "capture";
  fs::remove_all(folder);
  fs::create_directories(folder);
  simulate(scene, capture, {});
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(capture / "images")) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  const int threads = resolveJobs(0);
  // By turns, so that what else the machine does meets both; the least of each.
  Seconds bare, whole;
  int tags = 0;
  for (int k = 0; k < repetitions; ++k) {
    bare.keepLess(secondsOf([&] { tags = bareLoop(files, threads); }));
    int status = 0;
    whole.keepLess(secondsOf([&] { status = runProgram(capture, folder / "out", threads); }));
    if (status != 0) {
      fmt::print(stderr, "poecal run failed\n");
      return 1;
    }
  }
  fmt::print("{} pictures of {} x {}, {} threads, least of {}.\n\n", files.size(), scene.camera.width, scene.camera.height, threads,
             repetitions);
  fmt::print("| | wall clock [s] | processor [s] |\n|---|---|---|\n");
  fmt::print("| reading the pictures and AprilTag at quad_decimate 2, {} tags | {:.2f} | {:.2f} |\n", tags, bare.wall, bare.processor);
  fmt::print("| `poecal run`: pictures to model and diagnosis | {:.2f} | {:.2f} |\n", whole.wall, whole.processor);
  fmt::print("| ratio | {:.2f} | {:.2f} |\n\n", whole.wall / bare.wall, whole.processor / bare.processor);
  return 0;
}

}  // namespace
}  // namespace poecal

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::string(argv[1]) == "--quick";
  if (argc != (quick ? 3 : 2)) {
    fmt::print(stderr, "usage: benchmark_pictures [--quick] FOLDER\n");
    return 2;
  }
  return poecal::run(quick, argv[argc - 1]);
}
