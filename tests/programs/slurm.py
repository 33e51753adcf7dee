# SPDX-License-Identifier: BSD-2-Clause
"""A real SLURM with its controller and one node on the loopback address."""

import contextlib
import getpass
import os
import shutil
import socket
import subprocess
import time

CONFIGURATION = """
ClusterName=ricochet
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def until(there, complaint, seconds=200):
    deadline = time.monotonic() + seconds
    while not there():
        if time.monotonic() > deadline:
            raise TimeoutError(complaint)
        time.sleep(0.1)


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout


@contextlib.contextmanager
def node(folder):
    """Runs SLURM with its files in `folder` for the commands that are started in this scope."""
    if not all(shutil.which(program) for program in ("slurmctld", "slurmd", "sbatch")):
        raise FileNotFoundError("SLURM is not installed: run scripts/setup --tests")
    for name in ("state", "spool"):
        (folder / name).mkdir(parents=True)
    host = socket.gethostname().split(".")[0]
    (folder / "slurm.conf").write_text(
        CONFIGURATION.format(host=host, ports=free_ports(2), user=getpass.getuser(), folder=folder)
    )
    before = os.environ.get("SLURM_CONF")
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    with contextlib.ExitStack() as scope:
        scope.callback(
            lambda: os.environ.pop("SLURM_CONF") if before is None else os.environ.update(SLURM_CONF=before)
        )
        for command in (["slurmctld", "-D"], ["slurmd", "-D", "-N", host]):
            daemon = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            scope.callback(daemon.wait)
            scope.callback(daemon.terminate)
        until(lambda: "idle" in output_of("sinfo", "-h", "-o", "%T"), "the node of SLURM does not come up")
        yield
