//! Float channels.
