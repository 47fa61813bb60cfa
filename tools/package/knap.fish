# Completion of knap for fish: what bash is offered, by the same script (knap.bash), which is beside this file or where packages have it.
set -g __knap_folder (path dirname (path resolve (status filename)))
function __knap_offer
    set -l words (commandline -opc) (commandline -ct)
    set -l prefix (path dirname (path dirname (path resolve (command -v $words[1]))))
    for script in $__knap_folder/knap.bash $prefix/share/bash-completion/completions/knap /usr/share/bash-completion/completions/knap
        if test -r $script
            bash $script offer (count $words) $words 2>/dev/null
            return
        end
    end
end
complete -c knap -f -a '(__knap_offer)'
