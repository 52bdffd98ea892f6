#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The Debian package on a system of its own: a bare Debian 12 (mmdebstrap, kept in build/system) in which it is installed, which is booted with its
# own systemd (systemd-nspawn), fed by `kinemap replay`, and in which the daemon is killed, held, reloaded, upgraded, removed and purged.
# Needs root and the packages mmdebstrap and systemd-container (tools/setup.sh --tests); 77: skipped, since something is missing. Builds first.
# The last line: "N passed, N failed".
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

skip() {
  echo "SKIPPED: tools/test-system.sh: $*" >&2
  ((${failed:-0} == 0)) || exit 1 # what was done before it did not pass
  exit 77
}
((EUID == 0)) || skip "needs root, to make a root file system and to boot it"
for program in mmdebstrap systemd-nspawn nsenter cpack; do
  command -v "$program" >/dev/null || skip "$program is missing; tools/setup.sh --tests installs it"
done

work=$PWD/build/system
root=$work/root
unit=kinemapd.service
container=
passed=0
failed=0
mkdir -p "$work"

end() {
  if [[ -n $container ]]; then
    inside systemctl poweroff >/dev/null 2>&1 || true
    timeout 20 tail --pid="$container" -f /dev/null || kill -KILL "$container"
  fi
  rm -rf "$root"
}
trap end EXIT

# step WHAT COMMAND…: one line of the report; what a failed step printed follows. In a shell of its own, and in no condition: there any command that
# fails ends it (set -e).
step() {
  local what=$1 code
  shift
  set +e
  (
    set -e
    "$@"
  ) >"$work/step.log" 2>&1
  code=$?
  set -e
  if ((code == 0)); then
    echo "ok      $what"
    passed=$((passed + 1))
  else
    echo "FAILED  $what"
    tail -n 20 "$work/step.log" | sed 's/^/          /'
    failed=$((failed + 1))
  fi
}

not() {
  if "$@"; then
    echo "this should have failed: $*"
    return 1
  fi
}

# eventually COMMAND…: within 40 s.
eventually() {
  local i
  for ((i = 0; i < 200; i++)); do
    "$@" >/dev/null 2>&1 && return
    sleep 0.2
  done
  echo "this did not come true in 40 s: $*"
  if [[ -n $container ]]; then inside journalctl --no-pager -n 12 -o cat -u "$unit"; fi
  return 1
}

# --- the system ---------------------------------------------------------------------------------------------------------------------------------

# The package's own dependencies are in the base, so that it is installed without a network, as on the PC of a suit.
base_system() {
  local deb=$1 include base
  include=$(dpkg-deb -f "$deb" Depends | sed 's/([^)]*)//g; s/ //g')
  include=systemd,systemd-sysv,dbus,procps,$include
  base=$work/base-$(sha256sum <<<"$include" | cut -c1-12).tar
  if [[ ! -f $base ]]; then
    echo "test-system: making a bare Debian 12 (two minutes, once)" >&2
    if ! mmdebstrap --quiet --variant=minbase --include="$include" bookworm "$work/new.tar" >"$work/mmdebstrap.log" 2>&1; then
      tail -n 5 "$work/mmdebstrap.log" >&2
      skip "mmdebstrap could not make a root file system (network?)"
    fi
    mv "$work/new.tar" "$base"
  fi
  rm -rf "$root"
  mkdir -p "$root"
  tar -C "$root" --exclude='./dev/*' -xf "$base"
}

in_bare_root() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
inside() {
  nsenter --target "$(leader)" --mount --uts --ipc --net --pid --root --wd \
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C "$@"
}
leader() { pgrep -P "$container" -x systemd; }

# Many containers let no container be made in them.
can_contain() { timeout 30 systemd-nspawn --quiet --register=no --keep-unit --private-network -D "$root" /bin/true </dev/null >"$work/step.log" 2>&1; }
start_container() {
  systemd-nspawn --quiet --register=no --keep-unit --private-network --boot -D "$root" </dev/null >"$work/boot.log" 2>&1 &
  container=$!
}
booted() { eventually inside systemctl is-active multi-user.target || { tail -n 5 "$work/boot.log" && return 1; }; }

# --- what is asked of the daemon ----------------------------------------------------------------------------------------------------------------

show() { inside systemctl show --value -p "$1" "$unit"; }
active() { [[ $(show ActiveState) == active ]]; }
objects() { inside kinemap map --json 2>/dev/null | grep -oE '"type": ?"' | wc -l; }
has_objects() { (($(objects) >= $1)); }
logged() { inside journalctl --no-pager -o cat -u "$unit" | grep -F -- "$1"; }
new_process() { active && [[ $(show MainPID) != "$1" ]]; }
host_pid() { pgrep -x kinemapd --ns "$(leader)" --nslist pid; }

installed() {
  in_bare_root dpkg --install "/root/$(basename "$1")"
  test -f "$root/etc/kinemap/config.json"
  test -L "$root/etc/systemd/system/multi-user.target.wants/$unit"
}
remarked() { lintian --allow-root --fail-on error,warning "$1"; }
told_systemd() { show StatusText | grep -F "waiting for the suit"; }
journal_fields() { inside journalctl -u "$unit" -o export | grep -aE '^(PRIORITY=6|SYSLOG_IDENTIFIER=kinemapd|_TRANSPORT=journal)$' | sort -u | wc -l | grep -x 3; }
exposure() { inside systemd-analyze security --no-pager --threshold=12 "$unit"; }

start_replay() {
  inside kinemap replay /root/session.pcap --speed 8 >"$work/replay.log" 2>&1 &
  replay=$!
}
killed() {
  local pid objects_before
  pid=$(show MainPID)
  objects_before=$(objects)
  inside systemctl kill --signal=KILL "$unit"
  eventually new_process "$pid"
  eventually has_objects "$objects_before"
  eventually logged "the suit's stream goes on"
  eventually logged "goes on with the socket of the daemon before"
}
walked_to_the_end() {
  tail --pid="$replay" -f /dev/null
  eventually has_objects 7
}
watchdog_timeouts() { inside journalctl --no-pager -o cat -u "$unit" | grep -c "Watchdog timeout" || true; }
stopped_by_signal() {
  local pid
  pid=$(show MainPID)
  inside kill -STOP "$pid"
  eventually new_process "$pid"
  (($(watchdog_timeouts) == 1))
  eventually has_objects 7
}
held_detection() {
  local pid
  pid=$(show MainPID)
  /usr/bin/python3 tests/system/hold_thread.py "$(host_pid)" detection
  eventually new_process "$pid"
  (($(watchdog_timeouts) == 2))
  eventually has_objects 7
}
reloaded() {
  local pid
  pid=$(show MainPID)
  sed -i 's/"level": "info"/"level": "debug"/' "$root/etc/kinemap/config.json"
  inside systemctl reload "$unit"
  eventually logged "log.level has changed"
  [[ $(show MainPID) == "$pid" ]]
  active
}
refused_reload() {
  local pid
  pid=$(show MainPID)
  cp "$root/etc/kinemap/config.json" "$work/config.json"
  echo '{"suit": {"prot": 1}}' >"$root/etc/kinemap/config.json"
  inside systemctl reload "$unit"
  eventually logged "the configuration stays as it was"
  [[ $(show MainPID) == "$pid" ]]
  active
}
refused_start() {
  not inside systemctl restart "$unit"
  sleep 3 # a second try would come after one
  local state
  state=$(show ActiveState)
  cp "$work/config.json" "$root/etc/kinemap/config.json"
  [[ $state == failed ]]
  logged "suit.prot"
  inside systemctl reset-failed "$unit"
  inside systemctl start "$unit"
}
upgraded() {
  local pid
  pid=$(show MainPID)
  inside dpkg --install "/root/$(basename "$1")"
  eventually new_process "$pid"
  eventually has_objects 7
  inside dpkg-query --show --showformat '${Version}' kinemap | grep -x -- "$(dpkg-deb -f "$1" Version)"
  grep '"level": "debug"' "$root/etc/kinemap/config.json"
}
removed() {
  local pid
  pid=$(show MainPID)
  inside dpkg --remove kinemap
  not inside test -e "/proc/$pid"
  not test -e "$root/usr/bin/kinemapd"
  test -f "$root/etc/kinemap/config.json"
  test -d "$root/var/lib/private/kinemap/sessions"
}
# What `kinemap pair` wrote goes with the package, what the administrator put beside it stays.
pair_purged() {
  in_bare_root kinemap pair --host 127.0.0.1
  grep -q 0.0.0.0 "$root/etc/kinemap/conf.d/remote.json"
  in_bare_root kinemapd --config /etc/kinemap/config.json --print-config | grep -F '"address": "0.0.0.0"'
  test -f "$root/etc/credstore/kinemap.key"
  echo '{"api": {"max_clients": 32}}' >"$root/etc/kinemap/conf.d/site.json"
  openssl ecparam -genkey -name prime256v1 -noout -out "$root/etc/credstore/kinemap.key"
  in_bare_root dpkg --purge kinemap
  local left
  left=$(cd "$root" && find etc/kinemap etc/credstore -type f | sort | tr '\n' ' ')
  [[ $left == "etc/credstore/kinemap.key etc/kinemap/conf.d/site.json " ]] || { echo "left: $left" && return 1; }
  rm -r "$root/etc/credstore/kinemap.key" "$root/etc/kinemap"
}
purged() {
  inside dpkg --purge kinemap
  local left
  left=$(cd "$root" && find etc run usr var -name '*kinemap*' -not -path 'var/log/*')
  [[ -z $left ]] || { echo "still there: $left" && return 1; }
  not inside systemctl cat "$unit"
}

# --- from the beginning to the end --------------------------------------------------------------------------------------------------------------

first=$(tools/package.sh 2>/dev/null)
second=$(tools/package.sh --release 2 2>/dev/null)
build/release/tools/kinemap/kinemap sim --seed 3 --out "$work/session" >/dev/null
base_system "$first"
cp "$first" "$second" "$work/session/session.pcap" "$root/root/"

if command -v lintian >/dev/null; then step "lintian has nothing to remark" remarked "$first"; fi
step "installed in a bare root file system: enabled, default configuration" installed "$first"
step "purge takes what kinemap pair wrote, and leaves what the administrator did" pair_purged
step "installed again" installed "$first"
can_contain || skip "systemd-nspawn cannot make a container here: $(tail -n 1 "$work/step.log")"
start_container
booted >"$work/step.log" 2>&1 || skip "a bare Debian does not boot under systemd-nspawn here: $(tail -n 1 "$work/step.log")"
step "boots under a real systemd ($(in_bare_root systemctl --version | head -n 1))" booted
step "the service is up: READY was said" eventually active
step "systemctl status says that it waits for the suit" told_systemd
step "messages are in the journal with their fields" journal_fields
step "exposure as systemd sees it running: at most 1.2" exposure
start_replay
step "fed by kinemap replay: objects appear" eventually has_objects 2
step "kill -9 in the middle of the walk: back, with the same socket and all objects, and the session goes on" killed
step "the walk ends: at least 7 of its 9 objects are there" walked_to_the_end
step "SIGSTOP: the watchdog brings it back" stopped_by_signal
step "the detection thread alone is held: the watchdog notices and brings it back" held_detection
step "reload takes over a changed key, in the same process" reloaded
step "reload of a wrong configuration: stays as it was, and says so" refused_reload
step "start with a wrong configuration: refused, not tried again, the key is named" refused_start
step "upgrade: the new version runs, map and configuration are kept" upgraded "$second"
step "remove: stopped and gone; configuration and sessions stay" removed
step "purge: nothing is left" purged

echo "$passed passed, $failed failed"
((failed == 0))
