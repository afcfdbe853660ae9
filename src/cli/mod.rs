//! The command line: one table of commands, a file for each.
//!
//! Exit codes: 0 done, 1 failed (one line on standard error says why), 2 wrong usage (clap prints how).

mod calibrate;
mod circle;
mod compare;
mod decode_picture;
mod demo;
mod evaluate;
mod info;
mod memory;
mod open;
mod output;
mod paper;
mod plan;
mod progress;
mod scene;
mod simulate;
mod solve;
mod solve_many;
mod table;
mod unit;
mod watch;
mod window;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Photometric stereo without the light between an object's own walls. Without a command the window opens.
#[derive(Debug, Parser)]
#[command(version, about)]
struct Program {
    #[command(subcommand)]
    command: Option<Command>,
}

/// Every command.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Open the window on a capture set
    Open(open::OpenArgs),
    /// From photos to bounces, normals, depth, a mesh and a report; of many sets in one table
    Solve(solve::SolveArgs),
    /// Measure lamps and paint on the calibration balls
    Calibrate(calibrate::CalibrateArgs),
    /// Compare the results with the truth of a rendered set
    Evaluate(evaluate::EvaluateArgs),
    /// Measure how far one mesh is from another, or from the truth of a rendered set
    Compare(compare::CompareArgs),
    /// Show what a capture set holds, and what it lacks
    Info(info::InfoArgs),
    /// Photograph a scene whose truth is known, and write the capture set
    Simulate(Box<simulate::SimulateArgs>),
    /// Check the photos of a set as they arrive, and solve it each time a light is complete
    Watch(watch::WatchArgs),
    /// Predict the errors of a rig against frames and albedos
    Plan(Box<plan::PlanArgs>),
    /// Reproduce the paper's synthetic experiments
    Paper(paper::PaperArgs),
    /// Solve the set that comes with the program
    Demo(demo::DemoArgs),
    /// Decode one picture for the process that started this one
    #[command(hide = true)]
    DecodePicture(decode_picture::DecodeArgs),
}

/// The capture set that a command works on.
#[derive(Args, Debug)]
pub struct SetArgs {
    /// A capture set: its folder or its capture.toml
    #[arg(value_name = "SET")]
    path: PathBuf,
}

/// How a command prints.
#[derive(Args, Debug)]
pub struct PrintArgs {
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Reads the command line; prints help or usage and exits where it is not a command.
pub fn parse() -> Option<Command> {
    Program::parse().command
}

/// Runs a command; without one the window opens.
pub fn run(command: Option<Command>) -> anyhow::Result<()> {
    let Some(command) = command else { return window::open(None) };
    match command {
        Command::Open(args) => open::run(args),
        Command::Solve(args) => solve::run(&args),
        Command::Calibrate(args) => calibrate::run(&args),
        Command::Evaluate(args) => evaluate::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Watch(args) => watch::run(&args),
        Command::Plan(args) => plan::run(&args),
        Command::Paper(args) => paper::run(&args),
        Command::Demo(args) => demo::run(&args),
        Command::DecodePicture(args) => decode_picture::run(&args),
    }
}

/// One line on standard error.
pub fn print_error(error: &anyhow::Error) {
    let line = format!("{error:#}").replace('\n', " ");
    eprintln!("firstbounce: {line}");
}

/// Prints to standard output; a reader that went away (`| head`) is no error.
fn print(text: &str) -> anyhow::Result<()> {
    use std::io::{ErrorKind, Write};
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.write_all(b"\n")).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints one JSON object.
fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&serde_json::to_string_pretty(value)?)
}

/// Warnings go to standard error, so that what is printed can be piped on.
fn print_warnings(warnings: &[String]) {
    warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
}
