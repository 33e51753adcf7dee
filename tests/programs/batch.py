"""scripts/batch with a real SLURM, its controller and one node started here on the loopback address."""

import csv
import getpass
import os
import shutil
import socket
import subprocess
import time
import unittest

from programs import BIN, MESHES, SOURCE, ProgramTest, Run

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

STUDY = """
scene = "two-rods.toml"
title = "Rods"
[set]
"modes.count" = 20
"time.rate_hz" = 20.0
[grid]
"bodies.moving.velocity[0]" = { from = 0.1, to = 2.0, steps = 8 }
"bodies.resting.material.density" = [1.0, 2.0]
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Batch(ProgramTest):
    def setUp(self):
        super().setUp()
        self.assertTrue(shutil.which("slurmctld") and shutil.which("slurmd") and shutil.which("sbatch"),
                        "SLURM is not installed: run scripts/setup --tests")
        slurm = self.folder / "slurm"
        for name in ("state", "spool"):
            (slurm / name).mkdir(parents=True)
        (slurm / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], ports=free_ports(2), user=getpass.getuser(), folder=slurm))
        before = os.environ.get("SLURM_CONF")
        os.environ["SLURM_CONF"] = str(slurm / "slurm.conf")
        self.addCleanup(lambda: os.environ.pop("SLURM_CONF") if before is None else os.environ.update(SLURM_CONF=before))
        for command in (["slurmctld", "-D"], ["slurmd", "-D", "-N", socket.gethostname().split(".")[0]]):
            daemon = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            self.addCleanup(daemon.wait)
            self.addCleanup(daemon.terminate)
        self.until(lambda: "idle" in Run(["sinfo", "-h", "-o", "%T"]).out, "the node of SLURM does not come up")
        for path in (MESHES / "two-rods").glob("*.*"):
            shutil.copy(path, self.folder)
        self.study = self.write("study.toml", STUDY)
        self.out = self.folder / "out"

    def until(self, there, complaint, seconds=200):
        deadline = time.monotonic() + seconds
        while not there():
            self.assertLess(time.monotonic(), deadline, complaint)
            time.sleep(0.1)

    def submit(self, *more):
        """Submits and waits until all jobs have left the queue."""
        done = self.succeed(Run([SOURCE / "scripts" / "batch", self.study, "--ranks", "2", "--parts", "3", *more]))
        self.until(lambda: not Run(["squeue", "-h"]).out.strip(), "jobs stay in the queue:\n" + Run(["squeue"]).out)
        return done

    def rows(self):
        with open(self.out / "rods.sweep.csv") as file:
            return list(csv.DictReader(file))

    def logs(self):
        return "\n".join(path.read_text() for path in self.out.glob("*.log"))

    def test_kernels_impacts_and_results_are_those_of_a_sweep(self):
        self.submit()
        rows = self.rows()
        self.assertEqual([row["status"] for row in rows], ["0"] * 16, self.logs())
        self.assertEqual(len(list(self.out.glob("*.kernel.h5"))), 3)
        self.assertEqual(len(list(self.out.glob("rods.sweep.*-of-3.jsonl"))), 3)
        alone = self.folder / "alone"
        self.succeed(Run([SOURCE / "scripts" / "sweep", self.study, "--out", alone]))
        with open(alone / "rods.sweep.csv") as file:
            for one, other in zip(rows, csv.DictReader(file), strict=True):
                # Kernels of two ranks and of other runs differ by round-off, which the first touches amplify.
                self.assertAlmostEqual(float(one["impulse_ns"]), float(other["impulse_ns"]), delta=1e-6)

    def test_jobs_that_were_killed_are_made_up_for_by_submitting_again(self):
        done = self.succeed(Run([SOURCE / "scripts" / "batch", self.study, "--parts", "2"]))
        impacts = done.out.split("impacts ")[1].split()[0]
        self.until(lambda: list(self.out.glob("*.kernel.h5")), "no kernel")
        Run(["scancel", f"{impacts}_2"])
        self.until(lambda: not Run(["squeue", "-h"]).out.strip(), "jobs stay in the queue")
        self.assertEqual({row["status"] for row in self.rows()}, {"0", "-1"}, self.logs())
        self.submit()
        self.assertEqual({row["status"] for row in self.rows()}, {"0"}, self.logs())

    def test_without_kernels_the_impacts_are_not_started(self):
        bad = self.write("study.toml", STUDY.replace('"modes.count" = 20', '"modes.count" = 2000'))
        self.succeed(Run([SOURCE / "scripts" / "batch", bad]))
        self.until(lambda: not Run(["squeue", "-h"]).out.strip(), "jobs stay in the queue")
        self.assertEqual(list(self.out.glob("rods.impacts.*.log")), [])
        self.assertIn("free displacements", self.logs())


if __name__ == "__main__":
    unittest.main()
