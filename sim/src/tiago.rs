//! Dimensions and limits of a PAL Robotics TIAGo on its differential-drive base PMB-2.
//!
//! Figures are taken from PAL Robotics' public repositories on GitHub, which do not always agree
//! with each other; where they do not, the choice is said here.
//!
//! | figure | value | source |
//! | --- | --- | --- |
//! | base radius | 0.27 m | half of `robot_width: 0.54` in `pmb2_navigation`, `pmb2_2dnav/config/base/pal/local_planner.yaml`. Uncertain by a centimetre: the costmap of the same package has 0.275, its TEB planner 0.26. The arm is taken as tucked in, inside of the base's circle |
//! | wheel radius, separation | 0.0985 m, 0.4044 m | `pmb2_robot`, `pmb2_description/urdf/base/base.urdf.xacro` |
//! | wheel speed | 1.0 m/s at the rim | the same file (`wheel_velocity`, divided by the radius in `wheel.urdf.xacro`) |
//! | base speed | 1.0 m/s, 1.05 rad/s | `pmb2_robot`, `pmb2_controller_configuration/config/mobile_base_controller_public_sim.yaml`. The real robot's controller file also has 1.0 m/s, but 120 degrees/s. Reversing (0.2 m/s there) is not used |
//! | base acceleration | 0.5 m/s², 1.05 rad/s² | the same file. Uncertain: the real robot's controller file allows 1.0 m/s² and 120 degrees/s², the navigation 0.6 m/s²; the lowest is used |
//! | cruising speed | 0.8 m/s | `max_vel_x` of the PAL local planner |
//! | torso lift | 0 to 0.35 m at 0.07 m/s | `tiago_robot`, `tiago_description/urdf/torso/torso.urdf.xacro` |
//! | head pan | -75 to 75 degrees at 3 rad/s | `tiago_robot`, `tiago_description/urdf/head/head.urdf.xacro`. An early version had 90 degrees |
//! | head tilt | -60 (down) to 45 degrees (up) at 3 rad/s | the same file. An early version had -90 degrees |
//! | height | 1.10 m, torso down | from memory of the data sheet, not checked; only for drawing |
//!
//! Accelerations of torso and head are not modelled.

use core::f64::consts::PI;

/// A range of a joint and its largest speed, in metres or radians.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointLimits {
    /// Lowest position.
    pub min: f64,
    /// Highest position.
    pub max: f64,
    /// Largest speed, per second.
    pub speed: f64,
}

/// A differential-drive robot with a lifting torso and a head, as seen from above: a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RobotModel {
    /// Radius of the base, in metres.
    pub radius: f64,
    /// Radius of a wheel, in metres.
    pub wheel_radius: f64,
    /// Distance between the wheels, in metres.
    pub wheel_separation: f64,
    /// Largest speed of a wheel's rim, in m/s.
    pub wheel_speed: f64,
    /// Largest forward speed, in m/s.
    pub max_speed: f64,
    /// Speed at which the robot drives if nothing slows it down, in m/s.
    pub cruise_speed: f64,
    /// Largest turning speed, in rad/s.
    pub max_turn: f64,
    /// Largest change of speed, in m/s².
    pub acceleration: f64,
    /// Largest change of turning speed, in rad/s².
    pub turn_acceleration: f64,
    /// The lifting torso, in metres above its lowest position.
    pub torso: JointLimits,
    /// The head's pan, in radians, positive to the left.
    pub head_pan: JointLimits,
    /// The head's tilt, in radians, positive up.
    pub head_tilt: JointLimits,
    /// Height with the torso down, in metres. For drawing.
    pub height: f64,
}

impl RobotModel {
    /// The figures in the table above.
    pub const TIAGO: Self = Self {
        radius: 0.27,
        wheel_radius: 0.0985,
        wheel_separation: 0.4044,
        wheel_speed: 1.0,
        max_speed: 1.0,
        cruise_speed: 0.8,
        max_turn: 1.05,
        acceleration: 0.5,
        turn_acceleration: 1.05,
        torso: JointLimits { min: 0.0, max: 0.35, speed: 0.07 },
        head_pan: JointLimits { min: -75.0 * PI / 180.0, max: 75.0 * PI / 180.0, speed: 3.0 },
        head_tilt: JointLimits { min: -60.0 * PI / 180.0, max: 45.0 * PI / 180.0, speed: 3.0 },
        height: 1.10,
    };
}

impl Default for RobotModel {
    fn default() -> Self {
        Self::TIAGO
    }
}
