#!/usr/bin/env bash
# tests/run.sh [PRESET [CTEST-OPTION...]]: installs what is missing, builds all of a preset (release) and runs its tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
(($#)) && shift
apps/build.sh "$preset"
ctest --preset "$preset" --parallel "$(nproc)" "$@"
