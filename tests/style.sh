#!/usr/bin/env bash
# tests/style.sh: every C++ file is formatted as .clang-format says, and every shell script parses. What is wrong is printed; nothing is
# changed. To format: clang-format -i FILE...
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

find include src apps tests \( -name '*.hpp' -o -name '*.cpp' \) -print0 | sort -z | xargs -0 clang-format --dry-run --Werror
find .ci apps tests -type f -not -path '*/corpus/*' -print0 | sort -z | while IFS= read -r -d '' file; do
  if [[ $(head -n 1 "$file") == '#!'*bash ]]; then bash -n "$file"; fi
done
