# SPDX-License-Identifier: BSD-2-Clause
# Completes verbs and options of ricochet and its programs, from their --help, the keys of --set with their values, and the
# files that they read. In a checkout: source cmake/completion.bash

# Prints "KEY=" for each key of --set, with the names of the bodies and obstacles of the scene $2, and "KEY=VALUE" for each
# value of keys that have a choice, if it is one word. $1: ricochet-contact.
_ricochet_keys() {
    local key name names
    "$1" --keys 2>/dev/null | awk -F' *[|] *' '
        /^## / { top = /Top level/; table = $0 ~ /^## `\[[^][]+\]`$/; within = table ? substr($0, 6, length($0) - 7) "." : "" }
        /^\| `/ && (top || table) && $3 != "table" {
            key = within substr($2, 2, length($2) - 2) "="
            print key
            if ($3 == "true or false") { print key "true"; print key "false" }
            for (choices = $6; match(choices, /"[^" ]+"/); choices = substr(choices, RSTART + RLENGTH))
                print key substr(choices, RSTART + 1, RLENGTH - 2)
        }' |
        while read -r key; do
            [[ $key != *.NAME.* ]] && { echo "$key"; continue; }
            names=$(sed -n "s/^ *\[${key%%.*}\.\([A-Za-z0-9_-]*\).*/\1/p" "$2" 2>/dev/null | sort -u)
            for name in $names; do echo "${key/NAME/$name}"; done
        done
}

# Completes the setting $2, "KEY" or "KEY=VALUE", of the command $1. $3: what bash takes for a word of its own, "KEY=" or nothing.
_ricochet_set() {
    local scene choices setting=${2#[\"\']}
    scene=$(printf '%s\n' "${COMP_WORDS[@]}" | grep -m 1 '\.toml$')
    choices=$(_ricochet_keys "${1%"${1##*/}"}ricochet-contact" "${scene:-/dev/null}")
    [[ $setting == *=* ]] || choices=$(grep '=$' <<<"$choices")
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$setting" | grep -v "^$setting\$")
    COMPREPLY=("${COMPREPLY[@]#"$3"}")
    [[ $setting == *=* ]] || compopt -o nospace 2>/dev/null  # the value comes next
}

# Prints the verbs, or the sources of ricochet import, from the help of the command.
_ricochet_verbs() { "$@" --help 2>/dev/null | sed -n 's/^    \([a-z]\+\) \+[^ ].*/\1/p'; }

_ricochet() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} what=${1##*/} ending endings=toml
    local command=("$1") words=("${COMP_WORDS[@]:1:COMP_CWORD-1}") choices
    if [[ $what == ricochet ]]; then
        if [[ $COMP_CWORD -eq 1 && $word != -* ]]; then
            mapfile -t COMPREPLY < <(compgen -W "$(_ricochet_verbs "$1")" -- "$word"); return
        elif [[ $COMP_CWORD -gt 1 ]]; then
            command+=("${words[0]}") what=${words[0]}
        fi
    fi
    # bash takes "=" for a word of its own, unless it is in quotes.
    if [[ $word == = && ${COMP_WORDS[COMP_CWORD-2]} == --set ]]; then
        _ricochet_set "$1" "$before=" "$before="; return
    elif [[ $before == = && ${COMP_WORDS[COMP_CWORD-3]} == --set ]]; then
        _ricochet_set "$1" "${COMP_WORDS[COMP_CWORD-2]}=$word" "${COMP_WORDS[COMP_CWORD-2]}="; return
    fi
    case $what:$before in
        *:--out|plot:--kernels|report:--kernels) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
        *:--set) _ricochet_set "$1" "$word" ""; return ;;
    esac
    if [[ $what == import ]]; then
        # The source comes first and has its own options.
        what=$(printf '%s\n' "${words[@]:1}" | grep -m 1 -xE 'mesh|calculix|matrices')
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
        mesh) endings='inp bdf nas fem med vtu vtk xdmf e exo cgns' ;;
        calculix) endings=inp ;;
        matrices) endings='mtx txt' ;;
        surfaces) endings='step stp brep geo msh' ;;
        materials|example) COMPREPLY=(); return ;;  # take names, not files
    esac
    mapfile -t COMPREPLY < <(for ending in $endings; do compgen -f -X "!*.$ending" -- "$word"; done; compgen -d -- "$word")
}
complete -o filenames -F _ricochet ricochet ricochet-contact ricochet-kernel ricochet-recast
