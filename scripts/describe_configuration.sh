#!/usr/bin/env bash
# Writes the table of options in docs/configuration.md anew from config/default.yaml, which a test keeps equal to the
# code. --check: only says whether it is up to date.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

page=docs/configuration.md
mark='<!-- options: scripts/describe_configuration.sh -->'

table() {
  awk '
    function name(depth, key,   i, path) { for (i = 0; i < depth; ++i) path = path section[i] "."; return path key }
    {
      match($0, /^ */); depth = RLENGTH / 2
      key = substr($0, RLENGTH + 1); sub(/:.*/, "", key)
      if ($0 ~ /:$/) {
        section[depth] = key
        if (depth == 0) printf "\n## %s\n\n| option | default | range | meaning |\n|---|---|---|---|\n", key
        next
      }
      value = $0; sub(/^[^:]*: /, "", value)
      meaning = value; sub(/ +#.*/, "", value); sub(/^[^#]*# /, "", meaning)
      range = ""
      if (match(meaning, / \([-+.0-9e]+ to [-+.0-9e]+\)$/)) {
        range = substr(meaning, RSTART + 2, RLENGTH - 3); meaning = substr(meaning, 1, RSTART - 1)
      }
      printf "| `%s` | `%s` | %s | %s |\n", name(depth, key), value, range, meaning
    }' config/default.yaml
}

updated=$(sed "\|^$mark\$|q" "$page" && table)
if [ "${1:-}" = --check ]; then
  diff -u "$page" <(printf '%s\n' "$updated") || { echo "$page is out of date: run scripts/describe_configuration.sh" >&2; exit 1; }
else
  printf '%s\n' "$updated" >"$page"
fi
