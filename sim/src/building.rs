//! Floors with named places, and the elevators between them.
//!
//! A building is a YAML file that names one map per floor:
//!
//! ```yaml
//! name: Small house
//! floors:                            # from the lowest to the highest
//!   - name: ground
//!     map: ground.yaml               # ROS map_server; relative to this file
//!     places:
//!       - {name: door, x: 1.0, y: 2.5, heading: 1.57}   # metres, radians; heading optional
//! elevators:                         # optional
//!   - name: lift
//!     ride_seconds: 12               # doors and ride, between any two stops
//!     stops:
//!       - {floor: ground, x: 4.0, y: 1.0}
//! ```

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::error::{BuildingError, MapError, YamlError};
use crate::geometry::Point;
use crate::map::{Cell, OccupancyGrid};
use crate::yaml::{self, MAX_BYTES, Node};

/// A named spot on a floor to which the robot may be sent.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Place {
    /// Its name, unique in the building.
    pub name: String,
    /// Where, in metres, in the frame of the floor's map.
    pub position: Point,
    /// Which way the robot turns once it is there, in radians; if none, it stays as it came.
    pub heading: Option<f64>,
}

/// One floor.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// Its name, unique in the building.
    pub name: String,
    /// Its map.
    pub map: OccupancyGrid,
    /// Its places.
    pub places: Vec<Place>,
}

/// Where an elevator stops: a spot inside of its cabin.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stop {
    /// Index of the floor.
    pub floor: usize,
    /// Where, in metres, in the frame of the floor's map.
    pub position: Point,
}

/// An elevator.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Elevator {
    /// Its name, unique among elevators.
    pub name: String,
    /// Seconds from the robot's standing inside on one floor to its standing inside on another,
    /// doors included; 0 to 3600.
    pub ride_seconds: f64,
    /// Where it stops.
    pub stops: Vec<Stop>,
}

/// A building: floors, places and elevators, checked.
///
/// Floors are referred to by their index, counted from 0 in the order given.
#[derive(Clone, Debug, PartialEq)]
pub struct Building {
    name: String,
    floors: Vec<Floor>,
    elevators: Vec<Elevator>,
}

/// Most bytes that are read of an image: the largest image in the wordiest format, and a header.
const MAX_IMAGE_BYTES: u64 = 112 << 20;

impl Building {
    /// A building.
    ///
    /// # Errors
    ///
    /// A [`BuildingError`] if there is no floor, a name is used twice, an elevator stops at a
    /// floor that is not there, or a place or stop is off its map or inside a wall.
    pub fn new(name: String, floors: Vec<Floor>, elevators: Vec<Elevator>) -> Result<Self, BuildingError> {
        if floors.is_empty() {
            return Err(BuildingError::NoFloor);
        }
        let places = || floors.iter().flat_map(|f| &f.places);
        unique("floors", floors.iter().map(|f| f.name.as_str()))?;
        unique("places", places().map(|p| p.name.as_str()))?;
        unique("elevators", elevators.iter().map(|e| e.name.as_str()))?;
        for floor in &floors {
            for place in &floor.places {
                check_spot(&place.name, place.position, floor)?;
                if place.heading.is_some_and(|h| !h.is_finite()) {
                    return Err(BuildingError::Heading { name: place.name.clone() });
                }
            }
        }
        for elevator in &elevators {
            if !(0.0..=3600.0).contains(&elevator.ride_seconds) {
                let (elevator, seconds) = (elevator.name.clone(), elevator.ride_seconds);
                return Err(BuildingError::Ride { elevator, seconds });
            }
            for stop in &elevator.stops {
                let floor = floors.get(stop.floor).ok_or_else(|| BuildingError::UnknownFloor {
                    elevator: elevator.name.clone(),
                    floor: stop.floor.to_string(),
                })?;
                check_spot(&elevator.name, stop.position, floor)?;
            }
        }
        Ok(Self { name, floors, elevators })
    }

    /// Reads a building file, the maps that it names, and their images.
    ///
    /// # Errors
    ///
    /// Any [`BuildingError`]; it names the file.
    pub fn open(path: &Path) -> Result<Self, BuildingError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let text = into_text(path, read_file(path, MAX_BYTES as u64)?)?;
        Self::parse(path, &text, |file, limit| read_file(&folder.join(file), limit))
    }

    /// Reads a building from files in memory: `text` is the building file, and `file` gives the
    /// bytes of a file that it, or a map, names.
    ///
    /// # Errors
    ///
    /// Any [`BuildingError`], or what `file` fails with.
    pub fn from_memory(
        text: &str,
        file: impl Fn(&Path) -> Result<Vec<u8>, BuildingError>,
    ) -> Result<Self, BuildingError> {
        Self::parse(Path::new("building file"), text, |path, _| file(path))
    }

    fn parse(
        path: &Path,
        text: &str,
        file: impl Fn(&Path, u64) -> Result<Vec<u8>, BuildingError>,
    ) -> Result<Self, BuildingError> {
        let in_file = |source| BuildingError::Yaml { path: path.to_owned(), source };
        let root = yaml::parse(text).map_err(in_file)?;
        let name = root.get("name").and_then(|n| n.map_or(Ok("building"), Node::text)).map_err(in_file)?;
        let mut floors = Vec::new();
        for node in root.require("floors").and_then(Node::sequence).map_err(in_file)? {
            let (name, map, places) = read_floor(node).map_err(in_file)?;
            floors.push(Floor { name, map: read_map(&map, &file)?, places });
        }
        let mut elevators = Vec::new();
        if let Some(list) = root.get("elevators").map_err(in_file)? {
            for node in list.sequence().map_err(in_file)? {
                elevators.push(read_elevator(node, &floors).map_err(in_file)??);
            }
        }
        Self::new(name.to_owned(), floors, elevators)
    }

    /// The building's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All floors.
    #[must_use]
    pub fn floors(&self) -> &[Floor] {
        &self.floors
    }

    /// All elevators.
    #[must_use]
    pub fn elevators(&self) -> &[Elevator] {
        &self.elevators
    }

    /// The place of a name, with the index of its floor.
    #[must_use]
    pub fn place(&self, name: &str) -> Option<(usize, &Place)> {
        self.places().find(|(_, place)| place.name == name)
    }

    /// All places, each with the index of its floor.
    pub fn places(&self) -> impl Iterator<Item = (usize, &Place)> {
        self.floors.iter().enumerate().flat_map(|(i, floor)| floor.places.iter().map(move |p| (i, p)))
    }

    /// The index of the floor of a name.
    #[must_use]
    pub fn floor_named(&self, name: &str) -> Option<usize> {
        self.floors.iter().position(|f| f.name == name)
    }
}

fn unique<'a>(what: &'static str, names: impl Iterator<Item = &'a str>) -> Result<(), BuildingError> {
    let mut sorted: Vec<&str> = names.collect();
    sorted.sort_unstable();
    match sorted.iter().zip(sorted.iter().skip(1)).find(|(a, b)| a == b) {
        Some((name, _)) => Err(BuildingError::DuplicateName { what, name: (*name).to_owned() }),
        None => Ok(()),
    }
}

fn check_spot(name: &str, at: Point, floor: &Floor) -> Result<(), BuildingError> {
    let (name, floor_name) = (name.to_owned(), floor.name.clone());
    match floor.map.cell_at(at) {
        None => Err(BuildingError::OffMap { name, floor: floor_name, at }),
        Some(Cell::Free) => Ok(()),
        Some(Cell::Occupied | Cell::Unknown) => {
            Err(BuildingError::InsideWall { name, floor: floor_name, at })
        }
    }
}

fn read_point(node: &Node) -> Result<Point, YamlError> {
    Ok(Point::new(node.require("x")?.number()?, node.require("y")?.number()?))
}

fn read_floor(node: &Node) -> Result<(String, PathBuf, Vec<Place>), YamlError> {
    let mut places = Vec::new();
    for place in node.get("places")?.map_or(Ok(&[][..]), Node::sequence)? {
        places.push(Place {
            name: place.require("name")?.text()?.to_owned(),
            position: read_point(place)?,
            heading: place.get("heading")?.map(Node::number).transpose()?,
        });
    }
    Ok((node.require("name")?.text()?.to_owned(), PathBuf::from(node.require("map")?.text()?), places))
}

fn read_elevator(node: &Node, floors: &[Floor]) -> Result<Result<Elevator, BuildingError>, YamlError> {
    let name = node.require("name")?.text()?;
    let mut stops = Vec::new();
    for stop in node.require("stops")?.sequence()? {
        let floor_name = stop.require("floor")?.text()?;
        let Some(floor) = floors.iter().position(|f| f.name == floor_name) else {
            let (elevator, floor) = (name.to_owned(), floor_name.to_owned());
            return Ok(Err(BuildingError::UnknownFloor { elevator, floor }));
        };
        stops.push(Stop { floor, position: read_point(stop)? });
    }
    let ride_seconds = node.require("ride_seconds")?.number()?;
    Ok(Ok(Elevator { name: name.to_owned(), ride_seconds, stops }))
}

fn read_map(
    path: &Path,
    file: &impl Fn(&Path, u64) -> Result<Vec<u8>, BuildingError>,
) -> Result<OccupancyGrid, BuildingError> {
    /// Tells a fault of the map from a fault of reading the image's file.
    enum Fault {
        Map(MapError),
        Building(BuildingError),
    }
    impl From<MapError> for Fault {
        fn from(error: MapError) -> Self {
            Self::Map(error)
        }
    }
    let text = into_text(path, file(path, MAX_BYTES as u64)?)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    OccupancyGrid::read(&text, |image| file(&folder.join(image), MAX_IMAGE_BYTES).map_err(Fault::Building))
        .map_err(|fault| match fault {
            Fault::Map(source) => BuildingError::Map { path: path.to_owned(), source },
            Fault::Building(error) => error,
        })
}

fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, BuildingError> {
    let io = |source| BuildingError::Io { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|f| f.take(limit + 1).read_to_end(&mut bytes)).map_err(io)?;
    if read as u64 > limit {
        return Err(BuildingError::TooLarge { path: path.to_owned(), limit });
    }
    Ok(bytes)
}

fn into_text(path: &Path, bytes: Vec<u8>) -> Result<String, BuildingError> {
    String::from_utf8(bytes).map_err(|_| BuildingError::NotText { path: path.to_owned() })
}
