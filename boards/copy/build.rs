//! Sets `narrow` for ARMv6-M, which has no conditional instructions and no unaligned words.

fn main() {
    println!("cargo:rustc-check-cfg=cfg(narrow)");
    println!("cargo:rerun-if-env-changed=TARGET");
    if std::env::var("TARGET").is_ok_and(|target| target.starts_with("thumbv6m")) {
        println!("cargo:rustc-cfg=narrow");
    }
}
