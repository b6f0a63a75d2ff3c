# Sourced by the scripts beside it: strict mode, where the repository is, and the compiler cache.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
cd "$root"

# One cache for every clone of Glint on this machine: paths are hashed relative to the clone.
cache_home="${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}"
export CCACHE_DIR="${CCACHE_DIR:-$cache_home/ccache}"
export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$root}"
export CCACHE_NOHASHDIR="${CCACHE_NOHASHDIR:-1}"

say() { printf '\n== %s\n' "$*"; }

# As many compilers at once as there are cores, but no more than memory holds (some files take 2 GB).
jobs() {
  local cores memory_gib
  cores="$(nproc)"
  memory_gib="$(awk '/^MemAvailable:/ { print int($2 / 1048576) }' /proc/meminfo)"
  local limit=$((memory_gib / 2))
  ((limit < 1)) && limit=1
  echo $((cores < limit ? cores : limit))
}

# build_release [TARGET...]: everything if no target is named.
build_release() {
  say "Building (preset release)"
  cmake --preset release
  cmake --build --preset release --parallel "$(jobs)" ${*:+--target "$@"}
}
