#!/usr/bin/env bash
# Proves: every test that docs/faults.md names is one that ctest runs, with its parameter. Does not
# prove: that it tests what the row says.
# Usage: faults_test.sh BUILD [PAGE]
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$1
page=${2:-$root/docs/faults.md}

# [Instances/]Suite.Test[/parameter] of every test.
known=$(ctest --test-dir "$build" -N | sed -nE 's/^ *Test +#[0-9]+: //p')
named=$(grep -oE '`[A-Z][A-Za-z0-9]*\.[A-Z][A-Za-z0-9]*(/[a-z_]+)?`' "$page" | tr -d '`' | sort -u)

[ "$(wc -l <<<"$named")" -ge 10 ] || { echo "$page names hardly a test" && exit 1; }
failed=0
for name in $named; do
  grep -qE "^([A-Za-z]+/)?${name//./\\.}([/ ]|$)" <<<"$known" ||
    { echo "$page: there is no test $name" && failed=1; }
done
# The check itself must be able to fail, over a test and over a parameter.
if [ $# -eq 1 ]; then
  bad=$(mktemp)
  trap 'rm -f "$bad"' EXIT
  for damage in 's/KilledAfterEveryStep/KilledNever/' 's,Repeated/lost_steps,Repeated/retry,'; do
    sed "$damage" "$page" >"$bad"
    cmp -s "$page" "$bad" && { echo "$damage changes nothing" && failed=1; }
    if bash "$0" "$build" "$bad" >/dev/null; then echo "not noticed: $damage" && failed=1; fi
  done
fi
exit $failed
