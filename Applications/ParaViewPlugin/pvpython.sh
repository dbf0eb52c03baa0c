#!/usr/bin/env bash
# pvpython of the prefix that build.sh made, with its own libraries and modules first, or, where there is none, the system's with the
# package's plugin; under Xvfb where there is no display. Exit 125: no pvpython.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
prefix=$root/build/paraview-prefix/usr
if [ -x "$prefix/bin/pvpython" ] && [ -e "$root/build/paraview/lib/MammoRay/MammoRay.so" ]; then
  program=$prefix/bin/pvpython
  export LD_LIBRARY_PATH=$prefix/lib/x86_64-linux-gnu${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
  export PYTHONPATH=$prefix/lib/python3/dist-packages
  export PV_PLUGIN_PATH=$root/build/paraview/lib/MammoRay
elif command -v paraview-mammoray pvpython >/dev/null; then
  program=pvpython
  export PV_PLUGIN_PATH=$(echo /usr/lib/*/paraview-5.11/plugins/MammoRay)
else
  echo "skipped: no ParaView; ./quickstart paraview makes it" >&2
  exit 125
fi
if [ -z "${DISPLAY:-}" ]; then
  # The server itself takes a number that is free: xvfb-run -a looks for one first, and two at once find the same.
  exec {number}< <(exec Xvfb -displayfd 1 -screen 0 1400x1000x24 -noreset -nolisten tcp 2>/dev/null)
  server=$!
  trap 'kill "$server" 2>/dev/null' EXIT
  if ! read -r -t 60 display <&"$number"; then
    echo "expected an X server (Debian: xvfb), found none that starts" >&2
    exit 1
  fi
  DISPLAY=:$display "$program" "$@"
  exit
fi
exec "$program" "$@"
