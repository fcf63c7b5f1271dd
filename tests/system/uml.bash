# A computer with CAN, for what this one's kernel may not have: Debian's user-mode Linux, whose root is this computer's
# own file system. Sourced after verdicts.bash; ends the script with a visible skip where it is not installed.
needs linux.uml busybox ip
uml_modules=$(find /usr/lib/uml/modules -maxdepth 2 -name kernel 2>/dev/null | head -n 1)
[ -n "$uml_modules" ] || { skip "user-mode Linux has no modules (tools/setup)"; exit 0; }

needs g++
g++ -O1 -shared -fPIC -o "$scratch/uml_registers.so" tests/system/uml_registers.cpp || { fail "uml_registers.cpp compiles"; exit 1; }

# in_uml SECONDS SCRIPT: boots it, runs the bash script there as root, and returns its exit status; 125: it was cut short.
# vcan0 is up, and lo carries multicast. What the script prints comes out here.
in_uml() {
  local guest=$scratch/uml code=125
  mkdir -p "$guest"
  rm -f "$guest/code"
  cat >"$guest/init" <<END
#!$(command -v busybox) sh
export PATH=$PATH HOME=/root
bb=$(command -v busybox)
\$bb mount -t proc none /proc
\$bb mount -t sysfs none /sys
\$bb mount -t tmpfs none /run
\$bb mount -t devtmpfs none /dev 2>/dev/null
\$bb mkdir -p /dev/pts
\$bb mount -t devpts none /dev/pts
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan drivers/net/can/slcan/slcan; do
  \$bb insmod $uml_modules/\$module.ko
done
echo 8388608 >/proc/sys/net/core/rmem_max
ip link set lo up
ip route add 224.0.0.0/4 dev lo
ip link add dev vcan0 type vcan
ip link set vcan0 up
cd $PWD
bash $2 >$guest/said 2>&1
echo \$? >$guest/code
\$bb sync
\$bb poweroff -f
END
  chmod +x "$guest/init"
  # It has one processor, and is slow where its processes hop between this computer's; a real one would share it with nobody.
  local alone=()
  local last; last=$(sed -nE 's/^Cpus_allowed_list:(.*[^0-9])?([0-9]+)$/\2/p' /proc/self/status)
  taskset -c "$last" true 2>/dev/null && alone=(taskset -c "$last")
  nice -n -15 true 2>/dev/null && alone+=(nice -n -15)
  LD_PRELOAD="$scratch/uml_registers.so" timeout "$1" "${alone[@]}" linux.uml mem=768M root=/dev/root rootfstype=hostfs rootflags=/ rw quiet con=null con0=null,fd:2 con1=null,fd:2 \
    ssl=null init="$guest/init" </dev/null >"$guest/console" 2>&1
  [ -f "$guest/code" ] && code=$(cat "$guest/code")
  [ -f "$guest/said" ] && cat "$guest/said"
  [ "$code" -ne 125 ] || tail -n 5 "$guest/console"
  return "$code"
}
