#!/bin/bash
# What the transport of SocketCAN knows of its interface: socketcan_transport.sh PROGRAM PROBE, in the virtual machine of
# `socketcan_says_what_the_controller_does`. can0 and can1 are two controllers on one bus. Prints "socketcan ok".
set -eu
program=$1 probe=$2
here=$(dirname "$0")
export PROBE_WITHOUT_REMOTE=1  # the controllers of the virtual machine lose their place in the receive buffer at a remote frame
fail() { echo "$@"; tail -n 60 /tmp/*.log; ip -details link show can1; exit 1; }
node() {  # node INTERFACE
  python3 "$here/transport_node.py" 5 socketcan "$1" > "/tmp/node-$1.log" 2>&1 &
  until grep -qs ready "/tmp/node-$1.log"; do sleep 0.2; done
}
wait_for() {  # wait_for FILE LINE
  for _ in $(seq 100); do grep -q "$2" "$1" && return; sleep 0.2; done
  fail "$1 does not say: $2"
}

# A virtual interface: every kind of frame, remote ones too; own frames confirmed and not heard; each with its time.
node vcan0
unset PROBE_WITHOUT_REMOTE
"$probe" socketcan:vcan0 36 60 > /tmp/probe-vcan.log 2>&1 || fail "the probe on vcan0"
grep -q "heard 36 timed 36 sent 37 of 37 closed true" /tmp/probe-vcan.log || fail "vcan0: frames, times, confirmations"
grep -qx "heard XR 10008 8 " /tmp/probe-vcan.log || fail "vcan0: an extended remote frame"
export PROBE_WITHOUT_REMOTE=1

# A controller: its bit rate and sample point are netlink's.
"$probe" socketcan:can1 0 5 > /tmp/probe-can.log 2>&1 || fail "the probe on can1"
grep -qE "status 0 tec 0 rec 0 rate 125000 sample [1-9]" /tmp/probe-can.log || fail "can1: bit rate and sample point"
grep -q "sent 19 of 19 closed true" /tmp/probe-can.log || fail "can1: confirmations"

# The bit rate is set where that is permitted, and said how where it is not.
"$probe" socketcan:can1 0 5 250000 > /tmp/probe-rate.log 2>&1 || fail "the probe with 250 kbit/s"
ip -details link show can1 | grep -q "bitrate 250000" || fail "can1 has not 250 kbit/s"
if setpriv --reuid=65534 --clear-groups "$probe" socketcan:can1 0 5 500000 > /tmp/probe-user.log 2>&1; then fail "a user may"; fi
grep -q "may not set up the interface; ip link set can1 down; ip link set can1 type can bitrate 500000" /tmp/probe-user.log ||
  fail "what a user is told"
"$probe" socketcan:can1 0 5 125000 > /tmp/probe-back.log 2>&1 || fail "the probe back at 125 kbit/s"
"$probe" socketcan:vcan0 0 5 125000 > /tmp/probe-virtual.log 2>&1 || fail "vcan0 with a bit rate"

# Down and up again, and unplugged.
"$probe" socketcan:can1 1000 60 > /tmp/probe-down.log 2>&1 &
wait_for /tmp/probe-down.log "sent BD 7F0"
ip link set can1 down
wait_for /tmp/probe-down.log "interrupted: the interface is down"
ip link set can1 up
wait_for /tmp/probe-down.log "resumed"
cansend can0 181#0102
wait_for /tmp/probe-down.log "heard BD 181 2 0102"
kill %% 2>/dev/null || true
"$probe" socketcan:vcan1 1000 60 > /tmp/probe-gone.log 2>&1 &
wait_for /tmp/probe-gone.log "sent BD 7F0"
ip link delete vcan1
wait_for /tmp/probe-gone.log "interrupted: the interface is gone"
ip link add dev vcan1 type vcan
ip link set vcan1 up
wait_for /tmp/probe-gone.log "resumed"
cansend vcan1 182#03
wait_for /tmp/probe-gone.log "heard BD 182 1 03"
echo 'socketcan ok'
