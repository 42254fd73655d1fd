#!/bin/bash
# Builds the image and runs it for real, on a Debian machine that may have no container engine and reach no image
# registry: with Debian's own engine, and a base image made from the machine's Debian mirror.
#
#   docker/verify.sh          needs root; prints a line for every check; exit status 0 if all passed
#
# Environment: IMAGE (tag, default tumble:verify), SUITE (bookworm), COMPOSE_SUITE (the release whose compose is used,
# trixie), BASE_TAR (where to keep the base image between runs), TMPDIR (work folder; on a tmpfs half the time).
# The image is built without a bridge or firewall rules; everything runs in a network namespace of its own; nothing of
# the machine's network is changed. What it starts is ended by its id.
set -uo pipefail
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C
IMAGE=${IMAGE:-tumble:verify} SUITE=${SUITE:-bookworm} COMPOSE_SUITE=${COMPOSE_SUITE:-trixie}
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
work=$(mktemp -d) tools=$work/tools engine='' passed=0 failed=0 SECONDS=0
containers=()
export IMAGE PATH=$tools/usr/sbin:$tools/usr/bin:$PATH
export DOCKER_HOST=unix://$work/docker.sock DOCKER_CONFIG=$work/cli COMPOSE_PROJECT_NAME=verify$$
mkdir -p "$DOCKER_CONFIG/cli-plugins"

exec 3>&1 # a signal may come while a step's output is being kept
say() { printf '[%3ds] %s\n' "$SECONDS" "$*" >&3; }
expect() { # expect WHAT COMMAND...: runs it and counts
  local what=$1
  shift
  if "$@" >"$work/out" 2>&1; then
    passed=$((passed + 1)) && say "ok      $what"
  else
    failed=$((failed + 1)) && say "FAILED  $what"
    tail -n 20 "$work/out" >&3
    return 1
  fi
}
must() { expect "$@" || exit 1; }

stop_engine() {
  local i
  [[ -n $engine ]] || return 0
  kill "$engine" 2>/dev/null
  for i in {1..100}; do
    kill -0 "$engine" 2>/dev/null || break
    sleep 0.2
  done
  if ((i == 100)); then kill -KILL "$engine" 2>/dev/null; fi
  wait "$engine" 2>/dev/null
  engine=''
}
finish() {
  local container
  for container in "${containers[@]}"; do docker rm -f "$container" >/dev/null 2>&1; done
  stop_engine
  rm -rf "$work"
  echo "$passed passed, $failed failed" >&3
}
trap finish EXIT
trap 'say interrupted; exit 1' INT TERM

install_packages() { # without letting a package start its service
  local missing=() package policy=/usr/sbin/policy-rc.d made='' status
  for package in docker.io iptables iproute2 mmdebstrap; do
    dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  [[ -e $policy ]] || { printf '#!/bin/sh\nexit 101\n' >$policy && chmod +x $policy && made=yes; }
  timeout 300 apt-get -qq -o DPkg::Lock::Timeout=120 update &&
    DEBIAN_FRONTEND=noninteractive timeout 300 apt-get -qq -y -o DPkg::Lock::Timeout=120 \
      install --no-install-recommends "${missing[@]}"
  status=$?
  [[ -z $made ]] || rm -f $policy
  return $status
}

list_sources() { # the machine's own entries for these suites
  # shellcheck disable=SC2016 # the fields are apt's, not the shell's
  apt-get indextargets --format '$(REPO_URI) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
    awk -v want=" $* " 'index(want, " " $2 " ") { print "deb", $1, $2, $3 }' | sort -u
}

make_base_image() { # what the registry calls debian:SUITE-slim
  local tar=${BASE_TAR:-$work/base.tar} options=() line
  if [[ ! -s $tar ]]; then
    while read -r line; do options+=(--aptopt="$line"); done < <(apt-config dump | grep '^Acquire::Check')
    list_sources "$SUITE" "$SUITE-updates" "$SUITE-security" >"$work/sources"
    timeout 300 mmdebstrap --quiet --mode=root --format=tar --variant=minbase "${options[@]}" \
      --aptopt='Acquire::Languages "none"' --aptopt='Acquire::GzipIndexes "true"' \
      --aptopt='Dir::Cache::pkgcache ""' --aptopt='Dir::Cache::srcpkgcache ""' --dpkgopt=force-unsafe-io \
      --dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
      --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-include=/usr/share/doc/*/copyright' \
      "$SUITE" "$tar.part" - <"$work/sources" && mv "$tar.part" "$tar" || return 1
  fi
  timeout 120 docker import -c 'CMD ["bash"]' "$tar" "debian:$SUITE-slim"
}

unpack_compose() { # Compose v2 as users have it, from a newer release, beside the installed packages
  local apt=$work/apt
  mkdir -p "$apt/parts" "$apt/lists/partial" "$apt/cache/archives/partial"
  list_sources "$SUITE" | awk -v suite="$COMPOSE_SUITE" '{ $3 = suite; print }' >"$apt/sources.list"
  local options=(-qq -o Dir::Etc::sourcelist="$apt/sources.list" -o Dir::Etc::sourceparts="$apt/parts"
    -o Dir::State::lists="$apt/lists" -o Dir::Cache="$apt/cache" -o APT::Sandbox::User=root)
  timeout 600 apt-get "${options[@]}" update &&
    (cd "$apt" && timeout 600 apt-get "${options[@]}" download docker-compose && dpkg -x ./*.deb "$tools") &&
    cp "$tools"/usr/libexec/docker/cli-plugins/* "$DOCKER_CONFIG/cli-plugins/"
}

start_engine() { # start_engine build: the machine's network, no bridge; start_engine run: a network of its own
  local inside=(unshare --mount --propagation slave) options=()
  if [[ $1 == build ]]; then
    options=(--bridge=none --iptables=false --ip6tables=false --ip-forward=false --ip-masq=false)
  else # "host" mode containers find multicast on its loopback
    # shellcheck disable=SC2016 # the inner shell expands "$@"
    inside+=(--net sh -c 'ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo src 127.0.0.1 && exec "$@"' sh)
  fi
  # Its own requests go to a closed port, so that a missing image fails at once.
  HTTP_PROXY=http://127.0.0.1:9 HTTPS_PROXY=http://127.0.0.1:9 "${inside[@]}" dockerd --log-level warn "${options[@]}" \
    --data-root "$work/data" --exec-root "$work/exec" --pidfile "$work/pid" -H "$DOCKER_HOST" >>"$work/engine.log" 2>&1 &
  engine=$!
  for _ in {1..60}; do
    docker version >/dev/null 2>&1 && return 0
    kill -0 $engine 2>/dev/null || break
    sleep 0.5
  done
  tail -n 20 "$work/engine.log"
  return 1
}

build_image() {
  DOCKER_BUILDKIT=1 timeout 2400 docker build --network host --build-arg BASE_IMAGE="debian:$SUITE-slim" \
    -f "$root/docker/Dockerfile" -t "$IMAGE" "$root"
}
is_small() { (($(docker image inspect -f '{{.Size}}' "$IMAGE") <= 200000000)); }
has_user() { docker image inspect -f '{{.Config.User}}' "$IMAGE" | grep -qxE '[1-9][0-9]*:[1-9][0-9]*'; }
run_hardened() { # as Kubernetes would
  container=$(docker run -d --read-only --tmpfs /tmp --cap-drop ALL --security-opt no-new-privileges --pids-limit 256 \
    --memory 1g "$IMAGE" --demo pyramid --record /data/run.lcm) && containers+=("$container")
}
becomes_healthy() {
  local state
  for _ in {1..120}; do
    state=$(docker inspect -f '{{.State.Status}} {{.State.Health.Status}}' "$1")
    [[ $state == "running healthy" ]] && return 0
    [[ $state == running* ]] || break
    sleep 0.5
  done
  docker logs --tail 20 "$1"
  return 1
}
stops_well() { # SIGTERM ends it long before the kill, with status 0
  local before=$SECONDS
  timeout 30 docker stop -t 10 "$1" && ((SECONDS - before <= 5)) &&
    [[ $(docker inspect -f '{{.State.ExitCode}}' "$1") == 0 ]]
}
log_is_whole() { # the recording is closed to its last byte and repeats to the bit
  local replayer
  replayer=$(docker run -d --volumes-from "$container:ro" "$IMAGE" --replay /data/run.lcm) && containers+=("$replayer")
  [[ $(timeout 120 docker wait "$replayer") == 0 ]] && docker logs "$replayer" 2>&1 | grep "came out the same" &&
    ! docker logs "$replayer" 2>&1 | grep -E "the log ends|differs"
}
compose() { timeout 120 docker compose -f "$root/docker/compose.yaml" "${overrides[@]}" "$@"; }
height() { compose exec -T client tumble list --json | sed -n 's/.*"name":"ball".*"position":\[[^,]*,[^,]*,\([^]]*\)\].*/\1/p'; }
clients_are_heard() { # commands, answers and states cross from container to container; 0.5 s are 120 steps
  compose exec -T client sh -c 'tumble pause && tumble set ball --at 0 0 50 &&
    tumble push ball --force 0 0 30 --seconds 0.5 && tumble step 120' && height | awk '{ exit !($1 > 51 && $1 < 70) }' &&
    compose exec -T client tumble resume
}
recorder_hears() { compose exec -T recorder sh -c 'grep -c TUMBLE_STATE /data/bus.lcm && grep -c TUMBLE_ACK /data/bus.lcm'; }
machine_hears() { # a process outside of every container, in the network that "host" mode shares
  docker create --name "copy$$" "$IMAGE" && containers+=("copy$$") && docker cp "copy$$:/usr/local/bin/tumble-server" "$work/" &&
    nsenter -t "$(cat "$work/pid")" -n "$work/tumble-server" --health
}

[[ $EUID == 0 ]] || { say "root is needed" && exit 1; }
must 'packages are installed' install_packages
must "compose of $COMPOSE_SUITE is unpacked" unpack_compose
must 'the engine starts (to build)' start_engine build
must "a base image debian:$SUITE-slim is made" make_base_image
must 'the image builds' build_image
expect 'it is at most 200 MB' is_small
say "        base $(($(docker image inspect -f '{{.Size}}' "debian:$SUITE-slim") / 1000000)) MB, image $(($(docker image inspect -f '{{.Size}}' "$IMAGE") / 1000000)) MB"
expect 'its user is a number, not root' has_user
stop_engine
must 'the engine starts (to run)' start_engine run
must 'it runs read-only, without capabilities' run_hardened
expect 'it becomes healthy, as its own binary says' becomes_healthy "$container"
expect 'SIGTERM stops it within 5 s, with status 0' stops_well "$container"
expect 'its recording is closed and repeats to the bit' log_is_whole
overrides=()
expect 'compose.yaml is valid' compose config -q
expect 'its services start and become healthy' compose up -d --no-build --pull never --wait --wait-timeout 60
expect 'containers exchange state, a push and its answer' clients_are_heard
expect 'the recorder hears state and answers' recorder_hears
expect 'its services stop' compose down -t 10 -v
overrides=(-f "$root/docker/host.yaml")
expect 'host.yaml is valid' compose config -q
expect 'on the host network its services start' compose up -d --no-build --pull never --wait --wait-timeout 60
expect 'a process outside of containers hears the server' machine_hears
expect 'its services stop' compose down -t 10 -v
((failed == 0))
