#!/bin/sh
# Says in one sentence what the machine lacks to build gmr, and stops.
python=${PYTHON:-python3}

stop() {
    echo "gmr: $1" >&2
    exit 1
}

case $(uname -s) in
    Darwin)
        compiler="run 'xcode-select --install'"
        rust="run 'brew install rustup && rustup default stable' (or follow rustup.rs)"
        python_way="run 'brew install python'" ;;
    *)
        if command -v dnf >/dev/null 2>&1; then
            compiler="run 'sudo dnf install gcc'"
            rust="run 'sudo dnf install rustup && rustup-init -y' and open a new shell"
            python_way="run 'sudo dnf install python3'"
        elif command -v pacman >/dev/null 2>&1; then
            compiler="run 'sudo pacman -S gcc'"
            rust="run 'sudo pacman -S rustup && rustup default stable'"
            python_way="run 'sudo pacman -S python'"
        else
            compiler="run 'sudo apt install build-essential'"
            rust="install it with rustup (rustup.rs), since Debian's and Ubuntu's own may be too old"
            python_way="run 'sudo apt install python3 python3-venv'"
        fi ;;
esac

command -v "$python" >/dev/null 2>&1 || stop "Python 3.11 or newer is missing: $python_way."
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    stop "$("$python" --version) is too old, 3.11 or newer is needed: $python_way, or name another one with 'make PYTHON=python3.12'."
"$python" -c 'import ensurepip, venv' 2>/dev/null || stop "Python's venv module is missing: $python_way."
command -v cargo >/dev/null 2>&1 || stop "the Rust compiler is missing: $rust."
oldest=89
minor=$(rustc --version | sed -E 's/^rustc 1\.([0-9]+).*/\1/')
[ "$minor" -ge "$oldest" ] 2>/dev/null || stop "$(rustc --version) is too old, 1.$oldest or newer is needed: run 'rustup update stable'."
command -v cc >/dev/null 2>&1 || stop "a C compiler (Rust links with it) is missing: $compiler."
