# SPDX-License-Identifier: BSD-2-Clause
# Completes verbs and options of ricochet and its programs, from their --help, the keys of --set, and the files that
# they read.

# Prints the keys of --set, with the names of the bodies and obstacles of the scene $2. $1: ricochet-contact.
_ricochet_keys() {
    local key name names
    "$1" --keys 2>/dev/null | awk -F'`' '
        /^## / { top = /Top level/; table = $2 ~ /^\[[^][]+\]$/; within = table ? substr($2, 2, length($2) - 2) "." : "" }
        /^\| `/ && (top || table) && $3 !~ /^ \| table \|/ { print within $2 "=" }' |
        while read -r key; do
            [[ $key != *.NAME.* ]] && { echo "$key"; continue; }
            names=$(sed -n "s/^ *\[${key%%.*}\.\([A-Za-z0-9_-]*\).*/\1/p" "$2" 2>/dev/null | sort -u)
            for name in $names; do echo "${key/NAME/$name}"; done
        done
}

# Prints the verbs, or the sources of ricochet import, from the help of the command.
_ricochet_verbs() { "$@" --help 2>/dev/null | sed -n 's/^    \([a-z]\+\) \+[^ ].*/\1/p'; }

_ricochet() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} what=${1##*/} ending endings=toml
    local command=("$1") words=("${COMP_WORDS[@]:1:COMP_CWORD-1}") choices scene
    if [[ $what == ricochet ]]; then
        if [[ $COMP_CWORD -eq 1 && $word != -* ]]; then
            mapfile -t COMPREPLY < <(compgen -W "$(_ricochet_verbs "$1")" -- "$word"); return
        elif [[ $COMP_CWORD -gt 1 ]]; then
            command+=("${words[0]}") what=${words[0]}
        fi
    fi
    case $what:$before in
        *:--out|plot:--kernels|report:--kernels) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
        *:--set)
            scene=$(printf '%s\n' "${COMP_WORDS[@]}" | grep -m 1 '\.toml$')
            choices=$(_ricochet_keys "${1%"${1##*/}"}ricochet-contact" "${scene:-/dev/null}")
            mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
            compopt -o nospace 2>/dev/null  # the value comes next
            return ;;
    esac
    if [[ $what == import ]]; then
        # The source comes first and has its own options.
        what=$(printf '%s\n' "${words[@]:1}" | grep -m 1 -xE 'calculix|matrices')
        [[ $what ]] && command+=("$what")
        if [[ ! $what && $word != -* ]]; then
            mapfile -t COMPREPLY < <(compgen -W "$(_ricochet_verbs "${command[@]}")" -- "$word"); return
        fi
    fi
    if [[ $word == -* ]]; then
        choices=$("${command[@]}" --help 2>/dev/null | sed -n 's/^  \(-.*\)/\1/p' | sed 's/  .*//' |
            grep -oE -- '(^|[ ,])--?[a-z][a-z0-9-]*' | tr -d ' ,' | sort -u)
        mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
        return
    fi
    case $what in
        plot|report|ricochet-recast) endings=h5 ;;
        export) endings='h5 toml' ;;
        calculix) endings=inp ;;
        matrices) endings='mtx txt' ;;
        surfaces) endings='step stp brep geo msh' ;;
    esac
    mapfile -t COMPREPLY < <(for ending in $endings; do compgen -f -X "!*.$ending" -- "$word"; done; compgen -d -- "$word")
}
complete -o filenames -F _ricochet ricochet ricochet-contact ricochet-kernel ricochet-recast
