//! Child processes, with messages to the user.
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Folder of the repository.
pub fn root() -> PathBuf {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask).to_path_buf()
}

/// Prints the headline of a step.
pub fn step(what: &str) {
    eprintln!("\n== {what}");
}

/// The cargo that runs this program, in `folder`.
pub fn cargo(folder: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(folder).stdin(Stdio::null());
    command
}

/// Runs to the end; output goes to the user.
pub fn run(command: &mut Command) -> Result<(), String> {
    eprintln!("   {}", line(command));
    let status = command.status().map_err(|e| format!("{}: {e}", line(command)))?;
    if status.success() { Ok(()) } else { Err(format!("{}: {status}", line(command))) }
}

/// Result of a child process.
pub struct Output {
    /// The child ended in time and with code 0.
    pub success: bool,
    /// The child was ended after the limit.
    pub timed_out: bool,
    /// Standard output.
    pub out: Vec<u8>,
    /// Standard error.
    pub err: String,
}

/// Runs to the end or to `limit`; output goes to the caller.
pub fn capture(command: &mut Command, limit: Duration) -> Result<Output, String> {
    let name = line(command);
    let mut child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("{name}: {e}"))?;
    let out = collect(child.stdout.take());
    let err = collect(child.stderr.take());
    let (success, timed_out) = wait(&mut child, limit).map_err(|e| format!("{name}: {e}"))?;
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    Ok(Output { success, timed_out, out: join(out), err: text(join(err)) })
}

/// The same, with input to the child: `answer` gets all output after each change, and returns the next input.
pub fn talk(
    command: &mut Command,
    limit: Duration,
    mut answer: impl FnMut(&[u8]) -> Option<Vec<u8>>,
) -> Result<Output, String> {
    let name = line(command);
    let command = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|e| format!("{name}: {e}"))?;
    let (mut to, err) = (child.stdin.take(), collect(child.stderr.take()));
    let (said, heard) = mpsc::channel();
    if let Some(mut from) = child.stdout.take() {
        thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = from.read(&mut buffer) {
                if said.send(buffer.get(..count).unwrap_or_default().to_vec()).is_err() {
                    return;
                }
            }
        });
    }
    let (start, mut out) = (Instant::now(), Vec::new());
    loop {
        match heard.recv_timeout(limit.saturating_sub(start.elapsed())) {
            Ok(bytes) => out.extend(bytes),
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
            Err(mpsc::RecvTimeoutError::Timeout) => {
                child.kill().map_err(|e| format!("{name}: {e}"))?;
                break;
            }
        }
        if let (Some(bytes), Some(to)) = (answer(&out), &mut to) {
            // A child that has ended needs no input.
            let _ = to.write_all(&bytes).and_then(|()| to.flush());
        }
    }
    let (success, late) = wait(&mut child, limit).map_err(|e| format!("{name}: {e}"))?;
    Ok(Output {
        success,
        timed_out: late || start.elapsed() >= limit,
        out,
        err: String::from_utf8_lossy(&join(err)).into_owned(),
    })
}

fn wait(child: &mut Child, limit: Duration) -> std::io::Result<(bool, bool)> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok((status.success(), false));
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok((false, true));
        }
        thread::sleep(Duration::from_millis(10));
    }
}

fn collect(stream: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            // After an error the text so far counts.
            let _ = stream.read_to_end(&mut bytes);
        }
        bytes
    })
}

fn join(reader: JoinHandle<Vec<u8>>) -> Vec<u8> {
    reader.join().unwrap_or_default()
}

fn line(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// The file with this name in a folder of PATH.
pub fn on_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())
}
