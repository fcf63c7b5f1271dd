#!/usr/bin/env bash
# What tests/system/service.sh has a booted system do: everything that happens to the service, in turn. Prints PASS and FAIL.
# Runs as root under systemd; /slamd-test holds stop_thread and the package of a next version.
set -uo pipefail
pass() { echo "PASS service: $1"; }
fail() { echo "FAIL service: $1"; systemctl show slamd -p ActiveState,SubState,Result,NRestarts,StatusText; journalctl -u slamd -n 12 --no-pager -o cat; }
of() { systemctl show slamd -P "$1"; }
conf=/etc/slamd/slamd.toml

# within SECONDS COMMAND...: until it succeeds.
within() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $end ] || return 1
    sleep 0.2
  done
}
status_has() { [[ "$(of StatusText)" == *$1* ]]; }
is_active() { [ "$(of ActiveState)" = active ]; }
has_restarted() { [ "$(of NRestarts)" -gt "$1" ]; }
substate_is() { [ "$(of SubState)" = "$1" ]; }
restarted_since() { is_active && [ "$(of NRestarts)" -gt "$1" ]; }
said_since() { journalctl -u slamd --since "$1" -o cat --no-pager | grep -qF -- "$2"; }
# Within how many of DECISECONDS is it TRACKING again?
tracking() { within "$1" status_has TRACKING || within 1 status_has "DEGRADED"; }

within 20 has_restarted 0
if [ "$(of ActiveState)" != active ] && said_since -60s "is there a route for multicast?"; then
  pass "without a route for multicast it says so, and is tried again"
else
  fail "without a route for multicast it says so, and is tried again"
fi
ip route add 224.0.0.0/4 dev lo
if within 15 is_active; then pass "it is ready as soon as there is one, without a hand"; else fail "it is ready as soon as there is one"; fi
within 5 status_has "vlp16: nothing received yet"
if status_has "STARTING: vlp16: nothing received yet"; then pass "the status says what it waits for"; else fail "the status says what it waits for: $(of StatusText)"; fi

pid=$(of MainPID)
user=$(stat -c %U "/proc/$pid")
seccomp=$(awk '/^Seccomp:/ { print $2 }' "/proc/$pid/status")
if [ "$user" = slamd ] && [ "$seccomp" = 2 ] && grep -q '^NoNewPrivs:.*1' "/proc/$pid/status"; then
  pass "it runs as user slamd, filtered, without new privileges"
else
  fail "it runs as user $user, Seccomp $seccomp"
fi
fifo() { ps -L -o comm=,cls=,rtprio= -p "$(of MainPID)"; }
odometry_has_priority() { [ "$(fifo | awk '/slamd-odometry/ { print $3 }')" = "$1" ]; }
if [ "$(fifo | grep -c ' FF ')" -eq 4 ]; then pass "four threads run under SCHED_FIFO"; else fail "four threads run under SCHED_FIFO: $(fifo)"; fi

# The configuration: what may change while it runs, what may not, what is wrong.
now=$(date +'%F %T')
printf '[realtime]\npriority = 60\n' >>$conf
systemctl reload slamd
if within 5 said_since "$now" "now realtime.priority 50 → 60" && within 5 odometry_has_priority 60; then
  pass "a reload changes the priority of running threads"
else
  fail "a reload changes the priority of running threads: $(fifo)"
fi
printf '[imu]\nsource = "udp"\n' >>$conf
systemctl reload slamd
if within 5 said_since "$now" 'refused until a restart: imu.enabled false → true' && within 5 status_has "waits for a restart" && [ "$(of MainPID)" = "$pid" ]; then
  pass "a reload refuses in words what needs a restart"
else
  fail "a reload refuses in words what needs a restart"
fi
cp $conf /slamd-test/good.toml
echo 'lidar = 3' >>$conf
if ! systemctl reload slamd 2>/dev/null && said_since "$now" "$conf:" && [ "$(of MainPID)" = "$pid" ] && is_active; then
  pass "a reload of a broken configuration fails, and slamd goes on"
else
  fail "a reload of a broken configuration fails, and slamd goes on"
fi
systemctl --no-block restart slamd
if within 10 substate_is auto-restart && ! is_active && cp /slamd-test/good.toml $conf && within 10 is_active; then
  pass "with a broken configuration it does not start, and does without a hand when that is mended"
else
  fail "with a broken configuration it does not start, and does without a hand when that is mended"
fi
cp /slamd-test/good.toml $conf

# Sensors appear, each at the other end of a cable of its own, and are mapped.
ip netns add sensor
ip link add cable type veth peer name lidar netns sensor
ip link add second type veth peer name imu netns sensor
ip addr add 10.77.0.1/24 dev cable
ip addr add 10.77.1.1/24 dev second
ip link set cable up
ip link set second up
for device in "addr add 10.77.0.2/24 dev lidar" "addr add 10.77.1.2/24 dev imu" "link set lidar up" "link set imu up" "link set lo up" \
  "route add 224.0.0.0/4 dev lo"; do
  # shellcheck disable=SC2086 # words of ip
  ip -n sensor $device
done
sensor() { ip netns exec sensor "$@"; }
sensor slamd-simulate --drive 10.77.0.1 --lidar vlp16 --imu-rate 200 --imu-to udp:10.77.1.1:7501 --duration 3600 --seed 3 >/slamd-test/simulate.log 2>&1 &
simulator=$!
began=$SECONDS
if within 40 status_has TRACKING; then pass "a simulated VLP-16 appears, and is TRACKING after $((SECONDS - began)) s"; else fail "a simulated VLP-16 appears, and is mapped"; fi
sensor slamd-ctl drive 0.8 0.15 8 &
driven=$!
sleep 7
if slamd-ctl save yard >/slamd-test/saved 2>&1 && [ "$(sed -n 's/^element vertex //p' /var/lib/slamd/yard/map.ply)" -gt 2000 ]; then
  pass "a drive is mapped and saved: $(cat /slamd-test/saved)"
else
  fail "a drive is mapped and saved: $(cat /slamd-test/saved)"
fi
wait $driven

# Each thread hangs in turn.
for thread in slamd-receive slamd-preproc slamd-odometry slamd-publish slamd; do
  restarts=$(of NRestarts) now=$(date +'%F %T') began=$SECONDS
  /slamd-test/stop_thread "$(of MainPID)" $thread >/slamd-test/stopped 2>&1 &
  words="$thread hangs"
  [ $thread != slamd ] || words="Watchdog timeout"
  if within 15 restarted_since "$restarts" && said_since "$now" "Watchdog timeout" && said_since "$now" "$words"; then
    again=$((SECONDS - began))
    if tracking 40; then
      pass "$thread hangs: restarted by the watchdog after $again s, $(of StatusText | cut -d: -f1) after $((SECONDS - began)) s"
    else
      fail "$thread hangs: restarted after $again s, but: $(of StatusText)"
    fi
  else
    fail "$thread hangs: $(cat /slamd-test/stopped)"
  fi
done

# It is killed, crashes, is stopped.
for signal in KILL SEGV STOP TERM; do
  restarts=$(of NRestarts) began=$SECONDS
  kill -$signal "$(of MainPID)"
  if within 15 restarted_since "$restarts" && again=$((SECONDS - began)) && tracking 40; then
    pass "SIG$signal: restarted after $again s, $(of StatusText | cut -d: -f1) after $((SECONDS - began)) s"
  else
    fail "SIG$signal: it is restarted"
  fi
done
if [ -e "/sys/fs/cgroup/$(of ControlGroup)/memory.max" ]; then
  restarts=$(of NRestarts)
  systemctl set-property --runtime slamd MemoryMax=8M
  if within 20 has_restarted "$restarts" && systemctl set-property --runtime slamd MemoryMax=1G && within 15 is_active; then
    pass "out of memory: killed and restarted"
  else
    fail "out of memory: killed and restarted"
  fi
else
  echo "SKIP service: out of memory: this kernel's cgroups have no memory controller"
fi

# The cable is out.
within 30 status_has TRACKING
restarts=$(of NRestarts) pid=$(of MainPID)
ip link set cable down
if within 8 status_has silent && sleep 60 && [ "$(of NRestarts)" = "$restarts" ] && [ "$(of MainPID)" = "$pid" ]; then
  pass "the cable is out for a minute: slamd lives, and says so: $(of StatusText)"
else
  fail "the cable is out for a minute: slamd lives, and says so"
fi
began=$SECONDS
ip link set cable up
is_heard() { ! status_has silent; }
if within 10 is_heard && [ "$(of NRestarts)" = "$restarts" ]; then
  pass "the cable is in again: heard after $((SECONDS - began)) s"
else
  fail "the cable is in again: $(of StatusText)"
fi
if within 30 status_has TRACKING; then
  pass "after a minute without LiDAR it is TRACKING again, after $((SECONDS - began)) s"
else
  fail "after a minute without LiDAR it is TRACKING again: $(of StatusText)"
fi

if journalctl -u slamd SLAMD_STATE=TRACKING SLAMD_THREAD=odometry -o cat --no-pager | grep -q TRACKING; then
  pass "the journal finds states by their fields"
else
  fail "the journal finds states by their fields"
fi

# An upgrade while it maps.
pid=$(of MainPID)
if DEBIAN_FRONTEND=noninteractive dpkg -i /slamd-test/next.deb >/slamd-test/dpkg.log 2>&1 && within 15 is_active && [ "$(of MainPID)" != "$pid" ] &&
  cmp -s $conf /slamd-test/good.toml && [ -e /var/lib/slamd/yard/map.ply ] && [ "$(dpkg-query -W -f '${Version}' slamd)" = 0.1.0+next ]; then
  pass "an upgrade under load restarts it, and keeps configuration and maps"
else
  cat /slamd-test/dpkg.log
  fail "an upgrade under load restarts it, and keeps configuration and maps"
fi
if tracking 40; then pass "the upgraded one is $(of StatusText | cut -d: -f1)"; else fail "the upgraded one tracks"; fi
kill -KILL $simulator

# Removal keeps the configuration, a purge nothing (slamd.service.d is the test's own).
dpkg -r slamd >>/slamd-test/dpkg.log 2>&1
if [ ! -e /usr/bin/slamd ] && [ -e $conf ] && ! is_active; then pass "a removal ends it and keeps the configuration"; else fail "a removal ends it and keeps the configuration"; fi
dpkg -P slamd slamd-tools >>/slamd-test/dpkg.log 2>&1
left=$(find / -xdev \( -path /proc -o -path /sys -o -path /slamd-test -o -path /var/log/journal -o -path /etc/systemd/system/slamd.service.d \) -prune -o -name '*slamd*' -print)
if [ -z "$left" ] && ! getent passwd slamd >/dev/null && ! getent group slamd >/dev/null; then
  pass "a purge leaves nothing"
else
  cat /slamd-test/dpkg.log
  fail "a purge leaves: $left $(getent passwd slamd) $(getent group slamd)"
fi
echo "DONE"
