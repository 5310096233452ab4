# SPDX-License-Identifier: Apache-2.0
"""A data set made by a real Slurm on this machine, loopback alone: python3 slurm_test.py AIRTRUTH CATALOGUE

Starts munged, slurmctld and slurmd from Debian's packages in a folder of their own, submits the catalogue as an array,
kills a task in the middle and has Slurm put it back, and compares every annotation with those of a local build.
"""

import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

CONFIGURATION = """ClusterName=t
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={root}/munge.socket
CredType=cred/munge
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_interval=1
MinJobAge=86400
SlurmdTimeout=300
ReturnToService=2
KillWait=3
MailProg=/bin/true
StateSaveLocation={root}/state
SlurmdSpoolDir={root}/spool
SlurmctldPidFile={root}/slurmctld.pid
SlurmdPidFile={root}/slurmd.pid
SlurmctldLogFile={root}/slurmctld.log
SlurmdLogFile={root}/slurmd.log
NodeName=localhost CPUs={cpus} RealMemory=500 State=UNKNOWN
PartitionName=p Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""

DEADLINE_S = 300


OVER = {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "OUT_OF_MEMORY", "BOOT_FAIL", "DEADLINE"}


class Failed(Exception):
    pass


def output(*command, check=True):
    done = subprocess.run(command, capture_output=True, text=True)
    if check and done.returncode != 0:
        raise Failed(f"{command} ends with {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


def wait_for(what, condition, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.3)
    raise Failed(f"{what} took more than {seconds} s")


class Cluster:
    def __init__(self, root):
        self.root = root
        self.daemons = []

    def __enter__(self):
        os.chmod(self.root, 0o755)
        with open(os.path.join(self.root, "munge.key"), "wb") as key:
            key.write(os.urandom(128))
        os.chmod(key.name, 0o600)
        port = 20000 + os.getpid() % 20000
        configuration = os.path.join(self.root, "slurm.conf")
        with open(configuration, "w") as file:
            file.write(CONFIGURATION.format(root=self.root, controller=port, node=port + 1, cpus=min(os.cpu_count(), 4)))
        os.environ["SLURM_CONF"] = configuration
        place = lambda name: os.path.join(self.root, name)
        self.start("munged", "-F", "--socket=" + place("munge.socket"), "--key-file=" + place("munge.key"),
                   "--pid-file=" + place("munged.pid"), "--log-file=" + place("munged.log"),
                   "--seed-file=" + place("munge.seed"))
        self.start("slurmctld", "-D", "-f", configuration)
        self.start("slurmd", "-D", "-f", configuration)
        wait_for("the cluster's start", lambda: "idle" in output("sinfo", "-h", "-o", "%T", check=False), 60)
        return self

    def start(self, *command):
        self.daemons.append(subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    def __exit__(self, *what):
        if what[0] is Failed:
            self.explain()
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in reversed(self.daemons):
            try:
                daemon.wait(5)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()


    def explain(self):
        """What Slurm thought, for whom it fails."""
        print(output("squeue", "-r", "-t", "all", "-o", "%i %T %r %S %M", check=False))
        print(output("sinfo", "-N", "-o", "%N %T %E %c", check=False))
        for name in ("slurmctld.log", "slurmd.log", *(os.path.join(d, n) for d, _, names in os.walk(self.root) for n in names if n in ("work-0.log", "verify.log"))):
            try:
                with open(os.path.join(self.root, name), errors="replace") as file:
                    print(name, "ends:", *file.read().splitlines()[-25:], sep="\n  ")
            except FileNotFoundError:
                print(name, "is not there")


def start_waiting(tasks):
    """Tasks that were put back wait for about two minutes, unless told to start; while one is ending it cannot be told."""
    for task, state in tasks.items():
        if state == "PENDING":
            output("scontrol", "update", "jobid=" + task, "starttime=now", check=False)
    return tasks


def states(job):
    """Task -> state, of a job or an array."""
    found = {}
    for line in output("squeue", "-h", "-r", "-t", "all", "-j", job, "-o", "%i|%T", check=False).split():
        task, state = line.split("|")
        found[task] = state
    return found


def are_over(tasks):
    return bool(tasks) and set(tasks.values()) <= OVER


def annotations(folder):
    found = {}
    for where, _, files in os.walk(os.path.join(folder, "sequences")):
        for name in files:
            if name.endswith((".jsonl", ".xml", ".mkv", ".mp4")):
                path = os.path.join(where, name)
                with open(path, "rb") as file:
                    found[os.path.relpath(path, folder)] = hashlib.sha256(file.read()).hexdigest()
    return found


def workers(out):
    """Process numbers of the tasks at work in a folder."""
    return [int(pid) for pid in output("pgrep", "-f", f"dataset work .*{re.escape(out)} ", check=False).split()]


def main():
    airtruth, catalogue = sys.argv[1:3]
    missing = [name for name in ("munged", "slurmctld", "slurmd", "sbatch") if shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") is None]
    if missing or os.getuid() != 0:
        print("slurm_test: skipped:", "not root" if not missing else "missing " + ", ".join(missing))
        sys.exit(77)
    os.environ["PATH"] += ":/usr/sbin"
    with tempfile.TemporaryDirectory(prefix="airtruth_slurm_") as root, Cluster(root):
        # Quotes, patterns and commands in the name of the folder are a name.
        out = os.path.join(root, "it's a \"set\" %a #1 $(touch EVIL) `touch EVIL`")
        said = output(airtruth, "dataset", "submit", catalogue, "--out", out, "--slurm", "--array-size", "3",
                      "--sbatch", "--time=30:00", "--sbatch", "--mem=100M")
        work, verify = re.search(r"as (\d+), verified by (\d+)", said).groups()
        # One task is killed at work, then put back.
        victim = wait_for("the first task's start", lambda: workers(out), 120)[0]
        time.sleep(3)
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            raise Failed("the task was over before it could be killed")
        limits = output("scontrol", "-o", "show", "job", work)
        if "TimeLimit=00:30:00" not in limits or "MinMemoryNode=100M" not in limits:
            raise Failed(f"the array has other limits: {limits}")
        logs = sorted(name for name in os.listdir(os.path.join(out, "slurm")) if name.endswith(".log"))
        if not logs or logs[0] != "work-0.log":
            raise Failed(f"logs are named {logs}")
        failed = wait_for("the kill", lambda: [t for t, s in states(work).items() if s in ("FAILED", "NODE_FAIL")], 60)
        # Slurm refuses to start a task in the second in which it was killed.
        time.sleep(2)
        output("scontrol", "requeue", failed[0])
        print("killed and requeued:", failed[0])
        wait_for("the array", lambda: are_over(start_waiting(states(work))), DEADLINE_S)
        if set(states(work).values()) != {"COMPLETED"}:
            raise Failed(f"the array ended as {states(work)}")
        wait_for("the last job", lambda: are_over(start_waiting(states(verify))), DEADLINE_S)
        local = os.path.join(root, "local")
        output(airtruth, "dataset", "build", catalogue, "--out", local)
        here, there = annotations(local), annotations(out)
        differing = [name for name in here if there.get(name) != here[name] and not name.endswith(".mp4")]
        if set(here) != set(there) or differing:
            raise Failed(f"{len(here)} files here, {len(there)} there; these differ: {differing[:5]}")
        # The job after the array may have ended before the requeued task: the manifest is written, or can be now.
        check = subprocess.run([airtruth, "dataset", "verify", out, "--finish"], capture_output=True, text=True)
        if check.returncode != 0:
            raise Failed(check.stdout + check.stderr)
        print(check.stdout.strip())
        print(f"{len(here)} files are the same bytes as those of a local build")


if __name__ == "__main__":
    try:
        main()
    except Failed as failed:
        sys.exit(f"slurm_test: {failed}")
