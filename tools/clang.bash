# For the tools, which source it: clang_version PROGRAM prints the newest version of it that is installed, from 16 on; fails where there is none.
# Clang 14 does not know the ranges of the standard library that is beside it.
clang_version() {
    local version
    for version in 19 18 17 16; do
        if command -v "$1-$version" >/dev/null; then
            echo "$version"
            return
        fi
    done
    return 1
}
