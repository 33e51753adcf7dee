# SPDX-License-Identifier: BSD-2-Clause
# Completion in fish, with the answers of the functions for bash. In a checkout: source cmake/completion.fish

set -g __ricochet_bash (path resolve (status dirname)/completion.bash)
test -e $__ricochet_bash; or set -g __ricochet_bash (path resolve (status dirname)/../../bash-completion/completions/ricochet)

function __ricochet_complete
    set -l words (commandline -opc) (commandline -ct)
    bash -c '. "$1"; COMP_WORDS=("${@:2}"); COMP_CWORD=$(($# - 2)); _ricochet "$2"; printf "%s\n" "${COMPREPLY[@]}"' \
        bash $__ricochet_bash $words 2>/dev/null | string match -v ""
end

for program in ricochet ricochet-contact ricochet-kernel ricochet-recast
    complete -c $program -f -a "(__ricochet_complete)"
end
