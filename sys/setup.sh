#!/usr/bin/env bash
# Gets what the build of embree4-sys needs onto this machine: Embree 4 with its headers, and libclang for bindgen.
# Idempotent; says in one line per step what it did; does nothing, in well under a second, when all is there.
#
#   EMBREE_DIR set        that installation is checked and used; only libclang is installed
#   Embree 4 installed    (distribution's package, /usr or /usr/local) used as it is
#   apt offers 4.x        (Debian 13, Ubuntu 24.04 and later) libembree-dev is installed
#   Debian older than 13, x86_64 with glibc
#                         the library from a Python wheel, the headers from Debian 13's package, both checked by
#                         sha256, put under sys/.embree; the library is built for SSE2 to AVX-512
#   anything else         one sentence saying what to do
#
# build.rs looks in the same places in the same order. Headers 4.3.3 and library 4.4.0 were tried together: every
# geometry kind and query the tracer uses works.
set -euo pipefail
export LC_ALL=C DEBIAN_FRONTEND=noninteractive

readonly WHEEL=embreex==4.4.0.post1
readonly WHEEL_SHA256=2cd0f7d5c6342e6247e31f700761689cae7829454d8c6de0c41e62124a023e1f
readonly DEB=libembree-dev=4.3.3+dfsg-1
readonly DEB_SHA256=674a8b3d1a00612f46730da29f4cc146267b4917bbf0242113d0568429e78726
readonly DEB_SUITE=trixie
readonly KEYRING=/usr/share/keyrings/debian-archive-keyring.gpg

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
readonly here
readonly prefix=$here/.embree
scratch=

say() { printf 'setup: %s\n' "$*"; }
die() { printf 'setup: %s\n' "$*" >&2; exit 1; }
have() { command -v "$1" >/dev/null 2>&1; }

# True if one of the paths exists; called with unquoted globs.
any() { local f; for f in "$@"; do [ -e "$f" ] && return 0; done; return 1; }

# A temporary directory beside the target, so that the last step is a rename; removed however the script ends.
make_scratch() {
    [ -n "$scratch" ] && return 0
    scratch=$(mktemp -d --suffix=.tmp "$here/.embree-XXXXXX")
    trap 'rm -rf "$scratch"' EXIT
    trap 'exit 130' INT TERM HUP
}

can_be_root() { [ "$(id -u)" -eq 0 ] || { have sudo && { sudo -n true 2>/dev/null || [ -t 0 ]; }; }; }

as_root() { if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi; }

# Runs a command, showing its output only if it fails; $1 says what it was for.
quietly() {
    local what=$1 log; shift
    log=$(mktemp)
    if "$@" >"$log" 2>&1; then rm -f "$log"; return 0; fi
    cat "$log" >&2; rm -f "$log"
    die "$what failed: '$*'"
}

updated=
apt_update() {
    [ -n "$updated" ] && return 0
    updated=1
    quietly "reading the package lists" as_root apt-get -q update
}

apt_install() {
    have apt-get || die "no apt-get here: install $* by this system's own means, then run sys/setup.sh again"
    can_be_root || die "neither root nor sudo here: ask an administrator for 'apt-get install $*', then run sys/setup.sh again"
    apt_update
    quietly "installing $*" as_root apt-get -qy --no-install-recommends install "$@"
    say "installed $*"
}

# The version in rtcore_config.h of an include directory; empty if there is none.
embree_version() {
    [ -r "$1/embree4/rtcore_config.h" ] || return 0
    sed -n 's/^#define RTC_VERSION_STRING "\(.*\)".*/\1/p' "$1/embree4/rtcore_config.h"
}

# An installation prefix holds Embree 4 if it has the headers and the library to link by.
holds_embree() {
    case $(embree_version "$1/include") in 4.*) ;; *) return 1 ;; esac
    any "$1"/lib/libembree4.so "$1"/lib64/libembree4.so "$1"/lib/*-linux-gnu/libembree4.so "$1"/lib/libembree4.dylib
}

prefix_is_whole() {
    [ -f "$prefix/sha256sums" ] && holds_embree "$prefix" &&
        (cd "$prefix" && sha256sum --check --status --strict sha256sums)
}

# URI and keyring of the system's own Debian archive, from deb822 or one-line sources: "URI KEYRING".
debian_archive() {
    local codename
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    [ -n "$codename" ] || return 0
    {
        find /etc/apt/sources.list.d -name '*.sources' -exec cat {} + -exec echo \; 2>/dev/null | awk -v suite="$codename" -v RS= '
            { uri = key = ""; hit = deb = 0; n = split($0, line, "\n")
              for (i = 1; i <= n; i++) {
                  m = split(line[i], w, /[ \t]+/); name = tolower(w[1])
                  for (j = 2; j <= m; j++) {
                      if (name == "types:" && w[j] == "deb") deb = 1
                      if (name == "suites:" && w[j] == suite) hit = 1
                      if (name == "uris:" && uri == "") uri = w[j]
                      if (name == "signed-by:" && w[j] ~ /^\//) key = w[j]
                  }
              }
              if (deb && hit && uri != "") print uri, key }'
        cat /etc/apt/sources.list $(find /etc/apt/sources.list.d -name '*.list' 2>/dev/null) 2>/dev/null | awk -v suite="$codename" '
            $1 == "deb" { key = ""
              if (match($0, /signed-by=[^] \t]+/)) key = substr($0, RSTART + 10, RLENGTH - 10)
              sub(/\[[^]]*\][ \t]*/, "")
              if ($3 == suite) print $2, key }'
    } | grep -v security | head -n 1
}

find_pip() {
    local pip
    for pip in "python3 -m pip" pip3 pip; do
        $pip --version >/dev/null 2>&1 && { echo "$pip"; return 0; }
    done
    return 0
}

# The library and its own libtbb, out of the wheel into $scratch/new/lib. A wheel is a zip.
fetch_library() {
    local pip wheel
    pip=$(find_pip)
    if [ -z "$pip" ]; then apt_install python3-pip; pip=$(find_pip); fi
    [ -n "$pip" ] || die "no working pip: install one, then run sys/setup.sh again"
    quietly "fetching the library" $pip --quiet --disable-pip-version-check --no-cache-dir download --no-deps \
        --only-binary=:all: --python-version 311 --implementation cp --abi cp311 \
        --platform manylinux_2_28_x86_64 --dest "$scratch" "$WHEEL"
    wheel=$(echo "$scratch"/embreex-*.whl)
    echo "$WHEEL_SHA256  $wheel" | sha256sum --check --status ||
        die "the wheel $WHEEL fetched is not the one expected (sha256); set EMBREE_DIR to an Embree 4 installation"
    quietly "unpacking the wheel" python3 -m zipfile -e "$wheel" "$scratch/wheel"
    mkdir -p "$scratch/new/lib"
    mv "$scratch"/wheel/embreex.libs/* "$scratch/new/lib/"
    # The library's own name (soname) has a hash in it. The linker records that name in every program, and finds
    # the file through its rpath: a symbolic link to link by is enough, and nothing in the file need be changed.
    (cd "$scratch/new/lib" && ln -s libembree4-*.so.4 libembree4.so)
    say "fetched the library ($WHEEL)"
}

# The headers of Debian 13's package into $scratch/new/include. The suite is read through package lists of our
# own, from the machine's own mirror: the system's apt is neither changed nor asked to mix releases.
fetch_headers() {
    local uri key apt deb
    read -r uri key <<<"$(debian_archive)" || true
    [ -n "${uri:-}" ] ||
        die "no Debian archive among this system's apt sources: install Embree 4 yourself and set EMBREE_DIR to it"
    apt=$scratch/apt
    mkdir -p "$apt/lists/partial" "$apt/archives/partial"
    echo "deb [arch=amd64 signed-by=${key:-$KEYRING}] $uri $DEB_SUITE main" >"$apt/sources.list"
    local options=(-q -o "Dir::Etc::sourcelist=$apt/sources.list" -o Dir::Etc::sourceparts=- -o Dir::Etc::preferencesparts=-
        -o Dir::Etc::preferences=- -o "Dir::State::lists=$apt/lists" -o "Dir::Cache::archives=$apt/archives"
        -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root -o Acquire::Languages=none
        -o APT::Get::List-Cleanup=0 -o APT::Architecture=amd64)
    (cd "$apt" && apt-get "${options[@]}" update && apt-get "${options[@]}" download "$DEB") >"$apt/log" 2>&1 || {
        cat "$apt/log" >&2
        die "this system's apt mirror does not serve $DEB ($DEB_SUITE): install Embree 4 yourself and set EMBREE_DIR to it"
    }
    deb=$(echo "$apt"/libembree-dev_*.deb)
    echo "$DEB_SHA256  $deb" | sha256sum --check --status ||
        die "the package $DEB fetched is not the one expected (sha256); set EMBREE_DIR to an Embree 4 installation"
    quietly "unpacking the headers" dpkg -x "$deb" "$scratch/deb"
    mkdir -p "$scratch/new/include"
    mv "$scratch/deb/usr/include/embree4" "$scratch/new/include/"
    say "fetched the headers ($DEB)"
}

install_prefix() {
    [ "$(uname -s)-$(uname -m)" = Linux-x86_64 ] && getconf GNU_LIBC_VERSION >/dev/null 2>&1 ||
        die "no ready-made Embree 4 for $(uname -s) on $(uname -m): install it yourself and set EMBREE_DIR to it"
    have apt-get && have dpkg ||
        die "no apt here to fetch the headers with: install Embree 4 (embree-devel or the like), or set EMBREE_DIR to one"
    make_scratch
    fetch_library
    fetch_headers
    (cd "$scratch/new" && find . -type f ! -name sha256sums -print0 | sort -z | xargs -0 sha256sum >sha256sums)
    [ -e "$prefix" ] && mv -T "$prefix" "$scratch/old"
    mv -T "$scratch/new" "$prefix"
    say "Embree 4 is now in $prefix"
}

setup_embree() {
    if [ -n "${EMBREE_DIR:-}" ]; then
        holds_embree "$EMBREE_DIR" ||
            die "EMBREE_DIR=$EMBREE_DIR holds no Embree 4: include/embree4/rtcore.h and lib/libembree4.so are wanted there"
        say "Embree $(embree_version "$EMBREE_DIR/include") in EMBREE_DIR=$EMBREE_DIR"
        return
    fi
    if prefix_is_whole; then say "Embree 4 is in $prefix"; return; fi
    local dir
    for dir in /usr /usr/local; do
        if holds_embree "$dir"; then say "Embree $(embree_version "$dir/include") is in $dir"; return; fi
    done
    if apt_has_embree4; then apt_install libembree-dev; else install_prefix; fi
}

apt_candidate() { apt-cache policy libembree-dev 2>/dev/null | sed -n 's/^ *Candidate: *\([0-9].*\)/\1/p'; }

apt_has_embree4() {
    have apt-get || return 1
    # No candidate at all: this machine's lists have never been read.
    if [ -z "$(apt_candidate)" ] && can_be_root; then apt_update; fi
    case $(apt_candidate) in 4.*) return 0 ;; *) return 1 ;; esac
}

# bindgen needs the shared library and the compiler's own headers (stddef.h), which come apart in Debian.
has_libclang() {
    if [ -n "${LIBCLANG_PATH:-}" ]; then any "$LIBCLANG_PATH" && return 0; fi
    any /usr/lib/llvm-*/lib/libclang.so* /usr/lib/llvm-*/lib/libclang-[0-9]* /usr/lib/*-linux-gnu/libclang.so* \
        /usr/lib/*-linux-gnu/libclang-[0-9]* /usr/lib64/libclang.so* /usr/lib64/llvm*/lib*/libclang.so* \
        /usr/lib/libclang.so* /usr/local/lib/libclang.so* || return 1
    any /usr/lib/llvm-*/lib/clang/*/include/stddef.h /usr/lib/clang/*/include/stddef.h \
        /usr/lib64/clang/*/include/stddef.h /usr/local/lib/clang/*/include/stddef.h
}

setup_libclang() {
    if has_libclang; then say "libclang is there"; else apt_install libclang-dev; fi
}

# Rust links through the C compiler driver.
setup_linker() {
    if have cc; then say "a C compiler driver (cc) is there"; else apt_install gcc libc6-dev; fi
}

setup_linker
setup_libclang
setup_embree
