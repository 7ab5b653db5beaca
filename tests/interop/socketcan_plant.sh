#!/bin/bash
# A plant's module on one CAN interface, its slaves in another process on the other (or the same): socketcan_plant.sh PROGRAM
# DEVICES'-INTERFACE MODULE'S-INTERFACE. Prints "socketcan plant ok" when all was as expected.
set -u
program=$1 theirs=$2 ours=$3
examples=$(cd "$(dirname "$0")/../../examples" && pwd)
work=$(mktemp -d)
cd "$work" || exit 1
trap 'kill $(jobs -p) 2>/dev/null' EXIT
fail() {
  echo "socketcan plant: $*"
  local events
  for events in devices.json module.json; do
    echo "== $events: its last load, and what else has happened"
    grep '"event":"load"' $events | tail -n 1
    grep -v '"event":"load"' $events | tail -n 40
  done
  tail -n 5 ./*.err
  ip -details -statistics link show "$ours"
  exit 1
}
wait_for() {  # wait_for WHAT COMMAND...: until the command succeeds
  local what=$1 tries=0; shift
  until "$@"; do tries=$((tries + 1)); [ $tries -lt 300 ] || fail "$what"; sleep 0.2; done
}
heard() { grep -q "$2" "$1"; }
times_heard() { [ "$(grep -c "$2" "$1")" -ge "$3" ]; }
word() { "$program" plc read "U0\\G$1" --format dec 2>/dev/null | awk '{ print $NF }'; }
word_is() { [ "$(word "$1")" = "$2" ]; }
both_operational() { word_is 602 5 && word_is 603 5; }
missed() { ! word_is 602 5; }

# The bit rate of a controller is the plant file's: the program sets it where the interface has another one.
# Heartbeats are missed after 5 s (1388H), for on a busy machine with an emulated one inside those of 0.5 s were missed after 1.5 s:
# a boot that begins then and meets the interface that goes down fails for good.
sed "s#\"../devices/#\"$examples/devices/#; s#\"state\"#\"$work/store\"#; s#05DC#1388#g" "$examples/real-bus/module.toml" > module.toml
[ "$(grep -o 1388 module.toml | wc -l)" = 2 ] || fail "the module's heartbeat consumer times are not where they were"
sed "s#\"../devices/#\"$examples/devices/#; s#^serve.*##" "$examples/real-bus/devices.toml" > devices.toml
"$program" run devices.toml --bus "socketcan:$theirs" --json > devices.json 2> devices.err &
"$program" run module.toml --bus "socketcan:$ours" --json > module.json 2> module.err &
module=$!
wait_for "the slaves come up" both_operational
candump -L "$ours" > dump.log &

# Another program on the bus: a stranger's boot-up is an event, and NMT stops node 3.
cansend "$theirs" 709#00
wait_for "a stranger's boot-up is seen" heard module.json '"node":9'
cansend "$theirs" 000#0203
wait_for "node 3 is stopped by another program" heard devices.json '"node":3,.*stopped'
cansend "$theirs" 000#0103
wait_for "and started again" both_operational
wait_for "candump sees the encoder's PDO" heard dump.log "$ours 183#"

# The interface goes down and comes up again.
ip link set "$ours" down
wait_for "it is told that the interface is down" heard module.json 'tried again'
if [ "$theirs" != "$ours" ]; then wait_for "heartbeats are missed" missed; else sleep 6; fi
ip link set "$ours" up
wait_for "it is told that the bus is there again" heard module.json 'there again'
wait_for "the slaves come up again" both_operational

# Bus-off, told by error frames: 128 times 11 bits later the controller is started again.
if [ "$ours" = vcan0 ]; then
  cansend "$ours" 20000040#0000000000000000
  wait_for "bus-off is told" heard module.json 'bus-off'
  cansend "$ours" 20000100#0000000000000000
  wait_for "the slaves are there after bus-off" both_operational
fi
kill -INT $module
wait $module || fail "the module's plant ended with $?"
[ ! -s module.err ] || fail "$(cat module.err)"
echo 'socketcan plant ok'
