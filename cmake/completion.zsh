#compdef ricochet ricochet-contact ricochet-kernel ricochet-recast
# SPDX-License-Identifier: BSD-2-Clause
# Completion in zsh, with the answers of the functions for bash. In a checkout, after compinit: source cmake/completion.zsh

_ricochet_bash=${${(%):-%x}:A:h}/completion.bash
[[ -e $_ricochet_bash ]] || _ricochet_bash=${${(%):-%x}:A:h:h:h}/bash-completion/completions/ricochet

_ricochet() {
    local -a found
    found=("${(@f)$(bash -c '. "$1"; COMP_WORDS=("${@:2}"); COMP_CWORD=$(($# - 2)); _ricochet "$2"
        printf "%s\n" "${COMPREPLY[@]}"' bash "$_ricochet_bash" "${(@Q)words[1,CURRENT]}" 2>/dev/null)}")
    found=(${found:#})
    local -a open=(${(M)found:#*=}) folders=(${^found}(N-/)) closed
    closed=(${${found:|open}:|folders})
    compadd -S '' -- $open
    compadd -q -S / -- $folders
    compadd -- $closed
}

if [[ $funcstack[1] == _ricochet ]]; then _ricochet "$@"; else compdef _ricochet ricochet ricochet-{contact,kernel,recast}; fi
