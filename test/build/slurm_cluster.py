"""A Slurm of two nodes on this machine alone: own key, own ports, loopback, everything in one folder."""
import getpass
import os
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol", "sinfo")
CONFIG = """
ClusterName=softarm_test
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
SlurmctldPort={ports[0]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool_%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd_%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd_%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
MpiDefault=none
ReturnToService=2
KillWait=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class NoSlurm(Exception):
    """Why there is none here."""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    """Its commands find it by `environment`. Ended by end(), or by the end of a with block."""

    def __init__(self, folder):
        path = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
        missing = [name for name in PROGRAMS if shutil.which(name, path=path) is None]
        if missing:
            raise NoSlurm(f"no {', '.join(missing)} on this machine (Debian: slurm-wlm)")
        self.folder = folder
        self.processes = []
        self.config = os.path.join(folder, "slurm.conf")
        self.environment = {**os.environ, "PATH": path, "SLURM_CONF": self.config}
        os.makedirs(os.path.join(folder, "munge"), mode=0o700)
        os.chmod(folder, 0o755)  # munged: nobody else may write here, and its clients must get in
        for name in ("state", "spool_n1", "spool_n2"):
            os.mkdir(os.path.join(folder, name))
        key = os.path.join(folder, "munge/key")
        with open(key, "wb") as file:
            file.write(os.urandom(1024))
        os.chmod(key, 0o400)
        with open(self.config, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(folder=folder, host=socket.gethostname().split(".")[0], user=getpass.getuser(),
                                     ports=free_ports(3)))
        try:
            self.start()
        except BaseException:
            self.end()
            raise

    def start(self):
        munge = os.path.join(self.folder, "munge")
        self.daemon("munged", "--foreground", "--force", f"--socket={munge}/socket", f"--key-file={munge}/key",
                    f"--log-file={munge}/log", f"--pid-file={munge}/pid", f"--seed-file={munge}/seed")
        self.wait_for("munged", lambda: os.path.exists(f"{munge}/socket"))
        self.daemon("slurmctld", "-D", "-f", self.config)
        for node in ("n1", "n2"):
            self.daemon("slurmd", "-D", "-f", self.config, "-N", node)
        self.wait_for("slurmd", lambda: self.states() == {"n1": "idle", "n2": "idle"})

    def daemon(self, *words):
        with open(os.path.join(self.folder, f"said_{len(self.processes)}.txt"), "wb") as said:
            self.processes.append((words[0], subprocess.Popen(
                words, env=self.environment, stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT,
                start_new_session=True)))

    def wait_for(self, name, ready, seconds=60.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for i, (program, process) in enumerate(self.processes):
                if process.poll() is not None:
                    with open(os.path.join(self.folder, f"said_{i}.txt"), encoding="utf-8", errors="replace") as said:
                        lines = said.read().strip().splitlines()
                    raise NoSlurm(f"{program} does not start here: {lines[-1] if lines else process.returncode}")
            if ready():
                return
            time.sleep(0.1)
        raise NoSlurm(f"{name} is not ready within {seconds:.0f} s")

    def ask(self, *words):
        return subprocess.run(words, env=self.environment, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              encoding="utf-8", timeout=60).stdout

    def states(self):
        lines = self.ask("sinfo", "--noheader", "--Node", "--format=%N %T").splitlines()
        return dict(line.split() for line in lines if len(line.split()) == 2)

    def queue(self):
        return self.ask("squeue", "--noheader", "--array", "--format=%i %t").splitlines()

    def drain(self, node):
        self.ask("scontrol", "update", f"NodeName={node}", "State=DRAIN", "Reason=test")

    def resume(self, node):
        self.ask("scontrol", "update", f"NodeName={node}", "State=RESUME")

    def end(self):
        if any(name == "slurmctld" for name, _ in self.processes):
            subprocess.run(["scancel", "--quiet", "--full", f"--user={getpass.getuser()}"], env=self.environment,
                           check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60)
        for _, process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for _, process in self.processes:
            try:
                process.wait(10.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()
