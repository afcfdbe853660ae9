//! The simulation of light: form factors and bounces between patches, and scenes photographed by them.

pub mod radiosity;
pub mod scene;
