//! x
mod building;
mod drive;
mod error;
mod geometry;
mod joints;
mod map;
pub mod pgm;
pub mod tiago;
mod yaml;

pub use building::{Building, Elevator, Floor, Place, Stop};
pub use drive::Twist;
pub use error::{BuildingError, MapError, PgmError, RouteError, WorldError, YamlError};
pub use geometry::{Point, Pose, normalize_angle};
pub use joints::{JointState, JointTargets, Joints};
pub use map::{Cell, MAX_RESOLUTION, MIN_RESOLUTION, OccupancyGrid};
pub use tiago::{JointLimits, RobotModel};
pub use yaml::MAX_BYTES as MAX_YAML_BYTES;
