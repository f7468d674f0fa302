//! The command `couloir`.

fn main() -> std::process::ExitCode {
    couloir::cli::main()
}
