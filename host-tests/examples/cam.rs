//! Writes a program of short blocks: `cargo run --release -p host-tests --example cam -- circle|rows HEAD > FILE`.
//! HEAD is optional text that switches smoothing on; ` ` in HEAD begins a line.
use host_tests::cam;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let head = arguments.get(1).map_or(String::new(), |head| head.replace("\\n", "\n"));
    let text = match arguments.first().map(String::as_str) {
        Some("circle") => cam::circle(&head),
        Some("rows") => cam::rows(&head),
        _ => {
            eprintln!("usage: cam circle|rows [HEAD]");
            return ExitCode::FAILURE;
        }
    };
    print!("{text}");
    ExitCode::SUCCESS
}
