#include "poecal/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace poecal {

int resolveJobs(int jobs) {
  if (jobs > 0) return jobs;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallelFor(std::size_t count, int jobs, const std::function<void(std::size_t)>& work) {
  std::vector<std::exception_ptr> failures(count);
  std::atomic<std::size_t> lowest{count};  // that failed: what comes after it changes nothing
  const auto guarded = [&](std::size_t i) {
    if (i > lowest) return;
    try {
      work(i);
    } catch (...) {
      failures[i] = std::current_exception();
      std::size_t before = lowest;
      while (i < before && !lowest.compare_exchange_weak(before, i)) {
      }
    }
  };
  // More threads than cores gain nothing, and TBB complains of them on stderr.
  tbb::task_arena arena(std::min(resolveJobs(jobs), tbb::this_task_arena::max_concurrency()));
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, guarded, tbb::simple_partitioner()); });
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace poecal
