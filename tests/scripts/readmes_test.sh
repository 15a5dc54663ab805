#!/usr/bin/env bash
# Proves: every folder of the tree opens with a README.md (the tests and configs with one for all).
# Does not prove: that it is worth reading.
set -euo pipefail
cd "$(dirname "$0")/../.."

missing=()
while read -r folder; do
  [ -f "$folder/README.md" ] || missing+=("$folder")
done < <(git ls-files -- app base bench calib cmake configs docs estimator nodes rig scripts tests |
  xargs dirname | sed -E 's,^(tests|configs)/.*,\1,' | sort -u)
if [ ${#missing[@]} -gt 0 ]; then
  echo "without README.md: ${missing[*]}"
  exit 1
fi
