#!/usr/bin/env bash
# Makes the container of Packaging/Containerfile, at most 900 MB, and runs the demo in it as its ordinary user. The base image is made by debootstrap,
# so that no registry is needed. Needs root, buildah, debootstrap and a mirror of Debian; some minutes, 4 GB.
#
#   Packaging/container.sh [FOLDER_OF_PACKAGES [IMAGE]]     build/packages, mammoray; the image stays
#   BASE=IMAGE Packaging/container.sh ...                   on a base that is there
#
# In a sandbox without overlay file systems and namespaces: STORAGE_DRIVER=vfs BUILDAH_ISOLATION=chroot.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=$(realpath "${1:-$top/build/packages}")
image=${2:-mammoray}
die() { printf 'container.sh: %s\n' "$*" >&2; exit 1; }
compgen -G "$packages/*.deb" >/dev/null || die "expected packages in $packages (./quickstart package), found none"
command -v buildah >/dev/null || die "expected buildah (Debian: buildah), found none"
mirror=$(apt-get indextargets --format '$(REPO_URI) $(CODENAME) $(COMPONENT) $(ORIGIN)' 'Created-By: Packages' |
  awk '$2 == "bookworm" && $3 == "main" && $4 == "Debian" && !seen++ { print $1 }')
[ -n "$mirror" ] || die "expected Debian bookworm among apt's sources, found none"

if [ -z "${BASE:-}" ]; then
  BASE=localhost/debian:bookworm
  if ! buildah inspect --type image "$BASE" >/dev/null 2>&1; then
    command -v debootstrap >/dev/null || die "expected debootstrap (Debian: debootstrap), found none"
    root=$(mktemp -d)
    trap 'rm -rf --one-file-system "$root"' EXIT
    debootstrap --variant=minbase bookworm "$root" "$mirror"
    rm -rf "$root"/var/cache/apt/archives/*.deb
    container=$(buildah from scratch)
    buildah add --quiet "$container" "$root" /
    buildah config --cmd /bin/bash "$container"
    buildah commit --quiet --rm "$container" "$BASE"
  fi
fi
buildah bud --build-arg BASE="$BASE" --build-arg MIRROR="$mirror" -t "$image" -f "$top/Packaging/Containerfile" "$packages"
container=$(buildah from --pull-never "$image")
clean() { buildah rm "$container" >/dev/null; [ -z "${root:-}" ] || rm -rf --one-file-system "$root"; }
trap clean EXIT
buildah run "$container" -- sh -ec '
  [ "$(id -un)" = user ]
  if command -v cc c++; then echo "expected no compiler"; exit 1; fi
  megabytes=$(du --summarize --one-file-system --block-size=MB / 2>/dev/null | cut -f1)
  echo "container.sh: the image holds $megabytes"
  [ "${megabytes%MB}" -le 900 ]
  mammoray demo --overwrite
  test -s demo-result/report.html
  mammoray locate --result demo-result --lesion /usr/share/mammoray/victre-phantom-1/lesion.nrrd --axes-as-given -o outline.csv'
echo "container.sh: $image works"
