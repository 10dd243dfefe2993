//! Pictures on disk.

mod references;
