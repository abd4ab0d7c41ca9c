//! The program: arguments in, exit code out.

fn main() -> std::process::ExitCode {
    rtdsl::app::run(std::env::args_os())
}
