#!/usr/bin/env bash
# Unpacks the arm64 libraries that slamd links into $SLAMD_CACHE/arm64-sysroot. Nothing of them is installed
# or run here, so the machine's own package system stays as it is. Kept until the list below changes.
set -euo pipefail
packages=libc6-dev,libstdc++-12-dev,libgcc-12-dev,linux-libc-dev
packages+=,libeigen3-dev,libpcap-dev,libtomlplusplus-dev,libcli11-dev,libspdlog-dev,libfmt-dev,libpng-dev
packages+=,liblcm-dev,nlohmann-json3-dev,libgeographiclib-dev,libgtest-dev,libgmock-dev,librapidcheck-dev

cache=${SLAMD_CACHE:-$HOME/.cache/slamd}
root=$cache/arm64-sysroot
if [ "$(cat "$root/.packages" 2>/dev/null)" = "$packages" ]; then
  exit 0
fi
rm -rf "$root" "$root.new"
mkdir -p "$cache"
# As root only to unpack: "extract" runs no maintainer script, so no emulator is needed.
mmdebstrap --mode=root --variant=extract --architectures=arm64 --include="$packages" bookworm "$root.new"
# Debian's cross compiler searches lib and usr/lib; a merged tree serves both.
echo "$packages" >"$root.new/.packages"
mv "$root.new" "$root"
