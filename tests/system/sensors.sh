#!/usr/bin/env bash
# slamd-sensors and everything that can be connected: emulated Livox devices and a VLP-16 in a namespace of their own, an
# inertial sensor and a receiver on serial lines. It finds them, says what is wrong with them, disturbs none, and writes a
# configuration that slamd accepts. Needs root for the namespaces.
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
. tests/system/verdicts.bash
needs jq ip
. tests/system/network.bash
ip -n slamd_sensor route add 224.0.0.0/4 dev lo  # for the simulator's truth

# look SECONDS OPTION...: what it has seen in the end is in $seen, its words in $said.
seen=$scratch/seen.json
look() {
  on_host "$bin/slamd-sensors" --json --no-serial --seconds "$@" >"$scratch/seconds.json" 2>"$scratch/complaint"
  code=$?
  tail -n 1 "$scratch/seconds.json" >"$seen"
  said=$(jq -r '.remarks[] | "\(.about): \(.words)"' "$seen" 2>/dev/null)
}
# says WHAT PATTERN: a remark is like this.
says() { if grep -qE -- "$2" <<<"$said"; then pass "$1"; else fail "$1: no remark like '$2' among: ${said//$'\n'/; }"; fi; }
# says_not WHAT PATTERN
says_not() { if grep -qE -- "$2" <<<"$said"; then fail "$1: '$(grep -E -- "$2" <<<"$said")'"; else pass "$1"; fi; }
switch_on() {
  ip netns exec slamd_sensor "$bin/slamd-simulate" --live --lidar "$1" --seed 5 --duration 600 >/dev/null 2>>"$scratch/$1.log" &
  pids+=("$!")
  device=$!
}
# start_daemon SPACE TOML
start_daemon() {
  printf '%b' "$2" >"$scratch/daemon.toml"
  ip netns exec "$1" "$bin/slamd" --config "$scratch/daemon.toml" 2>"$scratch/slamd.log" &
  daemon=$!
  pids+=("$daemon")
}
stop_daemon() { kill -TERM "$daemon"; wait "$daemon" 2>/dev/null; }

refuses "seconds that are none" 2 '--seconds' "$bin/slamd-sensors" --seconds soon
refuses "a configuration that is not there" 2 'none\.toml: cannot be read' "$bin/slamd-sensors" --seconds 1 --config "$scratch/none.toml"

# Nothing is connected.
look 1 --write "$scratch/nothing.toml"
if [ "$code" -eq 1 ] && grep -q 'no LiDAR was found' "$scratch/complaint" && [ ! -e "$scratch/nothing.toml" ]; then
  pass "nothing is connected: exit 1, and nothing is written"
else
  fail "nothing is connected: exit $code, $(cat "$scratch/complaint")"
fi

"$bin/slamd-simulate" --out "$scratch/drive" --lidar vlp16 --seed 23 --duration 6.5 --rest 6.5 --imu-rate 200 >/dev/null || fail "simulated"
switch_on livox_avia
avia=$device
switch_on livox_mid360

# Everything at once.
on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 --imu-to "xsens:$scratch/imu" --gnss-to "both:$scratch/gnss" --json "$scratch/drive" >"$scratch/sent.json" 2>/dev/null &
sending=$!
pids+=("$sending")
for _ in $(seq 50); do [ -e "$scratch/imu" ] && [ -e "$scratch/gnss" ] && break; sleep 0.1; done
cat >"$scratch/sideways.toml" <<TOML
[[lidar]]
model = "vlp16"
[imu]
source = "serial"
device = "$scratch/imu"
T_base_imu = { xyz_m = [0.0, 0.0, 0.0], rpy_deg = [90.0, 0.0, 0.0] }
TOML
look 4.4 --serial "$scratch/imu" --serial "$scratch/gnss" --config "$scratch/sideways.toml" --write "$scratch/written.toml"
if [ "$code" -eq 0 ]; then pass "sensors are found: exit 0"; else fail "sensors are found: exit $code, $(cat "$scratch/complaint")"; fi
if [ "$(wc -l <"$scratch/seconds.json")" -eq 4 ]; then pass "a line of JSON each second"; else fail "$(wc -l <"$scratch/seconds.json") lines of JSON in 4.4 s"; fi
holds "the Avia is found by its broadcasts" "$seen" \
  '.lidars[] | select(.model == "livox_avia") | .code == "3JEDK380010Z391" and .address == "10.77.0.2" and .broadcasts.total >= 3'
holds "the Mid-360 is found by its answers" "$seen" \
  '.lidars[] | select(.model == "livox_mid360") | .code == "47MDL1234567890" and .broadcasts.total >= 3'
holds "the VLP-16 is found by its packets, and their rate is right" "$seen" \
  '.lidars[] | select(.model == "vlp16") | .packets.last_second > 700 and .packets.last_second < 800 and .positions.last_second > 40 and .pps == "locked"'
holds "the Xsens is found, and its rate is right" "$seen" \
  '.lines[0] | .speaks == "xsens" and .imu.samples.last_second > 190 and .imu.samples.last_second < 210 and .imu.units == "si"'
holds "the receiver is found, with fixes" "$seen" '.lines[1] | .speaks == "gnss" and .gnss.good.last_second >= 3 and .gnss.ubx.total > 0 and .gnss.sentences.total > 0'
says "gravity is not where the configured extrinsic has it" "$scratch/imu: gravity is (89|90)\.[0-9] degrees from where imu\.T_base_imu has it"
kill "$sending"; wait "$sending" 2>/dev/null

# What was written.
check "slamd accepts the configuration that was written" on_host "$bin/slamd-replay" --print-config --config "$scratch/written.toml" "$scratch/drive/lidar.pcap"
refuses "it takes no file's place" 2 'written\.toml: is there already; --force replaces it' \
  "$bin/slamd-sensors" --no-serial --seconds 1 --write "$scratch/written.toml"
if grep -vE '^(#.*|\[.*\]|)$' "$scratch/written.toml" | grep -qv ' # '; then fail "a key without what was seen: $(cat "$scratch/written.toml")"; else pass "each key says what was seen"; fi

# A Livox alone: what is written runs as it is.
look 2.5 --write "$scratch/written.toml" --force
check "slamd --check is ready with what was written" on_host "$bin/slamd" --check --config "$scratch/written.toml"
says_not "nothing is wrong with devices that wait for a host" 'Livox'

# slamd has them both. The Mid-360 is asked where it sends to, the Avia nothing, and neither they nor slamd are disturbed.
"$bin/slamd" --set lidar.model=livox_avia --set lidar.device.code=any --print-config >/dev/null || fail "a daemon for the Avia"
ip netns exec slamd_host "$bin/slamd" --set lidar.model=livox_avia --set lidar.device.code=any --set lcm.prefix=AVIA 2>"$scratch/avia.slamd.log" &
keeper=$!
pids+=("$keeper")
start_daemon slamd_host '[[lidar]]\nmodel = "livox_mid360"\ndevice.code = "any"\n[imu]\nsource = "livox"\n'
for _ in $(seq 80); do grep -q ' samples$' "$scratch/slamd.log" && grep -q ' samples$' "$scratch/avia.slamd.log" && break; sleep 0.1; done
look 2.2 --ask --ask-avia 10.77.0.2
holds "a Mid-360 that slamd has tells where it sends to" "$seen" '.lidars[] | select(.model == "livox_mid360") | .sends_to == "10.77.0.1" and .broadcasts.total >= 2'
says "ports that are taken are named with their owner" "UDP port 56301: is taken by slamd \(pid $daemon\): points of a Mid-360 are not heard here"
says "an Avia that slamd may have is not asked" "Livox SDK1 device at 10\.77\.0\.2: is not asked: slamd \(pid [0-9]+\) on this computer looks for such devices"
kill -TERM "$keeper"; wait "$keeper" 2>/dev/null
if grep -hE 'lost|silent|restarted|held by' "$scratch/slamd.log" "$scratch/avia.slamd.log" >"$scratch/disturbed"; then
  fail "slamd was disturbed: $(head -n 3 "$scratch/disturbed")"
elif ! grep -q ' samples$' "$scratch/avia.slamd.log"; then
  fail "slamd had the Avia: $(tail -n 3 "$scratch/avia.slamd.log")"
else
  pass "slamd is not disturbed"
fi
# It dies, and this computer gets another address: the device is set to send to a host that is another one.
kill -9 "$daemon"; wait "$daemon" 2>/dev/null
ip -n slamd_host addr add 10.77.0.4/24 dev slamd_a
ip -n slamd_host addr del 10.77.0.1/24 dev slamd_a
ip -n slamd_host addr add 10.77.0.4/24 dev slamd_a 2>/dev/null  # it was the second of its subnet, and went with the first
look 2.2 --ask
says "the host that a Mid-360 sends to is named" 'Livox Mid-360 47MDL1234567890 at 10\.77\.0\.2: is set to send to another host, 10\.77\.0\.1'
ip -n slamd_host addr flush dev slamd_a
ip -n slamd_host addr add 10.77.0.1/24 dev slamd_a

# Another host takes the Avia while it is listened to.
for _ in $(seq 8); do  # until it has missed the host that it had, and looks for one again
  look 1.3
  jq -e 'any(.lidars[]; .model == "livox_avia" and .broadcasts.last_second >= 1)' "$seen" >"$scratch/looks" && break
done
{ sleep 1.3; ip netns exec slamd_sensor "$bin/slamd" --set lidar.model=livox_avia --set lidar.device.code=any 2>"$scratch/slamd.log"; } &
taking=$!
pids+=("$taking")
look 9.2
says "an Avia that was taken by another host is said to be" 'Livox Avia 3JEDK380010Z391 at 10\.77\.0\.2: looks for no host any more: another host owns it'
look 2.4 --ask-avia 10.77.0.2
says "it says so itself when it is asked" 'Livox SDK1 device at 10\.77\.0\.2: refuses this host: another one owns it'
stop_other() { for pid in $(ip netns pids slamd_sensor); do [ "$(cat "/proc/$pid/comm")" = slamd ] && kill -TERM "$pid"; done; }
stop_other
wait "$taking" 2>/dev/null

# A daemon that runs keeps what it has: its port, its device, and its serial line.
on_sensor "$bin/slamd-replay" --to-network 10.77.0.1 --imu-to "mip:$scratch/mip" --json "$scratch/drive" >"$scratch/sent.json" 2>/dev/null &
sending=$!
pids+=("$sending")
for _ in $(seq 50); do [ -e "$scratch/mip" ] && break; sleep 0.1; done
start_daemon slamd_host "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"serial\"\nprotocol = \"mip\"\ndevice = \"$scratch/mip\"\n"
listens "$scratch/slamd.log"
sleep 0.7
look 2.5 --serial "$scratch/mip"
says "a serial line that is held is named with its holder" "$scratch/mip: is held by slamd \(pid $daemon\), and left to it"
wait "$sending"
sleep 0.3
stop_daemon
accounted_for "beside slamd-sensors" "$(cat "$scratch/sent.json")" "$scratch/slamd.log"
count=$(jq .sent.imu_rows "$scratch/sent.json")
if grep -qE "^I inertial: sample $count(,|$)" "$scratch/slamd.log"; then pass "all $count inertial samples got to slamd"; else
  fail "of $count inertial samples slamd has: $(grep '^I inertial' "$scratch/slamd.log")"; fi

# Numbers in g, from a line that says CSV rows; garbage at the ports; a sensor of another subnet.
awk -F, 'BEGIN { OFS = "," } NR > 1 { for (i = 5; i <= 7; ++i) $i /= 9.80665 } { print }' "$scratch/drive/imu.csv" >"$scratch/in_g.csv" && mv "$scratch/in_g.csv" "$scratch/drive/imu.csv"
on_sensor "$bin/slamd-replay" --to-network 127.0.0.1:9:9 --imu-to "pty:$scratch/rows" "$scratch/drive" >/dev/null 2>&1 &
pids+=("$!")
for _ in $(seq 50); do [ -e "$scratch/rows" ] && break; sleep 0.1; done
ip -n slamd_sensor addr flush dev slamd_b
ip -n slamd_sensor addr add 192.168.1.50/24 dev slamd_b
ip -n slamd_sensor addr add 10.77.0.3/24 dev slamd_b  # a stranger
# As systemd sets it: the kernel drops what comes from where it has no route to.
on_host sh -c 'for of in all slamd_a; do echo 2 >/proc/sys/net/ipv4/conf/$of/rp_filter; done'
on_sensor "$bin/slamd-replay" --to-network 10.77.0.1:9:9 --imu-to udp:10.77.0.1:7501 "$scratch/drive" >/dev/null 2>&1 &
pids+=("$!")
on_sensor bash -c 'for i in $(seq 200); do head -c 700 /dev/urandom >/dev/udp/10.77.0.1/2368; head -c 60 /dev/urandom >/dev/udp/10.77.0.1/56000; done' &
pids+=("$!")
look 4.2 --serial "$scratch/rows"
says "a sensor of another subnet is told so" 'Livox Avia 3JEDK380010Z391 at 192\.168\.1\.50: is of another subnet than this host, which has 10\.77\.0\.1/24'
says "numbers in g are recognised" "$scratch/rows: specific force looks like g, and must be m/s\^2"
holds "also in rows that come by UDP" "$seen" '.rows[0] | .port == 7501 and .imu.samples.last_second > 180 and .imu.units == "g"'
says "garbage is counted" 'UDP port 2368: [0-9]+ datagrams are no sensor.s that is known, the last one of 10\.77\.0\.3'
if kill -0 "$avia" 2>/dev/null; then pass "the emulated Avia has survived it all"; else fail "the emulated Avia has ended"; fi

# For people: lines through a pipe, and a picture on a terminal.
text=$(on_host "$bin/slamd-sensors" --no-serial --seconds 2.2)
if grep -qE '^ +2 s  Livox Avia 3JEDK380010Z391  192\.168\.1\.50  [12] broadcasts/s' <<<"$text"; then pass "lines through a pipe"; else fail "lines through a pipe: $text"; fi
if command -v script >/dev/null; then
  script -qec "ip netns exec slamd_host $bin/slamd-sensors --no-serial --seconds 1.2" /dev/null >"$scratch/terminal" </dev/null
  if grep -q $'\033\[H\033\[J''slamd-sensors: listening for 1 s' "$scratch/terminal"; then pass "a picture on a terminal"; else fail "a picture on a terminal: $(head -c 300 "$scratch/terminal")"; fi
else
  skip "script is not installed"
fi
exit "$status"
