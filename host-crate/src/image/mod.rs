//! Pictures on disk: EXR with named layers, PNG, and their comparison.
