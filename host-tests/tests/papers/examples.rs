//! The examples of the library run, and end at the expected position.
#[path = "."]
mod shipped {
    #[path = "../../../examples/beside.rs"]
    pub mod beside;
    #[path = "../../../examples/functions.rs"]
    pub mod functions;
    #[path = "../../../examples/simulate.rs"]
    pub mod simulate;
    #[path = "../../../examples/single_lines.rs"]
    pub mod single_lines;
    #[path = "../../../examples/threads.rs"]
    pub mod threads;
}

macro_rules! run {
    ($($name:ident),+) => {
        $(#[test]
        fn $name() {
            shipped::$name::main().unwrap_or_else(|error| panic!("{error}"));
        })+

        #[test]
        fn every_example_is_run() {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples");
            let mut there: Vec<String> = std::fs::read_dir(folder)
                .expect("the examples")
                .filter_map(|entry| entry.ok()?.file_name().to_str()?.strip_suffix(".rs").map(String::from))
                .collect();
            there.sort();
            assert_eq!(there, [$(stringify!($name)),+]);
        }
    };
}

run!(beside, functions, simulate, single_lines, threads);
