# Completes options of Ricochet's programs, as their --help lists them, and the files that they read.
_ricochet() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
    case $before in
        --out|--kernels) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
    esac
    if [[ $word == -* ]]; then
        local options
        options=$("$1" --help 2>/dev/null | grep -oE -- '(^|[ ,])--?[a-z][a-z-]*' | tr -d ' ,' | sort -u)
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    else
        local ending=toml
        [[ $1 == *-plot || $1 == *-recast ]] && ending=h5
        [[ $1 == *-surfaces ]] && ending='@(step|stp|brep|geo|msh)'
        mapfile -t COMPREPLY < <(compgen -f -X "!*.$ending" -- "$word"; compgen -d -S / -- "$word")
    fi
}
complete -o filenames -F _ricochet ricochet-contact ricochet-kernel ricochet-recast ricochet-run ricochet-plot \
    ricochet-sweep ricochet-tradeoff ricochet-batch ricochet-surfaces
