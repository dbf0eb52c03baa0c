#!/usr/bin/env bash
# ParaView 5.11 of Debian 12 in build/paraview-prefix, nothing installed (its Python package conflicts with python3-vtk9), and the
# plugin built against it in build/paraview. Downloads 83 MB once.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

prefix=$PWD/build/paraview-prefix
if [ ! -x "$prefix/usr/bin/pvpython" ]; then
  download=$(mktemp -d)
  trap 'rm -rf "$download"' EXIT
  # The window wants Qt's OpenGL, which nothing here installs.
  (cd "$download" && apt-get download paraview paraview-dev python3-paraview libqt5opengl5)
  for package in "$download"/*.deb; do
    dpkg-deb -x "$package" "$prefix"
  done
fi
missing=$(LD_LIBRARY_PATH="$prefix/usr/lib/x86_64-linux-gnu" ldd "$prefix/usr/bin/pvpython" "$prefix/usr/bin/paraview" | sed -n 's/ => not found//p')
if [ -n "$missing" ]; then
  echo "pvpython: libraries are missing; ./quickstart setup installs what VTK needs, of which ParaView needs the same: $missing" >&2
  exit 1
fi
unity=()
[ -f build/paraview/CMakeCache.txt ] || unity=(-DCMAKE_UNITY_BUILD=ON)
cmake -S Applications/ParaViewPlugin -B build/paraview -G Ninja -DCMAKE_BUILD_TYPE=Release "${unity[@]}" \
  -DPython3_EXECUTABLE=/usr/bin/python3 -DParaView_DIR="$prefix/usr/lib/x86_64-linux-gnu/cmake/paraview-5.11"
cmake --build build/paraview
# A state to open, for here and for the package.
if [ build/paraview/demo.pvsm -ot build/paraview/lib/MammoRay/MammoRay.so ] || [ build/paraview/demo.pvsm -ot Applications/ParaViewPlugin/makeState.py ]; then
  mkdir -p build/paraview/packaged
  Applications/ParaViewPlugin/pvpython.sh Applications/ParaViewPlugin/makeState.py build/paraview/demo.pvsm Data/victre-phantom-1/labels.nrrd
  sed "s|$PWD/Data|/usr/share/mammoray|g" build/paraview/demo.pvsm >build/paraview/packaged/demo.pvsm
fi
