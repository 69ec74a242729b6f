#!/bin/sh
# The first process of a user-mode Linux: the serial line ttyS0 becomes the network can0, a client
# drives on it. What they say goes to the console, and each frame, as a line of candump's log; then the
# machine goes off.
#
# usage: init=.../socketcan_init.sh -- PYTHON
set -e
mount -t proc proc /proc
mount -t sysfs sysfs /sys
end() {
    echo "exit code $?"
    echo o >/proc/sysrq-trigger
    sleep 10
}
trap end EXIT

for module in can-dev can can-raw slcan; do
    insmod "$(find "/usr/lib/uml/modules/$(uname -r)" -name "$module.ko*")"
done
slcand -F -o -c -s6 /dev/ttyS0 can0 &
slcand=$!
until ip link show can0 >/dev/null 2>&1; do
    sleep 0.1
done
ip link set can0 up

candump -L can0 &
candump=$!
until grep -q 'raw$' /proc/net/can/rcvlist_all; do
    sleep 0.1
done
cansend can0 601#4000100000000000 # upload 1000h
sleep 0.5
result=0
PYTHONDONTWRITEBYTECODE=1 timeout -k 5 60 "$1" "$(dirname "$0")/socketcan_client.py" can0 || result=$?
for count in rx_errors rx_over_errors rx_dropped tx_errors tx_dropped; do
    echo "$count $(cat /sys/class/net/can0/statistics/$count)"
done
sleep 0.5
kill $candump
wait $candump || true
kill $slcand
wait $slcand
exit $result
