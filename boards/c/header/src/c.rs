//! C programs on this computer with the library.
use crate::folder;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

/// The repository.
pub fn root() -> PathBuf {
    folder().join("../..")
}

/// Runs a command. Returns its standard output.
///
/// # Errors
/// The command fails; the error has its output.
pub fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.success() {
        Ok(text)
    } else {
        Err(format!("{command:?}: {}\n{text}{said}", output.status))
    }
}

/// The library for the PC, built once, with overflow checks and debug assertions, and low optimisation.
fn library() -> Result<PathBuf, String> {
    static LIBRARY: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let build = || {
        let target = root().join("target/c");
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.current_dir(folder()).args(["build", "--release", "--quiet"]).env("CARGO_TARGET_DIR", &target);
        for (key, value) in
            [("LTO", "off"), ("OPT_LEVEL", "1"), ("CODEGEN_UNITS", "16"), ("DEBUG_ASSERTIONS", "true")]
        {
            cargo.env(format!("CARGO_PROFILE_RELEASE_{key}"), value);
        }
        output(&mut cargo)?;
        Ok(target.join("release/libglidepath_c.a"))
    };
    LIBRARY.get_or_init(build).clone()
}

/// Compiles a C program with the library. Returns the file.
///
/// # Errors
/// The message of the compiler.
pub fn compile(name: &str, sources: &[PathBuf]) -> Result<PathBuf, String> {
    let library = library()?;
    let program = library.with_file_name(name);
    let mut gcc = Command::new("gcc");
    gcc.args(["-std=gnu11", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic"]);
    for place in ["include", "example"] {
        gcc.arg("-I").arg(folder().join(place));
    }
    gcc.args(sources).arg(library).args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
    output(&mut gcc)?;
    Ok(program)
}
