#!/usr/bin/env bash
# Makes what a release consists of, in build/releases/VERSION, from what is committed:
#
#   ./quickstart release VERSION [STEP...]     all steps, or some of them, in this order:
#
#   source         the sources, packed twice with the same bytes
#   packages       Debian packages of this release of Debian and, as root, of the other one, without lintian's errors and warnings
#   wheel          the projector for pip, on the same ones
#   container      an image of the packages, where buildah, podman or docker can make one
#   documentation  the site
#   notes          what the changelog says
#   sbom           of what all of this is made (SPDX 2.3)
#   sums           SHA256SUMS of all the files
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
say() { printf 'release.sh: %s\n' "$*"; }
die() { printf 'release.sh: %s\n' "$*" >&2; exit 1; }
steps=(source packages wheel container documentation notes sbom sums)
version=${1-}
version=${version#v}
project=$(sed -n 's/^project(MammoRay VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ "$version" = "$project" ] || die "expected the version in CMakeLists.txt, $project, found '$version'"
docs/develop/releaseNotes.py --check
git rev-parse --git-dir >/dev/null 2>&1 || die "expected a clone of the repository, found a folder without git"
[ -z "$(git status --porcelain)" ] || die "expected everything committed, found changes: $(git status --porcelain | head -3 | tr '\n' ' ')"
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
out=build/releases/$version
mkdir -p "$out"
here=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)

# Takes a clone.
archive() { git -C "$1" -c tar.umask=0022 archive --format=tar --prefix="mammoray-$version/" HEAD | gzip -9 --no-name; }

source() {
  local second
  second=$(mktemp -d)
  git clone --quiet . "$second"
  archive . >"$out/mammoray-$version.tar.gz"
  archive "$second" | cmp - "$out/mammoray-$version.tar.gz" || die "expected the same bytes of a second clone"
  rm -rf "$second"
}

# Takes what quickstart is to make on each release of Debian, in build/packages, and a pattern of the files.
on_each_release() {
  local release
  for release in bookworm trixie; do
    if [ "$release" = "$here" ]; then
      ./quickstart "$1"
      rm -rf "build/packages-$release"
      cp -r build/packages "build/packages-$release"
    elif [ "$(id -u)" = 0 ]; then
      ./quickstart "$1" --release $release
    else
      say "no $1 for $release: expected root, who may make another root, found $(id -un)"
      continue
    fi
    mkdir -p "$out/$release"
    find "build/packages-$release" -name "$2" -exec cp --target-directory="$out/$release" {} +
  done
}

packages() { on_each_release package '*.deb'; }
wheel() { on_each_release wheel '*.whl'; }

container() {
  local tool image=mammoray:$version file=$out/mammoray-$version-container.tar
  rm -f "$file"
  if command -v buildah >/dev/null; then
    Packaging/container.sh build/packages "$image"
    buildah push --quiet "$image" "oci-archive:$file:$image"
    return
  fi
  for tool in podman docker; do
    if "$tool" info >/dev/null 2>&1; then
      "$tool" build --tag "$image" --file Packaging/Containerfile build/packages
      "$tool" save --output "$file" "$image"
      return
    fi
  done
  say "no container image: expected buildah, podman or a running docker, found none"
}

documentation() {
  ./quickstart docs
  tar --create --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --directory build docs |
    gzip -9 --no-name >"$out/mammoray-$version-documentation.tar.gz"
}

notes() { docs/develop/releaseNotes.py "$version" >"$out/release-notes.md"; }
sbom() { Packaging/sbom.py "$version" "$out" >"$out/mammoray-$version.spdx.json"; }
sums() { (cd "$out" && find . -type f ! -name SHA256SUMS -printf '%P\0' | sort --zero-terminated | xargs --null sha256sum >SHA256SUMS); }

shift
wanted=("$@")
[ $# -gt 0 ] || wanted=("${steps[@]}")
for step in "${wanted[@]}"; do
  [[ " ${steps[*]} " == *" $step "* ]] || die "expected steps among ${steps[*]}, found $step"
done
for step in "${wanted[@]}"; do
  say "$step"
  "$step"
done
say "done: $(cd "$out" && find . -type f -printf '%P ' )"
