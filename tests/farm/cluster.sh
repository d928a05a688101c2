#!/bin/sh
# A Slurm cluster on this machine alone, for tests: a controller and some nodes, all on loopback addresses and free ports, all files in one
# directory. Needs slurmctld, slurmd, slurm-client and munge (Debian 12); no root, no systemd, no cgroups, no database.
#
#   cluster.sh up DIR NODES     starts it and waits until all nodes n1, n2, ... are idle; then SLURM_CONF=DIR/slurm.conf sbatch ...
#   cluster.sh kill DIR NODE    kills a node as a power cut would: its daemon, the keepers of its steps and the steps (SIGKILL)
#   cluster.sh down DIR         ends all of it
set -eu
PATH=$PATH:/usr/sbin:/sbin
what=$1 dir=$2
export SLURM_CONF="$dir/slurm.conf"

# The processes of steps on a node (on all nodes without one), and those that keep them: known by what they were started with.
steps() {
    for process in /proc/[0-9]*; do
        { tr '\0' '\n' <"$process/environ"; } >"$dir/environment" 2>/dev/null || continue
        grep -qxF "SLURM_CONF=$SLURM_CONF" "$dir/environment" || continue
        node=$(sed -n 's/^SLURMD_NODENAME=//p' "$dir/environment")
        [ -n "$node" ] && [ "$node" = "${1:-$node}" ] || continue
        echo "${process#/proc/}"
        parent=$(sed -n 's/^PPid:[[:space:]]*//p' "$process/status" 2>/dev/null) || continue
        case $(cat "/proc/${parent:-0}/comm" 2>/dev/null) in slurmstepd*) echo "$parent" ;; esac
    done | sort -u
    rm -f "$dir/environment"
}

# Ends processes, gently first, and waits for each.
end() {
    for process in "$@"; do
        kill "$process" 2>/dev/null || true
    done
    for process in "$@"; do
        i=0
        while kill -0 "$process" 2>/dev/null; do
            [ $i -ne 40 ] || kill -9 "$process" 2>/dev/null || true
            i=$((i + 1))
            sleep 0.1
        done
    done
}

configuration() {
    user=$(id -un) host=$(hostname -s)
    cat <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$1
SlurmUser=$user
SlurmdUser=$user
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthType=auth/munge
AuthInfo=socket=$dir/munge/socket
StateSaveLocation=$dir/state
SlurmdSpoolDir=$dir/spool/%n
SlurmctldPidFile=$dir/controller.pid
SlurmdPidFile=$dir/node-%n.pid
SlurmctldLogFile=$dir/log/controller
SlurmdLogFile=$dir/log/node-%n
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$dir/log/jobs
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
# A killed node is missed after ten seconds, and one that was only slow may come back.
SlurmdTimeout=10
ReturnToService=2
KillWait=10
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=3,sched_interval=3,batch_sched_delay=1
END
    shift
    i=1 nodes=
    for port in "$@"; do
        echo "NodeName=n$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$port CPUs=1 State=UNKNOWN"
        nodes=$nodes${nodes:+,}n$i i=$((i + 1))
    done
    echo "PartitionName=all Nodes=$nodes Default=YES MaxTime=INFINITE State=UP"
}

case $what in
up)
    umask 022
    mkdir -p "$dir/state" "$dir/log" "$dir/munge" "$dir/spool"
    # Ports that nobody has, held until all are known.
    # shellcheck disable=SC2046
    set -- $(python3 -c '
import socket, sys
held = [socket.create_server(("127.0.0.1", 0)) for _ in range(int(sys.argv[1]) + 1)]
print(*(one.getsockname()[1] for one in held))' "$3")
    configuration "$@" >"$SLURM_CONF"
    nodes=$(($# - 1))
    key=$dir/munge/private
    mkdir -p -m 700 "$key"
    (umask 077 && head -c 1024 /dev/urandom >"$key/key")
    # --force: temporary directories may be written to by anybody.
    munged --force --key-file="$key/key" --seed-file="$key/seed" --log-file="$key/log" \
        --pid-file="$dir/munge/pid" --socket="$dir/munge/socket"
    slurmctld
    i=1
    while [ $i -le $nodes ]; do
        mkdir -p "$dir/spool/n$i"
        slurmd -N "n$i"
        i=$((i + 1))
    done
    i=0
    until [ "$(sinfo --noheader --Node --states=idle --format=%N 2>/dev/null | wc -l)" -eq $nodes ]; do
        i=$((i + 1))
        if [ $i -gt 120 ]; then
            echo "the nodes do not come up" >&2
            tail -n 20 "$dir"/log/* >&2
            exit 1
        fi
        sleep 0.25
    done
    ;;
kill)
    # All at once, lest one of them tells of the others' end.
    # shellcheck disable=SC2046
    kill -9 $(cat "$dir/node-$3.pid") $(steps "$3")
    ;;
down)
    # shellcheck disable=SC2046
    end $(cat "$dir"/node-*.pid "$dir/controller.pid" 2>/dev/null) $(steps)
    # shellcheck disable=SC2046
    end $(cat "$dir/munge/pid" 2>/dev/null)
    ;;
*)
    echo "up, kill or down?" >&2
    exit 2
    ;;
esac
