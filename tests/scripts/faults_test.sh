#!/usr/bin/env bash
# Proves: every test that docs/faults.md names exists, with its parameter, in the tests' sources. Does
# not prove: that it tests what the row says.
# Usage: faults_test.sh [PAGE]
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
page=${1:-$root/docs/faults.md}

# Suite.Test of every TEST, TEST_F and TEST_P, with line breaks inside the parentheses.
known=$(find "$root/tests" -name '*_test.cpp' -exec cat {} + | tr '\n' ' ' |
  grep -oE 'TEST(_F|_P)?\( *[A-Za-z0-9_]+, *[A-Za-z0-9_]+ *\)' |
  sed -E 's/^TEST(_F|_P)?\( *([A-Za-z0-9_]+), *([A-Za-z0-9_]+) *\)/\2.\3/' | sort -u)
words=$(grep -ohE '"[a-z_]+"' -r "$root/tests/nodes" "$root/rig/sim/fault_script.cpp" | tr -d '"' | sort -u)
named=$(grep -oE '`[A-Z][A-Za-z0-9]*\.[A-Z][A-Za-z0-9]*(/[a-z_]+)?`' "$page" | tr -d '`' | sort -u)

[ "$(wc -l <<<"$named")" -ge 10 ] || { echo "$page names hardly a test" && exit 1; }
failed=0
for name in $named; do
  grep -qxF "${name%%/*}" <<<"$known" || { echo "$page: there is no test ${name%%/*}" && failed=1; }
  [[ $name != */* ]] || grep -qxF "${name#*/}" <<<"$words" ||
    { echo "$page: $name: there is no parameter ${name#*/}" && failed=1; }
done
# The check itself must be able to fail.
if [ $# -eq 0 ]; then
  bad=$(mktemp)
  trap 'rm -f "$bad"' EXIT
  sed 's/KilledAfterEveryStep/KilledNever/' "$page" >"$bad"
  if bash "$0" "$bad" >/dev/null; then echo "a missing test was not noticed" && failed=1; fi
fi
exit $failed
