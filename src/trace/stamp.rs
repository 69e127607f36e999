//! Simulated time as MCAP and Protobuf have it. A run begins at 0, the Unix epoch.

use std::time::Duration;

use prost_types::Timestamp;

/// Nanoseconds since the run's begin; after 584 years it stands still.
pub(super) fn nanos(at: Duration) -> u64 {
    u64::try_from(at.as_nanos()).unwrap_or(u64::MAX)
}

pub(super) fn timestamp(at: Duration) -> Option<Timestamp> {
    Some(Timestamp {
        seconds: i64::try_from(at.as_secs()).unwrap_or(i64::MAX),
        nanos: i32::try_from(at.subsec_nanos()).unwrap_or(0),
    })
}
