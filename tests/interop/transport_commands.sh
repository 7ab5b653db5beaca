#!/bin/bash
# Runs the program and transport_probe on a bus of python-can, over one transport, in a network namespace of its own: nothing
# leaves it.     unshare -n transport_commands.sh PROGRAM PROBE TRANSPORT
# TRANSPORT: udp-multicast, udp-multicast-6, slcan-pty, slcan-tcp, cannelloni-udp, cannelloni-tcp. Prints "transport ok".
set -eu
program=$1 probe=$2 transport=$3
here=$(dirname "$0") work=$(mktemp -d) python=/usr/bin/python3
children=()
trap 'kill "${children[@]}" 2>/dev/null || true; rm -rf "$work"' EXIT
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo
if [ "$transport" = udp-multicast-6 ]; then  # Linux does not loop IPv6 multicast back over lo
  ip link add pair0 type veth peer name pair1
  for end in pair0 pair1; do sysctl -q -w net.ipv6.conf.$end.accept_dad=0; ip link set $end up; done
  sleep 2
fi

start() {  # start NAME SCRIPT ARGUMENTS: in the background, once it said its first line
  local name=$1; shift
  "$python" "$here/$1" "${@:2}" > "$work/$name.log" 2> "$work/$name.err" &
  children+=($!)
  for _ in $(seq 1200); do [ -s "$work/$name.log" ] && return; sleep 0.1; done
  echo "$name does not start:"; cat "$work/$name.err"; exit 1
}
fail() { echo "$@"; for file in "$work"/*; do echo "--- $file"; tail -n 50 "$file"; done; exit 1; }

bus=(udp_multicast 239.74.163.9 port=43200)
case $transport in
  udp-multicast) bus=(udp_multicast 239.74.163.2); address=udp-multicast:239.74.163.2:43113 ;;
  udp-multicast-6) bus=(udp_multicast ff15:7079:7468:6f6e:6465:6d6f:6d63:6173)
    address="udp-multicast:[ff15:7079:7468:6f6e:6465:6d6f:6d63:6173]:43113" ;;
esac
start node transport_node.py 5 "${bus[@]}"
case $transport in
  slcan-pty) start adapter slcan_adapter.py pty "${bus[@]}"; address=slcan:$(head -1 "$work/adapter.log")@250000 ;;
  slcan-tcp) start adapter slcan_adapter.py tcp "${bus[@]}"; address=slcan:tcp:127.0.0.1:$(head -1 "$work/adapter.log")@250000 ;;
  cannelloni-udp) start peer cannelloni_peer.py udp 20000 20001 "${bus[@]}"; address=cannelloni:127.0.0.1:20000:20001 ;;
  cannelloni-tcp) start peer cannelloni_peer.py tcp "${bus[@]}"; address=cannelloni:tcp:127.0.0.1:$(head -1 "$work/peer.log") ;;
esac

"$probe" "$address" 36 300 > "$work/probe.log" 2>&1 || fail "the probe:"
# What the node sent, as we heard it.
for length in 0 1 2 3 4 5 6 7 8; do
  data=$(for byte in $(seq 1 $length); do printf '%02x' "$byte"; done)
  for line in "heard BD 30$length $length $data" "heard XD 1FFFFFF$length $length $data" "heard BR 31$length $length " \
              "heard XR 1000$length $length "; do
    grep -qxF "$line" "$work/probe.log" || fail "the probe does not say: $line"
  done
done
# What we sent, as python-can heard it.
for length in 0 1 2 3 4 5 6 7 8; do
  data=$(for byte in $(seq 1 $length); do printf '%02x' $((byte + 239)); done)
  for line in "BD 20$length $length $data" "XD 1ABCDE$length $length $data" "BR 21$length $length " "XR 1ABCDF$length $length "; do
    for _ in $(seq 600); do grep -qxF "$line" "$work/node.log" && break; sleep 0.1; done
    [ "$(grep -cxF "$line" "$work/node.log")" = 1 ] || fail "python-can does not say once: $line"
  done
done
grep -q "^complaint" "$work/probe.log" && fail "a complaint"

expect() {  # expect EXIT-CODE TEXT COMMAND...
  local code=$1 text=$2 got=0; shift 2
  "$program" "$@" --bus "$address" > "$work/said" 2>&1 || got=$?
  if [ "$got" != "$code" ] || ! grep -qF "$text" "$work/said"; then
    fail "$*: expected exit code $code and $text, found $got"
  fi
}
# A TCP adapter of these takes one connection.
case $transport in *-tcp) echo "transport ok"; exit ;; esac
expect 0 '1000:00  983441  000F0191H' sdo read 5 1000 --type u32 --timeout 60s
expect 1 'abort 06020000H: object does not exist' sdo read 5 3000 --timeout 60s
expect 0 '' sdo write 5 2000 0x1234 --type u32 --timeout 60s
expect 0 '2000:00  4660  00001234H' sdo read 5 2000 --type u32 --timeout 60s
expect 0 'node 5 is operational' nmt start 5 --wait --timeout 60s
expect 0 '   5  unknown          000F0191' scan --nodes 5 --timeout 5s
echo "transport ok"
