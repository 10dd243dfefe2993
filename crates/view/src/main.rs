//! Raystream's window.

fn main() {}
