//! Sets `narrow` for a core whose product has 32 bits, and that cannot count zeros.

fn main() {
    println!("cargo:rustc-check-cfg=cfg(narrow)");
    println!("cargo:rerun-if-env-changed=TARGET");
    let target = std::env::var("TARGET").unwrap_or_default();
    // The tests of the host try the same code.
    if target.starts_with("thumbv6m") || !target.contains("-none-") {
        println!("cargo:rustc-cfg=narrow");
    }
}
