# What the system tests share: PASS, FAIL and SKIP lines, a scratch folder, the programs. Sourced from the repository's root.
suite=$(basename "$0" .sh)
bin=$(realpath "${SLAMD_BIN:-build/release/bin}")
status=0
pass() { echo "PASS $suite: $1"; }
fail() { echo "FAIL $suite: $1"; status=1; }
skip() { echo "SKIP $suite: $1"; }

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# check WHAT COMMAND...: passes when the command succeeds; shows what it said when not.
check() {
  local what=$1
  shift
  if "$@" >"$scratch/said" 2>&1; then
    pass "$what"
  else
    fail "$what"
    head -n 10 "$scratch/said"
  fi
}

# listens LOG: waits until the daemon that writes this log listens; a loaded machine takes a second or two.
listens() {
  for _ in $(seq 200); do grep -q ' listening for ' "$1" 2>/dev/null && return; sleep 0.1; done
  fail "slamd listens within 20 s: $(tail -n 2 "$1")"
}

# refuses WHAT CODE PATTERN COMMAND...: the command ends with CODE, prints nothing on standard output and exactly one
# line on standard error, which matches the extended regular expression.
refuses() {
  local what=$1 code=$2 pattern=$3 got=0
  shift 3
  "$@" >"$scratch/out" 2>"$scratch/err" </dev/null || got=$?
  if [ "$got" -eq "$code" ] && [ ! -s "$scratch/out" ] && [ "$(wc -l <"$scratch/err")" -eq 1 ] &&
    grep -qE -- "$pattern" "$scratch/err"; then
    pass "$what"
  else
    fail "$what: exit code $got, expected $code, and one line like /$pattern/"
    head -n 5 "$scratch/out" "$scratch/err"
  fi
}

# holds WHAT FILE FILTER: the jq filter is true of the JSON file. To jq, anything is true of an empty one.
holds() { if [ -s "$2" ]; then check "$1" jq -e "$3" "$2"; else fail "$1: $2 is empty"; fi; }

# needs PROGRAM...: ends the script with a visible skip when one is not installed.
needs() {
  local program
  for program in "$@"; do
    command -v "$program" >/dev/null || { skip "$program is not installed (tools/setup)"; exit 0; }
  done
}
