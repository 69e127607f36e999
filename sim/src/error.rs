//! What can be wrong with a map, a building, a world or a goal.

use std::path::PathBuf;

use thiserror::Error;

use crate::geometry::Point;

/// What is wrong with a YAML text. Lines count from 1.
#[derive(Clone, Debug, Eq, Error, PartialEq)]
pub enum YamlError {
    /// Longer than [`crate::MAX_YAML_BYTES`].
    #[error("{bytes} bytes of YAML; at most {} are read", crate::MAX_YAML_BYTES)]
    TooLong {
        /// How long it is.
        bytes: usize,
    },
    /// Not YAML.
    #[error("line {line}: {what}")]
    Syntax {
        /// Where.
        line: usize,
        /// The parser's words.
        what: String,
    },
    /// No document at all.
    #[error("no YAML document in it")]
    Empty,
    /// Anchors and aliases are not read.
    #[error("line {line}: anchors and aliases are not supported here")]
    Anchor {
        /// Where.
        line: usize,
    },
    /// Nested more deeply than any map or building file.
    #[error("line {line}: nested too deeply")]
    TooDeep {
        /// Where.
        line: usize,
    },
    /// One key twice in a mapping.
    #[error("line {line}: key \"{key}\" a second time")]
    DuplicateKey {
        /// Where the second one is.
        line: usize,
        /// The key.
        key: String,
    },
    /// A mapping or sequence as a key.
    #[error("line {line}: a key must be a plain text")]
    KeyNotScalar {
        /// Where.
        line: usize,
    },
    /// A required key is not there.
    #[error("line {line}: key \"{key}\" is missing")]
    MissingKey {
        /// Where the mapping begins.
        line: usize,
        /// The key.
        key: &'static str,
    },
    /// Another kind of value.
    #[error("line {line}: expected {what}")]
    Expected {
        /// Where.
        line: usize,
        /// What was expected.
        what: &'static str,
    },
}

/// What is wrong with a PGM image.
#[derive(Clone, Debug, Eq, Error, PartialEq)]
pub enum PgmError {
    /// The magic number is neither P2 nor P5.
    #[error("not a PGM image: it begins with neither P2 nor P5")]
    NotPgm,
    /// The header ends too early.
    #[error("the PGM header is cut short: no {missing}")]
    HeaderCutShort {
        /// The first number that is not there.
        missing: &'static str,
    },
    /// A number over 4294967295.
    #[error("a number in the PGM image is too large")]
    NumberTooLarge,
    /// Not white space, comment or digit where a number was expected.
    #[error("byte {byte:#04x} in the PGM image, where a number was expected")]
    UnexpectedByte {
        /// The byte.
        byte: u8,
    },
    /// Empty, or larger than is read.
    #[error(
        "PGM image of {width} x {height} pixels; each side must be 1 to {}, and at most {} pixels are read",
        crate::pgm::MAX_SIDE,
        crate::pgm::MAX_PIXELS
    )]
    Dimensions {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The white value is out of range.
    #[error("PGM maxval {maxval}; it must be 1 to 65535")]
    Maxval {
        /// As in the header.
        maxval: u32,
    },
    /// Fewer samples than the header promises.
    #[error("the PGM image is truncated: {found} of {expected} samples")]
    Truncated {
        /// Width times height.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A sample above the white value.
    #[error("PGM sample {sample} above maxval {maxval}")]
    SampleAboveMaxval {
        /// The sample.
        sample: u32,
        /// The white value.
        maxval: u16,
    },
}

/// What is wrong with a map in the format of ROS `map_server`.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MapError {
    /// The YAML file.
    #[error(transparent)]
    Yaml(#[from] YamlError),
    /// The image.
    #[error(transparent)]
    Pgm(#[from] PgmError),
    /// Not a usable size of a cell.
    #[error("resolution {resolution} m; it must be {} to {}", crate::MIN_RESOLUTION, crate::MAX_RESOLUTION)]
    Resolution {
        /// Metres a cell.
        resolution: f64,
    },
    /// An origin that is not two or three numbers, or too far away to be exact about cells.
    #[error("origin must be [x, y, yaw], finite, within 1e6 m")]
    Origin,
    /// A rotated map. `map_server` passes the rotation on, most of its users ignore it; here it
    /// is refused rather than ignored.
    #[error("the map is rotated by {yaw} rad; only 0 is supported")]
    Rotated {
        /// As in the file, in radians.
        yaw: f64,
    },
    /// Not 0 <= free < occupied <= 1.
    #[error("thresholds free {free}, occupied {occupied}; expected 0 <= free < occupied <= 1")]
    Thresholds {
        /// `free_thresh`.
        free: f64,
        /// `occupied_thresh`.
        occupied: f64,
    },
    /// Not `trinary`.
    #[error("mode \"{mode}\"; only trinary is supported")]
    Mode {
        /// As in the file.
        mode: String,
    },
    /// `negate` is not 0, 1, true or false.
    #[error("negate \"{negate}\"; expected 0 or 1")]
    Negate {
        /// As in the file.
        negate: String,
    },
    /// The number of cells is not width times height, or a side is out of range.
    #[error("{cells} cells for a map of {width} x {height}")]
    SizeMismatch {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// How many cells there are.
        cells: usize,
    },
}

/// What is wrong with a building.
#[derive(Debug, Error)]
pub enum BuildingError {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file larger than is read.
    #[error("{}: more than {limit} bytes", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// How much is read.
        limit: u64,
    },
    /// A file that is not text.
    #[error("{}: not UTF-8", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
    },
    /// The building file.
    #[error("{}: {source}", path.display())]
    Yaml {
        /// The file.
        path: PathBuf,
        /// Why.
        source: YamlError,
    },
    /// A map.
    #[error("{}: {source}", path.display())]
    Map {
        /// The map's YAML file, or its image.
        path: PathBuf,
        /// Why.
        source: MapError,
    },
    /// No floor.
    #[error("a building needs at least one floor")]
    NoFloor,
    /// One name for two floors, places or elevators.
    #[error("two {what} are named \"{name}\"")]
    DuplicateName {
        /// "floors", "places" or "elevators".
        what: &'static str,
        /// The name.
        name: String,
    },
    /// An elevator stops at a floor that is not there.
    #[error("elevator \"{elevator}\" stops at \"{floor}\", which is not a floor")]
    UnknownFloor {
        /// The elevator.
        elevator: String,
        /// What it calls the floor.
        floor: String,
    },
    /// Out of range or not finite.
    #[error("elevator \"{elevator}\": ride of {seconds} s; expected 0 to 3600")]
    Ride {
        /// The elevator.
        elevator: String,
        /// As given.
        seconds: f64,
    },
    /// A place or elevator stop off its map.
    #[error("\"{name}\" at ({:.2}, {:.2}) is off the map of floor \"{floor}\"", at.x, at.y)]
    OffMap {
        /// The place or elevator.
        name: String,
        /// Its floor.
        floor: String,
        /// Where, in metres.
        at: Point,
    },
    /// A place or elevator stop in a cell that is occupied or unknown.
    #[error("\"{name}\" at ({:.2}, {:.2}) is inside a wall of floor \"{floor}\"", at.x, at.y)]
    InsideWall {
        /// The place or elevator.
        name: String,
        /// Its floor.
        floor: String,
        /// Where, in metres.
        at: Point,
    },
    /// A heading that is not finite.
    #[error("\"{name}\": the heading is not a finite number")]
    Heading {
        /// The place.
        name: String,
    },
}

/// Why a world cannot be set up, or somebody cannot be put into it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum WorldError {
    /// A setting out of its range.
    #[error("setting {name} is {value}; expected {expected}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// As given.
        value: f64,
        /// The range.
        expected: &'static str,
    },
    /// The robot does not fit at a place or elevator stop.
    #[error("the robot (radius {radius} m) does not fit at \"{name}\" on floor \"{floor}\"")]
    TooTight {
        /// The place or elevator.
        name: String,
        /// Its floor.
        floor: String,
        /// The robot's radius with the clearance it keeps, in metres.
        radius: f64,
    },
    /// No such place.
    #[error("no place named \"{name}\"; there are: {known}")]
    UnknownPlace {
        /// As asked for.
        name: String,
        /// All places, separated by commas.
        known: String,
    },
    /// No such floor.
    #[error("no floor {floor}; the building has {floors}")]
    UnknownFloor {
        /// As asked for.
        floor: usize,
        /// How many there are.
        floors: usize,
    },
    /// No such person.
    #[error("no person named \"{name}\"")]
    UnknownPerson {
        /// As asked for.
        name: String,
    },
    /// Two people of one name.
    #[error("a person named \"{name}\" is already there")]
    DuplicatePerson {
        /// The name.
        name: String,
    },
    /// A person whose size, speed or waits are out of range or not finite.
    #[error("person \"{name}\": {what}")]
    BadPerson {
        /// The person.
        name: String,
        /// What is wrong.
        what: &'static str,
    },
    /// A person stands in, or is sent through, something that is not free.
    #[error("person \"{name}\" cannot get to ({:.2}, {:.2}): a wall is in the way", at.x, at.y)]
    PersonInWall {
        /// The person.
        name: String,
        /// The position that cannot be had.
        at: Point,
    },
    /// The robot and a person would overlap.
    #[error("the robot and person \"{name}\" would overlap")]
    Overlap {
        /// The person.
        name: String,
    },
}

/// Why there is no way to a goal.
#[derive(Clone, Debug, Eq, Error, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum RouteError {
    /// No such place.
    #[error("no place named \"{place}\"")]
    UnknownPlace {
        /// As asked for.
        place: String,
    },
    /// No way wide enough for the robot, by foot or by elevator.
    #[error("no way to \"{place}\" that the robot fits through")]
    NoWay {
        /// The goal.
        place: String,
    },
}
