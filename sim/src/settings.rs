//! What a world is set up with.

use core::time::Duration;

use crate::error::WorldError;
use crate::tiago::RobotModel;

/// How long a step may take and how the robot deals with people.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct Settings {
    /// The robot.
    pub model: RobotModel,
    /// Length of a step, 1 to 50 ms; default 20 ms.
    pub step: Duration,
    /// Gap to people at which the robot waits for them to pass, in metres, 0.05 to 2; default 0.4.
    pub personal_gap: f64,
    /// Gap at which it passes someone who does not move on, in metres, 0.02 to `personal_gap`;
    /// default 0.1.
    pub passing_gap: f64,
    /// Seconds that it waits before it looks for a way around somebody, 0 to 600; default 4.
    pub patience: f64,
    /// Seconds without getting on, waits included, after which it gives up a goal, 1 to 3600;
    /// default 60. A goal is also given up after 30 ways around people.
    pub give_up_after: f64,
    /// Seconds without getting on and without anybody in the way after which it gives up a goal,
    /// 10 to 3600; default 15.
    pub stuck_after: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            model: RobotModel::TIAGO,
            step: Duration::from_millis(20),
            personal_gap: 0.4,
            passing_gap: 0.1,
            patience: 4.0,
            give_up_after: 60.0,
            stuck_after: 15.0,
        }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), WorldError> {
        let m = &self.model;
        let checks = [
            ("step", self.step.as_secs_f64(), 0.001..=0.05, "0.001 to 0.05 s"),
            ("personal_gap", self.personal_gap, 0.05..=2.0, "0.05 to 2 m"),
            ("passing_gap", self.passing_gap, 0.02..=self.personal_gap, "0.02 m to personal_gap"),
            ("patience", self.patience, 0.0..=600.0, "0 to 600 s"),
            ("give_up_after", self.give_up_after, 1.0..=3600.0, "1 to 3600 s"),
            ("stuck_after", self.stuck_after, 10.0..=3600.0, "10 to 3600 s"),
            ("radius", m.radius, 0.05..=2.0, "0.05 to 2 m"),
            ("wheel_radius", m.wheel_radius, 0.01..=1.0, "0.01 to 1 m"),
            ("wheel_separation", m.wheel_separation, 0.05..=4.0, "0.05 to 4 m"),
            ("max_speed", m.max_speed, 0.05..=3.0, "0.05 to 3 m/s"),
            ("cruise_speed", m.cruise_speed, 0.05..=m.max_speed, "0.05 m/s to max_speed"),
            ("wheel_speed", m.wheel_speed, m.max_speed..=10.0, "max_speed to 10 m/s"),
            ("max_turn", m.max_turn, 0.1..=6.0, "0.1 to 6 rad/s"),
            ("acceleration", m.acceleration, 0.05..=10.0, "0.05 to 10 m/s2"),
            ("turn_acceleration", m.turn_acceleration, 0.1..=20.0, "0.1 to 20 rad/s2"),
        ];
        for (name, value, range, expected) in checks {
            if !range.contains(&value) {
                return Err(WorldError::Setting { name, value, expected });
            }
        }
        for (name, joint) in [("torso", m.torso), ("head_pan", m.head_pan), ("head_tilt", m.head_tilt)] {
            let fine = joint.min <= 0.0 && joint.max >= 0.0 && joint.speed > 0.0;
            if !fine || !joint.min.is_finite() || !joint.max.is_finite() || !joint.speed.is_finite() {
                let expected = "finite, min <= 0 <= max, speed over 0";
                return Err(WorldError::Setting { name, value: joint.speed, expected });
            }
        }
        Ok(())
    }
}
