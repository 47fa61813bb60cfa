"""zsh and fish offer what bash is offered, as installed and from a clone: `completion.py KNAP REPOSITORY DIRECTORY`. Exit code 77: neither shell is here."""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

knap, tools, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve() / "tools/package", pathlib.Path(sys.argv[3]).resolve()
shutil.rmtree(folder, ignore_errors=True)
fish_file, zsh_file = folder / "share/fish/vendor_completions.d/knap.fish", folder / "share/zsh/vendor-completions/_knap"
for place, file in (("bin/knap", knap), ("share/bash-completion/completions/knap", tools / "knap.bash"),
                    (fish_file.relative_to(folder), tools / "knap.fish"), (zsh_file.relative_to(folder), tools / "_knap")):  # as packages install them
    (folder / place).parent.mkdir(parents=True)
    shutil.copy2(file, folder / place)
environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}


def printed(*command):
    return subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True, text=True).stdout.split()


def by_bash(*words):
    return printed("bash", tools / "knap.bash", "offer", str(len(words)), *words)


def by_fish(*words, file=fish_file):
    return printed("fish", "--no-config", "-c", f"source '{file}'; complete -C '{' '.join(words)}'")


def by_zsh(*words, file=zsh_file):
    """compadd prints what the editor would show."""
    return printed("zsh", "-f", "-c", "compadd() { while [[ $1 == -* ]]; do [[ $1 == -S ]] && shift; shift; done; (( $# )) && print -l -- $@ }; "
                   f"words=({shlex.join(words)}); CURRENT={len(words)}; source '{file}'; true")


(folder / "rock.toml").write_text("[material.mica]\nE = 1\n[interface.granite-mica]\nsigma_c = 1\n[interface.granite-mica.scatter]\n")
shells = [shell for shell in (by_fish, by_zsh) if shutil.which(shell.__name__.removeprefix("by_"))]
for words, offered in ((("knap", "sw"), ["sweep"]), (("knap", "run", "edge_cracked_block_f"), ["edge_cracked_block_fine"]),
                       (("knap", "run", "-s", "mesh.siz"), ["mesh.size="]),
                       (("knap", "run", "-s", "interface.default.G_c"), ["interface.default.G_c="]),
                       (("knap", "run", "rock.toml", "-s", "interface.granite-mica.sig"), ["interface.granite-mica.sigma_c="]),
                       (("knap", "run", "rock.toml", "-s", "material.mica.de"), ["material.mica.density="]),
                       (("knap", "render", "--show", "stress_y"), ["stress_yy"]),
                       (("knap", "new", "--from", "edge_cracked_block_f"), ["edge_cracked_block_fine"]), (("knap", "render", "sh"), ["share/"]),
                       (("knap", "run", "-s", "time.bulk=im"), ["time.bulk=implicit"]),
                       (("knap", "run", "-s", "output.report="), ["output.report=true", "output.report=false"]),
                       (("knap", "run", "-s", "interface.default.coupling=n"), ["interface.default.coupling=norm"]),
                       (("knap", "sweep", "-s", "figure[0].colour=slip,b"), ["figure[0].colour=slip,beta", "figure[0].colour=slip,break_time"]),
                       (("knap", "lcp", "x", "--solver", "lem"), ["lemke"]), (("knap", "run", "-o", "sh"), ["share/"])):
    for shell in [by_bash, *shells]: assert sorted(shell(*words)) == sorted(offered), (shell.__name__, words, shell(*words))
assert by_bash("knap", "run", "-s", "time.bulk", "=", "im") == ["implicit"]  # as readline of bash parts the words
shutil.rmtree(folder / "share/bash-completion")  # a clone: the files of the shells are beside that of bash
for shell, file in ((by_fish, "knap.fish"), (by_zsh, "_knap")):
    if shell in shells: assert shell("knap", "sw", file=tools / file) == ["sweep"], (shell.__name__, file)
if not shells:
    print("skipped: there is neither zsh nor fish (Debian: zsh, fish)")
    sys.exit(77)
print("the same for", *(shell.__name__.removeprefix("by_") for shell in shells))
