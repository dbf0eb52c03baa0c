#!/usr/bin/env bash
# Installs the packages in a bare Debian, which debootstrap makes, and uses them there as an ordinary user: the demo with the
# package mammoray alone; the manual, the completion, Python, the desktop application, Octave; then, with libmammoray-dev
# and the compiler that it brings, a C++ program; then the projector alone, and the plugin in ParaView. Needs root,
# debootstrap and the network; some minutes, 6 GB.
#
#   Packaging/try.sh [FOLDER_OF_PACKAGES [ROOT]]     build/packages, and a new folder that is removed at the end
#   RELEASE=trixie Packaging/try.sh ...              on Debian 13
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
release=${RELEASE:-bookworm}
packages=$(realpath "${1:-$top/build/packages}")
die() { printf 'try.sh: %s\n' "$*" >&2; exit 1; }
compgen -G "$packages/*.deb" >/dev/null || die "expected packages in $packages (./quickstart package), found none"
[ "$(id -u)" = 0 ] || die "expected root, who may make another root, found $(id -un)"

mirror=$(apt-get indextargets --format '$(REPO_URI) $(CODENAME) $(COMPONENT) $(ORIGIN)' 'Created-By: Packages' |
  awk '$2 ~ /^(bookworm|trixie)$/ && $3 == "main" && $4 == "Debian" && !seen++ { print $1 }')
root=${2:-}
if [ -z "$root" ]; then
  root=$(mktemp -d)
  trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
else
  trap 'umount "$root/proc" 2>/dev/null || true' EXIT
fi
if [ ! -x "$root/usr/bin/apt-get" ]; then
  command -v debootstrap >/dev/null || die "expected debootstrap (Debian: debootstrap), found none"
  debootstrap --variant=minbase "$release" "$root" "${mirror:-http://deb.debian.org/debian}"
fi
chmod 755 "$root" # mktemp's is closed to the user inside
echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/try" # need not survive a loss of power
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
rm -rf "$root/packages"
cp -r "$packages" "$root/packages"
inside() { chroot "$root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
inside apt-get update -q
if [ "$release" = bookworm ]; then
  echo "deb $mirror bookworm-backports main" >"$root/etc/apt/sources.list.d/backports.list"
  inside apt-get update -q
  # Again it would mix Mesa's libraries of both.
  inside dpkg -s mesa-vulkan-drivers >/dev/null 2>&1 ||
    inside apt-get install -y -q --no-install-recommends -t bookworm-backports mesa-vulkan-drivers
else
  inside apt-get install -y -q --no-install-recommends mesa-vulkan-drivers
fi
# Takes patterns of packages' names.
install() { (cd "$root/packages" && inside apt-get install -y -q --no-install-recommends $(printf '/packages/%s ' $1)); }
install 'mammoray_*.deb'
inside sh -c 'id user >/dev/null 2>&1 || useradd --create-home --shell /bin/bash user'
as_user() { inside su - user -c "$1"; }

as_user 'if command -v cc c++; then echo "expected no compiler"; exit 1; fi'
as_user 'time mammoray demo --overwrite && test -s demo-result/report.html'
as_user 'mammoray locate --result demo-result --lesion /usr/share/mammoray/victre-phantom-1/lesion.nrrd --axes-as-given --overwrite -o outline.csv && test -s outline.csv'
as_user 'zgrep -q "mammoray.-register" /usr/share/man/man1/mammoray.1.gz'
as_user 'bash -n /usr/share/bash-completion/completions/mammoray'
install 'python3-mammoray_*.deb'
cp "$top/Testing/Python/testScene.py" "$top/Testing/Python/testProjectBox.py" "$root/home/user"
as_user 'python3 testScene.py && python3 testProjectBox.py'

install 'mammoray-app_*.deb'
inside apt-get install -y -q --no-install-recommends xauth xvfb
as_user 'xvfb-run --auto-servernum mammoray app demo-result --benchmark'

if compgen -G "$packages/octave-mammoray_*.deb" >/dev/null; then
  install 'octave-mammoray_*.deb'
  cp "$top/Testing/Octave/twoPlates.m" "$root/home/user"
  as_user 'octave-cli --no-init-file --quiet --path $(echo /usr/lib/*/mammoray/octave) twoPlates.m'
fi

install 'libmammoray-dev_*.deb'
inside apt-get install -y -q --no-install-recommends cmake g++ make nlohmann-json3-dev
rm -rf "$root/home/user/consumer"
cp -r "$top/Testing/Package/consumer" "$root/home/user/consumer"
inside chown -R user /home/user/consumer
as_user 'cmake -S consumer -B consumer/build && cmake --build consumer/build -j2 && consumer/build/pipeline'
inside apt-get install -y -q --no-install-recommends pkg-config
as_user 'c++ -std=c++20 consumer/xray.cxx -o xray $(pkg-config --cflags --libs mammoray-xray) && ./xray'

# The second set takes the place of python3-mammoray, and needs neither VTK nor the libraries of the first.
if compgen -G "$packages/without-copyleft/python3-mammoray-xray_*.deb" >/dev/null; then
  inside apt-get purge -y -q libmammoray-dev mammoray mammoray-app 'python3-mammoray*' 'octave-mammoray*'
  inside apt-get autoremove -y -q
  install 'without-copyleft/*.deb'
  as_user 'if python3 -c "import vtkmodules" 2>/dev/null; then echo "expected no VTK"; exit 1; fi; python3 testScene.py'
fi
# The plugin in Debian's ParaView, whose Python conflicts with that of VTK.
if compgen -G "$packages/paraview/paraview-mammoray_*.deb" >/dev/null; then
  inside sh -c 'apt-get purge -y -q $(dpkg-query -W -f "\${Package} " "python3-mammoray*" "python3-vtk*" 2>/dev/null)'
  install 'without-copyleft/mammoray-data_*.deb paraview/paraview-mammoray_*.deb'
  inside apt-get install -y -q --no-install-recommends python3-paraview xauth xdotool xvfb
  mkdir -p "$root/home/user/Applications"
  ln -sfn /usr/share/mammoray "$root/home/user/Data"
  cp -r "$top/Applications/ParaViewPlugin" "$root/home/user/Applications"
  inside chown -R user /home/user/Applications
  as_user 'set -e
    Applications/ParaViewPlugin/pvpython.sh Applications/ParaViewPlugin/testPlugin.py plugin-test
    Applications/ParaViewPlugin/testWindow.sh /usr/share/mammoray/paraview/demo.pvsm state.png'
fi
echo "try.sh: all of $(cd "$packages" && echo *.deb) work on $release"
