//! Coordinate frames: the floors above each other in `building`, and the robot's links.
//!
//! Heights of the links are for drawing, a share of the robot's height; they are not from
//! TIAGo's description, whose link names they have.

use std::time::Duration;

use selfneg_sim::{Building, Point, World};

use super::schema::foxglove::{FrameTransform, FrameTransforms, Pose, PoseInFrame, Quaternion, Vector3};
use super::stamp::timestamp;

/// The frame that holds all others.
pub(super) const BUILDING: &str = "building";
/// The robot's base, on the floor.
pub(super) const BASE: &str = "base_link";
/// The lifting torso.
pub(super) const TORSO: &str = "torso_lift_link";
/// The head that nods.
pub(super) const HEAD: &str = "head_2_link";

const HEAD_PAN: &str = "head_1_link";
/// From one floor to the next, in metres, for drawing.
const STOREY: f64 = 4.0;
const TORSO_SHARE: f64 = 0.55;
const HEAD_SHARE: f64 = 0.35;

/// The frame of a floor's map.
pub(super) fn floor(index: usize) -> String {
    format!("map-{index}")
}

fn elevation(floor: usize) -> f64 {
    u32::try_from(floor).map_or(0.0, |floor| f64::from(floor) * STOREY)
}

pub(super) fn vector(x: f64, y: f64, z: f64) -> Option<Vector3> {
    Some(Vector3 { x, y, z })
}

/// A turn about the vertical axis, in radians.
pub(super) fn yaw(angle: f64) -> Option<Quaternion> {
    Some(Quaternion { x: 0.0, y: 0.0, z: libm::sin(angle / 2.0), w: libm::cos(angle / 2.0) })
}

/// A turn about the axis to the left: negative looks up.
fn pitch(angle: f64) -> Option<Quaternion> {
    Some(Quaternion { x: 0.0, y: libm::sin(angle / 2.0), z: 0.0, w: libm::cos(angle / 2.0) })
}

pub(super) fn pose(position: Point, z: f64, heading: f64) -> Option<Pose> {
    Some(Pose { position: vector(position.x, position.y, z), orientation: yaw(heading) })
}

pub(super) fn pose_in(at: Duration, floor_index: usize, position: Point, heading: f64) -> PoseInFrame {
    PoseInFrame { timestamp: timestamp(at), frame_id: floor(floor_index), pose: pose(position, 0.0, heading) }
}

fn transform(
    at: Duration,
    parent: &str,
    child: &str,
    translation: Option<Vector3>,
    rotation: Option<Quaternion>,
) -> FrameTransform {
    FrameTransform {
        timestamp: timestamp(at),
        parent_frame_id: parent.to_owned(),
        child_frame_id: child.to_owned(),
        translation,
        rotation,
    }
}

/// The floors' maps.
pub(super) fn floors(building: &Building) -> FrameTransforms {
    let floors = (0..building.floors().len()).map(|index| {
        let up = vector(0.0, 0.0, elevation(index));
        transform(Duration::ZERO, BUILDING, &floor(index), up, yaw(0.0))
    });
    FrameTransforms { transforms: floors.collect() }
}

/// The robot's links.
pub(super) fn robot(at: Duration, world: &World) -> FrameTransforms {
    let robot = world.robot();
    let height = world.settings().model.height;
    let place = robot.pose.position;
    let joints = robot.joints;
    FrameTransforms {
        transforms: vec![
            transform(
                at,
                BUILDING,
                BASE,
                vector(place.x, place.y, elevation(robot.floor)),
                yaw(robot.pose.heading),
            ),
            transform(
                at,
                BASE,
                TORSO,
                vector(0.0, 0.0, height * TORSO_SHARE + joints.torso.position),
                yaw(0.0),
            ),
            transform(
                at,
                TORSO,
                HEAD_PAN,
                vector(0.0, 0.0, height * HEAD_SHARE),
                yaw(joints.head_pan.position),
            ),
            transform(at, HEAD_PAN, HEAD, vector(0.0, 0.0, 0.0), pitch(-joints.head_tilt.position)),
        ],
    }
}
