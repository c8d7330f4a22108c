// Work on independent items with a bounded number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace poecal {

/// Calls work(i) for i in [0, count), at most `jobs` at a time (jobs <= 0: one per core). Items must not share state that they write.
/// The exception of the lowest failing item is thrown again, so that errors do not depend on timing; items after it may be left undone.
void parallelFor(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

/// Number of threads that `jobs` stands for: itself if positive, otherwise the number of cores.
int resolveJobs(int jobs);

}  // namespace poecal
