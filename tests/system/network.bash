# Two computers and a cable, as network namespaces: the robot's (slamd_host, 10.77.0.1) and the sensor's (slamd_sensor,
# 10.77.0.2). Sourced after verdicts.bash; ends the script with a visible skip where that is not permitted. Processes
# whose ids are in pids end with the script.
if ! ip netns add slamd_probe 2>/dev/null; then
  skip "network namespaces need root"
  exit 0
fi
ip netns del slamd_probe
# Another run's namespaces have the same names: one run after the other.
exec 9>"${TMPDIR:-/tmp}/slamd_network.lock"
flock --wait 600 9 || { echo "FAIL $suite: another run holds the network namespaces"; exit 1; }

pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done
  for space in slamd_host slamd_sensor; do
    for pid in $(ip netns pids "$space" 2>/dev/null); do kill "$pid" 2>/dev/null; done  # what those have started
  done
  wait 2>/dev/null
  ip netns del slamd_host 2>/dev/null
  ip netns del slamd_sensor 2>/dev/null
  rm -rf "$scratch"
}
trap finish EXIT

for space in slamd_host slamd_sensor; do ip netns del "$space" 2>/dev/null; done  # of a run that was killed
# Two computers and a cable: the robot's, and the sensor.
ip netns add slamd_host
ip netns add slamd_sensor
ip link add slamd_a netns slamd_host type veth peer name slamd_b netns slamd_sensor
ip -n slamd_host addr add 10.77.0.1/24 dev slamd_a
ip -n slamd_sensor addr add 10.77.0.2/24 dev slamd_b
for end in "slamd_host slamd_a" "slamd_host lo" "slamd_sensor slamd_b" "slamd_sensor lo"; do
  read -r space device <<<"$end"
  ip -n "$space" link set "$device" up
done
ip -n slamd_host route add 224.0.0.0/4 dev lo
on_host() { ip netns exec slamd_host "$@"; }
on_sensor() { ip netns exec slamd_sensor "$@"; }

# accounted_for WHAT SENT LOG: as many packets as slamd-replay says it has sent stand in the daemon's last words.
accounted_for() {
  local sent received
  sent=$(jq '.sent.lidar + .sent.position + .sent.imu_packets' <<<"$2")
  received=$(sed -nE 's/^I packets: //p' "$3" | tr ',' '\n' | awk '{ sum += $2 } END { print sum + 0 }')
  if [ "$sent" = "$received" ]; then
    pass "$1: all $sent packets are accounted for"
  else
    fail "$1: $sent packets were sent, $received are accounted for: $(grep packets "$3")"
  fi
}
