//! The differential drive: twists, exact arcs, limits, braking.

use crate::geometry::Point;
use crate::geometry::{Pose, Segment, normalize_angle, sin_cos};
use crate::tiago::RobotModel;

/// Speed of the base.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Twist {
    /// Forward, in m/s.
    pub linear: f64,
    /// Turning, in rad/s, counter-clockwise.
    pub angular: f64,
}

impl Twist {
    /// Standing still.
    pub const ZERO: Self = Self { linear: 0.0, angular: 0.0 };

    fn scaled(self, factor: f64) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }

    /// Speeds of the rims of the left and of the right wheel, in m/s.
    #[must_use]
    pub fn rims(self, model: &RobotModel) -> (f64, f64) {
        let turning = self.angular * model.wheel_separation / 2.0;
        (self.linear - turning, self.linear + turning)
    }
}

impl Pose {
    /// Where a robot is that keeps a twist for `seconds`: the exact end of its circular arc.
    #[must_use]
    pub fn moved(self, twist: Twist, seconds: f64) -> Self {
        let half = twist.angular * seconds / 2.0;
        // Length of the chord over length of the arc.
        let ratio = if half.abs() < 1e-8 { 1.0 } else { sin_cos(half).0 / half };
        let chord = twist.linear * seconds * ratio;
        let (sin, cos) = sin_cos(self.heading + half);
        Self {
            position: Point::new(self.position.x + chord * cos, self.position.y + chord * sin),
            heading: normalize_angle(self.heading + 2.0 * half),
        }
    }
}

/// Chords of an arc, and how far the arc strays from them, in metres.
pub(crate) fn chords(pose: Pose, twist: Twist, seconds: f64) -> (impl Iterator<Item = Segment>, f64) {
    let mut parts: u32 = 1;
    while (twist.angular * seconds).abs() > 0.2 * f64::from(parts) && parts < 64 {
        parts += 1;
    }
    let each = seconds / f64::from(parts);
    let quarter = twist.angular * each / 4.0;
    // The arc's height over its chord, r (1 - cos(a/2)) = 2 r sin^2(a/4), with r = v / w.
    let strays = if quarter.abs() < 1e-8 {
        0.0
    } else {
        let sin = sin_cos(quarter).0;
        (2.0 * twist.linear / twist.angular * sin * sin).abs()
    };
    let points = (0..parts).map(move |i| Segment {
        from: pose.moved(twist, each * f64::from(i)).position,
        to: pose.moved(twist, each * f64::from(i + 1)).position,
    });
    (points, strays)
}

/// Number of steps, at least 1, in which a robot can come to a stop along its present arc.
fn braking_steps(model: &RobotModel, twist: Twist, step: f64) -> f64 {
    let seconds =
        (twist.linear.abs() / model.acceleration).max(twist.angular.abs() / model.turn_acceleration);
    // Less a little, or rounding would make a further step out of an exact number of them.
    (seconds / step - 1e-9).ceil().max(1.0)
}

/// The twist after one step of braking: both speeds shrink alike, so the robot stays on its arc.
pub(crate) fn braked(model: &RobotModel, twist: Twist, step: f64) -> Twist {
    let steps = braking_steps(model, twist, step);
    if steps <= 1.0 { Twist::ZERO } else { twist.scaled((steps - 1.0) / steps) }
}

/// How long a robot that keeps a twist for one step and brakes from then on would need at the
/// full twist to get as far: the step, and then the sum of the shrinking speeds.
pub(crate) fn reach_seconds(model: &RobotModel, twist: Twist, step: f64) -> f64 {
    step * (1.0 + (braking_steps(model, twist, step) - 1.0) / 2.0)
}

/// The twist nearest to `wanted` that the limits allow one step after `now`.
pub(crate) fn limited(model: &RobotModel, now: Twist, wanted: Twist, step: f64) -> Twist {
    let (dv, dw) = (model.acceleration * step, model.turn_acceleration * step);
    let half = model.wheel_separation / 2.0;
    let mut linear = wanted.linear.clamp(0.0, model.max_speed).clamp(now.linear - dv, now.linear + dv);
    let mut angular = wanted.angular.clamp(-model.max_turn, model.max_turn);
    angular = angular.clamp(now.angular - dw, now.angular + dw);
    // The outer wheel: first slow down as far as possible, then turn less.
    let cap = model.wheel_speed - angular.abs() * half;
    if linear > cap {
        linear = cap.max(now.linear - dv);
        let turn = ((model.wheel_speed - linear) / half).max(0.0);
        angular = angular.clamp(-turn, turn);
    }
    Twist { linear, angular }
}

/// The largest speed from which one can stop within `distance`, decelerating by `rate` from the
/// next step on.
pub(crate) fn stopping_speed(distance: f64, rate: f64, step: f64) -> f64 {
    let lag = rate * step / 2.0;
    (lag * lag + 2.0 * rate * distance.max(0.0)).sqrt() - lag
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TIAGO: RobotModel = RobotModel::TIAGO;
    const STEP: f64 = 0.02;

    /// A twist that TIAGo can have.
    fn twist() -> impl Strategy<Value = Twist> {
        (-1.05..1.05f64, 0.0..1.0f64).prop_map(|(angular, share)| {
            let cap = 1.0 - angular.abs() * TIAGO.wheel_separation / 2.0;
            Twist { linear: share * cap, angular }
        })
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (-5.0..5.0f64, -5.0..5.0f64, -3.1..3.1f64)
            .prop_map(|(x, y, heading)| Pose { position: Point::new(x, y), heading })
    }

    fn close(a: Pose, b: Pose) -> bool {
        a.position.distance(b.position) < 1e-9 && normalize_angle(a.heading - b.heading).abs() < 1e-9
    }

    proptest! {
        #[test]
        fn an_arc_may_be_driven_in_parts(pose in pose(), twist in twist(), a in 0.0..3.0f64, b in 0.0..3.0f64) {
            prop_assert!(close(pose.moved(twist, a).moved(twist, b), pose.moved(twist, a + b)));
        }

        #[test]
        fn an_arc_is_the_limit_of_short_straight_moves(pose in pose(), twist in twist()) {
            let mut walked = pose;
            for _ in 0..20_000 {
                walked = walked
                    .moved(Twist { linear: 0.0, ..twist }, 5e-5)
                    .moved(Twist { angular: 0.0, ..twist }, 5e-5);
            }
            prop_assert!(walked.position.distance(pose.moved(twist, 1.0).position) < 1e-4);
        }

        #[test]
        fn an_arc_strays_from_its_chords_no_further_than_said(pose in pose(), twist in twist(), seconds in 0.0..2.0f64) {
            let (chords, strays) = chords(pose, twist, seconds);
            let chords: Vec<Segment> = chords.collect();
            for i in 0..=50u32 {
                let p = pose.moved(twist, seconds * f64::from(i) / 50.0).position;
                let off = chords.iter().map(|c| c.distance_squared(p).sqrt()).fold(f64::INFINITY, f64::min);
                prop_assert!(off <= strays + 1e-9, "{off} > {strays}");
            }
        }

        #[test]
        fn limits_hold_after_any_wish(now in twist(), linear in -3.0..3.0f64, angular in -4.0..4.0f64) {
            let next = limited(&TIAGO, now, Twist { linear, angular }, STEP);
            prop_assert!((next.linear - now.linear).abs() <= TIAGO.acceleration * STEP + 1e-9);
            prop_assert!((next.angular - now.angular).abs() <= TIAGO.turn_acceleration * STEP + 1e-9);
            prop_assert!(next.linear >= 0.0 && next.linear <= TIAGO.max_speed);
            prop_assert!(next.angular.abs() <= TIAGO.max_turn);
            let (left, right) = next.rims(&TIAGO);
            prop_assert!(left.abs().max(right.abs()) <= TIAGO.wheel_speed + 1e-9);
        }

        #[test]
        fn braking_ends_on_the_arc_where_it_was_foretold(pose in pose(), twist in twist()) {
            let foretold = pose.moved(twist, reach_seconds(&TIAGO, twist, STEP));
            let (mut at, mut now) = (pose, twist);
            let mut steps = 0;
            loop {
                at = at.moved(now, STEP);
                let next = braked(&TIAGO, now, STEP);
                prop_assert!((next.linear - now.linear).abs() <= TIAGO.acceleration * STEP + 1e-9);
                prop_assert!((next.angular - now.angular).abs() <= TIAGO.turn_acceleration * STEP + 1e-9);
                now = next;
                if now == Twist::ZERO {
                    break;
                }
                steps += 1;
                prop_assert!(steps < 200);
            }
            prop_assert!(close(at, foretold), "{at:?} {foretold:?}");
        }
    }
}
