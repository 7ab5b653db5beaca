#!/bin/bash
# Runs commands of the program on SocketCAN interfaces: socketcan_commands.sh PROGRAM NODE'S-INTERFACE OUR-INTERFACE
# The node is socketcan_node.py. Prints "socketcan ok" when all was as expected.
set -eu
program=$1 theirs=$2 ours=$3
python3 "$(dirname "$0")/socketcan_node.py" "$theirs" 5 > /tmp/node.log & node=$!
trap 'kill $node' EXIT
until grep -q ready /tmp/node.log; do sleep 0.2; done
expect() {  # expect TEXT COMMAND...
  local text=$1; shift
  "$program" "$@" --bus "socketcan:$ours" > /tmp/said 2>&1 || true
  grep -qF "$text" /tmp/said || { echo "$*: expected $text, found:"; cat /tmp/said; exit 1; }
}
expect '1000:00  983441  000F0191H' sdo read 5 1000 --type u32 --timeout 5s
expect 'abort 06020000H: object does not exist' sdo read 5 2000 --timeout 5s
expect 'node 5 is operational' nmt start 5 --wait --timeout 5s
expect '   5  unknown          000F0191' scan --nodes 5 --timeout 2s
echo 'socketcan ok'
