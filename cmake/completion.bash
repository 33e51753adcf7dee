# Completes options of Ricochet's programs, as their --help lists them, the keys that --set takes, and the files that they read.

# Keys that --set may name, for the bodies and obstacles of the scene $2 by their names. $1: ricochet-contact.
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

_ricochet() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} choices scene command=
    case ${1##*/}:$before in
        *:--out|ricochet-plot:--kernels|ricochet-report:--kernels) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
        *:--set)
            scene=$(printf '%s\n' "${COMP_WORDS[@]}" | grep -m 1 '\.toml$')
            choices=$(_ricochet_keys "${1%"${1##*/}"}ricochet-contact" "${scene:-/dev/null}")
            mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
            compopt -o nospace 2>/dev/null  # the value comes next
            return ;;
    esac
    # ricochet-import takes a command first, which has options of its own.
    [[ $1 == *-import ]] && command=$(printf '%s\n' "${COMP_WORDS[@]:1:COMP_CWORD-1}" | grep -m 1 -xE 'calculix|matrices')
    if [[ $word == -* ]]; then
        choices=$("$1" $command --help 2>/dev/null | sed -n 's/^  \(-.*\)/\1/p' | sed 's/  .*//' |
            grep -oE -- '(^|[ ,])--?[a-z][a-z-]*' | tr -d ' ,' | sort -u)
        mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
    elif [[ $1 == *-import && ! $command ]]; then
        mapfile -t COMPREPLY < <(compgen -W "calculix matrices" -- "$word")
    else
        local ending endings=toml
        [[ $1 == *-plot || $1 == *-report || $1 == *-recast || $1 == *-faust ]] && endings=h5
        [[ $command == calculix ]] && endings=inp
        [[ $command == matrices ]] && endings='mtx txt'
        [[ $1 == *-surfaces ]] && endings='step stp brep geo msh'
        mapfile -t COMPREPLY < <(for ending in $endings; do compgen -f -X "!*.$ending" -- "$word"; done; compgen -d -- "$word")
    fi
}
complete -o filenames -F _ricochet ricochet-contact ricochet-kernel ricochet-recast ricochet-run ricochet-plot \
    ricochet-report ricochet-sweep ricochet-tradeoff ricochet-batch ricochet-surfaces ricochet-import ricochet-faust
