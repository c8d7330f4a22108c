#!/usr/bin/env bash
# tests/fuzz/run.sh MINUTES [READER...]: what CI does for a minute, for hours. Each reader (default: all) runs under clang's libFuzzer for
# MINUTES; then 20,000 spoilt folders, or $POECAL_FUZZ_TRIALS of them, go through the sanitized program. What a reader must not do is left in
# build/fuzz/found/READER, to be made small with `fuzz_reader -minimize_crash=1`, mended, and put into tests/fuzz/corpus/READER; a folder
# that shows a fault is named by the test.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

minutes=${1:?usage: tests/fuzz/run.sh MINUTES [READER...]}
shift
apps/install-dependencies.sh --fuzz
apps/build.sh fuzz
export LSAN_OPTIONS=suppressions=$PWD/tests/leaks_of_others.txt:print_suppressions=0
readers=("$@")
((${#readers[@]})) || mapfile -t readers < <(grep -oP '^ *\{"\K[a-z_]+(?=",)' tests/fuzz/readers.cpp)

failed=()
for reader in "${readers[@]}"; do
  corpus=build/fuzz/corpus/$reader
  found=build/fuzz/found/$reader
  mkdir -p "$corpus" "$found"
  echo "$reader: $minutes minutes"
  POECAL_FUZZ_READER=$reader POECAL_FUZZ_SEEDS=$corpus build/fuzz/tests/fuzz/fuzz_reader -max_total_time=$((60 * minutes)) -timeout=20 \
    -max_len=65536 -use_value_profile=1 -print_final_stats=1 -artifact_prefix="$found/" "$corpus" >"build/fuzz/found/$reader.log" 2>&1 ||
    failed+=("$reader")
  grep -E 'number_of_executed_units|SUMMARY' "build/fuzz/found/$reader.log" || true
done

if ((${#readers[@]} > 1)); then
  apps/build.sh asan fuzz_captures_test
  export POECAL_FUZZ_TRIALS=${POECAL_FUZZ_TRIALS:-20000}
  parts=()
  for part in 0 1; do
    build/asan/tests/fuzz/fuzz_captures_test --gtest_filter="*SpoiltFolders*/$part" >"build/fuzz/found/folders-$part.log" 2>&1 &
    parts+=($!)
  done
  for part in "${parts[@]}"; do wait "$part" || failed+=("spoilt folders: build/fuzz/found/folders-*.log"); done
fi
if ((${#failed[@]})); then
  printf 'faults: %s\n' "${failed[@]}" >&2
  exit 1
fi
