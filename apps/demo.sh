#!/usr/bin/env bash
# The main job on a simulated cell whose truth is known: builds the program, draws pictures of an arm whose wrist is not as its model says
# (calib_data/cobot6/scene-joint.yaml) into build/demo, calibrates camera and arm from them, and puts the diagnosis beside the truth. Installs
# what is missing; may be run again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

apps/build.sh release poecal_app
poecal=build/release/apps/poecal/poecal
capture=build/demo/capture
out=build/demo/out

# Written last: a demo that was stopped while drawing begins anew.
if [[ ! -e $capture/capture.yaml ]]; then
  rm -rf build/demo
  "$poecal" simulate calib_data/cobot6/scene-joint.yaml --out "$capture"
fi
"$poecal" run "$capture" --out "$out"

echo
echo "the truth, which the capture does not hold:"
sed -n '/^effects:/,/^[^ -]/ { /^- / s/^- /  /p }' "$capture-truth/truth.yaml"
echo "the report, to open in a browser: $out/report.html"
echo "all results:                      $out"
echo "the capture and its truth:        $capture, $capture-truth"
