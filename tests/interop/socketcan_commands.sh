#!/bin/bash
# Runs commands of the program on SocketCAN interfaces: socketcan_commands.sh PROGRAM NODES'-INTERFACE OUR-INTERFACE
# The nodes are socketcan_node.py. Prints "socketcan ok" when all was as expected.
set -eu
program=$1 theirs=$2 ours=$3
nodes=()
trap 'kill "${nodes[@]}"' EXIT
node() {  # node NUMBER: puts a node on the bus
  python3 "$(dirname "$0")/socketcan_node.py" "$theirs" "$1" > "/tmp/node$1.log" &
  nodes+=($!)
  until grep -qs ready "/tmp/node$1.log"; do sleep 0.2; done
}
expect() {  # expect EXIT-CODE TEXT COMMAND...
  local code=$1 text=$2 got=0; shift 2
  "$program" "$@" --bus "socketcan:$ours" > /tmp/said 2>&1 || got=$?
  if [ "$got" != "$code" ] || ! grep -qF "$text" /tmp/said; then
    echo "$*: expected exit code $code and $text, found $got:"; cat /tmp/said; exit 1
  fi
}
node 5
expect 0 '1000:00  983441  000F0191H' sdo read 5 1000 --type u32 --timeout 5s
expect 1 'abort 06020000H: object does not exist' sdo read 5 3000 --timeout 5s
expect 0 '' sdo write 5 2000 0x1234 --type u32 --timeout 5s
expect 0 '2000:00  4660  00001234H' sdo read 5 2000 --type u32 --timeout 5s
expect 0 'node 5 is operational' nmt start 5 --wait --timeout 5s

printf '[master]\nnode = 1\n[[slave]]\nnode = 5\nvendor = 0x195\n' > /tmp/network.toml
expect 0 'node 5: booted' master /tmp/network.toml --timeout 5s
printf '[master]\nnode = 1\n[[slave]]\nnode = 5\nvendor = 0x196\n' > /tmp/network.toml
expect 1 '1018:01 reads 00000195H, expected 00000196H' master /tmp/network.toml --timeout 5s

node 255
expect 0 'serial 0000004D  is node 9 now' lss scan --assign 9 --store --timeout 600ms
expect 0 '1018:04  77  0000004DH' sdo read 9 1018:4 --type u32 --timeout 5s
# Last, because the controllers of the virtual machine lose their place in the receive buffer at a remote frame.
expect 0 '   5  unknown          000F0191' scan --nodes 5 --timeout 2s
echo 'socketcan ok'
