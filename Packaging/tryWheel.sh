#!/usr/bin/env bash
# Makes the wheel of the projector alone on each release of Debian, and tries it in a bare one that has a driver, numpy and what the
# gallery needs beside it. Needs root, debootstrap and the network; ten minutes and 3 GB for each.
#
#   Packaging/tryWheel.sh [bookworm] [trixie]      the wheels are left in build/packages-NAME/wheel
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -gt 0 ] || set -- bookworm trixie
root=$(mktemp -d)
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
inside() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }

for release; do
  ./quickstart wheel --release "$release"
  debootstrap --variant=minbase "$release" "$root" "$(sed -n 's/^deb \([^ ]*\).*/\1/p;q' "build/roots/$release/etc/apt/sources.list")"
  chmod 755 "$root" # mktemp's is closed to the user inside
  mount -t proc proc "$root/proc"
  inside apt-get install -y -q --no-install-recommends mesa-vulkan-drivers python3-matplotlib python3-meshio python3-scipy python3-venv
  inside useradd --create-home --shell /bin/bash user
  cp build/packages-"$release"/wheel/*.whl "$root/home/user"
  git ls-files -z Data/parts Testing/Python docs/gallery | tar --create --null --files-from=- | tar --extract --directory "$root/home/user"
  inside su - user -c 'MAMMORAY_LONG_TESTS=1 python3 Testing/Python/testWheel.py . ./*.whl'
  umount "$root/proc"
  rm -rf --one-file-system "${root:?}"/*
done
ls -l build/packages-*/wheel/*.whl
