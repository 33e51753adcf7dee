# Completes options of Ricochet's programs, as their --help lists them, and the files that they read.
_ricochet() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} choices
    case ${1##*/}:$before in
        *:--out|ricochet-plot:--kernels) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
    esac
    if [[ $word == -* ]]; then
        choices=$("$1" --help 2>/dev/null | sed -n 's/^  \(-.*\)/\1/p' | sed 's/  .*//' |
            grep -oE -- '(^|[ ,])--?[a-z][a-z-]*' | tr -d ' ,' | sort -u)
        mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
    else
        local ending endings=toml
        [[ $1 == *-plot || $1 == *-report || $1 == *-recast || $1 == *-faust ]] && endings=h5
        [[ $1 == *-import ]] && endings='inp mtx txt'
        [[ $1 == *-surfaces ]] && endings='step stp brep geo msh'
        mapfile -t COMPREPLY < <(for ending in $endings; do compgen -f -X "!*.$ending" -- "$word"; done; compgen -d -S / -- "$word")
    fi
}
complete -o filenames -F _ricochet ricochet-contact ricochet-kernel ricochet-recast ricochet-run ricochet-plot \
    ricochet-report ricochet-sweep ricochet-tradeoff ricochet-batch ricochet-surfaces ricochet-import ricochet-faust
