//! A range of ranks as an argument.

use std::ops::RangeInclusive;

/// Reads `A..=B`.
pub(super) fn parse(text: &str) -> Result<RangeInclusive<u8>, String> {
    let bounds = text.split_once("..=").and_then(|(lowest, highest)| {
        let rank = |text: &str| text.trim().parse::<u8>().ok();
        rank(lowest).zip(rank(highest))
    });
    match bounds {
        Some((lowest, highest)) if lowest <= highest => Ok(lowest..=highest),
        _ => Err("expected A..=B with whole numbers 0 <= A <= B <= 255".to_owned()),
    }
}
