//! Firstbounce: photometric stereo without the light between an object's own walls.

use std::process::ExitCode;

use firstbounce::cli;
use firstbounce_capture::image_file::decode_in;

fn main() -> ExitCode {
    if let Ok(program) = std::env::current_exe() {
        decode_in(program);
    }
    let command = cli::parse();
    match cli::run(command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            cli::print_error(&error);
            ExitCode::FAILURE
        }
    }
}
