#!/usr/bin/env bash
# apps/install-dependencies.sh [--workflow] [--python] [--ci] [--fuzz]: installs the Debian 12 packages that poecal is built and tested with.
# --workflow adds snakemake (80 packages, 680 MB), without which the tests of apps/workflow skip; --python what the Python module is built
# and used with; --ci what only .ci/run needs; --fuzz what only tests/fuzz/run.sh does. Needs no network where all packages are there already.
set -euo pipefail

packages=(
  # to build with
  cmake g++ ninja-build
  # find_package in CMakeLists.txt, and xxhash.h
  libapriltag-dev libboost-dev libceres-dev libeigen3-dev libfmt-dev libopencv-dev libtbb-dev libtinyxml2-dev liburdfdom-dev libyaml-cpp-dev
  libxxhash-dev nlohmann-json3-dev
  # cairo.h, and the font of what is printed
  libcairo2-dev fonts-dejavu-core
  # D3, for report.html
  node-d3
  # find_package in apps/ and tests/
  libcli11-dev libgmock-dev libgtest-dev liborocos-kdl-dev
)
for option in "$@"; do
  case $option in
    --workflow) packages+=(snakemake) ;;
    --python) packages+=(pybind11-dev python3-dev python3-numpy) ;;
    --ci) packages+=(chromium clang-format clang-tidy doxygen librsvg2-bin man-db mypy poppler-utils python3-matplotlib zsh) ;;
    --fuzz) packages+=(clang libclang-rt-14-dev) ;;
    *)
      echo "error: unknown option $option, expected --workflow, --python, --ci or --fuzz" >&2
      exit 2
      ;;
  esac
done
if [[ ${POECAL_BUILD_BENCHMARKS:-OFF} == ON ]]; then
  packages+=(libbenchmark-dev)
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "error: these packages are missing, and installing them needs root or sudo: ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "installing ${missing[*]}"
# env, because sudo drops the environment of its caller.
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update --quiet
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
