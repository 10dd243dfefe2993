//! What many threads do together.

mod compaction;
