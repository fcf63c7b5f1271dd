# Completes slamd's programs by what they say of themselves.
_slamd_help() { "$1" "${@:2}" --help 2>/dev/null; }

_slamd() {
  local cur prev words cword program=$1
  _init_completion -n = || return

  # slamd-ctl, slamd-map and slamd-simulate have commands.
  local command='' commands word
  commands=$(_slamd_help "$program" | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p')
  for word in "${words[@]:1:cword-1}"; do
    if [[ -n $commands && " $(echo $commands) " == *" $word "* ]]; then command=$word; fi
  done
  local help; help=$(_slamd_help "$program" $command)

  case $prev in
    --set)  # KEY=VALUE: the keys
      compopt -o nospace
      COMPREPLY=($(compgen -S = -W "$("$program" --print-config --set lidar.model=vlp16 2>/dev/null |
        awk '/^\[/ { gsub(/[][]/, ""); table = $0; next } NF { print table "." $1 }')" -- "$cur"))
      return ;;
    --*)  # a value: one of those listed, or a file
      local line; line=$(grep -m1 -E -- "(^|[ ,])$prev( |$)" <<<"$help")
      if [[ $line == *:{*}* ]]; then
        line=${line#*:\{}; line=${line%%\}*}
        COMPREPLY=($(compgen -W "${line//,/ }" -- "$cur"))
        return
      elif [[ $line =~ $prev\ (TEXT|FILE|DIR|PATH) ]]; then
        _filedir
        return
      elif [[ $line =~ $prev\ [A-Z] ]]; then
        return
      fi ;;
  esac
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$(grep -oE -- '(^|[ ,])--[a-z][a-z-]*' <<<"$help" | tr -d ' ,')" -- "$cur"))
  elif [[ -n $commands && -z $command ]]; then
    COMPREPLY=($(compgen -W "$commands" -- "$cur"))
  else
    _filedir
  fi
} &&
  complete -F _slamd slamd slamd-ctl slamd-status slamd-sensors slamd-replay slamd-evaluate slamd-simulate slamd-import slamd-map
