//! Points, poses and the few trigonometric functions that the simulator needs.
//!
//! Sines and arc tangents come from the pure-Rust `libm`, not from the platform, so that a run
//! gives the same bits wherever `f64` is IEEE 754 double precision; the rest is `+ - * /`,
//! comparisons, `floor` and `sqrt`, which IEEE 754 fixes exactly.

use core::f64::consts::{PI, TAU};

/// A point on a floor, in metres, in the frame of its map (x to the right, y up).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Point {
    /// Metres to the right.
    pub x: f64,
    /// Metres up.
    pub y: f64,
}

impl Point {
    /// The point (x, y), in metres.
    #[must_use]
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// Whether both coordinates are finite numbers.
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }

    /// Distance to `other`, in metres.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        self.distance_squared(other).sqrt()
    }

    /// Direction from here to `other`, in radians, in (-pi, pi]; 0 if they coincide.
    #[must_use]
    pub fn direction_to(self, other: Self) -> f64 {
        libm::atan2(other.y - self.y, other.x - self.x)
    }

    /// The point at the fraction `t` of the way to `other`.
    #[must_use]
    pub fn towards(self, other: Self, t: f64) -> Self {
        Self { x: self.x + (other.x - self.x) * t, y: self.y + (other.y - self.y) * t }
    }

    pub(crate) fn distance_squared(self, other: Self) -> f64 {
        let (dx, dy) = (other.x - self.x, other.y - self.y);
        dx * dx + dy * dy
    }
}

/// A position and a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose {
    /// Where, in metres.
    pub position: Point,
    /// Which way, in radians, counter-clockwise from the x axis, in (-pi, pi].
    pub heading: f64,
}

/// A straight line from one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    pub(crate) from: Point,
    pub(crate) to: Point,
}

impl Segment {
    /// The fraction of the way at which the segment is nearest to `p`, in 0..=1.
    pub(crate) fn nearest_fraction(self, p: Point) -> f64 {
        let (dx, dy) = (self.to.x - self.from.x, self.to.y - self.from.y);
        let length_squared = dx * dx + dy * dy;
        if length_squared <= 0.0 {
            return 0.0;
        }
        (((p.x - self.from.x) * dx + (p.y - self.from.y) * dy) / length_squared).clamp(0.0, 1.0)
    }

    pub(crate) fn distance_squared(self, p: Point) -> f64 {
        self.from.towards(self.to, self.nearest_fraction(p)).distance_squared(p)
    }
}

/// An axis-aligned rectangle, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) min: Point,
    pub(crate) max: Point,
}

impl Rect {
    pub(crate) fn distance_squared(self, p: Point) -> f64 {
        let dx = (self.min.x - p.x).max(p.x - self.max.x).max(0.0);
        let dy = (self.min.y - p.y).max(p.y - self.max.y).max(0.0);
        dx * dx + dy * dy
    }

    /// Squared distance from the nearest point of `s`; 0 if they meet.
    pub(crate) fn segment_distance_squared(self, s: Segment) -> f64 {
        if self.meets(s) {
            return 0.0;
        }
        // They do not meet, so the nearest pair includes an end of the segment or a corner.
        let corners =
            [self.min, self.max, Point::new(self.min.x, self.max.y), Point::new(self.max.x, self.min.y)];
        corners
            .iter()
            .map(|&c| s.distance_squared(c))
            .fold(self.distance_squared(s.from).min(self.distance_squared(s.to)), f64::min)
    }

    fn meets(self, s: Segment) -> bool {
        let mut span = (0.0, 1.0);
        span = clip(span, s.from.x, s.to.x, self.min.x, self.max.x);
        span = clip(span, s.from.y, s.to.y, self.min.y, self.max.y);
        span.0 <= span.1
    }
}

/// Narrows the span of fractions of a segment to those whose coordinate, going from `from` to
/// `to`, lies in `low..=high`. An empty span has its first end above its second.
pub(crate) fn clip(span: (f64, f64), from: f64, to: f64, low: f64, high: f64) -> (f64, f64) {
    let d = to - from;
    if d == 0.0 {
        return if from >= low && from <= high { span } else { (1.0, 0.0) };
    }
    let (a, b) = ((low - from) / d, (high - from) / d);
    (span.0.max(a.min(b)), span.1.min(a.max(b)))
}

/// `angle` brought into (-pi, pi]; non-finite angles give 0.
#[must_use]
pub fn normalize_angle(angle: f64) -> f64 {
    if !angle.is_finite() {
        return 0.0;
    }
    let turned = angle - TAU * ((angle + PI) / TAU).floor();
    if turned <= -PI { turned + TAU } else { turned }
}

/// Sine and cosine of an angle in radians.
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    (libm::sin(angle), libm::cos(angle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point> {
        (-3.0..3.0f64, -3.0..3.0f64).prop_map(|(x, y)| Point::new(x, y))
    }

    proptest! {
        #[test]
        fn a_normalized_angle_is_in_range_and_points_the_same_way(angle in -1e4..1e4f64) {
            let n = normalize_angle(angle);
            prop_assert!(n > -PI - 1e-12 && n <= PI + 1e-12);
            let ((s0, c0), (s1, c1)) = (sin_cos(angle), sin_cos(n));
            prop_assert!((s0 - s1).abs() < 1e-8 && (c0 - c1).abs() < 1e-8);
        }

        #[test]
        fn rectangle_to_segment_is_the_least_distance_over_points_of_the_segment(
            from in point(), to in point(), w in 0.1..1.0f64, h in 0.1..1.0f64,
        ) {
            let rect = Rect { min: Point::new(-w, -h), max: Point::new(w, h) };
            let exact = rect.segment_distance_squared(Segment { from, to }).sqrt();
            let sampled = (0..=2000u32)
                .map(|i| rect.distance_squared(from.towards(to, f64::from(i) / 2000.0)).sqrt())
                .fold(f64::INFINITY, f64::min);
            prop_assert!(exact <= sampled + 1e-9, "{exact} > {sampled}");
            prop_assert!(sampled - exact <= from.distance(to) / 2000.0 + 1e-9, "{exact} << {sampled}");
        }
    }
}
