//! x
mod building;
mod drive;
mod error;
mod follow;
mod geometry;
mod joints;
mod mall;
mod map;
mod person;
pub mod pgm;
mod reach;
mod route;
pub mod tiago;
mod world;
mod yaml;

pub use building::{Building, Elevator, Floor, Place, Stop};
pub use drive::Twist;
pub use error::{BuildingError, MapError, PgmError, RouteError, WorldError, YamlError};
pub use geometry::{Point, Pose, normalize_angle};
pub use joints::{JointState, JointTargets, Joints};
pub use map::{Cell, MAX_RESOLUTION, MIN_RESOLUTION, OccupancyGrid};
pub use person::{Person, Waypoint};
pub use route::{Estimate, Leg};
pub use tiago::{JointLimits, RobotModel};
pub use world::{Activity, Command, Event, Progress, Robot, Settings, World};
pub use yaml::MAX_BYTES as MAX_YAML_BYTES;
