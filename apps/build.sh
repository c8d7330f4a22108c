#!/usr/bin/env bash
# apps/build.sh PRESET [TARGET...]: installs what is missing, configures a preset of CMakePresets.json into build/PRESET and builds it,
# or only the targets. POECAL_BUILD_BENCHMARKS=ON in the environment: with tests/benchmark. POECAL_BUILD_PYTHON=ON: with apps/python.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=$1
shift
benchmarks=${POECAL_BUILD_BENCHMARKS:-OFF}
python=${POECAL_BUILD_PYTHON:-OFF}
with=()
if [[ $python == ON ]]; then
  with+=(--python)
fi
POECAL_BUILD_BENCHMARKS=$benchmarks apps/install-dependencies.sh "${with[@]}"

launcher=()
if command -v ccache >/dev/null; then
  launcher=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache)
fi
cmake --preset "$preset" -D POECAL_BUILD_BENCHMARKS="$benchmarks" -D POECAL_BUILD_PYTHON="$python" "${launcher[@]}"
targets=()
(($#)) && targets=(--target "$@")
cmake --build --preset "$preset" "${targets[@]}"
