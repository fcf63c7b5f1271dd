#!/usr/bin/env bash
# Proves that the documents tell the truth where a program can check them: keys, links, options, programs.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
bin=${SLAMD_BIN:-build/release/bin}
status=0
pass() { echo "PASS documents: $1"; }
fail() { echo "FAIL documents: $1"; status=1; }

case "${1:-}" in
  '' | --write) ;;
  --help | -h) echo "usage: tests/system/documents.sh [--write]   (--write renews the table of docs/configuration.md)"; exit 0 ;;
  *) echo "tests/system/documents.sh: unknown argument '$1'" >&2; exit 2 ;;
esac
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The keys.
reference=docs/configuration.md
if ! "$bin/slamd-replay" --print-keys >"$scratch/printed" || [ ! -s "$scratch/printed" ]; then
  fail "slamd-replay --print-keys prints the keys"
  exit 1
fi
if [ "${1:-}" = --write ]; then
  { sed '/^| key | /,$d' "$reference"; cat "$scratch/printed"; } >"$scratch/new" && cat "$scratch/new" >"$reference"
fi
sed -n '/^| key | /,$p' "$reference" >"$scratch/written"
if diff "$scratch/written" "$scratch/printed" >"$scratch/difference"; then
  pass "$reference has all $(grep -c '^| `' "$scratch/printed") keys as the program knows them"
else
  fail "$reference differs from slamd-replay --print-keys (tests/system/documents.sh --write renews it)"
  head -n 10 "$scratch/difference"
fi

# Links to files and to headings of the same file.
mapfile -t documents < <(git ls-files '*.md')
broken=()
for document in "${documents[@]}"; do
  while IFS= read -r link; do
    case "$link" in
      http://* | https://* | mailto:*) ;;
      '#'*)
        anchor=${link#\#}
        sed -nE 's/^#+ +(.*)$/\1/p' "$document" | tr '[:upper:]' '[:lower:]' | sed -E 's/[^a-z0-9 _-]//g; s/ /-/g' |
          grep -qxF -- "$anchor" || broken+=("$document: $link") ;;
      *) [ -e "$(dirname "$document")/${link%%#*}" ] || broken+=("$document: $link") ;;
    esac
  done < <(grep -oE '\]\([^) ]+\)' "$document" | sed -E 's/^\]\(//; s/\)$//')
done
if [ ${#documents[@]} -eq 0 ]; then
  fail "there are documents"
elif [ ${#broken[@]} -eq 0 ]; then
  pass "every link of ${#documents[@]} documents leads somewhere"
else
  fail "links lead nowhere: ${broken[*]}"
fi

# Every command line of a code block names a program that is there, with options that it has.
unknown=() lines=0
while IFS= read -r line; do
  read -r -a words <<<"${line%%#*}"
  [ ${#words[@]} -gt 0 ] || continue
  program=${words[0]##*/}
  case "${words[0]}" in
    slamd-*) program=$bin/$program ;;
    ./tools/*) program=${words[0]} ;;
    *) continue ;;
  esac
  if [ ! -x "$program" ]; then unknown+=("$program"); continue; fi
  lines=$((lines + 1))
  "$program" --help >"$scratch/help" 2>&1
  if grep -qE "^  ${words[1]:-none}  " "$scratch/help"; then "$program" "${words[1]}" --help >>"$scratch/help" 2>&1; fi  # its command
  for word in "${words[@]:1}"; do
    if [[ $word =~ ^--[a-z-]+ ]] && ! grep -qE -- "(^|[ ,[])${BASH_REMATCH[0]}([],= ]|$)" "$scratch/help"; then
      unknown+=("${words[0]} ${BASH_REMATCH[0]}")
    fi
  done
done < <(awk 'FNR == 1 { code = 0 } /^```/ { code = !code; next } code' "${documents[@]}")
if [ ${#unknown[@]} -eq 0 ] && [ $lines -gt 0 ]; then
  pass "$lines command lines name programs and options that exist"
else
  fail "command lines name what does not exist (of $lines): $(printf '%s; ' "${unknown[@]}")"
fi

# Pictures stay small enough for a clone.
large=$(find docs/pictures -type f -size +300k)
if [ -d docs/pictures ] && [ -z "$large" ]; then pass "no picture is larger than 300 kB"; else fail "pictures larger than 300 kB: $large"; fi
exit $status
