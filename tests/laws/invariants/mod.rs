//! Properties of any state, fragment and destination.

mod identities;
mod models;
mod monotone;
mod order;
mod untouched;
