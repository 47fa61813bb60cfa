"""zsh and fish offer what bash is offered: `completion.py KNAP REPOSITORY DIRECTORY`. Exit code 77: neither shell is here."""
import os
import pathlib
import shutil
import subprocess
import sys

knap, tools, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve() / "tools/package", pathlib.Path(sys.argv[3])
shutil.rmtree(folder, ignore_errors=True)
for place, file in (("bin/knap", knap), ("share/bash-completion/completions/knap", tools / "knap.bash")):  # as packages install them
    (folder / place).parent.mkdir(parents=True)
    shutil.copy2(file, folder / place)
environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}"}


def printed(*command):
    return subprocess.run(command, env=environment, cwd=folder, check=True, capture_output=True, text=True).stdout.split()


def by_bash(*words):
    return printed("bash", tools / "knap.bash", "offer", str(len(words)), *words)


def by_fish(*words):
    return printed("fish", "--no-config", "-c", f"source '{tools}/knap.fish'; complete -C '{' '.join(words)}'")


def by_zsh(*words):
    """compadd prints what the editor would show."""
    return printed("zsh", "-f", "-c", "compadd() { while [[ $1 == -* ]]; do [[ $1 == -S ]] && shift; shift; done; (( $# )) && print -l -- $@ }; "
                   f"words=({' '.join(words)}); CURRENT={len(words)}; source '{tools}/_knap'; true")


(folder / "rock.toml").write_text("[material.mica]\nE = 1\n[interface.granite-mica]\nsigma_c = 1\n[interface.granite-mica.scatter]\n")
shells = [shell for shell in (by_fish, by_zsh) if shutil.which(shell.__name__.removeprefix("by_"))]
for words, offered in ((("knap", "sw"), ["sweep"]), (("knap", "run", "edge_cracked_block_f"), ["edge_cracked_block_fine"]),
                       (("knap", "run", "-s", "mesh.siz"), ["mesh.size="]),
                       (("knap", "run", "-s", "interface.default.G"), ["interface.default.G_c="]),
                       (("knap", "run", "rock.toml", "-s", "interface.granite-mica.sig"), ["interface.granite-mica.sigma_c="]),
                       (("knap", "run", "rock.toml", "-s", "material.mica.de"), ["material.mica.density="]),
                       (("knap", "render", "--show", "stress_y"), ["stress_yy"]),
                       (("knap", "lcp", "x", "--solver", "lem"), ["lemke"]), (("knap", "run", "-o", "sh"), ["share/"])):
    for shell in [by_bash, *shells]: assert shell(*words) == offered, (shell.__name__, words, shell(*words))
if not shells:
    print("skipped: there is neither zsh nor fish (Debian: zsh, fish)")
    sys.exit(77)
print("the same for", *(shell.__name__.removeprefix("by_") for shell in shells))
