#!/usr/bin/env bash
# The main job on a simulated cell whose truth is known: builds the program, draws the pictures of calib_data/cobot6 into build/demo,
# calibrates camera and arm from them, and says where the results are. Installs what is missing; may be run again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

apps/build.sh release poecal_app
poecal=build/release/apps/poecal/poecal
capture=build/demo/capture
out=build/demo/out

# Written last: a demo that was stopped while drawing begins anew.
if [[ ! -e $capture/capture.yaml ]]; then
  rm -rf build/demo
  "$poecal" simulate calib_data/cobot6/scene.yaml --out "$capture"
fi
"$poecal" run "$capture" --out "$out"

echo
echo "the capture, as a camera would have taken it: $capture"
echo "the truth that it was drawn from:             $capture-truth"
echo "the results:"
find "$out" -maxdepth 1 -type f -printf '  %p\n' | sort
