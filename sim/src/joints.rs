//! Torso, head and wheels, as far as they show what the robot is about.

use crate::drive::Twist;
use crate::tiago::{JointLimits, RobotModel};

/// Positions that torso and head move to, as fast as they can. Kept within the joints' ranges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointTargets {
    /// Torso, in metres above its lowest position.
    pub torso: f64,
    /// Pan of the head, in radians, positive to the left.
    pub head_pan: f64,
    /// Tilt of the head, in radians, positive up.
    pub head_tilt: f64,
}

/// Position and speed of one joint, in metres or radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointState {
    /// Where it is.
    pub position: f64,
    /// How fast it has moved in the last step, per second.
    pub velocity: f64,
}

/// All joints that the simulator moves; the names are those of TIAGo's description.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Joints {
    /// `torso_lift_joint`, in metres.
    pub torso: JointState,
    /// `head_1_joint`, in radians, positive to the left.
    pub head_pan: JointState,
    /// `head_2_joint`, in radians, positive up.
    pub head_tilt: JointState,
    /// `wheel_left_joint`, in radians, counting turns.
    pub wheel_left: JointState,
    /// `wheel_right_joint`, in radians, counting turns.
    pub wheel_right: JointState,
}

impl Joints {
    pub(crate) fn step(&mut self, model: &RobotModel, targets: JointTargets, twist: Twist, step: f64) {
        approach(&mut self.torso, model.torso, targets.torso, step);
        approach(&mut self.head_pan, model.head_pan, targets.head_pan, step);
        approach(&mut self.head_tilt, model.head_tilt, targets.head_tilt, step);
        let (left, right) = twist.rims(model);
        roll(&mut self.wheel_left, left / model.wheel_radius, step);
        roll(&mut self.wheel_right, right / model.wheel_radius, step);
    }
}

fn approach(joint: &mut JointState, limits: JointLimits, target: f64, step: f64) {
    let target = if target.is_finite() { target.clamp(limits.min, limits.max) } else { joint.position };
    let moved = (target - joint.position).clamp(-limits.speed * step, limits.speed * step);
    joint.position += moved;
    joint.velocity = moved / step;
}

fn roll(wheel: &mut JointState, velocity: f64, step: f64) {
    wheel.position += velocity * step;
    wheel.velocity = velocity;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn joints_stay_in_range_and_within_their_speed(targets in proptest::collection::vec(
            (any::<f64>(), any::<f64>(), -9.0..9.0f64), 1..40,
        )) {
            let (model, step) = (RobotModel::TIAGO, 0.1);
            let mut joints = Joints::default();
            for (torso, head_pan, head_tilt) in targets {
                joints.step(&model, JointTargets { torso, head_pan, head_tilt }, Twist::ZERO, step);
                for (joint, limits) in [
                    (joints.torso, model.torso),
                    (joints.head_pan, model.head_pan),
                    (joints.head_tilt, model.head_tilt),
                ] {
                    prop_assert!(joint.position >= limits.min - 1e-12 && joint.position <= limits.max + 1e-12);
                    prop_assert!(joint.velocity.abs() <= limits.speed + 1e-9);
                }
            }
        }
    }
}
