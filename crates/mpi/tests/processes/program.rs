//! Runs of the program by several processes, none of them for ever.

use raystream_tests::Run;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

/// A run that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(180);

/// A run under way.
pub struct Running {
    child: Child,
    stdout: thread::JoinHandle<String>,
    stderr: thread::JoinHandle<String>,
}

impl Running {
    /// The process that was started.
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the end.
    #[track_caller]
    pub fn finish(mut self) -> Run {
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            if start.elapsed() > PATIENCE {
                // It ends the others.
                signal(self.id(), "TERM");
                thread::sleep(Duration::from_secs(5));
                let _ = self.child.kill();
                panic!("it hangs: {}", self.stderr.join().unwrap());
            }
            thread::sleep(Duration::from_millis(20));
        };
        let (stdout, stderr) = (self.stdout.join().unwrap(), self.stderr.join().unwrap());
        Run { status: status.code(), stdout, stderr }
    }
}

/// Sends a process a signal.
#[track_caller]
pub fn signal(process: u32, name: &str) {
    let killed = Command::new("kill").args([format!("-{name}"), process.to_string()]).status();
    assert!(killed.unwrap().success(), "{name} to {process}");
}

/// Says whether there is an `mpirun`, once also on stderr; where `RAYSTREAM_REQUIRE_MPI` is set there
/// must be one.
pub fn has_mpi() -> bool {
    static HAS_MPI: OnceLock<bool> = OnceLock::new();
    *HAS_MPI.get_or_init(|| {
        let found = Command::new("mpirun").arg("--version").stdout(Stdio::null()).status();
        let has_mpi = found.is_ok_and(|status| status.success());
        if !has_mpi {
            let variable = "RAYSTREAM_REQUIRE_MPI";
            assert!(
                std::env::var_os(variable).is_none(),
                "{variable} is set, but no mpirun is here"
            );
            raystream_tests::not_tested("several processes: there is no mpirun");
        }
        has_mpi
    })
}

/// Starts a command in `folder`, whose words are split at spaces; `raystream-mpi` is the program.
#[track_caller]
pub fn start(folder: &Path, command: &str) -> Running {
    let program = env!("CARGO_BIN_EXE_raystream-mpi");
    let words = command.split_whitespace();
    let mut words = words.map(|word| if word == "raystream-mpi" { program } else { word });
    let mut child = Command::new(words.next().unwrap())
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .env_remove("RUST_LOG")
        // `mpirun` has a terminal for them.
        .env("NO_COLOR", "1")
        // More processes than cores, each on any of them; containers run as root, and forbid one
        // process to read the memory of another.
        .env("OMPI_MCA_rmaps_base_oversubscribe", "true")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        .env("OMPI_MCA_btl_vader_single_copy_mechanism", "none")
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .spawn()
        .unwrap();
    let (stdout, stderr) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
    Running { child, stdout: reader(stdout), stderr: reader(stderr) }
}

fn reader(mut stream: impl Read + Send + 'static) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// Runs a command to its end.
#[track_caller]
pub fn run(folder: &Path, command: &str) -> Run {
    start(folder, command).finish()
}

/// The processes of number `rank` that `mpirun` has started.
pub fn process_of_rank(mpirun: u32, rank: u32) -> Option<u32> {
    let children =
        std::fs::read_to_string(format!("/proc/{mpirun}/task/{mpirun}/children")).ok()?;
    let variable = format!("OMPI_COMM_WORLD_RANK={rank}");
    children.split_whitespace().filter_map(|id| id.parse().ok()).find(|id: &u32| {
        let environment = std::fs::read(format!("/proc/{id}/environ")).unwrap_or_default();
        environment.split(|&byte| byte == 0).any(|entry| entry == variable.as_bytes())
    })
}

/// Waits until `path` is there.
#[track_caller]
pub fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < PATIENCE, "{} does not come", path.display());
        thread::sleep(Duration::from_millis(20));
    }
}
