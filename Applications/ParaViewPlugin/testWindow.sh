#!/usr/bin/env bash
# A state file in ParaView's own window, as a user opens it: no box besides the window, nothing complained of.
#
#   testWindow.sh STATE.pvsm PICTURE.png     with `paraview` of build.sh's prefix, or, where there is none, of the system
#
# Needs xdotool and Xvfb. Exit 125: one of these, or ParaView, is not there.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
prefix=$root/build/paraview-prefix/usr
if [ -x "$prefix/bin/paraview" ] && [ -e "$root/build/paraview/lib/MammoRay/MammoRay.so" ]; then
  program=("env" "LD_LIBRARY_PATH=$prefix/lib/x86_64-linux-gnu" "PYTHONPATH=$prefix/lib/python3/dist-packages"
    "PV_PLUGIN_PATH=$root/build/paraview/lib/MammoRay" "$prefix/bin/paraview")
elif command -v paraview-mammoray >/dev/null; then
  program=(paraview-mammoray)
else
  echo "skipped: no ParaView; ./quickstart paraview makes it" >&2
  exit 125
fi
command -v xdotool >/dev/null && command -v Xvfb >/dev/null || { echo "skipped: no xdotool or no Xvfb" >&2; exit 125; }
[ -e "$1" ] || { echo "skipped: no $1" >&2; exit 125; }
state=$(realpath "$1")
picture=$(realpath -m "$2")
mkdir -p "$(dirname "$picture")"
work=$(mktemp -d)
exec {number}< <(exec Xvfb -displayfd 1 -screen 0 1400x1000x24 -noreset -nolisten tcp 2>/dev/null)
server=$!
trap 'kill ${paraview:-} "$server" 2>/dev/null; rm -rf "$work"' EXIT
read -r -t 60 display <&"$number" || { echo "expected an X server, found none that starts" >&2; exit 1; }
export DISPLAY=:$display
# Without the welcome, which each new user gets once.
mkdir -p "$work/.config/ParaView" "$work/run"
printf '[General]\nGeneralSettings.ShowWelcomeDialog=false\n' | tee "$work"/.config/ParaView/ParaView5.11.{0,1,2}.ini >/dev/null
rm -f "$picture" "$picture.txt"
HOME=$work XDG_RUNTIME_DIR=$work/run MAMMORAY_STATE_TEST="$state $picture" "${program[@]}" --script="$here/testState.py" >"$work/log" 2>&1 &
paraview=$!
for _ in $(seq 500); do
  [ ! -e "$picture.txt" ] || break
  kill -0 $paraview 2>/dev/null || { cat "$work/log" >&2; echo "expected that ParaView runs on, found that it ended" >&2; exit 1; }
  sleep 1
done
[ -e "$picture.txt" ] || { cat "$work/log" >&2; echo "expected that $state is loaded, found that it is not" >&2; exit 1; }
sleep 3 # boxes come late
windows=$(for window in $(xdotool search --onlyvisible --name '.'); do xdotool getwindowname "$window"; done)
cat "$picture.txt"
[ "$(tail -1 "$picture.txt")" = "as expected" ] || exit 1
if [ "$(grep -c . <<<"$windows")" != 1 ] || ! grep -q '^ParaView' <<<"$windows"; then
  printf 'expected the window of ParaView alone, found:\n%s\n' "$windows" >&2
  exit 1
fi
if grep -E 'ERR\||WARN\||Traceback' "$work/log" >&2; then
  echo "expected no complaints, found these" >&2
  exit 1
fi
echo "one window, no complaints"
