//! What a 3D viewer draws: walls, places, robot, people, the destination.

use std::time::Duration;

use selfneg_sim::{Building, Cell, OccupancyGrid, Person, Point, RobotModel};

use super::frames;
use super::schema::foxglove::scene_entity_deletion::Type as Deletion;
use super::schema::foxglove::{
    Color, CubePrimitive, CylinderPrimitive, Pose, SceneEntity, SceneEntityDeletion, SceneUpdate,
    SpherePrimitive, TextPrimitive,
};
use super::stamp::timestamp;

const WALL_HEIGHT: f64 = 1.5;
const PERSON_HEIGHT: f64 = 1.7;

fn color(r: f64, g: f64, b: f64, a: f64) -> Option<Color> {
    Some(Color { r, g, b, a })
}

fn text(pose: Option<Pose>, text: &str) -> TextPrimitive {
    TextPrimitive {
        pose,
        billboard: true,
        font_size: 0.4,
        scale_invariant: false,
        color: color(0.1, 0.1, 0.1, 1.0),
        text: text.to_owned(),
    }
}

fn entity(at: Duration, frame: String, id: String) -> SceneEntity {
    SceneEntity {
        timestamp: timestamp(at),
        frame_id: frame,
        id,
        frame_locked: true,
        ..SceneEntity::default()
    }
}

fn update(entities: Vec<SceneEntity>) -> SceneUpdate {
    SceneUpdate { deletions: Vec::new(), entities }
}

/// Walls of all floors.
pub(super) fn building(building: &Building) -> SceneUpdate {
    let floors = building.floors().iter().enumerate();
    let walls = floors.map(|(index, floor)| SceneEntity {
        cubes: walls(&floor.map),
        ..entity(Duration::ZERO, frames::floor(index), format!("walls {index}"))
    });
    update(walls.collect())
}

/// Named places of all floors.
pub(super) fn places(building: &Building) -> SceneUpdate {
    let mut entities = Vec::new();
    for (index, floor) in building.floors().iter().enumerate() {
        for place in &floor.places {
            entities.push(SceneEntity {
                spheres: vec![SpherePrimitive {
                    pose: frames::pose(place.position, 0.1, 0.0),
                    size: frames::vector(0.2, 0.2, 0.2),
                    color: color(0.2, 0.5, 0.9, 0.8),
                }],
                texts: vec![text(frames::pose(place.position, 0.5, 0.0), &place.name)],
                ..entity(Duration::ZERO, frames::floor(index), format!("place {}", place.name))
            });
        }
    }
    update(entities)
}

/// Occupied cells as boxes: runs of a row, merged with equal runs of the rows above.
fn walls(map: &OccupancyGrid) -> Vec<CubePrimitive> {
    let mut open: Vec<(u32, u32, u32)> = Vec::new();
    let mut boxes = Vec::new();
    for row in 0..=map.height() {
        let runs = runs(map, row);
        let (kept, ended): (Vec<_>, Vec<_>) =
            open.into_iter().partition(|(from, to, _)| runs.contains(&(*from, *to)));
        boxes.extend(ended.into_iter().map(|(from, to, first)| cube(map, (from, first), (to, row - 1))));
        open = runs
            .into_iter()
            .map(|(from, to)| {
                let first = kept.iter().find(|run| (run.0, run.1) == (from, to)).map_or(row, |run| run.2);
                (from, to, first)
            })
            .collect();
    }
    boxes
}

/// First and last column of each run of occupied cells.
fn runs(map: &OccupancyGrid, row: u32) -> Vec<(u32, u32)> {
    let mut runs: Vec<(u32, u32)> = Vec::new();
    for column in (0..map.width()).filter(|column| map.cell(*column, row) == Some(Cell::Occupied)) {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == column => *last = column,
            _ => runs.push((column, column)),
        }
    }
    runs
}

fn cube(map: &OccupancyGrid, low: (u32, u32), high: (u32, u32)) -> CubePrimitive {
    let (a, b) = (map.center(low.0, low.1), map.center(high.0, high.1));
    CubePrimitive {
        pose: frames::pose(a.towards(b, 0.5), WALL_HEIGHT / 2.0, 0.0),
        size: frames::vector(b.x - a.x + map.resolution(), b.y - a.y + map.resolution(), WALL_HEIGHT),
        color: color(0.55, 0.55, 0.55, 1.0),
    }
}

/// The robot, in its own frames: it moves with them.
pub(super) fn robot(model: &RobotModel) -> SceneUpdate {
    let round = |z, radius: f64, height| CylinderPrimitive {
        pose: frames::pose(Point::new(0.0, 0.0), z, 0.0),
        size: frames::vector(2.0 * radius, 2.0 * radius, height),
        bottom_scale: 1.0,
        top_scale: 1.0,
        color: color(0.95, 0.95, 0.95, 1.0),
    };
    let part = |frame: &str| entity(Duration::ZERO, frame.to_owned(), format!("robot {frame}"));
    update(vec![
        SceneEntity { cylinders: vec![round(0.15, model.radius, 0.3)], ..part(frames::BASE) },
        SceneEntity { cylinders: vec![round(0.0, model.radius * 0.6, 0.6)], ..part(frames::TORSO) },
        SceneEntity {
            cubes: vec![CubePrimitive {
                pose: frames::pose(Point::new(0.05, 0.0), 0.1, 0.0),
                size: frames::vector(0.2, 0.25, 0.2),
                color: color(0.2, 0.6, 0.9, 1.0),
            }],
            ..part(frames::HEAD)
        },
    ])
}

/// A person; personal.
pub(super) fn person(at: Duration, id: &str, person: &Person, user: bool) -> SceneUpdate {
    let body = if user { color(0.9, 0.5, 0.2, 1.0) } else { color(0.6, 0.6, 0.3, 1.0) };
    update(vec![SceneEntity {
        cylinders: vec![CylinderPrimitive {
            pose: frames::pose(person.position, PERSON_HEIGHT / 2.0, person.heading),
            size: frames::vector(2.0 * person.radius, 2.0 * person.radius, PERSON_HEIGHT),
            bottom_scale: 1.0,
            top_scale: 0.6,
            color: body,
        }],
        texts: vec![text(frames::pose(person.position, PERSON_HEIGHT + 0.3, 0.0), &person.name)],
        ..entity(at, frames::floor(person.floor), id.to_owned())
    }])
}

/// What is no longer there.
pub(super) fn gone(at: Duration, id: &str) -> SceneUpdate {
    let deletion = SceneEntityDeletion {
        timestamp: timestamp(at),
        r#type: Deletion::MatchingId.into(),
        id: id.to_owned(),
    };
    SceneUpdate { deletions: vec![deletion], entities: Vec::new() }
}

/// The name of the destination's entity.
pub(super) const DESTINATION: &str = "destination";

/// Where the robot is going; personal, since somebody is there.
pub(super) fn destination(at: Duration, floor: usize, position: Point, name: &str) -> SceneUpdate {
    update(vec![SceneEntity {
        cylinders: vec![CylinderPrimitive {
            pose: frames::pose(position, 0.02, 0.0),
            size: frames::vector(0.8, 0.8, 0.04),
            bottom_scale: 1.0,
            top_scale: 1.0,
            color: color(0.2, 0.8, 0.3, 0.9),
        }],
        texts: vec![text(frames::pose(position, 0.9, 0.0), &format!("to {name}"))],
        ..entity(at, frames::floor(floor), DESTINATION.to_owned())
    }])
}
