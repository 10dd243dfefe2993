//! Executors that are worse than those of the library.

mod accounts;
mod hindered;

pub use accounts::Accounts;
pub use hindered::Hindered;
