//! Firstbounce: photometric stereo without the light between an object's own walls.

use std::process::ExitCode;

use firstbounce::cli;

fn main() -> ExitCode {
    let command = cli::parse();
    match cli::run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            cli::print_error(&error);
            ExitCode::FAILURE
        }
    }
}
