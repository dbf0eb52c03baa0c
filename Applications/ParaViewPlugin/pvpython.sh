#!/usr/bin/env bash
# pvpython of the prefix that build.sh made, with its own libraries and modules first. Exit 125: there is none.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
prefix=$root/build/paraview-prefix/usr
if [ ! -x "$prefix/bin/pvpython" ] || [ ! -e "$root/build/paraview/lib/MammoRay/MammoRay.so" ]; then
  echo "skipped: no ParaView; ./quickstart paraview makes it" >&2
  exit 125
fi
export LD_LIBRARY_PATH=$prefix/lib/x86_64-linux-gnu${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export PYTHONPATH=$prefix/lib/python3/dist-packages
export PV_PLUGIN_PATH=$root/build/paraview/lib/MammoRay
exec "$prefix/bin/pvpython" "$@"
