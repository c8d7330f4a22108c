#!/usr/bin/env bash
# tests/benchmark/run.sh [FILE]: builds the benchmarks, runs them and writes their tables in Markdown to FILE (build/benchmark.md). A quarter
# of an hour on two cores; --quick: a small part of each in seconds, to see that they run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

quick=()
if [[ ${1:-} == --quick ]]; then
  quick=(--quick)
  shift
fi
table=${1:-build/benchmark.md}
POECAL_BUILD_BENCHMARKS=ON apps/build.sh release poecal_app benchmark_corners benchmark_pictures benchmark_fits

programs=build/release/tests/benchmark
{
  "$programs/benchmark_corners" "${quick[@]}"
  "$programs/benchmark_pictures" "${quick[@]}" build/benchmark
  "$programs/benchmark_fits" "${quick[@]}"
} | tee "$table"
