#!/usr/bin/env bash
# Proves: the sources of this tree and their functions are as short as scripts/check-sizes allows, and it
# would say so if one were not. Does not prove: that short is plain.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
check=$root/scripts/check-sizes
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{base,tests/base}

# lines N: as many statements.
lines() { for ((i = 0; i < $1; i++)); do echo "  ++n;  // } is no brace, nor is '\"{'"; done; }
# A file of the standard input must be refused with these words, or accepted.
refused() {
  local file=$1 words=$2 said
  cat >"$tree/$file"
  if said=$("$check" "$tree"); then echo "not refused: $file: $words" && exit 1; fi
  grep -qxF "$file:$words" <<<"$said" || { echo "'$words' is not in: $said" && exit 1; }
  rm "$tree/$file"
}
accepted() {
  cat >"$tree/$1"
  "$check" "$tree" >"$tree/said" || { cat "$tree/said" && exit 1; }
  rm "$tree/$1"
}
# in_function N HEAD: a function of N lines that begins with the head.
in_function() { echo "namespace a {" && echo "$2 {" && lines $(($1 - 2)) && echo "}" && echo "}"; }

"$check" "$root"
seq 400 | accepted base/a.cpp
seq 401 | refused base/a.cpp '1: 401 lines, allowed are 400'
seq 401 | refused base/CMakeLists.txt '1: 401 lines, allowed are 400'
seq 500 | accepted tests/base/a_test.cpp
seq 501 | refused tests/base/a_test.cpp '1: 501 lines, allowed are 500'

in_function 50 'int f(int n)' | accepted base/a.cpp
in_function 51 'int f(int n)' | refused base/a.cpp '2: f: 51 lines, allowed are 50'
in_function 51 $'/* { */\nint f(int n)' | refused base/a.h '3: f: 51 lines, allowed are 50'
in_function 51 'template <typename T> auto A<T>::f(T n) const noexcept -> Result<T>' |
  refused base/a.cpp '2: A<T>::f: 51 lines, allowed are 50'
in_function 51 'A::A(int n) : Base(n), n_{n}, text_(R"({)")' |
  refused base/a.cpp '2: A::A: 51 lines, allowed are 50'
in_function 51 'TEST(Suite, Name)' | refused tests/base/a_test.cpp '2: TEST(Suite, Name): 51 lines, allowed are 50'
{ echo 'class A : public B {' && echo ' public:' && in_function 51 'bool operator==(A n)' && echo '};'; } |
  refused base/a.h '4: operator==: 51 lines, allowed are 50'
{ echo 'int f(int n) {' && echo '  auto g = [&] {' && lines 48 && echo '  };' && echo '}'; } |
  refused base/a.cpp '1: f: 52 lines, allowed are 50'
{ echo 'const F kF = {' && echo '  [](int n) {' && lines 49 && echo '  },' && echo '};'; } |
  refused base/a.cpp '1: lambda: 52 lines, allowed are 50'
{ echo 'const int kNumbers[] = {' && seq -f '    %g,' 60 && echo '};'; } | accepted base/a.cpp
{ echo 'struct A {' && seq -f '  int n%g{1};' 60 && echo '};'; } | accepted base/a.h
echo 'int f() {' | refused base/a.cpp '1: braces do not match'
