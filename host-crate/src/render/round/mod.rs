//! The parts of a round: what kind comes next and how long it is ([`plan`]), what it works on
//! ([`state`]), how long a batch is ([`batch`]), and launches with their times ([`launches`]).
//! [`Round`](super::Round) puts them together.

pub mod batch;
pub mod launches;
pub mod plan;
pub mod state;
