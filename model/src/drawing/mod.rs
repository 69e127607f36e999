//! Graphs as pictures: Graphviz DOT, and SVG that needs no other program. The same graph
//! always makes the same text.

mod beats;
mod canvas;
mod protocol;

pub use beats::{beats_dot, beats_svg};
pub use protocol::{ProtocolLabels, protocol_dot, protocol_svg};

/// A string as DOT writes it in quotes.
fn quoted(text: &str) -> String {
    let escaped = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
    format!("\"{escaped}\"")
}
