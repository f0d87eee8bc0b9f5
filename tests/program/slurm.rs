//! A study on a real Slurm cluster, which the test starts and stops itself. One shard of an array is killed and
//! submitted again alone. The joined result must have the same bytes as that of one machine.
//!
//! The test runs where `slurmctld`, `slurmd` and `sbatch` are installed (Debian: `apt-get install slurmctld slurmd
//! slurm-client`). It runs as any user and needs neither systemd, munge and cgroups nor a certain port.
//! `ARMWRIGHT_SLURM=0` skips it.

use crate::front_check::STUDY;
use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for anything that Slurm does.
const PATIENCE: Duration = Duration::from_secs(90);

/// A program of Slurm; administrators' programs are not on every `PATH`.
fn program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/usr/local/sbin".into()]);
    folders.map(|folder| folder.join(name)).find(|file| file.is_file())
}

/// A cluster of this machine alone. It ends with the value.
struct Cluster {
    here: tempfile::TempDir,
    daemons: Vec<Child>,
}

impl Cluster {
    /// Starts a cluster; `None`, said aloud, where there is no Slurm.
    fn start() -> Option<Self> {
        let found = ["slurmctld", "slurmd", "slurmstepd", "sbatch", "squeue", "scancel"].map(program);
        let asked = std::env::var("ARMWRIGHT_SLURM").map_or(true, |word| word != "0");
        let ([Some(controller), Some(daemon), Some(step), Some(_), Some(_), Some(_)], true) = (found, asked)
        else {
            eprintln!(
                "SKIPPED a cluster: needs slurmctld, slurmd and sbatch, and ARMWRIGHT_SLURM other than 0"
            );
            return None;
        };
        let here = tempfile::tempdir().expect("a folder");
        let name = read(Command::new("hostname").arg("-s"));
        let user = read(Command::new("id").arg("-un"));
        for folder in ["state", "spool", "bin"] {
            fs::create_dir(here.path().join(folder)).expect("made");
        }
        fs::write(here.path().join("slurm.conf"), config(here.path(), &name, &user)).expect("written");
        fs::write(here.path().join("cgroup.conf"), "").expect("written");
        let mut out = Self { here, daemons: Vec::new() };
        let spawn = |command: &mut Command| {
            let command = command.env("SLURM_CONF", out.here.path().join("slurm.conf"));
            let silent = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
            silent.spawn().expect("a daemon starts")
        };
        let controller = spawn(Command::new(controller).arg("-D"));
        let daemon = spawn(Command::new(daemon).args(["-D", "-d"]).arg(step).args(["-N", &name]));
        out.daemons = vec![controller, daemon];
        let idle = || read(&mut out.command("sinfo", &["-h", "-o", "%T"])) == "idle";
        assert!(wait_until(idle), "the cluster did not start: {}", out.log());
        Some(out)
    }

    fn path(&self) -> &Path {
        self.here.path()
    }

    /// A command in the folder of the cluster, with the `armwright` of its `bin`.
    fn command(&self, program: &str, words: &[&str]) -> Command {
        let path = std::env::var("PATH").unwrap_or_default();
        let mut command = Command::new(program);
        command.current_dir(self.path()).args(words);
        command.env("PATH", format!("{}:{path}", self.path().join("bin").display()));
        command.env("SLURM_CONF", self.path().join("slurm.conf"));
        command
    }

    fn log(&self) -> String {
        ["ctl.log", "d.log"]
            .map(|file| fs::read_to_string(self.path().join(file)).unwrap_or_default())
            .concat()
    }

    /// Jobs and tasks that are not done, one a line.
    fn queue(&self) -> String {
        read(&mut self.command("squeue", &["-h", "-r", "-o", "%i %t"]))
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let _ = self.command("scontrol", &["shutdown"]).output();
        let begun = Instant::now();
        for daemon in &mut self.daemons {
            while begun.elapsed() < Duration::from_secs(10) && matches!(daemon.try_wait(), Ok(None)) {
                std::thread::sleep(Duration::from_millis(100));
            }
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

/// A free port of this machine.
fn port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("an address").port()
}

fn config(here: &Path, name: &str, user: &str) -> String {
    let (controller, daemon, here) = (port(), port(), here.display());
    format!(
        "ClusterName=test\nSlurmctldHost={name}(127.0.0.1)\nSlurmctldPort={controller}\nSlurmdPort={daemon}\n\
         AuthType=auth/none\nCredType=cred/none\nSlurmUser={user}\nSlurmdUser={user}\n\
         StateSaveLocation={here}/state\nSlurmdSpoolDir={here}/spool\n\
         SlurmctldPidFile={here}/ctl.pid\nSlurmdPidFile={here}/d.pid\n\
         SlurmctldLogFile={here}/ctl.log\nSlurmdLogFile={here}/d.log\n\
         ProctrackType=proctrack/pgid\nTaskPlugin=task/none\nJobAcctGatherType=jobacct_gather/none\n\
         AccountingStorageType=accounting_storage/none\nMpiDefault=none\nSelectType=select/cons_tres\n\
         SelectTypeParameters=CR_Core\nSchedulerParameters=sched_interval=1,batch_sched_delay=0\n\
         ReturnToService=2\nKillWait=2\n\
         NodeName={name} NodeAddr=127.0.0.1 Port={daemon} CPUs=2 RealMemory=500 State=UNKNOWN\n\
         PartitionName=test Nodes={name} Default=YES MaxTime=INFINITE State=UP\n"
    )
}

/// What a command says on standard output, without space around it.
fn read(command: &mut Command) -> String {
    let output = command.output().expect("it runs");
    String::from_utf8_lossy(&output.stdout).trim().to_string()
}

fn wait_until(done: impl Fn() -> bool) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if done() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    false
}

#[cfg(target_os = "linux")]
#[test]
fn of_an_array_one_task_is_killed_and_submitted_again_and_the_bytes_are_those_of_one_machine() {
    use std::os::unix::fs::PermissionsExt;
    let Some(cluster) = Cluster::start() else { return };
    let here = cluster.path();
    fs::write(here.join("study.json"), STUDY).expect("written");
    // the second shard hangs until it is killed, and runs when it is submitted again
    let tool = here.join("bin/armwright");
    let script = format!(
        "#!/bin/sh\nif [ \"${{SLURM_ARRAY_TASK_ID:-}}\" = 2 ]; then exec sleep 600; fi\nexec '{}' \"$@\"\n",
        env!("CARGO_BIN_EXE_armwright")
    );
    fs::write(&tool, script).expect("written");
    fs::set_permissions(&tool, fs::Permissions::from_mode(0o755)).expect("set");
    let armwright = |words: &[&str]| {
        let output = cluster.command("armwright", words).output().expect("it runs");
        let text = [output.stdout, output.stderr].concat();
        (output.status.code(), String::from_utf8_lossy(&text).into_owned())
    };
    let whole = ["run", "study.json", "--search", "exhaustive", "--out", "whole"];
    assert_eq!(armwright(&whole).0, Some(0));
    let submit =
        read(&mut cluster.command("armwright", &["slurm", "study.json", "--shards", "4", "--out", "out"]));
    fs::write(here.join("submit.sh"), submit).expect("written");
    let said = read(&mut cluster.command("sh", &["submit.sh"]));
    let job =
        said.strip_prefix("shards ").and_then(|rest| rest.split(',').next()).expect("a number").to_string();
    let hangs = format!("{job}_2 R");
    let is_left =
        || cluster.queue().lines().filter(|line| line.starts_with(&format!("{job}_"))).eq([hangs.as_str()]);
    assert!(wait_until(is_left), "{}\n{}", cluster.queue(), cluster.log());
    read(&mut cluster.command("scancel", &["--signal=KILL", &format!("{job}_2")]));
    // with the task the merge goes, which waited for it
    assert!(wait_until(|| cluster.queue().is_empty()), "{}", cluster.queue());
    let (code, said) = armwright(&["merge", "out/shards", "--out", "out"]);
    let line = "armwright run study.json --shard 2/4 --out out/shards/2-of-4";
    assert!(code == Some(10) && said.contains("1 of 4 shards are missing") && said.contains(line), "{said}");
    read(&mut cluster.command("sbatch", &["--output=again.log", "--wrap", &format!("exec {line}")]));
    assert!(wait_until(|| cluster.queue().is_empty()), "{}", cluster.queue());
    let again = fs::read_to_string(here.join("again.log")).unwrap_or_default();
    let (code, said) = armwright(&["merge", "out/shards", "--out", "out"]);
    assert_eq!(code, Some(0), "{said}\n{again}");
    let (code, said) = armwright(&["check", "--same", "whole", "out"]);
    assert_eq!(code, Some(0), "{said}");
}
