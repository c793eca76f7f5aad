#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-2-Clause
# Sets Gaiter up on Debian 12 and runs the paper's scene or the tests. See ./quickstart.sh help.
set -euo pipefail

say() { printf 'gaiter: %s\n' "$*"; }
fail() { printf 'gaiter: %s\n' "$*" >&2; exit 1; }

usage() {
  cat <<'TEXT'
Usage: ./quickstart.sh run|test|build|help
  run    set up, build, solve the paper's scene on 2 ranks and write paper.h5 into the current folder
  test   set up, build and run all tests
  build  set up and build into build/
  help   print this
Setting up means: install with apt what is missing (Debian 12; as root or through sudo). With PETSC_DIR (and
PETSC_ARCH) set, that PETSc is used and none is installed. Running it again does only what is left to do.
TEXT
}

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$here/build
cores=$(nproc)

packages=(
  g++ cmake make pkg-config
  libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libopenblas0-serial
  zlib1g-dev libudunits2-dev libspdlog-dev libfmt-dev libboost-dev
  libgtest-dev libbenchmark-dev
  python3 python3-numpy python3-xarray python3-h5netcdf python3-h5py python3-matplotlib python3-vtk9
)
# Debian's PETSc brings a SLEPc and a MUMPS that fit it; a PETSc of your own brings its own.
if [[ -z ${PETSC_DIR:-} ]]; then
  packages+=(petsc-dev slepc-dev libmumps-dev)
fi

missing_packages() {
  local package
  for package in "${packages[@]}"; do
    if [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true) != installed ]]; then
      printf '%s\n' "$package"
    fi
  done
}

as_root() {
  if ((EUID == 0)); then
    "$@"
  else
    sudo "$@"
  fi
}

install_missing() {
  command -v dpkg-query >/dev/null || fail "this script needs Debian 12 or a system that has its packages (no dpkg here)"
  local missing
  mapfile -t missing < <(missing_packages)
  if ((${#missing[@]} == 0)); then
    return
  fi
  say "installing with apt: ${missing[*]}"
  ((EUID == 0)) || command -v sudo >/dev/null || fail "root rights are needed for that: run as root, or install sudo"
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0)
  local install=("${apt[@]}" install --no-install-recommends "${missing[@]}")
  # The lists of a fresh container are empty; old ones may name versions that are gone.
  if ! as_root "${install[@]}" --simulate >/dev/null 2>&1 || ! as_root "${install[@]}"; then
    say "updating apt's lists"
    as_root "${apt[@]}" update || fail "apt-get update failed"
    as_root "${install[@]}" || fail "apt-get install failed"
  fi
}

# build_it [TARGET]
build_it() {
  install_missing
  say "configuring and building in $build ($cores at a time)"
  cmake -S "$here" -B "$build" -DCMAKE_BUILD_TYPE=Release || fail "configuring failed"
  cmake --build "$build" --parallel "$cores" --target "${1:-all}" || fail "building failed"
}

# Open MPI refuses to run as root, or with more ranks than it counts cores, unless told otherwise.
allow_two_ranks() {
  if ((EUID == 0)); then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  fi
  if ! mpirun -n 2 true >/dev/null 2>&1; then
    export OMPI_MCA_rmaps_base_oversubscribe=1
  fi
}

case ${1:-help} in
  run)
    build_it gaiter
    allow_two_ranks
    say "solving options/scenes/paper.yaml on 2 ranks"
    mpirun -n 2 "$build/bin/gaiter" solve -options_file "$here/options/scenes/paper.yaml" -output paper.h5 ||
      fail "solving ended with exit code $?"
    [[ -f paper.h5 ]] || fail "no paper.h5 was written"
    say "results are in $PWD/paper.h5"
    ;;
  test)
    build_it
    say "testing"
    ctest --test-dir "$build" --output-on-failure --parallel "$cores" || fail "some tests failed"
    ;;
  build) build_it ;;
  help | -h | --help) usage ;;
  *)
    usage >&2
    fail "unknown word: $1"
    ;;
esac
