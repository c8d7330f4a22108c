#!/usr/bin/env bash
# tests/withheld/run.sh [CASES [SEED]]: the withheld check. Makes CASES cases (400) of every set and half as many of the harder ones, from a
# seed drawn now (or SEED). A twentieth have pictures; a tenth are effects brought into the real recordings of $POECAL_REAL_DIR
# (../shared/real) where these are there. Unlisted structure is of the family of generators that no number of the program was set on. Then
# `poecal diagnose` answers them, the truths are opened and the tables printed. Folder of the cases: $WITHHELD_DIR, or a new one under /tmp.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

cases=${1:-400}
seed=${2:-$(od -An -N4 -tu4 /dev/urandom | tr -d ' ')}
folder=${WITHHELD_DIR:-$(mktemp -d /tmp/withheld-XXXXXX)}
apps/build.sh release poecal_app withheld_world withheld_score

echo "seed $seed, cases in $folder"
programs=build/release/tests/withheld
few=$(((cases + 19) / 20)) # of the cases whose pictures are drawn and searched: they are slow
for set in single clean untidy untidy-single pairs outside scatter scale unobservable rendered \
  half waves field-80 field-300 fast large small in-hand triple bare; do
  compare=() count=$cases
  case $set in
    single | clean | pairs) compare=(--baselines) ;;
    outside) compare=(--baselines --second-family) ;;
    rendered) count=$few ;;
    half | waves | field-80 | field-300 | fast | large | small | in-hand | triple | bare)
      compare=(--second-family) count=$(((cases + 1) / 2))
      ;;
  esac
  "$programs/withheld_world" --set "$set" --cases "$count" --seed "$seed" --out "$folder/$set" --jobs "$(nproc)" "${compare[@]}"
done
real=${POECAL_REAL_DIR:-../shared/real}
if [ -d "$real" ]; then
  "$programs/withheld_world" --set injected --real "$real" --cases $((3 + (cases + 9) / 10)) --seed "$seed" --out "$folder/injected" \
    --jobs "$(nproc)"
else
  echo "skips the set injected: no real recordings in $real (POECAL_REAL_DIR names another place)"
fi
"$programs/withheld_score" "$folder" --poecal build/release/apps/poecal/poecal --jobs "$(nproc)" --table "$folder/table.md"
