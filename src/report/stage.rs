//! Where everybody was: floors, places and movements, as far as the trace shows them.

use std::collections::BTreeMap;
use std::time::Duration;

use prost::Message as _;

use crate::trace::schema::foxglove::{Grid, PoseInFrame, SceneUpdate};
use crate::trace::schema::{Schema, evidence};
use crate::trace::{Message, PERSONAL};

/// The largest map that is drawn, in cells.
const MAX_CELLS: usize = 1 << 22;

/// The building and everybody in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// By index.
    pub floors: Vec<Floor>,
    /// The robot first, then people by when they first appear.
    pub movers: Vec<Mover>,
}

/// A floor's map: cells of equal size, in rows from its origin on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Floor {
    /// Its name; empty if the trace does not say.
    pub name: String,
    /// Where the first cell begins, in metres.
    pub origin: (f64, f64),
    /// A cell's side, in metres.
    pub resolution: f64,
    /// How many cells a row has.
    pub columns: usize,
    /// All cells: 0 free, 100 occupied, else unknown.
    pub cells: Vec<u8>,
    /// Meeting places: name and position in metres.
    pub places: Vec<Place>,
}

/// A named place.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Its name.
    pub name: String,
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
}

/// What a mover is drawn as.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// The robot.
    Robot,
    /// A user, by pseudonym.
    User(u32),
    /// Somebody else, by the trace's own name, for instance `bystander-1`.
    Other(String),
}

/// Somebody who moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Mover {
    /// Who.
    pub shape: Shape,
    /// The name in the simulated world, if the trace tells it.
    pub name: Option<String>,
    /// In order of time.
    pub samples: Vec<Sample>,
}

/// Where somebody was at a time, and until the next sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Since the run's begin.
    pub at: Duration,
    /// `None`: not to be seen.
    pub pose: Option<Pose>,
}

/// A position on a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The floor's index.
    pub floor: usize,
    /// Metres.
    pub x: f64,
    /// Metres.
    pub y: f64,
    /// Radians, counter-clockwise from the x-axis.
    pub heading: f64,
}

impl Stage {
    /// What the messages for viewers show. Messages that do not decode are left out: the page
    /// is drawn from what is there, and the audit says what is wrong.
    #[must_use]
    pub fn of(header: &evidence::Header, messages: &[Message]) -> Self {
        let mut stage = Self::default();
        let mut movers: BTreeMap<Shape, Mover> = BTreeMap::new();
        let mut order = vec![Shape::Robot];
        let mut places = Vec::new();
        for message in messages {
            let at = Duration::from_nanos(message.log_time);
            if *message.schema == *Schema::Grid.name() {
                if let Some(floor) = floor_of(message, &header.floors) {
                    stage.floors.push(floor);
                }
            } else if *message.schema == *Schema::PoseInFrame.name() {
                let Some(shape) = shape_of(&message.topic) else { continue };
                let Some(pose) = pose_of(message) else { continue };
                let mover = entry(&mut movers, &mut order, shape);
                mover.samples.push(Sample { at, pose: Some(pose) });
            } else if *message.schema == *Schema::SceneUpdate.name() {
                let Ok(update) = SceneUpdate::decode(message.data.as_slice()) else { continue };
                match shape_of(&message.topic) {
                    Some(shape) if shape != Shape::Robot => {
                        let mover = entry(&mut movers, &mut order, shape);
                        let text = update.entities.iter().flat_map(|entity| &entity.texts).next();
                        if let Some(text) = text {
                            mover.name = Some(text.text.clone());
                        }
                        if !update.deletions.is_empty() {
                            mover.samples.push(Sample { at, pose: None });
                        }
                    }
                    _ if at.is_zero() => places.extend(places_of(&update)),
                    _ => {}
                }
            }
        }
        for (floor, place) in places {
            if let Some(floor) = stage.floors.get_mut(floor) {
                floor.places.push(place);
            }
        }
        stage.movers = order.iter().filter_map(|shape| movers.remove(shape)).collect();
        for mover in &mut stage.movers {
            mover.samples = thinned(&mover.samples);
        }
        stage
    }

    /// The robot's movement, if the trace shows it.
    #[must_use]
    pub fn robot(&self) -> Option<&Mover> {
        self.movers.iter().find(|mover| mover.shape == Shape::Robot)
    }

    /// A user's movement.
    #[must_use]
    pub fn user(&self, pseudonym: u32) -> Option<&Mover> {
        self.movers.iter().find(|mover| mover.shape == Shape::User(pseudonym))
    }

    /// Floors on which the robot ever was; none if it is not shown.
    #[must_use]
    pub fn visited(&self) -> Vec<usize> {
        let all = 0..self.floors.len();
        all.filter(|floor| self.robot().is_some_and(|robot| robot.is_ever_on(*floor))).collect()
    }
}

impl Mover {
    /// The last pose that was recorded until a time.
    #[must_use]
    pub fn pose_at(&self, at: Duration) -> Option<Pose> {
        let later = self.samples.partition_point(|sample| sample.at <= at);
        self.samples.get(later.checked_sub(1)?)?.pose
    }

    /// Whether it was ever seen on a floor.
    #[must_use]
    pub fn is_ever_on(&self, floor: usize) -> bool {
        self.samples.iter().any(|sample| sample.pose.is_some_and(|pose| pose.floor == floor))
    }
}

fn entry<'m>(movers: &'m mut BTreeMap<Shape, Mover>, order: &mut Vec<Shape>, shape: Shape) -> &'m mut Mover {
    if !order.contains(&shape) {
        order.push(shape.clone());
    }
    movers.entry(shape.clone()).or_insert(Mover { shape, name: None, samples: Vec::new() })
}

/// Whom a topic is about: `/robot/pose`, `/personal/robot/pose`, `/personal/people/ID/pose`.
fn shape_of(topic: &str) -> Option<Shape> {
    let path = topic.strip_prefix(PERSONAL).or_else(|| topic.strip_prefix('/'))?;
    let mut parts = path.split('/');
    match (parts.next(), parts.next(), parts.next()) {
        (Some("robot"), Some("pose"), None) => Some(Shape::Robot),
        (Some("people"), Some(id), Some("pose" | "scene")) => {
            let user = id.strip_prefix("user-").and_then(|number| number.parse().ok());
            Some(user.map_or_else(|| Shape::Other(id.to_owned()), Shape::User))
        }
        _ => None,
    }
}

fn floor_number(frame: &str) -> Option<usize> {
    frame.strip_prefix("map-")?.parse().ok()
}

fn pose_of(message: &Message) -> Option<Pose> {
    let pose = PoseInFrame::decode(message.data.as_slice()).ok()?;
    let floor = floor_number(&pose.frame_id)?;
    let pose = pose.pose?;
    let (position, turn) = (pose.position?, pose.orientation?);
    let heading = 2.0 * libm::atan2(turn.z, turn.w);
    let finite = position.x.is_finite() && position.y.is_finite() && heading.is_finite();
    finite.then_some(Pose { floor, x: position.x, y: position.y, heading })
}

fn floor_of(message: &Message, names: &[String]) -> Option<Floor> {
    let grid = Grid::decode(message.data.as_slice()).ok()?;
    let number = floor_number(&grid.frame_id)?;
    let origin = grid.pose?.position?;
    let resolution = grid.cell_size?.x;
    let columns = usize::try_from(grid.column_count).ok()?;
    let sound = resolution > 0.0
        && resolution.is_finite()
        && origin.x.is_finite()
        && origin.y.is_finite()
        && columns > 0
        && grid.row_stride == grid.column_count
        && grid.data.len() <= MAX_CELLS
        && grid.data.len().is_multiple_of(columns);
    sound.then(|| Floor {
        name: names.get(number).cloned().unwrap_or_default(),
        origin: (origin.x, origin.y),
        resolution,
        columns,
        cells: grid.data,
        places: Vec::new(),
    })
}

/// Names and positions of the spheres of a scene: places are drawn so.
fn places_of(update: &SceneUpdate) -> Vec<(usize, Place)> {
    let place = |entity: &crate::trace::schema::foxglove::SceneEntity| {
        let floor = floor_number(&entity.frame_id)?;
        let position = entity.spheres.first()?.pose.as_ref()?.position?;
        let name = entity.texts.first()?.text.clone();
        let finite = position.x.is_finite() && position.y.is_finite();
        finite.then_some((floor, Place { name, x: position.x, y: position.y }))
    };
    update.entities.iter().filter_map(place).collect()
}

/// Without the samples that say what the ones before and after them say.
fn thinned(samples: &[Sample]) -> Vec<Sample> {
    let says_more = |nth: usize, sample: &Sample| {
        let before = nth.checked_sub(1).and_then(|nth| samples.get(nth));
        let after = nth.checked_add(1).and_then(|nth| samples.get(nth));
        match (before, after) {
            (Some(before), Some(after)) => before.pose != sample.pose || after.pose != sample.pose,
            _ => true,
        }
    };
    let kept = samples.iter().enumerate().filter(|(nth, sample)| says_more(*nth, sample));
    kept.map(|(_, sample)| sample.clone()).collect()
}
